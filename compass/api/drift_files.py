"""What `compass drift` hands over: a dataset over time, and the elements to inject."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.conventions import epoch_text
from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY
from compass.orbits.motion import Motion
from compass.quantities import quantity

if TYPE_CHECKING:
    import xarray as xr

    from compass.api.drift_result import DriftResult


def drift_dataset(result: "DriftResult") -> "xr.Dataset":
    """Margin and room over (time), places in the slots over (time, satellite)."""
    import xarray as xr

    drift, names = result.drift, result.design.constellation.satellite_names
    margin = _attributes("cap_margin_deg")
    low, high = np.degrees(drift.least.T)
    data: dict[str, Any] = {
        "least_margin": ("time", low, margin | {"long_name": "least margin of the caps, at least"}),
        "least_margin_high": (
            "time",
            high,
            margin | {"long_name": "least margin of the caps, at most"},
        ),
        "margin": ("time", np.degrees(drift.margin), margin),
    }
    if (room := drift.room) is not None:
        data["room"] = ("time", np.degrees(room.room), _attributes("room_deg"))
        for name, values in (
            ("in_track_deg", np.degrees(room.along)),
            ("cross_track_deg", np.degrees(room.across)),
            ("radial_km", room.radial / 1e3),
        ):
            place = ("time", "satellite")
            data[name.rsplit("_", 1)[0]] = (place, values, _attributes(name))
    coords = {
        "time": ("time", drift.times, {"units": "s", "long_name": "time after the epoch"}),
        "satellite": ("satellite", list(names), {"long_name": "satellite"}),
    }
    attributes = {
        "title": f"Margin and room of {result.design.name}",
        "epoch_tdb": epoch_text(result.design.constellation.epoch),
        "motion": result.motion,
        "fold": drift.lasting.fold,
        "mask_deg": result.mask_deg,
        "outcome": str(result.outcome),
        "days_proven": result.days_proven,
    }
    return xr.Dataset(data, coords, attributes)


def _attributes(name: str) -> dict[str, str]:
    """Attributes of a quantity with its unit as UDUNITS spells it."""
    known = quantity(name).attributes()
    return known | {"units": known["units"].replace("deg", "degree")}


def check_trimmed(trimmed: bool) -> None:
    """Refuse to write elements or orbits to inject without a trim.

    Raises
    ------
    ArgumentError
        There is none.
    """
    if not trimmed:
        raise ArgumentError("elements, oem: the orbits to inject come from a trim; add --trim")


def injected_design(result: "DriftResult") -> Design:
    """The design of the trimmed elements, under the motion that they were trimmed for.

    Raises
    ------
    ArgumentError
        There was no trim.
    """
    check_trimmed(result.trim is not None)
    assert result.trim is not None
    motion = result.design.motion
    flown = Motion("numerical") if motion.model == "two-body" else motion
    return replace(result.design, constellation=result.trim.constellation, motion=flown)


def elements_text(result: "DriftResult") -> str:
    """Design file of trimmed elements, its tolerances as comments before them."""
    from compass.handover.toml import design_toml

    trimmed = injected_design(result)
    days = (result.drift.lasting.stop - result.drift.lasting.start) / SECONDS_PER_DAY
    lines = [f"# Osculating elements to inject, trimmed over {days:.6g} days."]
    if tolerance := result.tolerances():
        lines.append("# Each may be off by this, the others exact, for all of these days:")
        lines += [f"#   {name} {value:.3g}" for name, value in tolerance.items()]
    else:
        left = "left in the slots at the end" if result.drift.room else "known in slots"
        lines.append(f"# No room is {left}: no tolerance can be promised.")
    return "\n".join([*lines, design_toml(trimmed)])
