"""Constellations as people write them: patterns and elements in degrees and kilometres."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.arguments import checked
from compass.bodies import MARS_GM
from compass.errors import ArgumentError, near, real_number
from compass.frames import DEFAULT_FIGURE, Figure, figure_of
from compass.orbits.anomaly import mean_of_true
from compass.orbits.constellation import Constellation, from_pattern, keplerian
from compass.orbits.kinds import (
    ROSETTE,
    WALKER_DELTA,
    WALKER_STAR,
    PatternKind,
    kind_of,
    ratio_of,
)
from compass.orbits.pattern import Pattern, rosette_notation
from compass.orbits.period import areosynchronous_radius, repeat_radius
from compass.units import KM

#: Farthest that an orbit may reach, kilometres: beyond its Hill radius, ``a (1 - e) (m/3M)^(1/3)``
#: = 983,000 km, the Sun takes a satellite from Mars. Metres given for kilometres are farther.
FARTHEST_KM = 1e6


@checked
def walker_delta(
    satellites: int,
    planes: int,
    phasing: int,
    *,
    inclination_deg: float,
    radius_km: float | None = None,
    altitude_km: float | None = None,
    orbit: str | None = None,
    repeat: Sequence[int] | None = None,
    raan_deg: float = 0.0,
    phase_deg: float = 0.0,
    figure: Figure | str = DEFAULT_FIGURE,
    name: str = "",
    epoch: float = 0.0,
    gm: float = MARS_GM.value,
) -> Constellation:
    """Walker delta pattern i: t/p/f on circular orbits.

    Plane k has ``RAAN = raan + 2 pi k / p``; satellite j of it has argument of latitude
    ``phase + 2 pi j / s + 2 pi f k / t`` with ``s = t/p``.

    Parameters
    ----------
    satellites, planes, phasing
        t, p and f, from 0 to p - 1.
    inclination_deg
        0 to 180 degrees.
    radius_km, altitude_km, orbit, repeat
        One of them: radius from Mars's centre, altitude over the figure's equator,
        ``"areosynchronous"``, or revolutions and rotations of Mars after which the ground tracks
        close. Only with the last two do they count as closed.
    raan_deg, phase_deg
        Node and argument of latitude of the first satellite, degrees.
    figure
        The figure, or its name: `altitude_km` counts from its equator, and orbits must clear it.
    name, epoch, gm
        As in `Constellation`.

    Raises
    ------
    ArgumentError
        The satellites do not divide into the planes, a phasing or an inclination out of range, an
        orbit that is not above the surface, none or several of radius_km, altitude_km, orbit and
        repeat.

    References
    ----------
    Walker 1970, Circular Orbit Patterns Providing Continuous Whole Earth Coverage, RAE TR 70211.

    Examples
    --------
    >>> import compass
    >>> c = compass.walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
    >>> c.pattern.notation, c.size
    ('45°: 15/5/1', 15)
    """
    radius, closed = orbit_radius(radius_km, altitude_km, orbit, repeat, figure)
    counts = satellites, planes, phasing
    pattern = laid_out(WALKER_DELTA, *counts, inclination_deg, raan_deg, phase_deg)
    return from_pattern(pattern, radius, name=name, epoch=epoch, gm=gm, repeat=closed)


@checked
def walker_star(
    satellites: int,
    planes: int,
    phasing: int,
    *,
    inclination_deg: float,
    radius_km: float | None = None,
    altitude_km: float | None = None,
    orbit: str | None = None,
    repeat: Sequence[int] | None = None,
    raan_deg: float = 0.0,
    phase_deg: float = 0.0,
    figure: Figure | str = DEFAULT_FIGURE,
    name: str = "",
    epoch: float = 0.0,
    gm: float = MARS_GM.value,
) -> Constellation:
    """Walker star pattern: as `walker_delta` but with ``RAAN = raan + pi k / p``.

    Neighbouring planes go the same way but for the first and the last, where the satellites
    meet head-on (the seam); with near-polar inclination this is the pattern of Iridium.

    References
    ----------
    Walker 1970, Circular Orbit Patterns Providing Continuous Whole Earth Coverage, RAE TR 70211.

    Examples
    --------
    >>> import compass
    >>> compass.walker_star(66, 6, 2, inclination_deg=86.4, altitude_km=780).pattern.kind
    'walker-star'
    """
    radius, closed = orbit_radius(radius_km, altitude_km, orbit, repeat, figure)
    counts = satellites, planes, phasing
    pattern = laid_out(WALKER_STAR, *counts, inclination_deg, raan_deg, phase_deg)
    return from_pattern(pattern, radius, name=name, epoch=epoch, gm=gm, repeat=closed)


@checked
def rosette(
    satellites: int,
    planes: int,
    multiplier: Fraction | float | str,
    *,
    inclination_deg: float,
    radius_km: float | None = None,
    altitude_km: float | None = None,
    orbit: str | None = None,
    repeat: Sequence[int] | None = None,
    raan_deg: float = 0.0,
    phase_deg: float = 0.0,
    figure: Figure | str = DEFAULT_FIGURE,
    name: str = "",
    epoch: float = 0.0,
    gm: float = MARS_GM.value,
) -> Constellation:
    """Ballard's rosette (N, P, m) on circular orbits: the Walker delta pattern with ``F = m N/P``.

    Parameters
    ----------
    satellites, planes
        N and P.
    multiplier
        m: an integer 0 ... N-1 for P = N, else a multiple of P/N such as ``"1/4"`` or 1.75.
    inclination_deg, radius_km, altitude_km, orbit, repeat
        As in `walker_delta`.
    raan_deg, phase_deg, figure, name, epoch, gm
        As in `walker_delta`.

    Raises
    ------
    ArgumentError
        As `walker_delta` and `compass.orbits.kinds.walker_phasing`.

    References
    ----------
    Ballard 1980, Rosette Constellations of Earth Satellites, IEEE Trans. Aerosp. Electron. Syst.
    AES-16(5):656-673, doi 10.1109/TAES.1980.308932.

    Examples
    --------
    >>> import compass
    >>> c = compass.rosette(12, 3, "1/4", inclination_deg=50.73, orbit="areosynchronous")
    >>> c.name, c.pattern.notation
    ('(12, 3, 1/4)', '50.73°: 12/3/1')
    """
    radius, closed = orbit_radius(radius_km, altitude_km, orbit, repeat, figure)
    counts = satellites, planes, multiplier
    pattern = laid_out(ROSETTE, *counts, inclination_deg, raan_deg, phase_deg)
    called = name or rosette_notation(satellites, planes, ratio_of(multiplier))
    return from_pattern(pattern, radius, name=called, epoch=epoch, gm=gm, repeat=closed)


@checked
def from_elements(
    *,
    semi_major_axis_km: ArrayLike | None = None,
    repeat: Sequence[int] | None = None,
    eccentricity: ArrayLike = 0.0,
    inclination_deg: ArrayLike,
    raan_deg: ArrayLike = 0.0,
    argument_of_periapsis_deg: ArrayLike = 0.0,
    mean_anomaly_deg: ArrayLike | None = None,
    true_anomaly_deg: ArrayLike | None = None,
    figure: Figure | str = DEFAULT_FIGURE,
    name: str = "constellation",
    epoch: float = 0.0,
    satellite_names: Sequence[str] = (),
    gm: float = MARS_GM.value,
) -> Constellation:
    """Make a constellation from Keplerian elements; scalars stand for every satellite.

    Parameters
    ----------
    semi_major_axis_km, eccentricity, inclination_deg, raan_deg, argument_of_periapsis_deg
        Broadcast to a common shape (n,); kilometres and degrees.
    repeat
        Instead of the axis: revolutions and rotations of Mars after which all tracks close.
    mean_anomaly_deg, true_anomaly_deg
        At most one of them; else satellites stand at their periapsis.
    figure
        The figure that orbits must clear, or its name.
    name, epoch, satellite_names, gm
        As in `Constellation`; satellites without names are numbered.

    Raises
    ------
    ArgumentError
        An element that is not finite or that no orbit can have, an orbit that meets the surface.

    Examples
    --------
    >>> import compass
    >>> compass.from_elements(semi_major_axis_km=[9000, 12000], inclination_deg=30).size
    2
    """
    if (semi_major_axis_km is None) == (repeat is None):
        raise ArgumentError("orbit: needs exactly one of semi_major_axis_km and repeat")
    closed = None
    if repeat is None:
        a = np.asarray(semi_major_axis_km, dtype=float) * KM
    else:
        radius, closed = orbit_radius(None, None, None, repeat, figure)
        a = np.asarray(radius)
    e, i = np.asarray(eccentricity, dtype=float), np.asarray(inclination_deg, dtype=float)
    _check_inclination(i)
    if mean_anomaly_deg is not None and true_anomaly_deg is not None:
        raise ArgumentError("anomaly: has both mean_anomaly_deg and true_anomaly_deg; keep one")
    anomaly = np.radians(0.0 if mean_anomaly_deg is None else mean_anomaly_deg)
    if true_anomaly_deg is not None:
        anomaly = mean_of_true(np.radians(true_anomaly_deg), e)
    made = keplerian(
        a,
        e,
        np.radians(i),
        np.radians(raan_deg),
        np.radians(argument_of_periapsis_deg),
        anomaly,
        name=name,
        epoch=epoch,
        satellite_names=satellite_names,
        gm=gm,
        repeat=closed,
    )
    surface = figure_of(figure).equatorial_radius
    for k in np.flatnonzero(made.apoapsis_radius > FARTHEST_KM * KM):
        raise ArgumentError(
            f"semi_major_axis_km = {made.semi_major_axis[k] / KM:g}: apoapsis radius "
            f"{made.apoapsis_radius[k] / KM:g} km; allowed up to {FARTHEST_KM:g} km, where Mars "
            "loses its satellites to the Sun"
        )
    for k in np.flatnonzero(made.periapsis_radius <= surface):
        raise ArgumentError(
            f"semi_major_axis_km = {made.semi_major_axis[k] / KM:g}: periapsis radius "
            f"{made.periapsis_radius[k] / KM:g} km is not above the surface "
            f"({surface / KM:g} km); raise the axis or lower the eccentricity"
        )
    return made


def orbit_radius(
    radius_km: float | None,
    altitude_km: float | None,
    orbit: str | None,
    repeat: Sequence[int] | None = None,
    figure: Figure | str = DEFAULT_FIGURE,
) -> tuple[float, tuple[int, int] | None]:
    """Radius of circular orbits, metres, of the one of the four that is given.

    Returns
    -------
    radius, repeat
        Metres; revolutions and rotations of Mars after which the track is declared to close.

    Raises
    ------
    ArgumentError
        None or several of them, an orbit of another name, a radius that is not above the surface.
    """
    options = {"radius_km": radius_km, "altitude_km": altitude_km, "orbit": orbit, "repeat": repeat}
    given = [name for name, value in options.items() if value is not None]
    if len(given) != 1:
        raise ArgumentError(
            "orbit: needs exactly one of radius_km, altitude_km, orbit and repeat; found "
            f"{' and '.join(given) or 'none'}"
        )
    surface = figure_of(figure).equatorial_radius
    if orbit is not None:
        if orbit != "areosynchronous":
            raise ArgumentError(f"orbit = {orbit!r}: allowed areosynchronous")
        return areosynchronous_radius(), (1, 1)
    if repeat is not None:
        closed = _closed(repeat)
        radius = repeat_radius(*closed)
        if not radius > surface:
            raise ArgumentError(
                f"repeat = {list(closed)}: so many revolutions need a radius of {radius / KM:.6g} "
                f"km, which is not above the surface ({surface / KM:g} km); ask for fewer"
            )
        return radius, closed
    height = real_number(given[0], options[given[0]]) * KM
    radius = height if radius_km is not None else height + surface
    if height > FARTHEST_KM * KM:
        raise ArgumentError(
            f"{given[0]} = {options[given[0]]:g}: allowed up to {FARTHEST_KM:g} km, where Mars "
            "loses its satellites to the Sun; give kilometres"
        )
    if not radius > surface:
        least = surface / KM if radius_km is not None else 0.0
        hint = " (an altitude goes under altitude_km)" if radius_km is not None else ""
        raise ArgumentError(
            f"{given[0]} = {options[given[0]]:g}: is not above the surface; must be more than "
            f"{least:g} km{hint}"
        )
    return float(radius), None


def _closed(repeat: Sequence[int]) -> tuple[int, int]:
    """Revolutions and rotations in lowest terms: no sooner does a track close."""
    if len(repeat) != 2 or any(int(n) != n or not 1 <= n <= 1000 for n in repeat):
        raise ArgumentError(
            f"repeat = {list(repeat)}: must be two whole numbers from 1 to 1000, revolutions and "
            "rotations of Mars"
        )
    whole = Fraction(int(repeat[0]), int(repeat[1]))
    return whole.numerator, whole.denominator


def laid_out(
    kind: PatternKind,
    satellites: int,
    planes: int,
    third: Fraction | float | str,
    inclination_deg: float,
    raan_deg: float = 0.0,
    phase_deg: float = 0.0,
) -> Pattern:
    """Lay a pattern out from the numbers by which its kind writes it down.

    Raises
    ------
    ArgumentError
        As `walker_delta`, for what the kind does not allow.
    """
    numbers = (satellites, planes, third, inclination_deg, raan_deg, phase_deg)
    for parameter, value in zip(kind.parameters, numbers, strict=True):
        parameter.check(value)
    satellites, planes = int(satellites), int(planes)
    phasing = kind.phasing(satellites, planes, third)
    return Pattern(
        kind.layout,
        satellites,
        planes,
        phasing,
        float(np.radians(inclination_deg)),
        float(np.radians(raan_deg)),
        float(np.mod(np.radians(phase_deg), 2 * np.pi)),
    )


def with_changes(
    constellation: Constellation,
    changes: Mapping[str, Any],
    figure: Figure | str = DEFAULT_FIGURE,
) -> Constellation:
    """Lay the pattern that a constellation forms out again, with some of its numbers changed.

    Parameters
    ----------
    constellation
        Whose orbits form a pattern.
    changes
        By the keys of design files: numbers of the pattern's kind, and one of ``radius_km``,
        ``altitude_km``, ``orbit`` and ``repeat``. What is not named stays as it is.
    figure
        From whose equator altitudes count.

    Raises
    ------
    ArgumentError
        The orbits form no pattern, a key is not of its kind, a value is not allowed.
    """
    pattern = constellation.pattern
    if pattern is None:
        raise ArgumentError(
            f"{next(iter(changes))}: the orbits of {constellation.name} form no pattern; "
            "make them anew from elements"
        )
    kind = kind_of(pattern.kind)
    angles = ("inclination", "raan", "phase")
    numbers: dict[str, Any] = {
        "satellites": pattern.satellites,
        "planes": pattern.planes,
        "phasing": pattern.phasing,
        **{f"{angle}_deg": float(np.degrees(getattr(pattern, angle))) for angle in angles},
    }
    height = ("radius_km", "altitude_km", "orbit", "repeat")
    for key in changes:
        if key not in numbers and key not in height:
            guess = near(key, [*numbers, *height])
            allowed = f"did you mean {guess[0]}?" if guess else ", ".join([*numbers, *height])
            raise ArgumentError(f"{key}: unknown; {'' if guess else 'allowed '}{allowed}")
    laid = laid_out(kind, *(changes.get(key, value) for key, value in numbers.items()))
    kept = {a: getattr(pattern, a) for a in angles if f"{a}_deg" not in changes}
    radius, closed = float(constellation.semi_major_axis[0]), constellation.repeat
    if any(key in changes for key in height):
        radius, closed = orbit_radius(
            changes.get("radius_km"),
            changes.get("altitude_km"),
            changes.get("orbit"),
            changes.get("repeat"),
            figure,
        )
    named = constellation.name == pattern.notation
    return from_pattern(
        replace(laid, **kept),
        radius,
        name="" if named else f"{constellation.name}, {worded(changes)}",
        epoch=constellation.epoch,
        gm=constellation.gm,
        repeat=closed,
    )


def worded(changes: Mapping[str, Any]) -> str:
    """What was changed, in words: ``inclination 50 deg, planes 3``."""
    said = []
    for key, value in changes.items():
        name, _, unit = key.rpartition("_")
        number = f"{value:.6g}" if isinstance(value, float) else value
        said.append(f"{name} {number} {unit}" if unit in ("deg", "km") else f"{key} {number}")
    return ", ".join(said)


def _check_inclination(degrees: NDArray[np.float64]) -> None:
    wrong = ~((degrees >= 0) & (degrees <= 180))
    if np.any(wrong):
        raise ArgumentError(
            f"inclination_deg = {degrees[wrong].flat[0]:g}: allowed 0 to 180 degrees"
        )
