"""What is said of a flight and of one filter on it: sentences, tables, numbers."""

from typing import Any

import numpy as np

from compass.document.blocks import Picture, Section, Table, arranged
from compass.entry.assess import Assessment, assess
from compass.entry.state import longitude_degrees
from compass.entry.trajectory import Trajectory, fly, trajectory_dataset
from compass.errors import ArgumentError
from compass.inputs.scenario import Scenario

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


def entry_section(scenario: Scenario, found: Assessment, *, pictures: bool = True) -> Section:
    """Text, pictures and tables of one scenario."""
    drawn: tuple[Picture, ...] = ()
    if pictures:
        from compass.pictures.entry import entry_pictures

        drawn = entry_pictures(found)
    paragraphs = [" ".join(scenario.source.split())] if scenario.source.strip() else []
    words = (*paragraphs, *findings(scenario, found))
    return arranged(f"Entry: {scenario.name}", words, drawn, entry_tables(found))


def findings(scenario: Scenario, found: Assessment) -> list[str]:
    """What is to be known of a flight and its filter, in sentences."""
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
