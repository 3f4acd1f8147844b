"""One self-contained HTML page about a design, a scenario, a study, a paper or a result."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from compass.api.given import (
    given_places,
    given_scenario,
    given_study,
    in_metres,
    joined_designs,
    with_beacons,
)
from compass.api.judge import JudgeResult
from compass.api.land import LandResult, land
from compass.api.progress import bar
from compass.api.reproduce import ReproduceResult, reproduce
from compass.api.results import Result
from compass.arguments import checked
from compass.design import Design
from compass.document import Page, Section, Verdict
from compass.document.plain import plain
from compass.errors import ArgumentError, near
from compass.inputs.reading import read_text, tables_of
from compass.inputs.scenario import Scenario
from compass.inputs.study import Study
from compass.pages.design import PARTS, design_report
from compass.pages.judge import judge_report
from compass.pages.landing import landing_report
from compass.pages.page import check_page_folder, write_page
from compass.pages.paper import paper_report
from compass.pages.trade import trade_report
from compass.papers import PAPERS
from compass.saving import write_files
from compass.sites import Site
from compass.study.mapping import MapOptions


@dataclass(frozen=True, repr=False)
class ReportResult(Result):
    """Where a page is, and what it says in numbers.

    Attributes
    ----------
    title
        What it is about.
    page
        The page.
    known
        Numbers of a study's page, or the pictures beside it.
    """

    title: str
    page: Path
    known: Mapping[str, Any] = field(repr=False)

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return plain({"page": str(self.page), **self.known})

    def document(self) -> Page:
        """Where the page is."""
        return Page("report", (Verdict("", str(self.page)),))


@checked
def report(
    thing: Design | Scenario | Study | JudgeResult | LandResult | ReproduceResult | str | Path,
    *others: Design | str | Path,
    sites: Site | str | Sequence[Site | str] = (),
    regions: str | Sequence[str] = (),
    beacons: Site | str | Sequence[Site | str] = (),
    output: str | Path | None = None,
    step_deg: float | None = None,
    epochs: int | None = None,
    store: str | Path | None = None,
    command: str = "",
    progress: bool = False,
) -> ReportResult:
    """Report on a design, a scenario, a study, a paper or a result: one page, without a network.

    A file with a table [study] is a study, and its page is made from the store of
    `compass.trade`; one with a table [vehicle] is a scenario of landing; all else is a
    design. A name of `compass.papers.PAPERS` that is no file is a source paper.

    Parameters
    ----------
    thing
        What to report on, or the path of its file, or the name of a paper; or what `compass.judge`,
        `compass.land` or `compass.reproduce` found, which is then shown as it is.
    *others
        More designs, which are one network with a first: their satellites together.
    sites, regions
        Where figures of a design are wanted besides those of the whole surface, as of
        `compass.map`.
    beacons
        Of a design, on the ground, as of `compass.check`.
    output
        Folder for the page and its pictures; by default ``reports/`` and the name of the file.
    step_deg, epochs
        Cell size of a design's maps, degrees, and epochs in their period.
    store
        Folder of a study's store; by default ``trades/`` and the name of the file.
    command
        What to write into the page's provenance.
    progress
        Show bars on stderr.

    Raises
    ------
    ArgumentError, DesignError, OutputError
        An option, the file or the folder is not allowed.

    Examples
    --------
    >>> import tempfile
    >>> import compass
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     found = compass.report("designs/entry-ground-beacons.toml", output=f"{folder}/page")
    ...     found.page.name, "<h1>" in found.page.read_text()
    ('index.html', True)
    """
    read: Any = thing
    if isinstance(thing, str | Path):
        kind, name = _kind(Path(thing)), str(thing)
    elif isinstance(thing, (Design, *_KINDS)):
        kind, name = _KINDS.get(type(thing), "design"), _name(thing)
    else:
        raise ArgumentError(
            f"thing = {type(thing).__name__}: must be a Design, a Scenario, a Study, their file, a "
            "paper's name, or what judge, land or reproduce found"
        )
    if output is not None:
        folder = Path(output)
    elif isinstance(thing, str | Path):
        folder = Path("reports") / " + ".join(_stem(one) for one in (thing, *others))
    else:
        raise ArgumentError("output: needed for what is not read from a file; name a folder")
    check_page_folder(folder)
    if others and kind != "design":
        raise ArgumentError(
            f"{others[0]}: {name} is not a design, with which others are one network; leave it out"
        )
    finer = {"step_deg": step_deg, "epochs": epochs}
    placed = {"sites": sites, "regions": regions, "beacons": beacons}
    if kind != "design" and (asked := [key for key, value in placed.items() if value]):
        raise ArgumentError(f"{asked[0]}: {name} is not a design; leave it out")
    options: dict[str, Any] = {key: value for key, value in finer.items() if value is not None}
    if options and kind != "design":
        raise ArgumentError(
            f"{next(iter(options))}: {name} is not a design, and says itself how finely it is "
            "looked at; leave it out"
        )
    if kind != "study" and store is not None:
        raise ArgumentError(f"store: {name} is not a study; leave it out")
    if kind == "study":
        return _study(given_study(read), folder, _store(thing, store), command, progress)
    several: Sequence[Section]
    if kind == "paper":
        compared = read if isinstance(read, ReproduceResult) else reproduce(str(read))
        title, (page, several) = compared.title, paper_report(compared, command)
    elif kind == "scenario":
        is_flown = isinstance(read, LandResult)
        flown = read if is_flown else land(given_scenario(read), command=command, progress=progress)
        title, (page, several) = flown.scenario.name, landing_report(flown)
    elif kind == "ranking":
        title, (page, several) = name, judge_report(read, command)
    else:
        chosen = with_beacons(in_metres(joined_designs((read, *others))), beacons)
        places = given_places(sites, regions, chosen)
        with bar(progress, "report", total=PARTS, unit="part", leave=False) as parts:
            title = chosen.name
            page, several = design_report(
                chosen,
                command,
                MapOptions(**options),
                places,
                progress=lambda part: _step(parts, part),
            )
    path = write_page(folder, page, several)
    pictures = [p.file_name for section in several for p in section.pictures]
    return ReportResult(title, path, {"pictures": [str(folder / name) for name in pictures]})


#: What a page is about, by the type of what is given; else a design.
_KINDS: dict[type, str] = {
    Study: "study",
    Scenario: "scenario",
    LandResult: "scenario",
    ReproduceResult: "paper",
    JudgeResult: "ranking",
}


def _stem(thing: Design | str | Path) -> str:
    """What a page's folder is called by a file, or by a design of none."""
    return thing.name if isinstance(thing, Design) else Path(thing).stem


def _name(thing: object) -> str:
    """What something that is no path is called."""
    if isinstance(thing, JudgeResult | LandResult):
        return thing.scenario.name
    return str(getattr(thing, "title", "") or getattr(thing, "name", thing))


def _kind(path: Path) -> str:
    """What a file describes, by its tables; a design if it is no TOML, which its reader says.

    A paper is known by its name, where there is no file of it.
    """
    if not path.exists():
        if str(path) in PAPERS:
            return "paper"
        if meant := near(str(path), PAPERS):
            raise ArgumentError(f"{path}: no file and no paper; did you mean {meant[0]}?")
    text = read_text(path)
    try:
        tables = set(tables_of(text))
    except ValueError:
        return "design"
    return "study" if "study" in tables else "scenario" if "vehicle" in tables else "design"


def _store(thing: object, store: str | Path | None) -> Path:
    """Where a study's store is."""
    if store is not None:
        return Path(store)
    if isinstance(thing, str | Path):
        return Path("trades") / Path(thing).stem
    raise ArgumentError("store: needed for a study that is not read from a file; name its folder")


def _study(study: Study, folder: Path, store: Path, command: str, progress: bool) -> ReportResult:
    """Make the page of a study, its numbers and the files handed over beside it."""
    with bar(progress, "report", unit="part", leave=False) as parts:
        made = trade_report(study, store, command, progress=lambda part: _step(parts, part))
    path = write_page(folder, made.page, made.sections)
    summary = json.dumps(plain(made.summary), indent=2, allow_nan=False, ensure_ascii=False)
    write_files(folder, {"summary.json": summary + "\n", **made.files})
    return ReportResult(study.name, path, made.summary)


def _step(parts: Any, part: str) -> None:
    """Say which part of a page is being made."""
    parts.set_postfix_str(part)
    parts.update()
