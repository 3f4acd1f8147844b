"""Datasets as the CF conventions want them in files."""

import re
from datetime import datetime, timedelta
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr

CONVENTIONS = "CF-1.11"

#: What coordinates of these names are.
_AXES = {
    "lat": {"standard_name": "latitude", "units": "degrees_north", "axis": "Y"},
    "lon": {"standard_name": "longitude", "units": "degrees_east", "axis": "X"},
    "time": {"standard_name": "time", "axis": "T"},
}
#: Degrees as the program writes them, by themselves or in a product: "deg/year".
_DEGREES = re.compile(r"\bdeg\b")
_PLACES = {"latitude": "latitude", "longitude": "longitude"}


def in_conventions(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return a dataset with what CF-1.11 asks of its variables, values untouched.

    * Numbers along an axis have no fill value; names along one become a label variable beside
      it, ``dop`` of the axis dop becoming ``dop_name``: an axis takes numbers.
    * Latitude, longitude and time have their standard names and axes; seconds after an epoch
      have it in their units, if the dataset has an attribute ``epoch_tdb`` (ISO 8601).
    * Time, latitude and longitude come last among the dimensions, in this order.
    * Every variable has a long name; one without is called by its own.
    * Names hold no points: ``in_view.min`` becomes ``in_view_min``; units are as UDUNITS knows
      them, ``degree`` for deg.
    * What is known of no source has no text for it: texts of the file that are empty are left out.
    """
    last = [name for name in ("time", "lat", "lon") if name in dataset.dims]
    made = dataset.transpose(..., *last)
    made = made.rename({name: str(name).replace(".", "_") for name in made if "." in str(name)})
    labels = [
        str(name) for name in made.dims if name in made.coords and made[name].dtype.kind in "OUS"
    ]
    for name in labels:
        text = made[name].astype(str)
        made = made.drop_vars(name).assign_coords({f"{name}_name": (name, text.values, text.attrs)})
    epoch = made.attrs.get("epoch_tdb")
    for key in made.variables:
        name, variable = str(key), made[key]
        attrs = variable.attrs
        if name in made.dims:
            attrs.update({k: v for k, v in _AXES.get(name, {}).items() if k not in attrs})
            variable.encoding["_FillValue"] = None
            if name == "time" and epoch and attrs.get("units") == "s":
                attrs |= _since(epoch)
        elif name in _PLACES:
            attrs.setdefault("standard_name", _PLACES[name])
        if variable.dtype.kind in "OUS":
            attrs.pop("units", None)
        if "units" in attrs:
            attrs["units"] = _DEGREES.sub("degree", attrs["units"])
        if not {"long_name", "standard_name", "grid_mapping_name"} & set(attrs):
            attrs["long_name"] = name.replace("_", " ")
    made.attrs = {key: value for key, value in made.attrs.items() if not _is_empty(value)}
    made.attrs.setdefault("Conventions", CONVENTIONS)
    return made


def _is_empty(value: object) -> bool:
    return isinstance(value, str) and not value.strip()


def dated(dataset: "xr.Dataset", *names: str) -> "xr.Dataset":
    """Return a dataset whose times say from which epoch they count, so that xarray can date them.

    Parameters
    ----------
    dataset
        With the epoch as its attribute ``epoch_tdb`` (ISO 8601).
    *names
        Its variables in seconds after the epoch; ``time`` if none is named.
    """
    since, made = _since(dataset.attrs["epoch_tdb"]), dataset.copy()
    for name in names or ("time",):
        made[name].attrs = {**dataset[name].attrs, **since}
    return made


def _since(epoch: str) -> dict[str, str]:
    """Attributes of times in seconds after an epoch; TDB has no leap seconds."""
    return {
        "units": f"seconds since {epoch}",
        "calendar": "standard",
        "units_metadata": "leap_seconds: none",
    }


def epoch_text(seconds_past_j2000: float) -> str:
    """ISO 8601 date and time, TDB, of seconds past J2000."""
    instant = datetime(2000, 1, 1, 12) + timedelta(microseconds=round(seconds_past_j2000 * 1e6))
    return instant.isoformat()
