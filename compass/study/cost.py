"""Cost proxies: what a constellation costs in satellites, planes and velocity.

Every satellite starts from a circular parking orbit at the constellation's inclination, in the
plane of plane 0; or waits, several planes of a launch, until J2 has turned its node to its own.
Radiation is left out: no dose model of Mars orbits is at hand.
"""

import numpy as np
from numpy.typing import NDArray

from compass.design import Launching
from compass.inputs.study_models import CostTable
from compass.orbits.deployment import WEIGHED, cheapest_drift
from compass.orbits.impulses import hohmann, node_change
from compass.orbits.kinds import WALKER_STAR
from compass.orbits.period import secular_rates
from compass.quantities.merits import worked_out
from compass.study.candidates import PATTERNS

YEAR = 365.25 * 86400.0

#: Candidates whose waiting orbits are weighed together.
AT_ONCE = 4096


def cost_figures(
    rows: NDArray, table: CostTable, sphere_radius: float, launching: Launching | None = None
) -> dict[str, NDArray[np.float64]]:
    """Every cost figure of candidates, each of shape (n,).

    Parameters
    ----------
    rows
        Candidates, of dtype `compass.study.candidates.ROW`.
    table
        Assumptions.
    sphere_radius
        Radius to which altitudes are added, metres.
    launching
        How satellites come to their planes; by default as a design says nothing of it.
    """
    t, p = rows["satellites"].astype(float), rows["planes"].astype(float)
    radius, inclination = rows["radius_km"] * 1e3, np.radians(rows["inclination_deg"])
    star = rows["pattern"] == PATTERNS.index(WALKER_STAR.name)
    transfer = hohmann(sphere_radius + table.parking_altitude_km * 1e3, radius)
    # nodes k spread/p, k = 0 ... p - 1, turned the shorter way: the farthest and the sum
    spread = np.where(star, np.pi, 2 * np.pi)
    farthest = np.where(star, p - 1, np.floor(p / 2)) * spread / p
    plane_sum = np.zeros(t.size)
    for count, kind in {(int(a), bool(b)) for a, b in zip(p, star, strict=True)}:
        chosen = (p == count) & (star == kind)
        turns = np.arange(count) * (np.pi if kind else 2 * np.pi) / count
        moved = node_change(radius[chosen, None], inclination[chosen, None], turns)
        plane_sum[chosen] = moved.sum(axis=1)
    waits = _waiting(t, p, spread, radius, inclination, sphere_radius, launching or Launching())
    drift, _, _ = secular_rates(radius, 0.0, inclination)
    known = {
        "satellites": t,
        "planes": p,
        "delta_v_transfer_m_s": transfer,
        "delta_v_planes_m_s": node_change(radius, inclination, farthest),
        "turns_m_s": plane_sum,  # of one satellite of each plane, together
        "node_drift_deg_year": np.abs(np.degrees(drift) * YEAR),
    }
    return worked_out("cost", known | waits)


def _waiting(
    satellites: NDArray[np.float64],
    planes: NDArray[np.float64],
    spread: NDArray[np.float64],
    radius: NDArray[np.float64],
    inclination: NDArray[np.float64],
    sphere_radius: float,
    launching: Launching,
) -> dict[str, NDArray[np.float64]]:
    """What it costs a satellite to wait for its plane, and for how long."""
    most = launching.satellites_a_launch
    of_launch = satellites if most is None else np.full(satellites.size, float(most))
    together = np.clip(np.floor(of_launch * planes / satellites), 1, planes)
    low, high = launching.waiting
    waiting = sphere_radius + np.linspace(low, high, WEIGHED)
    launched = sphere_radius + launching.launched
    cost, wait = np.empty((2, satellites.size))
    for start in range(0, satellites.size, AT_ONCE):
        some = slice(start, start + AT_ONCE)
        cost[some], wait[some] = cheapest_drift(
            radius[some],
            inclination[some],
            (spread / planes)[some],
            together[some],
            launched,
            waiting,
            launching.longest_wait,
        )
    return {"delta_v_deploy_m_s": cost, "wait_days": wait / 86400.0}
