"""Many entries past a constellation: flights with sensitivities, and bounds at their ends.

Errors are carried in prior-whitened coordinates u of d components: the error of position, velocity,
density and lift at any epoch is ``S u`` with ``S S^T`` the prior moved to that epoch, so u has the
unit matrix as its prior covariance. Without process noise u is constant through the entry and
information about it simply adds up, satellite by satellite; losing one is leaving out its share.
Matrices of information are kept packed: the d (d + 1)/2 entries of the lower triangle, row by row.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.dop853 import WATCH_RADIUS, WATCH_SPEED, watched
from compass.core.entry.flow import advance_transition
from compass.core.entry.rates import COLUMNS, LIFT, World
from compass.core.jit import fast_kernel, kernel
from compass.core.smallmatrix import cholesky, matmul

Array = NDArray[np.float64]

#: What a satellite's errors do to what is measured, a number each: its radial, its along and its
#: cross error; its clock and the bias of its ranges, which no range tells apart.
WAYS = 4


class Worlds(NamedTuple):
    """How the world of each of m entries differs from the one that is flown in.

    `offsets` (m, 2) are added to the logarithm of the density and to L/D; `spreads` (m, 8, d) are S
    at entry: of position, velocity, logarithm of the density and L/D; `banks` (m, k, 2) are times
    and angles of each entry's bank, as in `compass.core.entry.flow.advance`.
    """

    offsets: Array
    spreads: Array
    banks: Array


class Ending(NamedTuple):
    """Where flights end: at the first epoch at which what is watched is at or below the level.

    `watch` is a number of `compass.core.entry.dop853.watched`, -1 for the last epoch; below the
    radius `ground`, metres, the flight has failed.
    """

    watch: int
    level: float
    ground: float


class Flights(NamedTuple):
    """Flights of m entries at t epochs.

    `paths` (m, t, 6) are positions and velocities, `gains` (m, t, 6, d) their derivatives in u;
    `stops` (m,) the index of the last epoch, ``-1 - t`` where the flight failed at epoch t.
    """

    paths: Array
    gains: Array
    stops: NDArray[np.int64]


@kernel
def fly_many(starts, worlds, p, times, longest, ending, flights):
    """Fly every entry to its end, with the derivative of every flight.

    Parameters
    ----------
    starts
        Positions and velocities at entry, shape (m, 6).
    worlds
        `Worlds`.
    p, longest
        As in `compass.core.entry.flow.advance`.
    times
        Epochs, s, shape (t,).
    ending
        `Ending`.
    flights
        Output, `Flights`.
    """
    offsets, spreads, banks = worlds
    watch, level, ground = ending
    paths, gains, stops = flights
    size, last = spreads.shape[2], times.size - 1
    phi, spread = np.empty((6, COLUMNS)), np.empty((COLUMNS, size))
    for m in range(starts.shape[0]):
        paths[m, 0] = starts[m]
        world = World(p, offsets[m, 0], p[LIFT] + offsets[m, 1])
        spread[:, :] = spreads[m]
        stops[m] = last
        for t in range(last + 1):
            here, gain = paths[m, t], gains[m, t]
            if t > 0:
                advance_transition(
                    paths[m, t - 1], world, banks[m], times[t - 1], times[t], longest, here, phi
                )
                matmul(phi, spread, gain)
                spread[:6] = gain
            else:
                gain[:] = spread[:6]
            high, fast = watched(here, WATCH_RADIUS, p), watched(here, WATCH_SPEED, p)
            if not (high > ground and fast > 0.0):
                stops[m] = -1 - t
                break
            if watch >= 0 and watched(here, watch, p) <= level:
                stops[m] = t
                break


@fast_kernel
def add_square(h, weight, out, m, i):
    """Add ``weight h h^T`` to a packed matrix."""
    k = 0
    for a in range(h.size):
        scaled = weight * h[a]
        for b in range(a + 1):
            out[m, i, k + b] += scaled * h[b]
        k += a + 1


@kernel
def take_out(told, erring, packed):
    """Take from packed information what errors cost that are found out as far as they can be.

    That is ``F_ue (I + F_ee)^-1 F_eu``; `told` (d, e) and `erring` (e, e), F_ue and F_ee of errors
    that are whitened, are spoilt.
    """
    size, errors = told.shape
    for e in range(errors):
        erring[e, e] += 1.0
    cholesky(erring, erring)
    k = 0
    for a in range(size):
        for e in range(errors):  # L^-1 of it, so that what is taken is a square
            for j in range(e):
                told[a, e] -= erring[e, j] * told[a, j]
            told[a, e] /= erring[e, e]
        for b in range(a + 1):
            for e in range(errors):
                packed[k] -= told[a, e] * told[b, e]
            k += 1


@kernel
def bounds(shares, own, ends, out):
    """Posterior sigma of position (m) and velocity (m/s) at the end of each entry.

    Parameters
    ----------
    shares
        Information of each satellite, (m, n, d (d + 1)/2).
    own
        And of what needs none, (m, 1, d (d + 1)/2).
    ends
        Gains B of `fly_many` at the end, (m, 6, d).
    out
        Output, (m, 1 + n, 2): with all satellites, then without each of them. Roots of the
        traces of the parts of ``B (I + F)^-1 B^T``.
    """
    n, size = shares.shape[1], ends.shape[2]
    low, y, packed = np.empty((size, size)), np.empty(size), np.empty(shares.shape[2])
    for m in range(shares.shape[0]):
        for lost in range(-1, n):
            k = 0
            for a in range(size):
                for b in range(a + 1):
                    total = own[m, 0, k] + (1.0 if a == b else 0.0)
                    for i in range(n):
                        if i != lost:
                            total += shares[m, i, k]
                    packed[k] = total
                    k += 1
            bound(packed, ends[m], low, y, out[m, 1 + lost])


@kernel
def bound(packed, gain, low, y, out):
    """Roots of the traces of the position and velocity parts of ``B A^-1 B^T``.

    A, packed, is the prior's unit matrix and the information; B, `gain`, is (6, d); `low` (d, d)
    and `y` (d,) are scratch.
    """
    size = y.size
    k = 0
    # Cholesky; every eigenvalue is at least 1
    for a in range(size):
        for b in range(a + 1):
            total = packed[k]
            for c in range(b):
                total -= low[a, c] * low[b, c]
            low[a, b] = math.sqrt(total) if a == b else total / low[b, b]
            k += 1
    for part in range(2):
        trace = 0.0
        for i in range(3 * part, 3 * part + 3):
            for a in range(size):
                total = gain[i, a]
                for c in range(a):
                    total -= low[a, c] * y[c]
                y[a] = total / low[a, a]
                trace += y[a] * y[a]
        out[part] = math.sqrt(trace)


@kernel
def count_in_view(seen, stops, out):
    """How often so many satellites are in view, over all entries and epochs up to deployment.

    Parameters
    ----------
    seen, stops
        Of `compass.core.entry.information.information` and `fly_many`.
    out
        Output, (1 + n, n + 1): times that 0 to n are in view, with all satellites and without
        each of them.
    """
    n = seen.shape[2]
    for m in range(seen.shape[0]):
        for t in range(stops[m] + 1):
            count = 0
            for i in range(n):
                count += seen[m, t, i]
            out[0, count] += 1
            for i in range(n):
                out[1 + i, count - seen[m, t, i]] += 1
