"""From the entry state to Cartesian position and velocity, and to a beacon, with derivatives.

State ``[r, lon, lat, V, gamma, psi]`` (psi clockwise from north); Cartesian axes are Mars-fixed
and velocities relative to the rotating planet.
"""

import math

from compass.core.jit import fast_kernel


@fast_kernel
def cartesian(x, out):
    """Write position (m) and relative velocity (m/s) into `out`, shape (6,)."""
    sl, cl = math.sin(x[2]), math.cos(x[2])
    so, co = math.sin(x[1]), math.cos(x[1])
    up, north, east = _components(x)
    out[0], out[1], out[2] = x[0] * cl * co, x[0] * cl * so, x[0] * sl
    out[3] = up * cl * co - north * sl * co - east * so
    out[4] = up * cl * so - north * sl * so + east * co
    out[5] = up * sl + north * cl


@fast_kernel
def _components(x):
    """Velocity up, north and east, m/s."""
    cg = math.cos(x[4])
    return x[3] * math.sin(x[4]), x[3] * cg * math.cos(x[5]), x[3] * cg * math.sin(x[5])


@fast_kernel
def cartesian_jacobian(x, out):
    """Write the 6 by 6 derivative of `cartesian` with respect to the state into `out`."""
    r = x[0]
    sl, cl = math.sin(x[2]), math.cos(x[2])
    so, co = math.sin(x[1]), math.cos(x[1])
    sg, cg = math.sin(x[4]), math.cos(x[4])
    sp, cp = math.sin(x[5]), math.cos(x[5])
    up, north, east = _components(x)
    out[:, :] = 0.0
    # local axes: up, north, east; their derivatives in longitude and latitude
    ux, uy, uz = cl * co, cl * so, sl
    nx, ny, nz = -sl * co, -sl * so, cl
    ex, ey = -so, co
    out[0, 0], out[1, 0], out[2, 0] = ux, uy, uz
    out[0, 1], out[1, 1] = r * cl * ex, r * cl * ey
    out[0, 2], out[1, 2], out[2, 2] = r * nx, r * ny, r * nz
    vx = up * ux + north * nx + east * ex
    vy = up * uy + north * ny + east * ey
    out[3, 1], out[4, 1] = -vy, vx
    out[3, 2] = up * nx - north * ux
    out[4, 2] = up * ny - north * uy
    out[5, 2] = up * nz - north * uz
    for column, du, dn, de in (
        (3, sg, cg * cp, cg * sp),
        (4, x[3] * cg, -x[3] * sg * cp, -x[3] * sg * sp),
        (5, 0.0, -x[3] * cg * sp, x[3] * cg * cp),
    ):
        out[3, column] = du * ux + dn * nx + de * ex
        out[4, column] = du * uy + dn * ny + de * ey
        out[5, column] = du * uz + dn * nz


@fast_kernel
def range_rows(c, beacon, beacon_velocity, jacobian, range_row, rate_row):
    """Range (m) and range rate (m/s) to a beacon, and their derivatives in the state.

    ``R = |r - b|``, ``R' = n.(v - b')``, ``dR/dr = n``, ``dR'/dr = (I - n n^T)(v - b')/R``,
    ``dR'/dv = n``, chained with `jacobian`, the derivative of ``c = (r, v)`` in the state.
    """
    dx, dy, dz = c[0] - beacon[0], c[1] - beacon[1], c[2] - beacon[2]
    distance = math.sqrt(dx * dx + dy * dy + dz * dz)
    nx, ny, nz = dx / distance, dy / distance, dz / distance
    wx, wy, wz = c[3] - beacon_velocity[0], c[4] - beacon_velocity[1], c[5] - beacon_velocity[2]
    rate = nx * wx + ny * wy + nz * wz
    lx, ly, lz = (
        (wx - rate * nx) / distance,
        (wy - rate * ny) / distance,
        (wz - rate * nz) / distance,
    )
    for j in range(6):
        range_row[j] = nx * jacobian[0, j] + ny * jacobian[1, j] + nz * jacobian[2, j]
        rate_row[j] = (
            lx * jacobian[0, j]
            + ly * jacobian[1, j]
            + lz * jacobian[2, j]
            + nx * jacobian[3, j]
            + ny * jacobian[4, j]
            + nz * jacobian[5, j]
        )
    return distance, rate
