"""Where beacons are best, and how the search for them went."""

import numpy as np
from matplotlib.axes import Axes

from compass.document import Picture
from compass.entry.beacons import surface_beacons
from compass.entry.search import Optimum
from compass.entry.trajectory import Trajectory
from compass.pictures.entry import draw_map
from compass.pictures.style import CYCLE, axes_or_new, look, new_figure, picture


def places(flight: Trajectory, optimum: Optimum) -> Picture:
    """Draw the best places of ground beacons, with the ground track and who sees it."""
    lat, lon = optimum.parameters.T
    beacons = surface_beacons(lat, lon, flight.times, planet_radius=flight.model.planet_radius)
    with look():
        figure = new_figure(7.5, 5.2)
        axes = figure.add_subplot()
        draw_map(axes, flight, beacons)
        axes.set_title("The best places for ground beacons")
        figure.legend(fontsize=8, frameon=False, loc="outside right upper")
    caption = "Best places found, with the ground track and the area that sees all of it."
    return picture(figure, "best-beacons", "Best places for ground beacons", caption)


def convergence(optimum: Optimum) -> Picture:
    """Show how the objective fell from every start."""
    with look():
        figure = new_figure(7.5, 3.6)
        draw_convergence(figure.add_subplot(), optimum)
    return picture(
        figure, "best-convergence", "Convergence of the search", "The best start in colour."
    )


def draw_convergence(given: Axes | None, optimum: Optimum) -> Axes:
    """Draw how the objective fell from every start, on axes given or new ones."""
    axes = axes_or_new(given, 7.5, 3.6)
    with look():
        for k, start in enumerate(optimum.starts):
            colour, width = (CYCLE[0], 2.0) if k == 0 else (CYCLE[6], 1.0)
            generations = range(1, len(start.history) + 1)
            axes.plot(generations, start.history, color=colour, lw=width, alpha=0.9)
            axes.plot(len(start.history), start.history[-1], "o", ms=4, color=colour)
        values = np.concatenate([s.history for s in optimum.starts])
        if values.min() > 0 and values.max() > 20 * values.min():
            axes.set_yscale("log")
        axes.set_xlabel("generation (last point: after the local polish)")
        axes.set_ylabel(optimum.objective)
        axes.set_title("Convergence of every start")
        axes.grid(True)
    return axes
