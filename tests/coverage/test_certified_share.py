"""Certified shares against random points, published brackets, and themselves without symmetry."""

import math
from dataclasses import replace

import numpy as np
import pytest

from compass.coverage.certified_domain import domain_of
from compass.coverage.certified_percentile import certified_percentile
from compass.coverage.certified_places import Circle, Spot, Tile
from compass.coverage.certified_question import DOPS
from compass.coverage.certified_share import certified_share
from compass.coverage.region import GLOBE, convex_polygon, latitude_band
from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.orbits import positions_mci, positions_mcmf, walker_delta
from compass.orbits.constellation import keplerian
from compass.sites import Mask, Site

KELLY = FIGURES["kelly2018-sphere"]
ELLIPSOID = FIGURES["iau-ellipsoid"]


def walker(t, p, f, inclination=45.0, radius=20427.0):
    return walker_delta(t, p, f, inclination_deg=inclination, radius_km=radius)


def dilutions(sights, up):
    """All five by inverting the normal matrix, in the order of DOPS."""
    if len(sights) < 4:
        return np.full(5, np.inf)
    rows = np.column_stack([sights, np.ones(len(sights))])
    normal = rows.T @ rows
    if np.linalg.cond(normal) > 1e14:
        return np.full(5, np.inf)
    inverse = np.linalg.inv(normal)
    vertical = up @ inverse[:3, :3] @ up
    position = np.trace(inverse[:3, :3])
    squares = [np.trace(inverse), position, position - vertical, vertical, inverse[3, 3]]
    return np.sqrt(np.maximum(squares, 0.0))


def sampled(constellation, limit, dop, figure, mask, places, times, motion="two-body", fixed=True,
            height=0.0):  # fmt: skip
    """Share of random places and times that keep a limit, with its standard error."""
    positions = positions_mcmf if fixed else positions_mci
    r = positions(constellation, times, motion)
    good = 0
    for k, (latitude, longitude) in enumerate(places):
        site = Site("", latitude, longitude, height, mask, figure)
        seen = site.sees(r[:, k])
        sights = r[seen, k] - site.r_mcmf
        sights /= np.linalg.norm(sights, axis=1, keepdims=True)
        good += dilutions(sights, site.enu_mcmf[2])[DOPS.index(dop)] <= limit
    share = good / len(times)
    return share, math.sqrt(max(share * (1 - share), 1 / len(times)) / len(times))


def on_the_globe(generator, n, south=-np.pi / 2, north=np.pi / 2, west=0.0, east=2 * np.pi):
    sines = generator.uniform(np.sin(south), np.sin(north), n)
    return np.stack([np.arcsin(sines), generator.uniform(west, east, n)], axis=1)


def agrees(found, share, error):
    assert found.low - 5 * error <= share <= found.high + 5 * error


@pytest.mark.slow
@pytest.mark.parametrize(
    ("dop", "bracket"), [("pdop", (0.9736164, 0.9736178)), ("gdop", (0.9707849, 0.9707864))]
)
def test_compass_pattern_meets_brackets_of_an_independent_program(dop, bracket):
    found = certified_share(walker(15, 5, 1), 6.0, dop=dop, figure=KELLY, width=5e-5)
    assert found.low <= bracket[0] <= bracket[1] <= found.high
    assert found.width <= 5e-5
    assert "for all time" in found.scope


@pytest.mark.slow
def test_gdop_tail_that_a_map_does_not_see():
    pattern = walker(15, 5, 1, 55.0, 20428.0)
    found = certified_percentile(
        pattern, 99, figure=KELLY, mask=math.radians(5), dop="gdop", precision=5e-3
    )
    assert 30.0 < found.low <= 30.54 and 30.44 <= found.high < 31.0


@pytest.mark.slow
def test_without_symmetry_the_bracket_holds_the_one_with_it():
    plain = certified_share(walker(9, 3, 1), 8.0, width=0.02, symmetric=False)
    found = certified_share(walker(9, 3, 1), 8.0, width=5e-4)
    assert plain.low <= found.low and found.high <= plain.high
    assert found.boxes < plain.boxes


@pytest.mark.slow
def test_any_workers_give_the_same_bytes_and_finer_goes_on_from_coarser():
    one = certified_share(walker(15, 5, 1), 6.0, width=1e-3)
    two = certified_share(walker(15, 5, 1), 6.0, width=1e-3, workers=2)
    assert (one.low, one.high, one.boxes) == (two.low, two.high, two.boxes)
    assert one.leaves.tobytes() == two.leaves.tobytes()
    finer = certified_share(walker(15, 5, 1), 6.0, width=3e-4, start=one)
    assert one.low <= finer.low <= finer.high <= one.high
    assert finer.width <= 3e-4


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_random_designs_meet_random_points(seed):
    generator = np.random.default_rng(seed)
    planes = int(generator.integers(2, 7))
    pattern = walker(
        planes * int(generator.integers(2, 5)),
        planes,
        int(generator.integers(0, planes)),
        float(generator.uniform(20, 100)),
        float(generator.uniform(6500, 25000)),
    )
    dop, limit = DOPS[seed % 5], float(generator.uniform(1.5, 12))
    mask = Mask.constant(float(np.radians(generator.choice([0, 5, 15]))))
    place = GLOBE if seed % 2 else latitude_band(-0.3, 0.9)
    found = certified_share(pattern, limit, dop=dop, mask=mask, place=place, width=8e-3)
    low, high = (-np.pi / 2, np.pi / 2) if seed % 2 else (-0.3, 0.9)
    where = on_the_globe(generator, 500, low, high)
    times = generator.uniform(0, 2 * np.pi / pattern.mean_motion[0], 500)
    sphere = FIGURES["iau-sphere"]
    agrees(found, *sampled(pattern, limit, dop, sphere, mask, where, times, fixed=False))


def shares_at_random(pattern, limit, dop, mask, north, points, generator):
    """Share of random places within a latitude and phases that keep a limit; its standard error.

    From the elements of circular orbits over a sphere, by no code of the package.
    """
    radius, good = pattern.semi_major_axis[0] / FIGURES["iau-sphere"].equatorial_radius, 0
    raan, place = pattern.raan, pattern.mean_anomaly + pattern.argument_of_periapsis
    tilt = pattern.inclination
    for _ in range(points // 10_000):
        where = on_the_globe(generator, 10_000, -north, north)
        u = place + generator.uniform(0, 2 * np.pi, (10_000, 1))
        across = np.sin(u) * np.cos(tilt)
        r = radius * np.stack(
            [
                np.cos(raan) * np.cos(u) - np.sin(raan) * across,
                np.sin(raan) * np.cos(u) + np.cos(raan) * across,
                np.sin(u) * np.sin(tilt),
            ],
            axis=2,
        )
        b, longitude = where.T
        up = np.stack([np.cos(b) * np.cos(longitude), np.cos(b) * np.sin(longitude), np.sin(b)], 1)
        sights = r - up[:, np.newaxis]
        sights /= np.linalg.norm(sights, axis=2, keepdims=True)
        seen = np.einsum("knx,kx->kn", sights, up) >= math.sin(mask)
        rows = np.concatenate([sights, np.ones((*seen.shape, 1))], axis=2)[seen.sum(1) >= 4]
        rows *= seen[seen.sum(1) >= 4][..., np.newaxis]
        normal = np.swapaxes(rows, 1, 2) @ rows
        inverse = np.linalg.inv(normal[np.linalg.cond(normal) < 1e12])
        squares = np.trace(inverse, axis1=1, axis2=2)
        if dop == "pdop":
            squares = squares - inverse[:, 3, 3]
        good += int((squares <= limit**2).sum())
    share = good / points
    return share, math.sqrt(max(share * (1 - share), 1 / points) / points)


@pytest.mark.slow
def test_a_pattern_whose_symmetry_lattices_follow_meets_random_points():
    pattern, mask, north = walker(28, 28, 21, 58.4), math.radians(15), math.radians(45)
    place = latitude_band(-north, north)
    found = certified_share(pattern, 3.0, mask=mask, place=place, width=2e-4)
    assert found.width <= 2e-4
    generator = np.random.default_rng(1)
    agrees(found, *shares_at_random(pattern, 3.0, "pdop", mask, north, 200_000, generator))


@pytest.mark.slow
def test_a_crowd_of_random_designs_meets_random_points():
    generator, off = np.random.default_rng(7), []
    for _ in range(16):
        planes = int(generator.integers(2, 11))
        pattern = walker(
            planes
            * int(generator.integers(1 + 7 // planes, 1 + max(30 // planes, 1 + 7 // planes))),
            planes,
            int(generator.integers(0, planes)),
            float(generator.uniform(20, 100)),
            float(generator.uniform(4900, 25000)),
        )
        limit, dop = float(generator.uniform(2, 20)), ("gdop", "pdop")[int(generator.integers(2))]
        mask, north = math.radians(generator.uniform(0, 15)), float(generator.uniform(0.3, 1.57))
        place = latitude_band(-north, north)
        found = certified_share(pattern, limit, dop=dop, mask=mask, place=place, width=2e-3)
        share, error = shares_at_random(pattern, limit, dop, mask, north, 10_000, generator)
        beyond = max(found.low - share, share - found.high, 0.0)
        off.append(beyond / error)
    # of 16 normal deviates 99.9 % stay within 4.1, and their squares together below 40
    assert max(off) < 4.1 and np.square(off).sum() < 40


def test_users_below_the_figure_are_users_of_a_smaller_sphere():
    """The floor of Hellas, 7 km deep: its own sphere has the same share."""
    pattern = walker(15, 5, 1, 45.0, 20427.0)
    sphere, deep = FIGURES["iau-sphere"], -7000.0
    radius = sphere.equatorial_radius
    smaller = replace(sphere, equatorial_radius=radius + deep, polar_radius=radius + deep)
    asked = {"place": latitude_band(-0.8, -0.7), "mask": 0.1, "width": 1e-2}
    one = certified_share(pattern, 6.0, figure=sphere, height=deep, **asked)
    two = certified_share(pattern, 6.0, figure=smaller, **asked)
    assert one.low <= two.high and two.low <= one.high
    assert abs(one.value - two.value) < 1e-5  # the same boxes, but for rounding
    with pytest.raises(ArgumentError, match=r"height = -30000 m: must be -20000 or more"):
        certified_share(pattern, 6.0, height=-3e4)


@pytest.mark.slow
def test_fine_brackets_lie_in_those_without_symmetry_and_coarser_ones():
    pattern = walker(12, 3, 1, 63.0, 15000.0)
    mask, place = math.radians(10), latitude_band(-0.4, 0.4)
    fine = certified_share(pattern, 5.0, mask=mask, place=place, width=1e-5)
    assert fine.width <= 1e-5
    plain = certified_share(pattern, 5.0, mask=mask, place=place, width=2e-2, symmetric=False)
    assert plain.low <= fine.low and fine.high <= plain.high
    near = shares_at_random(pattern, 5.0, "pdop", mask, 0.4, 50_000, np.random.default_rng(3))
    agrees(fine, *near)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_other_motions_meet_random_points(seed):
    generator = np.random.default_rng(seed)
    n = 9
    orbits = keplerian(
        np.full(n, 16e6) if seed == 0 else generator.uniform(12e6, 20e6, n),
        generator.uniform(0, 0.3, n),
        generator.uniform(0.5, 1.5, n),
        generator.uniform(0, 6.28, n),
        generator.uniform(0, 6.28, n),
        generator.uniform(0, 6.28, n),
    )
    drifting = seed == 2
    hours = None if seed == 0 else 20.0
    found = certified_share(
        orbits,
        7.0,
        figure=ELLIPSOID,
        width=0.03,
        duration=None if hours is None else hours * 3600,
        motion="j2" if drifting else "two-body",
    )
    last = 2 * np.pi / orbits.mean_motion[0] if hours is None else hours * 3600
    times = generator.uniform(0, last, 1500)
    where = on_the_globe(generator, 1500)
    motion = "j2" if drifting else "two-body"
    share = sampled(orbits, 7.0, "pdop", ELLIPSOID, Mask(), where, times, motion, fixed=False)
    agrees(found, *share)


HILLS = Mask((0.0, 1.0, 2.5, 4.0), (0.05, 0.3, 0.0, 0.2))


@pytest.mark.slow
@pytest.mark.parametrize("dop", DOPS)
def test_a_place_behind_hills_meets_random_moments(dop):
    generator = np.random.default_rng(5)
    pattern, spot = walker(15, 5, 1), Spot(0.7, 1.1)
    hours = 24.0
    found = certified_share(
        pattern,
        3.5,
        dop=dop,
        figure=ELLIPSOID,
        mask=HILLS,
        place=spot,
        duration=hours * 3600,
        width=1e-4,
    )
    times = generator.uniform(0, hours * 3600, 2000)
    where = np.full((2000, 2), (spot.latitude, spot.longitude))
    agrees(found, *sampled(pattern, 3.5, dop, ELLIPSOID, HILLS, where, times))


@pytest.mark.slow
def test_tiles_and_polygons_that_turn_with_mars_meet_random_points():
    generator = np.random.default_rng(6)
    pattern, hours = walker(9, 3, 1), 5.0
    south, north, west, east = 0.2, 0.8, 1.0, 1.9
    where = on_the_globe(generator, 3000, south, north, west, east)
    times = generator.uniform(0, hours * 3600, 3000)
    options = {"mask": 0.05, "duration": hours * 3600, "width": 0.01}
    tile = certified_share(pattern, 6.0, place=Tile(south, north, west, east), **options)
    sphere, mask = FIGURES["iau-sphere"], Mask.constant(0.05)
    agrees(tile, *sampled(pattern, 6.0, "pdop", sphere, mask, where, times))
    triangle = convex_polygon([0.1, 0.1, 0.9], [1.0, 2.0, 1.4])
    found = certified_share(pattern, 6.0, place=triangle, **options)
    where = on_the_globe(generator, 30000, 0.0, 1.0, 0.9, 2.1)
    directions = np.stack(
        [
            np.cos(where[:, 0]) * np.cos(where[:, 1]),
            np.cos(where[:, 0]) * np.sin(where[:, 1]),
            np.sin(where[:, 0]),
        ],
        axis=1,
    )
    where = where[triangle.contains(directions)][:3000]
    times = times[: len(where)]
    agrees(found, *sampled(pattern, 6.0, "pdop", sphere, mask, where, times))


@pytest.mark.slow
def test_a_circle_is_the_mean_of_its_places():
    pattern = walker(12, 3, 1)
    circle = certified_share(pattern, 5.0, place=Circle(0.6), width=1e-4)
    generator = np.random.default_rng(7)
    where = np.stack([np.full(6000, 0.6), generator.uniform(0, 2 * np.pi, 6000)], axis=1)
    times = generator.uniform(0, 2 * np.pi / pattern.mean_motion[0], 6000)
    sphere = FIGURES["iau-sphere"]
    agrees(circle, *sampled(pattern, 5.0, "pdop", sphere, Mask(), where, times, fixed=False))


def test_domains_say_what_they_stand_for():
    pattern = walker(15, 5, 1)
    torus = domain_of(pattern, KELLY)
    assert "for all time" in torus.scope and torus.slack < 1e-10
    assert np.allclose(torus.sides[:, 1] - torus.sides[:, 0], [np.pi / 2, 2 * np.pi, np.pi / 15])
    band = domain_of(pattern, KELLY, latitude_band(-0.5, 0.5), mirrored=False)
    assert np.allclose(band.sides[:, 1] - band.sides[:, 0], [1.0, 2 * np.pi, 2 * np.pi / 15])
    cap = domain_of(pattern, KELLY, latitude_band(0.5, np.pi / 2), symmetric=False)
    assert np.allclose(cap.sides, [[0.5, np.pi / 2], [0, 2 * np.pi], [0, 2 * np.pi]])
    # two planes by four: the turn of half a revolution leaves the phase alone
    assert domain_of(walker(8, 2, 0), KELLY).sides[1, 1] == pytest.approx(np.pi)
    tilted = keplerian(16e6, 0.1, 1.0, np.arange(5.0), 0.3, np.arange(5.0))
    assert "no symmetry" in domain_of(tilted, KELLY).scope
    drifting = domain_of(tilted, KELLY, motion="j2", duration=3600.0)
    assert "J2" in drifting.scope and "1 h" in drifting.scope
    assert np.all(drifting.orbits[:, 7] != 0) and drifting.circles.size == 0
    triangle = convex_polygon([0.1, 0.1, 0.9], [1.0, 2.0, 1.4])
    assert domain_of(pattern, KELLY, triangle, duration=3600.0).normals.shape == (3, 3)
    assert domain_of(pattern, KELLY, Tile(0.1, 0.4, 1.0, 2.0), closed=True).sides[1].tolist() == [
        1.0,
        2.0,
    ]
    mixed = keplerian(np.array([16e6, 17e6] * 3), 0.0, 1.0, np.arange(6.0), 0.0, 0.0)
    assert "h from the epoch" in domain_of(mixed, KELLY).scope


def test_fewer_than_four_satellites_keep_no_limit():
    found = certified_share(walker(3, 3, 0), 6.0)
    assert (found.low, found.high) == (0.0, 0.0)
    assert "fewer than four" in found.scope


def test_without_time_the_bracket_is_all_that_is_possible():
    found = certified_share(walker(5, 5, 1), 6.0, place=Circle(0.2), budget_s=0.0)
    assert found.stopped == "time"
    assert (found.low, found.high) == (0.0, 1.0)
    assert found.value == 0.5


def test_an_interrupted_search_gives_the_bracket_it_has(monkeypatch):
    from compass.coverage import certified_rounds as module

    def interrupted(leaves, *_):
        if len(leaves):
            raise KeyboardInterrupt
        return np.zeros(5), leaves

    monkeypatch.setattr(module, "refine", interrupted)
    found = certified_share(walker(5, 5, 1), 6.0, place=Circle(0.2))
    assert found.stopped == "interrupted"
    assert (found.low, found.high) == (0.0, 1.0)


@pytest.mark.parametrize(
    ("mask", "height", "limit"),
    [(0.1, 0.0, 4.0), (Mask((0.0, 2.0), (0.1, 0.2)), 0.0, 4.5), (-0.3, 3e5, 1.2),
     (-1.45, 3e7, 4.8)],
)  # fmt: skip
def test_moments_at_a_place_meet_random_ones(mask, height, limit):
    """On the ground, in a low orbit past whose horizon one looks, and above the satellites."""
    pattern, spot, hours = walker(12, 3, 1), Spot(0.3, 0.4), 6.0
    options = {"mask": mask, "place": spot, "duration": hours * 3600, "height": height}
    found = certified_share(pattern, limit, width=0.05, **options)
    times = np.random.default_rng(3).uniform(0, hours * 3600, 300)
    horizon = mask if isinstance(mask, Mask) else Mask.constant(mask)
    where = np.full((300, 2), (0.3, 0.4))
    sphere = FIGURES["iau-sphere"]
    agrees(found, *sampled(pattern, limit, "pdop", sphere, horizon, where, times, height=height))
    assert 0.3 < found.value < 0.7


def test_percentiles_stop_for_want_of_time_and_at_infinity():
    few = certified_percentile(walker(3, 3, 0), 50)
    assert few.low == few.high == few.value == np.inf
    late = certified_percentile(walker(5, 5, 1), 50, place=Circle(0.2), budget_s=0.0)
    assert (late.low, late.high, late.stopped) == (0.0, np.inf, "time")


@pytest.mark.slow
def test_a_percentile_that_no_limit_reaches_is_infinite_from_the_last_limit_on():
    rare = certified_percentile(walker(5, 5, 1), 95)
    assert (rare.low, rare.high, rare.stopped) == (1e5, np.inf, "")


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"limit": 0.5}, "limit = 0.5"),
        ({"dop": "xdop"}, "dop = 'xdop'"),
        ({"width": 0.0}, "width = 0"),
        ({"duration": 0.0}, "duration_h = 0"),
        ({"place": Circle(2.0)}, "latitude_deg"),
        ({"place": Tile(0.5, 0.2, 0.0, 1.0)}, "tile"),
    ],
)
def test_what_cannot_be_asked_is_refused(change, match):
    options = {"limit": 6.0, **change}
    with pytest.raises(ArgumentError, match=match):
        certified_share(walker(5, 5, 1), options.pop("limit"), **options)


def test_orbits_inside_the_planet_and_none_at_all_are_refused():
    low = keplerian(np.full(5, 4e6), 0.5, 1.0, np.arange(5.0), 0.0, np.arange(5.0))
    with pytest.raises(ArgumentError, match="inside the planet"):
        certified_share(low, 6.0)
    with pytest.raises(ArgumentError, match="altitude_km = 17030: among the satellites"):
        certified_share(keplerian(np.full(5, 2e7), 0.1, 1.0, 0.0, 0.0, np.arange(5.0)), 6.0,
                        height=1.703e7)  # fmt: skip
    with pytest.raises(ArgumentError, match="no satellite"):
        certified_share(walker(5, 5, 1).without(range(5)), 6.0)
    for percent in (0, 100):
        with pytest.raises(ArgumentError, match="percent"):
            certified_percentile(walker(5, 5, 1), percent)
    with pytest.raises(ArgumentError, match="precision"):
        certified_percentile(walker(5, 5, 1), 50, precision=0)


@pytest.mark.slow
def test_a_place_under_closed_tracks_is_not_its_circle():
    """An independent program says 0.9456 at the worst place of +-60 deg and 0.9916 on its circle."""
    pattern = walker_delta(17, 17, 3, inclination_deg=44.2, orbit="areosynchronous")
    mask, latitude, longitude = math.radians(5), math.radians(32), math.radians(14)
    circle = certified_share(pattern, 6.0, mask=mask, place=Circle(latitude), width=1e-5)
    assert circle.low == pytest.approx(0.9916, abs=2e-4)
    spot = Spot(latitude, longitude)
    place = certified_share(pattern, 6.0, mask=mask, place=spot, closed=True, width=1e-5)
    assert place.high == pytest.approx(0.9456, abs=1e-3)
    # where tracks are not said to close, a place stands for its circle
    open_ = certified_share(pattern, 6.0, mask=mask, place=spot, width=1e-5)
    assert (open_.low, open_.high) == (circle.low, circle.high)
    generator, day = np.random.default_rng(2), 2 * np.pi / pattern.mean_motion[0]
    horizon, sphere = Mask.constant(mask), FIGURES["iau-sphere"]
    where = np.full((4000, 2), (latitude, longitude))
    times = generator.uniform(0, day, 4000)
    agrees(place, *sampled(pattern, 6.0, "pdop", sphere, horizon, where, times))
    where[:, 1] = generator.uniform(0, 2 * np.pi, 4000)
    agrees(circle, *sampled(pattern, 6.0, "pdop", sphere, horizon, where, times))
