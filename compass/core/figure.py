"""Who sees a satellite over an ellipsoid: caps that surely do, and caps beyond which none does.

Stretched along the pole by ``s = a/b``, ``S = diag(1, 1, s)``, an ellipsoid of revolution is a
sphere of radius a. With q the unit vector to the user's stretched place, ``R = S r`` the stretched
satellite and ``D = R - a q`` the sight, the elevation e over the ellipsoid's normal obeys

    sin e = (q.R - a)/(|S q| |S^-1 D|) = sin e' / kappa,
    kappa^2 = (1 + (s^2 - 1) q_z^2) (1 - (1 - 1/s^2) d_z^2),    d = D/|D|,

e' the elevation over the sphere. So a mask of 0 gives caps exactly, and any other lies between the
caps of the sphere for the least and the greatest kappa that can occur: ``1/s`` to ``s`` anywhere,
and the closer the narrower the band of latitude (of q) and the shorter the time. For those bounds
kappa need only be known where e' comes near the mask: where ``sin e'`` is outside ``sin e`` times
1/s to s, it decides whatever kappa is.
"""

import math

import numpy as np

from compass.core.jit import kernel

#: Steps of azimuth, half a turn of them, at which the rim of a cap is looked at.
RIM = 180

#: What a few sums and roots of numbers about 1 may be wrong by.
ROUNDING = 1e-14


@kernel
def _within(value):
    return min(1.0, max(-1.0, value))


@kernel
def _sight(distance, sphere_radius, sin_mask):
    """Distance from a user to a satellite that stands at an elevation."""
    cos2 = max(0.0, 1.0 - sin_mask * sin_mask)
    reach = distance * distance - sphere_radius * sphere_radius * cos2
    return math.sqrt(max(0.0, reach)) - sphere_radius * sin_mask


@kernel
def _rim(distance, sphere_radius, sin_mask):
    """Radius of the cap of the sphere that sees a satellite above a mask."""
    mask = math.asin(_within(sin_mask))
    return math.acos(_within(sphere_radius * math.cos(mask) / distance)) - mask


@kernel
def stretched_cap(sphere_radius, stretch, mask, south, north, far, near, distant, height, rise):
    """Bounds of the cap of one stretched satellite, in a band and for a while.

    Parameters
    ----------
    sphere_radius, stretch, mask
        Equatorial radius, metres, its ratio to the polar one, and the mask, radians.
    south, north
        As in `stretched_caps`.
    far, near, distant
        Distance of the stretched satellite from the centre, and between what bounds it stays, m.
    height, rise
        Its height over the equator, and by how much that changes at most, m.

    Returns
    -------
    inner, outer
        Radii of the caps in which every user sees it above the mask and outside which none does.
    across, along, by_time
        What lies between the two by the band's own width, by that of the sights and by the time,
        radians.
    """
    e2 = 1.0 - 1.0 / (stretch * stretch)
    f2 = stretch * stretch - 1.0
    sin_mask = math.sin(mask)
    least_q = 0.0 if south <= 0.0 <= north else min(abs(south), abs(north))
    most_q = max(abs(south), abs(north))
    below, above = sin_mask / stretch, sin_mask * stretch
    if sin_mask < 0.0:
        below, above = above, below
    # how steeply the sight may run where the satellite stands near the mask
    n0, n1 = height - rise - sphere_radius * north, height + rise - sphere_radius * south
    least_n = 0.0 if n0 <= 0.0 <= n1 else min(abs(n0), abs(n1))
    most_n = max(abs(n0), abs(n1))
    shortest = _sight(near, sphere_radius, _within(above))
    longest = _sight(distant, sphere_radius, _within(below))
    most_d = 1.0 if most_n >= shortest else most_n / shortest
    least_d = min(1.0, least_n / longest)
    k0 = math.sqrt((1.0 + f2 * least_q * least_q) * (1.0 - e2 * most_d * most_d))
    k1 = math.sqrt((1.0 + f2 * most_q * most_q) * (1.0 - e2 * least_d * least_d))
    t0, t1 = k0 * sin_mask, k1 * sin_mask
    inner = _rim(far, sphere_radius, max(t0, t1)) - ROUNDING
    outer = _rim(far, sphere_radius, min(t0, t1)) + ROUNDING
    steep = e2 * most_d * abs(sin_mask) / shortest
    across = 0.5 * f2 * abs(sin_mask) * (most_q * most_q - least_q * least_q)
    return inner, outer, across, steep * sphere_radius * (north - south), 2.0 * steep * rise


@kernel
def stretched_caps(orbits, ground, half, south, north, u, radius, stray, outer):
    """Turn caps of the sphere at mask 0 into bounds for an ellipsoid, in place.

    Parameters
    ----------
    orbits, ground
        As in `compass.core.certificate.settle`.
    half
        Seconds: bounds hold so long before and after.
    south, north
        Band of the sphere, sines of latitude, in which they hold.
    u, radius, stray
        What `caps_at` gives for the sphere of the equatorial radius with mask 0. They take the
        directions to the stretched satellites, the radii of caps in which every user sees them
        above the mask, and how far directions and radii can stray, shape (n, 3), (n,), (n,).
    outer
        Takes the radii of caps outside which none does, shape (n,).

    Returns
    -------
    by_band, by_time
        About how much of what lies between the two caps is due to the width of the band, and how
        much to the length of the time, radians.
    """
    by_band, by_time = 0.0, 0.0
    elements, poles, gm = orbits.elements, orbits.poles, orbits.gm
    sphere_radius, stretch = ground.radius, ground.stretch
    f2 = stretch * stretch - 1.0
    for s in range(radius.size):
        distance = sphere_radius / math.cos(radius[s])
        a, e = elements[0, s], elements[1, s]
        x, y, z = u[s, 0], u[s, 1], stretch * u[s, 2]
        norm = math.sqrt(x * x + y * y + z * z)
        u[s, 0], u[s, 1], u[s, 2] = x / norm, y / norm, z / norm
        far = norm * distance
        # rates: of height from the stretched centre, and of the stretched height over the equator
        p = a * (1.0 - e * e)
        speed = math.sqrt(gm / p)
        tilt = math.sqrt(poles[s, 0] * poles[s, 0] + poles[s, 1] * poles[s, 1])
        climb = tilt * speed * (1.0 + e)
        rate = e * speed + f2 * climb
        low, high = max(a * (1.0 - e), far - rate * half), far + rate * half
        rise = stretch * climb * half
        radius[s], outer[s], across, along, moving = stretched_cap(
            sphere_radius, stretch, ground.mask, south, north, far, low, high, z * distance, rise
        )
        by_band = max(by_band, across + along)
        by_time = max(by_time, moving)
        growth = rate * sphere_radius / (low * math.sqrt(low * low - sphere_radius**2))
        stray[s] = stretch * stray[s] + growth * half
    return by_band, by_time


@kernel
def _round_the_rim(distance, height, sphere_radius, stretch, cap):
    """Least sine of the elevation over a circle about a satellite, seen from the centre.

    Looked at in `RIM` steps of azimuth, less what it can change by from the nearest of them. With q
    and R as above, ``c = q.R/|R|`` changes with the azimuth by at most ``2 f2 w``, where
    ``f2 = s^2 - 1`` and w is the sine of the circle's radius times the cosine of its middle's
    latitude; ``sin e'`` with c by at most ``R^2/D^2``, and kappa by at most
    ``s^3 (f2 + (1 - 1/s^2) a/D)``.
    """
    f2, e2 = stretch * stretch - 1.0, 1.0 - 1.0 / (stretch * stretch)
    rise = _within(height / distance)
    level = math.sqrt(1.0 - rise * rise)
    cc, sc = math.cos(cap), math.sin(cap)
    lowest, steepest, nearest = math.inf, 0.0, math.inf
    for k in range(RIM + 1):
        turn = math.pi * k / RIM
        north, east = sc * math.cos(turn), sc * math.sin(turn)
        x, y, z = cc * level - north * rise, east, cc * rise + north * level
        reach = sphere_radius / math.sqrt(x * x + y * y + stretch * stretch * z * z)
        px, py, pz = x * reach, y * reach, z * reach
        nx, ny, nz = px, py, stretch * stretch * pz
        dx, dy, dz = distance * level - px, -py, distance * rise - pz
        norm = math.sqrt(nx * nx + ny * ny + nz * nz)
        sine = (nx * dx + ny * dy + nz * dz) / (norm * math.sqrt(dx * dx + dy * dy + dz * dz))
        lowest, steepest = min(lowest, sine), max(steepest, abs(sine))
        nearest = min(nearest, dx * dx + dy * dy + stretch * stretch * dz * dz)
    if stretch == 1.0:
        return lowest
    far2 = distance * distance * (level * level + stretch * stretch * rise * rise)
    half, moves = 0.5 * math.pi / RIM, 2.0 * f2 * sc * level
    nearest -= 2.0 * math.sqrt(far2) * sphere_radius * moves * half
    if nearest <= 0.0:
        return -1.0
    tilt = 1.05 * steepest * stretch**3 * (f2 + e2 * sphere_radius / math.sqrt(nearest))
    return lowest - half * (moves * far2 / nearest + tilt)


@kernel
def inner_cap(distance, height, sphere_radius, stretch, mask):
    """Largest cap about a satellite, as an angle at the centre, in which all users see it.

    Users on the ellipsoid, over its normal; to 1e-9 rad and what `_round_the_rim` leaves open, on
    the safe side. Along every great circle from below the satellite its elevation falls, so that
    the rim decides.

    Parameters
    ----------
    distance, height
        Of the satellite, from the centre and over the equator, m.
    sphere_radius, stretch, mask
        As in `stretched_cap`.

    Returns
    -------
    cap
        Radians; 0 if there is none.
    """
    wanted, low, high = math.sin(mask), 0.0, math.pi
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        if _round_the_rim(distance, height, sphere_radius, stretch, middle) >= wanted:
            low = middle
        else:
            high = middle
    return low


@kernel
def inner_caps(distances, heights, sphere_radius, stretch, mask):
    """`inner_cap` of many satellites, shape (k,)."""
    radii = np.empty(distances.size)
    for k in range(distances.size):
        radii[k] = inner_cap(distances[k], heights[k], sphere_radius, stretch, mask)
    return radii
