"""Coverage pictures: counts, dilution of precision, fold by latitude and over time."""

from typing import TYPE_CHECKING

import numpy as np

from compass.api.map_result import MapResult
from compass.document.blocks import Picture
from compass.pictures.maps import LARGE, draw_map, map_figure, ranged_bar
from compass.pictures.style import (
    CYCLE,
    FAINT,
    HALF,
    INK,
    MARS,
    look,
    new_figure,
    on_mars,
    picture,
    whole_numbers,
)
from compass.quantities import quantity
from compass.words import capital

if TYPE_CHECKING:
    import xarray as xr


def count_picture(mapped: MapResult) -> Picture:
    """Map of the fewest satellites in view over the period."""
    dataset, design = mapped.dataset, mapped.design
    fewest = dataset.count_min.values
    figure = map_figure(
        fewest,
        mapped.made.grid,
        "Fewest satellites in view over the period",
        "satellites in view",
        figure_name=design.figure.name,
        scale="counts",
        wanted=dataset.attrs["wanted_fold"],
    )
    return picture(
        figure,
        "count-min",
        "Fewest satellites in view",
        "The smallest number of satellites in view at any epoch, by cell; red: fewer than wanted.",
        alt=f"Map of Mars: {fewest.min()} to {fewest.max()} satellites in view at least.",
    )


def one_count(mapped: MapResult) -> list[str]:
    """Say what a map of the fewest in view would show in one colour."""
    fewest = mapped.dataset.count_min.values
    if fewest.max() > fewest.min():
        return []
    return [f"At every cell the fewest in view at any epoch are {int(fewest.min())}."]


def dilution_pictures(mapped: MapResult) -> list[Picture]:
    """Maps of GDOP, with names, of its parts side by side, of the share of time with a good PDOP.

    A map of one colour is no map; its sentence is in `one_colour`.
    """
    made = []
    if not mapped.nowhere("gdop"):
        made = [percentile_map(mapped, "gdop", _BELOW, wide=True), _parts(mapped)]
    dataset = mapped.dataset
    threshold, share = dataset.attrs["pdop_threshold"], dataset.availability.values
    if share.max() > share.min():
        figure = map_figure(
            share,
            mapped.made.grid,
            f"Share of time with PDOP at most {threshold:g}",
            "share of time, %",
            figure_name=mapped.design.figure.name,
            scale="share",
        )
        made.append(
            picture(
                figure,
                "availability",
                "Availability",
                f"Share of the period with a position dilution of at most {threshold:g}.",
                alt=f"Map of Mars: from {100 * share.min():.1f} to {100 * share.max():.1f} % of "
                "the time.",
            )
        )
    return made


def one_colour(mapped: MapResult) -> list[str]:
    """Say what maps of one colour would show."""
    said = []
    if mapped.nowhere("gdop"):
        said.append(
            "At no cell is there a fix for 95 % of the time: no dilution has a value that it does "
            "not exceed for so long."
        )
    share, threshold = mapped.dataset.availability.values, mapped.dataset.attrs["pdop_threshold"]
    if share.max() == share.min() == 0.0:
        said.append(f"PDOP is never {threshold:g} or less, at any cell and epoch.")
    elif share.max() == share.min():
        always = f"{100.0 * float(share.min()):.4g} % of the time"
        said.append(f"PDOP is at most {threshold:g} for {always}, at every cell.")
    return said


_BELOW = (
    "Below this value 95 % of the time; infinite where the geometry is singular or fewer than "
    "four satellites are in view for longer than that."
)


def _parts(mapped: MapResult) -> Picture:
    """Maps of the other dilutions, on one scale of colours with that of GDOP."""
    names = ("pdop", "hdop", "vdop", "tdop")
    figure = new_figure(LARGE[0], 6.6)
    with look():
        panels = figure.subplots(2, 2).ravel()
    for axes, name in zip(panels, names, strict=True):
        values = mapped.dataset[name].sel(percentile=95).values
        chart = draw_map(
            axes, values, mapped.made.grid, _title(name), quantity(name).heading,
            figure_name=mapped.design.figure.name, named=False, bar=False,
        )  # fmt: skip
    with look():
        threshold = mapped.dataset.attrs["pdop_threshold"]
        label = f"dilution of precision (grey: none; line: PDOP {threshold:g})"
        ranged_bar(list(panels), chart.mesh, label, threshold)
    said = "; ".join(f"{name.upper()} {_range(mapped, name)}" for name in names)
    return picture(
        figure,
        "dilutions-p95",
        "PDOP, HDOP, VDOP and TDOP, 95th percentile over time",
        _BELOW,
        wide=True,
        alt=f"Four maps of Mars, 95th percentiles over time: {said}.",
    )


def _title(name: str) -> str:
    title = quantity(name).title
    return f"{capital(title)}, 95th percentile over time"


def _range(mapped: MapResult, name: str) -> str:
    values = mapped.dataset[name].sel(percentile=95).values
    finite = values[np.isfinite(values)]
    if not finite.size:
        return "none anywhere"
    unit = quantity(name).shown_unit
    return f"from {finite.min():.3g} to {finite.max():.3g} {unit}".rstrip()


def percentile_map(mapped: MapResult, name: str, caption: str, *, wide: bool = False) -> Picture:
    """Map of what a dilution, error or level does not exceed for 95 % of the time.

    A wide one has names of places.
    """
    figure = map_figure(
        mapped.dataset[name].sel(percentile=95).values,
        mapped.made.grid,
        _title(name),
        quantity(name).heading,
        figure_name=mapped.design.figure.name,
        of=name,
        named=wide,
    )
    return picture(
        figure,
        f"{name.removesuffix('_m').replace('_', '-')}-p95",
        _title(name),
        caption,
        wide=wide,
        alt=f"Map of Mars: {_title(name)}, {_range(mapped, name)}.",
    )


def fold_pictures(dataset: "xr.Dataset") -> list[Picture]:
    """Fold by latitude, and the count's range over time."""
    share = dataset.fold_share_lat
    with look():
        figure = new_figure(*HALF)
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
            ylabel="share of longitude and time, %",
            xlim=(-90, 90),
            xticks=range(-90, 91, 30),
            title="Satellites in view by latitude",
        )
        on_mars(axes.xaxis, "latitude")
        axes.grid(True)
        if drawn:  # none if no cell of the map ever sees a satellite
            axes.legend(
                title="in view", loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=4,
                fontsize=8, frameon=False,
            )  # fmt: skip
        by_latitude = picture(
            figure,
            "fold-latitude",
            "Fold by latitude",
            "How much of each parallel and of the time has at least k satellites in view"
            + (f"; k up to {whole[-1]} is always met." if whole else "."),
        )
        figure = new_figure(*HALF)
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
        whole_numbers(axes.yaxis)
        axes.margins(x=0)
        axes.grid(True, color=FAINT, alpha=0.4)
        axes.legend(
            loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=4, fontsize=8, frameon=False
        )
        over_time = picture(
            figure,
            "fold-time",
            "Fold over time",
            "Fewest, mean and most satellites in view anywhere on the grid, by epoch.",
        )
    return [by_latitude, over_time]
