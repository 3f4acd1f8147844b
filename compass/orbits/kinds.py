"""The kinds of patterns that a constellation can be written as, one record each.

A kind is a way of writing: geometry decides what a constellation is. A rosette is a Walker delta
pattern by another name, and `Constellation.pattern` finds the pattern in the elements themselves.
"""

from dataclasses import dataclass
from fractions import Fraction
from math import gcd

import numpy as np

from compass.errors import ArgumentError


@dataclass(frozen=True)
class Parameter:
    """A number that writes a pattern down.

    Attributes
    ----------
    name
        As in design files.
    unit
        ``1`` for counts.
    whole
        Whether it must be a whole number.
    meaning
        In words, with the allowed range.
    """

    name: str
    unit: str
    whole: bool
    meaning: str


@dataclass(frozen=True)
class PatternKind:
    """A way of writing symmetric constellations of circular orbits.

    Attributes
    ----------
    name
        As in design files.
    title
        For people.
    third
        Name of the number that stands beside satellites and planes.
    node_spread
        Angle over which the ascending nodes are spread, radians.
    parameters
        What writes it down, orbit apart.
    """

    name: str
    title: str
    third: str
    node_spread: float
    parameters: tuple[Parameter, ...]


_COUNTS = (
    Parameter("satellites", "1", True, "total number t, a whole number from 1 to 10000"),
    Parameter("planes", "1", True, "number of planes p; must divide satellites"),
)
_ANGLES = (
    Parameter("inclination_deg", "deg", False, "inclination, 0 to 180 degrees"),
    Parameter("raan_deg", "deg", False, "right ascension of the first plane's ascending node"),
    Parameter("phase_deg", "deg", False, "argument of latitude of the first satellite"),
)
_PHASING = Parameter("phasing", "1", True, "Walker's F, a whole number from 0 to planes - 1")
_MULTIPLIER = Parameter(
    "multiplier", "1", False, 'Ballard\'s m: a multiple of planes/satellites, such as "1/4"'
)

WALKER_DELTA = PatternKind(
    "walker-delta", "Walker delta", "phasing", 2.0 * np.pi, (*_COUNTS, _PHASING, *_ANGLES)
)
WALKER_STAR = PatternKind(
    "walker-star", "Walker star", "phasing", np.pi, (*_COUNTS, _PHASING, *_ANGLES)
)
ROSETTE = PatternKind(
    "rosette", "Ballard rosette", "multiplier", 2.0 * np.pi, (*_COUNTS, _MULTIPLIER, *_ANGLES)
)

#: Every kind, in the order in which studies number them.
KINDS = (WALKER_DELTA, WALKER_STAR, ROSETTE)

KIND_NAMES = tuple(kind.name for kind in KINDS)


def kind_of(name: str) -> PatternKind:
    """Return the kind of that name.

    Raises
    ------
    ArgumentError
        There is none, with the names that are.
    """
    for kind in KINDS:
        if kind.name == name:
            return kind
    raise ArgumentError(f"pattern = {name!r}: allowed {', '.join(KIND_NAMES)}")


def check_counts(satellites: int, planes: int) -> None:
    """Raise `ArgumentError` unless the satellites divide evenly into the planes."""
    if satellites < 1 or planes < 1:
        raise ArgumentError(
            f"satellites = {satellites}, planes = {planes}: both must be at least 1"
        )
    if satellites % planes:
        divisors = [str(d) for d in range(1, satellites + 1) if satellites % d == 0]
        raise ArgumentError(
            f"planes = {planes}: {satellites} satellites do not divide into {planes} planes; "
            f"use one of {', '.join(divisors)}"
        )


def check_phasing(phasing: int, planes: int) -> None:
    """Raise `ArgumentError` unless Walker's F is one of 0 to planes - 1, as files have it."""
    if not 0 <= phasing < planes:
        raise ArgumentError(
            f"phasing = {phasing}: allowed 0 to {planes - 1} for {planes} planes; phasing is meant "
            f"modulo planes, so write {phasing % planes}"
        )


def walker_phasing(satellites: int, planes: int, multiplier: Fraction | float | str) -> int:
    """Walker's F of the rosette (N, P, m): ``F = m N / P``, reduced modulo P.

    Ballard's satellite i has ``RAAN = 2 pi i / P`` and argument of latitude ``m RAAN``
    (i = 0 ... N-1). With ``m = c P / N`` the satellites i, i + P, i + 2P, ... share a plane, a
    step ``2 pi c P / N`` apart; they are N/P different ones, evenly spaced, exactly if c and
    N/P have no common factor. Plane k is then ahead of plane 0 by ``2 pi c k / N``, which is
    Walker's phasing ``2 pi F k / t`` with ``F = c``. F and F + P are the same pattern.

    Raises
    ------
    ArgumentError
        m is not a multiple of P/N, or two satellites would share a place.
    """
    check_counts(satellites, planes)
    steps = Fraction(multiplier).limit_denominator(10**6) * satellites / planes
    per_plane = satellites // planes
    if steps.denominator != 1:
        raise ArgumentError(
            f"multiplier = {multiplier}: allowed are whole multiples of planes/satellites = "
            f"{Fraction(planes, satellites)}"
        )
    if gcd(int(steps), per_plane) != 1:
        raise ArgumentError(
            f"multiplier = {multiplier}: two satellites would share a place in each plane; "
            f"its numerator over {per_plane} must have no factor in common with {per_plane}"
        )
    return int(steps) % planes


def least_multiplier(satellites: int, planes: int, phasing: int) -> Fraction | None:
    """Ballard's least m of Walker's t/p/f, or None: no rosette has that pattern."""
    per_plane = satellites // planes
    for c in range(phasing % planes, satellites, planes):
        if gcd(c, per_plane) == 1:
            return Fraction(c * planes, satellites)
    return None
