"""The first lines of a design's page: what is met, how sure that is, and what to do.

Further answers join `ANSWERS` in the order of the page: a function from `DesignResults` to rows.
"""

import shlex
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from compass.allowed import RANGES
from compass.api.check import CheckResult
from compass.api.map_statistics import ROVER
from compass.coverage.certificate import Outcome
from compass.coverage.certified_percentile import GREATEST
from compass.coverage.site import site_coverage
from compass.coverage.verdict import Verdict
from compass.design import Design
from compass.document import Answer, Answers, Bracket, Proven, Section, Sentence, Value
from compass.document.blocks import Block
from compass.document.numbers import significant
from compass.orbits.symmetry import one_circle
from compass.pages.design_results import DesignResults
from compass.pages.lasting import lasting_advice, lasting_answers, lasting_promise
from compass.pages.neighbours import Neighbour
from compass.quantities import quantity
from compass.signal.budget import basis
from compass.study.choice import notation
from compass.words import counted

#: Satellites that ranges of one moment take for a fix, and who fixes with fewer.
ENOUGH, LOCATE = 4, "compass locate, which gathers them over hours"


def requirements(results: DesignResults) -> list[Answer]:
    """Each requirement of the design: met or missed, by how much, and how sure."""
    return [] if results.checked is None else verdict_answers(results.checked.verdicts)


def verdict_answers(verdicts: Iterable[Verdict]) -> list[Answer]:
    """Requirements and their verdicts, an answer each."""
    rows = []
    for verdict in verdicts:
        asked, share, margin = verdict.requirement, verdict.share, verdict.margin
        how = ""
        if share is not None:
            value = Value(quantity("requirement_share"), share[0], Bracket(*share))
            how = f"{value} % of {'the time' if asked.share_of == 'time' else 'area and time'}"
        elif margin is not None:
            how = f"{significant(float(np.degrees(margin)), 3)}° to spare"
        sure = ", ".join(text for text in (verdict.sure, verdict.reason, verdict.scope) if text)
        question = f"{asked.name}: {asked.wanted}, {asked.when}"
        rows.append(Answer(question, how or verdict.word, verdict.met, sure))
    return rows


def flown(design: Design) -> str:
    """What is to be built: satellites, planes, inclination, orbit."""
    c, pattern = design.constellation, design.constellation.pattern
    size = counted(c.size, "satellite")
    if design.motion.table is not None:
        return f"{size} on given paths"
    if pattern is not None:
        return f"{size} in {counted(pattern.planes, 'plane')}: {notation(c)}"
    shape = f", eccentricity {_span(c.eccentricity, '')}" if c.eccentricity.any() else ""
    return (
        f"{size}, semi-major axis {_span(c.semi_major_axis / 1e3, ' km')}{shape}, inclination "
        f"{_span(np.degrees(c.inclination), '°')}"
    )


def _span(values: np.ndarray, unit: str) -> str:
    """Write a number that all have, or the least and the largest."""
    least, most = (significant(float(v), 5) for v in (values.min(), values.max()))
    return f"{least}{unit}" if least == most else f"{least} to {most}{unit}"


def subtitle(design: Design) -> str:
    """What flies and where that comes from, to stand under the title of a page."""
    return f"{flown(design)}. {' '.join(design.source.split()) or 'No source given.'}"


def coverage(results: DesignResults) -> list[Answer]:
    """Whether the fold wanted is there, everywhere and always, and by how much."""
    result = results.fold
    claim = f"{result.fold} in view above {result.mask_deg:g}°, everywhere"
    holds = {Outcome.PROVEN: True, Outcome.REFUTED: False}.get(result.outcome)
    if results.checked:
        holds, claim = None, f"Not asked for: {claim}"
    rows = [Answer(claim, str(result.outcome), holds, result.scope)]
    margin = result.margins().rows[3][1]
    assert isinstance(margin, Value)
    known = result.mask_margin_deg
    if known is not None and known >= result.mask_deg:
        rows.append(Answer("The mask may rise to", margin))
    elif known is not None and known >= 0.0:
        rows.append(Answer("It would take a mask of", margin))
    else:
        rows.append(Answer("It would take a mask", "below the horizon: none has it"))
    return rows


def tightest(results: DesignResults) -> list[Answer]:
    """Where and when the least is to spare."""
    place = results.fold.to_dict()["worst"]
    if not place:
        return []
    said = (
        f"{latitude_words(place['latitude_deg'])}, "
        f"{significant(place['longitude_deg'] % 360, 4)}° E, "
        f"{moment_words(place['time_s'])} after the epoch"
    )
    alike = "by symmetry one of several" if results.design.constellation.pattern else ""
    return [Answer("Tightest place and moment", said, evidence=alike)]


def moment_words(seconds: float) -> str:
    """Write a time in the unit that a reader would take."""
    for unit, size in (("h", 3600.0), ("min", 60.0)):
        if abs(seconds) >= size:
            return f"{significant(seconds / size, 3)} {unit}"
    return f"{significant(seconds, 3)} s"


def latitude_words(latitude_deg: float) -> str:
    """Write a latitude north or south."""
    if abs(latitude_deg) < 0.005:
        return "the equator"
    side = "N" if latitude_deg >= 0 else "S"
    return f"{significant(abs(latitude_deg), 3)}° {side}"


def geometry(results: DesignResults) -> list[Answer]:
    """How good the geometry is over all area and time."""
    if results.design.constellation.size < ENOUGH:
        few = "never: it takes four satellites in view"
        return [Answer("A fix from ranges of one moment", few, None, f"see {LOCATE}")]
    numbers, within = results.mapped.numbers(), results.mapped.dataset.attrs["pdop_threshold"]
    gdop = numbers["gdop"]
    return [
        *_errors(results, numbers),
        Answer("GDOP, 95 % below", *_dilution(results, gdop, "p95")),
        Answer("GDOP, half of area and time below", *_dilution(results, gdop, "p50")),
        Answer(
            f"Area and time with PDOP {within:g} or less",
            _known(results, "availability", numbers, "availability"),
        ),
    ]


def _dilution(
    results: DesignResults, gdop: dict[str, Any], key: str
) -> tuple[Value | str, None, str]:
    """A percentile of GDOP as an answer; in words where so much of area and time has no fix."""
    value = _known(results, "gdop", gdop, key)
    known = value.evidence
    least = known.low if isinstance(known, Bracket) else gdop[key]
    fixed = least is not None and least < GREATEST  # no percentile is looked for beyond
    return (value if fixed else "no fix in so much of it", None, str(known or ""))


def _known(results: DesignResults, name: str, of: dict[str, Any], key: str) -> Value:
    """A figure of the map with its proven bounds, or with what it was sampled on."""
    mapped = results.mapped
    scope = mapped.certified.scope.split(";")[0] if mapped.certified else ""
    return Value(quantity(name), of[key], Bracket.beside(of, key, scope) or mapped.looked)


def accurate(results: DesignResults) -> str:
    """How accurate a fix is, in a sentence."""
    if results.design.constellation.size < ENOUGH:
        return f"A fix from ranges of one moment takes four satellites in view: see {LOCATE}."
    numbers = results.mapped.numbers()
    errors = _errors(results, numbers)
    if errors and not np.isfinite(numbers["rover_horizontal_m"]):
        none, few = 1.0 - numbers["fix_share"], numbers["fewer_than_four_share"]
        return (
            f"A rover has no fix in {significant(100.0 * none, 3)} % of area and time: in "
            f"{significant(100.0 * few, 3)} % it sees fewer than four satellites."
        )
    if errors:
        return (
            f"A rover anywhere knows its place within {errors[0].written} horizontally: 95 % of "
            f"its fixes, in 95 % of area and time, with {basis(results.design)}."
        )
    for key, share in (("p95", "95 %"), ("p50", "half")):
        value = _known(results, "gdop", numbers["gdop"], key)
        if isinstance(value.evidence, Bracket):
            value = Value(value.quantity, value.evidence.high, Proven())
        if value.value is not None and np.isfinite(value.value):
            return f"GDOP is below {value} in {share} of area and time."
    if numbers["gdop"].get("p50_bracket", (0.0,))[0] >= GREATEST:
        return "In more than half of area and time ranges of one moment give no fix."
    return "In more than half of area and time no bound of GDOP is known."


def _errors(results: DesignResults, numbers: dict[str, Any]) -> list[Answer]:
    """What a rover anywhere knows of its place, where the design says what a range is worth."""
    if results.design.signal is None:
        return []
    rows = []
    for name, most in ROVER.items():
        value = results.mapped.value(quantity(most), numbers, most)
        said = f"A rover anywhere: {name.split('_')[1]}, 95 % of fixes, 95 % of area and time"
        evidence = f"{value.evidence}; with {basis(results.design)}"
        fixed = np.isfinite(numbers[most])
        rows.append(Answer(said, value if fixed else "no fix in so much of it", evidence=evidence))
    return rows


def stations(results: DesignResults) -> list[Answer]:
    """The station that is worst off."""
    sites, times = results.design.stations, results.mapped.made.view.times
    if not sites:
        return []
    counts = {
        site.name: site_coverage(
            results.design.constellation, site, times, results.design.motion
        )["count"].values
        for site in sites
    }  # fmt: skip
    worst = min(counts, key=lambda name: (counts[name].min(), counts[name].mean()))
    least, wanted = int(counts[worst].min()), results.design.fold
    return [
        Answer(
            f"Worst of {len(sites)} stations: {worst}" if len(sites) > 1 else f"Station {worst}",
            f"sees {least} at least, {wanted} wanted",
            least >= wanted,
            f"sampled, {times.size} epochs",
        )
    ]


def losses(results: DesignResults) -> list[Answer]:
    """What is left when one satellite fails."""
    if not results.fold.coverage.losses:
        return []
    least = min(sets.least for sets in results.fold.coverage.losses[0])
    scope = results.fold.scope
    evidence = Proven(scope) if least[0] == least[1] else Bracket(*least, scope)
    left = Value(quantity("min_fold"), least[0], evidence)
    return [Answer("After any one loss, in view at least", left)]


def lasting(results: DesignResults) -> list[Answer]:
    """How long it lasts left alone, what keeping costs, which radius does without."""
    if results.outlook is None:
        return []
    return lasting_answers(results.design, results.outlook)


#: In the order of the page.
ANSWERS: tuple[Callable[[DesignResults], list[Answer]], ...] = (
    requirements,
    coverage,
    lasting,
    geometry,
    tightest,
    stations,
    losses,
)


def answer_section(
    results: DesignResults, carrying: Sequence[Block], neighbours: Sequence[Neighbour]
) -> Section:
    """The answers, the picture that carries them, and what to do."""
    rows = tuple(row for question in ANSWERS for row in question(results))
    advice = (Sentence(words) for words in what_to_do(results, neighbours))
    return Section("The answer", (*advice, Answers("Met, and how sure", rows), *carrying))


def _of_requirements(checked: CheckResult, real: str) -> str:
    """What to do about a design that is asked for something of its own."""
    missed = [v.requirement.name for v in checked.verdicts if v.met is False]
    open_ = [v.requirement.name for v in checked.verdicts if v.met is None]
    count = len(checked.verdicts)
    if missed:
        listed = ", ".join(f"“{name}”" for name in missed)
        which = (
            f"its requirement {listed}" if count == 1 else f"{listed} of its {count} requirements"
        )
        line = search_line(checked.design, f"--require {shlex.quote(checked.design.label)}")
        remedy = f"What meets {'it' if count == 1 else 'all'} is found by {line}."
        return " ".join(
            part for part in (f"Do not build it as it is: it misses {which}.", remedy, real) if part
        )
    if open_:
        listed = ", ".join(f"“{name}”" for name in open_)
        return f"Decide after a finer look: {listed} cannot be told yet. {real}"
    said = f"it meets {'its requirement' if count == 1 else f'all of its {count} requirements'}"
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


def what_to_do(results: DesignResults, neighbours: Sequence[Neighbour]) -> list[str]:
    """Recommend in a sentence; name the rival, and what would change the advice."""
    result, c = results.fold, results.design.constellation
    wanted = f"{result.fold}-fold coverage above {result.mask_deg:g}°"
    real = lasting_advice(results.design, results.outlook) if results.outlook else ""
    if results.checked is not None:
        fix = accurate(results).replace("GDOP is below", "Over all of Mars GDOP is below")
        return [f"{_of_requirements(results.checked, real)} {fix}".strip()]
    when = result.scope.split(",")[0]
    words = {
        Outcome.PROVEN: f"Build it as it is: it has {wanted}, proven {when}."
        if not real
        else f"It has {wanted}, proven {when} on undisturbed orbits. {real}",
        Outcome.REFUTED: f"Do not build it for {wanted}: there is a place and a moment without.",
    }.get(result.outcome, f"Decide after a finer look: {wanted} is neither proven nor refuted.")
    said = [words]
    if result.outcome is Outcome.PROVEN:
        lasts = lasting_promise(results.design, results.outlook)
        said = [part for part in (words, lasts, accurate(results)) if part]
    margin = result.mask_margin_deg
    here = -np.inf if margin is None else margin
    sure = result.margins().rows[3][1]  # rounded to the safe side, as the table has it
    room = here >= result.mask_deg  # of a miss there is none to speak of
    best = max(neighbours, key=lambda n: n.mask_deg, default=None)
    there = f"a mask up to {significant(best.mask_deg, 3)}°" if best else ""
    if room and best:
        said.append(
            f"Its rival of the same size: {best.notation}, with {there} instead of {sure}°."
            if best.mask_deg > here + 0.1
            else "No other phasing or inclination of as many satellites has more margin."
        )
    elif best and best.mask_deg >= result.mask_deg:
        said.append(f"Build {best.notation} in its place: as many satellites, with {there}.")
    elif not room:
        others = "No other phasing or inclination of as many satellites has it. " if best else ""
        wanted = f"--fold {result.fold} --mask-deg {result.mask_deg:g}"
        line = search_line(results.design, wanted)
        said.append(f"{others}How many it takes is found by {line}.")
    if room:
        said.append(f"A mask above {sure}° would change this.")
    if room and result.coverage.losses and c.size > 1:
        least = min(sets.least[0] for sets in result.coverage.losses[0])
        if least < result.fold <= c.size:
            said.append(
                f"So would the loss of one satellite: then {least} in view is all that is sure."
            )
    return [" ".join(said)]
