"""Noise of ranges from the link: what the code loop makes of the carrier over the noise."""

import math

from compass.core.jit import fast_kernel

#: Places in ``link``: C/N0 at one metre along the antenna's axis, dB Hz; that below which nothing
#: is measured; q of the antenna's pattern ``cos^q`` (0: alike in all directions); 1 for an axis
#: that points up, 0 against the velocity; a, b of the loop's variance at a C/N0 of 1 Hz.
NEAR, REQUIRED, POWER, UPWARDS, LINEAR, SQUARE = range(6)


@fast_kernel
def carrier_to_noise(link, x, distance, cx, cy, cz, dimmed):
    """C/N0 of a beacon's signal, dB Hz.

    Parameters
    ----------
    link
        See `NEAR`.
    x
        State of the lander, (>= 6,).
    distance, cx, cy, cz
        To the beacon, m, and the unit vector towards it.
    dimmed
        What plasma takes away, dB.
    """
    decibels = link[NEAR] - 20.0 * math.log10(distance) - dimmed
    if link[POWER] == 0.0:
        return decibels
    first, sign = (0, 1.0) if link[UPWARDS] == 1.0 else (3, -1.0)
    ax, ay, az = x[first], x[first + 1], x[first + 2]
    cosine = sign * (ax * cx + ay * cy + az * cz) / math.sqrt(ax * ax + ay * ay + az * az)
    if cosine <= 0.0:
        return -math.inf
    return decibels + 10.0 * link[POWER] * math.log10(cosine)


@fast_kernel
def loop_variance(link, decibels):
    """Variance of a range by the code loop, m^2: ``a n + b n^2``, n = N0/C; nan below the limit."""
    if not decibels >= link[REQUIRED]:
        return math.nan
    inverse = 10.0 ** (-decibels / 10.0)
    return link[LINEAR] * inverse + link[SQUARE] * inverse * inverse


@fast_kernel
def carriers(link, path, sources, dimmed, out):
    """`carrier_to_noise` of sources (t, n, >= 3) along a flight (t, 6) into `out` (t, n)."""
    for t in range(path.shape[0]):
        for i in range(sources.shape[1]):
            x = sources[t, i, 0] - path[t, 0]
            y = sources[t, i, 1] - path[t, 1]
            z = sources[t, i, 2] - path[t, 2]
            far = math.sqrt(x * x + y * y + z * z)
            out[t, i] = carrier_to_noise(link, path[t], far, x / far, y / far, z / far, dimmed[t])


@fast_kernel
def loop_variances(link, decibels, out):
    """`loop_variance` of many C/N0 (t, n) into `out`."""
    for t in range(out.shape[0]):
        for i in range(out.shape[1]):
            out[t, i] = loop_variance(link, decibels[t, i])
