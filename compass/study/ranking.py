"""Designs judged on the same entries, and ranked."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from compass.allowed import check_all_allowed
from compass.coverage.areas import AreaFigures
from compass.coverage.certified_effort import Effort
from compass.design import Design
from compass.document import Interval
from compass.document.numbers import significant
from compass.entry.campaign import Campaign
from compass.entry.dispersed import beyond_words
from compass.entry.doubts import NO_DOUBTS, Doubts
from compass.entry.guidance import Dispersion
from compass.entry.schedule import Measurements
from compass.errors import ArgumentError, said_of
from compass.inputs.scenario import Scenario
from compass.quantities.draws import percentiles
from compass.quantities.percentile import percentile
from compass.sites import Site
from compass.study.certified import certified_areas
from compass.study.judge import (
    air_not_known,
    campaign_of,
    check_lander,
    doubts_of,
    ground_of,
    judge_entries,
)
from compass.study.judge_filter import NOT_RUN, judge_filter
from compass.study.judge_surface import judge_surface
from compass.study.judge_worst import worst_entry
from compass.study.judgement import Judgement
from compass.study.mapping import MapOptions
from compass.words import place_words


@dataclass(frozen=True)
class Ranking:
    """Designs ranked for a lander.

    Attributes
    ----------
    record
        Plain values with units in their names, the best design first.
    judgements
        What they come from, in the same order.
    areas
        What users have at the sites and in the regions that were named, likewise.
    """

    record: dict[str, Any]
    judgements: tuple[Judgement, ...]
    areas: tuple[tuple[AreaFigures, ...], ...] = ()


def rank_designs(
    designs: Sequence[Design],
    scenario: Scenario,
    *,
    samples: int = 1024,
    seed: int = 0,
    goal: float = 10.0,
    density_sigma: float = 0.0,
    lift_sigma: float = 0.0,
    doubts: Doubts = NO_DOUBTS,
    finalists: int = 3,
    runs: int = 512,
    sites: Sequence[Site] = (),
    regions: Sequence[str] = (),
    threads: int = 1,
    progress: Callable[..., Iterable[Any]] = lambda items, **_: items,
) -> Ranking:
    """Judge every design, best first; run the filter on the finalists.

    Ranked by the 95th percentile of the bound of position at deployment, then by the number of
    satellites.

    Parameters
    ----------
    designs
        Candidates, each with its own figure, mask and fold.
    scenario
        The lander.
    samples, seed
        As in `compass.study.judge.campaign_of`.
    goal
        Position sigma wanted at deployment, metres.
    density_sigma, lift_sigma
        As in `compass.entry.campaign.fly_campaign`.
    doubts
        What the lander does not know of clocks, orbits and biases.
    finalists, runs
        On how many of the best to run the filter, and how often for each.
    sites, regions
        Where the landers deploy, by turns; anywhere without any. For users there each design is
        asked too (`compass.coverage.areas.area_figures`).
    threads
        Threads; the numbers do not depend on them.
    progress
        Wraps designs in work, called with ``total`` and ``desc``, as tqdm is.

    Raises
    ------
    ArgumentError
        No design, or an option out of range.
    """
    if not designs:
        raise ArgumentError("designs: none given; name at least one design file")
    check_all_allowed(goal_m=goal, finalists=finalists, runs=runs)
    check_lander(scenario, samples, seed)
    ground = ground_of(sites, regions)
    density_sigma, lift_sigma = air_not_known(scenario, density_sigma, lift_sigma)
    doubts = doubts_of(scenario, doubts)
    air: dict[str, Any] = {"density_sigma": density_sigma, "lift_sigma": lift_sigma}
    campaign = campaign_of(scenario, samples, seed, ground=ground, **air)
    effort = Effort(workers=threads)
    rows: list[dict[str, Any]] = []
    kept: list[Judgement] = []
    areas: list[tuple[AreaFigures, ...]] = []
    for design in progress(designs, total=len(designs), desc="designs"):
        with said_of(design.label):
            place: dict[str, Any] = {"figure": design.figure, "mask": design.mask}
            c, unknowns = design.constellation, doubts.of(design.signal, design.constellation.size)
            place["unknowns"] = unknowns
            found = judge_entries(c, campaign, scenario, threads=threads, **place)
            kept.append(found)
            areas.append(certified_areas(design, MapOptions(), sites, regions, effort))
            judged = found.figures(goal)
            worst = worst_entry(
                c, scenario, campaign, seed=seed, start=found, lost=found.worst_loss, **place
            )
            if "after_loss" in worst:
                judged["after_loss"]["worst_found"] = worst.pop("after_loss")
            judged["worst_found"] = worst
            rows.append(
                {
                    "design": design.name,
                    "file": design.label,
                    "given": len(rows) + 1,
                    "satellites": design.constellation.size,
                    **judged,
                    "budget_m": found.budget(),
                    "answer": answer(judged, goal),
                    **NOT_RUN,
                    "surface": judge_surface(
                        c, fold=design.fold, figure=design.figure, mask=design.mask
                    ),
                    "areas": [one.as_dict() for one in areas[-1]],
                }
            )
    order = sorted(
        range(len(rows)),
        key=lambda k: (rows[k]["crlb_position_m"]["p95"], rows[k]["satellites"]),
    )
    for k in progress(order[:finalists], total=min(finalists, len(order)), desc="filter"):
        design = designs[k]
        with said_of(design.label):
            rows[k].update(
                judge_filter(
                    design.constellation,
                    scenario,
                    samples=samples,
                    runs=runs,
                    seed=seed,
                    figure=design.figure,
                    mask=design.mask,
                    unknowns=doubts.of(design.signal, design.constellation.size),
                    ground=ground,
                    threads=threads,
                    **air,
                )
            )
        rows[k]["answer"] = believed_answer(rows[k], goal)
    record = {
        "scenario": scenario.name,
        "deployment": campaign.deployment,
        "samples": samples,
        "seed": seed,
        "goal_m": goal,
        "ground": [] if ground is None else list(ground.names),
        **air,
        "doubts": asdict(doubts),
        "counted": doubts.sentence([d.name for d in designs if d.signal is not None])
        + measured_words(scenario.measurements)
        + dispersed_words(scenario.dispersion)
        + guided_words(campaign),
        "guided": guided_facts(campaign),
        "designs": [{"rank": rank + 1, **rows[k]} for rank, k in enumerate(order)],
    }
    return Ranking(record, tuple(kept[k] for k in order), tuple(areas[k] for k in order))


def ground_words(record: dict[str, Any]) -> str:
    """Say where landers come down in words that follow a comma: at named places, or anywhere."""
    return f"at {', '.join(record['ground'])}" if record["ground"] else "anywhere"


def measured_words(measurements: Measurements) -> str:
    """Say what is measured beside ranges and rates one way of one noise; nothing if nothing is."""
    words = ""
    if measurements.link is not None:
        words += " Ranges have the noise of the link; a satellite too faint for it is not in view."
    if measurements.instruments:
        named = ", ".join(one.title for one in measurements.instruments)
        words += f" Measured beside one-way radio: {named}."
    if measurements.features.names:
        words += " Features lie about every entry as they do about the scenario's own."
    return words


def dispersed_words(dispersion: Dispersion | None) -> str:
    """Say how far the entries are from the planned one; nothing if they are not."""
    if dispersion is None:
        return ""
    return (
        f" Entries differ from the planned one by {dispersion.position:g} m and "
        f"{dispersion.velocity:g} m/s on each axis, {100 * dispersion.density:g} % of density and "
        f"{dispersion.lift:g} of L/D (1 sigma)."
    )


def guided_facts(campaign: Campaign) -> dict[str, Any] | None:
    """How far from their targets entries deploy that are guided by their true state, or None."""
    if not campaign.misses.size:
        return None
    return {"miss_m": percentiles(campaign.misses), "beyond_m": campaign.beyond}


def guided_words(campaign: Campaign) -> str:
    """The same in words; nothing unguided."""
    if not campaign.misses.size:
        return ""
    half, most = (significant(float(percentile(campaign.misses, q)) / 1e3, 3) for q in (50, 95))
    return (
        f" They are guided by their true state, half to within {half} km of their targets, 95 % "
        f"within {most} km.{beyond_words(campaign.beyond)} Where the filter is run it guides them "
        "too, by what it knows of state and air, which may bring them nearer or less near."
    )


def answer(figures: dict[str, Any], goal: float) -> str:
    """Say whether the bound stays within the goal in every entry, and if not, where not."""
    text = _answer(figures, goal)
    lost = figures.get("after_loss", {})
    if "worst_found" in lost:
        text += f". After the loss of {lost['satellite']}: {_answer(lost, goal)}"
    return text


def believed_answer(figures: dict[str, Any], goal: float) -> str:
    """The answer where the filter was run: an inconsistent one makes no claim."""
    said = answer(figures, goal)
    if figures["believed"]:
        return said
    size = f"{figures['errors_over_claim']:.3g} times what it says (NEES {figures['nees']:.4g})"
    if figures["diverged"]:
        size = f"{size}, {figures['diverged']} of {figures['runs']} runs diverged"
    return f"no claim: the filter is inconsistent, its errors {size}; of the bound alone: {said}"


def _answer(figures: dict[str, Any], goal: float) -> str:
    worst = figures["worst_found"]
    where = (
        f"{worst['value']:.2f} m at "
        f"{place_words(worst['latitude_deg'], worst['longitude_deg'], '.1f')}, azimuth "
        f"{worst['azimuth_deg']:.0f} deg, entry {worst['epoch_s'] / 3600:.2f} h after "
        f"the epoch, {worst['in_view']} in view at least"
    )
    missed = 100 * (1 - figures["share_within_goal"])
    if worst["value"] <= goal:
        return f"yes; the worst that a search finds is {where}"
    if missed > 0:
        between = ""
        if known := Interval.beside(figures, "share_within_goal"):
            low, high = (significant(100 * (1 - end), 3) for end in (known.high, known.low))
            between = f" ({low} to {high})"
        return f"no: beyond it in {missed:.3g}{between} % of entries; worst {where}"
    return f"not quite: in all entries judged, but a search finds {where}"


def judge_more(
    ranking: Ranking,
    designs: Sequence[Design],
    scenario: Scenario,
    *,
    best: int,
    times: int,
    threads: int = 1,
) -> list[list[Judgement]]:
    """Judge the best of a ranking on further entries, drawn with the seeds that follow.

    Parameters
    ----------
    ranking, designs, scenario
        Who was ranked, in the order given, for which lander.
    best
        How many of the best.
    times
        How often its number of entries, the ranking's own included.
    threads
        Threads; the numbers do not depend on them.

    Returns
    -------
    judgements
        Of each of the best, the ranking's own first.
    """
    record, more = ranking.record, [[one] for one in ranking.judgements[:best]]
    for k in range(1, times):
        campaign = ranking.judgements[0].campaign.drawn(record["seed"] + k)
        for own, row in zip(more, record["designs"], strict=False):
            design = designs[row["given"] - 1]
            judged = judge_entries(
                design.constellation,
                campaign,
                scenario,
                figure=design.figure,
                mask=design.mask,
                unknowns=own[0].unknowns,
                threads=threads,
            )
            own.append(judged)
    return more
