"""What a reader can take from a picture: its maps and curves as numbers beside the drawing.

Places are fractions of the picture from its upper left corner, so that they hold at any size it
is shown. Maps are thinned to at most `ROWS` by `COLUMNS` cells, each kept with its own centre and
its value to three digits; curves to `POINTS` of their points. What stands between is not given.
Bars and rows of spans are kept whole, up to `BARS` and `SPANS` a picture.
"""

import base64
import json
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.container import BarContainer
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

#: At most so many cells of a map, points of a curve, curves of one set of axes.
ROWS, COLUMNS, POINTS, CURVES = 90, 180, 240, 24

#: At most so many bars of one set of axes, spans of one row.
BARS, SPANS = 200, 400

#: Largest value of a thinned map as it is kept, in a half-precision float.
_FULL = 60000.0


@dataclass(frozen=True)
class Field:
    """Values by cell as they are drawn on a map: the mesh, its edges in degrees, the values.

    `label` says what they are; without it the colour bar does, its own or the one all share.
    """

    mesh: Any
    longitude_edges_deg: ArrayLike
    latitude_edges_deg: ArrayLike
    values: NDArray[Any]
    rim: NDArray[np.float64]
    label: str = ""


@dataclass(frozen=True)
class Rows:
    """Spans as they are drawn, a row a thing, the first on top at 0: from and to of each."""

    axes: "Axes"
    names: tuple[str, ...]
    spans: tuple[NDArray[np.float64], ...]


def reading(figure: "Figure") -> str:
    """Return what a drawn figure says in numbers, as JSON; nothing if it has none to give."""
    fields: list[Field] = getattr(figure, "fields", [])
    rows: list[Rows] = getattr(figure, "rows", [])
    panels = [_map(field) for field in fields] + [_rows(some) for some in rows]
    told = {field.mesh.colorbar.ax for field in fields if field.mesh.colorbar is not None}
    told |= {field.mesh.axes for field in fields} | {some.axes for some in rows}
    for axes in figure.axes:
        if axes.axison and axes not in told and axes.name == "rectilinear":
            panels += [*_bars(axes), *_curves(axes)]
    if not panels:
        return ""
    # no "<" of a name can end the element that carries it
    return json.dumps(panels, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


def _map(field: Field) -> dict[str, Any]:
    """A map: where its rim is, centres of the cells kept, their values and what these are."""
    figure = field.mesh.get_figure()
    shared = (each.mesh.colorbar for each in (field, *figure.fields))
    bar = next((each for each in shared if each is not None), None)
    label = field.label or ("" if bar is None else bar.ax.get_xlabel())
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
        "label": label.split(" (grey")[0],
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
    yield _frame(axes) | {"lines": [_curve(line) for line in lines]}


def _frame(axes: "Axes") -> dict[str, Any]:
    """Where axes are, their ends, whether these are logarithmic, and what they mean."""
    x0, y0, x1, y1 = axes.get_position().extents
    return {
        "box": _rounded([x0, 1 - y1, x1, 1 - y0]),
        "title": axes.get_title(),
        "x": [*_rounded(axes.get_xlim(), 7), axes.get_xscale() == "log", axes.get_xlabel()],
        "y": [*_rounded(axes.get_ylim(), 7), axes.get_yscale() == "log", axes.get_ylabel()],
    }


def _rows(some: Rows) -> dict[str, Any]:
    """Rows of spans: the name of each, and from and to of its spans."""
    told = [
        {"name": name, "from": _rounded(spans[:SPANS, 0], 6), "to": _rounded(spans[:SPANS, 1], 6)}
        for name, spans in zip(some.names, some.spans, strict=True)
    ]
    return _frame(some.axes) | {"rows": told}


def _bars(axes: "Axes") -> Iterator[dict[str, Any]]:
    """Axes with bars: the corners of each, its name by the tick below it, how long it is."""
    drawn = []
    for bars in (some for some in axes.containers if isinstance(some, BarContainer)):
        flat = bars.orientation == "horizontal"
        axis = axes.yaxis if flat else axes.xaxis
        places = zip(axis.get_majorticklocs(), axis.get_majorticklabels(), strict=False)
        names = {float(at): label.get_text() for at, label in places}
        for bar, length in zip(bars.patches, np.asarray(bars.datavalues, float), strict=True):
            x, y = (
                sorted((bar.get_x(), bar.get_x() + bar.get_width())),
                sorted((bar.get_y(), bar.get_y() + bar.get_height())),
            )
            at = float(np.mean(y if flat else x))
            name = names.get(at) or f"{axis.label.get_text()}: {at:.6g}"
            corners = _rounded([x[0], y[0], x[1], y[1]], 7)
            drawn.append({"name": name, "value": float(f"{length:.5g}"), "corners": corners})
    if drawn:
        of = axes.get_xlabel() if flat else axes.get_ylabel()
        yield _frame(axes) | {"bars": drawn[:BARS], "of": of, "flat": flat}


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
