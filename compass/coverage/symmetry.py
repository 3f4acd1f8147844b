"""When a constellation looks the same again, turned or mirrored: how much time needs looking at.

Let theta be the phase all satellites of equal circular orbits have gone through. Up to isometries
of the sphere, which carry any fold along, the configuration S(theta) obeys:

* S(theta + pi) is S(theta) seen in the centre: a satellite half a revolution on is at its antipode.
* S(theta + phase) is S(theta) turned about the pole, for the phase of every shift that carries the
  constellation into itself. In a Walker delta pattern t/p/f a step to the next slot is a phase of
  ``2 pi p/t`` and one to the next plane a phase of ``-2 pi f/t``; together they make one of
  ``2 pi g/t`` with ``g = gcd(p, f)``. A rosette (N, N, m) therefore repeats after gcd(N, m) steps
  of ``2 pi/N``, not after one. In a Walker star only the slots are shifts.
* S(-theta - phase) is S(theta) turned half about a line of nodes, for the phase of every mirror.

Which shifts and mirrors there are is found in the elements (`compass.orbits.symmetry`); by how
much they miss goes with the span and into every bound that is proven over it.
"""

from dataclasses import dataclass
from itertools import combinations
from math import comb

import numpy as np
from numpy.typing import NDArray

from compass.coverage.region import GLOBE, Region
from compass.errors import ArgumentError
from compass.orbits import Constellation, orbital_period, repeat_period
from compass.orbits.symmetry import (
    TOLERANCE,
    mirrors,
    one_circle,
    one_period,
    shifts,
    widest_gap,
)
from compass.words import counted

#: Sets of lost satellites that are looked at one by one.
MOST_SUBSETS = 20_000


@dataclass(frozen=True)
class Span:
    """The time that stands for a statement.

    Attributes
    ----------
    start, stop
        Seconds after the epoch.
    for_all_time
        Whether what holds in it holds for ever, in two-body motion.
    reason
        Why, in words.
    mismatch
        Angle by which what happens at another time may differ from what happens in the span,
        radians: by so much the symmetries that carry one into the other are missed.
    """

    start: float
    stop: float
    for_all_time: bool
    reason: str
    mismatch: float = 0.0


#: Revolutions of the fastest satellite that a stretch of time may have. Each costs the same, for
#: a dozen satellites about a second for each thing that is settled.
MOST_REVOLUTIONS = 500.0


def shortest_span(
    constellation: Constellation, region: Region = GLOBE, duration: float | None = None
) -> Span:
    """Return the shortest time that decides about all time, or a stretch of it where none does.

    Parameters
    ----------
    constellation
        The orbits, in two-body motion.
    region
        Where.
    duration
        Seconds from the epoch to look at instead; without it, orbits of different periods and
        regions that turn with Mars get the repeat period of the ground tracks. One that reaches
        past the time after which all repeats decides about all time.

    Raises
    ------
    ArgumentError
        The duration is not positive, or longer than `MOST_REVOLUTIONS` where nothing repeats.
    """
    if duration is not None and not (np.isfinite(duration) and duration > 0):
        raise ArgumentError(f"duration_h = {duration / 3600.0:g}: must be positive and finite")
    if constellation.size == 0:
        return Span(0.0, 0.0, True, "no satellite, nothing changes")
    if region.mars_fixed or not one_period(constellation):
        return _stretch(constellation, duration)
    span = _deciding(constellation, region)
    if duration is None:
        return span
    repeats = _repeats(constellation, region)
    if duration < repeats:
        return Span(0.0, duration, False, "over the duration asked for")
    reason = f"the duration asked for reaches past {repeats / 3600:.4g} h, after which all repeats"
    return Span(span.start, span.stop, True, f"{reason}; {span.reason}", span.mismatch)


def _stretch(c: Constellation, duration: float | None) -> Span:
    """The time asked for, or that of the ground tracks, where nothing repeats for sure."""
    if duration is None:
        track = repeat_period(c)
        return Span(
            0.0,
            track.duration,
            False,
            f"over {counted(track.sidereal_days, 'rotation')} of Mars, after which the ground "
            f"tracks repeat to {np.degrees(track.closure):.3g} deg",
        )
    most = MOST_REVOLUTIONS * 2 * np.pi / float(c.mean_motion.max())
    if duration > most:
        raise ArgumentError(
            f"duration = {duration / 3600:g} h: nothing repeats here, and every revolution must be "
            f"looked at; allowed up to {most / 3600:.6g} h, {MOST_REVOLUTIONS:g} revolutions of "
            "the fastest satellite"
        )
    return Span(0.0, duration, False, "over the duration asked for")


def _phases(c: Constellation, region: Region) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Phases after which circular orbits look alike, and those about which they run backwards."""
    forwards, backwards = shifts(c).phase, mirrors(c).phase
    if region.is_globe or region.is_mirrored:
        return np.concatenate([forwards, forwards + np.pi]), backwards
    # seen in the centre half a turn about a horizontal line keeps north where it is
    return forwards, backwards + np.pi


def _repeats(c: Constellation, region: Region) -> float:
    """Time after which orbits of one period have shown all they ever show, seconds."""
    period = float(orbital_period(c.semi_major_axis[0], c.gm))
    return period if not c.is_circular else widest_gap(_phases(c, region)[0]) / (2 * np.pi) * period


def _deciding(c: Constellation, region: Region) -> Span:
    """Part of a revolution that decides about orbits of one period."""
    period = float(orbital_period(c.semi_major_axis[0], c.gm))
    if not c.is_circular:
        return Span(0.0, period, True, "all orbits have one period")
    forwards, backwards = _phases(c, region)
    gap = widest_gap(forwards)
    steps, parts = (round(2 * np.pi / g) for g in (widest_gap(shifts(c).phase), gap))
    mismatch = shifts(c).mismatch
    reason = f"turned about the pole it repeats after 1/{steps} of a revolution"
    if forwards.size > len(shifts(c)):
        reason += f", seen in the centre after 1/{parts}"
    if not backwards.size:
        return Span(0.0, gap / (2 * np.pi) * period, True, reason, mismatch)
    mismatch += mirrors(c).mismatch
    reason += f", and half a turn about a node line runs it backwards: 1/{2 * parts} decides"
    first = float(np.mod(-backwards[0] / 2, gap))
    if gap - first < TOLERANCE:  # the remainder of minus nothing
        mismatch += gap - first
        first = 0.0
    first, last = (theta / (2 * np.pi) * period for theta in (first, first + 0.5 * gap))
    return Span(first, last, True, reason, mismatch)


@dataclass(frozen=True)
class Part:
    """The part of all longitudes and phases that decides for ever about equal circular orbits.

    Attributes
    ----------
    longitude
        Longitudes from 0 up to this, radians.
    phases
        From the first to the last, radians.
    mismatch
        As of `Span`.
    reason
        Why, in words.
    """

    longitude: float
    phases: tuple[float, float]
    mismatch: float
    reason: str


def deciding_part(c: Constellation, *, mirrored: bool) -> Part:
    """Part of longitude and phase that decides for ever about equal circular orbits.

    A place sees alike at

    * ``(b, l, th)`` and ``(b, l - turn, th + phase)`` for each shift: of G shifts q leave the phase
      alone, so ``l in [0, 2 pi/q)`` and 2 pi q/G of phase hold everything once;
    * ``(b, l, th)`` and ``(-b, l + pi, th + pi)``: the mirror image of a circular orbit in the
      equator is the orbit half a turn and half a revolution on, so north stands for south;
    * with a half turn about a line of nodes and the mirror image, ``(b, l, th)`` and
      ``(b, turn + pi - l, pi - phase - th)``: half of the phase, from ``(pi - phase)/2`` on.

    Parameters
    ----------
    c
        Orbits of one radius, without eccentricity.
    mirrored
        Whether users see as far in all directions; else there is no mirror, and only shifts count.
    """
    moves = shifts(c)
    still = np.abs(np.mod(moves.phase + np.pi, 2 * np.pi) - np.pi) < 1e-9
    turns = max(int(still.sum()), 1)
    first, half, missed = 0.0, 1.0, moves.mismatch
    reason = counted(len(moves), "verified shift")
    if mirrored:
        reason += ", north mirrors south"
        back = mirrors(c)
        if len(back):
            first, half = 0.5 * (np.pi - float(back.phase[0])), 0.5
            missed += back.mismatch
            reason += ", half turns run it backwards"
    last = first + 2 * np.pi * half / (len(moves) // turns)
    return Part(2 * np.pi / turns, (first, last), missed, reason)


@dataclass(frozen=True)
class Alike:
    """Sets of satellites, sorted by what is left without them.

    Attributes
    ----------
    sets
        One of each kind and the number of sets that it stands for.
    mismatch
        Angle by which what is left of sets of a kind may differ, radians.
    """

    sets: dict[tuple[int, ...], int]
    mismatch: float


def unlike_subsets(
    constellation: Constellation,
    size: int,
    region: Region = GLOBE,
    duration: float | None = None,
    *,
    backwards: bool = True,
) -> Alike:
    """Subsets of `size` satellites of which none is another turned, delayed or run backwards.

    Of a limited time only turns are allowed: what comes later or backwards need not come in it.

    Parameters
    ----------
    constellation, region, duration
        As in `shortest_span`.
    size
        How many satellites a subset has.
    backwards
        Whether what runs backwards counts as alike: not for who looks over a horizon that north
        and south do not share.

    Raises
    ------
    ArgumentError
        The size is not in 1 ... number of satellites, or there are too many subsets.
    """
    n = constellation.size
    if not 1 <= size <= n:
        raise ArgumentError(f"losses = {size}: allowed 0 to {n}, the number of satellites")
    if comb(n, size) > MOST_SUBSETS:
        raise ArgumentError(
            f"losses = {size}: {comb(n, size)} sets of {size} among {n} satellites are more than "
            f"{MOST_SUBSETS}; ask for fewer losses"
        )
    moves, mismatch = _relabellings(constellation, region, duration, backwards)
    kinds: dict[tuple[int, ...], int] = {}
    for subset in combinations(range(n), size):
        images = np.sort(moves[:, list(subset)], axis=1)
        kind = tuple(int(i) for i in images[np.lexsort(images.T[::-1])[0]])
        kinds[kind] = kinds.get(kind, 0) + 1
    return Alike(kinds, mismatch)


def _relabellings(
    c: Constellation, region: Region, duration: float | None, backwards: bool = True
) -> tuple[NDArray[np.int64], float]:
    """Satellites that take each other's places, shape (m, n), in all that the time shows."""
    still = np.arange(c.size)[np.newaxis], 0.0
    if region.mars_fixed or not one_circle(c):
        return still
    forwards, mirrored = shifts(c), mirrors(c)
    period = float(orbital_period(c.semi_major_axis[0], c.gm))
    if duration is None or duration >= period:
        if not backwards:
            return forwards.image, forwards.mismatch
        return (
            np.concatenate([forwards.image, mirrored.image]),
            forwards.mismatch + mirrored.mismatch,
        )
    delay = np.abs(np.mod(forwards.phase + np.pi, 2 * np.pi) - np.pi)
    turns = delay <= TOLERANCE
    return forwards.image[turns], forwards.mismatch + float(delay[turns].max())
