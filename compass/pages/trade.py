"""The design trade report of a study: fronts, the best, sensitivity, maps, recommendation."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import compass
from compass.api.trade import clock_blocks
from compass.document import Evidence, Sampled, Value
from compass.document.blocks import Picture, Section, Sentence, Table, arranged
from compass.inputs.study import Constraint, Free, Study
from compass.pages.page import render
from compass.pages.trade_finalists import (
    Entrant,
    answer_section,
    entrants,
    handover_files,
    handover_section,
    landing_sections,
    rank_finalists,
    recommendation,
    with_unit,
)
from compass.pages.trade_interactive import interactive_front
from compass.pages.trade_pictures import (
    front_pictures,
    map_comparison,
    sensitivity_pictures,
    share_picture,
)
from compass.quantities import Quantity, quantity
from compass.quantities.merits import MERITS, STAGES
from compass.study.area_figures import shown_areas
from compass.study.bounds import bracketed_figures, limited_figures
from compass.study.candidates import make_constellation
from compass.study.choice import Finalist, finalists_of, notation, rows_in
from compass.study.clocks import errors_by_clock
from compass.study.columns import shown
from compass.study.requirement_figures import shown_requirements
from compass.study.results import bounds_beside, known_figures, read_results
from compass.study.sampling import front_known, map_errors, sampled_over, sampling_of
from compass.study.yardstick import Yardstick, yardstick
from compass.words import capital

if TYPE_CHECKING:
    import xarray as xr

#: Rows of a table of the best.
BEST = 10

#: Candidates of the first front in its table.
SHOWN = 40


@dataclass(frozen=True)
class TradeReport:
    """A study's report.

    Attributes
    ----------
    page, sections
        HTML text, and what it was made of.
    summary
        The numbers, as plain values.
    files
        Texts of the files handed over, by name, which may name a folder.
    """

    page: str
    sections: list[Section]
    summary: dict[str, Any]
    files: dict[str, str]


def trade_report(
    study: Study,
    folder: Path,
    command: str = "",
    *,
    progress: Callable[[str], None] = lambda step: None,
) -> TradeReport:
    """Make the report of a study.

    Parameters
    ----------
    study
        The study.
    folder
        Its store.
    command
        The command line, for provenance.
    progress
        Told the name of each part before it is made.

    Raises
    ------
    ArgumentError
        There is no store, or it is of another study or version.
    """
    progress("results")
    results = read_results(study, folder)
    progress("finalists")
    chosen, measure = entrants(study, finalists_of(study, results)), yardstick(study)
    ranked = rank_finalists(study, chosen, progress)
    ranking = None if ranked is None else ranked[0].record
    advised = recommendation(study, chosen, measure, ranking)
    sections = [advised, _looked_at(study, results)]
    if chosen:
        finalists = [e.finalist for e in chosen]
        progress("fronts")
        first, *others = front_pictures(study, results, finalists, measure) or (None,)
        carrying = interactive_front(study, results, finalists, measure, first)
        sections = [
            answer_section(study, chosen, measure, ranking, carrying),
            Section("Recommendation", (*map(Sentence, advised.paragraphs), *advised.tables)),
            _fronts(study, results, others),
            _looked_at(study, results),
        ]
        sections.append(_best(study, results))
        progress("sensitivity")
        sections.append(_sensitivity(study, results))
        progress("maps")
        sections.append(_maps(study, finalists, measure))
        progress("clocks")
        if clocks := clock_blocks(study, errors_by_clock(study, results)):
            sections.append(Section("What a better clock buys", tuple(clocks)))
        if ranked is not None:
            sections += landing_sections(study, *ranked, progress)
        sections.append(handover_section(chosen))
    page = render(
        study.name,
        " ".join(study.source.split()) or "No source given.",
        sections,
        [
            ("command", command or "made from Python"),
            ("version", f"compass {compass.__version__}"),
            ("study file", study.label),
            ("SHA-256 of the study", study.digest),
            ("reference figure", study.figure.title),
        ],
        study.text,
    )
    summary = _summary(study, results, chosen, measure, ranking)
    return TradeReport(page, sections, summary, handover_files(chosen))


def _looked_at(study: Study, results: "xr.Dataset") -> Section:
    stage = np.array([STAGES.index(s) for s in results.stage.values])
    total = results.sizes["candidate"]
    rows: list[tuple[object, ...]] = [("looked at", total)]
    rows += [
        (f"reached stage {name}", reached)
        for k, name in enumerate(STAGES)
        if k > 1 and (reached := int((stage >= k).sum()))
    ]
    raised = int((results.error.values != "").sum())
    rows += [
        *([("raised an error", raised)] if raised else []),
        ("meet every constraint", int(results.feasible.sum())),
        ("on the first Pareto front", int((results.front.values == 0).sum())),
    ]
    fails = []
    for c in study.constraints:
        values = results[c.figure].values
        known = values[~np.isnan(values)]
        held = sum(c.holds(float(v)) for v in known)
        fails.append((_asked(c), int(known.size), int(held), int(known.size - held)))
    tables = [Table("Candidates", ("", "number"), tuple(rows))]
    if fails:
        header = ("constraint", "candidates it was tried on", "met it", "failed it")
        tables.append(Table("Constraints", header, tuple(fails)))
    failed = results.isel(candidate=np.flatnonzero(results.error.values != ""))
    if failed.sizes["candidate"]:
        lines = tuple(
            (str(i), str(e))
            for i, e in zip(failed.identity.values[:20], failed.error.values[:20], strict=True)
        )
        tables.append(Table("Errors, first 20", ("candidate", "error"), lines))
    text = (
        "Every candidate went through the exact screen (costs, fold, margin); those that met its "
        "constraints were mapped over area and time; the best fronts of these, by what was known "
        "so far, were judged as beacons of a lander, where the study asks for it."
    )
    return arranged("What was looked at", (text,), (), tuple(tables))


def _asked(c: Constraint) -> str:
    """A constraint in words."""
    if c.figure == "fold_proven":
        return "the fold, proven"
    above = np.isfinite(c.low)
    words = {(True, False): "at least", (True, True): "above", (False, False): "at most"}
    value = with_unit(Value(MERITS[c.figure].quantity, c.low if above else c.high))
    return f"{MERITS[c.figure].title} {words.get((bool(above), c.strict), 'below')} {value}"


def _fronts(study: Study, results: "xr.Dataset", pictures: Sequence[Picture]) -> Section:
    """Show the first front, two objectives at a time, and its candidates in a table."""
    front = results.isel(candidate=np.flatnonzero(results.front.values == 0))
    order = np.lexsort([o.sign * front[o.figure].values for o in study.objectives[::-1]])
    cut = f", first {SHOWN} of {order.size}" if order.size > SHOWN else ""
    table = _candidate_table(
        f"The first Pareto front{cut}", study, front.isel(candidate=order[:SHOWN])
    )
    text = (
        "None is better than one of the first front in an objective and as good in all others; "
        "one of the front need not be the best in any two of them alone."
    )
    bounded = [name for name in bracketed_figures(study) if name in MERITS]
    rest = [name for name in known_figures(study) if name not in bounded]
    if how := sampled_over(study, rest):
        text += f" Sampled: {how}; what differs by less than another sampling would has no order."
    if bounded:
        titles = ", ".join(MERITS[name].title for name in bounded)
        text += (
            f" Of those that may be of the front, {titles} lie between proven bounds, for all "
            "time, brought as near as it takes to tell who is, and who keeps a limit. Bars show "
            "the bounds."
        )
    if told := [name for name in limited_figures(study) if name not in bounded]:
        titles = ", ".join(MERITS[name].title for name in told)
        text += f" On which side of its limit {titles} is, is told by proven bounds."
    text += f" {capital(front_known(study, results))}."
    return arranged("Pareto fronts", (text,), pictures, (table,))


def _candidate_table(title: str, study: Study, some: "xr.Dataset") -> Table:
    names = [*dict.fromkeys([*(o.figure for o in study.objectives), "mask_margin_deg"])]
    if isinstance(study.space.mask_deg, Free) or len(study.space.mask_deg) > 1:
        names = ["mask_deg", *names]
    labels = [_quantity(name).heading for name in names]
    each = shown([*shown_areas(study), *shown_requirements(study)], some)
    labels += [heading for heading, _ in each]
    columns = [_column(study, some, name) for name in names]
    rows = [
        (
            notation(make_constellation(row)).replace(" ", "\N{NO-BREAK SPACE}"),
            *(cells[k] for cells in columns),
            *(values[k] for _, values in each),
        )
        for k, row in enumerate(rows_in(some))
    ]
    return Table(title, ("constellation", *labels), tuple(rows))


def _column(study: Study, some: "xr.Dataset", name: str) -> list[object]:
    """A figure of candidates: between its bounds, or with what sampling leaves of doubt."""
    known, values = _quantity(name), some[name].values.astype(float)
    told: list[Evidence | None] = [*bounds_beside(study, some, name)]
    how = sampling_of(study, name) if name in MERITS else ""
    if how and None in told:
        errors = map_errors(study, rows_in(some)).get(name, np.full(values.size, np.nan))
        sampled = [Sampled(None if np.isnan(error) else float(error), how) for error in errors]
        told = [own or rough for own, rough in zip(told, sampled, strict=True)]
    return [
        "–" if np.isnan(value) else Value(known, float(value), evidence)
        for value, evidence in zip(values, told, strict=True)
    ]


def _quantity(name: str) -> Quantity:
    """What a column is of: a figure of merit, or what varies."""
    return MERITS[name].quantity if name in MERITS else quantity(name)


def _best(study: Study, results: "xr.Dataset") -> Section:
    good = results.isel(candidate=np.flatnonzero(results.front.values >= 0))
    tables = []
    for objective in study.objectives:
        rest = [o for o in study.objectives if o is not objective]
        keys = [o.sign * good[o.figure].values for o in [*rest[::-1], objective]]
        some = good.isel(candidate=np.lexsort(keys)[:BEST])
        title = f"{objective.goal.capitalize()} {MERITS[objective.figure].title}"
        tables.append(_candidate_table(title, study, some))
    return arranged(
        "The best by objective", ("Ties by the other objectives in order.",), (), tuple(tables)
    )


def _sensitivity(study: Study, results: "xr.Dataset") -> Section:
    text = (
        "How the constraints and the objectives depend on each variable alone, over all "
        "candidates with that value, whatever the others are."
    )
    pictures = (share_picture(results), *sensitivity_pictures(study, results))
    return arranged("Sensitivity", (text,), pictures)


def _maps(study: Study, chosen: Sequence[Finalist], measure: Yardstick | None) -> Section:
    shown: list[Finalist | Yardstick] = [*chosen[:5], *([measure] if measure else [])]
    return arranged("The finalists' maps", (), (map_comparison(study, shown),))


def _summary(
    study: Study,
    results: "xr.Dataset",
    chosen: Sequence[Entrant],
    measure: Yardstick | None,
    ranking: dict[str, Any] | None,
) -> dict[str, Any]:
    """Return the numbers of the report as plain values."""

    def facts(f: Finalist | Yardstick) -> dict[str, Any]:
        about = {"role": f.role, "constellation": f.notation, **f.variables, "figures": f.figures}
        return about | {"brackets": f.brackets, "errors": f.errors}

    stage = [STAGES.index(s) for s in results.stage.values]
    return {
        "study": study.name,
        "study_sha256": study.digest,
        "version": compass.__version__,
        "candidates": results.sizes["candidate"],
        "feasible": int(results.feasible.sum()),
        "judged": stage.count(STAGES.index("entry")),
        "errors": int((results.error.values != "").sum()),
        "first_front": int((results.front.values == 0).sum()),
        "finalists": [
            facts(e.finalist) | {"certificate": e.certificate, "design": e.design.label}
            for e in chosen
        ],
        "compared_with": None if measure is None else facts(measure),
        "landing": ranking,
    }
