"""Named groups of what the kernels of fused filters take, made by one function each."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.rates import COLUMNS
from compass.core.jit import kernel

Array = NDArray[np.float64]


class Arrangement(NamedTuple):
    """How measurements are shared among filters, and how their estimates become one.

    `apart`: one filter a beacon; `feedback`: each begins an epoch with the fused estimate; then
    `divided`: what they have in common (prior, process noise, accelerometers) is divided among
    them before it is added up again, so that nothing is counted twice (Carlson 1990), or `fading`:
    the prior is divided by the last weight, at least `floor` (Lou et al. 2019, eq. 22). `rule`: of
    `compass.core.entry.weights`; `scale` (s,): size of each state in which information is weighed;
    `iterations`: passes of one filter's update; `gate`: largest squared innovation over its
    variance that is believed (inf: all), from `gate_start` seconds on.
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


class Knowledge(NamedTuple):
    """The world as the filters know it, as in `compass.core.entry.filter.filter_run`.

    `walk` is the variance per second of the states behind the first six; `sources` (t, n, 6) and
    `kinds` (c,) are those of `compass.entry.schedule.Measurements.heard`, beacons first.
    """

    p: Array
    bank: Array
    times: Array
    longest: float
    noise: Array
    walk: Array
    sources: Array
    kinds: NDArray[np.int64]
    places: NDArray[np.int64]


class Heard(NamedTuple):
    """What comes at every epoch, or at one.

    `z`, `variances` (t, 3 + n c): measurements and their variances, nan for what does not come:
    accelerometers, then every kind of every source, of which the first m are the beacons; `alive`
    (t, m): which subsystems work.
    """

    z: Array
    variances: Array
    alive: NDArray[np.bool_]


class World(NamedTuple):
    """Added to the logarithm of the density and to L/D that the filters know."""

    thicker: float
    lift: float


class Told(NamedTuple):
    """What a fused filter says at every epoch: (t, s), (t, s, s), (t, m), (t, 3 + n c)."""

    xs: Array
    ps: Array
    weights: Array
    gated: NDArray[np.bool_]


class Estimates(NamedTuple):
    """Fused `x` (s,) and `P` (s, s), those of m subsystems, and the weights (m,).

    `gated` (3 + n c,) says which rows the gate refused at this epoch, `waiting` (m,) which
    subsystems without feedback are dead.
    """

    x: Array
    P: Array
    local_x: Array
    local_cov: Array
    weights: Array
    gated: NDArray[np.bool_]
    waiting: NDArray[np.bool_]


class Room(NamedTuple):
    """Scratch: what every epoch writes before it reads."""

    after: Array
    phi: Array
    half: Array
    noise: Array
    walk: Array
    rows: Array
    h: Array
    used: NDArray[np.bool_]
    gain: Array
    shift: Array
    before: Array
    point: Array
    prior: Array
    information: Array


@kernel
def make_estimates(x0, p0, m, rows):
    """Return estimates of m subsystems that all begin alike, with equal weights."""
    s = x0.size
    local_x, local_cov = np.empty((m, s)), np.empty((m, s, s))
    for i in range(m):
        local_x[i] = x0
        local_cov[i] = p0
    return Estimates(
        x0.copy(), p0.copy(), local_x, local_cov, np.full(m, 1.0 / max(m, 1)),
        np.zeros(rows, dtype=np.bool_), np.zeros(m, dtype=np.bool_),
    )  # fmt: skip


@kernel
def make_room(s, m, rows):
    """Return scratch for s states, m subsystems and so many rows of measurements."""
    return Room(
        np.empty(6), np.empty((6, COLUMNS)), np.empty((s, s)), np.empty((6, 6)), np.empty(s),
        np.zeros((rows, s)), np.zeros(rows), np.zeros(rows, dtype=np.bool_), np.empty(s),
        np.empty(s), np.empty(s), np.empty(s), np.empty((s, s)), np.zeros((m, s, s)),
    )  # fmt: skip
