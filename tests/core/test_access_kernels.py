"""The bounds that the event finder rests on, and the profile's interpolation."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.bodies import SUN_RADIUS
from compass.contacts.nodes import earth_node, moon_node, satellite_nodes, station_node, sun_node
from compass.contacts.radio import node_states
from compass.core.events import curvature, sight
from compass.core.horizon import horizon_clear, horizon_state, profile_elevation
from compass.core.motion import mover_bounds, mover_state
from compass.core.sight import ECLIPSE, ELEVATION, LIMB
from compass.frames import FIGURES
from compass.orbits import keplerian
from compass.sites import Mask, Site

A, B = FIGURES["iau-ellipsoid"].equatorial_radius, FIGURES["iau-ellipsoid"].polar_radius
SPAN = 1e5
EMPTY = np.zeros((1, 6))

angle = st.floats(0, 2 * np.pi)


@st.composite
def satellites(draw):
    q, e = draw(st.floats(3.5e6, 3e7)), draw(st.floats(0, 0.7))
    c = keplerian(q / (1 - e), e, draw(st.floats(0, np.pi)), draw(angle), draw(angle), draw(angle))
    return satellite_nodes(c, draw(st.sampled_from(["two-body", "j2"])))[0]


def pairs(one, two):
    """Kinds of sight that a satellite takes part in, with parameters, movers and table."""
    station = station_node(Site("s", 0.5, 0.3), 0.0, SPAN)
    earth, sun = earth_node(0.0, SPAN), sun_node(0.0, SPAN)
    deimos = moon_node("deimos", 0.0, SPAN)
    limb = np.array([A, A / B, 1e7])
    return [
        (ELEVATION, np.array([0.3]), station.row, one.row, EMPTY),
        (ELEVATION, np.array([0.0]), station.row, earth.row, earth.states),
        (LIMB, limb, one.row, two.row, EMPTY),
        (LIMB, limb, one.row, deimos.row, EMPTY),
        (LIMB, np.array([A, 1.0, 1e11]), one.row, earth.row, earth.states),
        (ECLIPSE, np.array([A, SUN_RADIUS.value, -1.0]), one.row, sun.row, sun.states),
    ]


@settings(deadline=None, max_examples=40)
@given(satellites(), satellites(), st.floats(0, 9e4), st.floats(1.0, 9e3))
def test_curvature_bounds_hold(one, two, start, h):
    """Rates of sight never differ by more than the bound times the time between them."""
    times = np.linspace(start, start + h, 9)
    for kind, numbers, p, q, table in pairs(one, two):
        samples = [sight(kind, numbers, p, q, table, t) for t in times]
        bound = curvature(kind, numbers, p, q, samples[0], samples[-1], h)
        rates = np.array([s[1] for s in samples])
        rounding = 1e-9 * np.abs(rates).max()
        assert np.all(np.abs(np.diff(rates)) <= bound * np.diff(times) + rounding)


@settings(deadline=None, max_examples=40)
@given(satellites(), satellites(), st.floats(1e3, 9e4))
def test_rates_of_sight_are_derivatives(one, two, t):
    for kind, numbers, p, q, table in pairs(one, two):
        h = 0.5
        before, here, after = (sight(kind, numbers, p, q, table, t + s) for s in (-h, 0, h))
        second = curvature(kind, numbers, p, q, before, after, 2 * h)
        if not np.isfinite(second):
            continue
        # off by at most K h / 2 where the second derivative is bounded, and by rounding
        slope = (after[0] - before[0]) / (2 * h)
        scale = abs(here[0]) + np.linalg.norm(mover_state(q, table, t)[:3])
        assert slope == pytest.approx(here[1], abs=0.5 * second * h + 1e-14 * scale / h)


@settings(deadline=None, max_examples=40)
@given(satellites(), st.floats(0, 9e4), st.floats(1.0, 9e3))
def test_bounds_on_motion_hold(node, start, h):
    """Distances, speeds and the radial products of samples stay inside the bounds."""
    times = np.linspace(start, start + h, 9)
    states = node_states(node, times)
    r, v = states[:, :3], states[:, 3:]
    distance, speed = np.linalg.norm(r, axis=1), np.linalg.norm(v, axis=1)
    low, high, fastest, acceleration, product, product_rate = mover_bounds(
        node.row, distance[0], distance[-1], h
    )
    tiny = 1e-9
    assert np.all(distance >= low * (1 - tiny))
    assert np.all(distance <= high * (1 + tiny))
    assert np.all(speed <= fastest * (1 + tiny))
    change = np.linalg.norm(np.diff(v, axis=0), axis=1) / np.diff(times)
    assert np.all(change <= acceleration * (1 + 1e-6))
    radial = (r * v).sum(axis=1)
    assert np.all(np.abs(radial) <= product * (1 + tiny) + 1.0)
    assert np.all(np.abs(np.diff(radial)) <= product_rate * np.diff(times) * (1 + tiny) + 10.0)


@settings(deadline=None, max_examples=60)
@given(
    st.sets(st.integers(0, 3599), min_size=1, max_size=8),
    st.lists(st.floats(0, 1.5), min_size=8, max_size=8),
    st.floats(0, 6.283),
)
def test_profiles_are_interpolated_as_the_mask_does(azimuths, elevations, azimuth):
    points = np.radians(np.array(sorted(azimuths)) / 10)
    heights = np.array(elevations[: len(points)])
    mask = Mask(tuple(points.tolist()), tuple(heights.tolist()))
    rows = np.concatenate([[[9.0, 9.0]], np.stack([points, heights], axis=1), [[9.0, 9.0]]])
    found = profile_elevation(rows, 1, len(points), azimuth)
    assert found == pytest.approx(float(mask.at(azimuth)), abs=1e-9)


@settings(deadline=None, max_examples=40)
@given(satellites(), st.floats(0, 9e4), st.floats(1.0, 2e3))
def test_what_is_called_clear_of_a_profile_is(node, start, h):
    """Where the bound says that no edge is crossed, samples agree in sign."""
    mask = Mask((0.0, 2.0, 4.0), (0.1, 0.9, 0.3))
    site = Site("s", 0.3, 1.0, mask=mask)
    station = station_node(site, 0.0, SPAN)
    rows = np.stack([mask.azimuth, mask.elevation], axis=1)
    slope = np.abs(np.diff([0.1, 0.9, 0.3, 0.1]) / np.diff([0, 2.0, 4.0, 2 * np.pi])).max()
    numbers = np.array([0, 3, slope, 0.1, 0.9])
    times = np.linspace(start, start + h, 20)
    samples = [horizon_state(numbers, station.row, node.row, EMPTY, rows, t) for t in times]
    if horizon_clear(numbers, station.row, node.row, samples[0], samples[-1], h):
        assert len({s[0] >= 0 for s in samples}) == 1


def test_a_table_interpolates_a_cubic_exactly():
    """Hermite's cubic through the states of a cubic motion is that motion."""
    t = np.arange(4) * 10.0
    states = np.stack([t**3, t**2, t, 3 * t**2, 2 * t, np.ones(4)], axis=1)
    row = np.zeros(20)
    row[:5] = 2.0, 0.0, 4, 0.0, 10.0
    for at in (0.0, 3.0, 10.0, 17.5, 30.0):
        expected = [at**3, at**2, at, 3 * at**2, 2 * at, 1]
        np.testing.assert_allclose(mover_state(row, states, at), expected, rtol=0, atol=1e-9)
