"""Orbits as the kernels of certified figures take them."""

import numpy as np
from numpy.typing import NDArray

from compass.frames import Figure
from compass.orbits import Constellation
from compass.orbits.period import secular_rates


def orbit_rows(
    c: Constellation, figure: Figure, pace: float, angle: float, rate: float, drifting: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Orbits and circles as the kernels take them, in a frame at `angle` that turns at `rate`.

    Greatest speed and acceleration: at periapsis, ``v + w r`` and ``a + 2 w v + w^2 r`` with w all
    that turns the orbit besides.
    """
    still = np.zeros(c.size)
    rates = (still, still, c.mean_motion)
    if drifting:
        rates = secular_rates(c.semi_major_axis, c.eccentricity, c.inclination, c.gm)
    a, e = c.semi_major_axis / figure.equatorial_radius, c.eccentricity
    node, periapsis, mean = (np.asarray(r) / pace for r in rates)
    node = node - rate / pace
    low, high = a * (1 - e), a * (1 + e)
    turning = np.abs(node) + np.abs(periapsis)
    speed = mean * a * np.sqrt((1 + e) / (1 - e))
    pull = mean**2 * a**3 / low**2
    orbits = np.stack(
        [
            a,
            e,
            np.cos(c.inclination),
            np.sin(c.inclination),
            c.raan - angle,
            c.argument_of_periapsis,
            c.mean_anomaly,
            node,
            periapsis,
            mean,
            (speed + turning * high) * (1 + 1e-12),
            (pull + 2 * turning * speed + turning**2 * high) * (1 + 1e-12),
        ],
        axis=1,
    )
    if not (np.all(e == 0) and np.unique(a).size == 1 and np.unique(node).size == 1):
        return orbits, np.empty((0, 6))
    if np.any(mean != 1.0) or np.any(periapsis != 0.0):
        return orbits, np.empty((0, 6))
    u = c.argument_of_periapsis + c.mean_anomaly
    co, so, ci = np.cos(orbits[:, 4]), np.sin(orbits[:, 4]), orbits[:, 2]
    towards = np.stack([co, so, 0 * co], axis=1)
    across = np.stack([-so * ci, co * ci, orbits[:, 3]], axis=1)
    cu, su = np.cos(u)[:, np.newaxis], np.sin(u)[:, np.newaxis]
    start, later = cu * towards + su * across, cu * across - su * towards
    return orbits, np.ascontiguousarray(np.hstack([start, later]) * a[:, np.newaxis])
