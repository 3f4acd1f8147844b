"""Shares over a polygon of Mars for ever, where ground tracks do not close.

Then every place of a latitude b meets all longitudes alike, and of a polygon only counts how wide
it is there, w(b)::

    share = sum of w kept / sum of w (kept + broken), over belts of latitude.

In a belt w lies between the width of what belongs to the polygon at all its latitudes and of what
does at any: each edge, a great circle, cuts every circle of latitude in one arc about the same
middle, whose half width is monotone in latitude. So the share lies between the bounds with every
doubt on one side, and narrower belts bring them nearer, in proportion to the part of less than a
half that is kept or broken.
"""

from collections.abc import Callable
from math import ceil

import numpy as np
from numpy.typing import NDArray

from compass.core.belt import area_below
from compass.core.compiling import worked

#: Belts at first, and at most.
FEW, MANY = 16, 2048

#: How much widths vary from belt to belt, over their mean: up one side of a bell, down the other.
SLOPE = 2.5

#: How near the first bounds come.
FIRST = 0.05

#: Rounding of widths, radians, and of sums.
ROUNDING = 1e-11

#: Bounds of the share on a belt between two geodetic latitudes, boxes, and why it stopped: asked
#: for how near, in how many seconds and boxes.
BeltShare = Callable[[float, float, float, float, float], tuple[float, float, int, str]]


def widths(
    normals: NDArray[np.float64], e2: float, edges: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Bounds of a polygon's width in longitude in belts of latitude, radians, shape (n,) each.

    Parameters
    ----------
    normals
        Of its edges, inwards, shape (m, 3).
    e2
        Eccentricity squared of the ellipsoid.
    edges
        Geodetic latitudes between the belts, rising, shape (n + 1,).
    """
    flat = np.hypot(normals[:, 0], normals[:, 1])
    middle = np.arctan2(normals[:, 1], normals[:, 0])
    # flat cos(l - middle) >= -z tan(latitude): an arc, all longitudes or none
    height = -normals[:, 2] * (1.0 - e2) * np.tan(edges)[:, np.newaxis]
    flat = np.maximum(flat, 1e-15)  # of the equator as an edge: all longitudes, none or in doubt
    inner, outer = (
        np.arccos(np.clip((height + off) / flat, -1.0, 1.0)) for off in (ROUNDING, -ROUNDING)
    )
    least = _common(middle, np.minimum(inner[:-1], inner[1:])) - ROUNDING
    most = _common(middle, np.maximum(outer[:-1], outer[1:])) + ROUNDING
    return np.maximum(least, 0.0), np.minimum(most, 2 * np.pi)


def _common(middle: NDArray[np.float64], half: NDArray[np.float64]) -> NDArray[np.float64]:
    """Length of what arcs about some middles have in common, by rows of half widths."""
    turn = 2 * np.pi
    ends = np.sort(np.mod(np.concatenate([middle - half, middle + half], axis=1), turn), axis=1)
    ends = np.concatenate([ends, ends[:, :1] + turn], axis=1)
    lengths, at = np.diff(ends, axis=1), 0.5 * (ends[:, 1:] + ends[:, :-1])
    off = np.abs(np.mod(at[:, :, np.newaxis] - middle + np.pi, turn) - np.pi)
    return np.asarray((lengths * np.all(off <= half[:, np.newaxis], axis=2)).sum(axis=1))


def weighed_share(
    normals: NDArray[np.float64],
    e2: float,
    latitudes: tuple[float, float],
    share: BeltShare,
    width: float,
    *,
    budget_s: float,
    budget_boxes: float,
    level: float | None,
    progress: Callable[[float], None],
) -> tuple[float, float, int, str]:
    """Bounds of a polygon's share, boxes looked at, and why it stopped.

    Parameters
    ----------
    normals, e2
        As of `widths`.
    latitudes
        Geodetic, of the polygon.
    share
        What is known of belts.
    width, budget_s, budget_boxes, level, progress
        As of `compass.coverage.certified_share.Search.share`.
    """
    end, near = worked() + budget_s, max(FIRST, width)
    low, high, boxes, stopped, belts = 0.0, 1.0, 0, "", FEW
    while True:
        edges = np.linspace(*latitudes, belts + 1)
        least, most = widths(normals, e2, edges)
        sums, wanted = np.zeros(4), np.flatnonzero(most > ROUNDING)
        each = (budget_boxes - boxes) / max(wanted.size, 1)
        for k in wanted:
            south, north = float(edges[k]), float(edges[k + 1])
            seconds = 0.0 if stopped == "interrupted" else end - worked()
            kept, rest, looked, why = share(south, north, 0.5 * near, seconds, each)
            boxes, stopped = boxes + looked, stopped or why
            area = area_below(north, e2) - area_below(south, e2)
            w, wide = least[k] * area, most[k] * area
            sums += (w * kept, wide * rest, w * (1.0 - rest), wide * (1.0 - kept))
        kept_low, kept_high, broken_low, broken_high = sums
        low = max(low, kept_low / (kept_low + broken_high) - ROUNDING)
        high = min(high, kept_high / max(kept_high + broken_low, 1e-300) + ROUNDING)
        progress(high - low)
        decided = level is not None and (low >= level or high < level)
        if stopped or decided or high - low <= width:
            return low, high, boxes, stopped
        doubt = SLOPE * 2.0 * min(0.5, high, 1.0 - low)
        enough = min(max(ceil(doubt / (0.5 * width)), belts), MANY)
        last, before = near, belts
        # as much doubt is left to what is between bounds as to how wide the polygon is
        belts = min(4 * belts, enough)
        near = max(min(near, doubt / belts), width)
        if belts == before and near > 0.9 * last:
            return low, high, boxes, "resolution"
