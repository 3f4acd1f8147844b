"""Curves of what stations see over time."""

from typing import TYPE_CHECKING

import numpy as np

from compass.frames import SECONDS_PER_DAY
from compass.pictures.style import CYCLE, INK, look, whole_numbers

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

#: Dilutions above this leave the picture.
TALLEST = 20.0


def draw_series(axes: "Axes", dataset: "xr.Dataset", name: str, fold: int) -> None:
    """Draw a count, a dilution or the age of data of every station against time."""
    days = dataset.time.values / SECONDS_PER_DAY
    with look():
        for k, station in enumerate(dataset.station.values.tolist()):
            values = dataset[name].values[k].astype(float)
            dilutes = name not in ("count", "age_h")
            shown = np.where(values > TALLEST, np.nan, values) if dilutes else values
            draw = axes.step if name == "count" else axes.plot
            draw(days, shown, color=CYCLE[k % len(CYCLE)], lw=1.0, label=station)
        if name == "count":
            axes.axhline(fold, color=INK, lw=0.8, ls="--", label=f"{fold} wanted")
            whole_numbers(axes.yaxis)
        axes.set_xlabel("time after the epoch (days)")
        word = {"count": "satellites in view", "age_h": f"since {fold} were last in view (h)"}
        axes.set_ylabel(word.get(name, f"{name.upper()}, up to {TALLEST:g}"))
        axes.set_title("What stations see")
        axes.grid(axis="y")
        axes.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))


def draw_errors(axes: "Axes", dataset: "xr.Dataset", name: str) -> None:
    """Draw an error of every user's fixes against time; without a fix there is no line."""
    days = dataset.time.values / SECONDS_PER_DAY
    with look():
        for k, user in enumerate(dataset.user.values.tolist()):
            values = dataset[name].values[k]
            shown = np.where(np.isfinite(values), values, np.nan)
            axes.plot(days, shown, color=CYCLE[k % len(CYCLE)], lw=1.0, label=user)
        axes.set_yscale("log")
        axes.set_xlabel("time after the epoch (days)")
        axes.set_ylabel(f"{dataset[name].attrs['long_name'].split(',')[0]} (m, 1 sigma)")
        axes.set_title("What users know of their place")
        axes.grid(axis="y")
        axes.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))
