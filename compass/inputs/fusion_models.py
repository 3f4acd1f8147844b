"""What the table [fusion] of a scenario may say: accelerometers, filters, radio and faults."""

from typing import Annotated, Literal

from pydantic import Field

from compass.entry.fused_kinds import Algorithm, Weighting
from compass.inputs.models import Kilometres
from compass.inputs.table import Table

Positive = Annotated[float, Field(gt=0, le=1e15)]
NotNegative = Annotated[float, Field(ge=0, le=1e15)]
Triple = Annotated[list[float], Field(min_length=3, max_length=3)]
StateVariances = Annotated[list[NotNegative], Field(min_length=6, max_length=11)]


class EstimateTable(Table):
    """What the filters start from and assume, where it differs from the truth."""

    radius_km: Kilometres | None = Field(None, description="distance from Mars's centre, km")
    longitude_deg: float | None = Field(None, description="east longitude, degrees")
    latitude_deg: float | None = Field(None, description="planetocentric latitude, degrees")
    speed_m_s: Positive | None = Field(None, description="speed, m/s")
    flight_path_deg: float | None = Field(None, description="flight-path angle, degrees")
    azimuth_deg: float | None = Field(None, description="azimuth, clockwise from north, degrees")
    reference_density_kg_m3: Positive | None = Field(
        None, description="density at the reference radius, kg/m^3"
    )
    lift_to_drag: float | None = Field(None, ge=-10, le=10, description="L/D")
    drag_area_per_mass_m2_kg: Positive | None = Field(None, description="C_D S / m, m^2/kg")


class RadioTable(Table):
    """What the plasma around the lander does to the ranges."""

    electrons: Literal["stagnation", "wake", "table"] = Field(
        description="electron density: the surrogate at the stagnation point or in the wake "
        "(fitted to one trajectory), or a table"
    )
    table: str | None = Field(
        None, min_length=1, description="file of altitude (km) and electrons per cm^3, two columns"
    )


class FaultTable(Table):
    """Something that goes wrong."""

    kind: Literal["outage", "bias", "spike", "all-ranges-lost", "subsystem-dead"] = Field(
        description="kind of fault"
    )
    beacon: str = Field("", description="name of the beacon")
    start_s: float = Field(0.0, ge=0, description="when it begins, s")
    end_s: float | None = Field(None, ge=0, description="when it ends, s; the end if left out")
    size_m: float = Field(0.0, description="error of the range, m, for bias and spike")


class FusedClockTable(Table):
    """The receiver's clock, whose first error is drawn in every run and estimated."""

    sigma_m: Positive = Field(description="one sigma of the clock, m")
    drift_sigma_m_s: Positive = Field(description="one sigma of its drift, m/s")


class FusionTable(Table):
    """Accelerometers and ranges in centralised and distributed filters."""

    filters: Annotated[list[Algorithm], Field(min_length=1, max_length=8)] = Field(
        description="filters to compare"
    )
    weighting: Weighting | None = Field(
        None, description="rule of the fusion weights; each filter's usual one if left out"
    )
    scaled_weights: bool = Field(
        True, description="weigh information in scaled units rather than SI"
    )
    weight_floor: Annotated[float, Field(gt=0, lt=1)] = Field(
        1e-3, description="smallest weight a covariance is divided by, above 0 to below 1"
    )
    gate_sigma: Positive | None = Field(
        None, description="innovations beyond this many sigma are refused; none if left out"
    )
    gate_start_s: float = Field(
        0.0, ge=0, description="when the gate is first shut, s: after the filters have settled"
    )
    p0_si: StateVariances = Field(
        description="variances of the start: 6, 8 or 11 numbers in m, rad, m/s, then ln rho0, L/D, "
        "then accelerometer biases"
    )
    process_noise_si: StateVariances = Field(
        description="variances added a second, as many as p0_si"
    )
    clock: FusedClockTable | None = Field(
        None, description="the receiver's clock, estimated; agrees with the beacons' if left out"
    )
    noisy_truth: bool = Field(
        False, description="the truth takes the process noise too: needed to judge consistency"
    )
    random_start: bool = Field(
        False, description="draw each run's start from p0_si instead of taking the estimate itself"
    )
    known_to: Annotated[list[NotNegative], Field(min_length=2, max_length=2)] = Field(
        default_factory=lambda: [0.0, 0.0],
        description="sigma of ln rho0 and L/D taken as known, for filters of six states",
    )
    published_linear_density: bool = Field(
        False, description="rho0 itself as the seventh state: in compass reproduce alone"
    )
    acceleration_sigma_m_s2: Positive = Field(description="accelerometer noise, m/s^2")
    acceleration_bias_m_s2: Triple = Field(
        default_factory=lambda: [0.0, 0.0, 0.0], description="true biases of the three axes, m/s^2"
    )
    assumed_acceleration_sigma_m_s2: Positive | None = Field(
        None, description="what the filters take it for, m/s^2; the true one if left out"
    )
    range_sigma_m: Annotated[list[Positive], Field(min_length=1, max_length=1000)] | None = Field(
        None,
        description="range noise, m: one number a beacon, [[beacon]] first, then [[orbiter]]; "
        "measurements.range_sigma_m for all if left out",
    )
    see_through_planet: bool = Field(
        False, description="let ranges pass through the planet, as sources do that do not check"
    )
    estimate: EstimateTable = Field(
        default_factory=lambda: EstimateTable.model_validate({}),
        description="what the filters start from and assume",
    )
    radio: RadioTable | None = Field(None, description="plasma; none if left out")
    fault: list[FaultTable] = Field(
        default_factory=list, max_length=100, description="one [[fusion.fault]] a fault"
    )
