"""When a constellation looks the same again, turned or mirrored: how much time needs looking at.

Let theta be the phase all satellites of equal circular orbits have gone through. Up to isometries
of the sphere, which carry any fold along, the configuration S(theta) obeys:

* S(theta + pi) is S(theta) seen in the centre: a satellite half a revolution on is at its antipode.
* In a Walker delta pattern or rosette t/p/f a step to the next slot is a phase of ``2 pi p/t`` and
  a step to the next plane, a turn of ``2 pi/p`` about the pole, one of ``-2 pi f/t``. Together
  they make a phase of ``2 pi g/t`` with ``g = gcd(p, f)``. A rosette (N, N, m) therefore repeats
  after gcd(N, m) steps of ``2 pi/N``, not after one.
* Half a turn about the nodes of plane 0 takes theta to -theta.

In a Walker star no plane becomes another by a turn; only the slots do, and half a turn about the
middle of the nodes takes theta to ``-theta - 2 pi f (p - 1)/t``.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations
from math import comb, gcd, lcm

import numpy as np

from compass.coverage.region import GLOBE, Region
from compass.errors import ArgumentError
from compass.orbits import Constellation, orbital_period, repeat_period
from compass.orbits.constellation import Pattern

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
    """

    start: float
    stop: float
    for_all_time: bool
    reason: str


def one_period(constellation: Constellation) -> bool:
    """Whether all orbits have the same period, after which everything repeats."""
    a = constellation.semi_major_axis
    return a.size == 0 or bool(np.all(a == a[0]))


def one_circle(constellation: Constellation) -> bool:
    """Whether all orbits are circles of one radius, so that all caps are alike for ever."""
    return constellation.is_circular and one_period(constellation)


def phase_steps(pattern: Pattern) -> int:
    """Into how many equal parts of a revolution a pattern repeats up to a turn about the pole."""
    if pattern.kind == "walker-star":
        return pattern.per_plane
    return pattern.satellites // gcd(pattern.planes, pattern.phasing)


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
        regions that turn with Mars get the repeat period of the ground tracks.

    Raises
    ------
    ArgumentError
        The duration is not positive.
    """
    if duration is not None:
        if not (np.isfinite(duration) and duration > 0):
            raise ArgumentError(f"duration = {duration:g} s: must be positive and finite")
        return Span(0.0, duration, False, "over the duration asked for")
    if constellation.size == 0:
        return Span(0.0, 0.0, True, "no satellite, nothing changes")
    if region.mars_fixed or not one_period(constellation):
        track = repeat_period(constellation)
        return Span(
            0.0,
            track.duration,
            False,
            f"over {track.sidereal_days} rotation(s) of Mars, after which the ground tracks "
            f"repeat to {np.degrees(track.closure):.3g} deg",
        )
    period = float(orbital_period(constellation.semi_major_axis[0], constellation.gm))
    if not constellation.is_circular:
        return Span(0.0, period, True, "all orbits have one period")
    pattern = constellation.pattern
    steps = phase_steps(pattern) if pattern else 1
    mirrored = region.is_globe or region.is_mirrored
    reason = f"turned about the pole it repeats after 1/{steps} of a revolution"
    if not mirrored:
        return Span(0.0, period / steps, True, reason)
    parts = lcm(steps, 2)
    reason += f", seen in the centre after 1/{parts}"
    if pattern is None:
        return Span(0.0, period / parts, True, reason)
    first = 0.0
    if pattern.kind == "walker-star":
        first = -pattern.phasing * (pattern.planes - 1) / (2.0 * pattern.satellites) % (1.0 / parts)
    reason += f", and half a turn about a node line runs it backwards: 1/{2 * parts} decides"
    return Span(first * period, (first + 0.5 / parts) * period, True, reason)


def unlike_subsets(
    constellation: Constellation, size: int, region: Region = GLOBE
) -> dict[tuple[int, ...], int]:
    """Subsets of `size` satellites of which none is another turned, delayed or run backwards.

    Returns
    -------
    subsets
        One of each kind and the number of subsets that it stands for.

    Raises
    ------
    ArgumentError
        The size is not in 1 ... number of satellites, or there are too many subsets.
    """
    n = constellation.size
    if not 1 <= size <= n:
        raise ArgumentError(f"losses = {size}: allowed 1 to {n}, the number of satellites")
    if comb(n, size) > MOST_SUBSETS:
        raise ArgumentError(
            f"losses = {size}: {comb(n, size)} sets of {size} among {n} satellites are more than "
            f"{MOST_SUBSETS}; ask for fewer losses"
        )
    moves = np.array(list(_relabellings(constellation, region)))
    kinds: dict[tuple[int, ...], int] = {}
    for subset in combinations(range(n), size):
        images = np.sort(moves[:, list(subset)], axis=1)
        kind = tuple(int(i) for i in images[np.lexsort(images.T[::-1])[0]])
        kinds[kind] = kinds.get(kind, 0) + 1
    return kinds


def _relabellings(constellation: Constellation, region: Region) -> Iterable[list[int]]:
    """Permutations of the satellites that an isometry and a shift or reversal of time bring."""
    pattern = constellation.pattern
    if pattern is None or region.mars_fixed:
        yield list(range(constellation.size))
        return
    p, s, f = pattern.planes, pattern.per_plane, pattern.phasing
    cells = [(k, j) for k in range(p) for j in range(s)]
    turns = range(1) if pattern.kind == "walker-star" else range(p)
    backwards = pattern.kind != "walker-star" and (region.is_globe or region.is_mirrored)
    for turn in turns:
        for slot in range(s):
            moved = [((k + turn) % p, (j + slot + f * ((k + turn) // p)) % s) for k, j in cells]
            yield [k * s + j for k, j in moved]
            if backwards:
                # plane k goes to plane -k; past plane 0 its slots count from f on
                yield [(-k % p) * s + (-j - (f if k else 0)) % s for k, j in moved]
