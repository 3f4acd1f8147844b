"""Figures of a map over all area and time, and their bounds, as variables of its dataset.

What cells and epochs come to stands beside them, as ``cells_...``.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.api.map_statistics import PROTECTED, after_each_loss
from compass.coverage.drawn import Drawn
from compass.coverage.fix_budget import PARTS
from compass.document import Bracket, Interval

if TYPE_CHECKING:
    import xarray as xr

#: A number of `compass.api.map_statistics.statistics`: where it stands, and its name there.
Place = tuple[dict[str, Any], str]


def with_global(
    dataset: "xr.Dataset", numbers: dict[str, Any], drawn: Drawn | None
) -> "xr.Dataset":
    """Return a map with its numbers over all area and time as ``global_...``.

    Beside each stand ``..._low`` and ``..._high``; where no bounds are known these are nan.
    """
    copy = dataset.copy()
    if "fix_budget" in numbers:
        copy.coords["part"] = list(PARTS)
    for name, places in _places(dataset, numbers).items():
        own, about = name.replace("global_", "cells_"), _ABOUT.get(name, {})
        dims = tuple(dataset[own].dims) if own in dataset else _DIMS.get(name, ())
        if own in dataset:
            about = dataset[own].attrs | about
            said = f"{about['long_name']}, of cells and epochs"
            copy[own] = copy[own].assign_attrs(long_name=said)
        known = [_known(*place) for place in places]
        for end, values in zip(("", "_low", "_high"), zip(*known, strict=True), strict=False):
            said = f"{_ENDS[end]}{about['long_name']}"
            evidence = _evidence(known)
            copy[name + end] = (
                dims, np.array(values, dtype=float).reshape([copy.sizes[dim] for dim in dims]),
                about | {"long_name": said, "evidence": evidence},
            )  # fmt: skip
    return copy if drawn is None or not drawn.left else _with_losses(copy, drawn)


_ENDS = {"": "", "_low": "lower bound of ", "_high": "upper bound of "}

_ABOUT: dict[str, dict[str, str]] = {
    "global_dop": {"long_name": "percentile over area and time"},
    "global_count_min": {"units": "1", "long_name": "fewest satellites in view anywhere"},
    "global_count_max": {"units": "1", "long_name": "most satellites in view anywhere"},
    "global_range_error": {
        "units": "m", "long_name": "median error of the ranges of fixes, one sigma"
    },
    "global_range_part": {
        "units": "1", "long_name": "share of the variance of the ranges of fixes, mean"
    },
    "global_fix_part": {"units": "1", "long_name": "share of the variance of fixes, mean"},
}  # fmt: skip

#: Of those that no cells tell.
_DIMS = {"global_range_part": ("part",), "global_fix_part": ("error", "part")}


def _places(dataset: "xr.Dataset", numbers: dict[str, Any]) -> dict[str, list[Place]]:
    """Where the numbers of each variable stand, in the order of its values."""
    percentiles = [f"p{q}" for q in dataset.global_percentile.values.tolist()]

    def ranks(names: Sequence[str]) -> list[Place]:
        return [(numbers[name], p) for name in names for p in percentiles]

    folds = dataset.global_fold.values.tolist()
    places: dict[str, list[Place]] = {
        "global_dop": ranks(dataset.dop.values.tolist()),
        "global_fold_share": [(numbers["fold_share"], str(k)) for k in folds],
        "global_count_min": [(numbers["count"], "min")],
        "global_count_mean": [(numbers["count"], "mean")],
        "global_count_max": [(numbers["count"], "max")],
        "global_availability": [(numbers, "availability")],
    }
    if "cells_error" in dataset:
        errors = dataset.error.values.tolist()
        places |= {
            "global_error": ranks(errors),
            "global_error_share": [(numbers[name], "share") for name in errors],
            "global_fix_share": [(numbers, "fix_share")],
        }
    if (budget := numbers.get("fix_budget")) is not None:
        made_of = [budget[name]["parts"] for name in dataset.error.values.tolist()]
        places |= {
            "global_range_error": [(budget, "range_error_m")],
            "global_range_part": [(budget["range_parts"], part) for part in PARTS],
            "global_fix_part": [(own, part) for own in made_of for part in PARTS],
        }
    if "cells_protection" in dataset:
        named = {protected: name for name, protected in PROTECTED.items()}
        places |= {
            "global_protection": ranks(dataset.level.values.tolist()),
            "global_protection_share": [
                (numbers, named[of]) for of in dataset.protected.values.tolist()
            ],
            "global_level_share": [(numbers, "level_share")],
        }
    return places


def _known(of: dict[str, Any], key: str) -> tuple[float, float, float, str]:
    """A number, its bounds, and what these are; nan where it was not looked at."""
    value = of.get(key, np.nan)
    for kind in (Bracket, Interval):
        if (ends := kind.beside(of, key)) is not None:
            return value, ends.low, ends.high, kind.WORDS
    return value, np.nan, np.nan, "of cells and epochs"


def _evidence(known: list[tuple[float, float, float, str]]) -> str:
    """What the bounds of a variable are, where it has a value."""
    kinds = dict.fromkeys(kind for value, *_, kind in known if not np.isnan(value))
    return ", or ".join(kinds)


def _with_losses(dataset: "xr.Dataset", drawn: Drawn) -> "xr.Dataset":
    """Return a map with the shares that are protected without each satellite, and their bounds."""
    shares = after_each_loss(drawn)
    named = {protected: name for name, protected in PROTECTED.items()}
    each = [shares[named[of]] for of in dataset.protected.values.tolist()]
    about = {
        "units": "1",
        "long_name": "share of area and time after the loss of one satellite",
        "evidence": f"{Interval.WORDS}, all at once: {drawn.how}",
    }
    values = np.array([[[one["share"], *one["share_interval"]] for one in of] for of in each])
    parts = {
        f"loss_protection_share{end}": (
            ("lost", "protected"), part.T, about | {"long_name": _ENDS[end] + about["long_name"]},
        )
        for end, part in zip(_ENDS, np.moveaxis(values, 2, 0), strict=True)
    }  # fmt: skip
    return dataset.assign(parts).assign_coords(lost=list(drawn.satellites))
