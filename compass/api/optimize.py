"""The best beacons, orbits or directions for a lander."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.api.given import given_scenario
from compass.api.progress import bar
from compass.api.results import Result
from compass.arguments import checked
from compass.document import Page, Picture, Sentence, Table, Verdict
from compass.document.plain import plain
from compass.entry.best_directions import best_directions_found
from compass.entry.best_ground import best_ground_beacons
from compass.entry.best_orbiters import best_orbiters
from compass.entry.fisher import best_determinant
from compass.entry.search import Optimum
from compass.entry.trajectory import Trajectory, fly
from compass.entry.views import cartesian_of
from compass.errors import ArgumentError
from compass.inputs.scenario import Scenario, provenance
from compass.units import KM
from compass.words import place_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, repr=False)
class OptimizeResult(Result):
    """The best that a search found, with its starts.

    Attributes
    ----------
    scenario
        What was asked, in its table [optimize].
    flight
        The true trajectory.
    optimum
        The best, and how every start got there.
    command
        For the provenance.
    """

    scenario: Scenario = field(repr=False)
    flight: Trajectory = field(repr=False)
    optimum: Optimum
    command: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        known = _facts(self.scenario, self.flight, self.optimum)
        return plain(known | {"provenance": provenance(self.scenario, self.command)})

    def document(self) -> Page:
        """The best in a sentence, where it is, and how the starts compare."""
        best, *more = self.words()
        tables = (_beacon_table(self.scenario, self.optimum), _start_table(self.optimum))
        words = (Sentence(text) for text in more)
        return Page(self.scenario.name, (Verdict("", best), *words, *tables))

    def words(self) -> tuple[str, ...]:
        """The best in a sentence, and the closed form where there is one."""
        best, task = self.optimum, self.scenario.optimize
        words = [
            f"Best {best.objective}: {best.value:.7g}, from {len(best.starts)} starts and "
            f"{sum(s.evaluations for s in best.starts)} evaluations in {best.seconds:.1f} s."
        ]
        assert task is not None
        if task.what == "directions":
            exact = best_determinant(np.ones(task.count))
            words.append(f"Closed form (N/3)^3: {exact:.7g}.")
        return tuple(words)

    def plot(self, *, axes: "Axes | None" = None) -> "Axes":
        """Draw how the objective fell from every start of the search.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.beacons import draw_convergence

        return draw_convergence(axes, self.optimum)

    def pictures(self) -> tuple[Picture, ...]:
        """Where ground beacons are best, and how the search converged."""
        from compass.pictures.beacons import convergence, places

        task = self.scenario.optimize
        ground = task is not None and task.what == "ground"
        placed = [places(self.flight, self.optimum)] if ground else []
        return (*placed, convergence(self.optimum))


@checked
def optimize(
    scenario: Scenario | str | Path, *, command: str = "", progress: bool = False
) -> OptimizeResult:
    """Search for the best beacons or orbits, as the scenario's [optimize] table asks.

    Parameters
    ----------
    scenario
        A scenario, or the path of its file.
    command
        What to write into the files' history.
    progress
        Show bars on stderr.

    Raises
    ------
    ArgumentError, DesignError
        The scenario is not allowed or has no such table, or the search has no answer.

    Examples
    --------
    >>> import compass
    >>> from dataclasses import replace
    >>> scenario = compass.read_scenario("designs/entry-ground-beacons.toml")
    >>> task = scenario.optimize.model_copy(update={"what": "directions", "starts": 2})
    >>> result = compass.optimize(replace(scenario, optimize=task))
    >>> f"{result.optimum.value:.4f}"
    '1.0000'
    """
    read = given_scenario(scenario)
    starts = read.optimize.starts if read.optimize else None
    with bar(progress, "search", total=starts, unit="start", leave=False) as done:
        flight, optimum = search_scenario(read, progress=done.update)
    return OptimizeResult(read, flight, optimum, command)


def search_scenario(
    scenario: Scenario, *, progress: Callable[[], object] = lambda: None
) -> tuple[Trajectory, Optimum]:
    """Search for what a scenario's ``[optimize]`` table asks, along its true trajectory.

    `progress` is called after each start.

    Raises
    ------
    ArgumentError
        The scenario has no such table, or the search has no answer.
    """
    task = scenario.optimize
    if task is None:
        raise ArgumentError(
            f'{scenario.label}: no [optimize] table; add one, such as what = "ground", count = 3'
        )
    flight = fly(scenario.truth, scenario.state, scenario.times)
    if flight.times.size < 2:
        raise ArgumentError(f"{scenario.label}: {flight.ending}; nothing to navigate")
    if task.what == "ground":
        optimum = best_ground_beacons(
            flight,
            task.count,
            objective=task.objective,
            measurements=scenario.measurements,
            covariance0=scenario.settings.covariance0,
            starts=task.starts,
            generations=task.generations,
            seed=task.seed,
            progress=progress,
        )
    elif task.what == "orbiters":
        optimum = best_orbiters(
            flight,
            (task.altitude_km or 0.0) * KM,
            task.count,
            starts=task.starts,
            generations=task.generations,
            seed=task.seed,
            progress=progress,
        )
    else:
        optimum = best_directions_found(np.ones(task.count), starts=task.starts, seed=task.seed)
    return flight, optimum


def _beacon_table(scenario: Scenario, optimum: Optimum) -> Table:
    assert scenario.optimize is not None
    if scenario.optimize.what == "ground":
        places = tuple(
            (k + 1, place_words(latitude, longitude))
            for k, (latitude, longitude) in enumerate(np.degrees(optimum.parameters).tolist())
        )
        return Table("Best beacons", ("beacon", "place"), places)
    header = {
        "orbiters": ("node, deg", "inclination, deg", "argument of latitude, deg"),
        "directions": ("x", "y", "z"),
    }[scenario.optimize.what]
    values = optimum.parameters
    if scenario.optimize.what != "directions":
        values = np.degrees(values)
    rows = tuple((k + 1, *row) for k, row in enumerate(values.tolist()))
    return Table("Best beacons", ("beacon", *header), rows)


def _start_table(optimum: Optimum) -> Table:
    rows = tuple((k + 1, s.value, s.evaluations) for k, s in enumerate(optimum.starts))
    return Table("Starts, best first", ("start", optimum.objective, "evaluations"), rows)


def _facts(scenario: Scenario, flight: Trajectory, optimum: Optimum) -> dict[str, Any]:
    """Return the numbers as one JSON object, names with their units."""
    assert scenario.optimize is not None
    what = scenario.optimize.what
    values = optimum.parameters if what == "directions" else np.degrees(optimum.parameters)
    keys = {
        "ground": ("latitude_deg", "longitude_deg"),
        "orbiters": ("raan_deg", "inclination_deg", "latitude_argument_deg"),
        "directions": ("x", "y", "z"),
    }[what]
    facts = {
        "scenario": scenario.name,
        "what": what,
        "objective": optimum.objective,
        "value": optimum.value,
        "beacons": [dict(zip(keys, row, strict=True)) for row in values.tolist()],
        "seconds": optimum.seconds,
        "starts": [
            {"value": s.value, "evaluations": s.evaluations, "history": s.history}
            for s in optimum.starts
        ],
    }
    if what != "directions":
        end = cartesian_of(flight.states[-1])[:3] / KM
        facts["lander_end_km"] = end
    return facts
