"""The page of designs judged: ranked for a lander, their bounds over the globe and as CDFs."""

from collections.abc import Callable, Sequence
from typing import Any

from compass.api.judge import JudgeResult
from compass.api.judge_tables import (
    budget_table,
    delivery_words,
    filter_table,
    not_told_apart,
    ranking_table,
    surface_table,
    unknown_air,
)
from compass.api.outlook import glance
from compass.cores import cores
from compass.design import PDOP_MAX, Design
from compass.document import Answer, Answers, Section, Sentence
from compass.document.blocks import Picture, arranged
from compass.document.numbers import significant
from compass.inputs.scenario import Scenario
from compass.pages.answers import flown
from compass.pages.landing import scenario_provenance
from compass.pages.page import render
from compass.pictures.judge import bound_distributions, bound_map
from compass.study.ranking import Ranking, ground_words, judge_more
from compass.words import capital

#: How many of the best are mapped, and on how many times the ranking's entries.
MAPPED, BATCHES = 4, 4


def judge_report(judge_result: JudgeResult, command: str = "") -> tuple[str, list[Section]]:
    """Make the page (HTML text) and the sections of designs judged, with the command line."""
    ranking, designs, scenario = judge_result.ranking, judge_result.designs, judge_result.scenario
    judged = judge_section(ranking, designs, scenario, threads=cores())
    world, carrying = judged.pictures
    sections = [
        answer_section(ranking.record, designs, carrying),
        arranged(judged.title, judged.paragraphs, (world,), judged.tables),
        surface_section(ranking.record),
    ]
    source, rows = scenario_provenance(scenario, command)
    rows += [(f"SHA-256 of {design.label}", design.digest) for design in designs]
    title = f"Constellations judged: {scenario.name}"
    return render(title, source, sections, rows, scenario.text), sections


def answer_section(record: dict[str, Any], designs: Sequence[Design], carrying: Picture) -> Section:
    """Which design is best, whether a lander on each knows its place, how long the best last."""
    rows, goal = record["designs"], record["goal_m"]
    best = rows[0]
    answers = [landing_answer(str(row["design"]), row, record) for row in rows]
    lasting = [glance(designs[row["given"] - 1]) for row in rows[:MAPPED]]
    rank = f", the best of {len(rows)}" if len(rows) > 1 else ""
    lead = (
        f"{'Met: build' if answers[0].holds else 'Missed; nearest comes'} “{best['design']}” "
        f"({flown(designs[best['given'] - 1])}){rank}. A lander knows its place to "
        f"{significant(best['crlb_position_m']['p95'], 3)} m in 95 % of {record['samples']:,} "
        f"entries, at {record['deployment']}, to {significant(best['worst_found']['value'], 3)} m "
        f"in the worst found; {goal:g} m are wanted"
        f"{_filter_words(best) if best['believed'] else ''}. "
        f"{lasting[0].sentence}"
    )
    if len(rows) > 1:
        ratio = rows[1]["crlb_position_m"]["p95"] / best["crlb_position_m"]["p95"]
        lead += f" Its rival “{rows[1]['design']}” has {significant(ratio, 3)} times as much."
    lead += "".join(f" {capital(words)}." for words in not_told_apart(rows))
    if best["nees"] is not None and not best["believed"]:
        lead += (
            " That is the bound: the filter flown on it is inconsistent, so no accuracy is claimed."
        )
    answers += [seen.answer(row["design"]) for row, seen in zip(rows, lasting, strict=False)]
    title = f"Within {goal:g} m at {record['deployment']}, {ground_words(record)} and at any time?"
    return Section("The answer", (Sentence(lead), Answers(title, tuple(answers)), carrying))


def landing_answer(question: str, row: dict[str, Any], record: dict[str, Any]) -> Answer:
    """Whether a lander knows its place well enough on one design, everywhere and at any time.

    Met if the worst found is within the goal too, and the filter, where it was flown, is believed.
    """
    p95, worst = row["crlb_position_m"]["p95"], row["worst_found"]["value"]
    believed = row["nees"] is None or row["believed"]
    return Answer(
        question,
        f"{significant(p95, 3)} m in 95 %, worst found {significant(worst, 3)} m",
        bool(p95 <= record["goal_m"] and worst <= record["goal_m"] and believed),
        f"bound of {record['samples']:,} entries{_filter_words(row)}",
    )


def _spread(record: dict[str, Any]) -> str:
    """Over what entries are spread."""
    named = ", ".join(record["ground"])
    return f"over deployments at {named}" if named else "over the globe"


def _filter_words(row: dict[str, Any]) -> str:
    """Whether the filter is as good as it says, where it was flown."""
    if row["nees"] is None:
        return ""
    if not row["believed"]:
        return f"; the filter's errors are {row['errors_over_claim']:.3g} times what it claims"
    return "; the filter is consistent" if row["consistent"] else "; the filter is not consistent"


def judge_section(
    ranking: Ranking,
    designs: Sequence[Design],
    scenario: Scenario,
    *,
    threads: int = 1,
    progress: Callable[[str], None] = lambda step: None,
) -> Section:
    """Show designs ranked for a lander: world maps of the best, distributions of all.

    Parameters
    ----------
    ranking
        Of `compass.study.ranking.rank_designs`, of these designs for this scenario.
    designs, scenario
        Who was ranked, for which lander.
    threads
        Threads; the pictures do not depend on them.
    progress
        Told the name of each part before it is made.
    """
    record, judgements = ranking.record, ranking.judgements
    goal, campaign = record["goal_m"], judgements[0].campaign
    progress("bounds over the globe")
    more = judge_more(ranking, designs, scenario, best=MAPPED, times=BATCHES, threads=threads)
    unknown = ", ".join(unknown_air(record))
    paragraphs = (
        f'{campaign.size:,} entries of the lander of "{scenario.name}" to {campaign.deployment}, '
        f"spread evenly {_spread(record)}, all azimuths and the repeat period. For each, the "
        f"posterior Cramer-Rao bound of position and velocity there from {_measured(scenario)} to "
        "every satellite in view, each weighted with the probability that it gets through the "
        f"plasma{'; ' + unknown if unknown else ''}. {record['counted']}",
        *(f"{row['design']}: within {goal:g} m? {row['answer']}." for row in record["designs"]),
        *delivery_words(record["designs"]),
    )
    names = [designs[row["given"] - 1].name for row in record["designs"]]
    pictures = (
        bound_map([(name, own) for name, own in zip(names, more, strict=False)], goal),
        bound_distributions(names, judgements, goal),
    )
    tables = [ranking_table(record["designs"]), budget_table(record["designs"])]
    run = [row for row in record["designs"] if row["nees"] is not None]
    if run:
        tables.append(filter_table(run))
    return arranged("Landing navigation", paragraphs, pictures, tuple(tables))


def _measured(scenario: Scenario) -> str:
    """Say what is measured, and how well."""
    m = scenario.measurements
    kinds = (("ranges", m.range_sigma, "m"), ("range rates", m.rate_sigma, "m/s"))
    return " and ".join(
        f"{name} of one sigma {sigma:g} {unit}" for name, sigma, unit in kinds if sigma is not None
    )


def surface_section(record: dict[str, Any]) -> Section:
    """Show what the ranked designs are worth to users on the surface."""
    text = (
        "Coverage at the design's mask is proven or refuted for all time; the highest mask is the "
        "one up to which that fold holds. Percentiles of GDOP and the share of area and time with "
        f"PDOP at most {PDOP_MAX:g} lie between the bounds shown, for all time."
    )
    return arranged("Users on the surface", (text,), (), (surface_table(record["designs"]),))
