"""Windows as a dataset: a contiguous ragged array, one row a window, as CF lays it out."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from compass.contacts.windows import Windows

if TYPE_CHECKING:
    import xarray as xr


def windows_dataset(spans: Sequence[Windows], **attributes: object) -> "xr.Dataset":
    """Windows of all pairs over (pair) and (window); `count` says how many rows a pair has."""
    import xarray as xr

    seconds = {"units": "s"}
    columns = {
        "start": ("time after the epoch at which the window opens", seconds),
        "end": ("time after the epoch at which the window closes", seconds),
        "culmination": ("time after the epoch of the highest elevation", seconds),
        "max_elevation": ("highest elevation over the station", {"units": "degree"}),
    }
    values = {name: np.concatenate([getattr(w, name) for w in spans]) for name in columns}
    values["max_elevation"] = np.degrees(values["max_elevation"])
    return xr.Dataset(
        {
            **{
                name: ("window", values[name], {"long_name": title, **unit})
                for name, (title, unit) in columns.items()
            },
            "count": (
                "pair",
                [w.count for w in spans],
                {"long_name": "windows of the pair", "units": "1", "sample_dimension": "window"},
            ),
        },
        coords={
            "first": ("pair", [w.first for w in spans], {"long_name": "one end of the link"}),
            "second": ("pair", [w.second for w in spans], {"long_name": "other end of the link"}),
        },
        attrs={"duration_s": spans[0].duration, **attributes},
    )
