"""Yu et al. 2018, orbiters: the best ones, and how they compare with ground beacons."""

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import simpson

from compass.entry.beacons import Beacons
from compass.entry.best_ground import best_ground_beacons
from compass.entry.best_orbiters import best_orbiters
from compass.entry.navigation import FilterRuns
from compass.entry.observability import observability
from compass.entry.schedule import Measurements, in_view
from compass.entry.trajectory import Trajectory, fly
from compass.entry.views import cartesian_of
from compass.papers import yu2018_case as paper
from compass.papers.verdict import Erratum, Row, claim, compare
from compass.papers.yu2018_filter import Filter, initial_covariance, run_monte_carlo


def orbiter_rows() -> list[Row]:
    """Tables 5 and 6: the best orbiters."""
    state = paper.table_5()
    ballistic = fly(paper.model(lift_to_drag=0.0), state, paper.TIMES)
    flight, beacons = paper.orbiter_flight(), paper.orbiters()
    index = observability(paper.model(), flight.states, beacons).index
    best = best_orbiters(flight, paper.ALTITUDE, starts=2)
    angles = _angles(flight, beacons)
    summed = float(simpson(index, x=paper.TIMES))
    lands = float(ballistic.events[-1].time) if ballistic.ending else np.inf
    return [
        claim(
            "Radius, speed and flight-path angle of the start, read as Mars-fixed",
            "Table 5",
            "Cartesian components",
            (state[0] / 1e3, state[3], np.degrees(state[4])),
            "km, m/s, deg",
            "6000 m/s and -15 deg to the digits printed",
            lambda _, speed, gamma: abs(speed - 6000) < 0.01 and abs(gamma + 15) < 0.001,
            shown="{:.3f}, {:.3f}, {:.4f}",
        ),
        claim(
            "Time at which a lander without lift is in the ground; with lift, time and altitude "
            "(km) at the end",
            "section 5.2",
            "a ballistic entry of 240 s",
            (lands, flight.times[-1], flight.altitude[-1] / 1e3),
            "s",
            "the first is later than 240",
            lambda without, *_: without > 240,
            shown="{:.1f}; {:.0f}, {:.2f}",
            erratum=Erratum(
                "ballistic must mean bank zero with lift, as the words beside it say",
                shown=lambda without, end, altitude: without < 240 == end and altitude > 0,
            ),
        ),
        compare(
            "Integral of det N over 240 s, orbiters of Table 6",
            "Table 6",
            "237.963",
            summed,
            "s",
            note=f"{100 * (summed / 237.963 - 1):.2f} %: {paper.NOT_PRINTED}",
        ),
        claim(
            "Integral of det N: best found; orbiters of Table 6",
            "Table 6, Figure 9",
            "the maximum",
            (best.value, summed),
            "s",
            "the first exceeds the second by no more than 0.1 %",
            lambda found, table: found <= 1.001 * table,
            shown="{:.3f}; {:.3f}",
            erratum=Erratum(
                "not the maximum: a search finds more in the same model; optima are many",
                shown=lambda found, table: 1.001 * table < found <= 240,
            ),
        ),
        claim(
            "Smallest det N of Table 6's orbiters over the entry",
            "Figure 10",
            "close to maximum at each epoch",
            float(index.min()),
            "1",
            "above 0.9 of 1",
            lambda least: 0.9 < least <= 1,
        ),
        claim(
            "Largest deviation of the angles between directions from 90 deg, orbiters",
            "Figures 9 and 11",
            "almost orthogonal throughout",
            float(np.abs(angles - 90).max()),
            "deg",
            "below 15",
            lambda off: off < 15,
        ),
        claim(
            "Range of those angles for the ground beacons of Figure 4's words; for the orbiters",
            "Figure 11",
            "change dramatically, the orbiters' hardly",
            (
                np.ptp(_angles(paper.ground_flight(), paper.ground_beacons()), axis=0).max(),
                np.ptp(angles, axis=0).max(),
            ),
            "deg",
            "three times as large",
            lambda ground, orbit: ground > 3 * orbit,
            shown="{:.1f}; {:.1f}",
        ),
    ]


def _angles(flight: Trajectory, beacons: Beacons) -> NDArray[np.float64]:
    """Angles between the three directions, degrees, shape (t, 3)."""
    line = cartesian_of(flight.states)[:, None, :3] - beacons.r
    n = line / np.linalg.norm(line, axis=2, keepdims=True)
    pairs = [(n[:, i] * n[:, j]).sum(axis=1) for i, j in ((0, 1), (0, 2), (1, 2))]
    return np.degrees(np.arccos(np.stack(pairs, axis=1)))


def comparison_rows() -> list[Row]:
    """Figure 12: 500 runs from Table 5, against the ground beacons placed for that entry."""
    flight = paper.orbiter_flight()
    by_delta = best_ground_beacons(flight, starts=2, generations=40).parameters
    by_index = best_ground_beacons(flight, objective="mean-log-index", starts=2, generations=40)
    sets = {
        "orbiters": paper.orbiters(),
        "delta-optimal ground beacons": paper.ground_beacons(by_delta),
        "ground beacons spread by mean log I": paper.ground_beacons(by_index.parameters),
    }
    results = {name: _figure_12(flight, beacons) for name, beacons in sets.items()}
    runs = {
        name: [
            errors[k] for k in (paper.at(60), -1) for errors in (mc.position_rms, mc.velocity_rms)
        ]
        for name, mc in results.items()
    }
    orbit, narrow, spread = runs.values()
    unit, shown = "m, m/s at 60 s; at 240 s", "{:.3g}, {:.3g}; {:.3g}, {:.3g}"
    where = "Figure 12"
    return [
        claim(
            f"Errors of {name}; the last of orbiters at 60 s",
            where,
            "much better performance by orbiters",
            (*errors, orbit[0]),
            unit,
            "three times those of the orbiters at 60 s",
            lambda at_60, _v, _p, _w, of_orbiters: at_60 > 3 * of_orbiters,
            shown=shown + "; {:.3g}",
            erratum=Erratum(
                "true of delta-optimal places only; well-spread ground beacons come close",
                shown=lambda at_60, _v, _p, _w, of_orbiters: at_60 < 2 * of_orbiters,
            ),
        )
        for name, errors in (
            ("delta-optimal ground beacons", narrow),
            ("ground beacons spread by mean log I", spread),
        )
    ] + [
        claim(
            "Errors of orbiters: share of the first left after 60 s, position and velocity",
            where,
            "velocity converges less quickly than position",
            (orbit[0] / (1000.0 * 3**0.5), orbit[1] / (0.5 * 3**0.5)),
            "1",
            "the first is less",
            lambda position, velocity: position < velocity,
            shown="{:.3g}, {:.3g}",
        )
    ]


def _figure_12(flight: Trajectory, beacons: Beacons) -> FilterRuns:
    measurements = Measurements(50.0)
    taken = measurements.taken(in_view(beacons, flight.states, paper.RADIUS), paper.TIMES)
    settings = Filter(initial_covariance(flight.states[0], 1000.0, 0.5), np.zeros(6))
    return run_monte_carlo(
        paper.model(), flight.states[0], beacons, taken, measurements, settings, runs=paper.RUNS
    )
