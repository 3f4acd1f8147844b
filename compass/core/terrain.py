"""The horizon of a place: what every edge of a triangulated terrain hides.

The terrain is a surface of plane triangles. In a vertical half-plane from the eye it is a broken
line, and along a straight piece the elevation seen from the eye grows or falls throughout: the
highest point seen at an azimuth lies on an edge. So the horizon is the upper envelope of the
edges, and no ray has to be marched. Along an edge the tangent of the elevation is
``g . (sin azimuth, cos azimuth)``, where ``up = g . (east, north)`` is the plane through the eye
and the edge: in a sector of azimuths it is highest at an end, or at the azimuth of g.

Rounding moves a tangent by some 1e-15 of the distances' ratio, far less than any grid's error.
But nodes and edges nearer than `NEAREST` to the eye count as the eye's own: rounding would tell
anything of how high they are seen, and the triangles that the eye stands on have other edges.
"""

import math

from compass.core.jit import kernel

#: Metres: places are known to some 1e-9 m, so that a tangent is known to 1e-5 from here on.
NEAREST = 1e-4


@kernel
def raise_horizon(east, north, up, exact, within):
    """Raise a horizon by a patch of a grid, each cell cut from (i, j) to (i + 1, j + 1).

    Parameters
    ----------
    east, north, up
        Nodes of the grid as seen from the eye, metres, shape (rows, columns); nan where unknown.
    exact
        Tangent of the elevation at azimuth ``2 pi k / n``, shape (n,); raised in place.
    within
        Highest tangent in the sector from ``2 pi k / n`` to ``2 pi (k + 1) / n``, shape (n,);
        raised in place.
    """
    rows, columns = east.shape
    for i in range(rows):
        for j in range(columns):
            e, n, u = east[i, j], north[i, j], up[i, j]
            if not (e * e + n * n > NEAREST * NEAREST and math.isfinite(u)):
                continue  # unknown, or the eye itself
            azimuth = math.atan2(e, n)
            k = int(math.floor(azimuth / (2.0 * math.pi) * within.size)) % within.size
            within[k] = max(within[k], u / math.sqrt(e * e + n * n))
            if j + 1 < columns:
                _raise_by_edge(e, n, u, east, north, up, i, j + 1, azimuth, exact, within)
            if i + 1 < rows:
                _raise_by_edge(e, n, u, east, north, up, i + 1, j, azimuth, exact, within)
            if i + 1 < rows and j + 1 < columns:
                _raise_by_edge(e, n, u, east, north, up, i + 1, j + 1, azimuth, exact, within)


@kernel
def _raise_by_edge(e, n, u, east, north, up, i, j, azimuth, exact, within):
    """Raise a horizon by the edge from (e, n, u), at that azimuth, to the node (i, j)."""
    e2, n2, u2 = east[i, j], north[i, j], up[i, j]
    across = e * n2 - n * e2
    length = math.hypot(e2 - e, n2 - n)
    if not (abs(across) > NEAREST * length and math.isfinite(u2)):
        return  # unknown, or seen from its end, where the nodes say it all
    size, turn = exact.size, 2.0 * math.pi
    # up = ge east + gn north is the plane through the eye and the edge
    ge, gn = (u * n2 - u2 * n) / across, (u2 * e - u * e2) / across
    span = math.atan2(e2, n2) - azimuth
    span -= turn * math.floor(span / turn + 0.5)
    start, stop = min(azimuth, azimuth + span), max(azimuth, azimuth + span)
    # the azimuths of the horizon that the edge passes over
    first, last = math.ceil(start / turn * size), math.floor(stop / turn * size)
    for k in range(int(first), int(last) + 1):
        at = k * turn / size
        height = ge * math.sin(at) + gn * math.cos(at)
        exact[k % size] = max(exact[k % size], height)
        within[k % size] = max(within[k % size], height)
        within[(k - 1) % size] = max(within[(k - 1) % size], height)
    # its highest point, where that is between the ends
    top = math.atan2(ge, gn)
    top += turn * math.ceil((start - top) / turn)
    if top <= stop:
        k = int(math.floor(top / turn * size)) % size
        within[k] = max(within[k], math.sqrt(ge * ge + gn * gn))
