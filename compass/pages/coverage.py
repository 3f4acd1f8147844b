"""Coverage pictures: counts, dilution of precision, fold by latitude and over time."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import BoundaryNorm, LogNorm
from numpy.typing import NDArray

from compass.document.blocks import Picture
from compass.pages.statistics import NAMES
from compass.pictures.mars_map import MarsMap, colour_bar
from compass.pictures.style import CYCLE, FAINT, INK, MARS, look, new_figure, picture, steps_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure
    from shapely import MultiPolygon

    from compass.coverage.grid import Grid


def map_figure(
    values: NDArray[Any],
    grid: "Grid",
    title: str,
    label: str,
    *,
    figure_name: str,
    counts: bool = False,
    share: bool = False,
    shapes: Sequence["MultiPolygon"] = (),
    satellites: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None,
) -> "Figure":
    """One equal-area map with graticule, places and a labelled colour bar.

    Parameters
    ----------
    values
        By cell, shape (row, column).
    grid
        The cells.
    title, label
        Of the map and of its colour bar.
    figure_name
        Reference figure.
    counts
        Whole numbers: one colour each. Otherwise a logarithmic scale, infinities in grey.
    share
        A share from 0 to 1, on a linear scale.
    shapes
        Outlines to draw on top, in degrees.
    satellites
        Sub-satellite longitudes and latitudes, degrees.
    """
    with look():
        figure = new_figure(8.6, 5.4)
        axes = figure.add_subplot()
        chart = MarsMap(axes, figure_name)
        lon, lat = np.degrees(grid.longitude_edges), np.degrees(grid.latitude_edges)
        if counts:
            low, high = int(values.min()), int(values.max())
            bounds = np.arange(low, high + 2) - 0.5
            colours = steps_of("viridis", high - low + 1)
            mesh = chart.field(lon, lat, values, cmap=colours, norm=BoundaryNorm(bounds, colours.N))
            bar = colour_bar(axes, mesh, label, ticks=np.arange(low, high + 1))
            bar.ax.minorticks_off()
        elif share:
            mesh = chart.field(lon, lat, values, cmap="viridis", vmin=0.0, vmax=1.0)
            colour_bar(axes, mesh, label)
        else:
            _dop_field(chart, lon, lat, values, label)
        chart.shapes(shapes, facecolor="none", edgecolor="white", linewidth=1.3)
        chart.graticule()
        chart.places()
        if satellites is not None:
            chart.points(*satellites, marker="*", ms=9, mfc=MARS, mec="white", mew=0.7)
        axes.set_title(title)
    return figure


def _dop_field(
    chart: MarsMap, lon: NDArray[Any], lat: NDArray[Any], values: NDArray[Any], label: str
) -> None:
    """Logarithmic colours from the smallest value to the 99th percentile; infinity is grey."""
    finite = values[np.isfinite(values)]
    shown = np.ma.masked_invalid(values)
    if finite.size == 0:
        low, high = 1.0, 10.0
    else:
        low = float(finite.min())
        high = max(float(np.quantile(finite, 0.99)), low * 1.05)
    colours = colormaps["magma_r"].with_extremes(bad="#8a8f98")
    mesh = chart.field(lon, lat, shown, cmap=colours, norm=LogNorm(low, high))
    missing = 1 - finite.size / values.size
    note = f" (grey: none, {missing:.1%} of cells)" if missing else ""
    bar = colour_bar(chart.axes, mesh, label + note, extend="max")
    ticks = np.geomspace(low, high, 6)
    bar.set_ticks(ticks, labels=[f"{tick:.3g}" for tick in ticks])
    bar.ax.minorticks_off()


def map_pictures(dataset: "xr.Dataset", grid: "Grid", figure_name: str) -> list[Picture]:
    """Count (fewest, mean) and dilution-of-precision maps over the period."""
    threshold = dataset.attrs["pdop_threshold"]
    mean = dataset.count_mean.values
    made = [
        picture(
            map_figure(
                dataset.count_min.values,
                grid,
                "Fewest satellites in view over the period",
                "satellites",
                figure_name=figure_name,
                counts=True,
            ),
            "count-min",
            "Fewest satellites in view",
            "The smallest number of satellites in view at any epoch, by cell.",
        ),
        picture(
            _mean_count(mean, grid, figure_name),
            "count-mean",
            "Mean satellites in view",
            "The mean number of satellites in view over the period, by cell.",
        ),
    ]
    for name, q in (("gdop", 50), ("gdop", 95), ("pdop", 95), ("hdop", 95), ("vdop", 95)):
        text = f"{NAMES[name]}, {q}th percentile over time"
        made.append(
            picture(
                map_figure(
                    dataset[name].sel(percentile=q).values,
                    grid,
                    text,
                    NAMES[name],
                    figure_name=figure_name,
                ),
                f"{name}-p{q}",
                text,
                f"Below this value {q} % of the time; infinite where the geometry is singular or "
                "fewer than four satellites are in view for longer than that.",
            )
        )
    made.append(
        picture(
            map_figure(
                dataset.availability.values,
                grid,
                f"Availability: share of time with PDOP at most {threshold:g}",
                "share of time",
                figure_name=figure_name,
                share=True,
            ),
            "availability",
            "Availability",
            f"Share of the period with a position dilution of at most {threshold:g}.",
        )
    )
    return made


def _mean_count(values: NDArray[Any], grid: "Grid", figure_name: str) -> "Figure":
    with look():
        figure = new_figure(8.6, 5.4)
        axes = figure.add_subplot()
        chart = MarsMap(axes, figure_name)
        mesh = chart.field(
            np.degrees(grid.longitude_edges),
            np.degrees(grid.latitude_edges),
            values,
            cmap="viridis",
        )
        colour_bar(axes, mesh, "satellites, mean over the period")
        chart.graticule()
        chart.places()
        axes.set_title("Mean satellites in view over the period")
    return figure


def fold_pictures(dataset: "xr.Dataset") -> list[Picture]:
    """Fold by latitude, and the count's range over time."""
    share = dataset.fold_share_lat
    with look():
        figure = new_figure(8.0, 4.2)
        axes = figure.add_subplot()
        partial = [k for k in share.fold.values if float(share.sel(fold=k).mean()) > 1e-9]
        whole = [k for k in partial if float(share.sel(fold=k).min()) >= 1 - 1e-9]
        drawn = [k for k in partial if k not in whole[:-1]]
        for n, k in enumerate(drawn):
            axes.plot(
                dataset.lat,
                100 * share.sel(fold=k),
                color=CYCLE[n % len(CYCLE)],
                label=f"at least {k}",
                lw=1.8,
            )
        axes.set(
            xlabel="latitude, degrees north",
            ylabel="share of longitude and time, %",
            xlim=(-90, 90),
            xticks=range(-90, 91, 30),
            title="Satellites in view by latitude",
        )
        axes.grid(True)
        if drawn:  # none if no cell of the map ever sees a satellite
            axes.legend(
                title="in view", loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False
            )
        by_latitude = picture(
            figure,
            "fold-latitude",
            "Fold by latitude",
            "How much of each parallel and of the time has at least k satellites in view"
            + (f"; k up to {whole[-1]} is always met." if whole else "."),
        )
        figure = new_figure(8.0, 3.4)
        axes = figure.add_subplot()
        hours = dataset.time / 3600
        low, mean, high = (dataset[f"count_{s}_time"] for s in ("min", "mean", "max"))
        axes.fill_between(
            hours, low, high, step="mid", color=CYCLE[5], alpha=0.35, lw=0, label="range on Mars"
        )
        axes.plot(hours, mean, color=CYCLE[0], lw=1.8, label="mean on Mars")
        axes.plot(hours, low, color=MARS, lw=1.4, label="fewest")
        axes.axhline(dataset.attrs["wanted_fold"], color=INK, lw=0.8, ls="--", label="wanted")
        axes.set(
            xlabel="time after the epoch, h",
            ylabel="satellites in view",
            ylim=(0, None),
            title="Satellites in view over time",
        )
        axes.margins(x=0)
        axes.grid(True, color=FAINT, alpha=0.4)
        axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
        over_time = picture(
            figure,
            "fold-time",
            "Fold over time",
            "Fewest, mean and most satellites in view anywhere on the grid, by epoch.",
        )
    return [by_latitude, over_time]
