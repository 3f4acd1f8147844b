import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Geod
from scipy.integrate import quad

from compass import Site, walker_delta
from compass.coverage.cap import cap, cap_radius, mask_for_cap, published_cap_area
from compass.coverage.gap import (
    gap,
    gap_circumference,
    gap_polygons,
    plane_closes,
    published_gap_circumference,
)
from compass.coverage.geometry import pattern_geometry
from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.orbits import keplerian, positions_mcmf

R, ORBIT = 3396.2e3, 20427e3
masks = st.floats(0.0, 1.4)
orbits = st.floats(1.001, 50.0)


@given(orbits, masks)
def test_mask_and_cap_are_inverse(ratio, mask):
    lam = cap_radius(ratio * R, R, mask)
    assert mask_for_cap(lam, ratio * R, R) == pytest.approx(mask, abs=1e-7)


@given(st.floats(1.05, 20.0), st.floats(0.0, 1.3))
def test_rim_of_the_cap_sees_the_satellite_at_the_mask(ratio, mask):
    lam = float(cap_radius(ratio * R, R, mask))
    site = Site("rim", 0.0, lam, figure=FIGURES["kelly2018-sphere"])
    elevation, _ = site.elevation_azimuth(np.array([ratio * R, 0.0, 0.0]))
    assert elevation == pytest.approx(mask, abs=1e-8)


def test_published_cap_numbers():
    c = cap(ORBIT, R)
    # spec: computed independently, R = 3396.2 km, r = 20 427 km
    assert np.degrees(c.half_cone) == pytest.approx(9.570458, abs=5e-7)
    assert np.degrees(c.half_arc) == pytest.approx(80.429542, abs=5e-7)
    assert c.tangent == pytest.approx(20142.695e3, abs=0.5)
    assert c.radius == pytest.approx(3348.931e3, abs=0.5)
    assert c.depth == pytest.approx(2831.547e3, abs=0.5)
    assert c.arc == pytest.approx(4767.451e3, abs=0.5)
    assert c.area == pytest.approx(6.042224e13, abs=5e6 * 1e1)
    assert c.fraction == pytest.approx(0.416870, abs=5e-7)
    assert published_cap_area(c) == pytest.approx(7.14697e13, rel=1e-6)


@given(orbits, masks)
def test_cap_closes_its_triangle(ratio, mask):
    c = cap(ratio * R, R, mask)
    # law of sines in the triangle centre - satellite - rim, and half-cone + half-arc + mask = 90
    assert c.half_cone + c.half_arc + mask == pytest.approx(np.pi / 2, abs=1e-7)
    assert c.tangent * np.sin(c.half_cone) == pytest.approx(c.radius, abs=1e-6 * R)


def test_satellite_under_the_surface_is_refused():
    with pytest.raises(ArgumentError, match="above the surface"):
        cap(R, R)


@given(st.floats(1.5, 30.0), st.integers(3, 12), st.floats(0.0, 0.5))
def test_gap_area_equals_quadrature(ratio, sides, mask):
    g = gap(ratio * R, R, sides, mask)
    lam = float(cap_radius(ratio * R, R, mask))
    assert (g is None) == (lam < np.pi / sides)
    if g is None:
        return
    half = np.pi / sides

    def strip(a):
        s = min(1.0, np.cos(lam) / np.cos(a))
        return 1 - np.sqrt(1 - s * s)

    area = 2 * sides * R**2 * quad(strip, 0, half, limit=200)[0]
    # quadrature has a square-root end where the gap reaches the equator of the plane
    assert g.area == pytest.approx(area, rel=1e-6)
    assert g.flat_area == pytest.approx(g.base * g.depth * sides / 2)


def test_published_gap_numbers():
    g = gap(ORBIT, R, 3)
    assert g.depth == pytest.approx(567.288e3, abs=0.5)
    assert g.base == pytest.approx(1965.142e3, abs=0.5)
    assert g.flat_area == pytest.approx(1.672201e12, abs=5e5 * 1e1)
    assert g.area == pytest.approx(1.680403e12, abs=5e5 * 1e1)
    assert g.fraction == pytest.approx(0.0115936, abs=5e-8)
    assert np.degrees(g.vertex) == pytest.approx(19.421842, abs=5e-7)
    i = np.radians(45.0)
    assert published_gap_circumference(g, i) == pytest.approx(13195.2e3, abs=50)
    assert gap_circumference(g, i) == pytest.approx(12370.2e3, abs=50)
    assert np.isnan(gap_circumference(g, 0.1))


def test_planes_that_do_not_close_have_no_polygons():
    assert not plane_closes(float(cap_radius(ORBIT, R)), 2)
    assert gap(ORBIT, R, 2) is None
    assert gap(1.1 * R, R, 3) is None
    assert gap(ORBIT, R, 1) is None


@pytest.mark.parametrize("inclination_deg", [0.0, 45.0, 80.0])
def test_polygons_hold_the_exact_area_and_no_satellite_of_their_plane(inclination_deg):
    from shapely import Point

    c = walker_delta(6, 2, 1, inclination_deg=inclination_deg, radius_km=ORBIT / 1e3)
    r = positions_mcmf(c, [1234.0])[:, 0]
    shapes = gap_polygons(c, r, R)
    exact = gap(ORBIT, R, 3).area
    geod = Geod(a=R, b=R)
    assert len(shapes) == 4
    for n, shape in enumerate(shapes):
        west, south, east, north = shape.bounds
        assert west >= -180 and east <= 180 and south >= -90 and north <= 90
        area = sum(abs(geod.geometry_area_perimeter(part)[0]) for part in shape.geoms)
        # 60 chords a side cut off 3e-5 of the area
        assert area == pytest.approx(exact, rel=1e-4)
        middle = shape.representative_point()
        lon, lat = np.radians([middle.x, middle.y])
        site = Site("m", lat, lon, figure=FIGURES["kelly2018-sphere"])
        plane = n // 2
        assert not site.sees(r[3 * plane : 3 * plane + 3]).any()
        for satellite in r[3 * plane : 3 * plane + 3]:
            lon, lat = np.degrees(np.arctan2(satellite[1], satellite[0])), 0.0
            lat = np.degrees(np.arcsin(satellite[2] / np.linalg.norm(satellite)))
            assert not shape.contains(Point(lon, lat))


def test_explicit_elements_have_no_gap_polygons():
    c = keplerian(ORBIT, 0, 0.5, [0, 1, 2], 0, 0)
    with pytest.raises(ArgumentError, match="use a pattern"):
        gap_polygons(c, positions_mcmf(c, [0.0])[:, 0], R)
    assert pattern_geometry(c, R) is None


def test_planes_without_polygons_give_no_polygons():
    c = walker_delta(4, 2, 1, inclination_deg=40.1, radius_km=ORBIT / 1e3)
    assert gap_polygons(c, positions_mcmf(c, [0.0])[:, 0], R) == []
    g = pattern_geometry(c, R)
    assert g.gap is None
    assert not g.closes
    assert g.plane_area is g.circumference is g.published_circumference is None
    assert g.limit_circumference is g.neighbour_overlap is None


def test_neighbours_overlap_equals_the_lens_of_two_caps():
    g = pattern_geometry(walker_delta(15, 5, 1, inclination_deg=40.1, radius_km=ORBIT / 1e3), R)
    lam, apart = g.cap.half_arc, 2 * np.pi / 3
    # lens of two equal caps: twice (sector - isosceles triangle), by spherical trigonometry
    half = np.arccos(np.tan(apart / 2) / np.tan(lam))  # angle at a centre
    corner = np.arcsin(np.sin(apart / 2) / np.sin(lam))  # half angle at a crossing
    sector = 2 * half * (1 - np.cos(lam))
    triangle = 2 * half + 2 * corner - np.pi
    assert g.neighbour_overlap == pytest.approx(2 * (sector - triangle) * R**2, rel=1e-9)
    six = pattern_geometry(walker_delta(6, 1, 0, inclination_deg=40.1, radius_km=ORBIT / 1e3), R)
    assert six.neighbour_overlap is None
