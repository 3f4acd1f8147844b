"""What a satellite's acceleration gains a unit of each number that a determination does not know.

Sunlight's scale, the planet's GM (relative) and coefficients of its field: the acceleration is
linear in each, so that its partial is the push that the number alone, at 1, would give.
"""

import math

from compass.core.forces import lit
from compass.core.gravity import field_acceleration
from compass.core.jit import kernel


@kernel
def pushes(r, sun, angles, sunlight, shadow, bodies, terms, highest, radius, gm, out):
    """Fill accelerations a unit of sunlight's scale, of GM (relative) and of each coefficient.

    Parameters
    ----------
    r
        Inertial places, m, shape (satellite, epoch, 3).
    sun
        Of the Sun, m, shape (epoch, 3).
    angles
        From the inertial x axis to the field's, rad, shape (epoch,).
    sunlight
        Acceleration by sunlight times distance squared, m^3/s^2.
    shadow
        Its kind, as `compass.core.forces.lit` takes it.
    bodies
        Radii of Mars and of the Sun, m.
    terms
        Of fields with one coefficient at 1 each, shape (g, k, columns), for `field_acceleration`.
    highest
        One more than their degree.
    radius, gm
        Reference radius, m; m^3/s^2.
    out
        Shape (satellite, epoch, 3, 2 + g), m/s^2.
    """
    scale = gm / (radius * radius)
    for s in range(r.shape[0]):
        for t in range(r.shape[1]):
            x, y, z = r[s, t, 0], r[s, t, 1], r[s, t, 2]
            sx, sy, sz = sun[t, 0], sun[t, 1], sun[t, 2]
            dx, dy, dz = x - sx, y - sy, z - sz
            far2 = dx * dx + dy * dy + dz * dz
            push = sunlight * lit(x, y, z, sx, sy, sz, shadow, bodies[0], bodies[1])
            push /= far2 * math.sqrt(far2)
            out[s, t, 0, 0], out[s, t, 1, 0], out[s, t, 2, 0] = push * dx, push * dy, push * dz
            near2 = x * x + y * y + z * z
            pull = -gm / (near2 * math.sqrt(near2))
            out[s, t, 0, 1], out[s, t, 1, 1], out[s, t, 2, 1] = pull * x, pull * y, pull * z
            cosine, sine = math.cos(angles[t]), math.sin(angles[t])
            fx, fy = cosine * x + sine * y, cosine * y - sine * x
            for g in range(terms.shape[0]):
                ax, ay, az = field_acceleration(fx, fy, z, terms[g], highest, radius, scale)
                out[s, t, 0, 2 + g] = cosine * ax - sine * ay
                out[s, t, 1, 2 + g] = cosine * ay + sine * ax
                out[s, t, 2, 2 + g] = az
