"""Boxes of a certified share at a moment: what is surely good, surely bad, cut, or open."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.patches import Patch, Rectangle

from compass.coverage.certified_boxes import BoxKind, MomentBoxes
from compass.pictures.style import CYCLE, INK, axes_or_new, on_mars

#: What a kind is called, and its colour.
_KINDS = {
    BoxKind.KEPT: ("good everywhere", CYCLE[5]),
    BoxKind.BROKEN: ("bad everywhere", CYCLE[1]),
    BoxKind.CUT: ("cut: part good, part bad", CYCLE[4]),
    BoxKind.OPEN: ("open", "#ffffff"),
}


def draw_boxes(made: MomentBoxes, title: str, axes: Axes | None = None) -> Axes:
    """Draw the boxes over longitude and latitude, degrees; the share known stands below."""
    drawn = axes_or_new(axes, 8.0, 4.5)
    degrees = np.degrees(made.boxes)
    for kind, (_, colour) in _KINDS.items():
        chosen = degrees[made.kinds == kind]
        boxes = [Rectangle((lon - wl, lat - wb), 2 * wl, 2 * wb) for lat, lon, wb, wl in chosen]
        drawn.add_collection(PatchCollection(boxes, facecolor=colour, edgecolor=INK, lw=0.15))
    low, high = degrees[:, 0] - degrees[:, 2], degrees[:, 0] + degrees[:, 2]
    drawn.set(xlim=(0, 360), ylim=(low.min(), high.max()))
    share = f"{100 * made.low:.2f} to {100 * made.high:.2f} % of the area is good"
    drawn.set(xlabel=f"longitude in the inertial frame, deg; {share}")
    on_mars(drawn.yaxis, "latitude")
    drawn.set_title(title)
    handles = [Patch(facecolor=c, edgecolor=INK, label=name) for name, c in _KINDS.values()]
    drawn.legend(handles=handles, loc="upper right", fontsize=8, ncols=2)
    return drawn
