"""What a lander tells itself while it enters: its instruments, and places known by sight."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.flow import bank_at
from compass.core.entry.many import add_square, take_out
from compass.core.entry.measure import AIR, ATTITUDE, GYRO, IMU, LIFT, PLACES, measured
from compass.core.entry.rates import COLUMNS
from compass.core.jit import kernel

Array = NDArray[np.float64]


class Readings(NamedTuple):
    """What is read of k sources: c kinds, numbers of `compass.core.entry.measure`.

    `sources` (m, k, 6) are positions and velocities of the places, and of the centre of Mars;
    `variances` (m, t, k, c) are nan where there is no reading; `errors` (9,) are one sigma of the
    biases of the accelerometers, of the axes and of the gyros that hold them.
    """

    sources: Array
    variances: Array
    kinds: NDArray[np.int64]
    errors: Array


@kernel
def own_information(flights, worlds, p, times, readings, out):
    """Information on u by what the lander reads of itself and of places that it knows by sight.

    Constant errors of its instruments e are found out as far as they can be, as those of satellites
    in `compass.core.entry.information.information`: ``F_uu - F_ue (I + F_ee)^-1 F_eu``.

    Parameters
    ----------
    flights, worlds, p, times
        Of `compass.core.entry.many.fly_many`.
    readings
        `Readings`.
    out
        Output, packed, (m, 1, d (d + 1)/2); what is behind the components of `gains` is not told.
    """
    paths, gains, stops = flights
    offsets, spreads, banks = worlds
    sources, variances, kinds, errors = readings
    places = np.full(PLACES, -1)
    places[AIR], places[LIFT], places[IMU], places[ATTITUDE], places[GYRO] = 6, 7, 8, 11, 14
    size, own = COLUMNS + errors.size, errors.size
    x, row, motion = np.zeros(size), np.empty(size), gains.shape[3]
    h, s = np.empty(motion), np.empty(own)
    cross, square = np.empty((motion, own)), np.empty((own, own))
    out[:] = 0.0
    for m in range(paths.shape[0]):
        cross[:] = 0.0
        square[:] = 0.0
        x[6:COLUMNS] = offsets[m]
        for t in range(stops[m] + 1):
            x[:6] = paths[m, t]
            angle = banks[m, bank_at(times[t], banks[m]), 1]
            for b in range(sources.shape[1]):
                for c in range(kinds.size):
                    if math.isnan(variances[m, t, b, c]):
                        continue
                    row[:] = 0.0
                    measured(kinds[c], x, sources[m, b], b, places, p, angle, row)
                    for j in range(motion):
                        h[j] = row[6] * spreads[m, 6, j] + row[7] * spreads[m, 7, j]
                        for i in range(6):
                            h[j] += row[i] * gains[m, t, i, j]
                    worth = 1.0 / variances[m, t, b, c]
                    add_square(h, worth, out, m, 0)
                    for e in range(own):
                        held = times[t] * row[COLUMNS + e - 3] if e >= 6 else row[COLUMNS + e]
                        s[e] = held * errors[e]
                    for e in range(own):
                        for j in range(motion):
                            cross[j, e] += worth * h[j] * s[e]
                        for k in range(own):
                            square[e, k] += worth * s[e] * s[k]
        take_out(cross, square, out[m, 0])
