"""What a study file may say: one model a table, each field with unit, range and meaning."""

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, GetJsonSchemaHandler, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from compass.allowed import LONGEST_DAYS, MOST_SAMPLES
from compass.design import PDOP_MAX
from compass.inputs.models import DeploymentTable, MotionTable, SatelliteCount, StationTable
from compass.inputs.requirements import RegionTexts, RequirementTable, SiteNames
from compass.inputs.signal import Sigma, SignalTable
from compass.inputs.table import Table
from compass.orbits.kinds import KIND_NAMES

if TYPE_CHECKING:
    PatternName = str
else:
    PatternName = Literal[KIND_NAMES]


class _Values(Table):
    """Values in a list, or from `least` to `most` by `step`; one value alone will do too.

    Which values are allowed is said by `study_faults`, which knows what they are of.
    """

    #: The key that a list or a value alone need not name.
    IMPLIED: ClassVar[str] = "values"

    @model_validator(mode="before")
    @classmethod
    def _listed(cls, given: Any) -> Any:
        if isinstance(given, list):
            return {"values": given}
        if isinstance(given, int | float) and not isinstance(given, bool):
            return {"values": [given]}
        if not isinstance(given, dict):
            raise ValueError("must be a number, a list of them or a range { least, most, step }")
        return given

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Schema of the table, and of what may be written instead of it."""
        table = handler.resolve_ref_schema(handler(core))
        listed = next(s for s in table["properties"]["values"]["anyOf"] if s["type"] == "array")
        return {"anyOf": [table, listed, listed["items"]], "description": table["description"]}


class Counts(_Values):
    """Whole numbers."""

    values: list[int] | None = Field(None, min_length=1, description="a list of whole numbers")
    least: int | None = Field(None, description="first of a range of whole numbers")
    most: int | None = Field(None, description="last of a range of whole numbers")
    step: Annotated[int, Field(ge=1)] = Field(1, description="step of the range, from 1")


class Numbers(_Values):
    """Real numbers; a range without a step is free and needs sampling."""

    values: list[float] | None = Field(None, min_length=1, description="a list of numbers")
    least: float | None = Field(None, description="lower end of a range")
    most: float | None = Field(None, description="upper end of a range")
    step: Annotated[float, Field(gt=0)] | None = Field(
        None, description="step; without it the range is free, for sampling"
    )


class SpaceTable(Table):
    """Which constellations to consider, and for which user."""

    patterns: list[PatternName] = Field(min_length=1, description="kinds of pattern")
    satellites: Counts = Field(description="total numbers t")
    planes: Counts | None = Field(
        None, description="numbers of planes p; all divisors of t if left out"
    )
    phasing: Counts | None = Field(None, description="Walker's F; 0 to p - 1 if left out")
    inclination_deg: Numbers = Field(description="inclinations, degrees from 0 to 180")
    orbits: list[Literal["areosynchronous", "half", "third"]] | None = Field(
        None,
        min_length=1,
        description="orbits by their period: a sidereal day of Mars, a half or a third of it",
    )
    radius_km: Numbers | None = Field(None, description="orbit radii from Mars's centre, km")
    mask_deg: Numbers = Field(
        default_factory=lambda: Numbers.model_validate([0.0]),
        description="elevation masks, 0 up to below 90 degrees",
    )
    fold: SatelliteCount = Field(4, description="satellites to be in view at once, continuously")
    seed: int = Field(0, ge=0, description="seed of everything random")


class SamplingTable(Table):
    """Which of the candidates are looked at."""

    method: Literal["grid", "latin-hypercube", "sobol", "nsga2"] = Field(
        "grid", description="how candidates are chosen"
    )
    samples: int | None = Field(
        None, ge=1, le=10_000_000, description="how many (latin-hypercube, sobol)"
    )
    population: int | None = Field(None, ge=4, le=100_000, description="of a generation (nsga2)")
    generations: int | None = Field(None, ge=1, le=100_000, description="how many (nsga2)")


class ConstraintTable(Table):
    """What a candidate must meet to go on to the next stage."""

    figure: str = Field(description="name of a figure of merit")
    at_least: float | None = Field(None, description="lowest value allowed")
    at_most: float | None = Field(None, description="highest value allowed")
    above: float | None = Field(None, description="all values above this are allowed")
    below: float | None = Field(None, description="all values below this are allowed")


class ObjectiveTable(Table):
    """What is to be as small or as large as possible."""

    figure: str = Field(description="name of a figure of merit")
    goal: Literal["minimise", "maximise"] | None = Field(
        None, description="which way; by default the way that is better"
    )


class MapTable(Table):
    """How finely geometry is sampled over area and time."""

    step_deg: float = Field(10.0, ge=1, le=45, description="cell of the equal-area grid, degrees")
    epochs: int = Field(12, ge=1, le=10_000, description="epochs in the time that decides")
    pdop_max: float = Field(PDOP_MAX, ge=1, description="largest PDOP that counts as available")
    sites: SiteNames | None = Field(
        None,
        description="names of [[station]] entries of which figures are wanted too: area_fold_met, "
        "area_margin_deg, area_availability, area_gdop_p50, area_gdop_p95",
    )
    region: RegionTexts | None = Field(
        None, description="regions of which they are wanted, as of a requirement"
    )


class EntryStageTable(Table):
    """How landing navigation is judged, for candidates that pass every other stage."""

    scenario: str = Field(min_length=1, description="scenario file, from the study's folder")
    samples: int = Field(32, ge=1, le=MOST_SAMPLES, description="entries a candidate")
    density_sigma: float = Field(
        0.0, ge=0, le=10, description="unknown part of the air's density, relative; 0: it is known"
    )
    lift_sigma: float = Field(
        0.0, ge=0, le=10, description="unknown part of L/D, relative; 0: it is known"
    )
    clock_m: Sigma | None = Field(
        None,
        description="one sigma of the lander's clock, estimated; 0, and so clock_drift_m_s, for "
        "known; of these five, as compass judge takes them if left out",
    )
    clock_drift_m_s: Sigma | None = Field(None, description="one sigma of its drift, m/s")
    orbit_m: Annotated[list[Sigma], Field(min_length=3, max_length=3)] | None = Field(
        None, description="one sigma of broadcast orbits, radial, along, cross, m"
    )
    satellite_clock_m: Sigma | None = Field(None, description="one sigma of broadcast clocks, m")
    range_bias_m: Sigma | None = Field(
        None, description="one sigma of a bias of the ranges to each satellite, m"
    )
    goal_m: float = Field(10.0, gt=0, le=1e9, description="position sigma wanted at the end, m")
    sites: SiteNames | None = Field(
        None, description="names of [[station]] entries at which landers deploy, by turns"
    )
    region: RegionTexts | None = Field(
        None, description="where else they deploy, as of a requirement; anywhere without either"
    )
    finalists: int = Field(
        100, ge=1, le=1_000_000, description="how many candidates are judged, best fronts first"
    )
    finalist_samples: int = Field(
        1024,
        ge=1,
        le=MOST_SAMPLES,
        description="entries on which the report judges its finalists",
    )
    filter_runs: int = Field(
        512, ge=0, le=100_000, description="runs of the filter on each of these; 0 for none"
    )


class CostTable(Table):
    """Assumptions of the cost proxies."""

    parking_altitude_km: float = Field(
        400.0, gt=0, le=1e6, description="altitude of the circular parking orbit, km"
    )


class OrbitsTable(Table):
    """How far real orbits are followed, for candidates that pass the map."""

    days: float = Field(
        687.0, gt=0, le=LONGEST_DAYS, description="for how long coverage is to be proven, days"
    )


class CompareTable(Table):
    """A design to compare the best with."""

    design: str = Field(min_length=1, description="design file, from the study's folder")


class StudyFile(Table):
    """A whole study file."""

    name: str = Field(min_length=1, max_length=200, description="what to call the study")
    source: str = Field("", description="why the study is made")
    figure: Literal["iau-sphere", "kelly2018-sphere"] = Field(
        "iau-sphere", description="reference sphere of Mars"
    )
    study: SpaceTable = Field(description="the candidates: a table [study]")
    sampling: SamplingTable = Field(
        default_factory=lambda: SamplingTable.model_validate({}), description="which are looked at"
    )
    constraint: list[ConstraintTable] = Field(
        default_factory=list, description="one [[constraint]] a condition"
    )
    objective: list[ObjectiveTable] = Field(min_length=1, description="one [[objective]] a goal")
    map: MapTable = Field(
        default_factory=lambda: MapTable.model_validate({}), description="sampling of geometry"
    )
    entry: EntryStageTable | None = Field(None, description="judging of landing navigation")
    cost: CostTable = Field(
        default_factory=lambda: CostTable.model_validate({}), description="cost assumptions"
    )
    orbits: OrbitsTable = Field(
        default_factory=lambda: OrbitsTable.model_validate({}),
        description="how long real orbits are followed",
    )
    motion: MotionTable = Field(
        default_factory=lambda: MotionTable.model_validate({"model": "numerical"}),
        description="how candidates move on real orbits; under all forces if left out",
    )
    deployment: DeploymentTable = Field(
        default_factory=lambda: DeploymentTable.model_validate({}),
        description="how satellites come to their planes",
    )
    station: list[StationTable] = Field(
        default_factory=list, max_length=1000, description="one [[station]] a place required"
    )
    requirement: list[RequirementTable] = Field(
        default_factory=list,
        max_length=100,
        description="one [[requirement]] a thing wanted of every candidate",
    )
    signal: SignalTable | None = Field(
        None,
        description="what ranges are worth: for errors in metres, and of entries' beacons",
    )
    compare: CompareTable | None = Field(None, description="a design to compare with")
