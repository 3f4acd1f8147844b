"""Lines of sight over a box of latitude, longitude and time: value, slope and bound of curvature.

Within a box with centre c and half-widths h = (hb, hl, ht) a place and moment is c + h u with u in
[-1, 1]^3. Lengths are in equatorial radii of the planet. All bounds are along the straight line
from the centre, u(s) = s u with s from 0 to 1, dots are derivatives by s.

User: geodetic latitude b, up n, place p at a height over the ellipsoid (eccentricity squared e2)
with meridian and normal radii, height added, ``M <= N <= F``. With ``cm = max cos b`` and
``sm = max |sin b|``::

    |n'|  <= v  = sqrt(hb^2 + cm^2 hl^2)            |p'|  <= F v
    |n''| <= wn = sqrt(v^4 + (sm cm hl^2)^2 + (2 sm hb hl)^2)
    |p''| <= wp = F sqrt(v^4 + (sm cm hl^2 + mu hb^2)^2 + (2 sm hb hl)^2),   |dM/db| <= mu F

(parts along n, north and east; ``dM/db = 3 e2 sin b cos b M / (1 - e2 sin^2 b)``).

Line of sight r e = q - p, satellite q with ``|q'| <= S, |q''| <= A ht^2``. With V = F v + S,
Acc = wp + A ht^2 and rm = r - V the shortest it can become::

    e'' = [(q'' - p'') across - 2 (r' along)(r' across)/r]/r - e |r' across|^2/r^2
    |e''| <= D2 = sqrt((Acc/rm + V^2/rm^2)^2 + (V^2/rm^2)^2)       (2 |ab| <= a^2 + b^2)
    |e(u) - e(0) - sum e_d u_d| <= D2/2
    |e(u) - e(0)| <= D1 = min(|sum e_d u_d| + D2/2, V/rm)

An error of the satellite's place up to `slack` moves e by slack/rm: it is added to D1 and,
doubled, to D2. Horizontal and vertical DOP need the local vertical to stand still: along the line
the frame is carried parallel, turned at ``w = n x n'``; then e' becomes ``e' - w x e``, D1 grows
by v and D2 by ``2 v V/rm + v^2 + wn``.

In sight where ``G = F - sin m |q - p| >= 0, F = n.(q - p)``. As ``n.p' = 0``::

    F'' = n''.q + 2 n'.q' + n.q'' - (n.p)'',    |(n.p)''| <= |M - n.p| hb^2

The first two at the centre are a quadratic form in u, ``u'H u``, which lies between the sums of its
negative and of its positive diagonal and twice the entries beside it; along the line they move by
no more than ``s T, T = |n'''| |q| + 3 wn S + 2 v A ht^2``, so that G lies above its tangent by no
more than ``(max u'H u + A ht^2 + |M - n.p| hb^2 + |sin m| (Acc + V^2/rm))/2 + T/6``, and below
it likewise. Near a rim n.q is hardly more than 1 where |q| is many radii: ``wn |q| + 2 v S``, which
bounds the first two anywhere, and is taken where it is less, is several times as large. With
``e^il (cos b, .)``::

    |n'''|^2 <= sm^2 (hb^3 + 3 hb hl^2)^2 + cm^2 (hl^3 + 3 hl hb^2)^2 + cm^2 hb^6

In a satellite's beam, half angle c about the way down w = q/|q|, where

    G = |q| - p.w - cos c |q - p| >= 0

With qm = |q| - S the least that |q| becomes, ``|w'| <= S/qm``, ``|w''| <= A ht^2/qm + 3 (S/qm)^2``
and ``||q|''| <= A ht^2 + S^2/qm``; on a circle |q| stands still, and ``|w''| = |q''|/|q|``. So G
strays from its tangent by no more than half of
``|p''| + 2 |p'||w'| + |p||w''| + ||q|''| + |cos c| (Acc + V^2/rm)``. Where one rim alone passes
through a box, that cuts it; where both do, none of it is surely seen.
"""

import math

import numpy as np

from compass.core.certified.weights import BY, W1, W2, WEIGHED, WEIGHT, line_weight
from compass.core.jit import fused_kernel
from compass.core.kepler import eccentric_anomaly
from compass.core.path import path_state, piece_of

#: Columns of a satellite's row: line of sight, its three slopes, D1, D2, sight and its slopes for
#: the highest and for the lowest mask that can apply, how far either falls below and rises above
#: its tangent, the fourth number of the row (1 without weights, which multiply line of sight and
#: slopes too) and its slopes; then what a weight is found from.
E, SLOPE, FIRST, SECOND, HIGH, LOW, FALL, RISE, LAST = 0, 3, 12, 13, 14, 18, 22, 23, 24
DISTANCE, BOUNDS, HEAVY, WIDTH = 28, 33, 38, 38 + WEIGHED

#: Numbers of a user, see `place`.
USER = 26

#: Columns of an orbit: semi-major axis, eccentricity, cosine and sine of inclination, node,
#: periapsis, mean anomaly at time 0, the rates of these three, greatest speed and acceleration.
#: Of a path: greatest distance, 0, and 4 and 7 as they turn all about the pole into the frame.
#: Where rows are weighed there follows what is known of ranges: `compass.core.certified.weights`.
ORBIT = 12

#: What the kernels take in one array: eccentricity squared of the ellipsoid, error of the
#: satellites' places, height of users, which dilution (as `compass.core.dop`), cosine of the half
#: angle of the satellites' beams, -1 where they reach all around; then what all ranges share.
E2, SLACK, HEIGHT, DOP, BEAM, NUMBERS = 0, 1, 2, 3, 4, 5

#: What a rim cannot fall below: nothing of a box is surely seen.
NOWHERE = 1e9

#: What rounding can move a sight by, relative to the satellite's distance.
SIGHT_ROUNDING = 1e-12


@fused_kernel
def turned_paths(orbits, breaks, paths, t, q, dq):
    """Fill positions and velocities of satellites on paths, seen from a turning frame."""
    piece, state = piece_of(breaks, t), np.empty(6)
    rate = orbits[0, 7]
    c, s = math.cos(orbits[0, 4] + rate * t), math.sin(orbits[0, 4] + rate * t)
    for k in range(orbits.shape[0]):
        path_state(breaks, paths, piece, k, t, state)
        q[k, 0], q[k, 1], q[k, 2] = (
            c * state[0] - s * state[1],
            s * state[0] + c * state[1],
            state[2],
        )
        dq[k, 0] = c * state[3] - s * state[4] - rate * q[k, 1]
        dq[k, 1] = s * state[3] + c * state[4] + rate * q[k, 0]
        dq[k, 2] = state[5]


@fused_kernel
def states(orbits, circles, breaks, paths, t, q, dq):
    """Positions and velocities of satellites at time t, filled in, shape (n, 3).

    With `paths` as in `compass.core.path`, seen from a frame that turns about the pole. With
    `circles`, shape (n, 6), all go around at rate 1 in the plane of two vectors, seen from
    a frame that turns about the pole at minus the first orbit's node rate.
    """
    n = orbits.shape[0]
    if paths.shape[0]:
        turned_paths(orbits, breaks, paths, t, q, dq)
        return
    if circles.shape[0]:
        c, s = math.cos(t), math.sin(t)
        rate = orbits[0, 7]
        cw, sw = (math.cos(rate * t), math.sin(rate * t)) if rate != 0.0 else (1.0, 0.0)
        for k in range(n):
            x = c * circles[k, 0] + s * circles[k, 3]
            y = c * circles[k, 1] + s * circles[k, 4]
            z = c * circles[k, 2] + s * circles[k, 5]
            vx = c * circles[k, 3] - s * circles[k, 0] - rate * y
            vy = c * circles[k, 4] - s * circles[k, 1] + rate * x
            vz = c * circles[k, 5] - s * circles[k, 2]
            q[k, 0], q[k, 1], q[k, 2] = cw * x - sw * y, sw * x + cw * y, z
            dq[k, 0], dq[k, 1], dq[k, 2] = cw * vx - sw * vy, sw * vx + cw * vy, vz
        return
    for k in range(n):
        a, e, ci, si = orbits[k, 0], orbits[k, 1], orbits[k, 2], orbits[k, 3]
        big_e = eccentric_anomaly(orbits[k, 6] + orbits[k, 9] * t, e)
        ce, se = math.cos(big_e), math.sin(big_e)
        root = math.sqrt(1.0 - e * e)
        rate = orbits[k, 9] / (1.0 - e * ce)
        fx, fy, gx, gy = a * (ce - e), a * root * se, -a * se * rate, a * root * ce * rate
        w = orbits[k, 5] + orbits[k, 8] * t
        co, so = math.cos(w), math.sin(w)
        ux, uy = co * fx - so * fy, so * fx + co * fy
        wx = co * gx - so * gy - orbits[k, 8] * uy
        wy = so * gx + co * gy + orbits[k, 8] * ux
        node = orbits[k, 4] + orbits[k, 7] * t
        cn, sn = math.cos(node), math.sin(node)
        q[k, 0], q[k, 1], q[k, 2] = cn * ux - sn * ci * uy, sn * ux + cn * ci * uy, si * uy
        dq[k, 0] = cn * wx - sn * ci * wy - orbits[k, 7] * q[k, 1]
        dq[k, 1] = sn * wx + cn * ci * wy + orbits[k, 7] * q[k, 0]
        dq[k, 2] = si * wy


@fused_kernel
def place(box, e2, height, user):
    """Fill the user's up, place, their slopes and bounds; shape (USER,).

    0:3 up, 3:6 place, 6:9 and 9:12 slopes of up times hb, hl, 12:15 and 15:18 of the place,
    then v, wn, wp, F v, bound of ``|M - n.p| hb^2``, largest ``|sin b|``, bound of the slope of
    n.p by b (``N e2 sin b cos b``), bound of |n'''|.
    """
    b, lon, hb, hl = box[0], box[1], box[3], box[4]
    cb, sb, cl, sl = math.cos(b), math.sin(b), math.cos(lon), math.sin(lon)
    flat = 1.0 - e2 * sb * sb
    normal = 1.0 / math.sqrt(flat)
    meridian = (1.0 - e2) * normal / flat + height
    user[0], user[1], user[2] = cb * cl, cb * sl, sb
    user[5] = (normal * (1.0 - e2) + height) * sb
    normal += height
    user[3], user[4] = normal * user[0], normal * user[1]
    user[6], user[7], user[8] = -hb * sb * cl, -hb * sb * sl, hb * cb
    user[9], user[10], user[11] = -hl * user[1], hl * user[0], 0.0
    for k in range(3):
        user[12 + k] = meridian * user[6 + k]
        user[15 + k] = normal * user[9 + k]
    low, high = b - hb, b + hb
    cm = 1.0 if low <= 0.0 <= high else max(math.cos(low), math.cos(high))
    sm = min(1.0, max(abs(math.sin(low)), abs(math.sin(high))))
    if high >= 0.5 * math.pi or low <= -0.5 * math.pi:
        sm = 1.0
    most = 1.0 / math.sqrt(1.0 - e2) + height
    mu = 1.5 * e2 / (1.0 - e2)
    v2 = hb * hb + cm * cm * hl * hl
    v = math.sqrt(v2)
    north, east = sm * cm * hl * hl, 2.0 * sm * hb * hl
    user[18] = v
    user[19] = math.sqrt(v2 * v2 + north * north + east * east)
    north += mu * hb * hb
    user[20] = most * math.sqrt(v2 * v2 + north * north + east * east)
    user[21] = most * v
    user[22] = max(1.0 / math.sqrt(1.0 - e2) - math.sqrt(1.0 - e2), e2) * hb * hb
    user[23] = sm
    user[24] = e2
    b3, l3 = hb * (hb * hb + 3.0 * hl * hl), hl * (hl * hl + 3.0 * hb * hb)
    user[25] = math.sqrt((sm * b3) ** 2 + (cm * l3) ** 2 + (cm * hb * hb * hb) ** 2)


@fused_kernel
def mask_range(azimuths, elevations, azimuth, half):
    """Lowest and highest elevation of a profile within `half` of an azimuth, radians."""
    n = azimuths.size
    low, high = elevations.min(), elevations.max()
    if n == 1 or half >= math.pi or low == high:
        return low, high
    turn = 2.0 * math.pi
    low, high = math.inf, -math.inf
    for k in range(n):  # the part of each side of the profile that lies in the interval
        a0, m0 = azimuths[k], elevations[k]
        a1 = azimuths[k + 1] if k + 1 < n else azimuths[0] + turn
        m1 = elevations[(k + 1) % n]
        for shift in (-turn, 0.0, turn):
            left, right = max(a0, azimuth + shift - half), min(a1, azimuth + shift + half)
            if left <= right:
                for a in (left, right):
                    m = m0 + (m1 - m0) * (a - a0) / (a1 - a0)
                    low, high = min(low, m - 1e-12), max(high, m + 1e-12)
    return low, high


@fused_kernel
def azimuth_reach(user, ex, ey, ez, first):
    """Azimuth of a line of sight at the centre of a box, and how far it can be from that in it.

    The line turns by `first` at most, up and with it the horizon by v, and north turns about up
    by no more than ``hl |sin b|``.
    """
    ring = math.hypot(user[0], user[1])
    if ring < 1e-9:
        return 0.0, math.pi
    east = (ey * user[0] - ex * user[1]) / ring
    north = ez * ring - user[2] * (ex * user[0] + ey * user[1]) / ring
    level = math.hypot(east, north)
    turn = first + user[18]
    if turn >= level:
        return 0.0, math.pi
    # slopes by longitude have length cos b hl
    spin = math.hypot(user[9], user[10]) / ring * user[23]
    azimuth = math.atan2(east, north) % (2.0 * math.pi)
    return azimuth, math.asin(turn / level) + spin + 1e-12


@fused_kernel
def in_beam(row, user, q, moved, r, away, beam, rest):
    """Whether a box is in a satellite's beam: 0 nowhere, 1 all of it, 2 in part.

    Where the beam's rim alone passes through the box, it takes the place of the mask's in the row.
    `moved` is how far the satellite goes in half of the box's time, `rest` how far the rim strays
    from its tangent.
    """
    at = away - (user[3] * q[0] + user[4] * q[1] + user[5] * q[2]) / away - beam * r
    s0 = -(user[12] * q[0] + user[13] * q[1] + user[14] * q[2]) / away
    s1 = -(user[15] * q[0] + user[16] * q[1] + user[17] * q[2]) / away
    rise = (moved[0] * q[0] + moved[1] * q[1] + moved[2] * q[2]) / away
    down = (user[3] * q[0] + user[4] * q[1] + user[5] * q[2]) / away
    s2 = rise - (user[3] * moved[0] + user[4] * moved[1] + user[5] * moved[2] - down * rise) / away
    s0 -= beam * row[DISTANCE + 1]
    s1 -= beam * row[DISTANCE + 2]
    s2 -= beam * row[DISTANCE + 3]
    reach = abs(s0) + abs(s1) + abs(s2)
    if at + reach + rest < 0.0:
        return 0
    if at - reach - rest >= 0.0:
        return 1
    least = row[HIGH] - abs(row[HIGH + 1]) - abs(row[HIGH + 2]) - abs(row[HIGH + 3])
    if least - row[FALL] >= 0.0:
        for rim in (HIGH, LOW):
            row[rim], row[rim + 1], row[rim + 2], row[rim + 3] = at, s0, s1, s2
        row[FALL] = row[RISE] = rest
    else:
        row[FALL] = NOWHERE
    return 2


@fused_kernel
def sights(box, user, orbits, q, dq, numbers, level, mask, rows, kinds):
    """Fill the rows of satellites that a box may see, and which: 1 surely, 2 in part.

    Parameters
    ----------
    box
        Centre and half-widths b, l, t, hb, hl, ht.
    user
        From `place`.
    orbits, q, dq
        Orbits, and states at the centre.
    numbers
        See `E2`.
    level
        Whether the local vertical is to stand still.
    mask
        Two rows: azimuths and elevations.
    rows, kinds
        Filled; shapes (n, WIDTH) and (n,).

    Returns
    -------
    count
        Rows filled; -1 where a satellite comes too near for the bounds to hold.
    """
    azimuths, elevations = mask[0], mask[1]
    slack, weighed = numbers[SLACK], orbits.shape[1] > ORBIT
    ht, v, wn = box[5], user[18], user[19]
    nx, ny, nz = user[0], user[1], user[2]
    beam = numbers[BEAM]
    out = 1.0 + abs(numbers[HEIGHT])  # no user is farther from the centre
    constant = azimuths.size == 1
    lowest, highest = elevations.min(), elevations.max()
    sin_high, sin_low = math.sin(highest), math.sin(lowest)
    count = 0
    for k in range(orbits.shape[0]):
        row = rows[count]
        rx, ry, rz = q[k, 0] - user[3], q[k, 1] - user[4], q[k, 2] - user[5]
        tx, ty, tz = dq[k, 0] * ht, dq[k, 1] * ht, dq[k, 2] * ht
        up = nx * rx + ny * ry + nz * rz
        speed, farthest = orbits[k, 10] * ht, orbits[k, 0] * (1.0 + orbits[k, 1])
        # G <= n.(q - p) over a mask from 0 on, which changes by no more than this: most satellites
        # below end here
        if lowest >= 0.0 and up + v * (farthest + speed + user[24]) + speed + slack < 0.0:
            continue
        bend = orbits[k, 11] * ht * ht
        speed = min(math.sqrt(tx * tx + ty * ty + tz * tz) + bend, speed)
        away = math.sqrt(q[k, 0] * q[k, 0] + q[k, 1] * q[k, 1] + q[k, 2] * q[k, 2])
        r = math.sqrt(rx * rx + ry * ry + rz * rz)
        reach = user[21] + speed
        nearest = r - reach - slack
        if nearest <= 0.1 * r:
            return -1
        swing = user[20] + bend
        pull = reach * reach / (nearest * nearest)
        across = (swing + 2.0 * slack) / nearest + pull
        second = math.sqrt(across * across + pull * pull)
        turn = reach / nearest
        ex, ey, ez = rx / r, ry / r, rz / r
        row[0], row[1], row[2] = ex, ey, ez
        sine_up = up / r
        for d in range(3):
            if d < 2:
                mx, my, mz = -user[12 + 3 * d], -user[13 + 3 * d], -user[14 + 3 * d]
            else:
                mx, my, mz = tx, ty, tz
            along = ex * mx + ey * my + ez * mz
            row[3 + 3 * d] = (mx - ex * along) / r
            row[4 + 3 * d] = (my - ey * along) / r
            row[5 + 3 * d] = (mz - ez * along) / r
            # slopes of n.(q - p), and of |q - p|
            slope = nx * mx + ny * my + nz * mz
            if d < 2:
                sx, sy, sz = user[6 + 3 * d], user[7 + 3 * d], user[8 + 3 * d]
                slope += sx * rx + sy * ry + sz * rz
            row[HIGH + 1 + d], row[LOW + 1 + d] = slope, along
            row[DISTANCE + 1 + d] = along
        row[LAST], row[LAST + 1], row[LAST + 2], row[LAST + 3] = 1.0, 0.0, 0.0, 0.0
        first = chord(row) + 0.5 * second
        first = min(first, turn + slack / nearest)
        if not constant:
            azimuth, half = azimuth_reach(user, ex, ey, ez, first)
            low, high = mask_range(azimuths, elevations, azimuth, half)
            sin_high, sin_low = math.sin(high), math.sin(low)
        anywhere = wn * (away + speed) + 2.0 * v * speed
        third = (user[25] * (away + speed) + 3.0 * wn * speed + 2.0 * v * bend) / 3.0
        turn_b = -box[3] * box[3] * (up + nx * user[3] + ny * user[4] + nz * user[5])
        turn_l = -box[4] * box[4] * (nx * q[k, 0] + ny * q[k, 1])
        beside = abs(box[4] * (user[6] * q[k, 1] - user[7] * q[k, 0]))
        beside += abs(user[6] * tx + user[7] * ty + user[8] * tz)
        beside += abs(user[9] * tx + user[10] * ty + user[11] * tz)
        fall = min(2.0 * beside - min(turn_b, 0.0) - min(turn_l, 0.0) + third, anywhere)
        rise = min(2.0 * beside + max(turn_b, 0.0) + max(turn_l, 0.0) + third, anywhere)
        far = swing + reach * reach / nearest
        error = SIGHT_ROUNDING * away + 2.0 * slack
        row[HIGH], row[LOW] = up - sin_high * r, up - sin_low * r
        least, most = row[HIGH], row[LOW]
        for d in range(3):
            slope, along = row[HIGH + 1 + d], row[LOW + 1 + d]
            row[HIGH + 1 + d] = slope - sin_high * along
            row[LOW + 1 + d] = slope - sin_low * along
            least -= abs(row[HIGH + 1 + d])
            most += abs(row[LOW + 1 + d])
        rest = 0.5 * (bend + user[22] + max(abs(sin_high), abs(sin_low)) * far) + error
        row[FALL], row[RISE] = 0.5 * fall + rest, 0.5 * rise + rest
        if most + row[RISE] < 0.0:
            continue
        kinds[count] = 1 if least - row[FALL] >= 0.0 else 2
        if beam > -1.0:
            least_out = away - speed - slack
            if least_out <= 0.1 * away:
                return -1
            turned, spun = speed / least_out, bend / least_out
            bent = user[20] + 2.0 * user[21] * turned + abs(beam) * far
            # paths have no rate of the mean anomaly
            if orbits[k, 1] != 0.0 or orbits[k, 9] == 0.0:
                spun += 3.0 * turned * turned
                bent += bend + speed * turned
            bent += out * spun
            error = SIGHT_ROUNDING * (away + out) + (2.0 + out / least_out) * slack
            inside = in_beam(row, user, q[k], (tx, ty, tz), r, away, beam, 0.5 * bent + error)
            if inside == 0:
                continue
            if inside == 2:
                kinds[count] = 2
        rate = 0.0
        if weighed:
            rate = min(chord(row) + second, turn + slack / nearest)
            row[DISTANCE], row[DISTANCE + 4] = r, sine_up
            row[BOUNDS], row[BOUNDS + 1], row[BOUNDS + 2] = reach, swing, nearest
            row[BOUNDS + 3], row[BOUNDS + 4] = rate, second
            if not line_weight(row[:3], row[3:12], user, row[DISTANCE:BOUNDS], q[k], dq[k], ht,
                               orbits[k, 7], row[BOUNDS:HEAVY], orbits[k, ORBIT:],
                               numbers[NUMBERS:], slack, row[HEAVY:WIDTH]):  # fmt: skip
                return -1
        if level:
            for d in range(2):
                sx, sy, sz = user[6 + 3 * d], user[7 + 3 * d], user[8 + 3 * d]
                lean = sx * ex + sy * ey + sz * ez
                row[3 + 3 * d] += nx * lean - sx * sine_up
                row[4 + 3 * d] += ny * lean - sy * sine_up
                row[5 + 3 * d] += nz * lean - sz * sine_up
            second += 2.0 * v * turn + v * v + wn
            first = min(first + v, chord(row) + 0.5 * second)
            rate += v
        if weighed:
            first, second = weighed_row(row, row[HEAVY:WIDTH], rate, second)
        row[FIRST], row[SECOND] = first, second
        count += 1
    return count


@fused_kernel
def weighed_row(row, weight, rate, second):
    """Multiply a row by its weight; return bounds of how far it strays, and of its curvature.

    `rate` and `second` bound the line of sight's first and second derivatives; see `line_weight`.
    """
    w = weight[WEIGHT]
    for d in range(3):
        by = weight[BY + d]
        row[LAST + 1 + d] = by
        for k in range(3):
            row[SLOPE + 3 * d + k] = w * row[SLOPE + 3 * d + k] + by * row[k]
    for k in range(3):
        row[k] *= w
    row[LAST] = w
    heavy = w + weight[W1]
    second = 1.4142135623730952 * weight[W2] + 2.0 * weight[W1] * rate + heavy * second
    return chord(row) + 0.5 * second, second


@fused_kernel
def chord(row):
    """Bound of ``|sum a_d u_d|`` over the box, a the row of which e is a part."""
    total = 0.0
    for d in range(3):
        for f in range(d + 1):
            dot = row[LAST + 1 + d] * row[LAST + 1 + f]
            for k in range(3):
                dot += row[3 + 3 * d + k] * row[3 + 3 * f + k]
            total += abs(dot) if d == f else 2.0 * abs(dot)
    return math.sqrt(total)
