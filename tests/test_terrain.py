"""Horizons of terrain against marched rays, closed forms and invariances."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import RegularGridInterpolator

from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.sites import Site
from compass.terrain import Terrain, ground, horizon, on_ground

SPHERE, ELLIPSOID = FIGURES["iau-sphere"], FIGURES["iau-ellipsoid"]


def grid(latitude_deg, longitude_deg, height, figure=SPHERE, **more):
    latitude, longitude = np.meshgrid(
        np.radians(latitude_deg), np.radians(longitude_deg), indexing="ij"
    )
    return Terrain(latitude, longitude, np.asarray(height, dtype=float), figure, **more)


def rough(seed, size=25, spread=2.0, figure=ELLIPSOID, latitude=18.4, longitude=77.5):
    """A patch of random hills, rough at the scale of its cells."""
    rng = np.random.default_rng(seed)
    lat = latitude + np.linspace(-spread, spread, size)
    lon = longitude + np.linspace(-spread, spread, size)
    waves = rng.normal(size=(6, 4))
    x, y = np.meshgrid(lat, lon, indexing="ij")
    height = sum(a * np.sin(3 * b * x + 3 * c * y + 6 * d) for a, b, c, d in waves) * 700.0
    return grid(lat, lon, height + 300.0 * rng.normal(size=height.shape), figure)


def site_on(terrain, latitude=18.43, longitude=77.52, above=2.0):
    place = Site("eye", np.radians(latitude), np.radians(longitude), figure=terrain.figure)
    return on_ground(place, terrain, above)


def geodetic(figure, latitude, longitude, height):
    """Places by the radius of curvature in the prime vertical, and east, north and up there.

    Of numbers alone: nothing of the package's own frames and sites is asked.
    """
    a, b = figure.equatorial_radius, figure.polar_radius
    phi, e2 = np.arctan2(a * a * np.sin(latitude), b * b * np.cos(latitude)), 1.0 - (b / a) ** 2
    across = a / np.sqrt(1.0 - e2 * np.sin(phi) ** 2)
    out, high = (across + height) * np.cos(phi), (across * (1.0 - e2) + height) * np.sin(phi)
    r = np.stack([out * np.cos(longitude), out * np.sin(longitude), high], axis=-1)
    s, c, sl, cl = np.sin(phi), np.cos(phi), np.sin(longitude), np.cos(longitude)
    return r, np.array([[-sl, cl, 0.0 * sl], [-s * cl, -s * sl, c], [c * cl, c * sl, s]], object)


def hits(site, terrain, azimuth, elevation):
    """Whether rays of light (n,) from the eye meet any triangle (Moeller and Trumbore 1997).

    Every ray against every triangle, places and axes worked out here.
    """
    eye, axes = geodetic(site.figure, site.latitude, site.longitude, site.height)
    nodes, _ = geodetic(terrain.figure, terrain.latitude, terrain.longitude, terrain.height)
    r = nodes - eye
    a, c = r[:-1, :-1].reshape(-1, 3), r[1:, 1:].reshape(-1, 3)
    met = np.zeros(len(azimuth), dtype=bool)
    flat = np.stack([np.sin(azimuth), np.cos(azimuth)], axis=-1) * np.cos(elevation)[:, None]
    rays = np.column_stack([flat, np.sin(elevation)]) @ axes.astype(float)
    for b in (r[:-1, 1:].reshape(-1, 3), r[1:, :-1].reshape(-1, 3)):
        one, two = b - a, c - a
        p = np.cross(rays[:, None], two)
        with np.errstate(invalid="ignore", divide="ignore"):
            scale = 1.0 / (p * one).sum(-1)
            u = -(p * a).sum(-1) * scale
            q = np.cross(-a, one)
            v = (rays @ q.T) * scale
            t = (two * q).sum(-1) * scale
        met |= ((u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)).any(axis=1)
    return met


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("figure", [SPHERE, ELLIPSOID], ids=lambda f: f.name)
def test_rays_below_the_horizon_meet_the_terrain_and_rays_above_it_do_not(seed, figure):
    terrain = rough(seed, figure=figure)
    eye = site_on(terrain)
    drawn = horizon(eye, terrain, 72)
    assert hits(eye, terrain, drawn.azimuth, drawn.elevation - 1e-9).all()
    assert not hits(eye, terrain, drawn.azimuth, drawn.elevation + 1e-9).any()


@pytest.mark.parametrize(("latitude", "longitude"), [(18.4, 77.5), (18.45, 77.5)])
def test_who_stands_on_a_node_or_an_edge_sees_what_he_sees_a_millimetre_above(latitude, longitude):
    """Rounding told an end of an edge below his feet from him, in any direction, steeply."""
    terrain = rough(1)
    on, above = (
        horizon(site_on(terrain, latitude, longitude, height), terrain, 72)
        for height in (0.0, 1e-3)
    )
    np.testing.assert_allclose(on.elevation, above.elevation, atol=1e-4)
    np.testing.assert_allclose(on.within, above.within, atol=1e-4)


def test_between_azimuths_nothing_stands_above_the_envelope():
    terrain = rough(5)
    eye = site_on(terrain)
    coarse, fine = horizon(eye, terrain, 36), horizon(eye, terrain, 36 * 40)
    assert np.allclose(fine.elevation[::40], coarse.elevation, atol=1e-12)
    sectors = fine.elevation.reshape(36, 40)
    assert np.all(sectors.max(axis=1) <= coarse.within + 1e-12)
    # and the highest of a sector is met to the fineness of the steps
    assert np.all(coarse.within - sectors.max(axis=1) < 0.02)
    safe = coarse.mask(safe=True).at(fine.azimuth)
    assert np.all(safe >= np.maximum(fine.elevation, 0) - 1e-12)
    assert np.any(coarse.mask().at(fine.azimuth) < fine.elevation - 1e-6)


def test_a_bare_sphere_dips_by_its_curvature():
    """Eye h over a sphere: the horizon dips by acos(R/(R + h)); the grid's facets less by little."""
    h, step = 2000.0, 0.02
    axis = np.arange(-3, 3 + step / 2, step)
    terrain = grid(axis, axis, np.zeros((axis.size, axis.size)))
    drawn = horizon(Site("eye", 0.0, 0.0, height=h, figure=SPHERE), terrain, 16)
    radius = SPHERE.equatorial_radius
    sagitta = radius * (1 - np.cos(np.radians(step) / np.sqrt(2)))
    dip = np.arccos(radius / (radius + h))
    assert np.all(-drawn.elevation >= dip - 1e-12)
    assert np.all(-drawn.elevation <= np.arccos((radius - sagitta) / (radius + h)))
    assert drawn.mask().highest == 0.0


def test_one_peak_is_seen_where_it_is():
    """A single node of known height; elsewhere flat ground far below the eye."""
    axis = np.linspace(-1, 1, 41)
    height = np.full((41, 41), -500.0)
    height[20 + 8, 20 + 6] = 4000.0  # 0.4 deg north, 0.3 deg east
    terrain = grid(axis, axis, height)
    eye = Site("eye", 0.0, 0.0, height=0.0, figure=SPHERE)
    peak = Site("peak", np.radians(0.4), np.radians(0.3), height=4000.0, figure=SPHERE)
    elevation, azimuth = eye.elevation_azimuth(peak.r_mcmf)
    drawn = horizon(eye, terrain, 360)
    k = int(np.degrees(azimuth))
    assert drawn.within[k] == pytest.approx(float(elevation), abs=1e-12)
    assert np.argmax(drawn.within) == k and drawn.elevation[(k + 180) % 360] < 0


@given(turn=st.floats(-180, 180), seed=st.integers(0, 5))
@settings(max_examples=10, deadline=None)
def test_turning_terrain_and_eye_about_the_pole_changes_nothing(turn, seed):
    terrain = rough(seed, size=9)
    eye = site_on(terrain)
    turned = Terrain(
        terrain.latitude, terrain.longitude + np.radians(turn), terrain.height, ELLIPSOID
    )
    there = Site(
        "there", eye.latitude, eye.longitude + np.radians(turn), eye.height, figure=ELLIPSOID
    )
    assert np.allclose(
        horizon(eye, terrain, 24).within, horizon(there, turned, 24).within, atol=1e-9
    )


def test_a_grid_around_mars_joins_its_ends_and_rows_in_patches_change_nothing(monkeypatch):
    lat, lon = np.arange(-88, 89, 4.0), np.arange(0, 360, 4.0)
    height = 8000 * np.random.default_rng(2).normal(size=(lat.size, lon.size))
    terrain = grid(lat, lon, height, closed=True)
    eye = on_ground(Site("seam", 0.1, np.radians(358.0), figure=SPHERE), terrain, 1.0)
    drawn = horizon(eye, terrain, 90)
    shifted = grid(lat, lon + 180, np.roll(height, -45, axis=1), closed=True)
    same = horizon(Site("seam", 0.1, np.radians(358.0), eye.height, figure=SPHERE), shifted, 90)
    # a cell is cut along the same diagonal in both
    assert np.allclose(drawn.within, same.within, atol=1e-9)
    monkeypatch.setattr("compass.terrain.PATCH", 300)
    assert np.array_equal(horizon(eye, terrain, 90).within, drawn.within)


def test_ground_lies_on_the_triangles():
    terrain = rough(1, figure=SPHERE)
    latitude, longitude = terrain.latitude[3, 4], terrain.longitude[3, 4]
    node = Site("node", float(latitude), float(longitude), figure=SPHERE)
    assert ground(node, terrain) == pytest.approx(terrain.height[3, 4], abs=1e-6)
    by_lines = RegularGridInterpolator(
        (terrain.latitude[:, 0], terrain.longitude[0]), terrain.height
    )
    middle = terrain.latitude[3, 4], 0.5 * (terrain.longitude[3, 4] + terrain.longitude[3, 5])
    # the chord between two nodes sinks below the figure by its sagitta
    sagitta = SPHERE.equatorial_radius * np.diff(terrain.longitude[0])[0] ** 2 / 8
    assert ground(Site("edge", *map(float, middle), figure=SPHERE), terrain) == pytest.approx(
        float(by_lines(middle).item()), abs=1.1 * sagitta
    )


def test_unknown_heights_hide_nothing():
    terrain = rough(3, figure=SPHERE)
    eye = site_on(terrain)
    holed = terrain.height.copy()
    holed[:8] = np.nan
    part = Terrain(terrain.latitude, terrain.longitude, holed, SPHERE)
    whole = Terrain(terrain.latitude[8:], terrain.longitude[8:], terrain.height[8:], SPHERE)
    assert np.array_equal(horizon(eye, part, 60).within, horizon(eye, whole, 60).within)


def test_bad_places_are_told():
    terrain = rough(0)
    eye = site_on(terrain)
    with pytest.raises(ArgumentError, match=r"azimuths = 3: must be a whole number from 4 on"):
        horizon(eye, terrain, 3)
    with pytest.raises(ArgumentError, match="use one figure for both"):
        horizon(Site("eye", eye.latitude, eye.longitude, eye.height, figure=SPHERE), terrain)
    with pytest.raises(ArgumentError, match=r"m below the terrain of terrain; stand it on"):
        horizon(site_on(terrain, above=-30.0), terrain)
    with pytest.raises(ArgumentError, match=r"far, .*, but some between .*° N and .*° N"):
        on_ground(Site("far", 0.0, 0.0), terrain)
    # straight through Mars from the grid: no height of the other side counts
    with pytest.raises(ArgumentError, match="holds no heights"):
        on_ground(Site("antipode", -eye.latitude, eye.longitude + np.pi), terrain)
