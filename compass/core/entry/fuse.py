"""Filters that hear accelerometers and beacons: all in one, or subsystems that are fused.

A subsystem hears its own beacon and what the lander reads of itself, its accelerometers and other
instruments; a fusion node adds the information of the
subsystems with coefficients c_i: ``P = (sum_i c_i Y_i)^-1``, ``x = P sum_i c_i Y_i x_i``. The
algorithms differ in what a subsystem starts from and in the coefficients (see
`compass.core.entry.groups.Arrangement`); dynamics, measurements and update are those of every
other filter here.
"""

import math

from compass.core.entry.flow import advance_transition, bank_at
from compass.core.entry.groups import Heard, make_estimates, make_room
from compass.core.entry.measure import AIR, AXES, CLOCK, LIFT, acceleration_rows, added, measured
from compass.core.entry.node import fuse, sound, weigh
from compass.core.entry.predict import moved_covariance
from compass.core.entry.rates import LIFT as RATIO
from compass.core.entry.update import absorb
from compass.core.entry.weights import make_scratch
from compass.core.jit import fast_kernel, kernel

#: Iterations stop when no state moves by more than this share of its predicted sigma.
SMALL_STEP = 1e-6


@kernel
def flow_of(known, t, x, world, room):
    """Move position and velocity of `x` to epoch t into ``room.after``, derivative in `phi`."""
    start = known.times[max(t - 1, 0)]
    advance_transition(
        x, world.thicker + added(x, known.places[AIR]),
        known.p[RATIO] + world.lift + added(x, known.places[LIFT]), known.p, known.bank, start,
        known.times[t], known.longest, room.after, room.phi,
    )  # fmt: skip


@kernel
def move(known, t, x, cov, factor, room):
    """Move an estimate along the flow in `room`, its process noise multiplied by `factor`."""
    dt = known.times[t] - known.times[max(t - 1, 0)]
    noise = room.noise[:, : known.noise.shape[1]]
    for i in range(6):
        for j in range(noise.shape[1]):
            noise[i, j] = math.sqrt(factor) * known.noise[t, i, j]
    for i in range(x.size):
        room.walk[i] = factor * dt * known.walk[i]
    moved_covariance(room.phi, dt, noise, room.walk, 1.0, known.places, room.half, cov)
    for i in range(6):
        x[i] = room.after[i]
    if known.places[CLOCK] >= 0:
        x[known.places[CLOCK]] += dt * x[known.places[CLOCK] + 1]


@kernel
def hears(r, kinds, group):
    """Whether the subsystem of beacons ``group = first, last, m`` hears measurement r."""
    first, last, m = group
    source = (r - AXES) // kinds
    return r < AXES or source >= m or first <= source < last


@kernel
def linearise(known, t, variances, x, world, group, room):
    """Write what a subsystem (see `hears`) would measure at `x`, and the rows."""
    angle = known.bank[bank_at(known.times[t], known.bank), 1]
    acceleration_rows(
        x, world.thicker + added(x, known.places[AIR]),
        known.p[RATIO] + world.lift + added(x, known.places[LIFT]), known.p, math.cos(angle),
        math.sin(angle), known.places, room.rows, room.h,
    )  # fmt: skip
    c = known.kinds.size
    for r in range(AXES, variances.size):
        if hears(r, c, group) and not math.isnan(variances[r]):
            k = (r - AXES) // c
            room.h[r] = measured(
                known.kinds[(r - AXES) % c], x, known.sources[t, k], k, known.places, known.p,
                angle, room.rows[r],
            )  # fmt: skip


@fast_kernel
def innovation_variance(cov, row, noise):
    """``h P h^T + R``."""
    total = noise
    for i in range(row.size):
        part = 0.0
        for j in range(row.size):
            part += cov[i, j] * row[j]
        total += row[i] * part
    return total


@kernel
def learn(arrangement, known, t, heard, x, cov, world, group, factor, estimates, room):
    """Update an estimate by what a subsystem hears, see `hears`; False if it is lost.

    What all subsystems hear alike has its variances multiplied by `factor`. The gate looks at each
    row alone, so its answer does not depend on their order.
    """
    z, variances, _ = heard
    size, used, c, m = x.size, room.used, known.kinds.size, group[2]
    linearise(known, t, variances, x, world, group, room)
    shut = arrangement.gate < math.inf and known.times[t] >= arrangement.gate_start
    for r in range(z.size):
        used[r] = hears(r, c, group) and not math.isnan(variances[r])
        if used[r] and shut:
            residual = z[r] - room.h[r]
            variance = innovation_variance(cov, room.rows[r], variances[r])
            if not residual * residual <= arrangement.gate * variance:
                used[r] = False
                estimates.gated[r] = True
    for i in range(size):
        room.shift[i] = 0.0
    room.prior[:, :] = cov
    for k in range(arrangement.iterations):
        for i in range(size):
            room.before[i] = room.shift[i]
            room.point[i] = x[i] + room.shift[i]
            room.shift[i] = 0.0
        if k > 0:
            cov[:, :] = room.prior
            linearise(known, t, variances, room.point, world, group, room)
        for r in range(z.size):
            if used[r]:
                residual = z[r] - room.h[r]
                for i in range(size):
                    residual += room.rows[r, i] * room.before[i]
                own = r >= AXES and (r - AXES) // c < m
                noise = variances[r] * (1.0 if own else factor)
                absorb(room.rows[r], residual, noise, size, room.gain, cov, room.shift)
        largest = 0.0
        for i in range(size):
            step = room.shift[i] - room.before[i]
            largest = max(largest, step * step / room.prior[i, i])
        if largest < SMALL_STEP * SMALL_STEP:
            break
    for i in range(size):
        x[i] += room.shift[i]
    return sound(x, cov)


@kernel
def fuse_epoch(arrangement, known, t, heard, world, estimates, room, work):
    """Move all estimates to epoch t and let them hear what there is; False if one is lost.

    Dead subsystems wait; without feedback they come back from the fused estimate of the epoch
    before. If all are dead the fused estimate is predicted.

    Parameters
    ----------
    arrangement, known
        Who hears what, and the world as they know it.
    t
        Epoch.
    heard
        What comes at it, `Heard`.
    world
        `World`.
    estimates, room, work
        Of `make_estimates`, `make_room` and `compass.core.entry.weights.make_scratch`.
    """
    alive, x, cov = heard.alive, estimates.x, estimates.P
    m = alive.size
    estimates.gated[:] = False
    count = 0
    for i in range(m):
        count += 1 if alive[i] else 0
    if arrangement.feedback or not arrangement.apart or count == 0:
        flow_of(known, t, x, world, room)
        if not arrangement.apart or count == 0:
            move(known, t, x, cov, 1.0, room)
            estimates.waiting[:] = True
            if arrangement.apart:
                return sound(x, cov)
            return learn(
                arrangement, known, t, heard, x, cov, world, (0, m, m), 1.0, estimates, room
            )
    for i in range(m):
        own_x, own_cov = estimates.local_x[i], estimates.local_cov[i]
        if not alive[i]:
            estimates.waiting[i] = True
            continue
        shares = 1.0
        if arrangement.feedback or estimates.waiting[i]:
            own_x[:] = x
            part = 1.0
            if arrangement.divided:
                shares = count
                part = 1.0 / count
            elif arrangement.fading:
                part = max(estimates.weights[i], arrangement.floor)
            for j in range(x.size):
                for k in range(x.size):
                    own_cov[j, k] = cov[j, k] / part
            estimates.waiting[i] = False
        if not arrangement.feedback:
            flow_of(known, t, own_x, world, room)
        move(known, t, own_x, own_cov, shares, room)
        group = (i, i + 1, m)
        if not learn(
            arrangement, known, t, heard, own_x, own_cov, world, group, shares, estimates, room
        ):
            return False
    if not weigh(arrangement, alive, estimates, room, work):
        return False
    coefficients = work.gradient
    for i in range(m):
        coefficients[i] = estimates.weights[i]
        if arrangement.divided:
            coefficients[i] = 1.0 if alive[i] else 0.0
    return fuse(arrangement, coefficients, estimates, room, work)


@kernel
def fuse_run(arrangement, known, x0, p0, heard, world, told):
    """Filter all epochs; return -1, or the epoch at which an estimate was lost.

    Parameters
    ----------
    arrangement, known, world
        As in `fuse_epoch`.
    x0, p0
        First estimate, before the first epoch's measurements, (s,) and (s, s).
    heard
        `Heard` at every epoch.
    told
        Output, `Told`.
    """
    z, variances, alive = heard
    m, rows = alive.shape[1], z.shape[1]
    estimates, room = make_estimates(x0, p0, m, rows), make_room(x0.size, m, rows)
    work = make_scratch(x0.size, m)
    for t in range(known.times.size):
        now = Heard(z[t], variances[t], alive[t])
        if not fuse_epoch(arrangement, known, t, now, world, estimates, room, work):
            return t
        told.xs[t] = estimates.x
        told.ps[t] = estimates.P
        told.weights[t] = estimates.weights
        told.gated[t] = estimates.gated
    return -1
