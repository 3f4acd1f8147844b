"""What pushes a satellite besides the central attraction: the field, the Sun, moons, sunlight.

The *sky* is what does not depend on the satellite: the prime meridian, the Sun and the moons, at
the moments at which forces are wanted. Meridian and Sun come as Chebyshev series on pieces of
equal length, moons as rows of `compass.core.motion`.

Scalars stand in one array, `constants`, whose places are named below.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.gravity import field_acceleration
from compass.core.jit import fast_kernel
from compass.core.motion import mover_state

#: Places in `constants`: GM of Mars; reference radius of the field; one more than its degree; GM
#: of the Sun; acceleration by sunlight times distance squared; kind of shadow; radii of Mars and
#: of the Sun; start and length of the pieces of the sky; angle of the prime meridian at time 0 and
#: its mean rate.
GM, RADIUS, HIGHEST, SUN_GM, SUNLIGHT, SHADOW, MARS_RADIUS, SUN_RADIUS = range(8)
SKY_START, SKY_LENGTH, MERIDIAN, SPIN = range(8, 12)
CONSTANTS = 12


class Forces(NamedTuple):
    """Forces over a span.

    `constants` (CONSTANTS,) have their places above; `series` (pieces, c, d + 1) are Chebyshev
    series of the meridian and the Sun; `terms` are the field's, for
    `compass.core.gravity.field_acceleration`; `moons` rows of `compass.core.motion`, `gms` (m,)
    theirs.
    """

    constants: NDArray[np.float64]
    series: NDArray[np.float64]
    terms: NDArray[np.float64]
    moons: NDArray[np.float64]
    gms: NDArray[np.float64]


NO_SHADOW, CYLINDER, CONE = 0.0, 1.0, 2.0

#: Columns of the sky before the moons: meridian, Sun.
MOONS_FROM = 4


@fast_kernel
def sky_at(t, constants, series, moons, sky):
    """Fill `sky` with the meridian's angle (rad), the Sun's and each moon's place (m) at time t."""
    length = constants[SKY_LENGTH]
    piece = int(math.floor((t - constants[SKY_START]) / length))
    piece = min(max(piece, 0), series.shape[0] - 1)
    x = 2.0 * (t - constants[SKY_START] - piece * length) / length - 1.0
    for column in range(MOONS_FROM):
        high, higher = 0.0, 0.0
        for k in range(series.shape[2] - 1, 0, -1):
            high, higher = series[piece, column, k] + 2.0 * x * high - higher, high
        sky[column] = series[piece, column, 0] + x * high - higher
    sky[0] += constants[MERIDIAN] + constants[SPIN] * t
    for m in range(moons.shape[0]):
        state = mover_state(moons[m], series[0], t)
        for k in range(3):
            sky[MOONS_FROM + 3 * m + k] = state[k]


@fast_kernel
def _third_body(x, y, z, bx, by, bz, gm):
    """Attraction by a body at b less that on Mars: ``GM (b - r)/|b - r|^3 - GM b/|b|^3``."""
    dx, dy, dz = bx - x, by - y, bz - z
    near = dx * dx + dy * dy + dz * dz
    far = bx * bx + by * by + bz * bz
    near = gm / (near * math.sqrt(near))
    far = gm / (far * math.sqrt(far))
    return near * dx - far * bx, near * dy - far * by, near * dz - far * bz


@fast_kernel
def lit(x, y, z, sx, sy, sz, kind, mars, sun):
    """Share of the Sun's disc that a satellite sees, 0 to 1.

    ``CYLINDER``: none inside a cylinder behind Mars of its radius. ``CONE``: what Mars's disc
    leaves of the Sun's, two circles that overlap (Montenbruck and Gill 2000, eqs. 3.85 to 3.94).
    """
    if kind == NO_SHADOW:
        return 1.0
    distance = math.sqrt(sx * sx + sy * sy + sz * sz)
    along = (x * sx + y * sy + z * sz) / distance
    squared = x * x + y * y + z * z
    if along >= 0.0:
        return 1.0
    if kind == CYLINDER:
        return 0.0 if squared - along * along < mars * mars else 1.0
    dx, dy, dz = sx - x, sy - y, sz - z
    far = math.sqrt(dx * dx + dy * dy + dz * dz)
    here = math.sqrt(squared)
    a, b = math.asin(sun / far), math.asin(min(mars / here, 1.0))
    cosine = -(x * dx + y * dy + z * dz) / (far * here)
    c = math.acos(min(max(cosine, -1.0), 1.0))
    if c >= a + b:
        return 1.0
    if c <= abs(b - a):
        return 0.0 if b >= a else 1.0 - (b / a) ** 2
    p = (c * c + a * a - b * b) / (2.0 * c)
    q = math.sqrt(max(a * a - p * p, 0.0))
    hidden = a * a * math.acos(p / a) + b * b * math.acos((c - p) / b) - c * q
    return 1.0 - hidden / (math.pi * a * a)


@fast_kernel
def perturbation(x, y, z, share, constants, terms, gms, sky):
    """Acceleration besides the central one at an inertial place, m/s^2.

    Parameters
    ----------
    x, y, z
        Inertial position, m.
    share
        Share of sunlight that counts there.
    constants, terms
        As above and in `compass.core.gravity`.
    gms
        GM of the moons, m^3/s^2.
    sky
        As `sky_at` leaves it.
    """
    c, s = math.cos(sky[0]), math.sin(sky[0])
    fx, fy, az = field_acceleration(
        c * x + s * y,
        c * y - s * x,
        z,
        terms,
        int(constants[HIGHEST]),
        constants[RADIUS],
        constants[GM] / (constants[RADIUS] * constants[RADIUS]),
    )
    ax, ay = c * fx - s * fy, s * fx + c * fy
    if constants[SUN_GM] > 0.0:
        bx, by, bz = _third_body(x, y, z, sky[1], sky[2], sky[3], constants[SUN_GM])
        ax, ay, az = ax + bx, ay + by, az + bz
    for m in range(gms.size):
        k = MOONS_FROM + 3 * m
        bx, by, bz = _third_body(x, y, z, sky[k], sky[k + 1], sky[k + 2], gms[m])
        ax, ay, az = ax + bx, ay + by, az + bz
    if constants[SUNLIGHT] > 0.0:
        dx, dy, dz = x - sky[1], y - sky[2], z - sky[3]
        squared = dx * dx + dy * dy + dz * dz
        push = share * constants[SUNLIGHT] / (squared * math.sqrt(squared))
        ax, ay, az = ax + push * dx, ay + push * dy, az + push * dz
    return ax, ay, az
