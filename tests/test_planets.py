"""Earth and Sun as seen from Mars, against published dates and two other theories."""

from datetime import datetime

import numpy as np
import pytest

from compass.bodies import ASTRONOMICAL_UNIT, SPEED_OF_LIGHT
from compass.contacts.nodes import earth_node, sun_node
from compass.contacts.radio import node_states
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY, seconds_past_j2000
from compass.planets import (
    conjunction_seasons,
    sun_earth_mars_angle,
    sun_earth_mci,
    sun_earth_states,
)

# E. M. Standish, Keplerian elements for approximate positions of the major planets, JPL, Table 1
# (1800 to 2050): a, e, i, L, longitudes of perihelion and node, and their rates a century
STANDISH = {
    "earth": (
        [1.00000261, 0.01671123, -0.00001531, 100.46457166, 102.93768193, 0.0],
        [0.00000562, -0.00004392, -0.01294668, 35999.37244981, 0.32327364, 0.0],
    ),
    "mars": (
        [1.52371034, 0.09339410, 1.84969142, -4.55343205, -23.94362959, 49.55953891],
        [0.00001847, 0.00007882, -0.00813131, 19140.30268499, 0.44441088, -0.29257343],
    ),
}
TILT = np.radians(84381.448 / 3600)
TO_EQUATOR = np.array(
    [[1, 0, 0], [0, np.cos(TILT), -np.sin(TILT)], [0, np.sin(TILT), np.cos(TILT)]]
)


def standish(body, seconds):
    """Heliocentric position in au, ICRF."""
    t = seconds / (36525 * SECONDS_PER_DAY)
    values, rates = (np.array(row)[:, None] for row in STANDISH[body])
    a, e, i, longitude, perihelion, node = values + rates * t
    i, longitude, perihelion, node = np.radians([i, longitude, perihelion, node])
    m = longitude - perihelion
    anomaly = m
    for _ in range(30):
        anomaly = m + e * np.sin(anomaly)
    x, y = a * (np.cos(anomaly) - e), a * np.sqrt(1 - e * e) * np.sin(anomaly)
    w = perihelion - node
    u, v = x * np.cos(w) - y * np.sin(w), x * np.sin(w) + y * np.cos(w)
    ecliptic = np.stack(
        [
            np.cos(node) * u - np.sin(node) * np.cos(i) * v,
            np.sin(node) * u + np.cos(node) * np.cos(i) * v,
            np.sin(i) * v,
        ],
        axis=-1,
    )
    return ecliptic @ TO_EQUATOR.T


def separation(a, b):
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(axis=-1))


def test_directions_agree_with_a_second_theory():
    """Standish's elements err by up to 40 (Mars) and 20 (Earth) arcseconds about the Sun.

    At the smallest distances, 0.37 au, those are (40 1.38 + 20) / 0.37 = 203 arcseconds from
    Mars to the Earth, and the centre of the Earth is up to 9 more from the barycentre's; most of
    the time it is far less.
    """
    seconds = np.arange(0.0, 50 * 365.25, 5.0) * SECONDS_PER_DAY
    sun, earth = sun_earth_states(seconds)
    other_earth, other_mars = standish("earth", seconds), standish("mars", seconds)
    to_sun = np.degrees(separation(sun[:, :3], -other_mars)) * 3600
    to_earth = np.degrees(separation(earth[:, :3], other_earth - other_mars)) * 3600
    assert np.median(to_sun) < 40
    assert to_sun.max() < 120  # 3 of the quoted errors
    assert np.median(to_earth) < 60
    assert to_earth.max() < 212


# oppositions: 2020-10-13 23 h, 2022-12-08 06 h, 2025-01-16 03 h UT (U.S. Naval Observatory,
# Astronomical Phenomena); an opposition is in ecliptic longitude
@pytest.mark.parametrize(
    "when", [datetime(2020, 10, 13, 23), datetime(2022, 12, 8, 6), datetime(2025, 1, 16, 3)]
)
def test_oppositions_come_when_published(when):
    """To an hour: rounding of half an hour, and light time of 3 to 5 minutes."""
    middle = seconds_past_j2000(when)
    seconds = middle + np.arange(-3 * 3600, 3 * 3600, 60.0)
    sun, earth = sun_earth_states(seconds)
    earth_from_sun, mars_from_earth = earth - sun, -earth
    longitudes = [
        np.arctan2(*(v[:, :3] @ TO_EQUATOR).T[[1, 0]]) for v in (earth_from_sun, mars_from_earth)
    ]
    gap = np.angle(np.exp(1j * (longitudes[0] - longitudes[1])))
    assert gap.min() < 0 < gap.max()
    found = seconds[np.abs(gap).argmin()]
    assert abs(found - middle) < 3600


# NASA's pauses in commanding, "when Mars is within 2 degrees of the Sun" (first and last day)
@pytest.mark.parametrize(
    ("begin", "end"),
    [
        (datetime(2019, 8, 28), datetime(2019, 9, 7)),
        (datetime(2021, 10, 2), datetime(2021, 10, 14)),
        (datetime(2023, 11, 11), datetime(2023, 11, 25)),
    ],
)
def test_conjunction_seasons_are_nasas_pauses(begin, end):
    """To two days: the pauses are planned by the day, with a margin."""
    epoch = seconds_past_j2000(begin) - 60 * SECONDS_PER_DAY
    begins, ends = conjunction_seasons(epoch, 120 * SECONDS_PER_DAY, np.radians(2.0))
    assert len(begins) == 1
    assert abs(epoch + begins[0] - seconds_past_j2000(begin)) < 2 * SECONDS_PER_DAY
    assert abs(epoch + ends[0] - seconds_past_j2000(end)) < 2 * SECONDS_PER_DAY


def test_seasons_are_cut_at_the_ends_of_the_span():
    epoch = seconds_past_j2000(datetime(2023, 11, 18))
    day = SECONDS_PER_DAY
    begins, ends = conjunction_seasons(epoch, 1.5 * day, np.radians(2.0))
    np.testing.assert_array_equal([begins, ends], [[0.0], [1.5 * day]])
    begins, ends = conjunction_seasons(epoch, 30 * day, np.radians(2.0))
    assert begins[0] == 0
    assert np.degrees(sun_earth_mars_angle(epoch + ends[0])[0]) == pytest.approx(2.0, abs=1e-4)
    assert conjunction_seasons(epoch + 100 * day, 30 * day, np.radians(2.0))[0].size == 0


def test_angles_of_the_triangle():
    """The three angles of Sun, Earth and Mars add up to 180 degrees."""
    seconds = np.linspace(0, 1e9, 40)
    sun, earth = sun_earth_states(seconds)
    at_sun = separation(-sun[:, :3], (earth - sun)[:, :3])
    at_mars = separation(sun[:, :3], earth[:, :3])
    total = sun_earth_mars_angle(seconds) + at_mars + at_sun
    np.testing.assert_allclose(total, np.pi, atol=1e-9)


@pytest.mark.parametrize("make", [earth_node, sun_node])
def test_tabulated_positions_are_the_theorys(make):
    epoch, duration = 8e8, 40 * SECONDS_PER_DAY
    times = np.linspace(0, duration, 333)
    sun, earth = sun_earth_mci(epoch, times)
    expected = earth if make is earth_node else sun
    states = node_states(make(epoch, duration), times)
    assert (
        np.linalg.norm(states[:, :3] - expected[:, :3], axis=1).max() < 2e4
    )  # plan94 speeds err by 2 m/s
    assert np.linalg.norm(states[:, 3:] - expected[:, 3:], axis=1).max() < 4.0


def test_the_earth_is_where_brahes_sun_is():
    """The Sun from the Earth, by brahe's low-precision formula, good to an arcminute.

    That formula (Montenbruck and Gill 2000, sec. 3.3.2) keeps the perihelion still against J2000
    and so drifts by 12 arcseconds a year; 2000 and 2001 are compared.
    """
    brahe = pytest.importorskip("brahe")
    for year in (2000, 2001):
        when = brahe.Epoch.from_datetime(year, 6, 1, 0, 0, 0.0, 0.0, brahe.TimeSystem.TT)
        sun, earth = sun_earth_states(seconds_past_j2000(datetime(year, 6, 1)))
        ours, theirs = (sun - earth)[0, :3], np.array(brahe.sun_position(when))
        assert separation(ours, theirs) < np.radians(1 / 60)
        assert np.linalg.norm(ours) == pytest.approx(np.linalg.norm(theirs), rel=1e-3)
        assert 0.98 < np.linalg.norm(ours) / ASTRONOMICAL_UNIT.value < 1.02


def test_times_outside_the_theories_are_refused():
    with pytest.raises(ArgumentError, match="1900 to 2100"):
        sun_earth_states(4e9)


def test_light_time_and_aberration_are_within_the_stated_accuracy():
    """They turn the Earth's direction by the transverse relative speed over that of light."""
    _, earth = sun_earth_states(np.arange(0.0, 50 * 365.25, 5.0) * SECONDS_PER_DAY)
    r, v = earth[:, :3], earth[:, 3:]
    along = (v * r).sum(axis=1, keepdims=True) / (r * r).sum(axis=1, keepdims=True)
    across = np.linalg.norm(v - along * r, axis=1)
    assert np.degrees(across.max() / SPEED_OF_LIGHT.value) * 3600 < 39
