"""The kinds of patterns that a constellation can be written as, one record each.

A kind is a way of writing: geometry decides what a constellation is. A rosette is a Walker delta
pattern by another name, and `Constellation.pattern` finds the pattern in the elements themselves.
Tables of files, their faults, choices of commands, studies and searches are made from the records.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from math import gcd, pi
from typing import Any, Literal

from compass.errors import ArgumentError, real_number, whole_number


@dataclass(frozen=True)
class Parameter:
    """A number that writes a pattern down.

    Attributes
    ----------
    name
        As in design files.
    unit
        ``1`` for counts.
    form
        ``whole``, ``real``, or ``ratio``: a number, or a text such as "1/4".
    meaning
        In words, with the allowed range.
    least, most
        The range where it does not depend on others.
    default
        What it is where nobody says; None if someone must.
    """

    name: str
    unit: str
    form: Literal["whole", "real", "ratio"]
    meaning: str
    least: float | None = None
    most: float | None = None
    default: float | None = None

    def check(self, value: object) -> None:
        """Raise `ArgumentError` unless the value is of the form and in the range.

        Ratios, and ranges that depend on others, are for the kind to judge.
        """
        bounds = () if self.least is None or self.most is None else (self.least, self.most)
        if self.form == "whole":
            whole_number(self.name, value, *map(int, bounds))
        elif self.form == "real":
            number = real_number(self.name, value)
            if bounds and not bounds[0] <= number <= bounds[1]:
                allowed = f"allowed {bounds[0]:g} to {bounds[1]:g} degrees"
                raise ArgumentError(f"{self.name} = {number:g}: {allowed}")


@dataclass(frozen=True)
class PatternKind:
    """A way of writing symmetric constellations of circular orbits.

    Attributes
    ----------
    name
        As in design files.
    title
        For people, with the numbers that write it down.
    layout
        Name of the kind as which its satellites are laid out: of itself, or of another.
    node_spread
        Angle over which the ascending nodes are spread, radians.
    parameters
        What writes it down, orbit apart.
    phasing
        Walker's F of satellites, planes and the number that stands beside them.

        It raises `ArgumentError` for what the kind does not allow.
    """

    name: str
    title: str
    layout: str
    node_spread: float
    parameters: tuple[Parameter, ...]
    phasing: Callable[[int, int, Any], int]

    @property
    def third(self) -> str:
        """Name of the number that stands beside satellites and planes."""
        return self.parameters[2].name

    def writes(self, satellites: int, planes: int, phasing: int) -> bool:
        """Whether Walker's t/p/f of its layout can be written as one of this kind."""
        if self.third != "multiplier":
            return True
        return least_multiplier(satellites, planes, phasing) is not None


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


def checked_phasing(satellites: int, planes: int, phasing: int) -> int:
    """Return Walker's F if it is one of 0 to planes - 1, as files have it.

    Raises
    ------
    ArgumentError
        It is not, or the satellites do not divide into the planes.
    """
    check_counts(satellites, planes)
    if not 0 <= phasing < planes:
        raise ArgumentError(
            f"phasing = {phasing}: allowed 0 to {planes - 1} for {planes} planes; phasing is meant "
            f"modulo planes, so write {phasing % planes}"
        )
    return phasing


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
    steps = ratio_of(multiplier) * satellites / planes
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


def ratio_of(multiplier: Fraction | float | str) -> Fraction:
    """Ballard's m as a fraction.

    Raises
    ------
    ArgumentError
        It is no finite number.
    """
    try:
        return Fraction(multiplier).limit_denominator(10**6)
    except (TypeError, ValueError, ZeroDivisionError, OverflowError):
        allowed = 'must be a finite number or a fraction such as "1/4"'
        raise ArgumentError(f"multiplier = {multiplier!r}: {allowed}") from None


def least_multiplier(satellites: int, planes: int, phasing: int) -> Fraction | None:
    """Ballard's least m of Walker's t/p/f, or None: no rosette has that pattern."""
    per_plane = satellites // planes
    for c in range(phasing % planes, satellites, planes):
        if gcd(c, per_plane) == 1:
            return Fraction(c * planes, satellites)
    return None


_COUNTS = (
    Parameter(
        "satellites", "1", "whole", "total number t, a whole number from 1 to 10000", 1, 10_000
    ),
    Parameter("planes", "1", "whole", "number of planes p; must divide satellites", 1, 10_000),
)
_ANGLES = (
    Parameter("inclination_deg", "deg", "real", "inclination, 0 to 180 degrees", 0, 180),
    Parameter(
        "raan_deg", "deg", "real", "node of the first plane, degrees", -360, 360, default=0.0
    ),
    Parameter(
        "phase_deg",
        "deg",
        "real",
        "argument of latitude of the first satellite, degrees",
        -360,
        360,
        default=0.0,
    ),
)
_PHASING = Parameter("phasing", "1", "whole", "Walker's F, a whole number from 0 to planes - 1", 0)
_MULTIPLIER = Parameter(
    "multiplier",
    "1",
    "ratio",
    'Ballard\'s m: a multiple of planes/satellites, as a number or text like "1/4"',
)

WALKER_DELTA = PatternKind(
    "walker-delta",
    "Walker's pattern i: t/p/f",
    "walker-delta",
    2.0 * pi,
    (*_COUNTS, _PHASING, *_ANGLES),
    checked_phasing,
)
WALKER_STAR = PatternKind(
    "walker-star",
    "Walker's star pattern i: t/p/f",
    "walker-star",
    pi,
    (*_COUNTS, _PHASING, *_ANGLES),
    checked_phasing,
)
ROSETTE = PatternKind(
    "rosette",
    "Ballard's rosette (N, P, m)",
    "walker-delta",
    2.0 * pi,
    (*_COUNTS, _MULTIPLIER, *_ANGLES),
    walker_phasing,
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
