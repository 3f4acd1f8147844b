"""Windows against brute-force sampling, closed forms, limits and invariances."""

import numpy as np
import pytest
from access_twin import covered, in_shadow, positions, ray_clear, station_sees
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from compass.bodies import (
    ASTRONOMICAL_UNIT,
    MARS_ROTATION_RATE,
    SOLAR_DAY,
    SUN_RADIUS,
    sidereal_day,
)
from compass.contacts.nodes import (
    MAX_SOLS,
    Node,
    earth_node,
    find_node,
    moon_node,
    satellite_nodes,
    station_node,
    sun_node,
)
from compass.contacts.radio import node_states
from compass.contacts.windows import UMBRA_LENGTH, eclipses, windows
from compass.errors import ArgumentError
from compass.frames import FIGURES, mcmf_from_mci, prime_meridian_angle
from compass.orbits import areosynchronous_radius, keplerian, states_mci, walker_delta
from compass.planets import sun_earth_mci
from compass.sites import Mask, Site

SPHERE, ELLIPSOID = FIGURES["iau-sphere"], FIGURES["iau-ellipsoid"]
R = SPHERE.equatorial_radius
SPAN = 4 * 3600.0
TIMES = np.arange(0.0, SPAN, 1.0)
MODEST = settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])

angle = st.floats(0, 2 * np.pi)
orbit = st.tuples(
    st.floats(3.45e6, 3e7), st.floats(0, 0.7), st.floats(0, np.pi), angle, angle, angle
)


@st.composite
def constellations(draw, size=2):
    elements = []
    for q, e, *angles in draw(st.lists(orbit, min_size=size, max_size=size)):
        elements.append([q / (1 - e), e, *angles])
    return keplerian(*np.array(elements).T, epoch=draw(st.floats(-1e9, 1e9)))


@st.composite
def masks(draw):
    if draw(st.booleans()):
        return Mask.constant(draw(st.floats(0, 1.5)))
    azimuths = sorted(set(draw(st.lists(st.integers(0, 359), min_size=2, max_size=8))))
    elevations = draw(st.lists(st.floats(0, 1.5), min_size=len(azimuths), max_size=len(azimuths)))
    return Mask(tuple(np.radians(azimuths).tolist()), tuple(elevations))


@st.composite
def sites(draw):
    return Site(
        "site",
        draw(st.floats(-np.pi / 2, np.pi / 2)),
        draw(st.floats(-np.pi, np.pi)),
        draw(st.floats(-5e3, 2e4)),
        draw(masks()),
        draw(st.sampled_from([SPHERE, ELLIPSOID])),
    )


@MODEST
@given(constellations(), sites())
def test_station_windows_equal_one_second_sampling(constellation, site):
    station = station_node(site, constellation.epoch, SPAN)
    pairs = [(station, satellite) for satellite in satellite_nodes(constellation)]
    seen = station_sees(constellation, site, TIMES)
    for found, sampled in zip(windows(pairs, SPAN), seen, strict=True):
        inside, clear = covered(found.spans, TIMES)
        np.testing.assert_array_equal(inside[clear], sampled[clear])
        assert np.all(found.start < found.end)
        assert np.all(found.end[:-1] < found.start[1:])


@MODEST
@given(constellations(), st.sampled_from([SPHERE, ELLIPSOID]), st.floats(0, 4e4))
def test_satellite_links_equal_one_second_sampling(constellation, figure, height):
    one, two = satellite_nodes(constellation)
    assume(min(one.lowest, two.lowest) > figure.equatorial_radius + height)
    (found,) = windows([(one, two)], SPAN, figure=figure, atmosphere_height=height)
    p, q = positions(constellation, TIMES)
    sampled = ray_clear(p, q, figure.equatorial_radius + height, figure.polar_radius + height)
    inside, clear = covered(found.spans, TIMES)
    np.testing.assert_array_equal(inside[clear], sampled[clear])


@MODEST
@given(constellations(1), st.booleans())
def test_eclipses_equal_ten_second_sampling(constellation, total):
    sun = sun_node(constellation.epoch, SPAN)
    (found,) = eclipses(satellite_nodes(constellation), sun, SPAN, total=total)
    coarse = TIMES[::10]
    p = positions(constellation, coarse)[0]
    s = sun_earth_mci(constellation.epoch, coarse)[0][:, :3]
    sampled = in_shadow(p, s, R, SUN_RADIUS.value, total)
    inside, clear = covered(found.spans, coarse, slack=0.05)  # the Sun is tabulated to 1 km
    np.testing.assert_array_equal(inside[clear], sampled[clear])


@MODEST
@given(constellations(1), sites())
@pytest.mark.slow
def test_culmination_is_the_highest_sampled_elevation(constellation, site):
    station = station_node(site, constellation.epoch, SPAN)
    (found,) = windows([(station, satellite_nodes(constellation)[0])], SPAN)
    relative = node_states(satellite_nodes(constellation)[0], TIMES)[:, :3]
    fixed = mcmf_from_mci(relative, prime_meridian_angle(constellation.epoch, TIMES))
    elevation, _ = site.elevation_azimuth(fixed)
    for k in range(found.count):
        within = elevation[covered(found.spans[k : k + 1], TIMES)[0]]
        assert found.max_elevation[k] >= within.max(initial=-2.0) - 1e-7
        assert found.start[k] <= found.culmination[k] <= found.end[k]


@MODEST
@given(constellations(2), angle)
def test_links_do_not_change_when_everything_turns(constellation, turn):
    """A common rotation about the pole: of all nodes for links, and with the site's longitude."""
    c = constellation
    turned = keplerian(
        c.semi_major_axis, c.eccentricity, c.inclination, c.raan + turn,
        c.argument_of_periapsis, c.mean_anomaly, epoch=c.epoch,
    )  # fmt: skip
    results = []
    for design, longitude in ((c, 0.3), (turned, 0.3 + turn)):
        one, two = satellite_nodes(design)
        station = station_node(Site("s", 0.4, longitude, mask=Mask.constant(0.1)), c.epoch, SPAN)
        results.append(windows([(one, two), (station, one), (station, two)], SPAN, figure=SPHERE))
    for before, after in zip(*results, strict=True):
        assert before.count == after.count
        np.testing.assert_allclose(before.spans, after.spans, rtol=0, atol=1e-3)


def test_polar_passes_have_the_closed_form():
    """Over the pole, in sight while ``sin i sin u >= cos lambda``, once a revolution."""
    c = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
    figure = FIGURES["kelly2018-sphere"]
    for mask in (0.0, np.radians(10.0)):
        site = Site("pole", np.pi / 2, 0.0, mask=Mask.constant(mask), figure=figure)
        station = station_node(site, c.epoch, 3 * SOLAR_DAY.value)
        found = windows([(station, s) for s in satellite_nodes(c)], 3 * SOLAR_DAY.value)
        cap = np.arccos(figure.equatorial_radius * np.cos(mask) / 20427e3) - mask
        half = np.arccos(np.cos(cap) / np.sin(np.radians(45)))
        for w in found:
            whole = (w.start > 0) & (w.end < w.duration)
            # 1 cm at each end, at a rate of r n sin i sin(half) = 0.99 km/s or more, and 1e-6 s
            np.testing.assert_allclose(
                w.length[whole], 2 * half / c.mean_motion[0], rtol=0, atol=2.3e-5
            )
            inside = (w.culmination > w.start) & (w.culmination < w.end) & whole
            highest = np.arctan2(
                np.sin(np.radians(45)) - figure.equatorial_radius / 20427e3,
                np.cos(np.radians(45)),
            )
            np.testing.assert_allclose(w.max_elevation[inside], highest, atol=1e-9)
            middle = 0.5 * (w.start + w.end)
            np.testing.assert_allclose(w.culmination[inside], middle[inside], rtol=0, atol=1e-3)


@pytest.mark.slow
def test_a_satellite_exactly_at_the_limb_is_in_view():
    """Two on one circle, apart by twice acos(R/r): the ray touches the sphere for ever."""
    r = 2 * R
    apart = 2 * np.arccos(R / r)
    for extra, share in ((0.0, 1.0), (-1e-6, 1.0), (1e-6, 0.0)):
        c = keplerian(r, 0.0, 0.7, 0.2, 0.0, [0.0, apart + extra])
        (found,) = windows([satellite_nodes(c)], 3600.0, figure=SPHERE)
        assert found.length.sum() == pytest.approx(share * 3600.0)


def test_an_areostationary_satellite_on_the_horizon_is_in_view_for_ever():
    r = areosynchronous_radius()
    c = keplerian(r, 0.0, 0.0, 0.0, 0.0, 0.0)
    day = sidereal_day()
    below = -float(prime_meridian_angle(0.0, 0.0))
    for shift, seen in ((0.0, True), (-1e-5, True), (1e-5, False)):
        site = Site("rim", 0.0, below + np.arccos(R / r) + shift, figure=SPHERE)
        (found,) = windows([(station_node(site, 0.0, day / 50), satellite_nodes(c)[0])], day / 50)
        assert (found.length.sum() > 0) == seen


def test_a_profile_equal_all_around_is_the_constant_mask():
    """The horizon kernel and the elevation kernel are two methods for one question."""
    c = walker_delta(6, 3, 1, inclination_deg=57.3, radius_km=6000)
    flat, bumpy = Mask.constant(0.2), Mask((0.0, 1.0, 2.0), (0.2, 0.2, 0.2 + 1e-12))
    assert not bumpy.is_constant
    for latitude in (0.0, 0.9, np.pi / 2):
        both = []
        for mask in (flat, bumpy):
            station = station_node(Site("s", latitude, 1.0, mask=mask), 0.0, SPAN)
            both.append(windows([(station, s) for s in satellite_nodes(c)], SPAN))
        for one, two in zip(*both, strict=True):
            assert one.count == two.count
            # the cone is met 1 cm early: at most 1e-8 rad of elevation over 1e6 m
            np.testing.assert_allclose(one.spans, two.spans, rtol=0, atol=2e-4)


def test_a_pass_through_the_zenith_of_a_walled_site():
    """All around a wall of 80 degrees but for a gap: only the zenith and the gap are open."""
    c = keplerian(5e6, 0.0, np.pi / 2, 0.0, 0.0, -0.5)
    t = 0.5 / c.mean_motion[0]
    longitude = -float(prime_meridian_angle(0.0, t))
    mask = Mask(tuple(np.radians([0, 90, 180, 270])), tuple(np.radians([80.0, 80.0, 80.0, 79.0])))
    site = Site("well", 0.0, longitude, mask=mask, figure=SPHERE)
    (found,) = windows([(station_node(site, 0.0, 2 * t), satellite_nodes(c)[0])], 2 * t)
    assert found.count == 1
    assert found.max_elevation[0] == pytest.approx(np.pi / 2, abs=2e-3)
    assert found.culmination[0] == pytest.approx(t, abs=10.0)


@pytest.mark.parametrize("eccentricity", [0.0, 0.3])
def test_nodes_move_as_the_ephemeris_says(eccentricity):
    c = keplerian([9e6, 2e7], eccentricity, [0.4, 2.0], [1.0, 2.0], 0.5, 1.0)
    times = np.linspace(0, 3e6, 50)
    for model in ("two-body", "j2"):
        r, v = states_mci(c, times, model)
        for k, node in enumerate(satellite_nodes(c, model)):
            expected = np.concatenate([r[k], v[k]], axis=1)
            np.testing.assert_allclose(node_states(node, times), expected, rtol=1e-9, atol=1e-5)


def test_stations_turn_as_the_prime_meridian_does():
    site = Site("s", 0.5, 2.0, 1e3)
    duration = 30 * SOLAR_DAY.value
    times = np.linspace(0, duration, 301)
    states = node_states(station_node(site, 7e8, duration), times)
    angles = prime_meridian_angle(7e8, times)
    expected = np.stack(
        [
            np.cos(angles) * site.r_mcmf[0] - np.sin(angles) * site.r_mcmf[1],
            np.sin(angles) * site.r_mcmf[0] + np.cos(angles) * site.r_mcmf[1],
            np.full(times.size, site.r_mcmf[2]),
        ],
        axis=1,
    )
    np.testing.assert_allclose(states[:, :3], expected, rtol=0, atol=1e-3)
    speed = MARS_ROTATION_RATE.value * np.hypot(*site.r_mcmf[:2])
    np.testing.assert_allclose(np.linalg.norm(states[:, 3:], axis=1), speed, rtol=1e-6)


def test_the_result_is_the_same_for_every_number_of_threads():
    c = walker_delta(6, 3, 1, inclination_deg=45.8, radius_km=10000)
    station = station_node(Site("s", 0.2, 0.3), 0.0, SPAN)
    pairs = [(station, s) for s in satellite_nodes(c)]
    alone = windows(pairs, SPAN, workers=1)
    for other in (windows(pairs, SPAN, workers=3), windows(pairs, SPAN)):
        for one, two in zip(alone, other, strict=True):
            np.testing.assert_array_equal(one.spans, two.spans)
    assert windows([], SPAN) == []


@pytest.mark.slow
def test_many_windows_of_a_low_orbit():
    """30 sols of a low orbit: more windows than any first guess of memory holds."""
    c = keplerian(3.7e6, 0.0, 1.5, 0.0, 0.0, 0.0)
    duration = 30 * SOLAR_DAY.value
    station = station_node(Site("pole", np.pi / 2, 0.0), 0.0, duration)
    (found,) = windows([(station, satellite_nodes(c)[0])], duration)
    revolutions = duration * c.mean_motion[0] / (2 * np.pi)
    assert abs(found.count - revolutions) <= 1
    sampled = station_sees(c, station.site, np.arange(0, duration, 30.0))[0]
    assert found.length.sum() / duration == pytest.approx(sampled.mean(), rel=1e-3)


@pytest.mark.parametrize("sols", [0.0, -1.0, np.nan, np.inf, 1e9, MAX_SOLS * 1.001])
def test_durations_out_of_range_are_refused(sols):
    with pytest.raises(ArgumentError, match="must be above 0 and at most 1000"):
        windows([], sols * SOLAR_DAY.value)


def test_what_cannot_be_linked_is_refused():
    station = station_node(Site("s", 0.0, 0.0), 0.0, SPAN)
    other = station_node(Site("t", 0.0, 1.0), 0.0, SPAN)
    satellite = satellite_nodes(keplerian(1e7, 0, 0, 0, 0, 0))[0]
    for pair in ((station, other), (satellite, sun_node(0.0, SPAN)), (satellite, satellite)):
        with pytest.raises(ArgumentError, match="cannot be asked for"):
            windows([pair], SPAN)
    low = satellite_nodes(keplerian(3.45e6, 0, 0, 0, 0, 0))[0]
    with pytest.raises(ArgumentError, match=r"not above the limb at 3496\.19 km"):
        windows([(satellite, low)], SPAN, atmosphere_height=1e5)
    with pytest.raises(ArgumentError, match="allowed two-body, j2"):
        satellite_nodes(keplerian(1e7, 0, 0, 0, 0, 0), "numerical")


def test_eclipses_end_where_the_umbra_does():
    far = satellite_nodes(keplerian(1.1e9, 0, 0, 0, 0, 0))
    with pytest.raises(ArgumentError, match="past the tip of Mars's umbra"):
        eclipses(far, sun_node(0.0, SPAN), SPAN)
    nearest = 1.381 * ASTRONOMICAL_UNIT.value  # perihelion
    assert UMBRA_LENGTH < R * nearest / (SUN_RADIUS.value - R) < 1.02 * UMBRA_LENGTH


def test_nodes_are_found_by_name():
    nodes: list[Node] = [moon_node("phobos", 0.0, SPAN), earth_node(0.0, SPAN)]
    assert find_node(nodes, "Earth").kind == "earth"
    with pytest.raises(ArgumentError, match="unknown; there are Phobos, Earth"):
        find_node(nodes, "Moon")
