"""The report of a search for the best beacons."""

from collections.abc import Callable
from typing import Any

import numpy as np

from compass.core.entry_geometry import cartesian_of
from compass.document.blocks import Picture, Section, Table, arranged
from compass.entry.beacons import surface_beacons
from compass.entry.best_directions import best_directions_found
from compass.entry.best_ground import best_ground_beacons
from compass.entry.best_orbiters import best_orbiters
from compass.entry.fisher import best_determinant
from compass.entry.search import Optimum
from compass.entry.trajectory import Trajectory, fly
from compass.errors import ArgumentError
from compass.inputs.scenario import Scenario
from compass.pages.entry_pictures import draw_map
from compass.pictures.style import CYCLE, look, new_figure, picture

KM = 1e3


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
        found = best_ground_beacons(
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
        found = best_orbiters(
            flight,
            (task.altitude_km or 0.0) * KM,
            task.count,
            starts=task.starts,
            generations=task.generations,
            seed=task.seed,
            progress=progress,
        )
    else:
        found = best_directions_found(np.ones(task.count), starts=task.starts, seed=task.seed)
    return flight, found


def best_beacons_section(scenario: Scenario, flight: Trajectory, found: Optimum) -> Section:
    """Text, pictures and tables of a search."""
    words = [
        f"Best {found.objective}: {found.value:.7g}, from {len(found.starts)} starts and "
        f"{sum(s.evaluations for s in found.starts)} evaluations in {found.seconds:.1f} s."
    ]
    assert scenario.optimize is not None
    if scenario.optimize.what == "directions":
        exact = best_determinant(np.ones(scenario.optimize.count))
        words.append(f"Closed form (N/3)^3: {exact:.7g}.")
    return arranged(
        f"Best beacons: {scenario.name}",
        tuple(words),
        (*_places(scenario, flight, found), _convergence(found)),
        (_beacon_table(scenario, found), _start_table(found)),
    )


def _beacon_table(scenario: Scenario, found: Optimum) -> Table:
    assert scenario.optimize is not None
    header = {
        "ground": ("latitude, deg", "east longitude, deg"),
        "orbiters": ("node, deg", "inclination, deg", "argument of latitude, deg"),
        "directions": ("x", "y", "z"),
    }[scenario.optimize.what]
    values = found.parameters
    if scenario.optimize.what != "directions":
        values = np.degrees(values)
    rows = tuple((k + 1, *row) for k, row in enumerate(values.tolist()))
    return Table("Best beacons", ("beacon", *header), rows)


def _start_table(found: Optimum) -> Table:
    rows = tuple((k + 1, s.value, s.evaluations) for k, s in enumerate(found.starts))
    return Table("Starts, best first", ("start", found.objective, "evaluations"), rows)


def _places(scenario: Scenario, flight: Trajectory, found: Optimum) -> list[Picture]:
    assert scenario.optimize is not None
    if scenario.optimize.what != "ground":
        return []
    lat, lon = found.parameters.T
    beacons = surface_beacons(lat, lon, flight.times, planet_radius=flight.model.planet_radius)
    with look():
        figure = new_figure(7.5, 5.2)
        axes = figure.add_subplot()
        draw_map(axes, flight, beacons)
        axes.set_title("The best places for ground beacons")
        figure.legend(fontsize=8, frameon=False, loc="outside right upper")
    caption = "Best places found, with the ground track and the area that sees all of it."
    return [picture(figure, "best-beacons", "Best places for ground beacons", caption)]


def _convergence(found: Optimum) -> Picture:
    with look():
        figure = new_figure(7.5, 3.6)
        axes = figure.add_subplot()
        for k, start in enumerate(found.starts):
            colour, width = (CYCLE[0], 2.0) if k == 0 else (CYCLE[6], 1.0)
            generations = range(1, len(start.history) + 1)
            axes.plot(generations, start.history, color=colour, lw=width, alpha=0.9)
            axes.plot(len(start.history), start.history[-1], "o", ms=4, color=colour)
        values = np.concatenate([s.history for s in found.starts])
        if values.min() > 0 and values.max() > 20 * values.min():
            axes.set_yscale("log")
        axes.set_xlabel("generation (last point: after the local polish)")
        axes.set_ylabel(found.objective)
        axes.set_title("Convergence of every start")
        axes.grid(True)
    return picture(
        figure, "best-convergence", "Convergence of the search", "The best start in colour."
    )


def best_beacons_facts(scenario: Scenario, flight: Trajectory, found: Optimum) -> dict[str, Any]:
    """Return the numbers as one JSON object, names with their units."""
    assert scenario.optimize is not None
    what = scenario.optimize.what
    table = _beacon_table(scenario, found)
    keys = {
        "ground": ("latitude_deg", "longitude_deg"),
        "orbiters": ("raan_deg", "inclination_deg", "latitude_argument_deg"),
        "directions": ("x", "y", "z"),
    }[what]
    facts = {
        "scenario": scenario.name,
        "what": what,
        "objective": found.objective,
        "value": found.value,
        "beacons": [dict(zip(keys, row[1:], strict=True)) for row in table.rows],
        "seconds": found.seconds,
        "starts": [
            {"value": s.value, "evaluations": s.evaluations, "history": s.history}
            for s in found.starts
        ],
    }
    if what != "directions":
        end = cartesian_of(flight.states[-1])[:3] / KM
        facts["lander_end_km"] = end
    return facts
