"""The table ``[constellation]``: patterns and elements checked, and turned into orbits."""

import math
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from compass.errors import ArgumentError
from compass.frames import Figure
from compass.inputs.faults import fault
from compass.inputs.models import ElementsTable, PatternTable, SatelliteTable
from compass.orbits.anomaly import mean_of_true
from compass.orbits.constellation import Constellation, declared, from_pattern, keplerian
from compass.orbits.kinds import KIND_NAMES, Parameter, check_counts, kind_of
from compass.orbits.patterns import laid_out, orbit_radius
from compass.units import KM


def constellation_of(
    table: ElementsTable | PatternTable, figure: Figure, name: str, epoch: float
) -> Constellation:
    """Constellation of a checked table; epoch in TDB seconds past J2000."""
    if isinstance(table, ElementsTable):
        return _of_elements(table, figure, name, epoch)
    kind = kind_of(table.pattern)
    radius, closed = orbit_radius(
        table.radius_km, table.altitude_km, table.orbit, table.repeat, figure
    )
    pattern = laid_out(
        kind,
        table.satellites,
        table.planes,
        _third(getattr(table, kind.third)),
        table.inclination_deg,
        raan_deg=table.raan_deg,
        phase_deg=table.phase_deg,
    )
    return from_pattern(pattern, radius, name=name, epoch=epoch, repeat=closed)


def _third(written: str | float) -> Fraction | float:
    """Return the number beside satellites and planes, as it may be written: 1, 0.25 or "1/4".

    Raises
    ------
    ValueError
        A text that is no number; of an exponent, "1e999999999", every digit would be written out.
    """
    if not isinstance(written, str):
        return written
    if "e" in written.lower() or len(written) > 40:
        raise ValueError
    return Fraction(written)


def _of_elements(table: ElementsTable, figure: Figure, name: str, epoch: float) -> Constellation:
    shapes = [_shape(s.model_dump(), figure) for s in table.satellite]
    axes, eccentricities = np.array([shape[:2] for shape in shapes]).T
    made = keplerian(
        axes,
        eccentricities,
        np.radians([s.inclination_deg for s in table.satellite]),
        np.radians([s.raan_deg for s in table.satellite]),
        np.radians([s.argument_of_periapsis_deg for s in table.satellite]),
        [_anomaly(s, e) for s, e in zip(table.satellite, eccentricities, strict=True)],
        name=name,
        epoch=epoch,
        satellite_names=[s.name for s in table.satellite],
    )
    return replace(made, **declared([shape[2] for shape in shapes]))


def _shape(
    satellite: dict[str, Any], figure: Figure
) -> tuple[float, float, tuple[int, int] | None]:
    """Semi-major axis (m) and eccentricity of a satellite's table, and after what it closes."""
    eccentricity = satellite.get("eccentricity") or 0.0
    if satellite.get("repeat") is not None:
        axis, closed = orbit_radius(None, None, None, satellite["repeat"], figure)
        return axis, eccentricity, closed
    if satellite.get("semi_major_axis_km") is not None:
        return satellite["semi_major_axis_km"] * KM, eccentricity, None
    surface = figure.equatorial_radius / KM
    low = satellite["periapsis_altitude_km"] + surface
    high = satellite["apoapsis_altitude_km"] + surface
    return (low + high) / 2 * KM, (high - low) / (high + low), None


def _anomaly(satellite: SatelliteTable, eccentricity: float) -> float:
    """Mean anomaly of a satellite, radians."""
    if satellite.true_anomaly_deg is None:
        return float(np.radians(satellite.mean_anomaly_deg))
    return float(mean_of_true(np.radians(satellite.true_anomaly_deg), eccentricity))


def constellation_faults(table: dict[str, Any], figure: Figure) -> list[str]:
    """Faults of ``[constellation]`` across fields, found on the raw table, whatever is in it."""
    if table.get("pattern") == "elements":
        return _satellite_faults(table.get("satellite"), figure)
    if table.get("pattern") == "ephemeris":
        return []
    return _pattern_faults(table) + _orbit_faults(table, figure)


def _number(table: dict[str, Any], key: str) -> float | None:
    """Return the value of `key` if it is a usable number, else None (the model reports it)."""
    value = table.get(key)
    usable = isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e15
    return value if usable else None


def _pattern_faults(table: dict[str, Any]) -> list[str]:
    satellites, planes = _count(table, "satellites"), _count(table, "planes")
    if satellites is None or planes is None:
        return []
    kind = kind_of(str(table["pattern"])) if table.get("pattern") in KIND_NAMES else None
    third: Any = None if kind is None else table.get(kind.third)
    try:
        check_counts(satellites, planes)
        if kind is not None and _is_written(kind.parameters[2], third):
            kind.phasing(satellites, planes, _third(third))
    except ArgumentError as error:
        return [f"constellation.{error}"]
    except (ValueError, ZeroDivisionError, OverflowError):
        allowed = 'must be a finite number or a fraction such as "1/4"'
        return [fault("constellation.multiplier", third, allowed)]
    return []


def _is_written(parameter: Parameter, value: Any) -> bool:
    """Whether a raw value is of a parameter's form and range; if not the model says so."""
    if isinstance(value, bool):
        return False
    if parameter.form == "ratio":
        return isinstance(value, str | int) or (isinstance(value, float) and math.isfinite(value))
    return isinstance(value, int) and value >= (parameter.least or 0)


def _count(table: dict[str, Any], key: str) -> int | None:
    """Return the value of `key` if it is a usable count, else None (the model reports it)."""
    value = table.get(key)
    usable = isinstance(value, int) and not isinstance(value, bool) and 1 <= value <= 10_000
    return value if usable else None


def _orbit_faults(table: dict[str, Any], figure: Figure) -> list[str]:
    given = [key for key in ("radius_km", "altitude_km", "orbit", "repeat") if key in table]
    faults = []
    if len(given) != 1:
        said = " and ".join(given) or "none"
        faults.append(
            "constellation: needs exactly one of radius_km, altitude_km, orbit and repeat; found "
            f"{said}"
        )
    radius, surface = _number(table, "radius_km"), figure.equatorial_radius / KM
    if len(given) == 1 and "repeat" in table:
        try:
            _closing_axis(table["repeat"], figure)
        except ArgumentError as error:
            faults.append(f"constellation.{error}")
    if radius is not None and 0 < radius <= surface:
        faults.append(
            fault(
                "constellation.radius_km",
                radius,
                f"is not above the surface; must be more than {surface:g} km "
                "(an altitude goes under altitude_km)",
            )
        )
    return faults


def _closing_axis(repeat: object, figure: Figure) -> float | None:
    """Semi-major axis of a raw ``repeat``, km; None of what is none (the model reports it).

    Raises
    ------
    ArgumentError
        As `orbit_radius`.
    """
    if not isinstance(repeat, list) or len(repeat) != 2:
        return None
    if any(type(n) is not int or not 1 <= n <= 1000 for n in repeat):
        return None
    return orbit_radius(None, None, None, repeat, figure)[0] / KM


def _satellite_faults(satellites: object, figure: Figure) -> list[str]:
    faults, names = [], set()
    surface = figure.equatorial_radius / KM
    for k, satellite in enumerate(satellites if isinstance(satellites, list) else [], start=1):
        if not isinstance(satellite, dict):
            continue
        field = f"constellation.satellite[{k}]"
        name = satellite.get("name")
        if isinstance(name, str):
            if name in names:
                faults.append(fault(f"{field}.name", name, "used twice; give each its own name"))
            names.add(name)
        if "mean_anomaly_deg" in satellite and "true_anomaly_deg" in satellite:
            faults.append(f"{field}: has both mean_anomaly_deg and true_anomaly_deg; keep one")
        by_repeat = "repeat" in satellite
        by_axis = "semi_major_axis_km" in satellite or (
            "eccentricity" in satellite and not by_repeat
        )
        by_height = "periapsis_altitude_km" in satellite or "apoapsis_altitude_km" in satellite
        if by_axis + by_repeat + by_height != 1 or (by_height and "eccentricity" in satellite):
            faults.append(
                f"{field}: needs either semi_major_axis_km (and eccentricity), repeat (and "
                "eccentricity), or periapsis_altitude_km and apoapsis_altitude_km"
            )
            continue
        keys = (
            ("semi_major_axis_km",)
            if by_axis
            else ("repeat",)
            if by_repeat
            else ("periapsis_altitude_km", "apoapsis_altitude_km")
        )
        missing = [key for key in keys if key not in satellite]
        faults += [f"{field}.{key}: missing; needed beside the others" for key in missing]
        if missing or (not by_repeat and any(_number(satellite, key) is None for key in keys)):
            continue
        if by_height:
            low, high = (satellite[key] for key in keys)
            if low > high:
                faults.append(
                    fault(
                        f"{field}.periapsis_altitude_km",
                        low,
                        f"is above apoapsis_altitude_km = {high}; swap them",
                    )
                )
            continue
        e, key = _number(satellite, "eccentricity") or 0.0, keys[0]
        try:
            axis = _closing_axis(satellite[key], figure) if by_repeat else satellite[key]
        except ArgumentError as error:
            faults.append(f"{field}.{error}")
            continue
        if axis is not None and 0 <= e < 1 and 0 < axis * (1 - e) <= surface:
            faults.append(
                fault(
                    f"{field}.{key}",
                    satellite[key],
                    f"periapsis radius {axis * (1 - e):g} km is not above the surface "
                    f"({surface:g} km); raise the axis or lower the eccentricity",
                )
            )
    return faults
