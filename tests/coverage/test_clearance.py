"""Clearances over horizons against random sampling, proofs with caps, and invariances."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.core.clearance import profile_range
from compass.coverage.certificate import prove_fold
from compass.coverage.clearance import clear_share, least_clearance, polygon_share, worst_share
from compass.coverage.fold_verdict import Course, losses_of
from compass.coverage.region import read_region, read_regions
from compass.coverage.share import mean_fold_shares
from compass.coverage.standing import nth_elevation
from compass.coverage.users import Users, by_horizon, geodetic, region_users, site_users
from compass.errors import ArgumentError
from compass.frames import FIGURES, prime_meridian_angle
from compass.orbits import (
    Constellation,
    positions_mci,
    positions_mcmf,
    states_mci,
    walker_delta,
)
from compass.orbits.motion import Motion
from compass.requirement import Requirement
from compass.sites import Mask, Site

SPHERE, ELLIPSOID = FIGURES["iau-sphere"], FIGURES["iau-ellipsoid"]
R = SPHERE.equatorial_radius


def orbits(elements):
    """A constellation of rows a, e, i, raan, argument of periapsis, mean anomaly (SI)."""
    n = elements.shape[1]
    names = tuple(f"S{k}" for k in range(n))
    return Constellation("any", *elements, satellite_names=names)


def some_orbits(rng, n, one_period=True):
    a = np.full(n, rng.uniform(8e6, 3e7)) if one_period else rng.uniform(8e6, 3e7, n)
    return orbits(
        np.stack(
            [
                a,
                rng.uniform(0, 0.3, n) * (rng.random() < 0.5),
                *rng.uniform(0, np.pi, (1, n)),
                *rng.uniform(0, 2 * np.pi, (3, n)),
            ]
        )
    )


def some_mask(rng):
    azimuths = np.sort(rng.uniform(0, 2 * np.pi, 6))
    return Mask(tuple(azimuths), tuple(rng.uniform(0, 0.4, 6)))


def clearances(c, site, longitude, phase, beam=None):
    """Clearances over a site's horizon at inertial longitudes and phases (n,): by definition.

    With a beam the lesser of these and of how far the site is inside each.
    """
    r, _ = states_mci(c, phase / c.mean_motion[0])
    found = []
    for angle, moment in zip(longitude, np.moveaxis(r, 1, 0), strict=True):
        there = Site("u", site.latitude, float(angle), site.height, site.mask, site.figure)
        elevation, azimuth = there.elevation_azimuth(moment)
        clear = elevation - site.mask.at(azimuth)
        if beam is not None:
            away = moment - there.r_mcmf
            lengths = np.linalg.norm(away, axis=1) * np.linalg.norm(moment, axis=1)
            clear = np.minimum(clear, beam - np.arccos((away * moment).sum(axis=1) / lengths))
        found.append(np.sort(clear)[::-1])
    return np.array(found)


@pytest.mark.slow
@given(
    seed=st.integers(0, 10**6),
    figure=st.sampled_from([SPHERE, ELLIPSOID]),
    above=st.booleans(),
    beam=st.sampled_from([None, 0.15, 0.5]),
)
@settings(max_examples=12, deadline=None)
def test_no_sample_is_below_the_bracket_and_its_place_shows_it(seed, figure, above, beam):
    """Of users near the ground, or above or among the satellites, who look past Mars."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(3, 13))
    c = some_orbits(rng, n)
    height, mask = rng.uniform(0, 3e5), some_mask(rng)
    if above:
        height = rng.uniform(3.5e7, 7e7)
        mask = Mask(mask.azimuth, tuple(np.array(mask.elevation) - 1.45))
    site = Site("a", rng.uniform(-1.5, 1.5), 0.3, height, mask, figure)
    sampled = clearances(c, site, *rng.uniform(0, 2 * np.pi, (2, 300)), beam)
    users = replace(site_users(site).belt(), beam=beam)
    for fold in (1, n // 2 + 1, n):
        found = least_clearance(c, users, fold, tolerance=0.05, most=4000)
        assert found.low <= min(found.high, sampled[:, fold - 1].min() + 1e-9)
        angle = float(prime_meridian_angle(c.epoch, found.time))
        there = clearances(
            c, site, [found.longitude + angle], np.array([found.time * c.mean_motion[0]]), beam
        )
        # straight below, where azimuths say little, the profile is read 1e-8 rad apart
        assert there[0, fold - 1] == pytest.approx(found.high, abs=1e-6)
        assert (there[0] >= 0).sum() == found.seen
        where = found.time, found.latitude, found.longitude
        place = Site("b", *where[1:], height, mask, figure)
        heights, azimuths = place.elevation_azimuth(positions_mcmf(c, [found.time])[:, 0])
        stands = nth_elevation(c, users, fold, *where)
        nearest = np.abs(heights - stands).argmin()
        assert heights[nearest] == pytest.approx(stands, abs=1e-9)
        if beam is None:
            assert stands - mask.at(azimuths[nearest]) == pytest.approx(found.high, abs=1e-6)


@pytest.mark.slow
@given(seed=st.integers(0, 10**6), height=st.sampled_from([0.0, 2e5]))
@settings(max_examples=8, deadline=None)
def test_at_a_place_for_a_span_against_its_own_path(seed, height):
    """Orbits of any periods, a site that turns with Mars: positions from another function."""
    rng = np.random.default_rng(seed)
    c = some_orbits(rng, 5, one_period=False)
    site = Site("a", rng.uniform(-1.5, 1.5), rng.uniform(-3, 3), height, some_mask(rng), ELLIPSOID)
    start, stop = 3e4, 9e4
    found = least_clearance(c, site_users(site), 2, span=(start, stop), tolerance=1e-3)
    times = rng.uniform(start, stop, 2000)
    r = np.moveaxis(positions_mcmf(c, times), 1, 0)
    elevation, azimuth = site.elevation_azimuth(r)
    second = np.sort(elevation - site.mask.at(azimuth), axis=-1)[:, -2]
    # W departs from uniform turning by less than 1e-8 rad in a day
    assert found.low - 1e-6 <= second.min()
    assert found.high == pytest.approx(found.low, abs=1.1e-3)
    assert second.min() < found.high + 0.05
    assert start <= found.time <= stop
    assert found.longitude == pytest.approx(site.longitude)


@pytest.mark.slow
def test_a_site_and_a_polygon_about_it_agree():
    c = walker_delta(8, 4, 1, inclination_deg=50, orbit="areosynchronous")
    site = Site("a", np.radians(20), np.radians(40), figure=SPHERE)
    span = (0.0, 88642.66)
    alone = least_clearance(c, site_users(site), 2, span=span)
    text = "polygon:19.9,39.9;19.9,40.1;20.1,40.1;20.1,39.9"
    about = region_users(read_region(text), SPHERE, Mask())
    around = least_clearance(c, about, 2, span=span, tolerance=1e-3, most=20_000)
    # a place 0.14 degrees off changes an elevation by less than 0.18
    assert around.low <= alone.high
    assert around.high >= alone.low - np.radians(0.2)


@pytest.mark.slow
@pytest.mark.parametrize("text", ["globe", "lat:-45:45", "lat:30:60"])
@pytest.mark.parametrize("figure", [SPHERE, ELLIPSOID])
def test_highest_mask_of_a_belt_is_that_of_caps(text, figure):
    """Two methods that share no kernel: cells between caps, and boxes of places."""
    c = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
    found = least_clearance(c, region_users(read_region(text), figure, Mask()), 4)
    assert found.high - found.low < 1.1e-4
    claim = {"sphere_radius": R, "stretch": figure.stretch, "region": read_region(text)}
    assert prove_fold(c, 4, mask=found.low - 1e-6, **claim).outcome == "proven"
    assert prove_fold(c, 4, mask=found.high + 1e-6, **claim).outcome == "refuted"


@pytest.mark.slow
def test_users_above_the_ground_are_users_of_a_larger_sphere():
    c = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
    dip = -0.9 * float(np.arccos(R / (R + 4e5)))
    found = least_clearance(c, region_users(read_region("globe"), SPHERE, Mask(), height=4e5), 4)
    claim = {"sphere_radius": R + 4e5}
    assert prove_fold(c, 4, mask=found.low - 1e-6, **claim).outcome == "proven"
    assert prove_fold(c, 4, mask=found.high + 1e-6, **claim).outcome == "refuted"
    users = region_users(read_region("globe"), SPHERE, Mask.constant(dip), height=4e5)
    # looking down by the dip gives all of it as room
    assert least_clearance(c, users, 4).low == pytest.approx(found.low - dip, abs=2e-4)


def test_users_above_a_ring_see_a_ring():
    """Who is over the equator sees satellites between the limb and the edge of their beam.

    Seen from the centre of Mars they are away from him by 180 degrees less the angles at him and at
    the satellite: at the limb by ``acos(R/u) + acos(R/r)``.
    """
    r, u, beam = 20e6, 60e6, np.radians(25)
    c = walker_delta(5, 1, 0, inclination_deg=0, radius_km=r / 1e3)
    mask = Mask.constant(-float(np.arccos(R / u)) + 1e-12)
    here = Users("here", 0.0, 0.0, SPHERE, mask, height=u - R, beam=beam)
    near = np.pi - beam - np.arcsin(r * np.sin(beam) / u)
    far = np.arccos(R / u) + np.arccos(R / r)
    share = clear_share(c, here, 1, width=1e-3)
    assert near < far
    assert share.low <= 5 * (far - near) / np.pi <= share.high
    wide = clear_share(c, replace(here, beam=None), 1, width=1e-3)
    assert wide.low == pytest.approx(1.0, abs=1e-3)
    # under them the edge of a beam is a horizon, of all sights and of geometry alike
    under = replace(here, height=0.0, mask=Mask(), beam=np.radians(8))
    raised = by_horizon(under, c)
    assert raised.beam is None
    edge = np.arccos(r * np.sin(under.beam) / R)
    assert raised.mask.lowest == pytest.approx(edge, rel=1e-12)
    for k in (1, 2):
        one, other = (clear_share(c, users, k, width=1e-3) for users in (under, raised))
        assert max(one.low, other.low) <= min(one.high, other.high)
    assert by_horizon(replace(under, beam=1.0), c).mask == Mask()
    # who looks down from above the ground loses nothing by it, down to where beams end past the limb
    above = replace(under, height=4e5, mask=Mask.constant(np.radians(-20)))
    edge = np.arccos(r * np.sin(under.beam) / (R + 4e5))
    assert by_horizon(above, c).mask.lowest == pytest.approx(edge, abs=1e-12)
    exact, same = (clear_share(c, one, 1, width=1e-3) for one in (above, by_horizon(above, c)))
    assert exact.low <= same.high and same.low <= exact.high
    # where none does, the beam stays as it is
    deep = replace(above, beam=np.radians(10.4))
    for users in (deep, here, raised):
        assert by_horizon(users, c) is users
    # forces bend circles: no horizon stands for a beam then
    assert by_horizon(above, c, Motion("j2")) == by_horizon(above, c)
    assert by_horizon(above, c, Motion("numerical")) is above


def test_shares_of_a_belt_against_exact_areas_and_of_a_circle_against_samples():
    c = walker_delta(6, 3, 1, inclination_deg=50, radius_km=20427)
    exact = mean_fold_shares(c, sphere_radius=R).share[2:].sum()
    globe = region_users(read_region("globe"), SPHERE, Mask())
    found = clear_share(c, globe, 2, width=0.2, most=4000)
    assert found.low <= exact <= found.high
    site = Site("a", 0.7, 0.0, mask=some_mask(np.random.default_rng(2)), figure=SPHERE)
    at = clear_share(c, site_users(site).belt(), 3, width=0.05, most=4000)
    longitude, phase = np.random.default_rng(3).uniform(0, 2 * np.pi, (2, 2000))
    mean = (clearances(c, site, longitude, phase)[:, 2] >= 0).mean()
    assert at.low - 0.05 < mean < at.high + 0.05  # 4.5 sigma of 2000 draws


@pytest.mark.slow
def test_the_share_of_a_polygon_for_ever_against_samples():
    """Of a triangle wide in the north, where fewer see two: its belts weigh by their width."""
    c = walker_delta(6, 3, 1, inclination_deg=20, radius_km=20000)
    users = region_users(
        read_region("polygon:0,0;60,-40;60,40"), SPHERE, Mask.constant(np.radians(10))
    )
    found = polygon_share(c, users, 2, width=0.2)
    assert found.high - found.low <= 0.2
    rng = np.random.default_rng(1)
    # by rejection: a wedge of longitudes about the triangle, of equal area everywhere
    z, longitude = rng.uniform(0, 1, 40_000), rng.uniform(-0.8, 0.8, 40_000)
    across = np.sqrt(1 - z * z)
    points = np.stack([across * np.cos(longitude), across * np.sin(longitude), z], axis=1)
    places = points[users.region.contains(points)][:4000]
    assert len(places) == 4000
    turn, phase = rng.uniform(0, 2 * np.pi, (2, 4000))
    away = np.arctan2(places[:, 1], places[:, 0]) + turn
    flat = np.hypot(places[:, 0], places[:, 1])
    places = np.stack([flat * np.cos(away), flat * np.sin(away), places[:, 2]], axis=1)
    r = np.moveaxis(positions_mci(c, phase / c.mean_motion[0]), 1, 0)
    sight = r - SPHERE.equatorial_radius * places[:, np.newaxis]
    up = (sight * places[:, np.newaxis]).sum(-1) / np.linalg.norm(sight, axis=-1)
    kept = ((up >= np.sin(np.radians(10))).sum(axis=1) >= 2).mean()
    spread = 5 * np.sqrt(kept * (1 - kept) / 4000)
    assert found.low - spread <= kept <= found.high + spread
    # its latitudes all alike have another share
    belt = clear_share(c, users.belt(), 2, width=0.05)
    assert not belt.low <= kept <= belt.high
    assert polygon_share(c, users, 7).high == 0.0


@pytest.mark.slow
def test_seconds_bring_the_share_of_a_span_nearer_about_samples():
    """Of users in a triangle that turns with Mars: parts of the time together make the whole."""
    c = walker_delta(9, 3, 1, inclination_deg=50, radius_km=12000)
    (region,) = read_regions("polygon:0,0;20,10;0,40")
    users, span = region_users(region, SPHERE, Mask.constant(0.15)), (3e4, 6e4)
    few = clear_share(c, users, 3, span=span, most=20_000)
    more = clear_share(c, users, 3, span=span, seconds=1.0)
    rng = np.random.default_rng(5)
    places = rng.normal(size=(200_000, 3))
    places /= np.linalg.norm(places, axis=1, keepdims=True)
    places = places[region.contains(places)]
    seen = []
    for time, place in zip(rng.uniform(*span, len(places)), places, strict=True):
        up = positions_mcmf(c, [time])[:, 0] - R * place
        seen.append((up @ place / np.linalg.norm(up, axis=1) >= np.sin(0.15)).sum() >= 3)
    sampled, sigma = np.mean(seen), 0.5 / np.sqrt(len(seen))
    assert more.low - 4 * sigma <= sampled <= more.high + 4 * sigma
    assert few.low <= more.low <= more.high <= few.high and more.boxes > few.boxes
    assert more.high - more.low < 0.7 * (few.high - few.low)


@pytest.mark.slow
def test_the_worst_latitude_has_the_least_share():
    c = walker_delta(6, 3, 1, inclination_deg=50, radius_km=20427)
    belt = region_users(read_region("lat:-30:60"), SPHERE, Mask())
    found, latitude = worst_share(c, belt, 3, width=0.1, most=30_000)
    for b in np.radians([-30, 0, 20, 45, 60]):
        circle = replace(belt, south=b, north=b)
        assert found.low <= clear_share(c, circle, 3, width=0.05, most=3000).high
    assert belt.south <= latitude <= belt.north
    at = clear_share(c, replace(belt, south=latitude, north=latitude), 3, width=0.02)
    assert at.low <= found.high
    told, _ = worst_share(c, belt, 3, level=0.01, most=300_000)
    assert told.low >= 0.01 or told.high < 0.01


@pytest.mark.slow
def test_a_ring_over_the_equator_is_known_by_hand():
    """Nine at 40 degrees: over one of them the fourth nearest stands 80 degrees away."""
    c = walker_delta(9, 1, 0, inclination_deg=0, radius_km=20427.7)
    belt = region_users(read_region("lat:-15:15"), SPHERE, Mask())
    away = np.arccos(np.cos(np.radians(15)) * np.cos(np.radians(80)))
    wanted = np.arctan2(np.cos(away) - R / 20427.7e3, np.sin(away))
    found = least_clearance(c, belt, 4)
    assert found.low <= wanted + 1e-9
    assert found.high >= wanted - 1e-9
    assert found.holds is True


def test_a_horizon_open_to_one_side_counts_by_azimuth():
    """A wall to the south of 89 degrees: of a ring over the equator a northern site sees none."""
    c = walker_delta(24, 1, 0, inclination_deg=0, radius_km=20427)
    wall = np.radians([0, 90.0, 90.1, 269.9, 270]), np.radians([0, 0, 89, 89, 0])
    mask = Mask(*(tuple(x.tolist()) for x in wall))
    north, south = (site_users(Site("a", b, 0.0, mask=mask, figure=SPHERE)) for b in (0.5, -0.5))
    assert least_clearance(c, north.belt(), 1, enough=0.0, most=2000).holds is False
    assert least_clearance(c, south.belt(), 5, enough=0.0, most=2000).holds is True


def test_what_hangs_on_a_hair_stays_open():
    """One satellite over the equator, seen from the pole at exactly the lowest mask allowed."""
    c = walker_delta(1, 1, 0, inclination_deg=0, radius_km=20000)
    pole = Site("a", np.pi / 2, 0.0, figure=SPHERE)
    elevation = float(pole.elevation_azimuth(np.array([2e7, 0.0, 0.0]))[0])
    users = Users("pole", np.pi / 2, np.pi / 2, SPHERE)
    found = least_clearance(c, users, 1)
    assert found.low <= elevation <= found.high + 1e-12
    assert found.holds is False


@given(
    seed=st.integers(0, 10**6),
    azimuth=st.floats(-3.2, 3.2),
    turn=st.floats(0, 3.3),
    points=st.integers(1, 7),
)
@settings(max_examples=60, deadline=None)
def test_range_of_a_profile_is_what_dense_sampling_finds(seed, azimuth, turn, points):
    rng = np.random.default_rng(seed)
    azimuths = np.sort(rng.uniform(0, 2 * np.pi, points))
    elevations = rng.uniform(0, 1, points)
    mask = Mask(tuple(azimuths.tolist()), tuple(elevations.tolist()))
    bottom, top = profile_range(azimuths, elevations, azimuth, turn)
    around = azimuth + np.linspace(-turn, turn, 2001)
    nodes = azimuths[np.abs(np.mod(azimuths - azimuth + np.pi, 2 * np.pi) - np.pi) <= turn]
    sampled = mask.at(np.concatenate([around, nodes]))
    assert bottom <= sampled.min() + 1e-12
    assert top >= sampled.max() - 1e-12
    if turn < np.pi:
        assert bottom == pytest.approx(sampled.min(), abs=1e-9)
        assert top == pytest.approx(sampled.max(), abs=1e-9)


def test_bad_claims_are_told():
    c = walker_delta(3, 1, 0, inclination_deg=0, radius_km=20000)
    users = site_users(Site("a", 0.0, 0.0, figure=SPHERE))
    with pytest.raises(ArgumentError, match="fold = 0: must be a whole number from 1 on"):
        least_clearance(c, users, 0)
    mixed = orbits(np.array([[1e7, 2e7], *np.zeros((5, 2))]))
    with pytest.raises(ArgumentError, match="orbits of different periods: a claim for ever"):
        least_clearance(mixed, users, 1)
    low = orbits(np.array([[3e6], [0.1], *np.zeros((4, 1))]))
    with pytest.raises(ArgumentError, match=r"comes down to 2700 km, inside Mars of 3396.19 km"):
        least_clearance(low, users, 1)
    down = replace(users, height=2.1e5, mask=Mask.constant(-0.4))
    with pytest.raises(
        ArgumentError, match=r"below the limb of Mars as seen from 210 km; allowed from -19"
    ):
        least_clearance(c, down, 1)
    with pytest.raises(ArgumentError, match="revolutions, more than 5000"):
        least_clearance(c, users, 1, span=(0.0, 1e9))
    assert least_clearance(c, users, 4).high == -np.inf
    assert clear_share(c, users, 4).high == 0.0
    assert worst_share(c, users, 4)[0].high == 0.0
    assert geodetic(np.pi / 2, ELLIPSOID) == np.pi / 2


def test_the_worst_place_of_a_region_has_the_least_share_under_closed_tracks():
    """Of all places that a grid finds in a polygon, at dense moments of one repeat."""
    c = walker_delta(6, 3, 1, inclination_deg=50, orbit="areosynchronous")
    (part,) = read_regions("polygon:0,0;0,40;40,0")
    users = region_users(part, SPHERE, Mask())
    span = (0.0, 88642.66)
    found, latitude = worst_share(c, users, 2, span=span, level=0.999, most=20_000)
    assert users.south <= latitude <= users.north and found.low <= found.high
    r = np.moveaxis(positions_mcmf(c, np.linspace(*span, 500)), 1, 0)
    shares = []
    for b, lon in ((0.0, 0.0), (0.0, 40.0), (40.0, 0.0), (20.0, 19.9)):
        site = Site.of("p", latitude_deg=b, longitude_deg=lon, figure=SPHERE)
        shares.append((site.sees(r).sum(axis=1) >= 2).mean())
    # a moment of 500 is off by one at each of some twenty rises and sets
    assert found.low <= min(shares) + 0.04
    assert found.high < 0.999 or found.low >= 0.999


@pytest.mark.slow  # interpreted, the exact answer has no more boxes
def test_many_satellites_have_an_answer_too_in_wider_bounds(monkeypatch):
    c = walker_delta(60, 6, 1, inclination_deg=50, radius_km=20000)
    users = region_users(read_region("globe"), SPHERE, Mask.constant(0.1))
    exact = least_clearance(c, users, 4)
    monkeypatch.setattr("compass.coverage.clearance.MOST_SIGHTS", 60 * 300)
    found = least_clearance(c, users, 4)
    assert found.boxes < 2 * 300 < exact.boxes  # it ends a little past them
    assert found.low <= exact.low <= exact.high <= found.high and found.low < exact.low


def test_losses_of_many_unlike_satellites_are_refused_before_any_proof(monkeypatch):
    monkeypatch.setattr("compass.coverage.fold_verdict.MOST_LEFT", 30)
    c = some_orbits(np.random.default_rng(3), 6)
    wanted = Requirement("four", regions=("globe",), fold=1, losses=1)
    course = Course((0.0, 60.0), False, "")
    with pytest.raises(ArgumentError, match=r"four: losses = 1: 6 sets .* allowed up to 5 sets"):
        next(losses_of(c, wanted, (), course))
    monkeypatch.setattr("compass.coverage.fold_verdict.MOST_LEFT", 36)
    assert len(list(losses_of(c, wanted, (), course))) == 6
    with pytest.raises(ArgumentError, match=r"four: losses = 7: allowed 0 to 6"):
        next(losses_of(c, replace(wanted, losses=7), (), course))
