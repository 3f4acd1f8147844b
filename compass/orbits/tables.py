"""Trajectories through tables of states, with an estimate of what lies between the rows."""

from collections.abc import Sequence

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from compass.errors import DesignError
from compass.orbits.trajectory import Trajectory

#: Nodes at which an interpolant is turned into a Legendre series: exact to degree 15.
NODES = 16

#: Largest estimated error of an interpolation, m, above which a table is refused: at an
#: areosynchronous satellite a degree-scale proof would rest on 3 thousandths of a degree.
COARSE = 1000.0


def from_tables(
    times: Sequence[NDArray[np.float64]],
    states: Sequence[NDArray[np.float64]],
    degrees: Sequence[int],
    *,
    epoch: float,
    satellite_names: Sequence[str],
    source: str,
) -> Trajectory:
    """Trajectory that passes through tables of states, over the time all of them cover.

    Between two rows it is the Hermite polynomial (positions and velocities) of the asked degree
    through the nearest rows, half of them on either side. Its error is estimated by leaving out
    every other row: the interpolant through the rest misses the rows left out by more than the one
    through all misses what lies between them, some 2^(d+1) times more. The larger miss is taken.

    Parameters
    ----------
    times
        Seconds after the epoch, increasing; one array a satellite.
    states
        Inertial positions and velocities, m and m/s, shape (t, 6).
    degrees
        Of the interpolation.
    epoch, satellite_names, source
        As in `Trajectory`.

    Raises
    ------
    DesignError
        A table too coarse for its degree: the estimated error is above `COARSE`.
    """
    start, stop = max(t[0] for t in times), min(t[-1] for t in times)
    inner = np.concatenate([t[(t > start) & (t < stop)] for t in times])
    breaks = np.concatenate([[start], np.unique(np.round(inner, 6)), [stop]])
    breaks = breaks[np.concatenate([[True], np.diff(breaks) > 1e-5])]
    breaks[-1] = stop
    nodes, weights = legendre.leggauss(NODES)
    to_series = (np.arange(NODES) + 0.5)[:, None] * (
        legendre.legvander(nodes, NODES - 1).T * weights
    )
    middle, half = 0.5 * (breaks[1:] + breaks[:-1]), 0.5 * np.diff(breaks)
    wanted = (middle[:, None] + half[:, None] * nodes).ravel()
    paths = np.empty((len(middle), len(times), 3, NODES))
    errors = np.empty((len(middle), len(times)))
    for s, (t, x, degree) in enumerate(zip(times, states, degrees, strict=True)):
        # a table that ends on an odd row keeps its last one, so that nothing is extrapolated
        rest = np.unique(np.append(np.arange(0, len(t), 2), len(t) - 1))
        left_out = np.setdiff1d(np.arange(len(t)), rest)
        guess = hermite(t[rest], x[rest], degree, t[left_out])
        miss = np.linalg.norm(guess - x[left_out, :3], axis=-1)
        worst = float(miss.max(initial=0.0))
        if worst > COARSE:
            raise DesignError(
                f"{satellite_names[s]}: states {np.median(np.diff(t)) / 60:.4g} min apart are too "
                f"coarse for interpolation of degree {degree}: without every other one it misses "
                f"by {worst / 1e3:.3g} km (allowed {COARSE / 1e3:g}); give more states or a higher "
                "degree"
            )
        errors[:, s] = _nearby(t[left_out], miss, middle) if miss.size else COARSE
        moved = hermite(t, x, degree, wanted).reshape(len(middle), NODES, 3)
        paths[:, s] = np.einsum("kj,pjc->pck", to_series, moved)
    errors += 1e-9 * np.abs(paths).sum(axis=(-1, -2))
    return Trajectory(
        breaks,
        np.ascontiguousarray(paths),
        errors,
        epoch,
        tuple(satellite_names),
        source,
        f"interpolation error of up to {errors.max():.3g} m, by leaving out every other state",
    )


def _nearby(
    at: NDArray[np.float64], miss: NDArray[np.float64], middle: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Largest of the three misses nearest to each stretch."""
    k = np.clip(np.searchsorted(at, middle), 0, len(at) - 1)
    low, high = np.maximum(k - 1, 0), np.minimum(k + 1, len(at) - 1)
    return np.maximum(np.maximum(miss[low], miss[k]), miss[high])


def hermite(
    times: NDArray[np.float64],
    states: NDArray[np.float64],
    degree: int,
    wanted: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Positions by Hermite interpolation in moving windows, shape (w, 3).

    Newton's divided differences over ``(degree + 1) / 2`` rows, each taken twice: the first
    difference of a row with itself is its velocity.

    Parameters
    ----------
    times, states
        Rows; s, m and m/s, shapes (t,) and (t, 6).
    degree
        Highest degree; an even one counts as the odd one below.
    wanted
        Seconds, shape (w,).
    """
    points = min(max((degree + 1) // 2, 1), len(times))
    k = np.clip(np.searchsorted(times, wanted, side="right") - 1, 0, len(times) - 2)
    first = np.clip(k - (points // 2 - 1), 0, len(times) - points)
    rows = first[:, None] + np.arange(points)
    scale = np.median(np.diff(times))
    t = np.repeat((times[rows] - wanted[:, None]) / scale, 2, axis=1)
    table = np.repeat(states[rows, :3], 2, axis=1)
    order = table.shape[1]
    newton = [table[:, 0]]
    for level in range(1, order):
        gap = (t[:, level:] - t[:, :-level])[..., None]
        step = table[:, 1:] - table[:, :-1]
        if level == 1:
            speeds = np.repeat(states[rows, 3:] * scale, 2, axis=1)[:, :-1]
            table = np.where(gap == 0.0, speeds, step / np.where(gap == 0.0, 1.0, gap))
        else:
            table = step / gap
        newton.append(table[:, 0])
    value = newton[-1]
    for level in range(order - 2, -1, -1):
        value = newton[level] - t[:, level, None] * value
    return value
