"""Cost proxies: what a constellation costs in satellites, planes and velocity.

Every satellite starts from a circular parking orbit at the constellation's inclination, in the
plane of plane 0. Radiation is left out: no dose model of Mars orbits is at hand.

References
----------
.. [1] Vallado 2013, Fundamentals of Astrodynamics and Applications, 4th ed., algorithm 36
   (Hohmann transfer) and section 6.4 (change of the node alone).
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.bodies import MARS_GM
from compass.inputs.study_models import CostTable
from compass.orbits.kinds import WALKER_STAR
from compass.orbits.period import secular_rates
from compass.study.candidates import PATTERNS

YEAR = 365.25 * 86400.0


def hohmann(start: ArrayLike, end: ArrayLike, gm: float = MARS_GM.value) -> NDArray[np.float64]:
    """Both impulses of a Hohmann transfer between coplanar circles, m/s.

    ``|v_p - sqrt(GM/r1)| + |sqrt(GM/r2) - v_a|`` with the vis-viva speeds v_p, v_a of the
    transfer ellipse, whose semi-major axis is (r1 + r2)/2 [1]_.

    Parameters
    ----------
    start, end
        Radii r1 and r2, metres.
    gm
        m^3/s^2.
    """
    r1, r2 = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    first = np.sqrt(gm / r1) * np.abs(np.sqrt(2 * r2 / (r1 + r2)) - 1)
    second = np.sqrt(gm / r2) * np.abs(1 - np.sqrt(2 * r1 / (r1 + r2)))
    return np.asarray(first + second)


def node_change(
    radius: ArrayLike, inclination: ArrayLike, turn: ArrayLike, gm: float = MARS_GM.value
) -> NDArray[np.float64]:
    """Impulse that turns the node of a circular orbit, inclination kept, m/s.

    The planes lie theta apart, ``sin(theta/2) = sin i |sin(dRAAN/2)|``, and the impulse at
    their common line is ``2 v sin(theta/2)`` [1]_.

    Parameters
    ----------
    radius, inclination, turn
        Metres; radians.
    gm
        m^3/s^2.
    """
    half = np.sin(inclination) * np.abs(np.sin(np.asarray(turn, dtype=float) / 2))
    return np.asarray(2 * np.sqrt(gm / np.asarray(radius, dtype=float)) * half)


def cost_figures(
    rows: NDArray, table: CostTable, sphere_radius: float
) -> dict[str, NDArray[np.float64]]:
    """Every cost figure of candidates, each of shape (n,).

    Parameters
    ----------
    rows
        Candidates, of dtype `compass.study.candidates.ROW`.
    table
        Assumptions.
    sphere_radius
        Radius to which the parking altitude is added, metres.
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
    drift, _, _ = secular_rates(radius, 0.0, inclination)
    return {
        "satellites": t,
        "planes": p,
        "delta_v_transfer_m_s": transfer,
        "delta_v_planes_m_s": node_change(radius, inclination, farthest),
        "delta_v_total_m_s": t * transfer + t / p * plane_sum,
        "node_drift_deg_year": np.abs(np.degrees(drift) * YEAR),
    }
