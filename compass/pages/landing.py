"""The page of a landing: how well the place is known, where it comes down, then the flight."""

from collections.abc import Sequence
from math import inf

from compass.api.land import LandResult
from compass.api.land_dispersed import distance_words
from compass.api.land_fusion import too_sure
from compass.api.land_tables import entry_tables
from compass.api.land_words import delivered, findings
from compass.api.outlook import glance, left_words
from compass.document import Answer, Answers, Section, Sentence
from compass.document.blocks import Picture, arranged
from compass.document.numbers import significant
from compass.entry.assess import Assessment
from compass.entry.dispersed import Dispersed
from compass.inputs.scenario import Scenario, provenance
from compass.pages.answers import flown as what_flies
from compass.pages.page import render
from compass.pictures.ellipse import arrivals, landing_ellipse
from compass.pictures.entry import entry_pictures
from compass.study.fusion import FusionRuns
from compass.units import KM
from compass.words import counted, listed


def landing_report(land_result: LandResult) -> tuple[str, tuple[Section, ...]]:
    """Make the page (HTML text) and the sections of a flown scenario."""
    scenario = land_result.scenario
    sections = landing_sections(land_result)
    source, rows = scenario_provenance(scenario, land_result.command)
    return render(scenario.name, source, sections, rows, scenario.text), sections


def scenario_provenance(scenario: Scenario, command: str) -> tuple[str, list[tuple[str, str]]]:
    """Where a scenario comes from, and what a page about it was made from."""
    made = provenance(scenario, command)
    rows = [
        ("command", command or "made from Python"),
        ("version", made["source"]),
        ("scenario file", made["scenario_file"]),
        ("SHA-256 of the scenario", made["scenario_sha256"]),
    ]
    return made["references"] or "No source given.", rows


def landing_sections(land_result: LandResult) -> tuple[Section, ...]:
    """The answer, then navigation, the flight, who is in view, and filters compared if any are."""
    scenario, dispersed = land_result.scenario, land_result.dispersed
    flown = land_result.assessment
    drawn = {picture.stem: picture for picture in entry_pictures(flown, dispersed)}
    tables = {table.title.split(" (")[0]: table for table in entry_tables(flown)}
    consistency, *words = findings(scenario, flown)
    how = delivered(guided=scenario.guidance is not None)
    known, *rest = answers(flown, how)
    compared = fused_answers(land_result.fused)
    rows = (known, *dispersed_answers(dispersed), *rest, *compared, *beacon_answers(scenario))
    to_scale = [] if flown.accuracy.anywhere else [landing_ellipse(flown.accuracy, how)]
    if dispersed is not None and dispersed.guided and dispersed.reached.any():
        to_scale.insert(0, arrivals(dispersed))
    answer = Section(
        "The answer",
        (
            Sentence(f"{land_result.claim} {rests_on(land_result)}".strip()),
            Answers("Known, and how sure", rows),
            *to_scale[:1],
        ),
    )
    navigation = arranged(
        "Navigation", (consistency, *words), _those(drawn, "navigation"), (tables["Navigation"],)
    )
    told = [tables[title] for title in ("Events", "Largest loads") if title in tables]
    pictures = (*to_scale[1:], *_those(drawn, "map", "flight"))
    flight = arranged("The flight", (), pictures, told)
    view = arranged(
        "Who is in view", (), _those(drawn, "view", "observability"), (tables["Beacons"],)
    )
    return (answer, navigation, flight, view, *land_result.sections()[1:])


def rests_on(land_result: LandResult) -> str:
    """Say how far the filter is to be believed, and what its beacons are and how long they last."""
    flown, scenario = land_result.assessment, land_result.scenario
    runs = counted(len(flown.monte_carlo.errors), "run")
    believed = "are" if flown.consistency.holds else "are not"
    words = [f"Over {runs} the filter's errors {believed} what it claims."]
    for design in (o.design for o in scenario.orbiters):
        if design is not None:
            words.append(
                f"Its beacons are {design.name} ({what_flies(design)}); {left_words(design)} "
                f"that lasts {glance(design).words}."
            )
    return " ".join(words)


def beacon_answers(scenario: Scenario) -> tuple[Answer, ...]:
    """Who the beacons are and, of a design's satellites, how long they last left alone."""
    own = sum(o.constellation.size for o in scenario.orbiters if o.design is None)
    ground = len(scenario.surface_names)
    rows = []
    if ground:
        rows.append(Answer("Its beacons", f"{counted(ground, 'beacon')} on the ground", None))
    if own:
        rows.append(Answer("Its beacons", f"{counted(own, 'orbiter')} of its own", None))
    for design in (o.design for o in scenario.orbiters):
        if design is not None:
            rows += [
                Answer("Its beacons", design.name, None, what_flies(design)),
                glance(design).answer(design.name),
            ]
    return tuple(rows)


def dispersed_answers(runs: Dispersed | None) -> tuple[Answer, ...]:
    """How far from the target or the planned place dispersed entries come, if any are flown."""
    if runs is None:
        return ()
    far, count = runs.within(95.0), runs.times.size
    what = "Guided, entries come to the target within" if runs.guided else "Entries come within"
    said = f"{distance_words(far)} in 95 %" if far < inf else "not in 95 %"
    return (Answer(what, said, None, f"sampled, {count:,} dispersed entries"),)


def fused_answers(fused: FusionRuns | None) -> tuple[Answer, ...]:
    """Whether the filters that are compared claim no more than holds, if any are."""
    if fused is None:
        return ()
    vain, runs = list(too_sure(fused)), next(iter(fused.clear.values())).attrs["runs"]
    said = f"too sure: {listed(vain)}" if vain else "none is too sure"
    return (Answer("Filters compared claim what holds", said, not vain, f"NEES of {runs} runs"),)


def _those(drawn: dict[str, Picture], *names: str) -> Sequence[Picture]:
    return [picture for stem, picture in drawn.items() if stem.removeprefix("entry-") in names]


def answers(flown: Assessment, how: str = "Unguided") -> tuple[Answer, ...]:
    """What a landing's reader asks first; `how` it is delivered."""
    at, ellipse = flown.accuracy, flown.accuracy.delivery.ellipse
    runs = len(flown.monte_carlo.errors)
    claim = flown.claim_m
    apart = ", ".join(significant(sigma, 3) for sigma in at.knowledge.along_cross_down)
    count = flown.seen.sum(axis=1)
    seen = f"{count.min()}" if count.min() == count.max() else f"{count.min()} to {count.max()}"
    linear = "linear covariance"
    last = f"{significant(at.time, 4)} s"
    rows = [
        Answer(
            f"Place known at {at.name}, {last}",
            "not claimed" if claim is None else f"{significant(claim, 3)} m, 1 sigma",
            False if claim is None else None,
            f"sampled, {runs} runs of the filter",
        ),
        Answer(
            f"Along, across and down{'' if claim else ', were the filter consistent'}",
            f"{apart} m, 1 sigma",
            None,
            linear,
        ),
        Answer(
            f"Comes down within, {how[0].lower()}{how[1:]}",
            "no answer, for its first state is hardly known"
            if at.anywhere
            else f"{significant(ellipse.semi_major / KM, 3)} by "
            f"{significant(ellipse.semi_minor / KM, 3)} km",
            None,
            f"95 % ellipse, half axes; {linear}",
        ),
        Answer(
            "Errors are what the filter claims",
            "consistent" if flown.consistency.holds else "not consistent",
            flown.consistency.holds,
            f"NEES of {runs} runs",
        ),
        Answer(
            "Position and velocity can be observed",
            f"not at {flown.flight.times[flown.blind_epoch]:g} s"
            if flown.blind.words
            else "throughout"
            if claim is not None
            else "by rank alone, no accuracy is claimed",
            not flown.blind.words and claim is not None,
            "rank of the observability matrix at every epoch",
        ),
        Answer(
            "Beacons in view",
            f"{seen} of {flown.beacons.size}",
            None,
            f"at {flown.flight.times.size} epochs",
        ),
    ]
    if flown.flight.missed:
        rows.append(Answer("Events", "not reached: " + "; ".join(flown.flight.missed), False))
    return tuple(rows)
