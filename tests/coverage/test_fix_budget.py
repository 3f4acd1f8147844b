"""Parts of a fix's variance against error maps of a signal that has that part alone."""

from dataclasses import replace

import numpy as np
import pytest

from compass.coverage.errors import ERRORS, error_map
from compass.coverage.fix_budget import PARTS, fix_budget, variances_by_part
from compass.coverage.grid import make_grid
from compass.coverage.view import view
from compass.design import Design
from compass.frames import direction, east_north_up, planetographic_latitude
from compass.links import Radio
from compass.orbits import walker_delta
from compass.ranging import Receiver, Signal
from compass.signal.ranges import range_errors
from compass.sites import Mask

WHOLE = Signal(
    frequency=4e8, ephemeris=(2, 8, 5), clock_sigma=3.0, common_time=2.0, common_orientation=1e-6,
    receiver=Receiver(0.3, 0.4, 300.0), ionosphere=2.0,
)  # fmt: skip
NOTHING = Signal(frequency=4e8, receiver=Receiver())
ALONE = (
    replace(NOTHING, clock_sigma=3.0),
    replace(NOTHING, ephemeris=(2, 8, 5)),
    replace(NOTHING, receiver=WHOLE.receiver),
    replace(NOTHING, ionosphere=2.0),
    replace(NOTHING, common_time=2.0, common_orientation=1e-6),
)
TIMES = np.array([100.0, 4321.0])
MASKS = Mask.of(5), Mask.of([[0, 2], [90, 20], [180, 4], [270, 11]])


def design(signal, mask=MASKS[0], satellites=9):
    c = walker_delta(satellites, 3, 1, inclination_deg=50, radius_km=20427)
    radio = Radio(("satellite", "station"), 4e8, 0.0, -25.0, 30.0)
    return Design(c, name="d", figure="iau-ellipsoid", mask=mask, signal=signal, radios=(radio,))


def looked_at(d, weights):
    seen = view(d.constellation, TIMES, d.figure.equatorial_radius, d.mask)
    return seen, range_errors(d, TIMES, weights=weights)


def of_map(d, grid, weights):
    """Variances of the second epoch, in single precision, shape (error, cell)."""
    seen, ranges = looked_at(d, weights)
    one = replace(seen, times=TIMES[1:], r=seen.r[1:], cos_cap=seen.cos_cap[1:])
    ranges = replace(ranges, forms=ranges.forms[1:], sun=ranges.sun[1:])
    made = error_map(one, grid, ranges, workers=1)
    return np.stack([made[name].sel(percentile=50).values.ravel() for name in ERRORS]) ** 2


@pytest.mark.parametrize("mask", MASKS)
def test_every_part_is_what_a_signal_with_it_alone_gives(mask):
    """With equal weights the solution does not depend on variances, so that parts are maps."""
    d = design(WHOLE, mask)
    figure = d.figure
    grid = make_grid("equal-angle", 30, figure.polar_radius / figure.equatorial_radius)
    latitude, longitude = (
        x.ravel() for x in np.meshgrid(grid.latitude, grid.longitude, indexing="ij")
    )
    polar = grid.polar
    radius = polar / np.hypot(polar * np.cos(latitude), np.sin(latitude))
    places = radius[:, None] * direction(latitude, longitude)
    ups = east_north_up(planetographic_latitude(latitude, figure), longitude)[:, 2]
    for weights in ("equal", "variance"):
        seen, ranges = looked_at(d, weights)
        found, fixed, heard, *_ = variances_by_part(seen.r, seen, ranges, places, ups)
        whole = of_map(d, grid, weights)
        good = fixed[1]
        assert np.array_equal(good, np.isfinite(whole).all(axis=0)) and 8 < good.sum() < good.size
        assert pytest.approx(whole[:, good], rel=3e-5) == found[1, good].sum(axis=2).T
        assert (heard >= 0).all()
        if weights == "equal":
            for part, signal in enumerate(ALONE):
                alone = of_map(design(signal, mask), grid, weights)[:, good]
                assert pytest.approx(alone, rel=3e-5, abs=1e-6) == found[1, good, :, part].T


def test_shares_add_up_and_a_better_clock_takes_its_share_away():
    d = design(WHOLE)
    made = fix_budget(d, *looked_at(d, "variance"))
    assert made.shares.sum(axis=1) == pytest.approx(1.0)
    assert made.range_shares.sum() == pytest.approx(1.0)
    better = design(replace(WHOLE, clock_sigma=0.3))
    after = fix_budget(better, *looked_at(better, "variance"))
    clock = PARTS.index("clock")
    assert np.all(after.shares[:, clock] < 0.1 * made.shares[:, clock])
    left = made.range_error**2 * (1.0 - 0.99 * made.range_shares[clock])
    assert after.range_error**2 == pytest.approx(left)


def test_correlated_orbit_and_clock_share_what_they_make_together():
    """A clock that is early by what the orbit is high: ranges straight down do not feel them."""
    both = np.zeros((4, 4))
    both[np.ix_([0, 3], [0, 3])] = [[9.0, -9.0], [-9.0, 9.0]]
    signal = Signal(covariance=(tuple(map(tuple, both)),), receiver=Receiver(0.1))
    d = design(signal)
    made = fix_budget(d, *looked_at(d, "variance"))
    assert made.range_error < 0.3  # 3 m each, of opposite sign
    assert made.range_shares[0] == pytest.approx(made.range_shares[1], rel=0.03)
    assert made.range_shares.min() >= 0


def test_without_a_fix_there_are_no_parts():
    d = design(WHOLE, satellites=3)
    made = fix_budget(d, *looked_at(d, "variance"))
    assert np.isnan(made.range_error) and np.isnan(made.shares).all()


def test_what_the_mask_hides_is_counted():
    """Of the same users and moments, four above the plain horizon as counted one by one."""
    d = design(WHOLE, Mask.of(30), satellites=12)
    seen, ranges = looked_at(d, "variance")
    made, bare = fix_budget(d, seen, ranges), design(WHOLE, Mask.of(0), satellites=12)
    open_ = fix_budget(bare, *looked_at(bare, "variance"))
    assert 0.0 < made.four < made.four_unmasked == open_.four == open_.four_unmasked
