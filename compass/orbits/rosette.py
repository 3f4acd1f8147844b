"""Ballard's rosettes, integer and fractional, and what they are in Walker's terms."""

from fractions import Fraction
from math import gcd

from compass.bodies import MARS_GM
from compass.errors import ArgumentError
from compass.orbits.constellation import Constellation, Pattern, check_counts, from_pattern


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


def rosette(
    satellites: int,
    planes: int,
    multiplier: Fraction | float | str,
    *,
    inclination: float,
    radius: float,
    name: str = "",
    epoch: float = 0.0,
    gm: float = MARS_GM.value,
) -> Constellation:
    """Ballard's rosette (N, P, m) on circular orbits, satellites in plane order.

    Parameters
    ----------
    satellites, planes
        N and P.
    multiplier
        m: an integer 0 ... N-1 for P = N, else a multiple of P/N such as ``"1/4"`` or 1.75.
    inclination, radius
        Radians and metres.
    name, epoch, gm
        As in `Constellation`.

    Raises
    ------
    ArgumentError
        As `walker_phasing`.

    References
    ----------
    Ballard 1980, Rosette Constellations of Earth Satellites, IEEE Trans. Aerosp. Electron. Syst.
    AES-16(5):656-673, doi 10.1109/TAES.1980.308932.
    """
    phasing = walker_phasing(satellites, planes, multiplier)
    exact = Fraction(multiplier).limit_denominator(10**6)
    pattern = Pattern("rosette", satellites, planes, phasing, inclination, exact)
    return from_pattern(pattern, radius, name=name, epoch=epoch, gm=gm)
