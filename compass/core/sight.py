"""Who is in sight of whom: smooth functions of time, not negative while in sight, in metres.

Each comes with its rate and with a bound on its second derivative over an interval, which is
what lets events be found without sampling (see `compass.core.events`).
"""

import math

from compass.core.jit import kernel

ELEVATION, LIMB, ECLIPSE, HORIZON = 0, 1, 2, 3

#: A ray that comes this close (metres) to the limb, or to the mask, still counts as in sight.
EDGE = 0.01


@kernel
def up_vector(mover, angle):
    """Components of a site's up direction when its meridian stands at `angle`."""
    return mover[4] * math.cos(angle), mover[4] * math.sin(angle), mover[5]


@kernel
def elevation_sight(mover, angle, rate, sine, p, q):
    """``f = u . d - sin(mask) |d|`` and its rate: height over the cone of the mask.

    Parameters
    ----------
    mover
        The site's row.
    angle, rate
        Angle of its meridian and its rate.
    sine
        Sine of the mask elevation.
    p, q
        States of site and target; ``d = r_q - r_p``, u is the site's up.
    """
    ux, uy, uz = up_vector(mover, angle)
    dx, dy, dz = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    ex, ey, ez = q[3] - p[3], q[4] - p[4], q[5] - p[5]
    distance = math.sqrt(dx * dx + dy * dy + dz * dz)
    above = ux * dx + uy * dy + uz * dz
    above_rate = ux * ex + uy * ey + uz * ez + rate * (ux * dy - uy * dx)
    range_rate = (dx * ex + dy * ey + dz * ez) / distance if distance > 0.0 else 0.0
    return above - sine * distance + EDGE, above_rate - sine * range_rate


@kernel
def elevation_curvature(rate, sine, da, db, h, one, two):
    """Bound on ``|f''|`` of `elevation_sight`.

    With V and A the largest relative speed and acceleration, D and d the largest and smallest
    distance: ``w^2 D + 2 w V + A + sin(mask) (V^2/d + A)``.

    Parameters
    ----------
    rate, sine
        As in `elevation_sight`.
    da, db, h
        Distances at the ends and length of the interval.
    one, two
        Bounds of the two movers (`mover_bounds`).
    """
    speed, acceleration = one[2] + two[2], one[3] + two[3]
    far = 0.5 * (da + db + speed * h)
    near = 0.5 * (da + db - speed * h)
    curvature = rate * rate * far + 2.0 * rate * speed + acceleration
    if sine > 0.0:
        if near <= 0.0:
            return math.inf
        curvature += sine * (speed * speed / near + acceleration)
    return curvature


@kernel
def limb_sight(radius, stretch, scale, p, q):
    """``f = (r_p . r_q + t_p t_q - R^2) / scale``, ``t = sqrt(r^2 - R^2)``, and its rate.

    Zero where the ray between p and q touches the sphere: then the central angle is the sum of
    ``acos(R/r)``. An ellipsoid of revolution becomes that sphere, rays staying rays, when the
    polar axis is stretched by the ratio of its axes, `stretch`.
    """
    k = stretch * stretch
    dot = p[0] * q[0] + p[1] * q[1] + k * p[2] * q[2]
    dot_rate = p[0] * q[3] + p[1] * q[4] + q[0] * p[3] + q[1] * p[4]
    dot_rate += k * (p[2] * q[5] + q[2] * p[5])
    tp, tp_rate = _tangent(p, radius, k)
    tq, tq_rate = _tangent(q, radius, k)
    value = (dot + tp * tq - radius * radius) / scale + EDGE
    return value, (dot_rate + tp_rate * tq + tp * tq_rate) / scale


@kernel
def _tangent(p, radius, k):
    """Length of the tangent from p to the sphere, and its rate."""
    squared = p[0] * p[0] + p[1] * p[1] + k * p[2] * p[2] - radius * radius
    t = math.sqrt(max(squared, 1.0))
    return t, (p[0] * p[3] + p[1] * p[4] + k * p[2] * p[5]) / t


@kernel
def limb_curvature(radius, stretch, scale, ends_p, ends_q, h, one, two):
    """Bound on ``|f''|`` of `limb_sight`, from the stretched distances at the ends."""
    rp, vp, ap, tp, tp1, tp2 = _stretched(radius, stretch, ends_p, h, one)
    rq, vq, aq, tq, tq1, tq2 = _stretched(radius, stretch, ends_q, h, two)
    if tp <= 0.0 or tq <= 0.0:
        return math.inf
    high_tp, high_tq = math.sqrt(rp * rp - radius * radius), math.sqrt(rq * rq - radius * radius)
    curvature = ap * rq + 2.0 * vp * vq + rp * aq
    return (curvature + tp2 * high_tq + 2.0 * tp1 * tq1 + high_tp * tq2) / scale


@kernel
def _stretched(radius, stretch, ends, h, bounds):
    """Bounds in the stretched space: distance, speed, acceleration; tangent (least), t', t''."""
    low, high, speed, acceleration, product, product_rate = bounds
    excess = stretch * stretch - 1.0
    product += excess * high * speed
    product_rate += excess * (speed * speed + high * acceleration)
    low = max(low, 0.5 * (ends[0] + ends[1] - product / low * h))
    squared = low * low - radius * radius
    t = math.sqrt(squared) if squared > 1.0 else 0.0
    t1 = product / t if t > 0.0 else math.inf
    t2 = (product_rate + t1 * t1) / t if t > 0.0 else math.inf
    return stretch * high, stretch * speed, stretch * acceleration, t, t1, t2


@kernel
def eclipse_sight(radius, sun_radius, sign, p, q):
    """``f = r . s + t cos(rho) + sign R sin(rho)`` and its rate, for a satellite p and the Sun q.

    s is the direction from satellite to Sun, rho the Sun's apparent radius, t the tangent to the
    sphere. With `sign` -1, f is negative where any of the Sun's disc is hidden (penumbra and
    umbra), with +1 where all of it is (umbra).
    """
    dx, dy, dz = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    ex, ey, ez = q[3] - p[3], q[4] - p[4], q[5] - p[5]
    distance = math.sqrt(dx * dx + dy * dy + dz * dz)
    range_rate = (dx * ex + dy * ey + dz * ez) / distance
    sine = sun_radius / distance
    cosine = math.sqrt(1.0 - sine * sine)
    sine_rate = -sine * range_rate / distance
    t, t_rate = _tangent(p, radius, 1.0)
    along = (p[0] * dx + p[1] * dy + p[2] * dz) / distance
    along_rate = (p[3] * dx + p[4] * dy + p[5] * dz + p[0] * ex + p[1] * ey + p[2] * ez) / distance
    along_rate -= along * range_rate / distance
    value = along + t * cosine + sign * radius * sine + EDGE
    return value, along_rate + t_rate * cosine + sine_rate * (sign * radius - t * sine / cosine)


@kernel
def eclipse_curvature(radius, ends, h, one, two):
    """Bound on ``|f''|`` of `eclipse_sight`; the Sun's slow drift enters with its own bounds."""
    r, v, a, t, t1, t2 = _stretched(radius, 1.0, ends, h, one)
    if t <= 0.0:
        return math.inf
    near = two[0] - r
    turn = (v + two[2]) / near
    turn_rate = (a + two[3]) / near + 3.0 * turn * turn
    return (
        a + 2.0 * v * turn + r * turn_rate + t2 + 2.0 * t1 * turn + 2.0 * (r + radius) * turn_rate
    )
