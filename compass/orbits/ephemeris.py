"""Positions and velocities over time: two-body, with J2's secular drift, or integrated."""

from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.bodies import MARS_J2, MARS_J2_RADIUS
from compass.core.kepler import elliptic_states
from compass.errors import ArgumentError
from compass.frames import mcmf_from_mci, prime_meridian_angle
from compass.orbits.constellation import Constellation
from compass.orbits.period import secular_rates

if TYPE_CHECKING:
    import xarray as xr

MotionModel = Literal["two-body", "j2", "numerical"]


def states_mci(
    constellation: Constellation, times: ArrayLike, model: MotionModel = "two-body"
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Inertial positions (m) and velocities (m/s), each of shape (satellite, time, 3).

    Parameters
    ----------
    constellation
        The orbits.
    times
        Seconds after the constellation's epoch, shape (t,); any order, may be negative.
    model
        ``two-body``; ``j2``: mean elements drifting at J2's secular rates (elements are taken
        as mean); ``numerical``: Cowell's method with J2 by SciPy's DOP853 at 1e-12 relative
        (elements are taken as osculating).

    Raises
    ------
    ArgumentError
        The model is unknown.
    """
    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    c = constellation
    if model == "numerical":
        return _integrate(c, seconds)
    if model == "two-body":
        still = np.zeros(c.size)
        rates = (still, still, c.mean_motion)
    elif model == "j2":
        rates = secular_rates(c.semi_major_axis, c.eccentricity, c.inclination, c.gm)
    else:
        raise ArgumentError(f"model = {model!r}: allowed {', '.join(get_args(MotionModel))}")
    r, v = elliptic_states(
        c.semi_major_axis,
        c.eccentricity,
        c.inclination,
        c.raan,
        c.argument_of_periapsis,
        c.mean_anomaly,
        *rates,
        seconds,
    )
    return r, v


def positions_mci(
    constellation: Constellation, times: ArrayLike, model: MotionModel = "two-body"
) -> NDArray[np.float64]:
    """Inertial positions, metres, shape (satellite, time, 3); see `states_mci`."""
    return states_mci(constellation, times, model)[0]


def positions_mcmf(
    constellation: Constellation, times: ArrayLike, model: MotionModel = "two-body"
) -> NDArray[np.float64]:
    """Mars-fixed positions, metres, shape (satellite, time, 3); see `states_mci`."""
    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    angle = prime_meridian_angle(constellation.epoch, seconds)
    return mcmf_from_mci(positions_mci(constellation, seconds, model), angle)


def ephemeris(
    constellation: Constellation, times: ArrayLike, model: MotionModel = "two-body"
) -> "xr.Dataset":
    """Positions and velocities as a dataset over (satellite, time, axis).

    Variables ``r_mci`` (m), ``v_mci`` (m/s) and ``r_mcmf`` (m); see `states_mci`.
    """
    import xarray as xr

    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    r, v = states_mci(constellation, seconds, model)
    fixed = mcmf_from_mci(r, prime_meridian_angle(constellation.epoch, seconds))
    dims = ("satellite", "time", "axis")
    return xr.Dataset(
        {
            "r_mci": (dims, r, {"units": "m", "long_name": "position, Mars-centred inertial"}),
            "v_mci": (dims, v, {"units": "m s-1", "long_name": "velocity, Mars-centred inertial"}),
            "r_mcmf": (dims, fixed, {"units": "m", "long_name": "position, Mars-fixed"}),
        },
        coords={
            "satellite": list(constellation.satellite_names),
            "time": ("time", seconds, {"units": "s", "long_name": "time after the epoch"}),
            "axis": ["x", "y", "z"],
        },
        attrs={"constellation": constellation.name, "epoch_tdb_s_past_j2000": constellation.epoch},
    )


def acceleration_j2(r: NDArray[np.float64], gm: float) -> NDArray[np.float64]:
    """Gravity of an oblate Mars, m/s^2, at positions (..., 3) in metres with z along the pole.

    ``-GM r/|r|^3`` plus J2's ``-3/2 GM J2 R^2/|r|^5 [(1 - 5 z^2/r^2) r + 2 z e_z]``.
    """
    squared = (r * r).sum(axis=-1, keepdims=True)
    z = r[..., 2:]
    pole = np.array([0.0, 0.0, 1.0])
    factor = 1.5 * gm * MARS_J2.value * MARS_J2_RADIUS.value**2 / squared**2.5
    return -gm * r / squared**1.5 - factor * ((1 - 5 * z * z / squared) * r + 2 * z * pole)


def _integrate(
    c: Constellation, seconds: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Integrate every satellite from the epoch through all `seconds`, forwards and backwards."""
    from scipy.integrate import solve_ivp

    r0, v0 = states_mci(c, [0.0])
    start = np.concatenate([r0[:, 0], v0[:, 0]], axis=1).ravel()
    states = np.empty((seconds.size, c.size, 6))

    def derivative(_: float, flat: NDArray[np.float64]) -> NDArray[np.float64]:
        state = flat.reshape(c.size, 6)
        return np.concatenate([state[:, 3:], acceleration_j2(state[:, :3], c.gm)], axis=1).ravel()

    for sign in (1.0, -1.0):
        chosen = np.flatnonzero(seconds * sign >= 0)
        if not chosen.size:
            continue
        wanted, back = np.unique(seconds[chosen] * sign, return_inverse=True)
        solution = solve_ivp(
            derivative,
            (0.0, sign * max(wanted[-1], 1.0)),
            start,
            method="DOP853",
            t_eval=sign * wanted,
            rtol=1e-12,
            atol=1e-6,
        )
        states[chosen] = solution.y.T.reshape(-1, c.size, 6)[back]
    return np.moveaxis(states[..., :3], 0, 1), np.moveaxis(states[..., 3:], 0, 1)
