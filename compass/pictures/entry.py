"""Pictures of an entry: map, flight, view, observability, navigation errors."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from compass.document.blocks import Picture
from compass.document.numbers import significant
from compass.entry.assess import Assessment
from compass.entry.beacons import Beacons
from compass.entry.dispersed import Dispersed
from compass.entry.trajectory import Trajectory, trajectory_dataset
from compass.entry.views import local_axes
from compass.entry.visible_area import VisibleArea, horizon
from compass.errors import ArgumentError
from compass.frames import latitude_longitude
from compass.pictures.rows import draw_rows, runs
from compass.pictures.style import (
    CYCLE,
    FAINT,
    HALF,
    INK,
    MARS,
    SKY,
    look,
    new_figure,
    on_mars,
    picture,
)
from compass.quantities.percentile import percentile
from compass.units import KM


def entry_pictures(
    assessment: Assessment, dispersed: Dispersed | None = None
) -> tuple[Picture, ...]:
    """All pictures of an assessment, dispersed entries on its map."""
    return (
        _map_picture(assessment, dispersed),
        _flight_picture(assessment.flight),
        _view_picture(assessment),
        _observability_picture(assessment),
        _navigation_picture(assessment),
        _budget_picture(assessment),
    )


def _budget_picture(assessment: Assessment) -> Picture:
    with look():
        figure = new_figure(7.5, 1.4 + 0.3 * len(assessment.budget))
        axes = figure.add_subplot()
        names, sigmas = zip(
            *((share.name, share.sigma) for share in assessment.budget), strict=True
        )
        axes.barh(range(len(names)), sigmas, color=CYCLE[0])
        axes.set_yticks(range(len(names)), names)
        axes.set_ylim(max(len(names), 4) - 0.5, -0.5)
        axes.set(xlabel="error of the known place, m (1 sigma, all axes)")
        axes.grid(axis="x", alpha=0.3)
    most, at = assessment.budget[0], assessment.accuracy
    return picture(
        figure,
        "landing-budget",
        "Where the error of the known place comes from",
        f"What every source leaves at {at.name}; squares add up to "
        f"{significant(float(np.linalg.norm(at.knowledge.along_cross_down)), 3)} m. The largest is "
        f"{most.name}, {significant(most.sigma, 3)} m.",
    )


def _map_picture(assessment: Assessment, dispersed: Dispersed | None) -> Picture:
    with look():
        figure = new_figure(HALF[0], 4.9)
        axes = figure.add_subplot()
        draw_map(axes, assessment.flight, assessment.beacons)
        draw_landing(axes, assessment, dispersed)
        figure.legend(fontsize=8, frameon=False, loc="outside lower center", ncols=3)
    delivery = assessment.accuracy.delivery.ellipse
    if assessment.accuracy.anywhere:
        where = "Where it comes down cannot be said: no ellipse is drawn."
    else:
        where = (
            "The ellipse that holds 95 % of landings has half axes of "
            f"{significant(delivery.semi_major / KM, 3)} and "
            f"{significant(delivery.semi_minor / KM, 3)} km, the longer one "
            f"{np.degrees(delivery.azimuth):.0f} deg from north."
        )
    return picture(
        figure,
        "entry-map",
        "Ground track, visible area and beacons",
        "Ground track, the rims of what sees the lander at the start and at the end (dashed), and "
        f"the area that sees it all the way (shaded, if there is one). {where}",
    )


def draw_landing(axes: Axes, assessment: Assessment, dispersed: Dispersed | None = None) -> None:
    """Draw where the lander comes down into a map and, larger, into a corner of it.

    The ellipse of 95 % of linear covariance, and entries that were flown.
    """
    at, states = assessment.accuracy, assessment.flight.states
    if at.anywhere and dispersed is None:
        return
    lon0 = float(np.degrees(states[:, 1].mean()))
    rim = _degrees(around(at.path[:3], at.delivery.ellipse.outline()), lon0)
    corner = axes.inset_axes((0.03, 0.03, 0.36, 0.3))
    for part in (axes, corner):
        if not at.anywhere:
            part.plot(*rim, color=CYCLE[3], lw=1.4, label="comes down, 95 %")
        if dispersed is not None:
            spots = _degrees(dispersed.ends[dispersed.reached, :3], lon0)
            part.plot(*spots, ".", color=INK, ms=2.5, alpha=0.6, label="dispersed entries")
    within, narrow = corner.get_xlim(), max(0.05, float(np.cos(states[-1, 2])))
    across = np.radians(within[1] - within[0]) * narrow * np.linalg.norm(at.path[:3]) / KM
    corner.set(xlim=within, ylim=corner.get_ylim(), xticks=[], yticks=[])
    corner.plot(np.degrees(states[:, 1]), np.degrees(states[:, 2]), color=MARS, lw=1.4, zorder=1)
    corner.set_aspect(1 / narrow)
    corner.set_title(f"{significant(float(across), 2)} km across", fontsize=8)
    axes.indicate_inset_zoom(corner, edgecolor=FAINT)


def around(place: NDArray[np.float64], offsets: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points (k, 3) so far to the east and north, (k, 2) m over the ground, of a place (3,)."""
    radius = np.linalg.norm(place)
    east, north, up = local_axes(place)
    way = np.linalg.norm(offsets, axis=1, keepdims=True)
    level = offsets @ np.stack([east, north]) / np.where(way > 0, way, 1.0)
    return np.asarray(radius * (np.cos(way / radius) * up + np.sin(way / radius) * level))


def _degrees(points: NDArray[np.float64], lon0: float) -> tuple[NDArray, NDArray]:
    """Longitudes within half a turn of `lon0` and latitudes of points (k, 3), degrees."""
    lat, lon = latitude_longitude(points)
    return lon0 + (np.degrees(lon) - lon0 + 180) % 360 - 180, np.degrees(lat)


def draw_map(axes: Axes, flight: Trajectory, beacons: Beacons) -> None:
    """Draw ground track, visible area and the beacons that stand near it into plain axes."""
    lon0 = float(np.degrees(flight.states[:, 1].mean()))
    for epoch, label in ((0, "sees the start"), (-1, "sees the end")):
        lon, lat = _degrees(horizon(flight, epoch), lon0)
        colour = FAINT if epoch == 0 else INK
        axes.plot(lon, lat, "--", color=colour, lw=1, label=label)
    try:
        lon, lat = _degrees(VisibleArea(flight).outline(), lon0)
        axes.fill(lon, lat, color=SKY, alpha=0.18, lw=0, label="sees all of it")
    except ArgumentError:
        pass  # no such area: nothing to shade
    lon, lat = np.degrees(flight.states[:, 1]), np.degrees(flight.states[:, 2])
    axes.plot(lon, lat, color=MARS, lw=2, label="ground track")
    axes.plot(lon[0], lat[0], "o", color=MARS, ms=5)
    axes.plot(lon[-1], lat[-1], ">", color=MARS, ms=7)
    near = ~beacons.moving
    if near.any():
        lon, lat = _degrees(beacons.r[0, near], lon0)
        axes.plot(lon, lat, "^", color=INK, ms=7, label="ground beacons")
        for x, y, k in zip(lon, lat, np.flatnonzero(near), strict=True):
            place = (5, 4) if k % 2 == 0 else (5, -11)  # neighbours on different sides
            axes.annotate(beacons.names[k], (x, y), place, textcoords="offset points", fontsize=8)
    on_mars(axes.xaxis, "longitude")
    on_mars(axes.yaxis, "latitude")
    # near a pole degrees of longitude shrink to nothing: no wider than 20 to 1
    narrow = max(0.05, float(np.cos(flight.states[:, 2].mean())))
    axes.set_aspect(1 / narrow, adjustable="datalim")
    axes.grid(True)
    axes.set_title("Where the lander flies and who sees it")


def _flight_picture(flight: Trajectory) -> Picture:
    data = trajectory_dataset(flight)
    with look():
        figure = new_figure(5.8, 4.6)
        axes = figure.subplots(2, 2, sharex=True).ravel()
        for ax, values, label, colour in (
            (axes[0], data.altitude / KM, "altitude, km", CYCLE[0]),
            (axes[1], data.speed / KM, "speed, km/s", CYCLE[1]),
            (axes[2], data.g_load, "deceleration, g", CYCLE[2]),
            (axes[3], data.heat_flux / 1e4, "heat flux, W/cm²", CYCLE[3]),
        ):
            ax.plot(flight.times, values, color=colour, lw=1.8)
            ax.set_ylabel(label)
            ax.grid(True)
            for event in flight.events:
                ax.axvline(event.time, color=FAINT, lw=0.8, ls=":")
        for event in flight.events:
            axes[0].annotate(
                event.name, (event.time, 1.0), (2, -9), xycoords=("data", "axes fraction"),
                textcoords="offset points", fontsize=8, color=INK,
            )  # fmt: skip
        for ax in axes[2:]:
            ax.set_xlabel("time after entry, s")
        figure.suptitle("The flight", fontsize=11, fontweight="bold")
    return picture(
        figure,
        "entry-flight",
        "Altitude, speed, deceleration and heat flux",
        "The true trajectory; the heat flux is convective at the stagnation point (Sutton and "
        "Graves 1971). Dotted: events.",
    )


def _view_picture(assessment: Assessment) -> Picture:
    names, times = assessment.beacons.names, assessment.flight.times
    with look():
        figure = new_figure(5.8, 1.4 + 0.24 * max(3, len(names)))
        axes = figure.add_subplot()
        step = times[1] - times[0]
        spans = []
        for seen in assessment.seen.T:
            first, past = runs(seen).T
            start = times[first]
            spans.append(np.column_stack([start, np.maximum(times[past - 1], start + step)]))
        ends = float(times[0]), float(times[-1])
        draw_rows(axes, names, spans, [SKY] * len(names), ends, width=11.0)
        axes.set_xlabel("time after entry, s")
        axes.set_title("Beacons in view")
    return picture(
        figure, "entry-view", "Beacons in view over time", "Line of sight past the planet's sphere."
    )


def _observability_picture(assessment: Assessment) -> Picture:
    times = assessment.flight.times
    with look():
        figure = new_figure(5.8, 4.6)
        upper, lower = figure.subplots(2, 1, sharex=True)
        visible = assessment.observability
        for degree, label, colour in (
            (visible.spherical_degree, "of angles, in m, s, rad", CYCLE[0]),
            (visible.degree, "of axes, in 3400 km, 100 s", CYCLE[1]),
        ):
            # beyond full rank only rounding is left to show
            shown = np.where(visible.rank == 6, degree, np.nan)
            upper.plot(times, shown, color=colour, lw=1.8, label=label)
        _logarithmic(upper)
        upper.set_ylabel("degree δ")
        upper.legend(fontsize=8, frameon=False)
        upper.set_title("How well the state is observable")
        lower.plot(times, assessment.observability.index, color=CYCLE[2], lw=1.8)
        lower.set_ylabel("geometric index I")
        lower.set_ylim(bottom=0)
        lower.grid(True)
        lower.set_xlabel("time after entry, s")
    return picture(
        figure,
        "entry-observability",
        "Observability degree and geometric index over time",
        "Above: smallest over largest singular value of the exact observability matrix of the "
        "beacons in view, of radius, angles and speed as papers have it, and of position and "
        "velocity, however the axes stand (gaps: rank below 6). Below: sum over triples "
        "of beacons of [n_i . (n_j x n_k)]^2.",
    )


def _navigation_picture(assessment: Assessment) -> Picture:
    times, mc, bound = assessment.flight.times, assessment.monte_carlo, assessment.bound
    with look():
        figure = new_figure(5.8, 4.8)
        both = figure.subplots(2, 1, sharex=True)
        for k, (rms, sigma, label) in enumerate(
            (
                (mc.position_rms, bound.position_sigma, "position error, m"),
                (mc.velocity_rms, bound.velocity_sigma, "velocity error, m/s"),
            )
        ):
            ax, part = both[k], slice(3 * k, 3 * k + 3)
            errors = np.linalg.norm(mc.errors[~mc.diverged, :, part], axis=2)
            if len(errors):
                low, high = (percentile(errors, percent, axis=0) for percent in (5, 95))
                ax.fill_between(
                    times, low, high, color=CYCLE[0], alpha=0.15, lw=0, label="5 to 95 % of runs"
                )
            ax.plot(times, rms, color=CYCLE[0], lw=1.6, label="rms error")
            ax.plot(times, sigma, color=CYCLE[1], lw=1.4, ls="--", label="Cramér-Rao bound")
            _logarithmic(ax)
            ax.set_ylabel(label)
        figure.axes[0].legend(fontsize=8, frameon=False, ncols=3)
        figure.axes[0].set_title(f"Navigation errors of {len(mc.errors)} runs")
        figure.axes[1].set_xlabel("time after entry, s")
    return picture(
        figure,
        "entry-navigation",
        "Navigation errors and their bound",
        "Three-dimensional errors of the filter over the Monte Carlo runs, and the posterior "
        "Cramér-Rao bound (root of the trace).",
    )


def _logarithmic(axes: Axes) -> None:
    axes.set_yscale("log")
    axes.grid(True, which="major")
    axes.grid(True, which="minor", alpha=0.35)
