"""What a design file may say: one model a table, each field with unit, range and meaning."""

from datetime import datetime
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union

from pydantic import Field, WithJsonSchema, create_model

from compass.allowed import LONGEST_DAYS
from compass.inputs.integrity import IntegrityTable
from compass.inputs.requirements import RequirementTable
from compass.inputs.signal import SignalTable
from compass.inputs.table import Table
from compass.inputs.tracking import TrackingTable
from compass.links import LinkEnd
from compass.orbits.kinds import KINDS, PatternKind
from compass.orbits.patterns import FARTHEST_KM

SatelliteCount = Annotated[int, Field(ge=1, le=10_000)]
Inclination = Annotated[float, Field(ge=0, le=180)]
Pair = Annotated[list[float], Field(min_length=2, max_length=2)]
#: Without a zone, for it is TDB; the format "date-time" of JSON Schema asks for one.
Epoch = Annotated[
    datetime,
    WithJsonSchema(
        {"type": "string", "pattern": r"^\d{4}-\d{2}-\d{2}[T ]\d{2}:\d{2}:\d{2}(\.\d+)?$"}
    ),
]
Rotations = Annotated[int, Field(ge=1, le=1000)]
Kilometres = Annotated[float, Field(gt=0, le=FARTHEST_KM)]


class CircularOrbit(Table):
    """How high the circular orbits of a pattern are: exactly one of the four."""

    radius_km: Kilometres | None = Field(None, description="orbit radius from Mars's centre, km")
    altitude_km: Kilometres | None = Field(
        None, description="orbit altitude over the reference figure's equator, km"
    )
    orbit: Literal["areosynchronous"] | None = Field(
        None, description="areosynchronous: the radius that keeps pace with Mars"
    )
    repeat: Annotated[list[Rotations], Field(min_length=2, max_length=2)] | None = Field(
        None, description="[revolutions, rotations of Mars] after which ground tracks close"
    )


class PatternTable(CircularOrbit):
    """What the tables of all kinds of pattern have in common; each has the kind's numbers."""

    if TYPE_CHECKING:
        pattern: str
        satellites: int
        planes: int
        inclination_deg: float
        raan_deg: float
        phase_deg: float


#: How numbers of a form are written in a file.
_FORMS: dict[str, Any] = {"whole": int, "real": float, "ratio": str | int | float}


def _table_of(kind: PatternKind) -> type[PatternTable]:
    """Return the table ``[constellation]`` of a kind, made from its record."""
    fields: dict[str, Any] = {
        "pattern": (Literal[kind.name], Field(description="kind of pattern")),
        **{
            one.name: (
                _FORMS[one.form],
                Field(
                    ... if one.default is None else one.default,
                    ge=one.least,
                    le=one.most,
                    description=one.meaning,
                ),
            )
            for one in kind.parameters
        },
    }
    name = "".join(word.capitalize() for word in kind.name.split("-"))
    title = f"{kind.title}."
    return create_model(f"{name}Table", __base__=PatternTable, __doc__=title, **fields)


_PATTERN_TABLES = tuple(_table_of(kind) for kind in KINDS)


class SatelliteTable(Table):
    """Keplerian elements of one satellite."""

    name: str = Field(min_length=1, description="what to call the satellite")
    semi_major_axis_km: Kilometres | None = Field(None, description="semi-major axis, km")
    eccentricity: float | None = Field(
        None, ge=0, lt=1, description="eccentricity, 0 up to below 1; 0 if left out"
    )
    repeat: Annotated[list[Rotations], Field(min_length=2, max_length=2)] | None = Field(
        None,
        description="instead of the axis: revolutions and rotations of Mars after which the "
        "ground track closes",
    )
    periapsis_altitude_km: Kilometres | None = Field(
        None,
        description="lowest altitude over the equatorial radius, km (with apoapsis_altitude_km)",
    )
    apoapsis_altitude_km: Kilometres | None = Field(
        None, description="highest altitude over the equatorial radius, km"
    )
    inclination_deg: Inclination = Field(description="inclination, 0 to 180 degrees")
    raan_deg: float = Field(0.0, description="right ascension of the ascending node, degrees")
    argument_of_periapsis_deg: float = Field(0.0, description="argument of periapsis, degrees")
    mean_anomaly_deg: float = Field(0.0, description="mean anomaly at the epoch, degrees")
    true_anomaly_deg: float | None = Field(
        None, description="true anomaly at the epoch, degrees, instead of mean_anomaly_deg"
    )


class ElementsTable(Table):
    """Explicit orbits, satellite by satellite."""

    pattern: Literal["elements"] = Field(description="kind of pattern")
    satellite: list[SatelliteTable] = Field(
        min_length=1, max_length=10_000, description="one [[constellation.satellite]] a satellite"
    )


class EphemerisTable(Table):
    """Trajectories from files."""

    pattern: Literal["ephemeris"] = Field(description="kind of pattern")
    files: list[str] = Field(
        min_length=1,
        max_length=10_000,
        description='CCSDS OEM files, one a satellite, or patterns such as "*.oem"',
    )


if TYPE_CHECKING:
    AnyPatternTable = PatternTable | ElementsTable | EphemerisTable
else:
    AnyPatternTable = Annotated[
        Union[(*_PATTERN_TABLES, ElementsTable, EphemerisTable)],
        Field(discriminator="pattern"),
    ]


class MotionTable(Table):
    """How the satellites move."""

    model: Literal["two-body", "j2", "numerical"] = Field(
        "two-body", description="two-body, j2 (mean elements drift), or numerical (forces)"
    )
    gravity_degree: int | None = Field(
        None, ge=2, le=120, description="degree of the gravity field; 8 if left out"
    )
    gravity_file: str | None = Field(
        None, min_length=1, description="SHADR (.tab) or ICGEM (.gfc) file, not the built-in GMM-3"
    )
    gravity_frame: Literal["iau-2000", "iau-1991"] | None = Field(
        None, description="prime meridian of the gravity file's longitudes"
    )
    sun: bool = Field(True, description="whether the Sun attracts")
    moons: bool = Field(True, description="whether Phobos and Deimos attract")
    radiation_m2_kg: float = Field(
        0.026, ge=0, lt=1000, description="reflectivity times area over mass, m^2/kg; 0: no light"
    )
    shadow: Literal["none", "cylinder", "cone"] = Field(
        "cylinder", description="how Mars shades: not, as a cylinder, or with penumbra"
    )


class KeepingTable(Table):
    """What satellites keep their slots with, for `compass keep`."""

    specific_impulse_s: float = Field(
        220.0, gt=0, lt=1e6, description="specific impulse of the propulsion, s"
    )
    dry_mass_kg: float = Field(
        100.0, gt=0, lt=1e6, description="mass of a satellite without propellant, kg"
    )
    smallest_burn_m_s: float = Field(
        0.005, ge=0, le=100, description="smallest impulse that can be commanded, m/s"
    )
    execution_error: float = Field(
        0.01, ge=0, lt=0.5, description="error of an impulse, relative, 1 sigma"
    )
    navigation_error_m: float = Field(
        1000.0, ge=0, le=1e6, description="error of the place along the track, m, 1 sigma"
    )
    years: float = Field(
        1.0, ge=0.1, le=100, description="for how long, Earth years of 365.25 days"
    )


class DeploymentTable(Table):
    """How satellites come to their planes, for `compass deploy`."""

    launch_altitude_km: float = Field(
        400.0, ge=100, le=1e6, description="altitude of the circular orbit launched into, km"
    )
    waiting_altitude_km: Pair = Field(
        default_factory=lambda: [300.0, 12000.0],
        description="lowest and highest altitude of orbits to wait in, km",
    )
    longest_wait_days: float = Field(
        365.25, gt=0, le=LONGEST_DAYS, description="until the last plane is reached, days"
    )
    satellites_a_launch: int | None = Field(
        None, ge=1, le=10_000, description="satellites of one launch; all if left out"
    )


class CoverageTable(Table):
    """What the user on the surface needs."""

    mask_deg: float = Field(
        0.0, ge=0, lt=90, description="elevation mask, 0 up to below 90 degrees"
    )
    horizon_deg: list[Pair] | None = Field(
        None, description="list of [azimuth, elevation] in degrees, instead of mask_deg"
    )
    fold: int = Field(4, ge=1, le=1000, description="satellites to be in view at once")


class StationTable(Table):
    """A place on the surface."""

    name: str = Field(min_length=1, description="what to call the station")
    latitude_deg: float = Field(ge=-90, le=90, description="latitude, -90 to 90 degrees")
    latitude_kind: Literal["planetocentric", "planetographic"] = Field(
        "planetocentric", description="kind of latitude"
    )
    longitude_deg: float = Field(ge=-180, le=360, description="east longitude, -180 to 360 degrees")
    height_km: float = Field(0.0, ge=-10, le=30, description="height over the figure, -10 to 30 km")
    mask_deg: float = Field(
        0.0, ge=0, lt=90, description="elevation mask, 0 up to below 90 degrees"
    )
    horizon_deg: list[Pair] | None = Field(
        None, description="list of [azimuth, elevation] in degrees, instead of mask_deg"
    )


class AccessTable(Table):
    """What to link for `compass access`, beside the stations."""

    duration_sols: float = Field(
        10.0, gt=0, le=1000, description="span from the epoch, above 0 to 1000 sols"
    )
    moons: list[Literal["phobos", "deimos"]] = Field(
        default_factory=list, max_length=2, description="moons to link with"
    )
    earth: bool = Field(False, description="whether to link with the Earth")
    crosslinks: bool = Field(False, description="whether to link satellites with each other")
    atmosphere_height_km: float = Field(
        0.0, ge=0, le=1000, description="height that rays off the surface keep, 0 to 1000 km"
    )
    conjunction_deg: float = Field(
        2.0,
        ge=0,
        le=90,
        description="Sun-Earth-Mars angle below which links to the Earth are lost, 0 to 90 degrees",
    )


class LinkTable(Table):
    """A radio link between two kinds of nodes."""

    between: Annotated[list[LinkEnd], Field(min_length=2, max_length=2)] = Field(
        description='two of "station", "satellite", "moon", "earth"'
    )
    frequency_mhz: float = Field(gt=0, le=1e6, description="carrier, MHz")
    eirp_dbw: float = Field(ge=-100, le=200, description="radiated power of the sender, dBW")
    g_over_t_db_per_k: float = Field(ge=-100, le=100, description="G/T of the receiver, dB/K")
    required_cn0_dbhz: float = Field(
        30.0, ge=-50, le=200, description="C/N0 at which the link is usable, dB Hz"
    )


class DesignFile(Table):
    """A whole design file."""

    name: str = Field(min_length=1, max_length=200, description="what to call the constellation")
    source: str = Field("", description="where the design comes from")
    paper: Literal["kelly2018"] | None = Field(
        None, description="source paper whose printed values to compare with"
    )
    figure: Literal["iau-sphere", "iau-ellipsoid", "kelly2018-sphere"] = Field(
        "iau-sphere", description="reference figure of Mars"
    )
    epoch: Epoch | None = Field(None, description="epoch of the elements, TDB; J2000 if left out")
    constellation: AnyPatternTable = Field(description="the orbits: a table [constellation]")
    motion: MotionTable = Field(
        default_factory=lambda: MotionTable.model_validate({}), description="how satellites move"
    )
    keeping: KeepingTable = Field(
        default_factory=lambda: KeepingTable.model_validate({}),
        description="what satellites keep their slots with",
    )
    deployment: DeploymentTable = Field(
        default_factory=lambda: DeploymentTable.model_validate({}),
        description="how satellites come to their planes",
    )
    coverage: CoverageTable = Field(
        default_factory=lambda: CoverageTable.model_validate({}), description="coverage wanted"
    )
    station: list[StationTable] = Field(
        default_factory=list, max_length=1000, description="one [[station]] a place"
    )
    access: AccessTable = Field(
        default_factory=lambda: AccessTable.model_validate({}), description="what to link"
    )
    link: list[LinkTable] = Field(
        default_factory=list, max_length=100, description="one [[link]] a kind of radio link"
    )
    requirement: list[RequirementTable] = Field(
        default_factory=list, max_length=100, description="one [[requirement]] a thing wanted"
    )
    signal: SignalTable | None = Field(None, description="what a user's ranges are worth")
    tracking: TrackingTable | None = Field(None, description="who tracks the satellites")
    integrity: IntegrityTable | None = Field(None, description="what users are promised")
