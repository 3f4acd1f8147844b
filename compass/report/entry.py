"""The report of an entry: flight, view, observability, bound and filter."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from compass.entry.assess import Assessment, assess
from compass.entry.beacons import Beacons
from compass.entry.state import longitude_degrees
from compass.entry.trajectory import Trajectory, fly, trajectory_dataset
from compass.entry.visible_area import VisibleArea, horizon
from compass.errors import ArgumentError
from compass.frames import latitude_longitude
from compass.inputs.scenario import Scenario
from compass.report.section import Picture, Section, Table, picture
from compass.report.style import CYCLE, FAINT, INK, MARS, SKY, look, new_figure

KM = 1e3

#: Nearer to the polar axis than so many sigmas, a filter of longitudes goes astray.
NEAR_POLE = 10.0


def assess_scenario(scenario: Scenario, runs: int | None = None) -> Assessment:
    """Fly a scenario's truth and assess its navigation; `runs` instead of the scenario's.

    Raises
    ------
    ArgumentError
        A flight that ends before its second time, or a beacon at the lander's place.
    """
    flight = fly(scenario.truth, scenario.state, scenario.times, triggers=scenario.triggers)
    if flight.times.size < 2:
        raise ArgumentError(f"{scenario.label}: {flight.ending}; nothing to navigate")
    return assess(
        scenario.model,
        flight,
        scenario.beacons(flight.times),
        scenario.measurements,
        scenario.settings,
        mask=scenario.mask,
        runs=scenario.runs if runs is None else runs,
        seed=scenario.seed,
    )


def entry_section(scenario: Scenario, found: Assessment) -> Section:
    """Text, pictures and tables of one scenario."""
    paragraphs = [" ".join(scenario.source.split())] if scenario.source.strip() else []
    return Section(
        f"Entry: {scenario.name}",
        (*paragraphs, *_findings(scenario, found)),
        entry_pictures(found),
        entry_tables(found),
    )


def _findings(scenario: Scenario, found: Assessment) -> list[str]:
    flight, mc = found.flight, found.monte_carlo
    last = flight.times[-1]
    count = found.seen.sum(axis=1)
    words = [
        f"The lander flies {last:g} s, from {flight.altitude[0] / KM:.1f} km and "
        f"{flight.states[0, 3]:.0f} m/s to {flight.altitude[-1] / KM:.1f} km and "
        f"{flight.states[-1, 3]:.0f} m/s. Between {count.min()} and {count.max()} of "
        f"{found.beacons.size} beacons are in view."
    ]
    if flight.ending:
        words.append(f"The flight ended early: {flight.ending}.")
    when = f"at {flight.times[found.blind_epoch]:g} s"
    if found.blind.words:
        hidden = "; ".join(found.blind.words)
        words.append(
            f"Not everything can be seen {when}: the observability matrix has rank "
            f"{found.blind.rank} of 6. Hidden: {hidden}."
        )
    else:
        words.append(
            f"Position and velocity are observable throughout; worst {when}, where the weakest "
            f"direction is {found.blind.weakest}."
        )
    if not found.taken.any():
        words.append("No beacon is ever measured: the errors are those of the first estimate.")
    if mc.diverged.any():
        words.append(f"{mc.diverged.sum()} of {len(mc.errors)} runs diverged and are left out.")
    if mc.broken.any():
        words.append(
            f"In {mc.broken.sum()} of {len(mc.errors)} runs the filter's covariance did not stay "
            "positive definite: the NEES is undefined from there on, and the filter not to be "
            "trusted."
        )
    # metres from the polar axis, against those by which the estimate may be off
    r, latitude = flight.states[:, 0], flight.states[:, 2]
    axis, unsure = r * np.cos(latitude), found.bound.position_sigma.copy()
    spread = np.diag(scenario.settings.covariance0)[:3] * [1.0, axis[0] ** 2, r[0] ** 2]
    unsure[0] = np.sqrt(spread.sum())  # before the first measurement
    if (near := axis < NEAR_POLE * unsure).any():
        first = int(np.argmax(near))
        words.append(
            f"At {flight.times[first]:g} s the lander is {axis[first] / KM:.3g} km from the polar "
            f"axis, its position known to {unsure[first] / KM:.3g} km: the filter estimates "
            "longitude and heading, which are undefined at a pole, so its errors say little."
        )
    return words


def event_table(flight: Trajectory) -> Table:
    """Return what happened on the way down, in order."""
    rows = [
        (
            event.name,
            event.time,
            (event.state[0] - flight.model.planet_radius) / KM,
            float(event.state[3]),
            float(np.degrees(event.state[2])),
            float(longitude_degrees(event.state[1])),
        )
        for event in flight.events
    ]
    return Table(
        "Events",
        ("event", "time, s", "altitude, km", "speed, m/s", "latitude, deg", "longitude, deg"),
        tuple(rows),
    )


def entry_tables(found: Assessment) -> tuple[Table, ...]:
    """Events, loads, view, and navigation at some times."""
    flight, data = found.flight, trajectory_dataset(found.flight)
    peaks = [
        (
            str(data[name].attrs["long_name"]),
            float(data[name].max()),
            unit,
            float(data[name].idxmax()),
        )
        for name, unit in (
            ("g_load", "g"),
            ("dynamic_pressure", "Pa"),
            ("heat_flux", "W/m^2"),
            ("heat_load", "J/m^2"),
        )
    ]
    view = [
        (name, float(found.seen[:, k].mean()), int(found.taken[:, k].sum()))
        for k, name in enumerate(found.beacons.names)
    ]
    mc, bound = found.monte_carlo, found.bound
    rows = [
        (
            float(flight.times[k]),
            int(found.seen[k].sum()),
            int(found.observability.rank[k]),
            float(found.observability.degree[k]),
            float(found.observability_scaled.degree[k]),
            float(found.observability.index[k]),
            float(bound.position_sigma[k]),
            float(mc.position_rms[k]),
            float(bound.velocity_sigma[k]),
            float(mc.velocity_rms[k]),
            float(mc.mean_nees[k]),
        )
        for k in np.unique(np.linspace(0, flight.times.size - 1, 9).round().astype(int))
    ]
    events = (event_table(flight),) if flight.events else ()
    return (
        *events,
        Table("Largest loads", ("quantity", "largest", "unit", "at, s"), tuple(peaks)),
        Table("Beacons", ("beacon", "share of time in view", "epochs measured"), tuple(view)),
        Table(
            f"Navigation ({len(mc.errors)} runs; delta in m, s, rad and with 3400 km, 100 s)",
            (
                "time, s",
                "in view",
                "rank",
                "delta SI",
                "delta scaled",
                "index I",
                "bound, m",
                "rms error, m",
                "bound, m/s",
                "rms error, m/s",
                "NEES (6)",
            ),
            tuple(rows),
        ),
    )


def entry_pictures(found: Assessment) -> tuple[Picture, ...]:
    """All pictures of an assessment."""
    return (
        _map_picture(found.flight, found.beacons),
        _flight_picture(found.flight),
        _view_picture(found),
        _observability_picture(found),
        _navigation_picture(found),
    )


def _map_picture(flight: Trajectory, beacons: Beacons) -> Picture:
    with look():
        figure = new_figure(7.5, 5.2)
        draw_map(figure.add_subplot(), flight, beacons)
        figure.legend(fontsize=8, frameon=False, loc="outside right upper")
    return picture(
        figure,
        "entry-map",
        "Ground track, visible area and beacons",
        "Ground track, the rims of what sees the lander at the start and at the end (dashed), and "
        "the area that sees it all the way (shaded, if there is one).",
    )


def draw_map(axes: Axes, flight: Trajectory, beacons: Beacons) -> None:
    """Draw ground track, visible area and the beacons that stand near it into plain axes."""
    lon0 = np.degrees(flight.states[:, 1].mean())

    def degrees(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        lat, lon = latitude_longitude(points)
        return lon0 + (np.degrees(lon) - lon0 + 180) % 360 - 180, np.degrees(lat)

    for epoch, label in ((0, "sees the start"), (-1, "sees the end")):
        lon, lat = degrees(horizon(flight, epoch))
        colour = FAINT if epoch == 0 else INK
        axes.plot(lon, lat, "--", color=colour, lw=1, label=label)
    try:
        lon, lat = degrees(VisibleArea(flight).outline())
        axes.fill(lon, lat, color=SKY, alpha=0.18, lw=0, label="sees all of it")
    except ArgumentError:
        pass  # no such area: nothing to shade
    lon, lat = np.degrees(flight.states[:, 1]), np.degrees(flight.states[:, 2])
    axes.plot(lon, lat, color=MARS, lw=2, label="ground track")
    axes.plot(lon[0], lat[0], "o", color=MARS, ms=5)
    axes.plot(lon[-1], lat[-1], ">", color=MARS, ms=7)
    near = ~beacons.moving
    if near.any():
        lon, lat = degrees(beacons.r[0, near])
        axes.plot(lon, lat, "^", color=INK, ms=7, label="ground beacons")
        for x, y, k in zip(lon, lat, np.flatnonzero(near), strict=True):
            place = (5, 4) if k % 2 == 0 else (5, -11)  # neighbours on different sides
            axes.annotate(beacons.names[k], (x, y), place, textcoords="offset points", fontsize=8)
    axes.set_xlabel("east longitude, degrees")
    axes.set_ylabel("latitude, degrees")
    axes.set_aspect(1 / np.cos(flight.states[:, 2].mean()), adjustable="datalim")
    axes.grid(True)
    axes.set_title("Where the lander flies and who sees it")


def _flight_picture(flight: Trajectory) -> Picture:
    data = trajectory_dataset(flight)
    with look():
        figure = new_figure(8.0, 5.0)
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
                textcoords="offset points", fontsize=7.5, color=INK,
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


def _view_picture(found: Assessment) -> Picture:
    names, times = found.beacons.names, found.flight.times
    with look():
        figure = new_figure(8.0, 1.4 + 0.24 * max(3, len(names)))
        axes = figure.add_subplot()
        step = times[1] - times[0]
        for k in range(len(names)):
            runs = np.flatnonzero(np.diff(np.concatenate([[0], found.seen[:, k], [0]])))
            bars = [
                (times[a], max(times[b - 1] - times[a], step))
                for a, b in zip(runs[::2], runs[1::2], strict=True)
            ]
            axes.broken_barh(bars, (k - 0.35, 0.7), color=SKY)
        axes.set_yticks(range(len(names)), names, fontsize=8)
        axes.set_ylim(len(names) - 0.4, -0.6)
        axes.set_xlim(times[0], times[-1])
        axes.set_xlabel("time after entry, s")
        axes.grid(True, axis="x")
        axes.set_title("Beacons in view")
    return picture(
        figure, "entry-view", "Beacons in view over time", "Line of sight past the planet's sphere."
    )


def _observability_picture(found: Assessment) -> Picture:
    times = found.flight.times
    with look():
        figure = new_figure(8.0, 5.0)
        upper, lower = figure.subplots(2, 1, sharex=True)
        for result, label, colour in (
            (found.observability, "metres, seconds, radians", CYCLE[0]),
            (found.observability_scaled, "lengths in 3400 km, times in 100 s", CYCLE[1]),
        ):
            # beyond full rank only rounding is left to show
            degree = np.where(result.rank == 6, result.degree, np.nan)
            upper.plot(times, degree, color=colour, lw=1.8, label=label)
        _logarithmic(upper)
        upper.set_ylabel("degree δ")
        upper.legend(fontsize=8, frameon=False)
        upper.set_title("How well the state is observable")
        lower.plot(times, found.observability.index, color=CYCLE[2], lw=1.8)
        lower.set_ylabel("geometric index I")
        lower.set_ylim(bottom=0)
        lower.grid(True)
        lower.set_xlabel("time after entry, s")
    return picture(
        figure,
        "entry-observability",
        "Observability degree and geometric index over time",
        "Above: smallest over largest singular value of the exact observability matrix of the "
        "beacons in view, in two systems of units (gaps: rank below 6). Below: sum over triples "
        "of beacons of [n_i . (n_j x n_k)]^2.",
    )


def _navigation_picture(found: Assessment) -> Picture:
    times, mc, bound = found.flight.times, found.monte_carlo, found.bound
    with look():
        figure = new_figure(8.0, 5.4)
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
                low, high = np.percentile(errors, [5, 95], axis=0)
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


def entry_facts(scenario: Scenario, found: Assessment) -> dict[str, Any]:
    """Return the numbers as one JSON object, names with their units."""
    flight, mc, bound = found.flight, found.monte_carlo, found.bound
    finest = found.observability_scaled
    return {
        "scenario": scenario.name,
        "rotation": flight.model.rotation,
        "ending": flight.ending,
        "events": [
            {
                "name": event.name,
                "time_s": event.time,
                "altitude_km": (event.state[0] - flight.model.planet_radius) / KM,
                "speed_m_s": event.state[3],
                "latitude_deg": np.degrees(event.state[2]),
                "longitude_deg": longitude_degrees(event.state[1]),
            }
            for event in flight.events
        ],
        "end": {
            "time_s": flight.times[-1],
            "altitude_km": flight.altitude[-1] / KM,
            "speed_m_s": flight.states[-1, 3],
            "latitude_deg": np.degrees(flight.states[-1, 2]),
            "longitude_deg": longitude_degrees(flight.states[-1, 1]),
            "flight_path_deg": np.degrees(flight.states[-1, 4]),
        },
        "beacons": list(found.beacons.names),
        "in_view_share": found.seen.mean(axis=0),
        "in_view": {
            "min": found.seen.sum(axis=1).min(),
            "max": found.seen.sum(axis=1).max(),
        },
        "observability": {
            "rank_min": found.observability.rank.min(),
            "degree_si_min": found.observability.degree.min(),
            "degree_scaled_min": finest.degree.min(),
            "index_mean": found.observability.index.mean(),
            "worst_time_s": flight.times[found.blind_epoch],
            "hidden": list(found.blind.words),
            "weakest": found.blind.weakest,
        },
        "navigation": {
            "time_s": flight.times,
            "position_bound_m": bound.position_sigma,
            "velocity_bound_m_s": bound.velocity_sigma,
            "position_rms_m": mc.position_rms,
            "velocity_rms_m_s": mc.velocity_rms,
            "nees": mc.mean_nees,
            "runs": len(mc.errors),
            "diverged": int(mc.diverged.sum()),
            "broken": int(mc.broken.sum()),
        },
    }
