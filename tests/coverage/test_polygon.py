"""Polygons of any shape in convex parts: areas, membership, and what is refused."""

from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.coverage.polygon import convex_parts
from compass.errors import ArgumentError
from compass.frames import direction, latitude_longitude


def area(corners):
    """Of a spherical triangle fan, steradians (l'Huilier)."""
    total = 0.0
    for b, c in pairwise(corners[1:]):
        a = corners[0]
        det = a @ np.cross(b, c)
        total += 2 * np.arctan2(det, 1 + a @ b + b @ c + c @ a)
    return total


def inside(parts, points):
    """Whether points (n, 3) lie in any part."""
    found = np.zeros(len(points), dtype=bool)
    for part in parts:
        normals = np.cross(part, np.roll(part, -1, axis=0))
        found |= np.all(points @ normals.T >= 0, axis=1)
    return found


def star(seed, corners, inner=0.3):
    """A star-shaped polygon about the origin of the gnomonic plane: never crosses itself."""
    rng = np.random.default_rng(seed)
    angle = (np.arange(corners) + rng.uniform(0.1, 0.9, corners)) * 2 * np.pi / corners
    radius = rng.uniform(inner, 1.0, corners)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)


def turned(flat, rotation):
    points = np.column_stack([flat, np.ones(len(flat))])
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return points @ rotation.T


@given(
    seed=st.integers(0, 10**6),
    corners=st.integers(4, 14),
    clockwise=st.booleans(),
)
@settings(max_examples=40, deadline=None)
def test_parts_are_convex_and_make_the_polygon(seed, corners, clockwise):
    """Against shapely in the plane in which great circles are straight, turned anywhere."""
    rng = np.random.default_rng(seed)
    flat = star(seed, corners)[:: -1 if clockwise else 1]
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    rotation *= np.sign(np.linalg.det(rotation))
    parts = convex_parts(*latitude_longitude(turned(flat, rotation)))
    for part in parts:
        normals = np.cross(part, np.roll(part, -1, axis=0))
        assert np.all(part @ normals.T >= -1e-12)
    probes = rng.uniform(-1.1, 1.1, (400, 2))
    polygon = shapely.Polygon(flat)
    clear = shapely.distance(polygon.boundary, shapely.points(probes)) > 1e-6
    wanted = shapely.contains_xy(polygon, *probes.T)
    assert np.array_equal(inside(parts, turned(probes, rotation))[clear], wanted[clear])
    # no overlap: areas add up to what one fan of signed triangles makes
    assert sum(map(area, parts)) == pytest.approx(abs(area(turned(flat, rotation))), rel=1e-9)


def test_a_convex_polygon_stays_one_and_an_l_becomes_two():
    assert len(convex_parts(np.radians([0, 0, 10, 10]), np.radians([0, 10, 10, 0]))) == 1
    ell = convex_parts(np.radians([0, 0, 5, 5, 10, 10]), np.radians([0, 10, 10, 5, 5, 0]))
    assert len(ell) == 2


def test_poles_and_the_antimeridian_are_places_like_any_other():
    cap = convex_parts(np.radians([70.0] * 4), np.radians([0, 90, 180, 270]))
    assert inside(cap, np.array([[0.0, 0.0, 1.0]])).all()
    across = convex_parts(np.radians([-5, -5, 0, 5, 5]), np.radians([170, -170, 175, -170, 170]))
    assert inside(across, direction(np.radians([0, 4]), np.radians([172, 179]))).all()
    assert not inside(across, direction(np.radians([0, 0]), np.radians([178, 0]))).any()


def test_corners_in_a_line_do_no_harm():
    parts = convex_parts([0.0, 0.0, 0.1], [0.0, 0.1, 0.05])
    more = convex_parts([0.0, 0.0, 0.0, 0.1], [0.0, 0.04, 0.1, 0.05])
    assert sum(map(area, more)) == pytest.approx(sum(map(area, parts)), rel=1e-9)


@pytest.mark.parametrize(
    ("latitudes", "longitudes", "match"),
    [
        ([0, 0], [0, 10], "polygon of 2 corners: allowed 3 to 1000"),
        ([0, 0, 0, 10], [0, 0, 10, 10], "corners 1 and 2 are one place"),
        ([0, 10, 0, 10], [0, 10, 10, 0], "sides after corners 1 and 3 cross or touch"),
        ([0, 0, 10, 0, 10], [0, 20, 20, 10, 0], "cross or touch; order the corners along"),
        ([0, 0, 0], [0, 20, 10], "turns back on itself at corner 2"),
        ([0, 0, 0], [0, 120, 240], "does not fit into the half of the sphere"),
        ([80, -80, 0], [0, 90, 200], "does not fit into the half of the sphere"),
    ],
)
def test_shapes_that_are_none_are_told(latitudes, longitudes, match):
    with pytest.raises(ArgumentError, match=match):
        convex_parts(np.radians(latitudes), np.radians(longitudes))
