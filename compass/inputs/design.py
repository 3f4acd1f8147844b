"""Design files: read, check across fields, and turn into a constellation, a mask and sites."""

from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.arguments import checked
from compass.bodies import SOLAR_DAY
from compass.design import Design, Launching, Upkeep
from compass.errors import ArgumentError, DesignError
from compass.frames import FIGURES, Figure, planetocentric_latitude, seconds_past_j2000
from compass.inputs.constellation import constellation_faults, constellation_of
from compass.inputs.faults import fault
from compass.inputs.integrity import integrity_faults, integrity_of_table
from compass.inputs.models import (
    AccessTable,
    CoverageTable,
    DeploymentTable,
    DesignFile,
    EphemerisTable,
    KeepingTable,
    LinkTable,
    StationTable,
)
from compass.inputs.motion import motion_faults, motion_of_table
from compass.inputs.reading import parse, read_text
from compass.inputs.requirements import requirement_faults, requirements_of
from compass.inputs.signal import signal_faults, signal_of_table
from compass.inputs.tracking import tracking_faults, tracking_of_table
from compass.links import Radio, Wanted
from compass.orbits import Constellation
from compass.orbits.states import from_states
from compass.saving import readable
from compass.sites import Mask, Site
from compass.units import KM

if TYPE_CHECKING:
    from compass.orbits.trajectory import Trajectory


@checked
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
    if isinstance(file.constellation, EphemerisTable):
        assert table is not None
        constellation = _osculating(file, table)
    else:
        epoch = seconds_past_j2000(file.epoch) if file.epoch else 0.0
        constellation = constellation_of(file.constellation, figure, file.name, epoch)
    return Design(
        name=file.name,
        source=file.source,
        paper=file.paper,
        figure=figure,
        constellation=constellation,
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
        launching=launching_of(file.deployment),
    )


def launching_of(table: DeploymentTable) -> Launching:
    """How satellites come to their planes, of a design's or a study's table."""
    low, high = sorted(table.waiting_altitude_km)
    return Launching(
        table.launch_altitude_km * KM,
        (low * KM, high * KM),
        table.longest_wait_days * 86400.0,
        table.satellites_a_launch,
    )


def _upkeep(table: KeepingTable) -> Upkeep:
    return Upkeep(
        specific_impulse=table.specific_impulse_s,
        dry_mass=table.dry_mass_kg,
        smallest_burn=table.smallest_burn_m_s,
        execution_error=table.execution_error,
        navigation_error=table.navigation_error_m,
        duration=table.years * 365.25 * 86400.0,
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


def mask_of(table: CoverageTable | StationTable) -> Mask:
    """Mask of a table: constant, or a horizon by azimuth."""
    return Mask.of(table.mask_deg if table.horizon_deg is None else table.horizon_deg)


def site_of(table: StationTable, figure: Figure) -> Site:
    """Site of a station's table."""
    latitude = np.radians(table.latitude_deg)
    if table.latitude_kind == "planetographic":
        latitude = planetocentric_latitude(latitude, figure)
    return Site(
        name=table.name,
        latitude=float(latitude),
        longitude=float(np.radians(table.longitude_deg)),
        height=table.height_km * KM,
        mask=mask_of(table),
        figure=figure,
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
        faults += constellation_faults(table, figure)
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
        Mask(tuple(azimuths), tuple(elevations)).on_the_ground()
    except (ArgumentError, OverflowError) as error:
        return [f"{field}.horizon_deg: {str(error).removeprefix('mask: ')}"]
    return []
