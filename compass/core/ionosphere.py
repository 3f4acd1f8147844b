"""How much of its content below the Sun the ionosphere keeps away from there."""

import math

import numpy as np

from compass.core.jit import inline_kernel, kernel


@kernel
def grazing(cosine, x):
    """Chapman's function: slant over vertical path of light at a zenith angle, by its cosine.

    In an exponential gas, x its distance from the centre over its scale height; to some per cent
    (Smith and Smith 1972, J. Geophys. Res. 77:3592, equations 12 and 13). Huge at night.
    """
    y2 = 0.5 * x * cosine * cosine
    y = math.sqrt(y2)
    # beyond y of 20 the two factors overflow; their product is 1/(y sqrt(pi)) to a thousandth
    tail = math.exp(min(y2, 400.0)) * math.erfc(y) if y < 20.0 else 1.0 / (y * 1.7724538509055159)
    half = math.sqrt(0.5 * math.pi * x) * tail
    if cosine >= 0.0:
        return half
    sine = math.sqrt(max(1.0 - cosine * cosine, 1e-24))
    below = math.exp(min(x * (1.0 - sine), 600.0))
    return math.sqrt(2.0 * math.pi * x * sine) * below - half


@kernel
def sunlit_table(x, size):
    """Share of the square of the delay at cosines of the Sun's zenith angle from -1 to 1.

    ``1/Ch``: content goes with its root. Linear between entries is good to a hundredth of the
    noon's at 1024 of them.
    """
    table = np.empty(size)
    for k in range(size):
        table[k] = 1.0 / grazing(-1.0 + 2.0 * k / (size - 1), x)
    return table


@inline_kernel
def sunlit(cosine, table):
    """Entry of `sunlit_table` at a cosine, linear between entries."""
    place = 0.5 * (cosine + 1.0) * (table.size - 1)
    k = min(max(int(place), 0), table.size - 2)
    return table[k] + (place - k) * (table[k + 1] - table[k])
