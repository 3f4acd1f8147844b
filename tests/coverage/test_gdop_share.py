"""GDOP over area and time: the kernel against linear algebra, percentiles against many samples."""

import numpy as np
import pytest

from compass.core.gdop import dops_at, dops_over
from compass.coverage.gdop import gdop_percentile, gdop_samples, gdop_share
from compass.coverage.symmetry import shortest_span
from compass.errors import ArgumentError
from compass.orbits import positions_mci, walker_delta

R = 3396.2e3


def design():
    return walker_delta(15, 5, 1, inclination_deg=45, radius_km=20428)


def plain_gdop(r, place, mask):
    sight = r - R * place
    unit = sight / np.linalg.norm(sight, axis=1, keepdims=True)
    unit = unit[unit @ place >= np.sin(mask)]
    if len(unit) < 4:
        return len(unit), np.inf
    h = np.hstack([unit, np.ones((len(unit), 1))])
    return len(unit), np.sqrt(np.trace(np.linalg.inv(h.T @ h)))


def test_kernel_against_numpy():
    r = positions_mci(design(), [1234.0])[:, 0]
    for place in np.random.default_rng(0).normal(size=(30, 3)):
        up = place / np.linalg.norm(place)
        for mask in (0.0, 0.15):
            fold, gdop, _ = dops_at(r, up, R, np.sin(mask))
            expected = plain_gdop(r, up, mask)
            assert fold == expected[0]
            assert gdop == pytest.approx(expected[1], rel=1e-7)


@pytest.mark.parametrize("count", [1, 5, 130])  # less than a tile of places, and more
def test_many_places_as_each_alone(count):
    r = positions_mci(design(), [1234.0, 40000.0]).transpose(1, 0, 2).copy()
    places = np.random.default_rng(count).normal(size=(count, 3))
    places /= np.linalg.norm(places, axis=1, keepdims=True)
    fold = np.empty((2, count), np.int64)
    gdop, pdop = np.empty((2, 2, count))
    dops_over(r, places, R, np.sin(0.1), fold, gdop, pdop)
    for t in range(2):
        for q in range(count):
            alone = dops_at(r[t], places[q], R, np.sin(0.1))
            assert fold[t, q] == alone[0]
            limit = 1e-15 * 15 * alone[1] ** 2 if np.isfinite(alone[1]) else 0
            assert (gdop[t, q], pdop[t, q]) == pytest.approx(alone[1:], rel=limit)


def test_singular_geometry_is_infinite():
    # four lines of sight on one cone about the vertical
    turn = np.radians([0, 90, 180, 270])
    up = np.array([0.0, 0.0, 1.0])
    r = R * up + 1e7 * np.stack([np.cos(turn), np.sin(turn), np.ones(4)], axis=1)
    assert dops_at(r, up, R, 0.0) == (4, np.inf, np.inf)


def test_weights_are_shares_of_area_and_time():
    c = design()
    gdop, fold, weight = gdop_samples(
        c,
        95.0,
        sphere_radius=R,
        mask=0.0,
        span=shortest_span(c),
        generator=np.random.default_rng(0),
        start=4,
        levels=2,
    )
    assert weight.sum() == pytest.approx(1.0)
    assert gdop.size == fold.size
    # mean fold is the total area of the caps: 15 times 41.687 % (specification, section 1)
    assert (fold * weight).sum() == pytest.approx(6.253, abs=0.12)


@pytest.mark.slow
def test_percentile_and_availability_against_many_samples():
    c = design()
    rng = np.random.default_rng(7)
    times = rng.uniform(0, shortest_span(c).stop, 200)
    samples = []
    for moment in positions_mci(c, times).transpose(1, 0, 2):
        places = rng.normal(size=(100, 3))
        places /= np.linalg.norm(places, axis=1, keepdims=True)
        samples += [plain_gdop(moment, place, 0.0)[1] for place in places]
    gdop = np.array(samples)
    found = gdop_percentile(c, 95.0, sphere_radius=R)
    available = gdop_share(c, 4.0, sphere_radius=R)
    # places of one moment are not independent: the spread among ten groups of moments says how
    # far their mean may be off
    groups = gdop.reshape(10, -1)
    for limit, share, error in (
        (found.value, 0.95, 0.0),
        (4.0, available.value, available.error),
    ):
        shares = (groups <= limit).mean(axis=1)
        spread = shares.std(ddof=1) / np.sqrt(10)
        assert spread < 0.01
        assert shares.mean() == pytest.approx(share, abs=4 * np.hypot(error, spread))
    assert 0 < found.error < 0.02
    assert 0 < available.error < 0.01


def test_same_seed_same_number():
    c = walker_delta(6, 3, 1, inclination_deg=57.3, radius_km=20428)
    one, other = (
        gdop_share(c, 6.0, sphere_radius=R, repetitions=2, start=4, levels=2) for _ in range(2)
    )
    assert one == other


def test_percent_is_checked():
    with pytest.raises(ArgumentError, match="percent = 100"):
        gdop_percentile(design(), 100.0, sphere_radius=R)
