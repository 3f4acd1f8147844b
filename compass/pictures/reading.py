"""What a reader can take from a picture: its maps and curves as numbers beside the drawing.

Places are fractions of the picture from its upper left corner, so that they hold at any size it
is shown. Maps are thinned to at most `ROWS` by `COLUMNS` cells, each kept with its own centre and
its value to three digits; curves to `POINTS` of their points. What stands between is not given.
"""

import base64
import json
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

#: At most so many cells of a map, points of a curve, curves of one set of axes.
ROWS, COLUMNS, POINTS, CURVES = 90, 180, 240, 24

#: Largest value of a thinned map as it is kept, in a half-precision float.
_FULL = 60000.0


@dataclass(frozen=True)
class Field:
    """Values by cell as they are drawn on a map: the mesh, its edges in degrees, the values."""

    mesh: Any
    longitude_edges_deg: ArrayLike
    latitude_edges_deg: ArrayLike
    values: NDArray[Any]
    rim: NDArray[np.float64]


def reading(figure: "Figure") -> str:
    """Return what a drawn figure says in numbers, as JSON; nothing if it has none to give."""
    fields: list[Field] = getattr(figure, "fields", [])
    panels = [_map(field) for field in fields]
    bars = {field.mesh.colorbar.ax for field in fields if field.mesh.colorbar is not None}
    maps = {field.mesh.axes for field in fields}
    for axes in figure.axes:
        if axes.axison and axes not in maps | bars and axes.name == "rectilinear":
            panels += _curves(axes)
    if not panels:
        return ""
    # no "<" of a name can end the element that carries it
    return json.dumps(panels, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


def _map(field: Field) -> dict[str, Any]:
    """A map: where its rim is, centres of the cells kept, their values and what these are."""
    figure, bar = field.mesh.get_figure(), field.mesh.colorbar
    corners = field.mesh.axes.transData.transform([field.rim.min(0), field.rim.max(0)])
    (left, low), (right, high) = figure.transFigure.inverted().transform(corners)
    values: NDArray[np.float64] = np.ma.filled(np.ma.asarray(field.values, float), np.inf)
    rows, columns = (
        np.arange((step := -(-size // most)) // 2, size, step)
        for size, most in zip(values.shape, (ROWS, COLUMNS), strict=True)
    )
    kept = values[np.ix_(rows, columns)]
    finite = kept[np.isfinite(kept)]
    scale = float(np.abs(finite).max()) / _FULL if finite.size and finite.any() else 1.0
    packed = zlib.compress((kept / scale).astype("<f2").tobytes(), 9)
    lon, lat = (
        _centres(edges)[kept_of]
        for edges, kept_of in (
            (field.longitude_edges_deg, columns),
            (field.latitude_edges_deg, rows),
        )
    )
    return {
        "box": _rounded([left, 1 - high, right, 1 - low]),
        "title": field.mesh.axes.get_title(),
        "label": "" if bar is None else bar.ax.get_xlabel().split(" (grey")[0],
        "lon": _rounded(lon, 6),
        "lat": _rounded(lat, 6),
        "scale": scale,
        "values": base64.b64encode(packed).decode("ascii"),
    }


def _curves(axes: "Axes") -> Iterator[dict[str, Any]]:
    """Axes with curves or points: where they are, what the axes mean, each curve's points."""
    scales = {"linear": False, "log": True}
    if axes.get_xscale() not in scales or axes.get_yscale() not in scales:
        return
    lines = [line for line in axes.lines if _told(axes, line)][:CURVES]
    if not lines:
        return
    x0, y0, x1, y1 = axes.get_position().extents
    yield {
        "box": _rounded([x0, 1 - y1, x1, 1 - y0]),
        "title": axes.get_title(),
        "x": [*_rounded(axes.get_xlim(), 7), scales[axes.get_xscale()], axes.get_xlabel()],
        "y": [*_rounded(axes.get_ylim(), 7), scales[axes.get_yscale()], axes.get_ylabel()],
        "lines": [_curve(line) for line in lines],
    }


def _told(axes: "Axes", line: "Line2D") -> bool:
    """Whether a line is one of values: not a mark across the axes, not without a number."""
    x, y = (np.asarray(v, float) for v in line.get_data(orig=False))
    return bool(
        line.get_visible()
        and line.get_transform() == axes.transData
        and (np.isfinite(x) & np.isfinite(y)).any()
    )


def _curve(line: "Line2D") -> dict[str, Any]:
    x, y = (np.asarray(v, float) for v in line.get_data(orig=False))
    known = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
    if known.size > POINTS:
        known = known[np.linspace(0, known.size - 1, POINTS).round().astype(int)]
    name = str(line.get_label())
    return {
        "name": "" if name.startswith("_") else name,
        "x": _rounded(x[known], 5),
        "y": _rounded(y[known], 5),
    }


def _centres(edges: ArrayLike) -> NDArray[np.float64]:
    at = np.asarray(edges, float)
    return (at[1:] + at[:-1]) / 2


def _rounded(values: ArrayLike, digits: int = 5) -> list[float]:
    """Numbers with so many digits, which a page need not carry more of."""
    return [float(f"{value:.{digits}g}") for value in np.asarray(values, float)]
