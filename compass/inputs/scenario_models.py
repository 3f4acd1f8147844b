"""What a scenario file may say: one model a table, each field with unit, range and meaning."""

from typing import Annotated, Literal

from pydantic import Field

from compass.inputs.fusion_models import FusionTable
from compass.inputs.guidance_models import DispersionTable, GuidanceTable
from compass.inputs.instrument_models import (
    AccelerometersTable,
    AltimeterTable,
    FeaturesTable,
    FeatureTable,
    LinkTable,
    TwoWayTable,
    VelocimeterTable,
)
from compass.inputs.models import Inclination, Kilometres, Pair
from compass.inputs.table import Table

Positive = Annotated[float, Field(gt=0, le=1e15)]
#: Past Mars's sphere of influence, and short of an entry's radius in metres.
Distance = Annotated[float, Field(gt=0, le=1e6)]
#: Rows of winds; their bounds differ by column, and `scenario_faults` holds them.
Winds = (
    Literal["mars"]
    | Annotated[
        list[Annotated[list[float], Field(min_length=3, max_length=3)]],
        Field(min_length=1),
    ]
)
Considered = Annotated[
    bool, Field(description="let it into the covariance, but do not correct it (Schmidt)")
]
Triple = Annotated[list[float], Field(min_length=3, max_length=3)]
Latitude = Annotated[float, Field(ge=-90, le=90)]
Longitude = Annotated[float, Field(ge=-180, le=360)]


class PlanetTable(Table):
    """The planet and how much of its rotation is kept."""

    gm_m3_s2: Positive | None = Field(
        None, description="gravitational parameter, m^3/s^2; Mars's if left out"
    )
    radius_km: Kilometres | None = Field(
        None, description="radius of the sphere that blocks the view and ends the flight, km"
    )
    rotation: Literal["none", "coriolis", "full", "published-coriolis"] = Field(
        "full", description="terms of the rotation that are kept"
    )
    gravity: Literal["point", "j2"] = Field(
        "point", description="of a point, or with the second zonal, the flattening of Mars"
    )
    rotation_rate_rad_s: float | None = Field(
        None, ge=-1e-2, le=1e-2, description="rotation rate, rad/s; Mars's if left out"
    )


class VehicleTable(Table):
    """The lander in its aeroshell."""

    drag_area_per_mass_m2_kg: Annotated[float, Field(ge=0, le=1)] | None = Field(
        None, description="C_D S / m, at most 1 m^2/kg"
    )
    ballistic_coefficient_kg_m2: Annotated[float, Field(ge=1, le=1e6)] | None = Field(
        None,
        description="m / (C_D S), at least 1 kg/m^2, instead of drag_area_per_mass_m2_kg",
    )
    lift_to_drag: float = Field(ge=-10, le=10, description="L/D")
    bank_deg: float | list[Pair] = Field(
        0.0, description="bank angle, degrees, or a list of [time in s, angle]"
    )
    nose_radius_m: Positive = Field(1.0, description="effective nose radius for the heat flux, m")


class AtmosphereTable(Table):
    """The air as the navigation filter knows it."""

    reference_density_kg_m3: Positive | None = Field(
        None, description="density at reference_radius_km, kg/m^3"
    )
    reference_radius_km: Kilometres | None = Field(None, description="r0, km from Mars's centre")
    scale_height_km: Annotated[float, Field(ge=0.1, le=100)] | None = Field(
        None, description="h of rho0 exp((r0 - r)/h), 0.1 to 100 km"
    )
    table: str | None = Field(
        None,
        min_length=1,
        description="file of altitude (km) and density (kg/m^3) columns, flown as it is given, "
        "instead of the three above",
    )
    winds_by_km: Winds | None = Field(
        None,
        description="[altitude in km, wind to the east, to the north in m/s] rows, upwards, from "
        '-10 to 1000 km and up to 500 m/s, or "mars" for a sample of Mars-GRAM; speeds of the '
        "entry and of triggers stay those over the ground, Mach numbers are through the air",
    )
    temperature_k: Positive = Field(200.0, description="for the speed of sound, K")


class TruthTable(Table):
    """How the real air differs from what the filter knows."""

    winds_by_km: Winds | None = Field(
        None, description="winds as they really are, rows as in [atmosphere]; as known if left out"
    )
    density_bias: float = Field(
        0.0, gt=-1, le=10, description="relative error of the density, above -1"
    )
    scale_height_factor: float = Field(
        1.0, ge=0.1, le=10, description="true scale height over the known one, 0.1 to 10"
    )


class EntryTable(Table):
    """The state at time 0 and how long to fly: spherical or Cartesian."""

    altitude_km: Distance | None = Field(None, description="altitude over the planet's sphere, km")
    radius_km: Distance | None = Field(None, description="distance from Mars's centre, km")
    longitude_deg: Longitude | None = Field(None, description="east longitude, degrees")
    latitude_deg: Latitude | None = Field(None, description="planetocentric latitude, degrees")
    speed_m_s: Annotated[float, Field(ge=100, le=1e5)] | None = Field(
        None, description="speed relative to the planet, 100 to 100000 m/s"
    )
    flight_path_deg: Annotated[float, Field(gt=-90, lt=90)] | None = Field(
        None, description="flight-path angle, between -90 and 90 degrees, positive up"
    )
    heading_deg: Annotated[float, Field(ge=-360, le=360)] | None = Field(
        None, description="heading of the velocity, degrees; see heading_from"
    )
    heading_from: Literal["north", "east"] | None = Field(
        None, description="north: clockwise from north; east: from east, positive to the north"
    )
    position_km: Triple | None = Field(None, description="Mars-fixed position [x, y, z], km")
    velocity_m_s: Triple | None = Field(
        None, description="velocity relative to the rotating planet, Mars-fixed axes, m/s"
    )
    duration_s: float = Field(gt=0, le=1e5, description="how long to fly, s")
    step_s: float = Field(
        1.0, gt=0, le=30, description="time between epochs: of outputs and of measurements, s"
    )


class TriggerTable(Table):
    """Something to notice on the way down: exactly one of the three levels."""

    name: str = Field(min_length=1, description="what to call the event")
    altitude_km: Annotated[float, Field(ge=-20, le=1e4)] | None = Field(
        None, description="altitude fallen to, km"
    )
    speed_m_s: Positive | None = Field(None, description="speed fallen to, m/s")
    mach: Positive | None = Field(None, description="Mach number fallen to")


class BeaconsTable(Table):
    """Beacons taken from a design file, and what counts as in view."""

    design: str | None = Field(
        None, min_length=1, description="design file whose satellites are beacons, from this folder"
    )
    start_s: float = Field(
        0.0, ge=-1e9, le=1e9, description="seconds after the design's epoch at which entry begins"
    )
    mask_deg: Annotated[float, Field(ge=0, lt=90)] | None = Field(
        None,
        description="elevation the lander must have over a surface beacon's horizon, degrees; "
        "satellites of a design have the design's mask",
    )


class BeaconTable(Table):
    """A beacon on the surface."""

    name: str = Field(min_length=1, description="what to call the beacon")
    latitude_deg: Latitude = Field(description="planetocentric latitude, degrees")
    longitude_deg: Longitude = Field(description="east longitude, degrees")
    height_km: float = Field(
        0.0, ge=0, le=1e4, description="height over the planet's sphere, 0 or more km"
    )


class OrbiterTable(Table):
    """A beacon in orbit: a circle by its angles, or a state vector; inertial axes.

    The inertial axes coincide with the Mars-fixed ones at time 0.
    """

    name: str = Field(min_length=1, description="what to call the orbiter")
    altitude_km: Kilometres | None = Field(
        None, description="altitude of the circular orbit over the planet's sphere, km"
    )
    inclination_deg: Inclination | None = Field(None, description="inclination, 0 to 180 degrees")
    raan_deg: float | None = Field(None, description="right ascension of the node, degrees")
    latitude_argument_deg: float | None = Field(
        None, description="argument of latitude at time 0, degrees"
    )
    position_km: Triple | None = Field(None, description="inertial position [x, y, z], km")
    velocity_m_s: Triple | None = Field(None, description="inertial velocity, m/s")


class MeasurementsTable(Table):
    """What is measured, how well and when."""

    range_sigma_m: Positive | None = Field(None, description="one sigma of ranges, m")
    range_rate_sigma_m_s: Positive | None = Field(None, description="one sigma of range rates, m/s")
    interval_s: Positive = Field(1.0, description="time between measurements of beacons, s")
    start_s: float = Field(0.0, ge=0, description="first measurement of beacons, s")
    stop_s: float | None = Field(
        None, ge=0, description="last measurement of beacons, s; the end if left out"
    )
    in_turn: bool = Field(False, description="one beacon at a time rather than all at once")
    link: LinkTable | None = Field(
        None, description="noise of the ranges from the link budget, on top of range_sigma_m"
    )
    two_way: TwoWayTable | None = Field(
        None, description="radio both ways, to the same beacons at the same times"
    )
    altimeter: AltimeterTable | None = Field(None, description="height over the sphere")
    velocimeter: VelocimeterTable | None = Field(None, description="velocity over the ground")
    features: FeaturesTable | None = Field(
        None, description="directions to features of the surface, one [[feature]] each"
    )
    accelerometers: AccelerometersTable | None = Field(
        None, description="drag and lift, along and across the velocity through the air"
    )


class BlockTable(Table):
    """One more quantity that is not known: estimated by the filter, or only considered."""

    sigma: Positive = Field(description="one sigma: of L/D, or of ranges in m")
    considered: Considered = False


class DensityTable(Table):
    """The air's density as a quantity that is not known."""

    sigma: Positive | None = Field(
        None, description="one sigma of ln density, the same at every height"
    )
    considered: Considered = False
    sigma_by_km: Literal["mars"] | Annotated[list[Pair], Field(min_length=2)] | None = Field(
        None,
        description="instead, of one that wanders: [altitude in km, sigma] rows, upwards, or "
        '"mars" for the spread of Mars-GRAM',
    )
    scale_km: Annotated[float, Field(gt=0, le=1000)] | None = Field(
        None,
        description="altitude over which its correlation falls to 1/e, km (8.2 on Mars); one "
        "factor all the way if left out",
    )
    along_km: Annotated[float, Field(gt=0, le=1e5)] | None = Field(
        None, description="the same along the ground, km; no limit if left out"
    )


class ClockTable(Table):
    """The receiver's clock as a quantity that is not known."""

    sigma_m: Positive = Field(description="one sigma of the clock, m")
    drift_sigma_m_s: Positive = Field(description="one sigma of its drift, m/s")
    considered: Considered = False


class AttitudeTable(Table):
    """The axes in which the lander sees features and its velocity, as a quantity not known."""

    sigma_deg: Annotated[float, Field(gt=0, le=10)] = Field(
        description="one sigma of a constant turn about each axis, degrees"
    )
    considered: Considered = False


class BiasTable(Table):
    """Biases of the accelerometers as quantities that are not known."""

    sigma_m_s2: Annotated[float, Field(gt=0, le=10)] = Field(
        description="one sigma of a constant bias of each axis, m/s^2"
    )
    considered: Considered = False


class GyrosTable(Table):
    """Gyros that hold the axes of [filter.attitude]: their drift, constant in these axes."""

    drift_sigma_deg_h: Annotated[float, Field(gt=0, le=1e4)] = Field(
        description="one sigma of a constant drift about each axis, degrees an hour"
    )
    walk_deg_sqrt_h: Annotated[float, Field(ge=0, le=100)] = Field(
        0.0, description="what the axes wander beside it, degrees over the root of an hour"
    )
    considered: Considered = False


FilterKind = Literal[
    "ekf", "iterated-ekf", "relinearised-ekf", "unscented", "square-root-ekf", "information-ekf"
]


class FilterTable(Table):
    """The navigation filter: first uncertainty per Cartesian axis, or of each state."""

    kind: FilterKind = Field(
        "ekf",
        description="which filter: extended; iterated at each update; extended, that hears all "
        "again once density or L/D is known twice as well; through spread points; iterated, "
        "with a root in place of its covariance, for ranges far better than the first state; "
        "extended, that gathers all that an epoch tells before it inverts once",
    )
    iterations: int = Field(5, ge=2, le=100, description="most passes of the iterated filter")
    position_sigma_m: Positive | None = Field(None, description="one sigma a Cartesian axis, m")
    velocity_sigma_m_s: Positive | None = Field(None, description="one sigma a Cartesian axis, m/s")
    radius_sigma_m: Positive | None = Field(None, description="one sigma of the radius, m")
    longitude_sigma_deg: Positive | None = Field(None, description="one sigma, degrees")
    latitude_sigma_deg: Positive | None = Field(None, description="one sigma, degrees")
    speed_sigma_m_s: Positive | None = Field(None, description="one sigma of the speed, m/s")
    flight_path_sigma_deg: Positive | None = Field(None, description="one sigma, degrees")
    heading_sigma_deg: Positive | None = Field(None, description="one sigma, degrees")
    process_noise_si: (
        Annotated[list[Annotated[float, Field(ge=0)]], Field(min_length=6, max_length=6)] | None
    ) = Field(
        None,
        description="variance per second of radius, longitude, latitude, speed, flight-path angle "
        "and azimuth: six numbers, m, rad, m/s",
    )
    clock: ClockTable | None = Field(None, description="the receiver's clock and its drift")
    density: DensityTable | None = Field(
        None, description="the air's density: sigma of ln rho, and how far it is the same"
    )
    lift_to_drag: BlockTable | None = Field(None, description="the lift-to-drag ratio")
    range_bias: BlockTable | None = Field(
        None, description="a constant bias of the ranges of each beacon, as of its orbit and clock"
    )
    attitude: AttitudeTable | None = Field(
        None, description="the axes in which features and velocities are seen"
    )
    gyros: GyrosTable | None = Field(None, description="gyros that hold these axes")
    accelerometers: BiasTable | None = Field(None, description="biases of the accelerometers")


class MonteCarloTable(Table):
    """How many runs, and from which seed."""

    runs: int = Field(500, ge=1, le=100_000, description="number of runs, 1 to 100000")
    seed: int = Field(0, ge=0, description="seed of the random numbers, 0 or more")


class OptimizeTable(Table):
    """What ``compass optimize`` looks for."""

    what: Literal["ground", "orbiters", "directions"] = Field(description="what is placed")
    count: int = Field(3, ge=1, le=30, description="number of beacons, 1 to 30")
    objective: Literal["minimum-delta", "mean-log-index", "bound-trace"] = Field(
        "minimum-delta", description="of ground beacons"
    )
    altitude_km: Kilometres | None = Field(None, description="of the circular orbits, km")
    starts: int = Field(4, ge=1, le=1000, description="independent starts")
    generations: int = Field(60, ge=1, le=10_000, description="most generations of each start")
    seed: int = Field(0, ge=0, description="seed of the random numbers, 0 or more")


class ScenarioFile(Table):
    """A whole scenario file."""

    name: str = Field(min_length=1, max_length=200, description="what to call the scenario")
    source: str = Field("", description="where the scenario comes from")
    paper: Literal["yu2018", "lou2017", "lou2019"] | None = Field(
        None, description="source paper of the scenario"
    )
    planet: PlanetTable = Field(
        default_factory=lambda: PlanetTable.model_validate({}), description="the planet"
    )
    vehicle: VehicleTable = Field(description="the lander: a table [vehicle]")
    atmosphere: AtmosphereTable = Field(
        default_factory=lambda: AtmosphereTable.model_validate({}),
        description="the air; a mean profile of Mars where it is left out",
    )
    truth: TruthTable = Field(
        default_factory=lambda: TruthTable.model_validate({}), description="the air as it really is"
    )
    entry: EntryTable = Field(description="the state at time 0: a table [entry]")
    guidance: GuidanceTable | None = Field(None, description="guidance of the bank to a target")
    dispersion: DispersionTable | None = Field(
        None, description="entries that differ from the planned one, to see where they come down"
    )
    trigger: list[TriggerTable] = Field(
        default_factory=list, max_length=100, description="one [[trigger]] an event to notice"
    )
    beacons: BeaconsTable = Field(
        default_factory=lambda: BeaconsTable.model_validate({}),
        description="beacons from a design, and the view",
    )
    beacon: list[BeaconTable] = Field(
        default_factory=list, max_length=1000, description="one [[beacon]] a surface beacon"
    )
    orbiter: list[OrbiterTable] = Field(
        default_factory=list, max_length=1000, description="one [[orbiter]] an orbiting beacon"
    )
    feature: list[FeatureTable] = Field(
        default_factory=list,
        max_length=1000,
        description="one [[feature]] a feature of the surface known by sight",
    )
    measurements: MeasurementsTable = Field(description="what is measured: a table [measurements]")
    filter: FilterTable = Field(description="the filter: a table [filter]")
    monte_carlo: MonteCarloTable = Field(
        default_factory=lambda: MonteCarloTable.model_validate({}), description="the runs"
    )
    optimize: OptimizeTable | None = Field(None, description="what compass optimize looks for")
    fusion: FusionTable | None = Field(
        None, description="accelerometers and ranges in centralised and distributed filters"
    )
