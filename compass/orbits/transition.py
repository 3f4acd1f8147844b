"""State transition matrices along given paths: how small errors of orbits and forces grow."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.frames import prime_meridian_angle
from compass.orbits.gravity import GravityField

Array = NDArray[Any]


def quadrupole(field: GravityField) -> Array:
    """Traceless matrix A, m^2, of ``V = GM (1/r + x'A x / r^5)``, field-fixed: J2, C22 and S22."""
    c20, c22, s22 = field.c[2, 0], field.c[2, 2], field.s[2, 2]
    zonal = 0.5 * np.sqrt(5.0) * c20 * np.diag([-1.0, -1.0, 2.0])
    factor = 3.0 * np.sqrt(10.0 / 24.0)
    sectoral = factor * np.array([[c22, s22, 0.0], [s22, -c22, 0.0], [0.0, 0.0, 0.0]])
    return np.asarray(field.radius**2 * (zonal + sectoral))


def turned_quadrupole(field: GravityField, epoch: float, times: Array) -> Array:
    """`quadrupole` in the inertial frame of the epoch, shape (t, 3, 3)."""
    angle = prime_meridian_angle(epoch, times) + field.meridian
    turn = np.zeros((len(times), 3, 3))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(angle)
    turn[:, 1, 0], turn[:, 0, 1] = np.sin(angle), -np.sin(angle)
    turn[:, 2, 2] = 1.0
    return np.asarray(turn @ quadrupole(field) @ np.swapaxes(turn, 1, 2))


def gradient(r: Array, quadrupoles: Array, gm: float) -> Array:
    """Gradient of gravity, 1/s^2, shape (n, t, 3, 3), at places (n, t, 3).

    Second derivatives of V: with q = x'Ax,
    ``GM (3 xx'/r^5 - I/r^3 + 2 A/r^5 - (10 (Ax x' + x x'A) + 5 q I)/r^7 + 35 q xx'/r^9)``.
    """
    distance = np.linalg.norm(r, axis=-1)[..., None, None]
    outer = r[..., :, None] * r[..., None, :]
    ax = np.einsum("tij,ntj->nti", quadrupoles, r)
    q = (ax * r).sum(axis=-1)[..., None, None]
    mixed = ax[..., :, None] * r[..., None, :]
    eye = np.eye(3)
    form = 3.0 * outer / distance**5 - eye / distance**3 + 2.0 * quadrupoles / distance**5
    form -= (10.0 * (mixed + np.swapaxes(mixed, -1, -2)) + 5.0 * q * eye) / distance**7
    return np.asarray(gm * (form + 35.0 * q * outer / distance**9))


def transitions(gradients: Array, step: float) -> Array:
    """State transition over every step, shape (n, k, 6, 6), from gradients at halves of steps.

    The classical Runge-Kutta step of ``F' = [[0, I], [G, 0]] F``; a step of a hundredth of a
    revolution leaves out some 1e-8 of it.

    Parameters
    ----------
    gradients
        At the ends and middles of all steps, shape (n, 2 k + 1, 3, 3), 1/s^2.
    step
        Seconds.
    """
    n, k = gradients.shape[0], (gradients.shape[1] - 1) // 2
    rate = np.zeros((*gradients.shape[:2], 6, 6))
    rate[..., :3, 3:], rate[..., 3:, :3] = np.eye(3), gradients
    start, middle, end = rate[:, 0:-1:2], rate[:, 1::2], rate[:, 2::2]
    one = np.broadcast_to(np.eye(6), (n, k, 6, 6))
    k1 = start @ one
    k2 = middle @ (one + 0.5 * step * k1)
    k3 = middle @ (one + 0.5 * step * k2)
    k4 = end @ (one + step * k3)
    return np.asarray(one + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4))


def driven(gradients: Array, push: Array, step: float) -> Array:
    """What constants that push do over every step to position and velocity, shape (n, k, 6, m).

    The Runge-Kutta step of ``X' = [[0, I], [G, 0]] X + [0; B]`` from nothing, as `transitions`.

    Parameters
    ----------
    gradients
        At the ends and middles of all steps, shape (n, 2 k + 1, 3, 3), 1/s^2.
    push
        B there: acceleration a unit of each constant, shape (n, 2 k + 1, 3, m).
    step
        Seconds.
    """

    def rate(g: Array, b: Array, x: Array) -> Array:
        return np.concatenate([x[..., 3:, :], g @ x[..., :3, :] + b], axis=-2)

    start, middle, end = (
        (gradients[:, part], push[:, part])
        for part in (slice(0, -1, 2), slice(1, None, 2), slice(2, None, 2))
    )
    none = np.zeros((*start[1].shape[:2], 6, push.shape[-1]))
    k1 = rate(*start, none)
    k2 = rate(*middle, 0.5 * step * k1)
    k3 = rate(*middle, 0.5 * step * k2)
    k4 = rate(*end, step * k3)
    return np.asarray(step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4))
