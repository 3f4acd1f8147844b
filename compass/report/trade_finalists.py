"""The part of a trade report on the finalists: recommendation, comparison, landing, hand-over."""

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from compass.coverage.certificate import prove_fold
from compass.handover.czml import czml
from compass.handover.geojson import geojson
from compass.handover.instants import sample_times
from compass.handover.oem import oem
from compass.handover.toml import constellation_toml
from compass.inputs import Design, read_design_text
from compass.inputs.merit import MERITS
from compass.inputs.study import Study
from compass.report.judge import judge_section, surface_section
from compass.report.section import Section, Table
from compass.sites import Mask
from compass.study.candidates import make_constellation
from compass.study.choice import Finalist, compared_mask_deg
from compass.study.ranking import rank_designs
from compass.study.results import known_figures


@dataclass(frozen=True)
class Entrant:
    """A finalist as a design.

    Attributes
    ----------
    finalist
        The candidate and its figures.
    design
        Read from the design file that the report hands over, whose name is its label.
    certificate
        Outcome of the certificate of its fold, whose rounding is on the safe side.
    """

    finalist: Finalist
    design: Design
    certificate: str


def entrants(study: Study, chosen: Sequence[Finalist]) -> list[Entrant]:
    """Write each finalist down as a design file, and prove its fold."""
    found = []
    for k, finalist in enumerate(chosen, start=1):
        c = replace(make_constellation(finalist.row), name=finalist.notation)
        mask = float(np.radians(finalist.row["mask_deg"]))
        source = f'"{finalist.role}" of the trade study "{study.name}" ({study.label})'
        text = constellation_toml(
            c, study.figure, mask=Mask.constant(mask), fold=study.fold, source=source
        )
        certificate = prove_fold(
            c, study.fold, sphere_radius=study.figure.equatorial_radius, mask=mask
        )
        found.append(
            Entrant(finalist, read_design_text(text, f"finalist-{k}.toml"), certificate.outcome)
        )
    return found


def recommendation(study: Study, chosen: Sequence[Entrant], measure: Finalist | None) -> Section:
    """Say what to build, why, and how each finalist compares with the others and the yardstick."""
    if not chosen:
        return Section("Recommendation", ("No candidate meets every constraint; see below why.",))
    first = chosen[0].finalist
    numbers = ", ".join(f"{o.figure} {first.figures[o.figure]:.5g}" for o in study.objectives)
    text = [
        f"Build {first.notation}: {numbers}. It is the balanced choice of the Pareto front: the "
        "largest of its shortfalls from the front's best, each in ranges of the front, is the "
        f"smallest. Its {study.fold}-fold coverage above {first.row['mask_deg']:g} deg is "
        f"{chosen[0].certificate} for all time by a certificate whose rounding is on the safe "
        "side (two-body motion).",
    ]
    for other in chosen[1:]:
        one = other.finalist
        text.append(f"{one.role}: {one.notation}, {against(study, one, first)}.")
    tables = [_finalist_table(study, chosen, measure)]
    if measure is not None:
        rows = [
            (e.finalist.role, e.finalist.notation, verdict(study, e.finalist, measure),
             against(study, e.finalist, measure))
            for e in chosen
        ]  # fmt: skip
        tables.append(
            Table(
                f"Against {measure.role}",
                ("role", "candidate", "verdict", "by objective"),
                tuple(rows),
            )
        )
    return Section("Recommendation", tuple(text), (), tuple(tables))


def against(study: Study, one: Finalist, other: Finalist) -> str:
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


def verdict(study: Study, one: Finalist, other: Finalist) -> str:
    """Whether one beats another in all objectives, loses in all, or is a trade."""
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


def _finalist_table(study: Study, chosen: Sequence[Entrant], measure: Finalist | None) -> Table:
    columns = [*(e.finalist for e in chosen), *([measure] if measure else [])]
    rows: list[tuple[object, ...]] = [("constellation", *(f.notation for f in columns))]
    for name in known_figures(study):
        merit = MERITS[name]
        unit = "" if merit.unit == "1" else f", {merit.unit}"
        rows.append((f"{merit.title}{unit}", *(number(f.figures[name]) for f in columns)))
    rest = ("",) if measure else ()
    rows.append(("certificate of the fold", *(e.certificate for e in chosen), *rest))
    rows.append(("design file", *(e.design.label for e in chosen), *rest))
    return Table("The finalists", ("figure of merit", *(f.role for f in columns)), tuple(rows))


def number(value: float) -> object:
    """Five digits of a number for a table, a dash for none."""
    return "–" if np.isnan(value) else float(f"{value:.5g}")


def rank_finalists(
    study: Study, chosen: Sequence[Entrant], progress: Callable[[str], None]
) -> tuple[dict[str, Any], list[Design]] | None:
    """Judge the finalists and the yardstick again, closely, with the filter; None without entry.

    Where the study draws few entries a candidate, to sort thousands, here are many, other ones
    in part, with the search for the worst, every loss of a satellite, and the filter itself.
    """
    if study.entry is None or not chosen:
        return None
    designs = [e.design for e in chosen]
    if study.compare is not None:
        mask = Mask.constant(float(np.radians(compared_mask_deg(study))))
        label = study.compare.label
        if label in {design.label for design in designs}:
            label = f"./{label}"  # a finalist handed over before, compared with those of now
        designs.append(
            replace(study.compare, figure=study.figure, fold=study.fold, mask=mask, label=label)
        )

    def told(items: Iterable[Any], total: int, desc: str) -> Iterator[Any]:
        for k, item in enumerate(items, start=1):
            progress(f"{desc}: {k} of {total}")
            yield item

    runs = study.entry.filter_runs
    ranking = rank_designs(
        designs,
        study.entry.scenario,
        samples=study.entry.finalist_samples,
        seed=study.seed,
        finalists=len(designs) if runs else 0,
        runs=max(runs, 1),
        threads=os.cpu_count() or 1,
        progress=told,
    )
    return ranking, designs


def landing_sections(
    study: Study,
    ranking: dict[str, Any],
    designs: Sequence[Design],
    progress: Callable[[str], None],
) -> list[Section]:
    """Sections on the finalists' landers and on users on the surface."""
    assert study.entry is not None
    landing = judge_section(
        ranking, designs, study.entry.scenario, threads=os.cpu_count() or 1, progress=progress
    )
    return [landing, surface_section(ranking)]


def handover_files(chosen: Sequence[Entrant]) -> dict[str, str]:
    """Texts of the files handed over, by name: every finalist, the first for other programs too."""
    files = {e.design.label: e.design.text for e in chosen}
    if chosen:
        first = chosen[0].design
        stem = first.label.removesuffix(".toml")
        times = sample_times(first.constellation)
        files[f"{stem}.czml"] = czml(first, times)
        files[f"{stem}.geojson"] = geojson(first, times)
        files |= {f"{stem}-oem/{name}": text for name, text in oem(first, times).items()}
    return files


def handover_section(chosen: Sequence[Entrant]) -> Section:
    """Say which file is which finalist, and how the others go to other programs."""
    rows = tuple((e.design.label, e.finalist.role, e.finalist.notation) for e in chosen)
    first = chosen[0].design.label
    out = first.removesuffix(".toml")
    text = (
        "Beside this page each finalist lies as a design file, which every command reads. The one "
        f"recommended is there for other programs too: {out}-oem (CCSDS OEM, a message a "
        f"satellite), {out}.czml (on the Mars ellipsoid), {out}.geojson (footprints and gaps in "
        "the Mars CRS). For another finalist, or another span: "
        f"compass export {first} --format oem -o FOLDER."
    )
    table = Table("Design files", ("file", "finalist", "constellation"), rows)
    return Section("Hand-over", (text,), (), (table,))
