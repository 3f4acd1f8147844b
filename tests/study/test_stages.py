"""Stages against the slow, obvious twins: brackets, spans, geometry maps, single candidates."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.core.nearest import worst_radius
from compass.core.patterns import Patterns
from compass.core.screen import closest_pair, deciding_phases, pattern_angles, screen_patterns
from compass.coverage.certificate import prove_fold
from compass.coverage.grid import equal_area_grid
from compass.coverage.maps import coverage_map
from compass.coverage.margin import covering_radius
from compass.coverage.motion import motion_of
from compass.coverage.symmetry import shortest_span
from compass.coverage.view import view
from compass.inputs.study import EntryStage, read_study_text
from compass.orbits import walker_delta, walker_star
from compass.sites import Site
from compass.study import stages
from compass.study.candidates import ROW, candidates, make_constellation
from compass.study.judge import campaign_of, ground_of
from compass.study.pattern_judging import entries_of, entry_figures, judged
from compass.study.pattern_map import map_figures
from compass.study.search import closest_approach
from compass.study.stages import TOLERANCE, evaluate, passing

R, ORBIT = 3396.19e3, 20427e3

TEXT = """
name = "t"
[study]
patterns = ["walker-delta", "walker-star", "rosette"]
satellites = {satellites}
inclination_deg = [43, 66]
radius_km = 20427.7
fold = {fold}
mask_deg = 5
[map]
step_deg = 15
epochs = 4
{more}
[[objective]]
figure = "satellites"
"""

PROVEN = '[[constraint]]\nfigure = "fold_proven"\nat_least = 1'


def study(satellites=6, fold=1, more=""):
    return read_study_text(TEXT.format(satellites=satellites, fold=fold, more=more))


def make(star, *counts, inclination):
    return (walker_star if star else walker_delta)(
        *counts, inclination_deg=np.degrees(inclination), radius_km=ORBIT / 1e3
    )


@st.composite
def patterns(draw):
    t = draw(st.integers(1, 12))
    p = draw(st.sampled_from([p for p in range(1, t + 1) if t % p == 0]))
    return draw(st.booleans()), t, p, draw(st.integers(0, p - 1)), draw(st.floats(0, np.pi / 2))


@settings(max_examples=40)
@given(patterns())
def test_patterns_are_laid_out_as_by_the_makers(pattern):
    star, t, p, f, inclination = pattern
    c = make(star, t, p, f, inclination=inclination)
    raan, u = pattern_angles(star, t, p, f)
    assert raan == pytest.approx(c.raan)
    assert np.exp(1j * u) == pytest.approx(np.exp(1j * c.mean_anomaly))
    assert closest_pair(raan, u, inclination) == pytest.approx(closest_approach(c), abs=1e-7)
    span, rate = shortest_span(c), c.mean_motion[0]
    first, last = deciding_phases(star, t, p, f)
    assert last - first == pytest.approx((span.stop - span.start) * rate)
    assert np.exp(1j * first) == pytest.approx(np.exp(1j * span.start * rate), abs=1e-9)


def bracket(pattern, fold, cap, reject):
    star, t, p, f, inclination = pattern
    least, most, closest = np.empty((3, 1))
    *columns, cap = (np.array([value]) for value in (star, t, p, f, inclination, cap))
    screen_patterns(Patterns(*columns), cap, fold, reject, 2e-3, 1e-6, least, most, closest)
    return least[0], most[0]


@settings(max_examples=10)
@given(patterns(), st.integers(1, 3))
def test_brackets_hold_the_covering_radius_of_the_whole_period(pattern, fold):
    star, t, p, f, inclination = pattern
    least, most = bracket(pattern, fold, -1.0, False)
    if t < fold:
        assert least == most == np.inf
        return
    # the twin takes no symmetry for granted: it looks at a whole revolution, in samples
    c = make(star, t, p, f, inclination=inclination)
    (orbits, frame), period = motion_of(c, shortest_span(c)), 2 * np.pi / c.mean_motion[0]
    times = np.linspace(0, period, 60)
    values = [worst_radius(orbits, frame.spin, fold, x, x, x, -1.0, 1, np.inf, 2)[0] for x in times]
    assert max(values) <= most + 1e-9
    found = covering_radius(c, fold, tolerance=2e-3)
    assert least <= found.radius + 1e-9 and found.at_least <= most + 1e-9
    assert most - least <= 2e-3 + 1e-12


@settings(max_examples=20)
@given(patterns(), st.floats(0, np.pi), st.integers(1, 6))
def test_brackets_against_points_and_moments(pattern, inclination, fold):
    """Any inclination, backwards too, at 3000 places and 90 moments of a whole revolution."""
    star, t, p, f, _ = pattern
    least, most = bracket((*pattern[:4], inclination), fold, -1.0, False)
    if t < fold:
        return
    number = np.arange(3000) + 0.5
    z, turn = 1 - number / 1500, np.pi * (1 + 5**0.5) * number
    places = np.stack([(1 - z * z) ** 0.5 * np.cos(turn), (1 - z * z) ** 0.5 * np.sin(turn), z])
    plane, slot = np.divmod(np.arange(t), t // p)
    raan = plane * (np.pi if star else 2 * np.pi) / p
    node = np.stack([np.cos(raan), np.sin(raan), 0 * raan], axis=1)
    ahead = np.stack([-np.sin(raan), np.cos(raan), 0 * raan], axis=1) * np.cos(inclination)
    ahead[:, 2] = np.sin(inclination)
    worst, step = 0.0, 2 * np.pi / 90
    for phase in step * np.arange(90):
        u = (2 * np.pi * (slot * p + f * plane) / t + phase)[:, None]
        cosines = (node * np.cos(u) + ahead * np.sin(u)) @ places
        distance = np.arccos(np.clip(np.partition(cosines, t - fold, axis=0)[t - fold], -1, 1))
        worst = max(worst, distance.max())
    # no place is farther from one of the spiral than 1.37 radii of 3000 discs that share the sphere
    # (its Voronoi corners), no moment than half a step, in which no satellite goes farther
    gap = 1.37 * np.arccos(1 - 2 / 3000) + step / 2
    assert worst - 1e-9 <= most and least <= worst + gap


def test_close_calls_are_decided_and_rejects_end_early():
    pattern = (False, 5, 5, 1, np.radians(43.66))
    exact = covering_radius(make(*pattern[:4], inclination=pattern[4]), 1, tolerance=1e-7).radius
    for cap in (exact - 1e-4, exact + 1e-4):  # inside a bracket of 2e-3, outside one of 1e-6
        least, most = bracket(pattern, 1, cap, False)
        assert (most <= cap) == (cap > exact) and (least > cap) == (cap < exact)
    assert bracket(pattern, 1, exact - 0.1, True)[1] == np.inf


def test_screen_agrees_with_the_certificate():
    s = study(satellites="[5, 6, 7]")
    found = candidates(s)
    rows = found.rows(0, len(found))
    figures = evaluate("screen", s, rows).figures
    outcomes = [
        prove_fold(make_constellation(row), 1, sphere_radius=R, mask=np.radians(5)).outcome
        for row in rows
    ]
    assert set(outcomes) == {"proven", "refuted"}
    assert figures["fold_proven"].tolist() == [float(o == "proven") for o in outcomes]
    # the margin is the highest mask that holds, on the safe side by the bracket
    proven = figures["fold_proven"] == 1
    assert np.all(figures["mask_margin_deg"][proven] >= 5)
    for k in np.flatnonzero(proven)[:6]:
        c = make_constellation(rows[k])
        at = np.radians(figures["mask_margin_deg"][k])
        assert prove_fold(c, 1, sphere_radius=R, mask=at - 1e-9).outcome == "proven"
        above = at + 3 * TOLERANCE
        assert prove_fold(c, 1, sphere_radius=R, mask=above).outcome == "refuted"


def test_rejected_candidates_have_no_margin_but_the_same_verdict():
    free, wanted = study(satellites="[5, 6]"), study(satellites="[5, 6]", more=PROVEN)
    rows = candidates(free).rows(0, 40)
    a, b = (evaluate("screen", s, rows).figures for s in (free, wanted))
    assert np.array_equal(a["fold_proven"], b["fold_proven"])
    refuted = a["fold_proven"] == 0
    assert np.all(np.isfinite(a["mask_margin_deg"]))
    assert np.all(np.isnan(b["mask_margin_deg"][refuted]))
    assert np.array_equal(passing(wanted, "screen", b), ~refuted)


def test_costs_that_are_not_allowed_end_it_at_once():
    s = study(satellites="[5, 6]", more='[[constraint]]\nfigure = "satellites"\nat_most = 5')
    rows = candidates(s).rows(0, 60)
    figures = evaluate("screen", s, rows).figures
    small = rows["satellites"] == 5
    assert np.array_equal(np.isnan(figures["fold_proven"]), ~small)
    assert np.array_equal(passing(s, "cost", figures), small)


@pytest.mark.slow
def test_map_against_the_coverage_map():
    s = study(satellites=15, fold=4)
    c = walker_delta(15, 5, 1, inclination_deg=45, radius_km=ORBIT / 1e3)
    mask = np.radians(5)
    # the map is Mars-fixed, ours inertial: many epochs of a day average the difference out
    grid = equal_area_grid(np.radians(5))
    from compass.sites import Mask

    seen = view(c, np.linspace(0, 88642.663, 48, endpoint=False), R, Mask.constant(mask))
    data = coverage_map(seen, grid, fold=4, workers=1)
    dops = data.cells_dop
    finer = read_study_text(
        s.text.replace("step_deg = 15", "step_deg = 5").replace("epochs = 4", "epochs = 40")
    )
    found = map_figures(finer, np.array([(0, 15, 5, 1, 45.0, ORBIT / 1e3, 5.0)], ROW))
    ours = {name: values[0] for name, values in found.items()}
    # both sample area and time: some 1e5 correlated points each, percents apart
    for name, percent in (("gdop", 50), ("gdop", 95), ("pdop", 95)):
        there = float(dops.sel(dop=name, global_percentile=percent))
        assert ours[f"{name}_p{percent}"] == pytest.approx(there, rel=0.03)
    assert ours["availability"] == pytest.approx(float(data.cells_availability), abs=0.01)
    # the mean count is exact: satellites times the share of a cap, as a fine map has it nearly
    assert ours["count_mean"] == pytest.approx(float(data.cells_count_mean), rel=2e-3)
    cap = np.arccos(R * np.cos(mask) / ORBIT) - mask
    assert ours["count_mean"] == pytest.approx(15 * (1 - np.cos(cap)) / 2, rel=1e-12)


@pytest.mark.parametrize("stage", ["screen", "map", "entry"])
def test_the_batch_does_not_matter(stage, short):
    s = replace(study(satellites="[5, 6, 12]"), entry=EntryStage(short(), 2, 9, 2, 1))
    found = candidates(s)
    rows = found.rows(0, len(found))[::17]
    assert set(rows["pattern"]) == {0, 1}  # rosettes are delta patterns
    together = evaluate(stage, s, rows)
    assert not together.errors
    for some in ([3, 1], *([k] for k in range(rows.size))):
        alone = evaluate(stage, s, rows[some])
        for name in stages.figures_of(stage, s):
            assert np.array_equal(together.figures[name][some], alone.figures[name], equal_nan=True)


def test_one_that_raises_does_not_harm_the_others(monkeypatch):
    s = study(satellites="[5, 6]")
    rows = candidates(s).rows(0, 5)
    whole = evaluate("map", s, rows)
    honest = stages.FINDERS["map"]

    def flawed(study, some):
        if rows[2] in some:
            raise ZeroDivisionError("no such thing")
        return honest(study, some)

    monkeypatch.setitem(stages.FINDERS, "map", flawed)
    found = evaluate("map", s, rows)
    assert found.errors == {2: "ZeroDivisionError: no such thing"}
    for name, values in found.figures.items():
        assert np.isnan(values[2])
        others = [0, 1, 3, 4]
        assert np.array_equal(values[others], whole.figures[name][others], equal_nan=True)


@pytest.mark.slow
def test_a_symmetric_pattern_that_fails_the_poles_is_found_out():
    # 24/8/4: near the poles all in view lie on a cone once a step, whatever the inclination
    text = study(satellites=24, fold=4).text.replace("step_deg = 15", "step_deg = 10")
    s = read_study_text(text.replace("epochs = 4", "epochs = 100"))
    c = walker_delta(24, 8, 4, inclination_deg=50, radius_km=ORBIT / 1e3)
    figures = map_figures(s, np.array([(0, 24, 8, 4, 50.0, ORBIT / 1e3, 5.0)], ROW))
    assert figures["gdop_p95"] < 3
    # the worst zone, sampled plainly: both hemispheres, random times of a whole revolution
    rng = np.random.default_rng(3)
    times = rng.uniform(0, 2 * np.pi / c.mean_motion[0], 2000)
    from compass.coverage.fold import clearances
    from compass.frames import direction
    from compass.orbits import positions_mci

    values = []
    for time, sign, longitude in zip(
        times, rng.choice([-1, 1], 2000), rng.uniform(0, 6.28, 2000), strict=True
    ):
        place = direction(sign * np.radians(85), longitude)
        up = clearances(positions_mci(c, [time])[:, 0], R, np.radians(5), place) >= 0
        sight = positions_mci(c, [time])[up, 0] - R * place
        h = np.hstack([sight / np.linalg.norm(sight, axis=1)[:, None], np.ones((up.sum(), 1))])
        values.append(np.sqrt(np.trace(np.linalg.pinv(h.T @ h))))
    # of 2000 the 95th percentile is the value of a share of 5 +- 0.5 %, and here GDOP times
    # that share is constant: 10 % for one sigma
    assert figures["gdop_p95_zone"] == pytest.approx(np.percentile(values, 95), rel=0.3)
    assert figures["gdop_p95_zone"] > 25


def test_landers_of_a_study_deploy_where_it_says(short):
    here = Site.of("here", latitude_deg=20, longitude_deg=50)
    entry = EntryStage(short(), 2, 9, 2, 1, sites=(here,))
    s = replace(study(satellites="[6]"), entry=entry)
    rows = candidates(s).rows(0, 1)
    found = entry_figures(s, rows)
    alone = judged(s, entries_of(s), make_constellation(rows[0]), float(rows["mask_deg"][0]))
    assert found["crlb_position_m.p95"][0] == pytest.approx(alone["crlb_position_m.p95"], rel=1e-3)
    campaign = campaign_of(entry.scenario, 2, s.seed, ground=ground_of((here,), ()))
    latitude, longitude = np.degrees(campaign.deployment_place)
    assert latitude == pytest.approx([20, 20], abs=1e-4)
    assert longitude == pytest.approx([50, 50], abs=1e-4)
    anywhere = entry_figures(replace(s, entry=EntryStage(short(), 2, 9, 2, 1)), rows)
    assert anywhere["crlb_position_m.p95"][0] != found["crlb_position_m.p95"][0]
