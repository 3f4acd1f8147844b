"""Phobos and Deimos against published ephemerides."""

import erfa
import numpy as np
import pytest

from compass.bodies import MARS_GM
from compass.contacts.nodes import moon_node
from compass.contacts.radio import node_states
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY, mci_from_icrf
from compass.moons import J2000_FROM_B1950, moon_row

# Lainey, Dehant and Paetzold 2007, Astron. Astrophys. 465:1075 (MarsSatV1_0): the examples of its
# README at ftp.imcce.fr/pub/ephem/satel/martian, au in the J2000 equator, every 10 days from J2000
PHOBOS_AU = [
    [-0.000013308157, -0.000058444725, -0.000021266023],
    [0.000050907508, 0.000033574979, -0.000011296402],
    [-0.000051052809, 0.000012426617, 0.000033811410],
    [0.000011455883, -0.000053566072, -0.000032215644],
    [0.000035899752, 0.000050192828, 0.000004641808],
    [-0.000056181406, -0.000012965245, 0.000024600096],
    [0.000033910062, -0.000038516526, -0.000037325256],
]
DEIMOS_AU = [
    [0.000069313218, -0.000105248430, -0.000093221981],
    [0.000003554238, -0.000139120094, -0.000072183842],
    [-0.000063012999, -0.000139517199, -0.000033799655],
    [-0.000114484040, -0.000106353638, 0.000012773591],
    [-0.000138399541, -0.000047650734, 0.000056274718],
    [-0.000129040645, 0.000022457606, 0.000086250692],
    [-0.000088636495, 0.000087252940, 0.000095540292],
]
AU = 1.49597870691e11  # the README's

# JPL Horizons, osculating elements on the J2000 ecliptic, 2024-Nov-28 00:00 TDB (JD 2460642.5):
# a km, e, i, node, argument of periapsis, mean anomaly, degrees
HORIZONS = {
    "phobos": [9378.884043, 0.01488911986, 26.12626927, 84.86814910, 343.8114266, 134.7141321],
    "deimos": [23458.26597, 0.0003081896335, 24.27418931, 80.69489331, 14.22288177, 305.8632770],
}


def icrf_position(name, seconds):
    states = node_states(moon_node(name, 0.0, 2 * seconds.max() + 1.0), seconds)
    return states[:, :3] @ mci_from_icrf(0.0)


@pytest.mark.parametrize(
    ("name", "published", "kilometres"), [("phobos", PHOBOS_AU, 20.0), ("deimos", DEIMOS_AU, 45.0)]
)
def test_positions_agree_with_the_numerical_ephemeris_of_2007(name, published, kilometres):
    """0.12 and 0.11 degrees: the mean theory leaves out short-period terms of up to that size."""
    times = np.arange(7) * 10 * SECONDS_PER_DAY
    miss = np.linalg.norm(icrf_position(name, times) - np.array(published) * AU, axis=1)
    assert miss.max() < kilometres * 1e3


@pytest.mark.parametrize(("name", "kilometres"), [("phobos", 32.0), ("deimos", 45.0)])
def test_positions_agree_with_jpl_a_quarter_of_a_century_later(name, kilometres):
    """The secular acceleration and the long-period term carry: without the first, 0.9 degrees."""
    a, e, *angles = HORIZONS[name]
    i, node, periapsis, m = np.radians(angles)
    anomaly = m
    for _ in range(30):
        anomaly = m + e * np.sin(anomaly)
    x, y = a * (np.cos(anomaly) - e), a * np.sqrt(1 - e * e) * np.sin(anomaly)
    u, v = (
        x * np.cos(periapsis) - y * np.sin(periapsis),
        x * np.sin(periapsis) + y * np.cos(periapsis),
    )
    ecliptic = np.array(
        [
            np.cos(node) * u - np.sin(node) * np.cos(i) * v,
            np.sin(node) * u + np.cos(node) * np.cos(i) * v,
            np.sin(i) * v,
        ]
    )
    tilt = np.radians(84381.448 / 3600)
    c, s = np.cos(tilt), np.sin(tilt)
    equatorial = np.array([[1, 0, 0], [0, c, -s], [0, s, c]]) @ ecliptic
    epoch = (2460642.5 - 2451545.0) * SECONDS_PER_DAY
    states = node_states(moon_node(name, epoch, 1.0), [0.0])
    miss = states[0, :3] @ mci_from_icrf(epoch) - equatorial * 1e3
    assert np.linalg.norm(miss) < kilometres * 1e3


def test_the_b1950_matrix_is_erfas():
    """At epoch 2000, ERFA's fk45z differs by the E-terms of aberration: 0.343 arcseconds."""
    for ra, dec in ((0.3, 0.2), (2.0, -1.0), (5.0, 0.9)):
        b1950 = np.array([np.cos(dec) * np.cos(ra), np.cos(dec) * np.sin(ra), np.sin(dec)])
        ra2, dec2 = erfa.fk45z(ra, dec, 2000.0)
        expected = np.array([np.cos(dec2) * np.cos(ra2), np.cos(dec2) * np.sin(ra2), np.sin(dec2)])
        assert np.linalg.norm(J2000_FROM_B1950 @ b1950 - expected) < np.radians(0.35 / 3600)


@pytest.mark.parametrize("name", ["phobos", "deimos"])
def test_motion_is_nearly_keplerian(name):
    """Mean motion squared times a cubed is GM: to 0.3 % for Phobos, whom J2 hurries."""
    row = moon_row(name, 0.0, 0.0)
    assert (row[10] + row[9] + row[8]) ** 2 * row[1] ** 3 == pytest.approx(MARS_GM.value, rel=4e-3)


def test_the_circular_moon_starts_where_the_precessing_one_is():
    for name in ("phobos", "deimos"):
        plain = node_states(moon_node(name, 1e8, 2e5, "circular"), [0.0, 1e5, 2e5])
        true = node_states(moon_node(name, 1e8, 2e5), [1e5])
        np.testing.assert_array_equal(plain[:, 2], 0.0)
        turn = np.arctan2(plain[1, 1], plain[1, 0]) - np.arctan2(true[0, 1], true[0, 0])
        assert np.cos(turn) == pytest.approx(1.0, abs=1e-12)
        radius = np.linalg.norm(plain[:, :3], axis=1)
        np.testing.assert_allclose(radius, moon_row(name, 0.0, 0.0)[1], rtol=1e-12)


def test_unknown_moons_and_models_are_refused():
    with pytest.raises(ArgumentError, match="moon = 'luna': allowed phobos, deimos"):
        moon_row("luna", 0.0, 0.0)
    with pytest.raises(ArgumentError, match="allowed precessing, circular"):
        moon_row("phobos", 0.0, 0.0, "flat")
