"""Fly a scenario, assess its navigation, and draw the section that says what came of it."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from compass.api.given import in_metres
from compass.api.land_tables import entry_tables
from compass.api.land_words import claim_sentence, findings
from compass.document.blocks import Picture, Section, arranged
from compass.entry.assess import Assessment, assess
from compass.entry.carried import CarriedFilter
from compass.entry.dispersed import Dispersed, fly_dispersed
from compass.entry.layout import Part
from compass.entry.trajectory import fly
from compass.errors import ArgumentError
from compass.inputs.scenario import Scenario
from compass.signal.budget import mean_age_covariance

#: Filter runs that would take longer (s), or have more epochs in all, are refused.
MOST_SECONDS, MOST_STEPS = 3600.0, 100_000_000


def assess_scenario(scenario: Scenario, runs: int | None = None) -> Assessment:
    """Fly a scenario's truth and assess its navigation; `runs` instead of the scenario's.

    Raises
    ------
    ArgumentError
        A flight that ends before its second time, or a beacon at the lander's place.
    """
    many = scenario.runs if runs is None else runs
    check_cost(scenario, many)
    errors = satellite_errors(scenario)
    planned = scenario.planned()
    flight = fly(planned.truth, scenario.state, scenario.times, triggers=scenario.triggers)
    if flight.times.size < 2:
        raise ArgumentError(f"{scenario.label}: {flight.ending}; nothing to navigate")
    return assess(
        planned.model,
        flight,
        scenario.beacons(flight.times),
        scenario.measurements,
        replace(scenario.settings, parts=_off_their_time(scenario)),
        deployment=scenario.deployment,
        satellites=None if errors is None else errors[0],
        turns=None if errors is None else errors[1],
        runs=many,
        seed=scenario.seed,
    )


def satellite_errors(
    scenario: Scenario,
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Covariance of each beacon's radial, along, cross and clock error, m^2, (n, 4, 4).

    As the [signal] of the beacons' design says, by its age of data; and one sigma of the turn about
    each axis of the frame that its satellites share, rad, (n,). Zeros of beacons of the scenario's
    own, and None where no design has that table.

    Raises
    ------
    ArgumentError
        Nothing measures the clocks of satellites whose errors tracking is to imply.
    """
    designs = [orbiters.design for orbiters in scenario.orbiters]
    if not any(design is not None and design.signal is not None for design in designs):
        return None
    count = len(scenario.surface_names)
    covariances, turns = [np.zeros((count, 4, 4))], [np.zeros(count)]
    for orbiters, design in zip(scenario.orbiters, designs, strict=True):
        count = orbiters.constellation.size
        errors, turn = np.zeros((count, 4, 4)), 0.0
        if design is not None and design.signal is not None:
            signal = in_metres(design).signal
            assert signal is not None
            errors, turn = mean_age_covariance(signal, count), signal.common_orientation
        covariances.append(errors)
        turns.append(np.full(count, turn))
    return np.concatenate(covariances), np.concatenate(turns)


def _off_their_time(scenario: Scenario) -> tuple[Part, ...]:
    """The filter's blocks with a clock that is off by what the satellites' time is, too.

    A lander without a clock of its own keeps their time, and where it is makes no difference.
    """
    signals = [one.design.signal for one in scenario.orbiters if one.design is not None]
    off = max((signal.common_time for signal in signals if signal is not None), default=0.0)

    def widened(part: Part) -> Part:
        if part.name != "clock":
            return part
        return replace(part, sigma=(float(np.hypot(part.sigma[0], off)), part.sigma[1]))

    return tuple(widened(part) for part in scenario.settings.parts)


def disperse_scenario(scenario: Scenario, assessment: Assessment) -> Dispersed | None:
    """Fly the entries of a scenario's [dispersion]; None if it has none.

    Guided ones know of themselves what the filter tells them that `assessment` was assessed with.

    Raises
    ------
    ArgumentError
        The planned entry does not come to deployment.
    """
    if scenario.dispersion is None:
        return None
    settings = assessment.settings or scenario.settings
    carried = CarriedFilter(
        assessment.flight, assessment.beacons, assessment.taken, scenario.measurements, settings
    )
    return fly_dispersed(
        scenario.truth,
        scenario.model,
        scenario.state,
        scenario.dispersion,
        float(scenario.times[-1]),
        trigger=scenario.deployment,
        guidance=scenario.guidance,
        carried=None if scenario.guidance is None else carried,
        seed=scenario.seed,
    )


def check_cost(scenario: Scenario, runs: int) -> float:
    """Seconds that the filter runs will take, about; refused beyond `MOST_SECONDS`.

    Raises
    ------
    ArgumentError
        So many runs of so many epochs that they would take hours.
    """
    beacons = len(scenario.surface_names) + sum(o.constellation.size for o in scenario.orbiters)
    steps = runs * scenario.times.size
    seconds = steps * (2e-6 + 0.4e-6 * beacons)
    if seconds > MOST_SECONDS or steps > MOST_STEPS:
        raise ArgumentError(
            f"{scenario.label}: {runs} runs of {scenario.times.size} epochs past {beacons} beacons "
            f"would take about {seconds / 60:.0f} minutes and {steps * 80 / 1e9:.0f} GB of memory; "
            "give a longer entry.step_s or fewer runs"
        )
    return seconds


def entry_section(
    scenario: Scenario,
    assessment: Assessment,
    *,
    pictures: bool = True,
    claim: str | None = None,
    dispersed: Dispersed | None = None,
) -> Section:
    """Text, pictures and tables of one scenario, the answer first: `claim`, if given."""
    drawn: tuple[Picture, ...] = ()
    if pictures:
        from compass.pictures.entry import entry_pictures

        drawn = entry_pictures(assessment, dispersed)
    paragraphs = [" ".join(scenario.source.split())] if scenario.source.strip() else []
    first = claim_sentence(assessment) if claim is None else claim
    words = [*([first] if first else []), *paragraphs, *findings(scenario, assessment)]
    return arranged(f"Entry: {scenario.name}", tuple(words), drawn, entry_tables(assessment))
