"""How well a lander navigates on radio beacons."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from compass.api.given import given_scenario
from compass.api.land_dispersed import dispersed_facts
from compass.api.land_facts import entry_facts
from compass.api.land_flight import assess_scenario, check_cost, disperse_scenario, entry_section
from compass.api.land_fusion import fusion_facts, fusion_section, too_sure
from compass.api.land_words import claim_sentence
from compass.api.results import Result
from compass.arguments import checked
from compass.conventions import dated
from compass.document import Page, Picture, Section, Sentence, Verdict
from compass.document.plain import plain
from compass.entry.assess import Assessment, assessment_dataset
from compass.entry.dispersed import Dispersed
from compass.inputs.fusion import fusion_plan
from compass.inputs.scenario import Scenario, provenance
from compass.saving import save_netcdf
from compass.study.fusion import FusionRuns, run_fusion

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


#: Filter runs that take longer (s) are announced.
LONG = 10.0

_ON_DAY = "Entry begins on day {:g} after the epoch of the satellites that serve as beacons."


@dataclass(frozen=True, repr=False)
class LandResult(Result):
    """A scenario flown and navigated.

    Attributes
    ----------
    scenario
        What was flown.
    assessment
        Flight, view, observability, bound and filter.
    fused
        The filters compared, if the scenario has a table [fusion].
    dispersed
        Entries about the planned one, if it has a table [dispersion].
    command
        For the provenance.
    strict
        Whether an inconsistent filter, or a fused one that is too sure, makes the claim fail.
    start_day
        Day after the epoch of the beacons' design at which entry begins; None: as the file says.
    """

    scenario: Scenario = field(repr=False)
    assessment: Assessment = field(repr=False)
    fused: FusionRuns | None = field(repr=False, default=None)
    command: str = ""
    strict: bool = False
    dispersed: Dispersed | None = field(repr=False, default=None)
    start_day: float | None = None

    @property
    def holds(self) -> bool:
        """Whether the filters' claims hold, if that was asked for."""
        if not self.strict:
            return True
        return self.assessment.consistency.holds and not (self.fused and too_sure(self.fused))

    @property
    def dataset(self) -> "xr.Dataset":
        """The flight and everything over its times."""
        data = assessment_dataset(self.assessment)
        return dated(data.assign_attrs(provenance(self.scenario, self.command)))

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        known = entry_facts(self.scenario, self.assessment)
        if self.fused:
            known["fusion"] = fusion_facts(self.fused)
        if self.dispersed:
            known["dispersed"] = dispersed_facts(self.dispersed)
        if self.start_day is not None:
            known["start_day"] = self.start_day
        return plain(known | {"provenance": provenance(self.scenario, self.command)})

    def document(self) -> Page:
        """Knowledge and delivery in a sentence, then the flight and the filters."""
        words = Verdict("", self.claim)
        flight, *fused = self.sections(pictures=False, claim=False)
        day = () if self.start_day is None else (Sentence(_ON_DAY.format(self.start_day)),)
        return Page(self.scenario.name, (words, *day, *flight.blocks, *fused))

    @property
    def claim(self) -> str:
        """Knowledge and delivery, and where dispersed entries come down."""
        guided = self.scenario.guidance is not None
        return claim_sentence(self.assessment, self.dispersed, guided=guided)

    def sections(self, *, pictures: bool = True, claim: bool = True) -> tuple[Section, ...]:
        """The flight with one filter on it, then the filters compared if there are any."""
        words = self.claim if claim else ""
        flight = entry_section(
            self.scenario,
            self.assessment,
            pictures=pictures,
            claim=words,
            dispersed=self.dispersed,
        )
        if self.fused is None:
            return (flight,)
        return flight, fusion_section(self.fused, pictures=pictures)

    def pictures(self) -> tuple[Picture, ...]:
        """All pictures of the flight and the filters."""
        return tuple(picture for section in self.sections() for picture in section.pictures)

    def plot(self, *, axes: "Axes | None" = None) -> "Axes":
        """Draw the ground track, who sees it, the beacons near it, and where it comes down.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.entry import draw_landing, draw_map
        from compass.pictures.style import axes_or_new

        drawn = axes_or_new(axes, 7.5, 5.2)
        draw_map(drawn, self.assessment.flight, self.assessment.beacons)
        draw_landing(drawn, self.assessment, self.dispersed)
        return drawn

    def write(self, path: str | Path) -> None:
        """Write the dataset as netCDF, the filters' results in groups of their own.

        Raises
        ------
        OutputError
            The file cannot be written.
        """
        save_netcdf(Path(path), self.dataset, self.fused.groups() if self.fused else ())


@checked
def land(
    scenario: Scenario | str | Path,
    *,
    runs: int | None = None,
    start_day: float | None = None,
    strict: bool = False,
    command: str = "",
    progress: bool = False,
    notice: Callable[[str], object] = lambda words: None,
) -> LandResult:
    """Fly a scenario and navigate it: trajectory, view, observability, bound and filter.

    A scenario with a table [fusion] is also flown with accelerometers and ranges in centralised
    and distributed filters, through plasma and faults if it has them.

    Parameters
    ----------
    scenario
        A scenario, or the path of its file.
    runs
        Monte Carlo runs; else the scenario's.
    start_day
        Day after the epoch of the beacons' design at which entry begins; else the scenario's.
    strict
        Whether `LandResult.holds` is false where the filter is inconsistent.
    command
        What to write into the files' history.
    progress
        Show bars on stderr.
    notice
        Told what is to be known before the work begins, such as beacons that are never seen.

    Raises
    ------
    ArgumentError, DesignError
        An option or the scenario is not allowed, or the flight ends before its second time.

    Examples
    --------
    >>> import compass
    >>> found = compass.land("designs/entry-ground-beacons.toml", runs=5)
    >>> found.to_dict()["navigation"]["runs"]
    5
    """
    read = given_scenario(scenario, start_day)
    plan = fusion_plan(read)
    for words in plan.case.visibility_report() if plan else ():
        notice(words)
    seconds = check_cost(read, read.runs if runs is None else runs)
    if seconds > LONG:
        notice(f"filter runs: about {seconds:.0f} s")
    assessment = assess_scenario(read, runs)
    fused = run_fusion(plan, runs, progress=progress) if plan else None
    entries = disperse_scenario(read, assessment)
    return LandResult(read, assessment, fused, command, strict, entries, start_day)
