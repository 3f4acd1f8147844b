"""Tables of a flight and of the filter on it: events, budget, loads, beacons, navigation."""

import math

import numpy as np
from numpy.typing import NDArray

from compass.document.blocks import Table
from compass.document.numbers import significant
from compass.entry.assess import Assessment
from compass.entry.trajectory import Trajectory, loads
from compass.units import KM
from compass.words import place_words


def entry_tables(assessment: Assessment) -> tuple[Table, ...]:
    """Events, loads, view, and navigation at some times."""
    flight, borne = assessment.flight, loads(assessment.flight)
    peaks = [
        (title, borne.largest(name)[0] / size, unit, borne.largest(name)[1])
        for name, title, unit, size in (
            ("g_load", "aerodynamic acceleration in standard gravities", "g", 1.0),
            ("dynamic_pressure", "dynamic pressure", "kPa", 1e3),
            ("heat_flux", "stagnation-point convective heat flux", "W/cm²", 1e4),
            ("heat_load", "heat flux integrated", "J/cm²", 1e4),
        )
    ]
    view = [
        (
            name,
            100.0 * float(assessment.seen[:, k].mean()),
            int(assessment.taken[:, k].sum()),
            _noise(assessment.range_noise, k),
        )
        for k, name in enumerate(assessment.beacons.names)
    ]
    mc, bound = assessment.monte_carlo, assessment.bound
    rows = [
        (
            float(flight.times[k]),
            int(assessment.seen[k].sum()),
            int(assessment.observability.rank[k]),
            float(assessment.observability.spherical_degree[k]),
            float(assessment.observability.degree[k]),
            float(assessment.observability.index[k]),
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
        budget_table(assessment),
        Table("Largest loads", ("quantity", "largest", "unit", "at, s"), tuple(peaks)),
        Table(
            "Beacons",
            ("beacon", "share of epochs in view, %", "epochs measured", "range noise, m"),
            tuple(view),
        ),
        *(
            [Table("Beside one-way radio", ("what", "numbers read"), assessment.readings)]
            if assessment.readings
            else []
        ),
        Table(
            # of normal errors on three axes a mean square has a relative error of at most
            # sqrt(2 / n), its root half of that
            f"Navigation ({len(mc.errors)} runs, which know rms errors to "
            f"{100 / math.sqrt(2 * len(mc.errors)):.2g} % or better, 1 sigma; "
            "delta of angles in SI, not free of latitude, and of axes in 3400 km, 100 s)",
            (
                "time, s",
                "in view",
                "rank",
                "delta of angles",
                "delta of axes",
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


def event_table(flight: Trajectory) -> Table:
    """Return what happened on the way down, in order."""
    rows = [
        (
            event.name,
            event.time,
            (event.state[0] - flight.model.planet_radius) / KM,
            float(event.state[3]),
            place_words(float(np.degrees(event.state[2])), float(np.degrees(event.state[1]))),
        )
        for event in flight.events
    ]
    return Table(
        "Events",
        ("event", "time, s", "altitude, km", "speed, m/s", "place"),
        tuple(rows),
    )


def budget_table(assessment: Assessment) -> Table:
    """What the error of the known place comes from; squares add up."""
    whole = assessment.accuracy.knowledge.along_cross_down
    variance = float(whole @ whole)
    rows = [
        (
            share.name,
            *(significant(sigma, 3) for sigma in (*share.along_cross_down, share.sigma)),
            f"{100.0 * share.sigma**2 / variance:.1f}",
        )
        for share in assessment.budget
    ]
    total = (significant(float(sigma), 3) for sigma in (*whole, math.sqrt(variance)))
    return Table(
        "Where the error of the known place comes from, 1 sigma "
        f"({assessment.accuracy.name}; squares add up)",
        ("source", "along, m", "across, m", "down, m", "all axes, m", "share of variance, %"),
        (*rows, ("all", *total, "100.0")),
    )


def _noise(sigmas: NDArray[np.float64] | None, beacon: int) -> str:
    """Noise of the ranges of one beacon, least to most."""
    if sigmas is None or not np.isfinite(sigmas[:, beacon]).any():
        return "none"
    low, high = (significant(float(f(sigmas[:, beacon])), 3) for f in (np.nanmin, np.nanmax))
    return low if low == high else f"{low} to {high}"
