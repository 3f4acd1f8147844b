"""The fusion part of a scenario, turned into a case with accelerometers, filters and faults."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from compass.entry.atmosphere import read_atmosphere_table
from compass.entry.beacons import Beacons
from compass.entry.faults import Fault, fault_tables
from compass.entry.fused import FusedFilter
from compass.entry.inertial import InertialCase
from compass.entry.radio import PER_CM3, STAGNATION, WAKE, ElectronModel, ElectronTable
from compass.entry.trajectory import fly
from compass.entry.views import cartesian_of, spherical_jacobian
from compass.errors import ArgumentError, CompassError, DesignError
from compass.inputs.fusion_models import EstimateTable, FusionTable, RadioTable
from compass.units import KM

if TYPE_CHECKING:
    from compass.entry.model import EntryModel
    from compass.inputs.scenario import Scenario


@dataclass(frozen=True)
class FusionPlan:
    """What is to be flown and filtered.

    Attributes
    ----------
    case
        The truth.
    filters
        Filters to compare.
    faults
        What goes wrong in a second set of runs.
    electrons
        Model of the plasma, or None.
    see_through
        Whether ranges pass through the planet.
    runs, seed
        Of the Monte Carlo.
    """

    case: InertialCase
    filters: tuple[FusedFilter, ...]
    faults: tuple[Fault, ...]
    electrons: ElectronModel | ElectronTable | None
    see_through: bool
    runs: int
    seed: int


def fusion_plan(scenario: "Scenario") -> FusionPlan | None:
    """Return what a scenario's [fusion] asks for; None if it has none.

    Raises
    ------
    DesignError
        Values that do not fit together, with the field.
    """
    if scenario.fusion is None:
        return None
    try:
        return _plan(scenario.planned(), scenario.fusion)
    except DesignError:
        raise
    except CompassError as error:
        raise DesignError(f"{scenario.label}: fusion: {error}") from error


def _plan(scenario: "Scenario", table: FusionTable) -> FusionPlan:
    beacons = scenario.beacons()
    n = len(table.process_noise_si)
    if len(table.p0_si) != n:
        raise ArgumentError(
            f"p0_si: {len(table.p0_si)} values, process_noise_si: {n}; give as many"
        )
    if table.published_linear_density:
        raise ArgumentError(
            "published_linear_density: filters here carry ln rho0; those of the papers, with rho0 "
            "itself, are run by compass reproduce; leave it out"
        )
    noise = np.array(table.process_noise_si)
    true_noise = np.zeros(8)
    if table.noisy_truth:
        true_noise[: min(n, 8)] = noise[:8]
    case = InertialCase(
        name=scenario.name,
        flight=fly(scenario.truth, scenario.state, scenario.times),
        beacons=beacons,
        measurements=scenario.measurements,
        sigma=_sigma(scenario, table, beacons),
        imu_sigma=np.full(3, table.acceleration_sigma_m_s2),
        imu_bias=np.array(table.acceleration_bias_m_s2),
        noise=true_noise,
    )
    electrons = _electrons(table.radio, Path(scenario.label).parent)
    if electrons is not None:
        case = case.through_plasma(electrons)
    first = cartesian_of(_start(scenario.state, table.estimate))
    turned = spherical_jacobian(first) * np.sqrt(table.p0_si[:6])
    clock = table.clock
    assumed = table.assumed_acceleration_sigma_m_s2 or table.acceleration_sigma_m_s2
    filters = tuple(
        FusedFilter(
            algorithm=algorithm,
            model=_assumed(scenario.model, table.estimate),
            first=first,
            covariance0=turned @ turned.T,
            further=np.array(table.p0_si[6:]),
            clock=() if clock is None else (clock.sigma_m, clock.drift_sigma_m_s),
            noise=noise,
            imu_variance=np.full(3, assumed**2),
            random_start=table.random_start,
            known_to=(table.known_to[0], table.known_to[1]),
            weighting=table.weighting,
            scaled=table.scaled_weights,
            weight_floor=table.weight_floor,
            gate_sigma=table.gate_sigma or np.inf,
            gate_start=table.gate_start_s,
        )
        for algorithm in table.filters
    )
    faults = tuple(
        Fault(f.kind, f.beacon, f.start_s, np.inf if f.end_s is None else f.end_s, f.size_m)
        for f in table.fault
    )
    fault_tables(faults, case.times, beacons.names)  # says now what is wrong with them
    return FusionPlan(
        case=case,
        filters=filters,
        faults=faults,
        electrons=electrons,
        see_through=table.see_through_planet,
        runs=scenario.runs,
        seed=scenario.seed,
    )


def _sigma(scenario: "Scenario", table: FusionTable, beacons: Beacons) -> NDArray[np.float64]:
    """Noise of each beacon's ranges (m), by the table's own numbers, and range rates (m/s)."""
    common = (scenario.measurements.range_sigma, scenario.measurements.rate_sigma)
    out = np.tile([np.nan if sigma is None else sigma for sigma in common], (beacons.size, 1))
    if table.range_sigma_m is not None:
        if len(table.range_sigma_m) != beacons.size:
            raise ArgumentError(
                f"range_sigma_m: {len(table.range_sigma_m)} values for {beacons.size} beacons "
                f"({', '.join(beacons.names)}); give one each"
            )
        out[:, 0] = table.range_sigma_m
    return out


def _electrons(table: RadioTable | None, folder: Path) -> ElectronModel | ElectronTable | None:
    if table is None:
        return None
    if (table.electrons == "table") != (table.table is not None):
        raise ArgumentError(
            f'radio.table = {table.table!r}: needed with electrons = "table", and only then'
        )
    if table.table is None:
        return STAGNATION if table.electrons == "stagnation" else WAKE
    altitudes, per_cm3 = read_atmosphere_table(folder / table.table)
    return ElectronTable(altitudes, tuple(PER_CM3 * n for n in per_cm3))


def _assumed(model: "EntryModel", table: EstimateTable) -> "EntryModel":
    """Return the model with the density, L/D and C_D S/m that the filters assume."""
    air, craft = model.atmosphere, model.vehicle
    if table.reference_density_kg_m3 is not None:
        air = air.of_density(table.reference_density_kg_m3)
    if table.lift_to_drag is not None:
        craft = replace(craft, lift_to_drag=table.lift_to_drag)
    if table.drag_area_per_mass_m2_kg is not None:
        craft = replace(craft, drag_area_per_mass=table.drag_area_per_mass_m2_kg)
    return replace(model, atmosphere=air, vehicle=craft)


def _start(state: NDArray[np.float64], table: EstimateTable) -> NDArray[np.float64]:
    given = [
        (table.radius_km, KM),
        (table.longitude_deg, np.pi / 180),
        (table.latitude_deg, np.pi / 180),
        (table.speed_m_s, 1.0),
        (table.flight_path_deg, np.pi / 180),
        (table.azimuth_deg, np.pi / 180),
    ]
    return np.array(
        [
            true if value is None else value * unit
            for true, (value, unit) in zip(state[:6], given, strict=True)
        ]
    )
