"""Study files: read, check across fields, and turn into candidates and what is wanted of them."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.arguments import checked
from compass.design import Design, Launching
from compass.digest import digest_of
from compass.entry.doubts import NO_DOUBTS, Doubts
from compass.errors import ArgumentError, CompassError, DesignError
from compass.frames import FIGURES, Figure
from compass.inputs.design import launching_of, read_design, site_of
from compass.inputs.motion import motion_of_table
from compass.inputs.reading import parse, read_text
from compass.inputs.requirements import region_texts, requirements_of, sites_named
from compass.inputs.scenario import Scenario, read_scenario
from compass.inputs.signal import signal_of_table
from compass.inputs.study_faults import study_faults
from compass.inputs.study_models import (
    ConstraintTable,
    CostTable,
    Counts,
    EntryStageTable,
    MapTable,
    Numbers,
    OrbitsTable,
    SamplingTable,
    SpaceTable,
    StudyFile,
)
from compass.orbits import areosynchronous_radius
from compass.orbits.motion import Motion
from compass.quantities.merits import MERITS, STAGES
from compass.ranging import Signal
from compass.requirement import Requirement
from compass.saving import readable
from compass.sites import Site

FileKind = TypeVar("FileKind", Scenario, Design)

#: Revolutions in one rotation of Mars of the orbits that have names.
REVOLUTIONS = {"areosynchronous": 1, "half": 2, "third": 3}


@dataclass(frozen=True)
class Free:
    """A range of real numbers from which samples are drawn."""

    least: float
    most: float


@dataclass(frozen=True)
class Space:
    """What candidates may be.

    Attributes
    ----------
    patterns, satellites
        Kinds and sizes.
    planes, phasing
        Numbers allowed, or None for all there are.
    inclination_deg, radius_km, mask_deg
        Values, or a free range.
    revolutions
        In a rotation of Mars, of orbits that are named: their tracks are closed, one a radius.
    """

    patterns: tuple[str, ...]
    satellites: tuple[int, ...]
    planes: tuple[int, ...] | None
    phasing: tuple[int, ...] | None
    inclination_deg: tuple[float, ...] | Free
    radius_km: tuple[float, ...] | Free
    mask_deg: tuple[float, ...] | Free
    revolutions: tuple[int, ...] = ()

    def repeat(self, radius_km: float) -> tuple[int, int] | None:
        """Revolutions and rotations of Mars after which tracks of a radius are declared closed."""
        for number, radius in zip(self.revolutions, as_values(self.radius_km), strict=False):
            if radius == radius_km:
                return number, 1
        return None


def as_values(given: tuple[float, ...] | Free) -> tuple[float, ...]:
    """Values of what is listed; none of a free range."""
    return () if isinstance(given, Free) else given


@dataclass(frozen=True)
class Constraint:
    """A condition ``low <= figure <= high``, strict where said so."""

    figure: str
    low: float
    high: float
    strict: bool

    def holds(self, values: ArrayLike | None) -> NDArray[np.bool_]:
        """Whether values meet it, shape as `values`; no value (None, nan) never does."""
        reached = np.asarray(values, dtype=float)
        if self.strict:
            return np.asarray((self.low < reached) & (reached < self.high))
        return np.asarray((self.low <= reached) & (reached <= self.high))

    def __str__(self) -> str:
        sign = ("<", ">") if self.strict else ("<=", ">=")
        if np.isfinite(self.high):
            return f"{self.figure} {sign[0]} {self.high:g}"
        return f"{self.figure} {sign[1]} {self.low:g}"


@dataclass(frozen=True)
class Objective:
    """A figure to be as small (sign 1) or as large (sign -1) as possible."""

    figure: str
    sign: int

    @property
    def goal(self) -> str:
        """In words."""
        return "smallest" if self.sign > 0 else "largest"


@dataclass(frozen=True)
class EntryStage:
    """Judging of landing navigation: the lander, entries a candidate, how many are judged.

    Those that the report singles out are judged again on `finalist_samples` entries and their
    filter is run `filter_runs` times. Density and L/D are unknown by relative sigmas; the position
    sigma wanted at the end is `goal`, metres; `doubts` is what is not known of clocks and orbits.
    Landers deploy at `sites` and in `regions`, by turns; anywhere without any.
    """

    scenario: Scenario
    samples: int
    finalists: int
    finalist_samples: int
    filter_runs: int
    density_sigma: float = 0.0
    lift_sigma: float = 0.0
    goal: float = 10.0
    doubts: Doubts = NO_DOUBTS
    sites: tuple[Site, ...] = ()
    regions: tuple[str, ...] = ()


@dataclass(frozen=True, repr=False)
class Study:
    """A study file, read.

    Attributes
    ----------
    name, source
        As written.
    figure
        Reference sphere.
    space, sampling
        The candidates, and which of them are looked at.
    fold, seed
        Satellites wanted at once; seed of everything random.
    constraints, objectives
        What candidates must and should be.
    map, cost, orbits
        Sampling of geometry; assumptions of the cost proxies; how long real orbits are followed.
    motion, launching
        How candidates move on real orbits; how satellites come to their planes.
    entry
        How landing navigation is judged, or None.
    compare
        A design to compare with, or None.
    text, digest, label
        The file's text, the SHA-256 of it and of all that was read from the files that it names,
        and that these name; its name as given.
    requirements
        What must be so of every candidate, at its mask.
    sites, regions
        Of which figures are wanted besides those of the whole sphere.
    """

    name: str
    source: str
    figure: Figure
    space: Space
    sampling: SamplingTable
    fold: int
    seed: int
    constraints: tuple[Constraint, ...]
    objectives: tuple[Objective, ...]
    map: MapTable
    cost: CostTable
    orbits: OrbitsTable
    motion: Motion
    launching: Launching
    entry: EntryStage | None
    compare: Design | None
    text: str
    digest: str
    label: str
    requirements: tuple[Requirement, ...] = ()
    signal: Signal | None = None
    sites: tuple[Site, ...] = ()
    regions: tuple[str, ...] = ()

    def __repr__(self) -> str:
        wanted = ", ".join(f"{one.goal} {one.figure}" for one in self.objectives)
        return f"Study {self.name}: {wanted}; stages: {', '.join(self.stages)}"

    @property
    def stages(self) -> tuple[str, ...]:
        """What candidates are put through, in order: after the map only where asked for."""
        followed = "orbits" in {MERITS[name].stage for name in self.named}
        asked = {
            "screen": True,
            "map": True,
            "requirements": bool(self.requirements),
            "areas": bool(self.sites or self.regions),
            "orbits": followed,
            "entry": bool(self.entry),
        }
        return tuple(stage for stage in STAGES if asked.get(stage))

    @property
    def named(self) -> set[str]:
        """Figures that a constraint or an objective is of."""
        return {c.figure for c in self.constraints} | {o.figure for o in self.objectives}

    def constraints_of(self, stage: str) -> list[Constraint]:
        """Conditions on figures that a stage finds."""
        return [c for c in self.constraints if MERITS[c.figure].stage == stage]


@checked
def read_study(path: str | Path) -> Study:
    """Read a study file and the scenario and the design that it names.

    Raises
    ------
    DesignError
        With every fault of the file: field, value, what is allowed and the remedy.

    Examples
    --------
    >>> import compass
    >>> [each.figure for each in compass.read_study("designs/study-small.toml").objectives]
    ['satellites', 'gdop_p95']
    """
    place = Path(path)
    return read_study_text(read_text(place), readable(path), place.parent)


def _doubts(table: EntryStageTable, faults: list[str]) -> Doubts:
    """What the lander does not know of clocks, orbits and biases; the usual where left out."""
    names = ("clock_m", "clock_drift_m_s", "orbit_m", "satellite_clock_m", "range_bias_m")
    given = {name: value for name in names if (value := getattr(table, name)) is not None}
    if "orbit_m" in given:
        given["orbit_m"] = tuple(given["orbit_m"])
    try:
        return Doubts(**given)
    except ArgumentError as error:
        faults.append(f"entry: {error}")
        return NO_DOUBTS


def read_study_text(text: str, label: str = "study", folder: Path = Path()) -> Study:
    """Read a study from its TOML text; files it names are looked for from `folder`."""
    file = parse(text, label, StudyFile, study_faults)
    digest = hashlib.sha256(text.encode())
    faults: list[str] = []
    scenario = compare = None
    if file.entry:
        scenario = _named(read_scenario, folder / file.entry.scenario, "entry.scenario", faults)
    if file.compare:
        compare = _named(read_design, folder / file.compare.design, "compare.design", faults)
    doubts = _doubts(file.entry, faults) if file.entry else NO_DOUBTS
    if faults:
        raise DesignError([f"{label}: {line}" for line in faults])
    motion = motion_of_table(file.motion, folder, label)
    digest.update(digest_of((scenario, compare, doubts, motion)).encode())
    stations = [site_of(station, FIGURES[file.figure]) for station in file.station]
    entry = None
    if file.entry and scenario is not None:
        entry = EntryStage(
            scenario,
            file.entry.samples,
            file.entry.finalists,
            file.entry.finalist_samples,
            file.entry.filter_runs,
            file.entry.density_sigma,
            file.entry.lift_sigma,
            file.entry.goal_m,
            doubts,
            sites_named(file.entry.sites, stations),
            region_texts(file.entry.region),
        )
    return Study(
        name=file.name,
        source=file.source,
        figure=FIGURES[file.figure],
        space=_space(file.study),
        sampling=file.sampling,
        fold=file.study.fold,
        seed=file.study.seed,
        constraints=(
            *(_constraint(table) for table in file.constraint),
            *([Constraint("requirements_met", 1.0, np.inf, False)] if file.requirement else []),
        ),
        objectives=tuple(
            Objective(o.figure, 1 if (o.goal or MERITS[o.figure].goal) == "minimise" else -1)
            for o in file.objective
        ),
        map=file.map,
        cost=file.cost,
        orbits=file.orbits,
        motion=motion,
        launching=launching_of(file.deployment),
        entry=entry,
        compare=compare,
        text=text,
        digest=digest.hexdigest(),
        label=label,
        requirements=requirements_of(file.requirement, stations),
        signal=None if file.signal is None else signal_of_table(file.signal),
        sites=sites_named(file.map.sites, stations),
        regions=region_texts(file.map.region),
    )


def _named(
    read: Callable[[Path], FileKind], path: Path, field: str, faults: list[str]
) -> FileKind | None:
    """Read a file that a field of the study names; its faults are added to `faults`."""
    try:
        return read(path)
    except CompassError as error:
        faults += [f"{field}: {line}" for line in str(error).splitlines()]
        return None


def _space(table: SpaceTable) -> Space:
    if table.orbits is not None:
        rate = areosynchronous_radius() / 1e3
        radii: tuple[float, ...] | Free = tuple(
            rate * REVOLUTIONS[orbit] ** (-2 / 3) for orbit in table.orbits
        )
    else:
        assert table.radius_km is not None  # study_faults has seen to it
        radii = _numbers(table.radius_km)
    return Space(
        tuple(dict.fromkeys(table.patterns)),
        _counts(table.satellites),
        None if table.planes is None else _counts(table.planes),
        None if table.phasing is None else _counts(table.phasing),
        _numbers(table.inclination_deg),
        radii,
        _numbers(table.mask_deg),
        tuple(REVOLUTIONS[orbit] for orbit in table.orbits or ()),
    )


def _counts(table: Counts) -> tuple[int, ...]:
    if table.values is not None:
        return tuple(dict.fromkeys(table.values))
    return tuple(range(table.least or 0, (table.most or 0) + 1, table.step))


def _numbers(table: Numbers) -> tuple[float, ...] | Free:
    if table.values is not None:
        return tuple(dict.fromkeys(float(value) for value in table.values))
    low, high = float(table.least or 0.0), float(table.most or 0.0)
    if table.step is None:
        return Free(low, high)
    count = int(np.floor((high - low) / table.step + 1e-9)) + 1
    return tuple(round(low + k * table.step, 9) for k in range(count))


def _constraint(table: ConstraintTable) -> Constraint:
    infinity = float("inf")
    low = table.at_least if table.at_least is not None else table.above
    high = table.at_most if table.at_most is not None else table.below
    strict = table.above is not None or table.below is not None
    return Constraint(
        table.figure,
        -infinity if low is None else low,
        infinity if high is None else high,
        strict,
    )
