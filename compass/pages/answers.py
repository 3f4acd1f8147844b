"""The first lines of a design's page: what is met, how sure that is, and what to do.

Further answers join `ANSWERS` in the order of the page: a function from `Found` to rows.
"""

from collections.abc import Callable, Sequence

import numpy as np

from compass.coverage.certificate import Outcome
from compass.coverage.site import site_coverage
from compass.document import Answer, Answers, Bracket, Sampled, Section, Sentence, Value
from compass.document.blocks import Block
from compass.document.numbers import significant
from compass.pages.found import Found
from compass.pages.lasting import lasting_advice, lasting_answers
from compass.pages.neighbours import Neighbour
from compass.quantities import quantity


def coverage(found: Found) -> list[Answer]:
    """Whether the fold wanted is there, everywhere and always, and by how much."""
    result = found.fold
    claim = f"{result.fold} in view above {result.mask_deg:g}°, everywhere"
    holds = {Outcome.PROVEN: True, Outcome.REFUTED: False}.get(result.outcome)
    rows = [Answer(claim, str(result.outcome), holds, result.scope)]
    margin = result.margins().rows[3][1]
    assert isinstance(margin, Value)
    known = result.mask_margin_deg
    question = "The mask may rise to" if known is None or known >= 0 else "It would take a mask of"
    rows.append(Answer(question, "no mask has it" if known is None else margin))
    if place := result.to_dict()["worst"]:
        rows.append(
            Answer(
                "Tightest place and moment",
                f"{latitude_words(place['latitude_deg'])}, "
                f"{significant(place['longitude_deg'] % 360, 4)}° E, "
                f"{significant(place['time_s'] / 3600, 3)} h after the epoch",
                evidence="by symmetry one of several" if found.design.constellation.pattern else "",
            )
        )
    return rows


def latitude_words(latitude_deg: float) -> str:
    """Write a latitude north or south."""
    side = "N" if latitude_deg >= 0 else "S"
    return f"{significant(abs(latitude_deg), 3)}° {side}"


def geometry(found: Found) -> list[Answer]:
    """How good the geometry is over all area and time."""
    numbers, attrs = found.mapped.numbers(), found.mapped.dataset.attrs
    sampled = Sampled(None, f"{attrs['epochs']} epochs, {attrs['grid']}")
    scope = found.mapped.certified.scope.split(";")[0] if found.mapped.certified else ""

    def bracketed(bounds: list[float] | None) -> Bracket | Sampled:
        return Bracket(bounds[0], bounds[1], scope) if bounds else sampled

    gdop = quantity("gdop")
    rows = [
        Answer("GDOP, half of area and time below", Value(gdop, numbers["gdop"]["p50"], sampled)),
        Answer(
            "GDOP, 95 % below",
            Value(gdop, numbers["gdop"]["p95"], bracketed(numbers["gdop"].get("p95_bracket"))),
        ),
    ]
    share = Value(
        quantity("availability"),
        numbers["availability"],
        bracketed(numbers.get("availability_bracket")),
    )
    return [*rows, Answer(f"Area and time with PDOP {attrs['pdop_threshold']:g} or less", share)]


def stations(found: Found) -> list[Answer]:
    """The station that is worst off."""
    sites, times = found.design.stations, found.mapped.made.view.times
    if not sites:
        return []
    counts = {
        site.name: site_coverage(
            found.design.constellation, site, times, found.design.motion
        )["count"].values
        for site in sites
    }  # fmt: skip
    worst = min(counts, key=lambda name: (counts[name].min(), counts[name].mean()))
    least, wanted = int(counts[worst].min()), found.design.fold
    return [
        Answer(
            f"Worst of {len(sites)} stations: {worst}" if len(sites) > 1 else f"Station {worst}",
            f"sees {least} at least, {wanted} wanted",
            least >= wanted,
            f"sampled, {times.size} epochs",
        )
    ]


def losses(found: Found) -> list[Answer]:
    """What is left when one satellite fails."""
    if not found.fold.coverage.losses:
        return []
    least = min(sets.least for sets in found.fold.coverage.losses[0])
    evidence = Bracket(*least, found.fold.scope)
    left = Value(quantity("min_fold"), least[0], evidence)
    return [Answer("After any one loss, in view at least", left, None, found.fold.scope)]


def lasting(found: Found) -> list[Answer]:
    """How long it lasts left alone, what keeping costs, which radius does without."""
    return lasting_answers(found.design, found.outlook) if found.outlook else []


#: In the order of the page.
ANSWERS: tuple[Callable[[Found], list[Answer]], ...] = (
    coverage,
    lasting,
    geometry,
    stations,
    losses,
)


def answer_section(
    found: Found, carrying: Sequence[Block], neighbours: Sequence[Neighbour]
) -> Section:
    """The answers, the picture that carries them, and what to do."""
    rows = tuple(row for question in ANSWERS for row in question(found))
    advice = (Sentence(words) for words in what_to_do(found, neighbours))
    return Section("The answer", (*advice, Answers("Met, and how sure", rows), *carrying))


def what_to_do(found: Found, neighbours: Sequence[Neighbour]) -> list[str]:
    """Recommend in a sentence; name the rival, and what would change the advice."""
    result, c = found.fold, found.design.constellation
    wanted = f"{result.fold}-fold coverage above {result.mask_deg:g}°"
    real = lasting_advice(found.outlook) if found.outlook else ""
    words = {
        Outcome.PROVEN: f"Build it as it is: it has {wanted}, with nothing left to chance."
        if not real
        else f"It has {wanted} on undisturbed orbits. {real}",
        Outcome.REFUTED: f"Do not build it for {wanted}: there is a place and a moment without.",
    }.get(result.outcome, f"Decide after a finer look: {wanted} is neither proven nor refuted.")
    said = [words]
    margin = result.mask_margin_deg
    if margin is not None and margin < 0:  # below the horizon: none that can be built
        margin = None
    if neighbours:
        best = max(neighbours, key=lambda n: n.mask_deg)
        here = -np.inf if margin is None else margin
        if best.mask_deg > here + 0.1:
            said.append(
                f"Its rival of the same size: {best.notation}, with a mask up to "
                f"{significant(best.mask_deg, 3)}°"
                + ("." if margin is None else f" instead of {significant(margin, 3)}°.")
            )
        else:
            said.append("No other phasing or inclination of as many satellites has more margin.")
    if margin is not None:
        said.append(f"A mask above {significant(margin, 3)}° would change this.")
    if found.fold.coverage.losses and c.size > 1:
        least = min(sets.least[0] for sets in found.fold.coverage.losses[0])
        if least < result.fold <= c.size:
            said.append(
                f"So would the loss of one satellite: then {least} in view is all that is sure."
            )
    return [" ".join(said)]
