"""Walker's patterns: delta (nodes all around the equator) and star (nodes over half of it)."""

from compass.bodies import MARS_GM
from compass.orbits.constellation import Constellation, Pattern, check_counts, from_pattern


def walker_delta(
    satellites: int,
    planes: int,
    phasing: int,
    *,
    inclination: float,
    radius: float,
    name: str = "",
    epoch: float = 0.0,
    gm: float = MARS_GM.value,
) -> Constellation:
    """Walker delta pattern i: t/p/f on circular orbits.

    Plane k has ``RAAN = 2 pi k / p``; satellite j of it has argument of latitude
    ``2 pi j / s + 2 pi f k / t`` with ``s = t/p``.

    Parameters
    ----------
    satellites, planes, phasing
        t, p and f; f is meant modulo p.
    inclination, radius
        Radians and metres.
    name, epoch, gm
        As in `Constellation`.

    Raises
    ------
    ArgumentError
        The satellites do not divide into the planes.

    References
    ----------
    Walker 1970, Circular Orbit Patterns Providing Continuous Whole Earth Coverage, RAE TR 70211.
    """
    return _walker(
        "walker-delta", satellites, planes, phasing, inclination, radius, name, epoch, gm
    )


def walker_star(
    satellites: int,
    planes: int,
    phasing: int,
    *,
    inclination: float,
    radius: float,
    name: str = "",
    epoch: float = 0.0,
    gm: float = MARS_GM.value,
) -> Constellation:
    """Walker star pattern: as `walker_delta` but with ``RAAN = pi k / p``.

    Neighbouring planes go the same way but for the first and the last, where the satellites
    meet head-on (the seam); with near-polar inclination this is the pattern of Iridium.

    References
    ----------
    Walker 1970, Circular Orbit Patterns Providing Continuous Whole Earth Coverage, RAE TR 70211.
    """
    return _walker("walker-star", satellites, planes, phasing, inclination, radius, name, epoch, gm)


def _walker(
    kind: str,
    satellites: int,
    planes: int,
    phasing: int,
    inclination: float,
    radius: float,
    name: str,
    epoch: float,
    gm: float,
) -> Constellation:
    check_counts(satellites, planes)
    pattern = Pattern(kind, satellites, planes, phasing, inclination)
    return from_pattern(pattern, radius, name=name, epoch=epoch, gm=gm)
