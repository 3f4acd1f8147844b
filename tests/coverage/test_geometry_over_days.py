"""How long dilutions of precision are kept along real paths."""

from dataclasses import replace

import numpy as np
import pytest

from compass.coverage import geometry_over_days as module
from compass.coverage.certificate import Outcome
from compass.coverage.geometry_over_days import RESOLUTION, geometry_lasts
from compass.coverage.verdict import Verdict, Worst
from compass.design import Design
from compass.frames import SECONDS_PER_DAY
from compass.orbits import walker_delta
from compass.orbits.motion import Motion
from compass.requirement import Requirement
from compass.sites import Site

SITE = Site.of("here", latitude_deg=-41.0, longitude_deg=70.0)
ALWAYS = Requirement.of("always", sites=[SITE], pdop_at_most=6)
OFTEN = replace(ALWAYS, share=0.9)


@pytest.fixture
def design():
    return Design(walker_delta(15, 5, 1, inclination_deg=28, radius_km=20427.7))


def settled(met, requirement, share=None, time=None, reason=""):
    worst = None if time is None else Worst(time, -0.7, 1.2, 9.0)
    return Verdict(requirement, met, "bracket", "", share, None, worst, reason=reason)


@pytest.mark.parametrize("seen", [False, True])
def test_a_miss_is_found_by_halving(design, monkeypatch, seen):
    """Missed from day 9.3 on: proven before it and missed within the resolution after it."""
    miss = 9.3 * SECONDS_PER_DAY

    def verdict(design, requirement, name, limit, *, days, start_day, **_):
        end = (start_day + days) * SECONDS_PER_DAY
        return settled(end <= miss, requirement, time=miss if seen and end > miss else None)

    monkeypatch.setattr(module, "geometry_verdict", verdict)
    path = Motion().trajectory(design.constellation, 0.0, 30 * SECONDS_PER_DAY)
    found = geometry_lasts(design, ALWAYS, path, 0.0, 30 * SECONDS_PER_DAY)
    assert found.outcome is Outcome.REFUTED
    assert found.proven_until <= miss <= found.lost_at + 1e-6
    assert found.lost_at - found.proven_until <= RESOLUTION


def test_a_share_is_taken_of_each_stretch_and_what_is_open_is_said(design, monkeypatch):
    widths = []

    def verdict(design, requirement, name, limit, *, days, start_day, width, **_):
        widths.append(width)
        if start_day < 7.0:
            return settled(True, requirement, (0.96, 1.0))
        return settled(None, requirement, (0.8, 0.95), reason="open")

    monkeypatch.setattr(module, "geometry_verdict", verdict)
    path = Motion().trajectory(design.constellation, 0.0, 14 * SECONDS_PER_DAY)
    two = replace(OFTEN, limits=(("pdop", 6.0), ("vdop", 6.0)))
    found = geometry_lasts(design, two, path, 0.0, 14 * SECONDS_PER_DAY)
    assert (found.outcome, found.lost_at) == (Outcome.UNDECIDED, None)
    assert (found.days_proven, found.first_loss_days) == (7.0, None)
    assert found.verdict.reason == "open"
    # finer and finer where it is open, at once content where it is not
    assert widths == [module.WIDTHS[0]] * 2 + [w for w in module.WIDTHS for _ in range(2)]


def test_what_has_used_up_its_boxes_is_not_asked_again_more_finely(design, monkeypatch):
    """And who watches is told how much of the way is gone, up to where it is open."""
    asked, parts = [], []

    def verdict(design, requirement, name, limit, *, days, start_day, effort, width, **_):
        asked.append((start_day, width))
        effort.progress("share", 0.5)
        late = "boxes" if start_day >= 7.0 else ""
        open_ = replace(settled(None, requirement, (0.0, 1.0), reason="open"), stopped=late)
        return open_ if late else settled(True, requirement, (0.96, 1.0))

    monkeypatch.setattr(module, "geometry_verdict", verdict)
    path = Motion().trajectory(design.constellation, 0.0, 28 * SECONDS_PER_DAY)
    found = geometry_lasts(design, OFTEN, path, 0.0, 28 * SECONDS_PER_DAY, parts.append)
    assert (found.outcome, found.days_proven) == (Outcome.UNDECIDED, 7.0)
    assert asked == [(0.0, module.WIDTHS[0]), (7.0, module.WIDTHS[0])]
    assert parts == pytest.approx([0.125, 0.25, 0.375, 0.5])


@pytest.mark.slow
def test_the_first_moment_of_a_poor_geometry_agrees_with_a_look_every_ten_seconds(design):
    path = Motion("numerical").trajectory(design.constellation, 0.0, 2 * SECONDS_PER_DAY)
    found = geometry_lasts(design, ALWAYS, path, 0.0, 2 * SECONDS_PER_DAY)
    times = np.arange(0.0, 2 * SECONDS_PER_DAY, 10.0)
    r = path.positions_mcmf(times) - SITE.r_mcmf
    lines = r / np.linalg.norm(r, axis=-1, keepdims=True)
    up = SITE.enu_mcmf[2]
    poor = []
    for k in range(times.size):
        e = lines[:, k][lines[:, k] @ up > 0.0]
        rows = np.hstack([e, np.ones((len(e), 1))])
        spread = np.trace(np.linalg.inv(rows.T @ rows)[:3, :3]) if len(e) >= 4 else np.inf
        poor.append(not 0.0 <= spread <= 36.0)
    first = times[int(np.argmax(poor))] if any(poor) else np.inf
    if found.lost_at is None:
        assert found.outcome is Outcome.PROVEN
        assert first == np.inf
    else:
        assert found.proven_until <= first <= found.lost_at + 10.0
