"""Polygons of any shape on the sphere, cut into convex ones.

From the centre of the sphere great circles are seen as straight lines (the gnomonic projection),
so a polygon that fits into less than half of the sphere is cut like one in the plane: into
triangles by its ears, which are then joined again where that leaves them convex.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.errors import ArgumentError
from compass.frames import direction

#: Corners that a polygon may have.
MOST_CORNERS = 1000


def convex_parts(latitudes: ArrayLike, longitudes: ArrayLike) -> list[NDArray[np.float64]]:
    """Convex polygons that together make one of any shape, edges along great circles.

    Its inside is the part that fits into less than half of the sphere. They do not overlap but
    along their sides (Hertel and Mehlhorn 1983: at most four times as many as the fewest).

    Parameters
    ----------
    latitudes, longitudes
        Of the corners, radians, in either sense of rotation, without the first again at the end.

    Returns
    -------
    parts
        Corners of each as unit vectors, shape (c, 3), anticlockwise seen from above.

    Raises
    ------
    ArgumentError
        Fewer than three corners or more than a thousand, two in a row at one place, sides that
        cross or touch, half of the sphere or more.
    """
    corners = direction(latitudes, longitudes).reshape(-1, 3)
    if not 3 <= len(corners) <= MOST_CORNERS:
        raise ArgumentError(
            f"region = polygon of {len(corners)} corners: allowed 3 to {MOST_CORNERS}"
        )
    flat = _gnomonic(corners)
    _check_sides(flat)
    order = list(range(len(corners)))
    if _area(flat) < 0:
        order.reverse()
    return [corners[part] for part in _join(flat, _ears(flat, order))]


def _gnomonic(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Corners seen from the centre on the plane that touches the sphere amid them, shape (n, 2)."""
    middle = corners.sum(axis=0)
    length = np.linalg.norm(middle)
    # the middle of the corners need not see them all, though some other point might
    if length < 1e-9 or np.any(corners @ middle <= 1e-6 * length):
        raise ArgumentError(
            "region = polygon: does not fit into the half of the sphere around its middle; split "
            "it into smaller ones"
        )
    up = middle / length
    east = np.cross([0.0, 0.0, 1.0] if abs(up[2]) < 0.9 else [1.0, 0.0, 0.0], up)
    east /= np.linalg.norm(east)
    return (
        np.stack([corners @ east, corners @ np.cross(up, east)], axis=-1) / (corners @ up)[:, None]
    )


def _check_sides(p: NDArray[np.float64]) -> None:
    """Refuse sides without length, and sides that meet elsewhere than at the corner they share."""
    n = len(p)
    q = np.roll(p, -1, axis=0)
    for k in np.flatnonzero(np.hypot(*(q - p).T) < 1e-9):
        raise ArgumentError(
            f"region = polygon: corners {k + 1} and {(k + 1) % n + 1} are one place"
        )
    # whether the ends of side j are on different sides of the line through side i, or on it
    start = _turn(p[:, None], q[:, None], p[None])
    end = _turn(p[:, None], q[:, None], q[None])
    parted = (start * end <= 0) | (np.minimum(abs(start), abs(end)) < 1e-12)
    meet = parted & parted.T & _boxes_meet(p, q)
    apart = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
    meet &= (apart > 1) & (apart < n - 1)
    for i, j in np.argwhere(meet):
        raise ArgumentError(
            f"region = polygon: the sides after corners {i + 1} and {j + 1} cross or touch; order "
            "the corners along the rim"
        )
    back, on = p - q, np.roll(q, -1, axis=0) - q
    straight = np.abs(back[:, 0] * on[:, 1] - back[:, 1] * on[:, 0]) < 1e-12
    for k in np.flatnonzero(straight & ((back * on).sum(axis=1) > 0)):
        raise ArgumentError(
            f"region = polygon: turns back on itself at corner {(k + 1) % n + 1}; leave it out"
        )


def _boxes_meet(p: NDArray[np.float64], q: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether the boxes around sides i and j, from p to q, have a point in common."""
    low, high = np.minimum(p, q) - 1e-12, np.maximum(p, q) + 1e-12
    return np.all((low[:, None] <= high[None]) & (low[None] <= high[:, None]), axis=-1)


def _turn(a: NDArray, b: NDArray, c: NDArray) -> NDArray[np.float64]:
    """Twice the area of the triangle a, b, c: positive if it turns left."""
    return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (
        c[..., 0] - a[..., 0]
    )


def _area(p: NDArray[np.float64]) -> float:
    """Twice the area inside corners, positive if they turn left."""
    q = np.roll(p, -1, axis=0)
    return float((p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum())


def _ears(p: NDArray[np.float64], left: list[int]) -> list[list[int]]:
    """Triangles of a polygon whose corners turn left, by cutting off one ear after the other."""
    left, triangles = list(left), []
    while len(left) > 3:
        for k in range(len(left)):
            a, b, c = left[k - 1], left[k], left[(k + 1) % len(left)]
            if _turn(p[a], p[b], p[c]) <= 0:
                continue
            rest = p[[i for i in left if i not in (a, b, c)]]
            inside = (
                (_turn(p[a], p[b], rest) >= 0)
                & (_turn(p[b], p[c], rest) >= 0)
                & (_turn(p[c], p[a], rest) >= 0)
            )
            if not inside.any():
                triangles.append([a, b, c])
                del left[k]
                break
        else:
            # what is left are corners in a line: no area
            return triangles
    if _turn(*p[left]) > 0:
        triangles.append(left)
    return triangles


def _join(p: NDArray[np.float64], parts: list[list[int]]) -> list[list[int]]:
    """Polygons joined along common sides wherever the whole stays strictly convex."""
    joined = True
    while joined:
        joined = False
        owner = {side: k for k, part in enumerate(parts) for side in _sides(part)}
        for (a, b), k in owner.items():
            other = owner.get((b, a))
            if other is None or other == k:
                continue
            one, two = parts[k], parts[other]
            # from b around the first to a, then around the second back to b
            at, back = one.index(b), two.index(a)
            whole = one[at:] + one[:at] + (two[back:] + two[:back])[1:-1]
            corners = p[whole]
            turns = _turn(np.roll(corners, 1, axis=0), corners, np.roll(corners, -1, axis=0))
            if np.all(turns > 1e-12):
                parts = [part for i, part in enumerate(parts) if i not in (k, other)] + [whole]
                joined = True
                break
    return parts


def _sides(part: list[int]) -> list[tuple[int, int]]:
    return list(zip(part, part[1:] + part[:1], strict=True))
