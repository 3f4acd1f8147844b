"""Draws against exact areas, certified shares, and dilutions and errors of one user by himself."""

from dataclasses import replace

import numpy as np
import pytest

from compass.coverage import drawn as module
from compass.coverage.certified_ranges import ranges_of
from compass.coverage.certified_share import certified_share
from compass.coverage.certified_witness import dilution_at
from compass.coverage.drawn import drawn
from compass.coverage.share import mean_fold_shares
from compass.design import Design
from compass.frames import FIGURES
from compass.integrity import Integrity
from compass.orbits import walker_delta
from compass.orbits.motion import Motion
from compass.quantities.draws import quantile_bounds, share_bounds
from compass.ranging import Receiver, Signal
from compass.sites import Mask, Site

PATTERN = walker_delta(9, 3, 1, inclination_deg=50, radius_km=20000)
SIGNAL = Signal(ephemeris=(2, 8, 5), clock_sigma=3.0, receiver=Receiver(0.5))
DAY = 88642.66


def design(mask=5, **more):
    return Design(PATTERN, name="d", mask=Mask.of(mask), **more)


@pytest.mark.slow
def test_folds_and_dilutions_are_those_of_exact_areas_and_certified_shares():
    found = drawn(design(), (0.0, 1e7), draws=20_000, seed=3)
    exact = mean_fold_shares(
        PATTERN, sphere_radius=FIGURES["iau-sphere"].equatorial_radius, mask=np.radians(5)
    )
    for fold in (3, 4, 5):
        share = exact.share[fold:].sum()
        sigma = np.sqrt(share * (1 - share) / 20_000)
        assert (found.count >= fold).mean() == pytest.approx(share, abs=4 * sigma)
    for dop, limit in (("hdop", 2.0), ("gdop", 5.0)):
        known = certified_share(PATTERN, limit, dop=dop, mask=np.radians(5), width=5e-3)
        share = (found.values[dop] <= limit).mean()
        assert abs(share - known.value) <= 0.5 * known.width + 4 * np.sqrt(0.25 / 20_000)


def test_each_draw_is_what_its_user_has(monkeypatch):
    """On the ellipsoid, over a horizon by azimuth; pieces change nothing."""
    figure, mask = FIGURES["iau-ellipsoid"], Mask.of([[0, 2], [90, 20], [180, 4], [270, 11]])
    asked = replace(design(figure="iau-ellipsoid", signal=SIGNAL), mask=mask)
    users = []
    looked = module.seen_along

    def note(design, mover, times, motion, beam):
        if mover.mask == mask:  # not once more over the plain horizon
            users.extend(zip(mover.r, mover.axes, times, strict=True))
        return looked(design, mover, times, motion, beam)

    monkeypatch.setattr(module, "seen_along", note)
    monkeypatch.setattr(module, "PIECE", 9 * 17)
    found, ranges = drawn(asked, (0.0, DAY), draws=40), ranges_of(asked)
    assert len(users) == 40 and found.count.max() > 3
    for k, (r, axes, time) in enumerate(users):
        a, b = figure.equatorial_radius, figure.polar_radius
        assert (r[0] ** 2 + r[1] ** 2) / a**2 + r[2] ** 2 / b**2 == pytest.approx(1.0)
        place = np.arctan2(r[2], np.hypot(*r[:2])), np.arctan2(r[1], r[0])
        site = Site("", *place, 0.0, mask, figure)
        assert site.enu_mcmf == pytest.approx(axes, abs=1e-9)
        for dop in ("gdop", "pdop", "hdop", "vdop", "tdop"):
            value, names = dilution_at(PATTERN, site, time, Motion(), dop)
            assert found.count[k] == len(names)
            assert found.values[dop][k] == pytest.approx(value, rel=1e-6)
        value, _ = dilution_at(PATTERN, site, time, Motion(), "vdop", ranges)
        assert found.values["error_vertical_m"][k] == pytest.approx(value, rel=1e-6)


def test_places_are_of_equal_chance_by_area_and_the_same_seed_draws_the_same():
    """Of a polar satellite, which every place meets alike, its cap is the share of area."""
    one, two = (drawn(design(signal=SIGNAL), (0.0, DAY), draws=500) for _ in range(2))
    other = drawn(design(signal=SIGNAL), (0.0, DAY), draws=500, seed=1)
    assert all(np.array_equal(one.values[name], two.values[name]) for name in one.values)
    assert not np.array_equal(one.values["gdop"], other.values["gdop"])
    pole = replace(design(mask=0), constellation=walker_delta(1, 1, 0, inclination_deg=90,
                                                              radius_km=20000))  # fmt: skip
    few = drawn(pole, (0.0, DAY), draws=20_000)
    cap = 0.5 * (1 - 3396.19 / 20000)
    assert few.count.mean() == pytest.approx(cap, abs=4 * np.sqrt(cap * (1 - cap) / 20_000))


def test_levels_are_drawn_with_what_is_promised():
    promised = design(signal=SIGNAL, integrity=Integrity())
    found = drawn(promised, (0.0, DAY), draws=300)
    level = found.values["protection_horizontal_m"]
    assert np.isfinite(level).any() and np.isinf(level[found.count < 5]).all()
    both = found.protected["horizontal"] & found.protected["vertical"]
    assert np.array_equal(found.protected["both"], both)
    assert np.array_equal(found.protected["horizontal"], level <= 50.0)
    assert not drawn(design(), (0.0, DAY), draws=10).protected


@pytest.mark.slow
def test_who_stands_behind_the_mask_is_counted_and_what_a_loss_leaves_is_drawn():
    promised = design(mask=4, signal=SIGNAL, integrity=Integrity())
    found = drawn(promised, (0.0, DAY), draws=400, losses=True)
    bare = drawn(replace(promised, mask=Mask()), (0.0, DAY), draws=400)
    assert np.array_equal(found.risen, bare.count) and (found.risen > found.count).any()
    for lost in (0, 7):
        fewer = replace(promised, constellation=PATTERN.without([lost]))
        alone = drawn(fewer, (0.0, DAY), draws=400).protected
        for name, hits in found.left.items():
            assert np.array_equal(hits[:, lost], alone[name])
    able = found.protected["detectable"]
    assert np.array_equal(able, np.isfinite(found.values["protection_vertical_m"]))
    lost = found.left["detectable"].sum(axis=0)
    assert (lost <= able.sum()).all() and (lost < able.sum()).any()


@pytest.mark.slow
def test_intervals_hold_as_often_as_they_say():
    """Of 60 draws of 12 designs at least 50 hold the certified share, 57 expected; ranks, too."""
    g = np.random.default_rng(11)
    held = ranked = alike = 0
    for number in range(12):
        planes = int(g.integers(2, 6))
        pattern = walker_delta(
            planes * int(g.integers(3, 5)), planes, int(g.integers(planes)),
            inclination_deg=float(g.uniform(30, 90)), radius_km=float(g.uniform(15000, 25000)),
        )  # fmt: skip
        asked = Design(pattern, name="d", mask=Mask.of(5))
        known = certified_share(pattern, 4.0, mask=np.radians(5), width=2e-3)
        for seed in range(5):
            values = drawn(asked, (0.0, 1e7), draws=500, seed=5 * number + seed).values["pdop"]
            low, high = share_bounds(float((values <= 4.0).mean()), values.size)
            held += low <= known.high and known.low <= high
            if 0.02 < known.value < 0.98:
                low, high = quantile_bounds(values, 100 * known.value)
                ranked += low <= 4.0 <= high
            else:  # so few draws tell no such percentile
                alike += 1
    assert held >= 50 and ranked >= 50 - alike and alike <= 20
