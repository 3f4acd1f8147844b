"""Design files: read, check across fields, and turn into a constellation, a mask and sites."""

from datetime import datetime
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.bodies import SOLAR_DAY
from compass.design import Design, Launching, Radio, Upkeep, Wanted
from compass.errors import ArgumentError, DesignError
from compass.frames import FIGURES, Figure, planetocentric_latitude, seconds_past_j2000
from compass.inputs.faults import fault
from compass.inputs.integrity import integrity_faults, integrity_of_table
from compass.inputs.models import (
    AccessTable,
    CoverageTable,
    DeploymentTable,
    DesignFile,
    ElementsTable,
    EphemerisTable,
    KeepingTable,
    LinkTable,
    RosetteTable,
    SatelliteTable,
    StationTable,
)
from compass.inputs.motion import motion_faults, motion_of_table
from compass.inputs.reading import parse, read_text
from compass.inputs.requirements import requirement_faults, requirements_of
from compass.inputs.signal import signal_faults, signal_of_table
from compass.inputs.tracking import tracking_faults, tracking_of_table
from compass.orbits import (
    Constellation,
    keplerian,
    rosette,
    walker_delta,
    walker_star,
)
from compass.orbits.anomaly import mean_of_true
from compass.orbits.kinds import WALKER_DELTA, check_counts, check_phasing, walker_phasing
from compass.orbits.patterns import orbit_radius
from compass.orbits.states import from_states
from compass.saving import readable
from compass.sites import Mask, Site

if TYPE_CHECKING:
    from compass.orbits.trajectory import Trajectory

KM = 1e3


def read_design(path: str | Path) -> Design:
    """Read a design file.

    Raises
    ------
    DesignError
        With every fault of the file: field, value, what is allowed and the remedy.

    Examples
    --------
    >>> import compass
    >>> compass.read_design("designs/compass-15-5-1.toml").constellation.size
    15
    """
    return read_design_text(read_text(Path(path)), readable(path))


def read_design_text(text: str, label: str = "design") -> Design:
    """Read a design from its TOML text; `label` stands for the file name in messages."""
    file = parse(text, label, DesignFile, cross_faults)
    figure, folder = FIGURES[file.figure], Path(label).parent
    table = _ephemeris(file, folder, label)
    motion = motion_of_table(file.motion, folder, label, table)
    stations = tuple(site_of(station, figure) for station in file.station)
    return Design(
        name=file.name,
        source=file.source,
        paper=file.paper,
        figure=figure,
        constellation=_constellation(file, figure, table),
        mask=mask_of(file.coverage),
        fold=file.coverage.fold,
        stations=stations,
        requirements=requirements_of(file.requirement, stations),
        access=_wanted(file.access),
        access_duration=file.access.duration_sols * SOLAR_DAY.value,
        conjunction=float(np.radians(file.access.conjunction_deg)),
        radios=tuple(_radio(link) for link in file.link),
        signal=None if file.signal is None else signal_of_table(file.signal),
        tracking=None if file.tracking is None else tracking_of_table(file.tracking),
        integrity=None if file.integrity is None else integrity_of_table(file.integrity),
        text=text,
        label=label,
        motion=motion,
        upkeep=_upkeep(file.keeping),
        launching=_launching(file.deployment),
    )


def _launching(table: DeploymentTable) -> Launching:
    low, high = sorted(table.waiting_altitude_km)
    return Launching(
        table.launch_altitude_km * KM,
        (low * KM, high * KM),
        table.longest_wait_days * 86400.0,
        table.satellites_a_launch,
    )


def _upkeep(table: KeepingTable) -> Upkeep:
    return Upkeep(
        table.specific_impulse_s,
        table.dry_mass_kg,
        table.smallest_burn_m_s,
        table.execution_error,
        table.navigation_error_m,
        table.years * 365.25 * 86400.0,
    )


def _ephemeris(file: DesignFile, folder: Path, label: str) -> "Trajectory | None":
    """Trajectory of a design's files, if it is made of such."""
    if not isinstance(file.constellation, EphemerisTable):
        return None
    from compass.inputs.oem import read_ephemerides

    epoch = None if file.epoch is None else seconds_past_j2000(file.epoch)
    try:
        return read_ephemerides(file.constellation.files, folder, epoch)
    except DesignError as error:
        raise DesignError(f"{label}: {error}") from error


def _osculating(file: DesignFile, table: "Trajectory") -> Constellation:
    """Ellipses that touch the paths of a table at its epoch."""
    r, v = table.states([max(table.start, 0.0)])
    return from_states(
        r[:, 0],
        v[:, 0],
        name=file.name,
        epoch=table.epoch,
        satellite_names=table.satellite_names,
    )


def _constellation(
    file: DesignFile, figure: Figure, ephemeris: "Trajectory | None" = None
) -> Constellation:
    table, epoch = file.constellation, seconds_past_j2000(file.epoch) if file.epoch else 0.0
    if isinstance(table, EphemerisTable):
        assert ephemeris is not None
        return _osculating(file, ephemeris)
    if isinstance(table, ElementsTable):
        shapes = [_shape(s.model_dump(), figure) for s in table.satellite]
        axes, eccentricities = np.array(shapes).T
        return keplerian(
            axes * KM,
            eccentricities,
            np.radians([s.inclination_deg for s in table.satellite]),
            np.radians([s.raan_deg for s in table.satellite]),
            np.radians([s.argument_of_periapsis_deg for s in table.satellite]),
            [_anomaly(s, e) for s, e in zip(table.satellite, eccentricities, strict=True)],
            name=file.name,
            epoch=epoch,
            satellite_names=[s.name for s in table.satellite],
        )
    orbit: dict[str, Any] = {
        "inclination_deg": table.inclination_deg,
        "radius_km": table.radius_km,
        "altitude_km": table.altitude_km,
        "orbit": table.orbit,
        "repeat": table.repeat,
        "raan_deg": table.raan_deg,
        "phase_deg": table.phase_deg,
        "figure": figure,
        "name": file.name,
        "epoch": epoch,
    }
    if isinstance(table, RosetteTable):
        return rosette(table.satellites, table.planes, Fraction(table.multiplier), **orbit)
    make = walker_delta if table.pattern == WALKER_DELTA.name else walker_star
    return make(table.satellites, table.planes, table.phasing, **orbit)


def _shape(satellite: dict[str, Any], figure: Figure) -> tuple[float, float]:
    """Semi-major axis (km) and eccentricity of a satellite's table."""
    if satellite.get("semi_major_axis_km") is not None:
        return satellite["semi_major_axis_km"], satellite.get("eccentricity") or 0.0
    surface = figure.equatorial_radius / KM
    low = satellite["periapsis_altitude_km"] + surface
    high = satellite["apoapsis_altitude_km"] + surface
    return (low + high) / 2, (high - low) / (high + low)


def _anomaly(satellite: SatelliteTable, eccentricity: float) -> float:
    """Mean anomaly of a satellite, radians."""
    if satellite.true_anomaly_deg is None:
        return float(np.radians(satellite.mean_anomaly_deg))
    return float(mean_of_true(np.radians(satellite.true_anomaly_deg), eccentricity))


def mask_of(table: CoverageTable | StationTable) -> Mask:
    """Mask of a table: constant, or a horizon by azimuth."""
    return Mask.of(table.mask_deg if table.horizon_deg is None else table.horizon_deg)


def site_of(table: StationTable, figure: Figure) -> Site:
    """Site of a station's table."""
    latitude = np.radians(table.latitude_deg)
    if table.latitude_kind == "planetographic":
        latitude = planetocentric_latitude(latitude, figure)
    return Site(
        table.name,
        float(latitude),
        float(np.radians(table.longitude_deg)),
        table.height_km * KM,
        mask_of(table),
        figure,
    )


def _wanted(table: AccessTable) -> Wanted:
    return Wanted(
        tuple(table.moons), table.earth, table.crosslinks, table.atmosphere_height_km * KM
    )


def _radio(table: LinkTable) -> Radio:
    one, two = table.between
    return Radio(
        (one, two),
        table.frequency_mhz * 1e6,
        table.eirp_dbw,
        table.g_over_t_db_per_k,
        table.required_cn0_dbhz,
    )


def cross_faults(raw: dict[str, Any]) -> list[str]:
    """Faults between fields of a design, found on the raw tables, whatever is in them."""
    figure_name = raw.get("figure", "iau-sphere")
    figure = FIGURES.get(figure_name if isinstance(figure_name, str) else "", FIGURES["iau-sphere"])
    faults: list[str] = []
    table = raw.get("constellation")
    if isinstance(table, dict):
        if table.get("pattern") == "elements":
            faults += _satellite_faults(table.get("satellite"), figure)
        elif table.get("pattern") != "ephemeris":
            faults += _pattern_faults(table) + _orbit_faults(table, figure)
    faults += motion_faults(raw) + requirement_faults(raw)
    faults += signal_faults(raw) + tracking_faults(raw) + integrity_faults(raw)
    faults += place_faults(raw)
    access = raw.get("access")
    moons = access.get("moons") if isinstance(access, dict) else None
    if isinstance(moons, list) and len(moons) == 2 and moons[0] == moons[1]:
        faults.append(fault("access.moons", moons, "names a moon twice; keep one"))
    epoch = raw.get("epoch")
    if isinstance(epoch, datetime) and epoch.tzinfo is not None:
        faults.append(
            fault(
                "epoch", epoch.isoformat(), "must be TDB, without a time zone; drop the Z or offset"
            )
        )
    return faults


def place_faults(raw: dict[str, Any]) -> list[str]:
    """Faults of the mask and the stations, across fields."""
    faults: list[str] = []
    if isinstance(raw.get("coverage"), dict):
        faults += _horizon_faults(raw["coverage"], "coverage")
    stations, names = raw.get("station"), set()
    for k, station in enumerate(stations if isinstance(stations, list) else [], start=1):
        if isinstance(station, dict):
            faults += _horizon_faults(station, f"station[{k}]")
            name = station.get("name")
            if isinstance(name, str) and name in names:
                faults.append(fault(f"station[{k}].name", name, "used twice; rename one"))
            names.add(name if isinstance(name, str) else None)
    return faults


def _number(table: dict[str, Any], key: str) -> float | None:
    """Return the value of `key` if it is a usable number, else None (the model reports it)."""
    value = table.get(key)
    usable = isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e15
    return value if usable else None


def _pattern_faults(table: dict[str, Any]) -> list[str]:
    satellites, planes = _count(table, "satellites"), _count(table, "planes")
    if satellites is None or planes is None:
        return []
    try:
        check_counts(satellites, planes)
    except ArgumentError as error:
        return [f"constellation.{error}"]
    if table.get("pattern") == "rosette":
        multiplier = table.get("multiplier")
        if isinstance(multiplier, bool) or not isinstance(multiplier, str | int | float):
            return []
        try:
            # of an exponent, "1e999999999", Fraction would write out every digit
            if isinstance(multiplier, str) and ("e" in multiplier.lower() or len(multiplier) > 40):
                raise ValueError
            walker_phasing(satellites, planes, Fraction(multiplier))
        except ArgumentError as error:
            return [f"constellation.{error}"]
        except (ValueError, ZeroDivisionError, OverflowError):
            allowed = 'must be a finite number or a fraction such as "1/4"'
            return [fault("constellation.multiplier", multiplier, allowed)]
        return []
    phasing = table.get("phasing")
    if isinstance(phasing, int) and not isinstance(phasing, bool) and phasing >= 0:
        try:
            check_phasing(phasing, planes)
        except ArgumentError as error:
            return [f"constellation.{error}"]
    return []


def _count(table: dict[str, Any], key: str) -> int | None:
    """Return the value of `key` if it is a usable count, else None (the model reports it)."""
    value = table.get(key)
    usable = isinstance(value, int) and not isinstance(value, bool) and 1 <= value <= 10_000
    return value if usable else None


def _orbit_faults(table: dict[str, Any], figure: Figure) -> list[str]:
    given = [key for key in ("radius_km", "altitude_km", "orbit", "repeat") if key in table]
    faults = []
    if len(given) != 1:
        found = " and ".join(given) or "none"
        faults.append(
            "constellation: needs exactly one of radius_km, altitude_km, orbit and repeat; found "
            f"{found}"
        )
    radius, surface = _number(table, "radius_km"), figure.equatorial_radius / KM
    closed = table.get("repeat")
    if len(given) == 1 and isinstance(closed, list):
        try:
            orbit_radius(None, None, None, [n if isinstance(n, int) else 1 for n in closed], figure)
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
        by_axis = "semi_major_axis_km" in satellite or "eccentricity" in satellite
        by_height = "periapsis_altitude_km" in satellite or "apoapsis_altitude_km" in satellite
        if by_axis == by_height:
            faults.append(
                f"{field}: needs either semi_major_axis_km (and eccentricity) or "
                "periapsis_altitude_km and apoapsis_altitude_km"
            )
            continue
        keys = (
            ("semi_major_axis_km",)
            if by_axis
            else ("periapsis_altitude_km", "apoapsis_altitude_km")
        )
        missing = [key for key in keys if key not in satellite]
        faults += [f"{field}.{key}: missing; needed beside the others" for key in missing]
        if missing or any(_number(satellite, key) is None for key in keys):
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
        axis, e = satellite["semi_major_axis_km"], _number(satellite, "eccentricity") or 0.0
        if 0 <= e < 1 and 0 < axis * (1 - e) <= surface:
            faults.append(
                fault(
                    f"{field}.semi_major_axis_km",
                    axis,
                    f"periapsis radius {axis * (1 - e):g} km is not above the surface "
                    f"({surface:g} km); raise the axis or lower the eccentricity",
                )
            )
    return faults


def _horizon_faults(table: dict[str, Any], field: str) -> list[str]:
    pairs = table.get("horizon_deg")
    if pairs is None:
        return []
    if "mask_deg" in table:
        return [f"{field}: has both mask_deg and horizon_deg; keep one"]
    usable = isinstance(pairs, list) and all(
        isinstance(pair, list)
        and len(pair) == 2
        and all(isinstance(x, int | float) and not isinstance(x, bool) for x in pair)
        for pair in pairs
    )
    if not usable:
        return []  # the model says what is wrong with it
    try:
        azimuths, elevations = np.radians(np.array(pairs, dtype=float).reshape(-1, 2)).T
        Mask(tuple(azimuths), tuple(elevations))
    except (ArgumentError, OverflowError) as error:
        return [f"{field}.horizon_deg: {str(error).removeprefix('mask: ')}"]
    return []
