"""The first table of a design's page: what is met, and how sure that is.

Further answers join `ANSWERS` in the order of the page: a function from `DesignResults` to rows.
"""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from compass.api.map_result import MapResult
from compass.api.map_statistics import ROVER
from compass.coverage.certificate import Outcome
from compass.coverage.certified_percentile import GREATEST
from compass.coverage.verdict import Verdict
from compass.design import Design
from compass.document import Answer, Bracket, Proven, Value
from compass.document.evidence import Between
from compass.document.numbers import significant
from compass.pages.design_results import DesignResults
from compass.pages.lasting import lasting_answers
from compass.quantities import quantity
from compass.signal.budget import basis
from compass.study.choice import notation
from compass.words import counted, place_words

#: Satellites that ranges of one moment take for a fix, and who fixes with fewer.
ENOUGH, LOCATE = 4, "compass locate, which gathers them over hours"

#: Said of what has no value, for so much of area and time has no fix, by percentile.
NO_FIX = {
    "p95": "none: over 5 % of it has no fix",
    "p50": "none: over half of it has no fix",
}


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
            how = _spare(margin)
        sure = ", ".join(text for text in (verdict.sure, verdict.reason, verdict.scope) if text)
        question = f"{asked.name}: {asked.wanted}, {asked.when}"
        rows.append(Answer(question, how or verdict.word, verdict.met, sure))
    return rows


def _spare(margin: float) -> str:
    """By how much a horizon may rise, or is too high, radians as degrees."""
    degrees = significant(abs(float(np.degrees(margin))), 3)
    return f"{degrees}° {'to spare' if margin >= 0.0 else 'short'}"


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
        f"{place_words(place['latitude_deg'], place['longitude_deg'])}, "
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


def geometry(results: DesignResults) -> list[Answer]:
    """How good the geometry is over all area and time."""
    if results.design.constellation.size < ENOUGH:
        few = "never: it takes four satellites in view"
        return [Answer("A fix from ranges of one moment", few, None, f"see {LOCATE}")]
    ground, aloft = [results.mapped], list(results.aloft)
    led = aloft + ground if leads_aloft(results) else ground + aloft
    return [
        *(row for one in led for row in place_errors(one)),
        *(row for one in led for row in _dilutions(one, placed=bool(aloft))),
    ]


def _dilutions(mapped: MapResult, *, placed: bool) -> list[Answer]:
    """Dilutions of precision of the users of a map; where they stand, if that is to be told."""
    numbers, within = mapped.numbers(), mapped.dataset.attrs["pdop_threshold"]
    gdop, of = numbers["gdop"], f" {mapped.users[2:] or 'on the ground'}" if placed else ""
    return [
        Answer(f"GDOP{of}, 95 % below", *_dilution(mapped, gdop, "p95")),
        Answer(f"GDOP{of}, half of area and time below", *_dilution(mapped, gdop, "p50")),
        Answer(
            f"Area and time with PDOP{of} {within:g} or less",
            known_value(mapped, "availability", numbers, "availability"),
        ),
    ]


def _dilution(mapped: MapResult, gdop: dict[str, Any], key: str) -> tuple[Value | str, None, str]:
    """A percentile of GDOP as an answer; in words where so much of area and time has no fix."""
    value = known_value(mapped, "gdop", gdop, key)
    known = value.evidence
    least = known.low if isinstance(known, Between) else gdop[key]
    fixed = least is not None and least < GREATEST  # no percentile is looked for beyond
    return (value if fixed else NO_FIX[key], None, str(known or ""))


def known_value(mapped: MapResult, name: str, of: dict[str, Any], key: str) -> Value:
    """A figure of a map with its proven bounds, or with those of what was drawn."""
    scope = mapped.certified.scope.split(";")[0] if mapped.certified else ""
    bracket = Bracket.beside(of, key, scope)
    return (
        Value(quantity(name), of[key], bracket)
        if bracket
        else mapped.value(quantity(name), of, key)
    )


def leads_aloft(results: DesignResults) -> bool:
    """Whether its requirements speak of users above the ground or in beams, and of no others."""
    return bool(results.aloft) and all(
        each.areas and (each.altitude or each.beam is not None)
        for each in results.design.requirements
    )


def place_errors(mapped: MapResult) -> list[Answer]:
    """What those of whom a map is know of their place, where it says what a range is worth."""
    if mapped.design.signal is None:
        return []
    numbers, rows = mapped.numbers(), []
    who = f"A user anywhere{mapped.users}" if mapped.users else "A rover anywhere"
    for name, most in ROVER.items():
        value = mapped.value(quantity(most), numbers, most)
        said = f"{who}: {name.split('_')[1]}, 95 % of fixes, 95 % of area and time"
        evidence = f"{value.evidence}; with {basis(mapped.design)}; {map_command(mapped)}"
        fixed = np.isfinite(numbers[most])
        rows.append(Answer(said, value if fixed else NO_FIX["p95"], evidence=evidence))
    return rows


def map_command(mapped: MapResult) -> str:
    """The command line that tells the same of the same users."""
    attrs = mapped.made.dataset.attrs
    words = ["compass map", mapped.design.typed]
    if mapped.users:
        words += [
            f"--{option} {attrs[name]:g}"
            for option, name in (("altitude-km", "user_altitude_km"), ("beam-deg", "beam_deg"))
            if attrs.get(name)
        ]
        lowest = float(np.min(attrs["elevation_mask_deg"]))
        if lowest != float(np.degrees(mapped.design.mask.lowest)):
            words.append(f"--mask-deg {lowest:g}")
    return " ".join(words)


def stations(results: DesignResults) -> list[Answer]:
    """The station that is worst off: whether the fold wanted is always in view there."""
    areas = results.stations
    if not areas:
        return []
    worst = min(areas, key=lambda area: -np.inf if area.fold.margin is None else area.fold.margin)
    verdict, margin = worst.fold, worst.fold.margin
    said = [] if verdict.met is not None and margin is not None else [verdict.word]
    said += [] if margin is None else [_spare(margin)]
    return [
        Answer(
            f"Worst of {len(areas)} stations: {worst.name}"
            if len(areas) > 1
            else f"Station {worst.name}",
            f"{results.design.fold} in view always: {', '.join(said)}",
            verdict.met,
            ", ".join(words for words in (verdict.sure, verdict.reason, verdict.scope) if words),
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
    stations,
    lasting,
    geometry,
    tightest,
    losses,
)
