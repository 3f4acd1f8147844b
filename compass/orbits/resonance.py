"""Slow pushes along circular orbits: which swing satellites to and fro, which never end.

The quick law of station-keeping: what a resonant push does in a year must be undone in that year,
whatever the box. `compass.orbits.keeping` simulates it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.bodies import MARS_ROTATION_RATE
from compass.core.resonance import along_track
from compass.orbits.gravity import GravityField
from compass.orbits.period import secular_rates

#: Strongest terms that are kept of each orbit; those after them swing a satellite by hundredths of
#: a degree even next to a resonance.
KEPT = 12


@dataclass(frozen=True)
class SlowPushes:
    """The terms of the push along the track of g circular orbits that swing satellites most.

    Attributes
    ----------
    waves
        k and m of ``2 |A| cos(k u + m node + arg A)``, shape (g, w, 2).
    pushes
        Twice the amplitude A, real and imaginary part, m/s^2, shape (g, w, 2).
    rates
        ``k u' + m node'`` with the node's rate over the ground, rad/s, shape (g, w).
    swings
        Along the track, radians, shape (g, w), the largest first.
    """

    waves: NDArray[np.float64]
    pushes: NDArray[np.float64]
    rates: NDArray[np.float64]
    swings: NDArray[np.float64]


def slow_pushes(field: GravityField, radius: ArrayLike, inclination: ArrayLike) -> SlowPushes:
    """Fourier terms of the push along circular orbits, and how far each swings a satellite.

    The potential of degree N along a circle has no wave shorter than N in either angle, so that
    2 N + 2 places a turn tell all of them.

    Parameters
    ----------
    field
        Gravity of Mars.
    radius, inclination
        Of the orbits, m and radians, shape (g,).
    """
    a, i = np.atleast_1d(radius).astype(float), np.atleast_1d(inclination).astype(float)
    size = 2 * field.degree + 2
    grid = np.empty((a.size, size, size))
    scale = field.gm / field.radius**2
    terms, highest = field.terms(), field.degree + 1
    for g in range(a.size):
        along_track(a[g], i[g], terms, highest, field.radius, scale, grid[g])
    # the half with m from 1 on; the other is its conjugate
    amplitude = np.fft.rfft2(grid)[:, :, 1 : field.degree + 1] / size**2
    k = np.fft.fftfreq(size, 1.0 / size)
    m = np.arange(1.0, field.degree + 1.0)
    node, periapsis, anomaly = secular_rates(a, 0.0, i, field.gm)
    turning = (periapsis + anomaly)[:, None, None] * k[:, None]
    over_ground = (node - MARS_ROTATION_RATE.value)[:, None, None] * m
    rate = turning + over_ground
    with np.errstate(divide="ignore", invalid="ignore"):
        swing = np.where(amplitude == 0.0, 0.0, 6.0 * abs(amplitude) / (a[:, None, None] * rate**2))
    waves = size * field.degree  # said, because of no orbit none could be told
    flat = np.argsort(-swing.reshape(a.size, waves), axis=1, kind="stable")[:, :KEPT]

    def chosen(values: NDArray) -> NDArray:
        whole = np.broadcast_to(values, swing.shape).reshape(a.size, waves)
        return np.take_along_axis(whole, flat, axis=1)

    kept = chosen(2.0 * amplitude)
    return SlowPushes(
        np.stack([chosen(k[:, None]), chosen(m)], axis=-1),
        np.stack([kept.real, kept.imag], axis=-1),
        chosen(rate),
        np.minimum(chosen(swing), 1e6),
    )
