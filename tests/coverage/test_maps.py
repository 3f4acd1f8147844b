import os
import time
from functools import partial

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from compass import Design, Mask, Site, walker_delta
from compass.cores import cores
from compass.coverage.count import count_map
from compass.coverage.files import write_map
from compass.coverage.grid import equal_angle_grid, make_grid
from compass.coverage.maps import DOPS, coverage_map
from compass.coverage.site import site_coverage
from compass.coverage.view import view
from compass.errors import ArgumentError
from compass.frames import FIGURES, direction
from compass.orbits import keplerian

R, ORBIT = 3396.2e3, 20427e3
COARSE = make_grid("equal-angle", 15)


def seed(inclination_deg=45.0, **more):
    return walker_delta(15, 5, 1, inclination_deg=inclination_deg, radius_km=ORBIT / 1e3, **more)


def brute(seen, grid, mask_deg=0.0):
    """Counts and DOPs cell by cell, with matrices: shapes (epoch, row, column) and (5, ...)."""
    p = direction(grid.latitude[:, None], grid.longitude)
    sights = seen.r[:, None, None] - p[None, :, :, None]
    sights /= np.linalg.norm(sights, axis=-1, keepdims=True)
    visible = np.einsum("tijsc,ijc->tijs", sights, p) >= np.sin(np.radians(mask_deg))
    counts = visible.sum(-1)
    dops = np.full((5, *counts.shape), np.inf)
    for index in np.argwhere(counts >= 4):
        t, i, j = index
        u = sights[t, i, j][visible[t, i, j]]
        g = np.column_stack([u, np.ones(len(u))])
        normal = g.T @ g
        if np.linalg.cond(normal) > 1e12:
            continue
        q = np.linalg.inv(normal)
        p2, v2 = np.trace(q[:3, :3]), p[i, j] @ q[:3, :3] @ p[i, j]
        dops[:, t, i, j] = np.sqrt([p2 + q[3, 3], p2, p2 - v2, v2, q[3, 3]])
    return counts, dops


@pytest.mark.parametrize("kind", ["equal-angle", "equal-area"])
def test_cells_cover_the_sphere_once(kind):
    grid = make_grid(kind, 10)
    assert grid.cell_share.sum() * grid.columns == pytest.approx(1.0, abs=1e-14)
    assert grid.rows == 18 and grid.columns == 36
    assert np.all(np.diff(grid.latitude) > 0)
    inside = (grid.latitude_edges[:-1] < grid.latitude) & (grid.latitude < grid.latitude_edges[1:])
    assert inside.all()
    if kind == "equal-area":
        np.testing.assert_allclose(grid.cell_share, 1 / (18 * 36), rtol=1e-12)


@pytest.mark.parametrize(
    ("kind", "step", "message"),
    [
        ("equal-angle", 0.0, "allowed 0.05 to 90"),
        ("equal-angle", float("nan"), "allowed 0.05 to 90"),
        ("equal-angle", 7.3, "nearest that fits is 7.2"),
        ("hexagons", 1.0, "allowed equal-angle, equal-area"),
    ],
)
def test_impossible_grids_are_refused(kind, step, message):
    with pytest.raises(ArgumentError, match=message):
        make_grid(kind, step)


@pytest.mark.parametrize("mask_deg", [0.0, 12.0])
def test_map_equals_brute_force_in_every_cell(mask_deg):
    seen = view(seed(), np.linspace(0, 5e4, 3), R, Mask.constant(np.radians(mask_deg)))
    counts, dops = brute(seen, COARSE, mask_deg)
    np.testing.assert_array_equal(count_map(seen, COARSE), counts)
    made = coverage_map(seen, COARSE)
    np.testing.assert_array_equal(made.count_min, counts.min(0))
    np.testing.assert_array_equal(made.count_max, counts.max(0))
    np.testing.assert_allclose(made.count_mean, counts.mean(0), rtol=1e-6)
    for k in (1, 5, 9):
        np.testing.assert_allclose(made.fold_share.sel(fold=k), (counts >= k).mean(0), atol=1e-6)
    for name, values in zip(DOPS, dops, strict=True):
        ranked = np.sort(values, axis=0)
        # nearest rank of three: the second is the median, the third the 95th percentile
        np.testing.assert_allclose(made[name].sel(percentile=50), ranked[1], rtol=1e-5)
        np.testing.assert_allclose(made[name].sel(percentile=95), ranked[2], rtol=1e-5)
    np.testing.assert_allclose(made.availability, (dops[1] <= 6).mean(0), atol=1e-6)


def test_global_numbers_are_weighted_by_area():
    seen = view(seed(), np.linspace(0, 5e4, 4), R)
    counts, dops = brute(seen, COARSE)
    made = coverage_map(seen, COARSE)
    weight = np.broadcast_to(COARSE.cell_share[None, :, None] / 4, counts.shape)
    assert float(made.cells_count_mean) == pytest.approx((counts * weight).sum(), rel=1e-12)
    for k in (4, 6, 8):
        share = weight[counts >= k].sum()
        assert float(made.cells_fold_share.sel(global_fold=k)) == pytest.approx(share, abs=1e-12)
    for name, values in zip(DOPS, dops, strict=True):
        order = np.argsort(values, axis=None)
        cumulative = np.cumsum(weight.ravel()[order])
        for q in (50, 90, 95):
            exact = values.ravel()[order][np.searchsorted(cumulative, q / 100 - 1e-12)]
            found = float(made.cells_dop.sel(dop=name, global_percentile=q))
            neighbours = values[np.isfinite(values)]
            gap = np.abs(np.log(neighbours / exact))
            assert abs(np.log(found / exact)) <= max(5e-4, np.partition(gap, 2)[2] + 5e-4)
    assert float(made.cells_availability) == pytest.approx(weight[dops[1] <= 6].sum(), abs=1e-6)
    np.testing.assert_allclose(
        made.count_mean_time, (counts * COARSE.cell_share[:, None]).sum((1, 2)), rtol=1e-12
    )
    np.testing.assert_array_equal(made.count_min_time, counts.min((1, 2)))
    np.testing.assert_array_equal(made.count_max_time, counts.max((1, 2)))


@pytest.mark.slow
def test_mean_fold_is_the_sum_of_the_caps():
    seen = view(seed(), np.arange(8) * 11000.0, R)
    made = coverage_map(seen, equal_angle_grid(np.radians(1.0)))
    expected = 15 * (1 - np.cos(np.radians(80.429542))) / 2
    assert float(made.cells_count_mean) == pytest.approx(expected, abs=1e-3)


@settings(max_examples=10)
@given(st.integers(-6, 6))
def test_turning_every_node_turns_the_map(columns):
    c, grid = seed(), make_grid("equal-area", 30)
    turn = columns * 2 * np.pi / grid.columns
    turned = keplerian(c.semi_major_axis, 0, c.inclination, c.raan + turn, 0, c.mean_anomaly)
    one, other = (view(x, [0.0], R) for x in (c, turned))
    different = np.roll(count_map(one, grid), columns, axis=2) != count_map(other, grid)
    # rounding may move a cell centre that lies on a rim, and no other
    places = direction(grid.latitude[:, None], grid.longitude)
    beyond = np.einsum("tsc,ijc->tijs", other.directions, places) - other.cos_cap[:, None, None]
    on_a_rim = np.abs(beyond).min(axis=-1) < 1e-13
    assert not np.any(different & ~on_a_rim)
    assert on_a_rim.mean() < 0.1


def test_number_of_threads_does_not_change_a_bit():
    seen = view(seed(), np.linspace(0, 5e4, 3), R)
    one, other = (coverage_map(seen, COARSE, workers=n) for n in (1, 3))
    xr.testing.assert_identical(one, other)


def test_azimuth_dependent_mask_equals_sites_one_by_one():
    mask = Mask(tuple(np.radians([0, 90, 180, 270])), tuple(np.radians([5.0, 25, 5, 15])))
    times = np.array([0.0, 4000.0])
    seen = view(seed(), times, R, mask)
    made = coverage_map(seen, COARSE)
    for i, j in [(0, 0), (3, 11), (6, 20), (11, 5)]:
        site = Site(
            "x",
            COARSE.latitude[i],
            COARSE.longitude[j],
            mask=mask,
            figure=FIGURES["kelly2018-sphere"],
        )
        single = site_coverage(seed(), site, times)
        cell = made.isel(lat=i, lon=j)
        assert int(cell.count_min) == int(single["count"].min())
        assert int(cell.count_max) == int(single["count"].max())
        assert float(cell.gdop.sel(percentile=95)) == pytest.approx(
            float(single.gdop.max()), rel=1e-5
        )
    with pytest.raises(ArgumentError, match="changes with azimuth"):
        count_map(seen, COARSE)


def test_elliptical_orbits_have_caps_that_breathe():
    c = keplerian(8e6, 0.4, 0.6, [0, 2, 4], 0.3, [0, 1, 2])
    seen = view(c, np.linspace(0, 9e3, 4), R)
    assert np.ptp(seen.cos_cap, axis=0).min() > 0.05
    counts, _ = brute(seen, COARSE)
    np.testing.assert_array_equal(count_map(seen, COARSE), counts)


def test_draims_four_satellites_cover_mars_always_and_just_so(designs):
    """Draim 1987: single coverage at all times if the period is long enough (7.06 radii)."""
    import compass

    c = compass.read_design(designs / "draim-four.toml").constellation
    for radii, least in ((7.2, 1), (6.6, 0)):
        scaled = keplerian(
            radii * 3396.19e3, c.eccentricity, c.inclination, c.raan,
            c.argument_of_periapsis, c.mean_anomaly,
        )  # fmt: skip
        period = 2 * np.pi / scaled.mean_motion[0]
        seen = view(scaled, np.arange(60) * period / 60, 3396.19e3)
        assert count_map(seen, make_grid("equal-area", 6)).min() == least


@pytest.mark.parametrize(
    ("options", "message"),
    [({"fold": 0}, "whole number from 1 on"), ({"pdop_threshold": 0.0}, "positive")],
)
def test_impossible_options_are_refused(options, message):
    with pytest.raises(ArgumentError, match=message):
        coverage_map(view(seed(), [0.0], R), COARSE, **options)


@pytest.mark.parametrize("figure", list(FIGURES.values()), ids=lambda f: f.name)
def test_file_is_cf_with_mars_as_grid_mapping(tmp_path, figure):
    from pyproj import CRS

    seen = view(seed(), [0.0, 9000.0], R)
    made = coverage_map(seen, COARSE)
    path = tmp_path / "map.nc"
    write_map(made, path, figure, series=(seen, COARSE))
    with xr.open_dataset(path, engine="h5netcdf") as back:
        assert back.attrs["Conventions"] == "CF-1.11"
        assert back.gdop.attrs["grid_mapping"] == "mars"
        assert back.lat.attrs["standard_name"] == "latitude"
        crs = CRS.from_cf(back.mars.attrs)
        assert crs.ellipsoid.semi_major_metre == figure.equatorial_radius
        assert crs.ellipsoid.semi_minor_metre == pytest.approx(figure.polar_radius)
        for name in back.data_vars:
            if name != "mars":
                assert "units" in back[name].attrs, name
                assert "long_name" in back[name].attrs, name
        np.testing.assert_array_equal(back.count_series, count_map(seen, COARSE))
        np.testing.assert_allclose(
            back.gdop_series.max("time"), made.gdop.sel(percentile=95), rtol=1e-5
        )
    assert [p.name for p in tmp_path.iterdir()] == ["map.nc"]


def test_site_on_the_ellipsoid_sees_by_its_own_normal(seed_design):
    times = np.linspace(0, 8e4, 30)
    site = Site("x", 0.8, 0.3, 2000.0)
    data = site_coverage(seed_design.constellation, site, times)
    assert data["count"].shape == (30,)
    assert int(data["count"].min()) >= 4
    np.testing.assert_array_equal(data["count"], data.visible.sum("satellite"))
    assert np.all(data.gdop**2 == pytest.approx(data.pdop**2 + data.tdop**2))
    assert np.all(data.pdop**2 == pytest.approx(data.hdop**2 + data.vdop**2))


@pytest.mark.slow
def test_positions_come_in_pieces_that_change_nothing_and_hold_little(monkeypatch):
    import tracemalloc

    from compass.coverage import view as module

    c, times = walker_delta(400, 20, 1, inclination_deg=55, radius_km=9000), np.arange(3000) * 30.0
    tracemalloc.start()
    whole = view(c, times, R)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    # position and cap are kept, 32 bytes; a piece at work takes 120 for each of its positions
    assert peak < 1.05 * 32 * c.size * times.size + 130 * module.PIECE
    monkeypatch.setattr(module, "PIECE", 7 * c.size)
    parts = view(c, times[:50], R)
    np.testing.assert_array_equal(parts.r, whole.r[:50])
    np.testing.assert_array_equal(parts.cos_cap, whole.cos_cap[:50])


def test_a_map_that_does_not_fit_is_refused_with_how_much_it_would_take():
    from compass.study.mapping import MapOptions, make_map

    many = Design(walker_delta(10_000, 100, 1, inclination_deg=45, radius_km=20427))
    told = []
    with pytest.raises(
        ArgumentError, match=r"3600 by 7200 cells would take .* GB of memory, there are"
    ):
        make_map(many, MapOptions(step_deg=0.05, epochs=100_000), foretell=told.append)
    assert not told  # it is not begun


def test_who_leaves_a_map_waits_for_the_rows_at_work_and_no_more():
    from compass.coverage.rows import Part, by_threads

    begun = []

    def one_block(rows):
        for i in rows:
            begun.append(i)
            time.sleep(0.001)
        return Part({})

    parts = by_threads(2, lambda rows: None)("counts", one_block, make_grid("equal-angle", 1))
    next(parts)
    parts.close()
    assert 6 <= len(begun) < 60  # of 180


def test_a_thread_a_core_that_may_be_used_unless_asked_otherwise(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda process: {3, 5, 7}, raising=False)
    assert cores() == cores(None) == 3
    assert cores(1) == 1
    monkeypatch.delattr(os, "sched_getaffinity")
    monkeypatch.setattr(os, "cpu_count", lambda: None)
    assert cores() == 1


def test_what_a_map_takes_is_told_before_it_is_begun(capsys):
    from compass.api.progress import foretell
    from compass.orbits.motion import Motion
    from compass.study.map_cost import map_cost

    half = make_grid("equal-angle", 0.5)
    large = map_cost(1000, 10_000, half, 2, Motion())
    assert large.bytes < 1e9
    assert map_cost(1000, 10_000, half, 2, Motion("numerical")).bytes > 1.5 * large.bytes
    alone = map_cost(1000, 10_000, half, 1, Motion(), errors=True)
    assert alone.seconds > 2 * large.seconds
    # who looks down is asked cell by cell, gaps are followed, and levels take a fix a satellite
    few = partial(map_cost, 15, 109, half, 2, Motion())
    bare, down, levels = few(), few(slanted=True), few(errors=True, levels=True)
    # 6.4 times as long was measured, and 2.0 times with errors; of 60 satellites 13 and 2.3 times
    assert 6.4 / 1.3 < down.seconds / bare.seconds < 6.4 * 1.3
    assert 2.0 / 1.3 < few(errors=True).seconds / bare.seconds < 2.0 * 1.3
    many = partial(map_cost, 60, 109, half, 2, Motion())
    assert 13 / 1.3 < many(slanted=True).seconds / many().seconds < 13 * 1.3
    assert 2.3 / 1.3 < many(errors=True).seconds / many().seconds < 2.3 * 1.3
    assert 50 < levels.seconds / few(errors=True).seconds < 150
    assert few(gap_epochs=109 * 100).seconds > 20 * bare.seconds
    foretell(True, "map", large.seconds, large.bytes)
    said = f"map: about {large.seconds / 60:.2g} minutes and {large.bytes / 1e9:.2g} GB\n"
    assert capsys.readouterr().err == said
    foretell(True, "map", 9.0, 1e9)
    foretell(False, "map", large.seconds, large.bytes)
    assert not capsys.readouterr().err
