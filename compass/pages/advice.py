"""The first section of a design's page: what to do, the answers, the picture that carries them."""

from collections.abc import Sequence

import numpy as np

from compass.allowed import RANGES
from compass.api.check import CheckResult
from compass.api.map_errors import rest_of
from compass.coverage.cap import cap_radius
from compass.coverage.certificate import Outcome
from compass.coverage.certified_percentile import GREATEST
from compass.design import Design
from compass.document import Answers, Bracket, Proven, Section, Sentence, Value
from compass.document.blocks import Block
from compass.document.evidence import Between
from compass.document.numbers import significant
from compass.orbits.symmetry import one_circle
from compass.pages.answers import ANSWERS, ENOUGH, LOCATE, known_value, leads_aloft, place_errors
from compass.pages.design_results import DesignResults
from compass.pages.lasting import lasting_advice, lasting_sentence
from compass.pages.neighbours import Neighbour
from compass.quantities import quantity
from compass.signal.budget import basis
from compass.words import listed


def answer_section(
    results: DesignResults, carrying: Sequence[Block], neighbours: Sequence[Neighbour]
) -> Section:
    """The answers, the picture that carries them, and what to do."""
    rows = tuple(row for question in ANSWERS for row in question(results))
    advice = Sentence(what_to_do(results, neighbours))
    return Section("The answer", (advice, Answers("Met, and how sure", rows), *carrying))


def accurate(results: DesignResults) -> str:
    """How accurate a fix is, in a sentence."""
    if results.design.constellation.size < ENOUGH:
        return f"A fix from ranges of one moment takes four satellites in view: see {LOCATE}."
    mapped = results.aloft[0] if leads_aloft(results) else results.mapped
    numbers, errors = mapped.numbers(), place_errors(mapped)
    who = f"A user anywhere{mapped.users}," if mapped.users else "A rover anywhere"
    if errors and not np.isfinite(numbers["rover_horizontal_m"]):
        part = quantity("part_share")
        none = mapped.value(part, rest_of("fix_share", numbers), "fix_share")
        few = mapped.value(part, numbers, "fewer_than_four_share")
        return (
            f"{who.replace(' anywhere', '', 1)} has no fix in {none} % of area and time: in {few} "
            f"% fewer than four satellites are in view ({few.evidence})."
        )
    if errors:
        return (
            f"{who} knows its place within {errors[0].written} horizontally: 95 % of its fixes, in "
            f"95 % of area and time, with {basis(results.design)}."
        )
    for key, share in (("p95", "95 %"), ("p50", "half")):
        value = known_value(mapped, "gdop", numbers["gdop"], key)
        known = value.evidence
        if isinstance(known, Between):
            value = Value(value.quantity, known.high, Proven())  # rounded to its own side
        if value.value is not None and np.isfinite(value.value):
            proven = isinstance(known, Bracket)
            chance = "" if proven else f" ({known})"
            return (
                f"GDOP is {'proven ' if proven else ''}below {value} in {share} of area and time"
                f"{mapped.users}{chance}: a fix, place and time, errs less than so many times the "
                "error of a range."
            )
    if numbers["gdop"].get("p50_bracket", (0.0,))[0] >= GREATEST:
        return f"In more than half of area and time{mapped.users} ranges of one moment give no fix."
    return f"In more than half of area and time{mapped.users} no bound of GDOP is known."


def _of_requirements(checked: CheckResult, real: str) -> str:
    """What to do about a design that is asked for something of its own."""
    missed = [v.requirement.name for v in checked.verdicts if v.met is False]
    open_ = [v.requirement.name for v in checked.verdicts if v.met is None]
    count = len(checked.verdicts)
    if missed:
        named = listed([f"“{name}”" for name in missed])
        which = f"its requirement {named}" if count == 1 else f"{named} of its {count} requirements"
        remedy = ""
        if not checked.design.others:  # a search has the requirements of one file
            line = search_line(checked.design, f"--require {checked.design.typed}")
            remedy = f"What meets {'it' if count == 1 else 'all'} is found by {line}."
        return _told(f"Do not build it as it is: it misses {which}.", remedy)
    if open_:
        named = listed([f"“{name}”" for name in open_])
        return f"Decide after a finer look: {named} cannot be told yet. {real}"
    certain = all(v.evidence in ("proven", "bracket") for v in checked.verdicts)
    said = (
        f"it meets {'its requirement' if count == 1 else f'all of its {count} requirements'}, "
        f"{'proven' if certain else 'as far as was sampled'}"
    )
    return f"Build it as it is: {said}." if not real else f"On undisturbed orbits {said}. {real}"


def search_line(design: Design, wanted: str) -> str:
    """The command line that finds the smallest that has what is `wanted`.

    At the design's own radius, where its orbits are circles of one, else at the areosynchronous.
    """
    axes = design.constellation.semi_major_axis / 1e3
    own = axes.size and one_circle(design.constellation)
    orbit = f"--radius-km {axes[0]:.6g}" if own else "--orbit areosynchronous"
    most = RANGES["max_satellites"].most  # sizes are tried one after the other, up to the first
    return f"compass search {wanted} {orbit} --max-satellites {most:g}"


def what_to_do(results: DesignResults, neighbours: Sequence[Neighbour]) -> str:
    """Recommend; say how long it lasts and how accurate it is, its rival, what would change it."""
    result, outlook = results.fold, results.outlook
    wanted = f"{result.fold}-fold coverage above {result.mask_deg:g}°"
    missed = result.outcome is Outcome.REFUTED
    if results.checked is not None:
        missed = any(verdict.met is False for verdict in results.checked.verdicts)
    # what has it from the first is told how to keep it; all else how long it has it
    keeping = "" if missed or outlook is None else lasting_advice(results.design, outlook)
    lasts = "" if keeping or outlook is None else lasting_sentence(results.design, outlook)
    fix = accurate(results)
    if results.checked is not None:
        fix = fix.replace("GDOP is", "Over all of Mars GDOP is")
        return _told(_of_requirements(results.checked, keeping), lasts, fix)
    when = result.scope.split(",")[0]
    words = {
        Outcome.PROVEN: f"Build it as it is: it has {wanted}, proven {when}."
        if not keeping
        else f"It has {wanted}, proven {when} on undisturbed orbits. {keeping}",
        Outcome.REFUTED: f"Do not build it for {wanted}: there is a place and a moment without.",
    }.get(result.outcome, f"Decide after a finer look: {wanted} is neither proven nor refuted.")
    others = (*_rivals(results, neighbours), *_of_losses(results))
    return _told(words, _of_stations(results), lasts, fix, *others)


def _of_stations(results: DesignResults) -> str:
    """At which stations it is missed, in a sentence; nothing where it is missed at none."""
    missed = [f"“{one.name}”" for one in results.stations if one.fold.met is False]
    if not missed:
        return ""
    return f"Above the horizon of {listed(missed)} it has less: not always {results.fold.fold}."


def _told(*sentences: str) -> str:
    return " ".join(sentence for sentence in sentences if sentence)


def _rivals(results: DesignResults, neighbours: Sequence[Neighbour]) -> list[str]:
    """What to build in its place, or what is as large and how it compares."""
    result = results.fold
    margin = result.mask_margin_deg
    here = -np.inf if margin is None else margin
    best = max(neighbours, key=lambda n: n.mask_deg, default=None)
    there = f"a mask up to {significant(best.mask_deg, 3)}°" if best else ""
    if here < result.mask_deg:  # of a miss there is no room to speak of
        if best and best.mask_deg >= result.mask_deg:
            return [f"Build {best.notation} in its place: as many satellites, with {there}."]
        others = "No other phasing or inclination of as many satellites has it." if best else ""
        line = search_line(results.design, f"--fold {result.fold} --mask-deg {result.mask_deg:g}")
        return [others, f"How many it takes{_at_least(results)} is found by {line}."]
    sure = result.margins().rows[3][1]  # rounded to the safe side, as the table has it
    said = [f"A mask above {sure}° would change this."]
    if best:
        said.insert(
            0,
            f"Its rival of the same size: {best.notation}, with {there} instead of {sure}°."
            if best.mask_deg > here + 0.1
            else "No other phasing or inclination of as many satellites has more margin.",
        )
    return said


def _at_least(results: DesignResults) -> str:
    """How many satellites it takes at its radius whatever their pattern, by the area of caps."""
    c, result = results.design.constellation, results.fold
    if not (c.size and one_circle(c)):
        return ""
    sphere, mask = results.design.figure.equatorial_radius, np.radians(result.mask_deg)
    seen = 0.5 * (1.0 - np.cos(cap_radius(float(c.semi_major_axis[0]), sphere, float(mask))))
    return f", {int(np.ceil(result.fold / seen - 1e-9))} or more by the area that each sees,"


def _of_losses(results: DesignResults) -> list[str]:
    """That the loss of one satellite would change the advice, if it would."""
    result, size = results.fold, results.design.constellation.size
    margin = result.mask_margin_deg
    if margin is None or margin < result.mask_deg or not result.coverage.losses:
        return []
    least = min(sets.least[0] for sets in result.coverage.losses[0])
    if size == 1 or not least < result.fold <= size:
        return []
    return [f"So would the loss of one satellite: then {least} in view is all that is sure."]
