"""Extended Kalman filter on Cartesian states and further blocks: predict, update, one run.

States: position and velocity (6), then the blocks that `places` names. Those behind the estimated
ones are considered (Schmidt): the filter knows how uncertain they are and lets that uncertainty
into its covariance, but does not correct them.
"""

import math

import numpy as np

from compass.core.entry.flow import advance_transition
from compass.core.entry.measure import (
    AIR,
    BIAS,
    CLOCK,
    ESTIMATED,
    KINDS,
    LIFT,
    RANGE,
    measurement_rows,
)
from compass.core.entry.rates import COLUMNS, OF_AIR, OF_LIFT
from compass.core.entry.rates import LIFT as RATIO
from compass.core.jit import fast_kernel, kernel


@fast_kernel
def moved_covariance(phi, dt, noise, walk, fade, places, half, covariance):
    """``P = F P F^T + G G^T + W`` in place, with F made of `phi` and of what stays as it is.

    Parameters
    ----------
    phi
        Derivative of position and velocity, (6, 8), of `advance_transition`.
    dt
        Seconds.
    noise
        G (6, 6): root of the process noise of the step; shape (0, 0) for none.
    walk, fade
        Variance that all states but the first six gather over the step, (s,), and what is left
        of the logarithm of the density at its end.
    places
        See `compass.core.entry.measure.PLACES`.
    half
        Scratch, (s, s).
    covariance
        P, (s, s).
    """
    size = covariance.shape[0]
    air, lift, clock = places[AIR], places[LIFT], places[CLOCK]
    for i in range(6):
        for j in range(size):
            total = 0.0
            for k in range(6):
                total += phi[i, k] * covariance[k, j]
            if air >= 0:
                total += phi[i, OF_AIR] * covariance[air, j]
            if lift >= 0:
                total += phi[i, OF_LIFT] * covariance[lift, j]
            half[i, j] = total
    for i in range(6, size):
        for j in range(size):
            half[i, j] = fade * covariance[i, j] if i == air else covariance[i, j]
            if i == clock:
                half[i, j] += dt * covariance[clock + 1, j]
    for i in range(size):
        for j in range(min(i + 1, 6)):
            total = 0.0
            for k in range(6):
                total += half[i, k] * phi[j, k]
            if air >= 0:
                total += half[i, air] * phi[j, OF_AIR]
            if lift >= 0:
                total += half[i, lift] * phi[j, OF_LIFT]
            if i < 6:
                for k in range(noise.shape[0]):
                    total += noise[i, k] * noise[j, k]
            covariance[i, j] = total
            covariance[j, i] = total
        for j in range(6, i + 1):
            value = fade * half[i, j] if j == air else half[i, j]
            if j == clock:
                value += dt * half[i, clock + 1]
            covariance[i, j] = value
            covariance[j, i] = value
        if i >= 6:
            covariance[i, i] += walk[i]


@fast_kernel
def absorb(row, residual, variance, estimated, gain, covariance, shift):
    """Update by one measurement, linear in the state: `shift` and `covariance` change.

    ``g = P h``, ``s = h g + R``: ``shift += g/s (residual - h shift)`` on the estimated states and
    ``P -= g g^T / s`` but for the considered ones among themselves, which is Joseph's form with
    Schmidt's gain.
    """
    size = row.size
    s = variance
    for i in range(size):
        gain[i] = 0.0
    for j in range(size):
        if row[j] != 0.0:  # a range knows three states and a bias
            for i in range(size):
                gain[i] += covariance[j, i] * row[j]
    for i in range(size):
        s += row[i] * gain[i]
        residual -= row[i] * shift[i]
    for i in range(size):
        scaled = gain[i] / s
        if i < estimated:
            shift[i] += scaled * residual
        for j in range(min(i + 1, estimated)):
            value = covariance[i, j] - scaled * gain[j]
            covariance[i, j] = value
            covariance[j, i] = value


@kernel
def update(x, covariance, beacons, variances, z, places, iterations):
    """Update with all measurements of an epoch; iterated about the new mean.

    Gauss-Newton on the posterior: each pass linearises at the latest estimate and starts again
    from the prior; one pass is the plain extended Kalman filter.
    """
    size = x.size
    prior, shift, before = covariance.copy(), np.zeros(size), np.empty(size)
    rows, gain, point = np.zeros((KINDS, size)), np.empty(size), x.copy()
    for _ in range(iterations):
        for i in range(size):
            before[i] = shift[i]
            point[i] = x[i] + shift[i]
            shift[i] = 0.0
        covariance[:, :] = prior
        for b in range(beacons.shape[0]):
            if math.isnan(variances[b, 0]) and math.isnan(variances[b, 1]):
                continue
            if places[BIAS] >= 0:
                rows[RANGE, places[BIAS] :] = 0.0
            predicted = measurement_rows(point, beacons[b], b, places, rows[0], rows[1])
            for kind in range(KINDS):
                if math.isnan(variances[b, kind]):
                    continue
                residual = z[b, kind] - predicted[kind]
                for i in range(size):
                    residual += rows[kind, i] * before[i]
                absorb(
                    rows[kind], residual, variances[b, kind], places[ESTIMATED], gain, covariance,
                    shift,
                )  # fmt: skip
        change = 0.0
        for i in range(places[ESTIMATED]):
            change = max(change, abs(shift[i] - before[i]) / math.sqrt(prior[i, i]))
        if change < 1e-9:
            break
    for i in range(size):
        x[i] += shift[i]


@kernel
def added(x, place):
    """State at `place`, or 0 where the block is left out (-1)."""
    return x[place] if place >= 0 else 0.0


@kernel
def filter_run(
    x0, covariance0, p, bank, times, longest, noise, walk, fade, beacons, variances, z, places,
    iterations, xs, ps,
):  # fmt: skip
    """One filter run.

    Parameters
    ----------
    x0, covariance0
        Estimate (s,) and its covariance at the first time, before that time's measurements.
    p, bank
        Parameters of the dynamics, and bank angles (k, 2) of `advance`.
    times, longest
        Epochs (t,) and the longest Runge-Kutta step, s.
    noise, walk, fade
        From the epoch before to each: roots of the process noise, (t, 6, 6) or (0, 6, 6) for
        none, variances of the further states, (t, s), and what is left of the logarithm of the
        density, (t,).
    beacons, variances, z
        Positions and velocities (t, n, 6); variances (t, n, 2), nan for what is not measured;
        measurements (t, n, 2).
    places, iterations
        Where the blocks are, and the passes of the update.
    xs, ps
        Outputs after each update, (t, s) and (t, s, s).
    """
    x, covariance = x0.copy(), covariance0.copy()
    after, phi, half = np.empty(6), np.empty((6, COLUMNS)), np.empty(covariance.shape)
    none, noisy = np.empty((0, 6)), noise.shape[0] > 0
    clock = places[CLOCK]
    for t in range(times.size):
        if t > 0:
            dt = times[t] - times[t - 1]
            thicker, lift = added(x, places[AIR]), p[RATIO] + added(x, places[LIFT])
            advance_transition(
                x, thicker, lift, p, bank, times[t - 1], times[t], longest, after, phi
            )
            moved_covariance(
                phi, dt, noise[t] if noisy else none, walk[t], fade[t], places, half, covariance
            )
            for i in range(6):
                x[i] = after[i]
            if clock >= 0:
                x[clock] += dt * x[clock + 1]
            if places[AIR] >= 0:
                x[places[AIR]] *= fade[t]
        update(x, covariance, beacons[t], variances[t], z[t], places, iterations)
        xs[t] = x
        ps[t] = covariance


@kernel
def covariance_run(
    path, covariance0, p, bank, times, longest, noise, walk, fade, beacons, variances, places, ps
):  # fmt: skip
    """Linear covariance along a flight: what `filter_run` would claim at the true states.

    With the states known that is the posterior Cramer-Rao bound,
    ``J_k = (Q + Phi J_(k-1)^-1 Phi^T)^-1 + H^T R^-1 H`` carried as ``P = J^-1``. Parameters as in
    `filter_run`; `path` is the flight at the epochs, (t, 6).
    """
    size = covariance0.shape[0]
    covariance = covariance0.copy()
    after, phi, half = np.empty(6), np.empty((6, COLUMNS)), np.empty((size, size))
    none, noisy = np.empty((0, 6)), noise.shape[0] > 0
    rows, gain, x, shift = np.zeros((KINDS, size)), np.empty(size), np.zeros(size), np.zeros(size)
    for t in range(times.size):
        if t > 0:
            advance_transition(
                path[t - 1], 0.0, p[RATIO], p, bank, times[t - 1], times[t], longest, after, phi
            )
            moved_covariance(
                phi, times[t] - times[t - 1], noise[t] if noisy else none, walk[t], fade[t], places,
                half, covariance,
            )  # fmt: skip
        for i in range(6):
            x[i] = path[t, i]
        for b in range(beacons.shape[1]):
            if math.isnan(variances[t, b, 0]) and math.isnan(variances[t, b, 1]):
                continue
            if places[BIAS] >= 0:
                rows[RANGE, places[BIAS] :] = 0.0
            measurement_rows(x, beacons[t, b], b, places, rows[0], rows[1])
            for kind in range(KINDS):
                if not math.isnan(variances[t, b, kind]):
                    absorb(
                        rows[kind], 0.0, variances[t, b, kind], places[ESTIMATED], gain, covariance,
                        shift,
                    )  # fmt: skip
        ps[t] = covariance
