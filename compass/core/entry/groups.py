"""Named groups of what the kernels of filters take, made by one function each."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.jit import kernel

Array = NDArray[np.float64]


class Problem(NamedTuple):
    """What is to be estimated along a flight; made by `compass.entry.covariance.problem_of`.

    Attributes
    ----------
    p, bank
        Parameters of the dynamics, and bank angles (k, 2) of `compass.core.entry.flow.advance`.
    times, longest
        Epochs (t,) and the longest Runge-Kutta step, s.
    noise, walk, fade
        From the epoch before to each: roots of the process noise, (t, 6, 6) or (t, 0, 6) for
        none, variances of the further states, (t, s), and what is left of the logarithm of the
        density, (t,).
    sources, variances, kinds
        Positions and velocities (t, n, 6); variances (t, n, c), nan for what is not measured, of
        the kinds (c,) of `compass.core.entry.measure`.
    places
        Where the blocks of the state are.
    """

    p: Array
    bank: Array
    times: Array
    longest: float
    noise: Array
    walk: Array
    fade: Array
    sources: Array
    variances: Array
    kinds: NDArray[np.int64]
    places: NDArray[np.int64]


@kernel
def in_world(problem, p, bank):
    """Return the problem in another world, flown by another bank."""
    _, _, times, longest, noise, walk, fade, sources, variances, kinds, places = problem
    return Problem(
        p, bank, times, longest, noise, walk, fade, sources, variances, kinds, places
    )  # fmt: skip


class Arrangement(NamedTuple):
    """How measurements are shared among filters, and how their estimates become one.

    `apart`: one filter a beacon; `feedback`: each begins an epoch with the fused estimate; then
    `divided`: what they have in common (prior, process noise, readings without a beacon) is divided
    among them before it is added up again, so that nothing is counted twice (Carlson 1990), or
    `fading`: the prior is divided by the last weight, at least `floor` (Lou et al. 2019, eq. 22).
    `rule`: of `compass.core.entry.weights`; `scale` (s,): size of each state in which information
    is weighed; `iterations`: passes of one filter's update; `gate`: largest squared innovation over
    its variance that is believed (inf: all), from `gate_start` seconds on.
    """

    apart: bool
    feedback: bool
    divided: bool
    fading: bool
    rule: int
    floor: float
    scale: Array
    iterations: int
    gate: float
    gate_start: float


class Told(NamedTuple):
    """What a fused filter says at every epoch: (t, s), (t, s, s), (t, m), (t, n, c)."""

    xs: Array
    ps: Array
    weights: Array
    gated: NDArray[np.bool_]


class Estimates(NamedTuple):
    """Fused `x` (s,) and `P` (s, s), those of m subsystems, and the weights (m,).

    `information` (m, s, s) of each, scaled; `gated` (n, c) says which measurements the gate refused
    at this epoch, `waiting` (m,) which subsystems without feedback are dead.
    """

    x: Array
    P: Array
    local_x: Array
    local_cov: Array
    information: Array
    weights: Array
    gated: NDArray[np.bool_]
    waiting: NDArray[np.bool_]


@kernel
def make_estimates(x0, p0, m, gated):
    """Return estimates of m subsystems that all begin alike, with equal weights."""
    s = x0.size
    local_x, local_cov = np.empty((m, s)), np.empty((m, s, s))
    for i in range(m):
        local_x[i] = x0
        local_cov[i] = p0
    return Estimates(
        x0.copy(), p0.copy(), local_x, local_cov, np.zeros((m, s, s)), np.full(m, 1.0 / max(m, 1)),
        gated, np.zeros(m, dtype=np.bool_),
    )  # fmt: skip
