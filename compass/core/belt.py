"""Area of belts of latitude on an ellipsoid."""

import math

from compass.core.jit import kernel


@kernel
def area_below(b, e2):
    """Area from the equator to a geodetic latitude, per radian of longitude.

    Integral of ``(1 - e^2) cos b / (1 - e^2 sin^2 b)^2``, in squares of the equatorial radius.
    """
    s = math.sin(b)
    if e2 == 0.0:
        return s
    e = math.sqrt(e2)
    return 0.5 * (1.0 - e2) * (s / (1.0 - e2 * s * s) + math.atanh(e * s) / e)
