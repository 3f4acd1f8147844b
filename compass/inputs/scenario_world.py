"""The world of a scenario file and the entry into it: planet, vehicle, air, winds, first state."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from compass.bodies import MARS_EQUATORIAL_RADIUS, MARS_GM, MARS_J2, MARS_ROTATION_RATE
from compass.entry.atmosphere import Atmosphere, read_atmosphere_table
from compass.entry.mars_air import PROFILE, WINDS
from compass.entry.model import EntryModel
from compass.entry.state import azimuth_from_heading, state_from_cartesian
from compass.entry.vehicle import Vehicle
from compass.inputs.scenario_faults import EXPONENTIAL
from compass.inputs.scenario_models import (
    EntryTable,
    MeasurementsTable,
    ScenarioFile,
    TruthTable,
)
from compass.units import KM

Winds = tuple[tuple[float, float, float], ...]


def model_of(file: ScenarioFile, folder: Path) -> EntryModel:
    """World that the filter knows, and the vehicle in it."""
    planet, craft, air = file.planet, file.vehicle, file.atmosphere
    radius = MARS_EQUATORIAL_RADIUS.value if planet.radius_km is None else planet.radius_km * KM
    mean = all(getattr(air, name) is None for name in (*EXPONENTIAL, "table"))
    altitudes, densities = read_atmosphere_table(folder / air.table) if air.table else ((), ())
    if mean:
        altitudes, densities = zip(*((KM * km, density) for km, density in PROFILE), strict=True)
    tabled = bool(air.table) or mean
    if craft.ballistic_coefficient_kg_m2 is not None:
        drag = 1.0 / craft.ballistic_coefficient_kg_m2
    else:
        drag = craft.drag_area_per_mass_m2_kg or 0.0
    bank = craft.bank_deg if isinstance(craft.bank_deg, list) else [[0.0, craft.bank_deg]]
    return EntryModel(
        Vehicle(
            drag,
            craft.lift_to_drag,
            tuple(pair[0] for pair in bank),
            tuple(float(np.radians(pair[1])) for pair in bank),
            craft.nose_radius_m,
        ),
        Atmosphere(
            # beside a table these three only name a level; the table is flown as it is
            1.0 if tabled else air.reference_density_kg_m3 or 0.0,
            radius + 40.0 * KM if tabled else (air.reference_radius_km or 0.0) * KM,
            1.0 * KM if tabled else (air.scale_height_km or 0.0) * KM,
            tuple(radius + altitude for altitude in altitudes),
            densities,
            air.temperature_k,
            _winds(air.winds_by_km, radius),
        ),
        planet.rotation,
        MARS_GM.value if planet.gm_m3_s2 is None else planet.gm_m3_s2,
        radius,
        MARS_ROTATION_RATE.value
        if planet.rotation_rate_rad_s is None
        else planet.rotation_rate_rad_s,
        MARS_J2.value if planet.gravity == "j2" else 0.0,
    )


def range_sigma_of(table: MeasurementsTable) -> float | None:
    """Own noise of ranges one way: none beside that of a link which is all there is of radio."""
    alone = table.link is not None and table.range_rate_sigma_m_s is None and not table.two_way
    return 0.0 if table.range_sigma_m is None and alone else table.range_sigma_m


def _winds(rows: Sequence[Sequence[float]] | Literal["mars"] | None, radius: float) -> Winds:
    """Rows of a table of winds over distance from the centre."""
    given = WINDS if rows == "mars" else rows or ()
    return tuple((radius + KM * float(km), float(e), float(n)) for km, e, n in given)


def truth_of(model: EntryModel, table: TruthTable) -> EntryModel:
    """World as it is."""
    truth = model.truth(table.density_bias, table.scale_height_factor)
    if table.winds_by_km is None:
        return truth
    winds = _winds(table.winds_by_km, model.planet_radius)
    return replace(truth, atmosphere=replace(truth.atmosphere, winds=winds))


def state_of(table: EntryTable, model: EntryModel) -> NDArray[np.float64]:
    """First state, spherical: radius, longitude, latitude, speed, flight-path angle, azimuth."""
    if table.position_km is not None and table.velocity_m_s is not None:
        return state_from_cartesian(np.array(table.position_km) * KM, table.velocity_m_s)
    if table.radius_km is not None:
        radius = table.radius_km * KM
    else:
        radius = model.planet_radius + (table.altitude_km or 0.0) * KM
    assert table.heading_from is not None  # scenario_faults has seen to these
    lon, lat, gamma, heading = np.radians(
        [
            table.longitude_deg or 0.0,
            table.latitude_deg or 0.0,
            table.flight_path_deg or 0.0,
            table.heading_deg or 0.0,
        ]
    )
    azimuth = float(azimuth_from_heading(heading, table.heading_from))
    return np.array([radius, lon, lat, table.speed_m_s or 0.0, gamma, azimuth])
