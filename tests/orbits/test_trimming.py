"""Trimming: one mean rate for all, and where it cannot be had."""

import numpy as np
import pytest

from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY as DAY
from compass.orbits.constellation import keplerian
from compass.orbits.forces import ForceModel
from compass.orbits.gravity import built_in_field
from compass.orbits.motion import Motion
from compass.orbits.trimming import (
    beat_of,
    can_trim,
    excursions,
    kinds_of,
    mean_rates,
    trim,
    trimmed_path,
    turned,
)

OBLATE = ForceModel(built_in_field().truncated(2, 0), False, False, 0.0, "none")


def ring(radius, inclination=0.9):
    return keplerian(radius, 0.0, inclination, 0.4, 0.0, np.arange(4) * np.pi / 2)


def test_under_oblateness_alone_the_shift_is_the_short_period_term_of_the_axis():
    """``3/2 J2 R^2 / a sin^2 i cos 2u`` (Kozai 1959), first order: J2 (R/a)^2 is left out."""
    c = ring(12000e3)
    done = trim(c, OBLATE, 6 * DAY)
    amplitude = 1.5 * 1.9566e-3 * 3396e3**2 / 12000e3 * np.sin(0.9) ** 2
    known = amplitude * np.array([1, -1, 1, -1])
    assert done.shift - done.shift.mean() == pytest.approx(known, rel=0.02)
    assert done.spread < 1e-3 * done.spread_before
    assert done.excursion < 0.1 * done.excursion_before
    # 1 km of axis is 3/2 n / a: what was given runs apart by twice the amplitude
    rate = 1.5 * c.mean_motion[0] / 12000e3 * 2 * amplitude
    assert done.spread_before == pytest.approx(rate, rel=0.05)


def test_paths_of_trimmed_orbits_keep_together_as_the_trim_does():
    c = ring(12000e3)
    done = trim(c, OBLATE, 6 * DAY)
    path = trimmed_path(c, OBLATE, 6 * DAY)
    _, theta = turned(path)
    furthest = excursions(theta, kinds_of(c)).max()
    assert furthest < 1.1 * done.excursion < 0.1 * done.excursion_before
    axis = np.linalg.norm(path.states([0.0])[0][:, 0], axis=1)
    assert axis - axis.mean() == pytest.approx(done.shift - done.shift.mean(), rel=0.05)


def test_each_kind_of_orbit_is_trimmed_to_its_own_mean():
    shells = [ring(12000e3), ring(9000e3, 1.5)]
    both = keplerian(
        np.repeat([12000e3, 9000e3], 4), 0.0, np.repeat([0.9, 1.5], 4), 0.4, 0.0,
        np.tile(np.arange(4) * np.pi / 2, 2),
    )  # fmt: skip
    assert kinds_of(both).tolist() == [1] * 4 + [0] * 4
    done = trim(both, OBLATE, 2 * DAY)
    alone = np.concatenate([trim(shell, OBLATE, 2 * DAY).shift for shell in shells])
    assert done.shift == pytest.approx(alone, abs=30.0)
    assert np.abs(done.shift).max() > 1000.0
    assert done.spread < 0.02 * done.spread_before


def test_where_no_two_orbits_have_one_period_there_is_nothing_to_trim():
    apart = keplerian([9000e3, 12000e3], 0.0, 0.9, 0.4, 0.0, 0.0)
    with pytest.raises(ArgumentError, match="no two satellites have one period"):
        trim(apart, OBLATE, 2 * DAY)


@pytest.mark.slow
def test_a_beat_of_weeks_does_not_deceive_the_fit():
    """20,227.7 km: J22 swings by degrees with a beat of 34.5 days; a plain line errs by 0.1 deg/d."""
    forces = ForceModel(built_in_field().truncated(3), False, False, 0.0, "none")
    c = ring(20227.7e3, np.pi / 4)
    beat = beat_of(c, forces.field).period
    assert beat / DAY == pytest.approx(34.5, abs=0.3)
    done = trim(c, forces, 300 * DAY)
    path = Motion("numerical", forces).trajectory(done.constellation, 0.0, 300 * DAY)
    times, theta = turned(path)
    rates = mean_rates(times, theta)
    assert np.degrees(np.ptp(rates)) * DAY < 1e-3
    # an independent look: from one beat's mean to another's, whole beats apart

    def mean_over(start):
        x = np.linspace(start, start + beat, 400)
        return np.array([np.interp(x, times, angle).mean() for angle in theta.T])

    far = 7 * beat
    slow = (mean_over(far) - mean_over(0.0)) / far
    assert np.degrees(np.ptp(slow)) * DAY < 0.01
    assert np.degrees(done.excursion) < 5.0 < np.degrees(done.excursion_before)


#: The least degree that has a term for each of the resonances below.
FOUR = built_in_field().truncated(4)

#: Where ``p n = q omega``, first order in J2 left out: p rotations are q revolutions.
SPIN = np.radians(350.89198226) / DAY


@pytest.mark.parametrize(("revolutions", "rotations"), [(1, 1), (2, 1), (3, 1), (3, 2)])
def test_no_trim_helps_in_resonance(revolutions, rotations):
    """At some radius about each place where a term stands still; none a thousand km away."""
    radius = (FOUR.gm * (rotations / revolutions / SPIN) ** 2) ** (1 / 3)
    beats = [beat_of(ring(radius + shift), FOUR) for shift in np.arange(-30e3, 31e3, 3e3)]
    longest = max(beats, key=lambda beat: beat.period)
    assert (longest.revolutions, longest.rotations) == (revolutions, rotations)
    assert not can_trim(longest)
    aside = beat_of(ring(radius + 1e6), FOUR)
    assert aside.period < 40 * DAY and can_trim(aside)


def test_what_does_not_resonate_can_be_trimmed():
    with pytest.raises(ArgumentError, match="they are in resonance, and no initial axis"):
        trim(ring(20430e3), ForceModel(built_in_field().truncated(2)), 30 * DAY)
    # a field that turns unseen pushes nobody along, nor does any against its turn on the equator
    assert beat_of(ring(20430e3), OBLATE.field).period == 0.0
    assert can_trim(beat_of(ring(20430e3, np.pi), FOUR))
    oval = keplerian(20430e3, 0.3, 0.9, 0.4, 0.0, 0.0)
    assert beat_of(oval, FOUR).ratio == "1:1" and not can_trim(beat_of(oval, FOUR))


def test_the_turned_angle_of_a_circle_is_its_mean_anomaly():
    c = ring(12000e3)
    times, theta = turned(Motion().trajectory(c, 0.0, DAY))
    assert theta == pytest.approx(times[:, None] * c.mean_motion, rel=1e-9)
    assert mean_rates(times, theta) == pytest.approx(c.mean_motion, rel=1e-9)
