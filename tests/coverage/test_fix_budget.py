"""Parts of a fix's variance against error maps of a signal that has that part alone."""

from dataclasses import fields, replace
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from compass.api.map_statistics import _budget
from compass.coverage.drawn import drawn
from compass.coverage.errors import ERRORS, error_map
from compass.coverage.fix_budget import PARTS, FixBudget, fix_budget, variances_by_part
from compass.coverage.grid import make_grid
from compass.coverage.moving import Mover, ranges_at, seen_along
from compass.coverage.view import view
from compass.design import Design
from compass.frames import direction, east_north_up, planetographic_latitude
from compass.links import Radio
from compass.orbits import walker_delta
from compass.orbits.motion import Motion
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
TIME = 4321.0
MASKS = Mask.of(5), Mask.of([[0, 2], [90, 20], [180, 4], [270, 11]])


def design(signal, mask=MASKS[0], satellites=9):
    c = walker_delta(satellites, 3, 1, inclination_deg=50, radius_km=20427)
    radio = Radio(("satellite", "station"), 4e8, 0.0, -25.0, 30.0)
    return Design(c, name="d", figure="iau-ellipsoid", mask=mask, signal=signal, radios=(radio,))


def of_map(d, grid, weights):
    """Variances at one moment, in single precision, shape (error, cell)."""
    times = np.array([TIME])
    seen = view(d.constellation, times, d.figure.equatorial_radius, d.mask)
    made = error_map(seen, grid, range_errors(d, times, weights=weights), workers=1)
    return np.stack([made[name].sel(percentile=50).values.ravel() for name in ERRORS]) ** 2


def at_cells(d, grid, weights):
    """What `variances_by_part` takes of users at all cells at that moment."""
    latitude, longitude = (
        x.ravel() for x in np.meshgrid(grid.latitude, grid.longitude, indexing="ij")
    )
    polar, radius = grid.polar, d.figure.equatorial_radius
    places = polar / np.hypot(polar * np.cos(latitude), np.sin(latitude))
    axes = east_north_up(planetographic_latitude(latitude, d.figure), longitude)
    r = radius * places[:, None] * direction(latitude, longitude)
    times = np.full(len(r), TIME)
    positions, seen, _ = seen_along(d, Mover("", r, axes, d.mask), times, Motion())
    ranges = ranges_at(d, times, Motion(), weights)
    return positions, seen, ranges, r / radius, axes[:, 2]


@pytest.mark.parametrize("mask", MASKS)
def test_every_part_is_what_a_signal_with_it_alone_gives(mask):
    """With equal weights the solution does not depend on variances, so that parts are maps."""
    d = design(WHOLE, mask)
    figure = d.figure
    grid = make_grid("equal-angle", 30, figure.polar_radius / figure.equatorial_radius)
    for weights in ("equal", "variance"):
        found, fixed, heard = variances_by_part(*at_cells(d, grid, weights))
        whole = of_map(d, grid, weights)
        assert np.array_equal(fixed, np.isfinite(whole).all(axis=0)) and 8 < fixed.sum() < 70
        assert pytest.approx(whole[:, fixed], rel=3e-5) == found[fixed].sum(axis=2).T
        assert (heard >= 0).all()
        if weights == "equal":
            for part, signal in enumerate(ALONE):
                alone = of_map(design(signal, mask), grid, weights)[:, fixed]
                assert pytest.approx(alone, rel=3e-5, abs=1e-6) == found[fixed, :, part].T


def test_of_each_fix_a_range_is_chosen_and_the_shares_of_all_are_averaged():
    d = design(WHOLE)
    grid = make_grid("equal-angle", 30, d.figure.polar_radius / d.figure.equatorial_radius)
    given = at_cells(d, grid, "variance")
    variances, fixed, heard = variances_by_part(*given)
    seen, total = given[1], heard.sum(axis=2)
    last = fix_budget(*given, np.full(len(seen), 1.0 - 1e-9))
    first = fix_budget(*given, np.zeros(len(seen)))
    for k, t in enumerate(np.flatnonzero(fixed)):
        own = np.flatnonzero(seen[t])
        assert first.range_error[k] == pytest.approx(np.sqrt(total[t, own[0]]))
        assert last.range_error[k] == pytest.approx(np.sqrt(total[t, own[-1]]))
        shares = heard[t, own] / total[t, own, None]
        assert first.of_ranges[k] == pytest.approx(shares.mean(axis=0))
        assert first.of_fixes[k] * variances[t].sum(axis=1)[:, None] == pytest.approx(variances[t])


def budget_of(d, **options):
    return drawn(d, (0.0, 1e5), budget=True, draws=400, **options).budget


def test_shares_add_up_and_a_better_clock_takes_its_share_away():
    d = design(WHOLE)
    made = budget_of(d)
    assert made.of_fixes.sum(axis=2) == pytest.approx(1.0)
    assert made.of_ranges.sum(axis=1) == pytest.approx(1.0)
    after = budget_of(design(replace(WHOLE, clock_sigma=0.3)))
    clock = PARTS.index("clock")
    assert np.all(after.of_fixes.mean(axis=0)[:, clock] < 0.1 * made.of_fixes[..., clock].mean(0))
    assert after.range_error**2 == pytest.approx(made.range_error**2 - 9.0 + 0.09)


def test_correlated_orbit_and_clock_share_what_they_make_together():
    """A clock that is early by what the orbit is high: ranges straight down do not feel them."""
    both = np.zeros((4, 4))
    both[np.ix_([0, 3], [0, 3])] = [[9.0, -9.0], [-9.0, 9.0]]
    made = budget_of(design(Signal(covariance=(tuple(map(tuple, both)),), receiver=Receiver(0.1))))
    assert np.median(made.range_error) < 0.3  # 3 m each, of opposite sign
    assert made.of_ranges[:, 0].mean() == pytest.approx(made.of_ranges[:, 1].mean(), rel=0.03)
    assert made.of_ranges.min() >= 0


def test_a_budget_is_of_some_draws_and_changes_no_other_number(monkeypatch):
    d = design(WHOLE)
    whole, plain = (drawn(d, (0.0, 1e5), draws=400, budget=k) for k in (True, False))
    assert plain.budget is None
    for name, values in plain.values.items():
        assert np.array_equal(values, whole.values[name])
    fixes = int(np.isfinite(plain.values["pdop"]).sum())
    assert whole.budget.range_error.size == fixes
    monkeypatch.setattr("compass.coverage.drawn.BUDGET_SIGHTS", 400 * 9 // 4)
    monkeypatch.setattr("compass.coverage.drawn.PIECE", 9 * 90)
    some = drawn(d, (0.0, 1e5), draws=400, budget=True).budget
    assert 0.1 * fixes < some.range_error.size < 0.5 * fixes
    assert {len(getattr(some, field.name)) for field in fields(some)} == {some.range_error.size}
    for name in ("of_ranges", "of_fixes"):  # of these users the same shares
        kept = {tuple(row.ravel()) for row in getattr(whole.budget, name).round(12)}
        assert {tuple(row.ravel()) for row in getattr(some, name).round(12)} <= kept


def test_without_a_fix_there_are_no_parts():
    made = budget_of(design(WHOLE, satellites=3))
    assert made.range_error.size == 0 and made.of_fixes.shape == (0, 4, 5)


def test_few_fixes_leave_bounds_of_geometry_open():
    """Three fixes of a hundred: no range error is bounded from above, most errors are infinite."""
    errors = np.full(100, np.inf)
    errors[:3] = 20.0, 30.0, 40.0
    made = FixBudget(np.array([4.0, 5.0, 6.0]), np.full((3, 5), 0.2), np.full((3, 4, 5), 0.2))
    drawn = SimpleNamespace(budget=made, values=dict.fromkeys(ERRORS, errors))
    dataset = xr.Dataset(coords={"global_percentile": [1, 50, 95]})
    geometry = _budget(dataset, drawn)["fix_budget"]["error_position_m"]["geometry"]
    assert geometry["p1"] == 4.0
    assert geometry["p1_interval"] == [0.0, np.inf]
    assert geometry["p50_interval"] == geometry["p95_interval"] == [np.inf, np.inf]
