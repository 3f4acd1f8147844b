"""Areostationary equilibria: own values, and the swing against integration."""

import numpy as np
import pytest

from compass.frames import SECONDS_PER_DAY as DAY
from compass.frames import prime_meridian_angle
from compass.orbits.equilibria import (
    equilibria,
    largest_acceleration,
    longitude_acceleration,
    synchronous_radius,
)
from compass.orbits.forces import ForceModel
from compass.orbits.gravity import built_in_field
from compass.orbits.trajectory import integrate
from compass.papers.areostationary import rows

FIELD = built_in_field().truncated(8)


def test_points_are_those_of_two_other_programs():
    """Newton's method on other fields, MRO95A and GMM-3 alike, to a hundredth of a degree."""
    points = equilibria(FIELD)
    found = [float(np.degrees(p.longitude)) for p in points]
    assert found == pytest.approx([75.35, 167.82, 254.43, 342.10], abs=0.01)
    assert [p.stable for p in points] == [False, True, False, True]
    assert [p.radius / 1e3 for p in points if p.stable] == pytest.approx(
        [20428.128, 20428.132], abs=1e-3
    )
    assert [p.period / DAY for p in points if p.stable] == pytest.approx([127.3, 130.8], abs=0.05)
    place, most = largest_acceleration(FIELD)
    assert np.degrees(place) == pytest.approx(212.5, abs=0.3)
    assert np.degrees(most) * DAY**2 == pytest.approx(0.0756, abs=5e-5)


def test_degree_two_alone_is_three_degrees_off():
    found = [np.degrees(p.longitude) for p in equilibria(FIELD.truncated(2)) if p.stable]
    assert found == pytest.approx([164.98, 344.98], abs=0.01)
    # of an ellipse of mass the axes are the stable points: tan 2 lambda = S22 / C22
    axis = np.degrees(0.5 * np.arctan2(FIELD.s[2, 2], FIELD.c[2, 2])) % 180
    assert found == pytest.approx([axis + 90, axis + 270], abs=1e-6)


@pytest.mark.slow
def test_the_swing_takes_as_long_in_an_integration():
    """Half a period after a start 1 degree aside a satellite stands 1 degree on the other side."""
    point = equilibria(FIELD)[1]
    start = point.longitude + np.radians(1.0)
    r = synchronous_radius(FIELD, start)
    # kept at pace with Mars: the radius of a circle about the oblate planet
    angle = start + float(prime_meridian_angle(0.0))
    omega = 7.088218070006562e-05
    x = r * np.array([np.cos(angle), np.sin(angle), 0.0])
    v = omega * np.array([-x[1], x[0], 0.0])
    path = integrate(x, v, ForceModel(FIELD, False, False, 0.0, "none"), 0.75 * point.period)
    times = np.linspace(0.45, 0.55, 41) * point.period
    fixed = path.positions_mcmf(times)[0]
    aside = np.degrees(np.arctan2(fixed[:, 1], fixed[:, 0])) - np.degrees(point.longitude)
    aside = (aside + 180) % 360 - 180
    assert aside.min() == pytest.approx(-1.0, abs=0.02)
    turning = times[aside.argmin()] / point.period
    assert turning == pytest.approx(0.5, abs=0.02)


def test_the_push_changes_sign_at_a_point():
    for point in equilibria(FIELD):
        after = longitude_acceleration(FIELD, point.longitude + 0.01)
        assert (after < 0) == point.stable


def test_papers_agree():
    found = rows()
    assert all(row.holds for row in found)
    assert sum(row.published is not None for row in found) == 4
