"""Height over a horizon profile, which has corners: bounds on its rate instead of its curvature."""

import math

from compass.core.jit import kernel
from compass.core.motion import meridian, mover_bounds, mover_state

#: Radians. A target this little below the profile still counts as in sight.
EDGE_ANGLE = 1e-9


@kernel
def profile_elevation(masks, first, count, azimuth):
    """Elevation of a profile at an azimuth in [0, 2 pi): linear between its points, periodic."""
    k = first + count - 1
    while k >= first and masks[k, 0] > azimuth:
        k -= 1
    turn = 2.0 * math.pi
    left = k if k >= first else first + count - 1
    right = left + 1 if left + 1 < first + count else first
    a0, a1 = masks[left, 0], masks[right, 0]
    if k < first:
        a0 -= turn
    elif right == first:
        a1 += turn
    share = (azimuth - a0) / (a1 - a0) if a1 > a0 else 0.0
    return masks[left, 1] + share * (masks[right, 1] - masks[left, 1])


@kernel
def horizon_state(numbers, one, two, table, masks, t):
    """Height over the profile, elevation, both distances from the centre, speed, 0, distance apart.

    The speed is the target's in the rotating frame; the layout is that of `events.sight`.
    """
    p, q = mover_state(one, table, t), mover_state(two, table, t)
    angle, rate = meridian(one, t)
    dx, dy, dz = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    c, s = math.cos(angle), math.sin(angle)
    outward, east = c * dx + s * dy, c * dy - s * dx
    up = one[4] * outward + one[5] * dz
    north = one[4] * dz - one[5] * outward
    elevation = math.atan2(up, math.hypot(east, north))
    azimuth = math.atan2(east, north)
    if azimuth < 0.0:
        azimuth += 2.0 * math.pi
    mask = profile_elevation(masks, int(numbers[0]), int(numbers[1]), azimuth)
    vx, vy = q[3] + rate * q[1], q[4] - rate * q[0]
    speed = math.sqrt(vx * vx + vy * vy + q[5] * q[5])
    rp = math.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])
    rq = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2])
    apart = math.sqrt(dx * dx + dy * dy + dz * dz)
    return elevation - mask + EDGE_ANGLE, elevation, rp, rq, speed, 0.0, apart


@kernel
def horizon_clear(numbers, one, two, a, b, h):
    """Whether the target stays on one side of the profile between states a and b.

    Seen from the site it turns no faster than ``w = V/d``, V the largest speed in the rotating
    frame. Its elevation changes at most at w; the profile's at most at ``slope w / cos(el)``.
    Wholly above the highest or below the lowest point of the profile, azimuth does not matter.
    """
    rate = 1.00001 * abs(one[9]) / one[7]
    _, high, speed, acceleration, _, _ = mover_bounds(two, a[3], b[3], h)
    turning = acceleration + 2.0 * rate * speed + 3.0 * rate * rate * high
    fastest = 0.5 * (a[4] + b[4] + turning * h)
    near = 0.5 * (a[6] + b[6] - fastest * h)
    if near <= 0.0:
        return False
    w = fastest / near
    if 0.5 * (a[1] + b[1] - w * h) > numbers[4]:
        return True
    top = 0.5 * (a[1] + b[1] + w * h)
    if top < numbers[3] - EDGE_ANGLE:
        return True
    steepest = max(top, 0.5 * (w * h - a[1] - b[1]))
    if steepest >= 0.5 * math.pi or (a[0] >= 0.0) != (b[0] >= 0.0):
        return False
    return abs(a[0]) + abs(b[0]) > w * (1.0 + numbers[2] / math.cos(steepest)) * h
