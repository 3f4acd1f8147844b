"""What is said of a flight and of the filter on it, in sentences."""

import numpy as np

from compass.api.land_dispersed import dispersed_sentence
from compass.document.numbers import significant
from compass.entry.accuracy import Accuracy
from compass.entry.assess import Assessment
from compass.entry.dispersed import Dispersed
from compass.inputs.scenario import Scenario
from compass.ranging import MAS
from compass.signal.budget import basis
from compass.units import KM

#: Degrees that lines to satellites may turn from mid-flight on before it is said: an error along
#: them has changed by 1 - cos of it, 6 %, and what was across them counts with its sine.
MOST_TURN = 20.0


def findings(scenario: Scenario, assessment: Assessment) -> list[str]:
    """What is to be known of a flight and its filter, in sentences."""
    flight = assessment.flight
    last = flight.times[-1]
    count = assessment.seen.sum(axis=1)
    words = [
        assessment.consistency.sentence,
        *_whole_words(assessment),
        accuracy_sentence(assessment.accuracy, claimed=assessment.claim_m is not None),
        *ground_words(assessment),
        *satellite_words(scenario, assessment),
        f"The lander flies {last:g} s, from {flight.altitude[0] / KM:.1f} km and "
        f"{flight.speed[0]:.0f} m/s to {flight.altitude[-1] / KM:.1f} km and "
        f"{flight.speed[-1]:.0f} m/s. Between {count.min()} and {count.max()} of "
        f"{assessment.beacons.size} beacons are in view.",
    ]
    if flight.ending:
        words.append(f"The flight ended early: {flight.ending}.")
    if flight.missed:
        words.append(f"Not reached: {'; '.join(flight.missed)}.")
    if scenario.notes:
        words.append(f"Note: {'; '.join(scenario.notes)}.")
    words.append(observability_sentence(assessment))
    if not assessment.taken.any():
        left = "the errors are those of the first estimate"
        if any(count for _, count in assessment.readings):
            left = "what is known is from the other instruments"
        words.append(f"No beacon is ever measured: {left}.")
    return words


def observability_sentence(assessment: Assessment) -> str:
    """What beacons tell of position and velocity, which is no claim where the filter makes none."""
    radio = " by radio alone" if assessment.readings else ""
    when = f"at {assessment.flight.times[assessment.blind_epoch]:g} s"
    if assessment.blind.words:
        return (
            f"Not everything can be seen{radio} {when}: the observability matrix has rank "
            f"{assessment.blind.rank} of 6. Hidden: {'; '.join(assessment.blind.words)}."
        )
    weakest = f"worst {when}, where the weakest direction is {assessment.blind.weakest}."
    if assessment.claim_m is None:
        return (
            f"The observability matrix{radio} has full rank throughout, which is no accuracy: the "
            f"filter makes no claim from it; {weakest}"
        )
    return f"Position and velocity are observable throughout{radio}; {weakest}"


def satellite_words(scenario: Scenario, assessment: Assessment) -> list[str]:
    """What is said of how well the satellites' own places and clocks are known."""
    words = []
    for orbiters in scenario.orbiters:
        if (design := orbiters.design) is None:
            continue
        if design.signal is None:
            words.append(
                f"Orbits and clocks of {design.name} count as known exactly; give the design a "
                "table [signal] to count what is not known of them."
            )
        else:
            turn = design.signal.common_orientation
            mas = significant(turn / MAS, 3)
            words.append(
                f"Considered of {design.name}: {basis(design)}; as errors of the range to each "
                f"satellite that stay as they are in mid-flight{_turning(assessment)}"
                + (f"; and a turn of their frame by {mas} mas about each axis." if turn else ".")
            )
    if not assessment.known_exactly and scenario.fusion is not None:
        words.append("Filters of [fusion] take orbits and clocks of satellites as known exactly.")
    return words


def _turning(assessment: Assessment) -> str:
    """By how much lines to measured satellites turn, where that is too much for constant errors."""
    lines = assessment.flight.path[:, None, :3] - assessment.beacons.r
    lines /= np.linalg.norm(lines, axis=2, keepdims=True)
    cosine = (lines * lines[len(lines) // 2]).sum(axis=2)
    used = assessment.taken & assessment.beacons.moving
    turned = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))[used].max(initial=0.0)
    if turned < MOST_TURN:
        return ""
    return f", which holds badly here: lines to satellites turn by up to {turned:.0f} deg from then"


def _whole_words(assessment: Assessment) -> list[str]:
    """What is to be said of further states that the filter estimates."""
    whole = assessment.whole
    if whole.states == assessment.consistency.states or whole.holds == assessment.consistency.holds:
        return []
    nees = f"NEES {whole.nees[whole.worst]:.3g} at {assessment.flight.times[whole.worst]:g} s"
    return [
        f"All {whole.states} states that it estimates together are "
        f"{'consistent' if whole.holds else 'inconsistent'} ({nees}, {whole.low:.2f} to "
        f"{whole.high:.2f} is right): that concerns density, L/D, clock and biases, not the place."
    ]


def claim_sentence(
    assessment: Assessment, dispersed: Dispersed | None = None, *, guided: bool = False
) -> str:
    """What a landing comes to: knowledge, if it may be claimed, delivery, and entries flown.

    Of a `guided` one delivery is that of its bank flown as planned, whatever happens: entries that
    are guided come before it.
    """
    at, claim = assessment.accuracy, assessment.claim_m
    where = f"At {at.name} ({at.time:.1f} s)"
    if claim is None:
        known = f"{where} no accuracy is claimed, for the filter is inconsistent."
    else:
        known = (
            f"{where} the lander knows its place to {significant(claim, 3)} m (1 sigma, all axes)."
        )
    ellipse = at.delivery.ellipse
    how = delivered(guided=guided)
    half = (significant(axis / KM, 3) for axis in (ellipse.semi_major, ellipse.semi_minor))
    linear = (
        anywhere(how)
        if at.anywhere
        else f"{how} it comes down within {' by '.join(half)} km (95 % ellipse, half axes, "
        f"major axis {np.degrees(ellipse.azimuth):.0f} deg from north), half of the time within "
        f"{significant(at.delivery.cep / KM, 3)} km."
    )
    flown = dispersed_sentence(dispersed) if dispersed else ""
    parts = (known, flown, linear) if guided else (known, linear, flown)
    return " ".join(part for part in parts if part)


def delivered(*, guided: bool) -> str:
    """How a lander comes to where linear covariance has it."""
    return "By the planned bank alone" if guided else "Unguided"


def anywhere(how: str) -> str:
    """What is said instead of an ellipse that is larger than Mars."""
    return (
        f"{how} it comes down nobody knows where: what is not known of its first state spreads "
        "over more than a radian of the ground, of which linear covariance says nothing."
    )


def ground_words(assessment: Assessment) -> list[str]:
    """What is to be said of the ground, where a flight goes on to it past deployment."""
    ground = assessment.ground
    if ground is None:
        return []
    said = accuracy_sentence(ground, claimed=assessment.claim_m is not None)
    said = said.removeprefix("Linear covariance there, ")
    return [f"On the ground ({ground.time:.1f} s), as if no parachute were opened, {said}"]


def accuracy_sentence(at: Accuracy, *, claimed: bool) -> str:
    """Knowledge and delivery along, across and down; knowledge a filter's that is consistent."""
    known, comes = (
        ", ".join(significant(sigma, 3) for sigma in spread.along_cross_down)
        for spread in (at.knowledge, at.delivery)
    )
    when = "at the moment of the event" if at.projected else "at that time"
    would = "known" if claimed else "by a consistent filter it would be known"
    said = f"Linear covariance there, along, across and down: {would} to {known} m"
    if at.anywhere:
        return f"{said} (1 sigma)."
    return f"{said}, delivered to {comes} m (1 sigma, {when})."
