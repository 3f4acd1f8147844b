"""GeoJSON as other programs read it: areas on Mars, winding, cuts, the CRS."""

import json
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import CRS, Geod
from shapely.geometry import LineString, Point, shape

from compass.coverage.cap import cap
from compass.coverage.gap import gap, spherical_polygon
from compass.frames import direction
from compass.handover.geojson import CORNERS, _circle, _polygons, geojson
from compass.handover.instants import sample_times
from compass.inputs import read_design, read_design_text
from compass.orbits import positions_mcmf

R = 3396.19e3


def chord_loss(half_angle, edge, count):
    """Area between arcs of a small circle and their chords, in steradians.

    An arc of geodesic curvature k = cot(lambda) and length s leaves k s^3 / 12 to its chord.
    """
    return count * edge**3 / (12 * np.tan(half_angle))


def read(design, hours=None):
    times = sample_times(design.constellation, hours)
    return json.loads(geojson(design, times))


def features(collection, kind):
    return [f for f in collection["features"] if f["properties"]["kind"] == kind]


def area(feature, radius=R):
    """Signed area by geodesics on the sphere, of every part; counter-clockwise is positive."""
    geometry = shape(feature["geometry"])
    geod = Geod(a=radius, b=radius)
    parts = getattr(geometry, "geoms", [geometry])
    areas = [geod.geometry_area_perimeter(part)[0] for part in parts]
    assert min(areas) > 0
    return sum(areas)


def cut_error(feature):
    """Bound of what straight lines in longitude and latitude do to the cut edges, steradians.

    An edge of length s at latitude b bends from a great circle by at most s^2 tan(b) / 8. Where
    a ring is cut, the new corner is off by that, over one edge on either side.
    """
    geometry = shape(feature["geometry"])
    total = 0.0
    for part in getattr(geometry, "geoms", [geometry]):
        ring = np.radians(part.exterior.coords)
        cut = np.flatnonzero(np.abs(np.abs(ring[:, 0]) - np.pi) < 1e-12)
        u = direction(ring[:, 1], ring[:, 0])
        edges = np.linalg.norm(np.diff(u, axis=0), axis=1)
        longest = edges[edges < 0.1].max()
        latitude = np.abs(ring[cut, 1])
        tangent = np.tan(np.minimum(latitude, np.pi / 2 - longest))
        total += float((longest**3 * np.maximum(tangent, 1)).sum())
    return total


@pytest.mark.parametrize(
    "name", ["compass-15-5-1.toml", "draim-four.toml", "areostationary-trio.toml"]
)
def test_footprints_hold_the_area_of_their_caps(designs, name):
    design = read_design(designs / name)
    radius = design.figure.equatorial_radius
    collection = read(design, 1.0)
    footprints = features(collection, "footprint")
    assert len(footprints) == design.constellation.size
    r = positions_mcmf(design.constellation, [0.0])[:, 0]
    for feature, place in zip(footprints, r, strict=True):
        geometry = cap(np.linalg.norm(place), radius, design.mask.lowest)
        edge = 2 * np.pi * np.sin(geometry.half_arc) / CORNERS
        loss = chord_loss(geometry.half_arc, edge, CORNERS)
        missing = (geometry.area - area(feature, radius)) / radius**2
        # the next term of the series is (s / sin lambda)^2 smaller
        assert abs(missing - loss) < 1e-3 * loss + cut_error(feature)
        assert feature["properties"]["area_km2"] == pytest.approx(geometry.area / 1e6)
        assert shape(feature["geometry"]).is_valid


@given(st.floats(-1.57, 1.57), st.floats(-np.pi, np.pi), st.floats(np.radians(2), np.radians(88)))
def test_circles_anywhere_hold_the_area_of_their_caps(latitude, longitude, half_angle):
    if abs(abs(latitude) + half_angle - np.pi / 2) < 2e-3:
        return  # a rim through the pole: which side the pole is on is a matter of rounding
    outline = _circle(direction(latitude, longitude), half_angle)
    geometry = _polygons(spherical_polygon(outline))
    feature = {"geometry": geometry}
    assert shape(geometry).is_valid
    exact = 2 * np.pi * (1 - np.cos(half_angle))
    loss = chord_loss(half_angle, 2 * np.pi * np.sin(half_angle) / CORNERS, CORNERS)
    # coordinates are rounded to 1e-9 deg, on a rim shorter than 2 pi
    missing = exact - area(feature) / R**2
    assert abs(missing - loss) < 2e-3 * loss + cut_error(feature) + 2 * np.pi * 2e-11


@pytest.mark.parametrize("per_plane", [3, 4])
def test_gaps_hold_their_exact_area(per_plane):
    t = 2 * per_plane
    design = read_design_text(
        f'name = "g"\n[constellation]\npattern = "walker-delta"\nsatellites = {t}\nplanes = 2\n'
        "phasing = 1\ninclination_deg = 50\nradius_km = 20428\n[coverage]\nmask_deg = 3\n"
    )
    gaps = features(read(design, 1.0), "gap")
    assert [f["properties"]["plane"] for f in gaps] == [1, 1, 2, 2]
    geometry = gap(20428e3, R, per_plane, np.radians(3.0))
    for feature in gaps:
        assert shape(feature["geometry"]).is_valid
        found = area(feature) / R**2
        exact = geometry.area / R**2
        assert feature["properties"]["area_km2"] == pytest.approx(geometry.area / 1e6)
        # the sides bend inwards, so chords add; every edge is at most one 60th of a side
        side = 2 * np.arccos(np.cos(geometry.vertex) / np.sin(geometry.half_arc))
        mean = side * np.sin(geometry.half_arc) / 60
        least = chord_loss(geometry.half_arc, mean, 60 * per_plane)
        assert found > exact
        # equal steps about the plane's pole are unequal ones about the satellite: by less than
        # the cosine of the corner's half angle either way
        most = least / np.cos(np.pi / per_plane) ** 6
        assert least * 0.999 - cut_error(feature) < found - exact < most + cut_error(feature)


def test_the_crs_is_mars(designs):
    collection = read(read_design(designs / "compass-15-5-1.toml"), 1.0)
    crs = CRS.from_user_input(collection["crs"]["properties"]["name"])
    assert crs.to_authority() == ("IAU_2015", "49900")
    assert crs.ellipsoid.semi_major_metre == 3396190
    assert collection["metadata"]["sphere_radius_m"] == 3396200.0
    assert "not WGS 84" in collection["metadata"]["note"]
    # members that RFC 7946, 7.1 forbids a collection
    assert not {"coordinates", "geometries", "geometry", "properties"} & set(collection)
    identities = [f["id"] for f in collection["features"]]
    assert len(set(identities)) == len(identities)
    for feature in collection["features"]:
        assert set(feature) == {"type", "id", "properties", "geometry"}
        assert feature["properties"]["body"] == "Mars"
        assert feature["properties"]["crs"] == collection["crs"]["properties"]["name"]


def test_points_are_under_the_satellites_and_in_their_footprints(designs):
    design = read_design(designs / "compass-15-5-1.toml")
    collection = read(design, 1.0)
    r = positions_mcmf(design.constellation, [0.0])[:, 0]
    points = features(collection, "satellite")
    for point, place, footprint in zip(points, r, features(collection, "footprint"), strict=True):
        lon, lat = point["geometry"]["coordinates"]
        np.testing.assert_allclose(
            direction(np.radians(lat), np.radians(lon)), place / np.linalg.norm(place), atol=2e-11
        )
        assert shape(footprint["geometry"]).contains(Point(lon, lat))


def test_ground_tracks_are_cut_at_the_antimeridian(designs):
    design = read_design(designs / "relay-orbiters.toml")
    c = design.constellation
    times = sample_times(c, 30.0)
    collection = json.loads(geojson(design, times))
    tracks = features(collection, "ground track")
    assert len(tracks) == c.size
    r = positions_mcmf(c, times)
    for track, places in zip(tracks, r, strict=True):
        lines = [np.array(line) for line in track["geometry"]["coordinates"]]
        lon = np.degrees(np.arctan2(places[:, 1], places[:, 0]))
        crossings = int((np.abs(np.diff(lon)) > 180).sum())
        assert crossings >= 2
        assert len(lines) == crossings + 1
        # every sample is there, and two more points a cut
        assert sum(map(len, lines)) == times.size + 2 * crossings
        for line in lines:
            assert np.abs(line[:, 0]).max() <= 180
            assert np.abs(np.diff(line[:, 0])).max() < 180
            assert LineString(line).is_valid
        for before, after in pairwise(lines):
            assert abs(before[-1, 0]) == 180
            assert after[0, 0] == -before[-1, 0]
            assert after[0, 1] == before[-1, 1]


def test_a_satellite_that_stands_still_has_no_track(designs):
    collection = read(read_design(designs / "areostationary-trio.toml"))
    assert features(collection, "ground track") == []
    assert len(features(collection, "satellite")) == 3


def test_explicit_elements_and_open_planes_have_no_gaps(designs):
    assert features(read(read_design(designs / "draim-four.toml"), 1.0), "gap") == []
    low = read_design_text(
        'name = "low"\n[constellation]\npattern = "walker-star"\nsatellites = 4\nplanes = 2\n'
        "phasing = 1\ninclination_deg = 90\naltitude_km = 400\n"
    )
    assert features(read(low, 1.0), "gap") == []
