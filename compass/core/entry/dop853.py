"""Dormand-Prince 8(5,3) along an entry trajectory: steps sized by error, events located.

Coefficients: Hairer, Norsett and Wanner 1993, Solving Ordinary Differential Equations I, 2nd ed.,
section II.10 (their program DOP853).
"""

import math

import numpy as np

from compass.core.entry.flow import bank_at
from compass.core.entry.rates import ROTATION, SWAPPED, acceleration, through_air
from compass.core.jit import fast_kernel

STAGES = 12
_ROWS: tuple[list[float], ...] = (
    [],
    [0.05260015195876773],
    [0.0197250569845379, 0.0591751709536137],
    [0.02958758547680685, 0.0, 0.08876275643042054],
    [0.2413651341592667, 0.0, -0.8845494793282861, 0.924834003261792],
    [0.037037037037037035, 0.0, 0.0, 0.17082860872947386, 0.12546768756682242],
    [0.037109375, 0.0, 0.0, 0.17025221101954405, 0.06021653898045596, -0.017578125],
    [
        0.03709200011850479, 0.0, 0.0, 0.17038392571223998, 0.10726203044637328,
        -0.015319437748624402, 0.008273789163814023,
    ],
    [
        0.6241109587160757, 0.0, 0.0, -3.3608926294469414, -0.868219346841726, 27.59209969944671,
        20.154067550477894, -43.48988418106996,
    ],
    [
        0.47766253643826434, 0.0, 0.0, -2.4881146199716677, -0.590290826836843, 21.230051448181193,
        15.279233632882423, -33.28821096898486, -0.020331201708508627,
    ],
    [
        -0.9371424300859873, 0.0, 0.0, 5.186372428844064, 1.0914373489967295, -8.149787010746927,
        -18.52006565999696, 22.739487099350505, 2.4936055526796523, -3.0467644718982196,
    ],
    [
        2.273310147516538, 0.0, 0.0, -10.53449546673725, -2.0008720582248625, -17.9589318631188,
        27.94888452941996, -2.8589982771350235, -8.87285693353063, 12.360567175794303,
        0.6433927460157636,
    ],
)  # fmt: skip
_A = np.zeros((STAGES, STAGES))
for _i, _row in enumerate(_ROWS):
    _A[_i, : len(_row)] = _row
_B = np.array([
    0.054293734116568765, 0.0, 0.0, 0.0, 0.0, 4.450312892752409, 1.8915178993145003,
    -5.801203960010585, 0.3111643669578199, -0.1521609496625161, 0.20136540080403034,
    0.04471061572777259,
])  # fmt: skip
#: Less the weights of the embedded third order.
_E3 = _B.copy()
_E3[[0, 8, 11]] -= [0.2440944881889764, 0.7338466882816118, 0.022058823529411766]
_E5 = np.array([
    0.01312004499419488, 0.0, 0.0, 0.0, 0.0, -1.2251564463762044, -0.4957589496572502,
    1.6643771824549864, -0.35032884874997366, 0.3341791187130175, 0.08192320648511571,
    -0.022355307863886294,
])  # fmt: skip

#: How a flight ended: at the last time asked for; at a terminal event; because the speed came to
#: zero, or the velocity to the vertical with lift (both leave a direction undefined); because no
#: step was small enough.
ARRIVED, EVENT, STANDSTILL, VERTICAL, STUCK = range(5)

#: What events watch: the distance from the centre, m, and the speed over the ground and through
#: the air, m/s.
WATCH_RADIUS, WATCH_SPEED, WATCH_AIRSPEED = 0, 1, 2

#: Below this speed (m/s) and cosine a direction counts as undefined.
LEAST_SPEED, LEAST_COSINE = 1e-3, 1e-6


@fast_kernel
def dop853_step(x, world, cos_bank, sin_bank, h, stages, out):
    """One step of size `h`; fills `stages` (12 by 6, the rates) and `out`."""
    stage = np.empty(6)
    for s in range(STAGES):
        for i in range(6):
            total = 0.0
            for j in range(s):
                total += _A[s, j] * stages[j, i]
            stage[i] = x[i] + h * total
        stages[s, :3] = stage[3:]
        acceleration(stage, world, cos_bank, sin_bank, stages[s, 3:])
    for i in range(6):
        total = 0.0
        for j in range(STAGES):
            total += _B[j] * stages[j, i]
        out[i] = x[i] + h * total


@fast_kernel
def error_norm(x, ahead, h, stages, rtol, atol):
    """Hairer's blend of the fifth- and third-order estimates; the step is good if below 1."""
    five, three = 0.0, 0.0
    for i in range(6):
        e5, e3 = 0.0, 0.0
        for j in range(STAGES):
            e5 += _E5[j] * stages[j, i]
            e3 += _E3[j] * stages[j, i]
        # by the length of the whole vector: what the axes are decides nothing
        first = 3 * (i // 3)
        size = x[first] ** 2 + x[first + 1] ** 2 + x[first + 2] ** 2
        scale = atol[i] + rtol * math.sqrt(size)
        five += (e5 / scale) ** 2
        three += (e3 / scale) ** 2
    if five == 0.0 and three == 0.0:
        return 0.0
    return abs(h) * five / math.sqrt(6.0 * (five + 0.01 * three))


@fast_kernel
def watched(x, what, p):
    """Distance from the centre or a speed, as `what` says, in the world `p`."""
    if what == WATCH_AIRSPEED:
        u, v, w = through_air(x, p)
        return math.sqrt(u * u + v * v + w * w)
    first = 0 if what == WATCH_RADIUS else 3
    return math.sqrt(x[first] ** 2 + x[first + 1] ** 2 + x[first + 2] ** 2)


@fast_kernel
def _locate(x, world, cos_bank, sin_bank, h, what, level, stages, out):
    """Part of the step `h` after which a quantity crosses `level`, by bisection and secant."""
    low, high, p = 0.0, h, world.p
    g_low = watched(x, what, p) - level
    dop853_step(x, world, cos_bank, sin_bank, h, stages, out)
    g_high = watched(out, what, p) - level
    for k in range(80):
        middle = 0.5 * (low + high)
        if k % 2 == 0 and g_high != g_low:
            middle = low - g_low * (high - low) / (g_high - g_low)
        if middle <= low or middle >= high:
            middle = 0.5 * (low + high)
        dop853_step(x, world, cos_bank, sin_bank, middle, stages, out)
        g = watched(out, what, p) - level
        if g * g_low > 0.0:
            low, g_low = middle, g
        else:
            high, g_high = middle, g
        if g == 0.0 or high - low <= 1e-12 * h:
            break
    dop853_step(x, world, cos_bank, sin_bank, high, stages, out)
    return high


@fast_kernel
def vertical(x):
    """Whether the velocity is along the radius, where the side of a lift is undefined."""
    dot, r, v = 0.0, 0.0, 0.0
    for i in range(3):
        dot += x[i] * x[3 + i]
        r += x[i] * x[i]
        v += x[3 + i] * x[3 + i]
    return not 1.0 - dot * dot / (r * v) > LEAST_COSINE * LEAST_COSINE


@fast_kernel
def dop853_flight(x0, world, times, bank, rtol, atol, watch, states, event_times, event_states):
    """Fly from `x0` through all `times`.

    Parameters
    ----------
    x0, world
        State (6) and `compass.core.entry.rates.World`.
    times
        Output times, s, increasing, shape (t,); `x0` holds at the first. Every switch of the bank
        between the first and the last must be among them.
    bank
        Bank angles, as in `compass.core.entry.flow.advance`.
    rtol, atol
        Relative tolerance, of the lengths of position and velocity, and absolute ones (6).
    watch
        Events, shape (e, 4): what is watched, level, direction (1 up, -1 down), 1 if the flight
        ends there.
    states, event_times, event_states
        Outputs, (t, 6), (e,) and (e, 6): only the first crossing of each event; nan where the
        flight did not get so far.

    Returns
    -------
    status, count, time
        How it ended (`ARRIVED` ...), how many output times were reached, and when it ended.
    """
    states[:, :] = np.nan
    event_times[:] = np.nan
    event_states[:, :] = np.nan
    p, stages = world.p, np.empty((STAGES, 6))
    x, ahead, crossing = x0.copy(), np.empty(6), np.empty(6)
    t = times[0]
    states[0] = x
    wish = 1.0
    sided = world.lift != 0.0 or p[ROTATION] == SWAPPED
    for n in range(1, times.size):
        angle = bank[bank_at(times[n - 1], bank), 1]
        cos_bank, sin_bank = math.cos(angle), math.sin(angle)
        while t < times[n]:
            if not watched(x, WATCH_SPEED, p) > LEAST_SPEED:
                return STANDSTILL, n, t
            if sided and vertical(x):
                return VERTICAL, n, t
            h = min(wish, times[n] - t)
            dop853_step(x, world, cos_bank, sin_bank, h, stages, ahead)
            error = error_norm(x, ahead, h, stages, rtol, atol)
            if not error < 1.0:
                wish = h * (max(0.2, 0.9 * error**-0.125) if math.isfinite(error) else 0.2)
                if wish < 1e-9:
                    return STUCK, n, t
                continue
            end, last = -1, h
            for e in range(watch.shape[0]):
                what, level = int(watch[e, 0]), watch[e, 1]
                before, after = watched(x, what, p) - level, watched(ahead, what, p) - level
                up = before < 0.0 and after >= 0.0 and watch[e, 2] > 0.0
                down = before > 0.0 and after <= 0.0 and watch[e, 2] < 0.0
                if not (up or down) or not math.isnan(event_times[e]):
                    continue
                part = _locate(x, world, cos_bank, sin_bank, h, what, level, stages, crossing)
                event_times[e] = t + part
                event_states[e] = crossing
                if watch[e, 3] > 0.0 and part <= last:
                    end, last = e, part
            if end >= 0:
                for e in range(watch.shape[0]):
                    if event_times[e] > t + last:
                        event_times[e] = np.nan
                        event_states[e, :] = np.nan
                return EVENT, n, t + last
            growth = min(10.0, 0.9 * error**-0.125) if error > 0.0 else 10.0
            if h == wish or h * growth > wish:
                wish = h * growth
            t = times[n] if h == times[n] - t else t + h
            x[:] = ahead
        states[n] = x
    return ARRIVED, times.size, t
