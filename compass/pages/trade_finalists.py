"""The part of a trade report on the finalists: recommendation, comparison, landing, hand-over."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from compass.api.check import verdict_sentences, verdict_table
from compass.api.keep import keep
from compass.api.outlook import glance, left_words
from compass.cores import cores
from compass.coverage.certificate import prove_fold
from compass.coverage.requirement_verdict import verdict_of
from compass.coverage.verdict import Verdict
from compass.design import Design
from compass.document import Answer, Answers, Bracket, Evidence, Sampled, Sentence, Value
from compass.document.blocks import Interactive, Section, Table, arranged
from compass.errors import ArgumentError
from compass.handover.czml import czml
from compass.handover.geojson import geojson
from compass.handover.instants import sample_times
from compass.handover.oem import oem
from compass.handover.toml import design_toml
from compass.inputs import read_design_text
from compass.inputs.study import Objective, Study
from compass.pages.answers import verdict_answers
from compass.pages.judge import judge_section, landing_answer, surface_section
from compass.quantities.merits import MERITS
from compass.requirement import ERRORS
from compass.sites import Mask
from compass.study.area_figures import demanded_folds
from compass.study.choice import Finalist
from compass.study.ranking import Ranking, ground_words, rank_designs
from compass.study.results import known_figures
from compass.study.sampling import sampled_over, sampling_of
from compass.study.yardstick import Yardstick, compared_mask_deg
from compass.words import capital, counted

#: The figure that is of a quick law, and simulated for finalists.
LAW = "delta_v_keeping_m_s_year"


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
    verdicts
        On what the study requires; of the recommended one alone.
    """

    finalist: Finalist
    design: Design
    certificate: str
    verdicts: tuple[Verdict, ...] = ()


def entrants(study: Study, chosen: Sequence[Finalist]) -> list[Entrant]:
    """Write each finalist down as a design file with what is required of it, and prove its fold."""
    wanted, entered = (*study.requirements, *demanded_folds(study)), []
    named = (*study.sites, *(site for each in wanted for site in each.sites))
    stations = {site.name: site for site in named}
    in_metres = any(name in ERRORS for each in wanted for name, _ in each.limits)
    for k, finalist in enumerate(chosen, start=1):
        c = replace(finalist.constellation, name=finalist.notation)
        if wanted or "areas" in study.stages:  # tracks close where the study names the orbits
            c = replace(c, repeat=study.space.repeat(float(finalist.row["radius_km"])))
        mask = float(np.radians(finalist.mask_deg))
        source = f'"{finalist.role}" of the trade study "{study.name}" ({study.label})'
        written = Design(
            c,
            source=source,
            figure=study.figure,
            mask=Mask.constant(mask),
            fold=study.fold,
            stations=tuple(stations.values()),
            requirements=wanted,
            signal=study.signal if in_metres else None,
        )
        text = design_toml(written)
        certificate = prove_fold(
            c, study.fold, sphere_radius=study.figure.equatorial_radius, mask=mask
        )
        design = read_design_text(text, f"finalist-{k}.toml")
        verdicts = tuple(verdict_of(design, each) for each in wanted) if k == 1 else ()
        entered.append(Entrant(finalist, design, certificate.outcome, verdicts))
    return entered


def recommendation(
    study: Study,
    chosen: Sequence[Entrant],
    measure: Yardstick | None,
    ranking: dict[str, Any] | None,
) -> Section:
    """Say what to build and why, and show each finalist beside the others and the yardstick.

    Parameters
    ----------
    study
        The study.
    chosen
        Its finalists, the recommended one first.
    measure
        The design to compare with, put through the same stages, if there is one.
    ranking
        Of `rank_finalists`, if there is one.
    """
    if not chosen:
        text = (
            "No candidate meets every constraint and has a value of every objective; see below why."
        )
        return arranged("Recommendation", (text,))
    first = chosen[0].finalist
    values = {o.figure: known(study, o.figure, first) for o in study.objectives}
    of_each = "; ".join(
        f"{MERITS[figure].title}: {with_unit(value)}" for figure, value in values.items()
    )
    proven = [figure for figure, value in values.items() if isinstance(value.evidence, Bracket)]
    paragraphs = [
        _build(chosen[0]),
        f"By objective: {of_each}. It is the balanced choice of the Pareto front: the largest of "
        "its shortfalls from the front's best, each in ranges of the front, is the smallest.",
        f"Its {study.fold}-fold coverage above {first.mask_deg:g} deg is "
        f"{chosen[0].certificate} for all time by a certificate whose rounding is on the safe "
        "side (two-body motion).",
    ]
    if how := sampled_over(study, [figure for figure in values if figure not in proven]):
        paragraphs[1] += f" Sampled: {how}."
    if measure is not None:
        paragraphs.append(f"Beside {measure.role} it is {against(study, first, measure)}.")
    if ranking is not None:
        row = next(row for row in ranking["designs"] if row["given"] == 1)
        paragraphs.append(
            f"Does a lander {ground_words(ranking)} and at any time know its position to "
            f"{ranking['goal_m']:g} m at {ranking['deployment']}? "
            f"{capital(row['answer'])}."
        )
    tables = [_objective_table(study, chosen, measure), _figure_table(study, chosen, measure)]
    if settled := chosen[0].verdicts:
        tables.append(verdict_table(settled))
        paragraphs += verdict_sentences(settled)
    return arranged("Recommendation", tuple(paragraphs), (), tuple(tables))


def answer_section(
    study: Study,
    chosen: Sequence[Entrant],
    measure: Yardstick | None,
    ranking: dict[str, Any] | None,
    carrying: Interactive,
) -> Section:
    """Say what to build, what it is worth and how sure that is, and what its rival is.

    Parameters as of `recommendation`; `carrying` is the front with the finalists.
    """
    first = chosen[0].finalist
    lasts = _lasts(chosen[0])
    lead = f"{_build(chosen[0])} {_worth_building(study, chosen[0], lasts)}"
    judged = None
    if ranking is not None:
        row = next(row for row in ranking["designs"] if row["given"] == 1)
        question = f"Landing: place known to {ranking['goal_m']:g} m at {ranking['deployment']}"
        judged = landing_answer(question, row, ranking)
        lead += f" {judged.question}: {'met' if judged.holds else 'missed'}, {judged.written}."
    if len(chosen) > 1:
        other = chosen[1].finalist
        lead += f" Its rival is {other.notation}; beside it, this is "
        lead += f"{against(study, first, other, sampled=False)}."
    asked = not chosen[0].verdicts or any(c.figure == "fold_proven" for c in study.constraints)
    everywhere = Answer(
        "Not asked for: " * (not asked)
        + f"{study.fold} in view above {first.mask_deg:g}°, everywhere",
        chosen[0].certificate,
        chosen[0].certificate == "proven" if asked else None,
        "for all time, two-body motion",
    )
    rows = [*verdict_answers(chosen[0].verdicts), everywhere]
    for o in study.objectives:
        value, how = known(study, o.figure, first), sampling_of(study, o.figure)
        sure = f"sampled over {how}" if how else _exactly(o)
        if isinstance(value.evidence, Bracket):
            sure = f"{value.evidence}, for all time"
        if measure is not None:
            sure += f"; {measure.role} has {with_unit(known(study, o.figure, measure))}"
            if ordered(o, first, measure) is None:
                sure += ", which is not told apart"
        title = MERITS[o.figure].title
        rows.append(Answer(capital(title), with_unit(value), None, sure))
    rows.insert(1 + len(chosen[0].verdicts), lasts)
    if judged is not None:
        rows.append(judged)
    return Section(
        "The answer", (Sentence(lead), Answers("What it is worth", tuple(rows)), carrying)
    )


def _exactly(objective: Objective) -> str:
    """How well a figure that is not sampled is known."""
    proven = MERITS[objective.figure].stage in ("areas", "requirements", "orbits")
    return "proven" if proven else "exact"


def _lasts(one: Entrant) -> Answer:
    """How long it lasts left alone, as the study found it; else as far as a glance goes."""
    days = one.finalist.figures.get("days_proven")
    if days is None or not np.isfinite(days):
        return glance(one.design).answer()
    question = f"{capital(left_words(one.design))} it lasts"
    return Answer(question, with_unit(Value(MERITS["days_proven"].quantity, days)), None, "proven")


def _worth_building(study: Study, one: Entrant, lasts: Answer) -> str:
    """Say what is met, how sure that is, and how long it lasts."""
    words = ""
    if one.verdicts:
        met = sum(verdict.met is True for verdict in one.verdicts)
        words = f"It meets {met} of its {counted(len(one.verdicts), 'requirement')}. "
    fold = f"{study.fold} in view above {one.finalist.mask_deg:g}° everywhere"
    left = f"{left_words(one.design)} it lasts {lasts.written}"
    return f"{words}{fold}: {one.certificate} for all time; {left}."


def _build(one: Entrant) -> str:
    """Say what to build."""
    row, notation = one.finalist.row, one.finalist.notation
    built = f"{counted(row['satellites'], 'satellite')} in {counted(row['planes'], 'plane')}"
    return f"Build {built}: {notation} ({one.design.label})."


def known(study: Study, name: str, one: Finalist | Yardstick) -> Value:
    """A figure of a finalist or the yardstick, with its bounds or what sampling leaves of doubt."""
    evidence: Evidence | None = None
    if name in one.brackets:
        evidence = Bracket(*one.brackets[name])
    elif error := one.errors.get(name, 0.0):
        evidence = Sampled(error, sampling_of(study, name))
    return Value(MERITS[name].quantity, one.figures[name], evidence)


def doubt(one: Finalist | Yardstick, name: str) -> float:
    """By how much another sampling may move a figure, as a bar shows it.

    0 where it is exact, where proven bounds say instead between what it lies, and where no number
    says it.
    """
    error = 0.0 if name in one.brackets else one.errors.get(name, 0.0)
    return error if np.isfinite(error) else 0.0


def with_unit(value: Value) -> str:
    """A value with its unit, for a sentence."""
    return f"{value} {value.quantity.shown_unit}".strip()


def change(a: float, b: float) -> str:
    """How far a is from b in percent, in brackets; nothing where that says nothing."""
    if not (np.isfinite(a) and np.isfinite(b) and b) or a == b:
        return ""
    percent = 100 * (a - b) / abs(b)
    if abs(percent) < 0.05:
        return ""
    written = f"{percent:+.{0 if abs(percent) >= 1 else 1}f}".replace("-", "−")
    return f" ({written} %)"


def moved(objective: Objective, one: Finalist, other: Finalist | Yardstick) -> str:
    """How far one is from another in an objective, in brackets; said where it is not told apart."""
    if ordered(objective, one, other) is None:
        return " (not told apart)"
    return change(one.figures[objective.figure], other.figures[objective.figure])


def against(
    study: Study, one: Finalist, other: Finalist | Yardstick, *, sampled: bool = True
) -> str:
    """How one compares with another, objective by objective, in words.

    What the sampling does not tell apart has no order; `sampled`: say what was sampled, too.
    """
    words = {
        -1: "better in", 1: "worse in", 0: "equal in", None: "not told apart by the sampling in",
        "open": "not told apart by proven bounds in",
        "nan": "not comparable in",
    }  # fmt: skip
    groups: dict[Any, list[str]] = {word: [] for word in words}
    for o in study.objectives:
        a, b = one.figures[o.figure], other.figures[o.figure]
        order: Any = "nan" if np.isnan(a) or np.isnan(b) else ordered(o, one, other)
        text = MERITS[o.figure].title
        if order not in (0, "nan"):
            text += ": " + " against ".join(
                with_unit(known(study, o.figure, each)) for each in (one, other)
            )
            text += change(a, b)
            both = o.figure in one.brackets and o.figure in other.brackets
            order = "open" if order is None and both else order
            if sampled and (how := sampling_of(study, o.figure)):
                how = "between proven bounds" if both else f"sampled over {how}"
                text += f", {how}"
        groups[order].append(text)
    return "; ".join(f"{words[key]} {', '.join(some)}" for key, some in groups.items() if some)


def ordered(
    objective: Objective, one: Finalist, other: Finalist | Yardstick
) -> Literal[-1, 0, 1] | None:
    """Whether one is better (-1), as good or worse (1) in an objective; None: not told apart."""
    name = objective.figure
    a, b = one.figures[name], other.figures[name]
    if a == b:
        return 0
    if np.isfinite(a) and np.isfinite(b):
        doubt = one.errors.get(name, 0.0) + other.errors.get(name, 0.0)
        if not abs(a - b) > doubt:
            return None
    return -1 if objective.sign * a < objective.sign * b else 1


def verdict(study: Study, one: Finalist, other: Finalist | Yardstick) -> str:
    """Whether one beats another in all objectives, loses in all, or is a trade.

    Where the sampling does not tell them apart in one, it is of the others, and said so.
    """
    if any(np.isnan([one.figures[o.figure], other.figures[o.figure]]).any()
           for o in study.objectives):  # fmt: skip
        return "not comparable"
    orders = [ordered(o, one, other) for o in study.objectives]
    told = [order for order in orders if order is not None]
    if len(told) < len(orders):
        if -1 in told and 1 not in told:
            return "beats it where they are told apart"
        if 1 in told and -1 not in told:
            return "loses where they are told apart"
        return "a trade" if 1 in told else "not told apart"
    if 1 not in told:
        return "beats it in all" if -1 in told else "equal"
    return "a trade" if -1 in told else "loses in all"


def _objective_table(study: Study, chosen: Sequence[Entrant], measure: Yardstick | None) -> Table:
    """Finalists by objective, beside the yardstick if there is one."""
    rows = []
    for e in chosen:
        one = e.finalist
        values = [
            f"{known(study, o.figure, one)}{'' if measure is None else moved(o, one, measure)}"
            for o in study.objectives
        ]
        beside = (verdict(study, one, measure),) if measure else ()
        rows.append((e.design.label, one.role, one.notation, *values, *beside))
    title = "The finalists by objective"
    header = [
        "design",
        "best at",
        "constellation",
        *(MERITS[o.figure].quantity.heading for o in study.objectives),
    ]
    if measure is not None:
        own = (str(known(study, o.figure, measure)) for o in study.objectives)
        rows.append((measure.role, "to compare with", measure.notation, *own, ""))
        title += f", and the change from {measure.role}"
        header.append(f"beside {measure.role}")
    return Table(title, tuple(header), tuple(rows))


def _figure_table(study: Study, chosen: Sequence[Entrant], measure: Yardstick | None) -> Table:
    """Every figure of merit of the finalists and the yardstick."""
    columns: list[Finalist | Yardstick] = [e.finalist for e in chosen]
    columns += [measure] if measure else []
    rows: list[tuple[object, ...]] = [("constellation", *(f.notation for f in columns))]
    rows += [
        (MERITS[name].quantity.heading, *(_cell(study, name, f) for f in columns))
        for name in known_figures(study)
    ]
    rest = ("",) if measure else ()
    rows.append(("certificate of the fold", *(e.certificate for e in chosen), *rest))
    if LAW in study.named:
        title = "the same simulated under all forces for a year, m/s/year"
        rows.append((title, *(simulated_keeping(e) for e in chosen), *rest))
    names = [*(e.design.label for e in chosen), *([measure.role] if measure else [])]
    return Table("Every figure of the finalists", ("figure of merit", *names), tuple(rows))


def _cell(study: Study, name: str, one: Finalist | Yardstick) -> object:
    """A figure for a table, a dash where there is none."""
    return "–" if np.isnan(one.figures[name]) else known(study, name, one)


def simulated_keeping(entrant: Entrant) -> object:
    """What keeping the satellite that needs most costs, simulated, where the law says it must be.

    The law is of the mean push; the simulation meets it as it is, with Sun, moons and sunlight.
    """
    if entrant.finalist.figures[LAW] == 0.0:
        return "none needed"
    try:
        return number(keep(entrant.design).to_dict()[LAW])
    except ArgumentError as error:
        return str(error)


def number(value: float) -> object:
    """A number for a table, a dash for none."""
    return "–" if np.isnan(value) else float(value)


def rank_finalists(
    study: Study, chosen: Sequence[Entrant], progress: Callable[[str], None]
) -> tuple[Ranking, list[Design]] | None:
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
        goal=study.entry.goal,
        density_sigma=study.entry.density_sigma,
        lift_sigma=study.entry.lift_sigma,
        doubts=study.entry.doubts,
        sites=study.entry.sites,
        regions=study.entry.regions,
        finalists=len(designs) if runs else 0,
        runs=max(runs, 1),
        threads=cores(),
        progress=told,
    )
    return ranking, designs


def landing_sections(
    study: Study,
    ranking: Ranking,
    designs: Sequence[Design],
    progress: Callable[[str], None],
) -> list[Section]:
    """Sections on the finalists' landers and on users on the surface."""
    assert study.entry is not None
    landing = judge_section(
        ranking, designs, study.entry.scenario, threads=cores(), progress=progress
    )
    return [landing, surface_section(ranking.record)]


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
    return arranged("Hand-over", (text,), (), (table,))
