"""Maps of Mars: values by cell drawn in colour, with the places a reader knows."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import BoundaryNorm, LogNorm
from numpy.typing import NDArray

from compass.pictures.colours import count_map
from compass.pictures.mars_map import MarsMap, colour_bar
from compass.pictures.style import MARS, look, new_figure
from compass.quantities import quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from shapely import MultiPolygon

    from compass.coverage.grid import Grid

Scale = Literal["dilution", "counts", "share", "linear"]

#: Width and height, inches, of a map that takes half of a page, and of one across it with names.
SMALL, LARGE = (5.5, 3.7), (9.6, 5.9)


def map_figure(*drawn: Any, named: bool = False, **options: Any) -> "Figure":
    """Return a figure of one map; arguments as of `draw_map` without the axes.

    It is drawn for half the width of a page; `named`, with names of places, for all of it.
    """
    figure = new_figure(*(LARGE if named else SMALL))
    with look():
        axes = figure.add_subplot()
    draw_map(axes, *drawn, named=named, **options)
    return figure


def draw_map(
    axes: "Axes",
    values: NDArray[Any],
    grid: "Grid",
    title: str,
    label: str,
    *,
    figure_name: str,
    scale: Scale = "dilution",
    of: str = "gdop",
    wanted: int = 0,
    threshold: float | None = None,
    named: bool = True,
    shapes: Sequence["MultiPolygon"] = (),
    satellites: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None,
    bar: bool = True,
) -> MarsMap:
    """Draw an equal-area map with graticule, places and a labelled colour bar.

    Parameters
    ----------
    axes
        Where to.
    values
        By cell, shape (row, column).
    grid
        The cells.
    title, label
        Of the map and of its colour bar.
    figure_name
        Reference figure.
    scale
        ``dilution``: logarithmic, on one range for every map of a quantity, infinities in grey;
        ``counts``: whole numbers, one colour each; ``share``: in per cent, from 0 to 100;
        ``linear``.
    of
        The quantity whose range that is: all dilutions share one.
    wanted
        Counts below it are red.
    threshold
        Of that quantity: marked on the colour bar.
    named
        Whether places have names.
    shapes
        Outlines to draw on top, in degrees.
    satellites
        Sub-satellite longitudes and latitudes, degrees.
    bar
        Whether a map on such a range has a colour bar of its own.
    """
    with look():
        chart = MarsMap(axes, figure_name)
        lon, lat = np.degrees(grid.longitude_edges), np.degrees(grid.latitude_edges)
        if scale == "counts":
            low, high = int(values.min()), int(values.max())
            bounds = np.arange(low, high + 2) - 0.5
            colours = count_map(wanted, low, high)
            mesh = chart.field(lon, lat, values, cmap=colours, norm=BoundaryNorm(bounds, colours.N))
            colour_bar(axes, mesh, label, ticks=np.arange(low, high + 1)).ax.minorticks_off()
        elif scale in ("share", "linear"):
            ends = (0.0, 100.0) if scale == "share" else (None, None)
            shown = 100.0 * values if scale == "share" else values
            mesh = chart.field(lon, lat, shown, cmap="viridis", vmin=ends[0], vmax=ends[1])
            colour_bar(axes, mesh, label)
        else:
            mesh = _ranged_field(chart, lon, lat, values, label, of)
            missing = 1 - np.isfinite(values).sum() / values.size
            note = f" (grey: none, {100 * missing:.1f} % of cells)" if missing else ""
            if bar:
                ranged_bar(axes, mesh, label + note, threshold, of=of)
        chart.relief()
        chart.shapes(shapes, facecolor="none", edgecolor="white", linewidth=1.3)
        chart.graticule()
        if named:
            chart.places()
        if satellites is not None:
            chart.points(*satellites, marker="*", ms=9, mfc=MARS, mec="white", mew=0.7)
        axes.set_title(title)
    return chart


def _ranged_field(
    chart: MarsMap, lon: NDArray[Any], lat: NDArray[Any], values: NDArray[Any], label: str, of: str
) -> Any:
    """Logarithmic colours over the range that all maps of a quantity share; infinity is grey."""
    limits = quantity(of).limits
    assert limits is not None
    colours = colormaps["magma_r"].with_extremes(bad="#8a8f98")
    shown = np.ma.masked_invalid(values)
    return chart.field(lon, lat, shown, label, cmap=colours, norm=LogNorm(*limits))


def ranged_bar(
    axes: "Axes | Sequence[Axes]",
    mesh: Any,
    label: str,
    threshold: float | None = None,
    *,
    of: str = "gdop",
) -> None:
    """Draw the colour bar that maps of a quantity share, with its ticks, the threshold marked."""
    ticks = quantity(of).ticks
    bar = colour_bar(axes, mesh, label, extend="both")
    bar.set_ticks(ticks, labels=[f"{tick:g}" for tick in ticks])
    bar.ax.minorticks_off()
    if threshold is not None:
        bar.ax.axvline(threshold, color="white", lw=3)
        bar.ax.axvline(threshold, color="#0072B2", lw=1.6)
