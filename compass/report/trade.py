"""The design trade report of a study: fronts, the best, sensitivity, maps, recommendation."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import compass
from compass.coverage.certificate import prove_fold
from compass.inputs.merit import MERITS, STAGES
from compass.inputs.study import Study
from compass.report.page import render
from compass.report.section import Section, Table
from compass.report.trade_pictures import (
    front_pictures,
    map_comparison,
    sensitivity_pictures,
    share_picture,
)
from compass.study.candidates import make_constellation
from compass.study.choice import Finalist, finalists_of, yardstick
from compass.study.results import read_results

if TYPE_CHECKING:
    import xarray as xr

#: Rows of a table of the best.
BEST = 10

_VARIABLES = ("pattern", "satellites", "planes", "phasing", "inclination_deg", "radius_km")


def trade_report(
    study: Study,
    folder: Path,
    command: str = "",
    *,
    progress: Callable[[str], None] = lambda step: None,
) -> tuple[str, list[Section], dict[str, Any]]:
    """Make the page (HTML text), the sections and the numbers of a study's report.

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
    chosen, measure = finalists_of(study, results), yardstick(study)
    progress("recommendation")
    certified = {f.notation: _certificate(study, f) for f in chosen}
    sections = [_recommendation(study, chosen, measure, certified), _looked_at(study, results)]
    if chosen:
        progress("fronts")
        sections.append(_fronts(study, results, chosen, measure))
        sections.append(_best(study, results))
        progress("sensitivity")
        sections.append(_sensitivity(study, results))
        progress("maps")
        sections.append(_maps(study, chosen, measure))
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
    return page, sections, _summary(study, results, chosen, measure, certified)


def _certificate(study: Study, finalist: Finalist) -> str:
    """Outcome of the certificate, whose rounding is on the safe side."""
    return prove_fold(
        make_constellation(finalist.row),
        study.fold,
        sphere_radius=study.figure.equatorial_radius,
        mask=float(np.radians(finalist.row["mask_deg"])),
    ).outcome


def shown_figures(study: Study) -> list[str]:
    """Figures worth a row: those wanted, then the rest of the stages that the study has."""
    wanted = [o.figure for o in study.objectives]
    others = [
        name
        for name, merit in MERITS.items()
        if name not in wanted and (study.entry or merit.stage != "entry")
    ]
    return wanted + others


def _recommendation(
    study: Study,
    chosen: Sequence[Finalist],
    measure: Finalist | None,
    certified: dict[str, str],
) -> Section:
    if not chosen:
        return Section("Recommendation", ("No candidate meets every constraint; see below why.",))
    first = chosen[0]
    numbers = ", ".join(f"{o.figure} {first.figures[o.figure]:.5g}" for o in study.objectives)
    text = [
        f"Build {first.notation}: {numbers}. It is the balanced choice of the Pareto front: the "
        "largest of its shortfalls from the front's best, each in ranges of the front, is the "
        f"smallest. Its {study.fold}-fold coverage above {first.row['mask_deg']:g} deg is "
        f"{certified[first.notation]} for all time by a certificate whose rounding is on the safe "
        "side (two-body motion).",
    ]
    for other in chosen[1:]:
        text.append(f"{other.role}: {other.notation}, {_against(study, other, first)}.")
    tables = [_finalist_table(study, chosen, measure, certified)]
    if measure is not None:
        rows = [
            (f.role, f.notation, _verdict(study, f, measure), _against(study, f, measure))
            for f in chosen
        ]
        tables.append(
            Table(
                f"Against {measure.role}",
                ("role", "candidate", "verdict", "by objective"),
                tuple(rows),
            )
        )
    return Section("Recommendation", tuple(text), (), tuple(tables))


def _against(study: Study, one: Finalist, other: Finalist) -> str:
    """How one compares with another, objective by objective."""
    parts = []
    for o in study.objectives:
        a, b = one.figures[o.figure], other.figures[o.figure]
        if a == b:
            parts.append(f"{o.figure} equal")
        elif np.isfinite(a) and np.isfinite(b):
            word = "better" if o.sign * a < o.sign * b else "worse"
            change = f" ({100 * (a / b - 1):+.1f} %)" if b else ""
            parts.append(f"{o.figure} {word}: {a:.5g} against {b:.5g}{change}")
        else:
            parts.append(f"{o.figure} {a:.5g} against {b:.5g}")
    return "; ".join(parts)


def _verdict(study: Study, one: Finalist, other: Finalist) -> str:
    pairs = [
        (o.sign * one.figures[o.figure], o.sign * other.figures[o.figure]) for o in study.objectives
    ]
    if any(np.isnan(a) or np.isnan(b) for a, b in pairs):
        return "not comparable"
    if all(a <= b for a, b in pairs) and any(a < b for a, b in pairs):
        return "beats it in all"
    if all(a >= b for a, b in pairs) and any(a > b for a, b in pairs):
        return "loses in all"
    if all(a == b for a, b in pairs):
        return "equal"
    return "a trade"


def _finalist_table(
    study: Study,
    chosen: Sequence[Finalist],
    measure: Finalist | None,
    certified: dict[str, str],
) -> Table:
    columns = [*chosen, *([measure] if measure else [])]
    rows: list[tuple[object, ...]] = [("constellation", *(f.notation for f in columns))]
    for name in shown_figures(study):
        merit = MERITS[name]
        unit = "" if merit.unit == "1" else f", {merit.unit}"
        rows.append((f"{merit.title}{unit}", *(_number(f.figures[name]) for f in columns)))
    rows.append(("certificate of the fold", *(certified.get(f.notation, "") for f in columns)))
    return Table("The finalists", ("figure of merit", *(f.role for f in columns)), tuple(rows))


def _number(value: float) -> object:
    return "–" if np.isnan(value) else float(f"{value:.5g}")


def _looked_at(study: Study, results: "xr.Dataset") -> Section:
    stage = np.array([STAGES.index(s) for s in results.stage.values])
    total = results.sizes["candidate"]
    rows: list[tuple[object, ...]] = [("looked at", total)]
    rows += [
        (f"reached stage {name}", int((stage >= k).sum())) for k, name in enumerate(STAGES) if k > 1
    ]
    rows += [
        ("raised an error", int((results.error.values != "").sum())),
        ("meet every constraint", int(results.feasible.sum())),
        ("on the first Pareto front", int((results.front.values == 0).sum())),
    ]
    fails = []
    for c in study.constraints:
        values = results[c.figure].values
        known = values[~np.isnan(values)]
        held = sum(c.holds(float(v)) for v in known)
        fails.append((str(c), int(known.size), int(held), int(known.size - held)))
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
        "constraints were mapped over area and time; the best fronts of these were judged as "
        "beacons of a lander, where the study asks for it."
    )
    return Section("What was looked at", (text,), (), tuple(tables))


def _fronts(
    study: Study, results: "xr.Dataset", chosen: Sequence[Finalist], measure: Finalist | None
) -> Section:
    front = results.isel(candidate=np.flatnonzero(results.front.values == 0))
    order = np.lexsort([o.sign * front[o.figure].values for o in study.objectives[::-1]])
    table = _candidate_table(
        "The first Pareto front, first 40", study, front.isel(candidate=order[:40])
    )
    text = "None is better than one of the first front in an objective and as good in all others."
    return Section(
        "Pareto fronts", (text,), front_pictures(study, results, chosen, measure), (table,)
    )


def _candidate_table(title: str, study: Study, some: "xr.Dataset") -> Table:
    names = [*_VARIABLES, *(o.figure for o in study.objectives if o.figure not in _VARIABLES)]
    if "mask_margin_deg" not in names:
        names.append("mask_margin_deg")
    rows = []
    for k in range(some.sizes["candidate"]):
        values = [some[name].values[k] for name in names]
        rows.append(tuple(v if isinstance(v, str) else _number(float(v)) for v in values))
    return Table(title, tuple(name.replace("_", " ") for name in names), tuple(rows))


def _best(study: Study, results: "xr.Dataset") -> Section:
    good = results.isel(candidate=np.flatnonzero(results.front.values >= 0))
    tables = []
    for objective in study.objectives:
        rest = [o for o in study.objectives if o is not objective]
        keys = [o.sign * good[o.figure].values for o in [*rest[::-1], objective]]
        some = good.isel(candidate=np.lexsort(keys)[:BEST])
        title = f"{objective.goal.capitalize()} {MERITS[objective.figure].title}"
        tables.append(_candidate_table(title, study, some))
    return Section(
        "The best by objective", ("Ties by the other objectives in order.",), (), tuple(tables)
    )


def _sensitivity(study: Study, results: "xr.Dataset") -> Section:
    text = (
        "How the constraints and the objectives depend on each variable alone, over all "
        "candidates with that value, whatever the others are."
    )
    pictures = (share_picture(results), *sensitivity_pictures(study, results))
    return Section("Sensitivity", (text,), pictures)


def _maps(study: Study, chosen: Sequence[Finalist], measure: Finalist | None) -> Section:
    shown = [*chosen[:5], *([measure] if measure else [])]
    return Section("The finalists' maps", (), (map_comparison(study, shown),))


def _summary(
    study: Study,
    results: "xr.Dataset",
    chosen: Sequence[Finalist],
    measure: Finalist | None,
    certified: dict[str, str],
) -> dict[str, Any]:
    """Return the numbers of the report as plain values."""

    def facts(f: Finalist) -> dict[str, Any]:
        row = {name: f.row[name].item() for name in f.row.dtype.names or () if name != "pattern"}
        return {
            "role": f.role,
            "constellation": f.notation,
            **row,
            "certificate": certified.get(f.notation),
            "figures": f.figures,
        }

    return {
        "study": study.name,
        "study_sha256": study.digest,
        "version": compass.__version__,
        "candidates": results.sizes["candidate"],
        "feasible": int(results.feasible.sum()),
        "judged": int((results.stage.values == "entry").sum()),
        "errors": int((results.error.values != "").sum()),
        "first_front": int((results.front.values == 0).sum()),
        "finalists": [facts(f) for f in chosen],
        "compared_with": None if measure is None else facts(measure),
    }
