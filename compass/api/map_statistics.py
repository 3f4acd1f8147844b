"""Numbers over all area and time of the maps of a design."""

from typing import TYPE_CHECKING, Any

import numpy as np

from compass.ranging import FACTOR_95
from compass.words import counted

if TYPE_CHECKING:
    import xarray as xr

#: Errors, and what of them 95 % of a rover's fixes stay below for 95 % of area and time.
ROVER = {
    "error_horizontal_m": "rover_horizontal_m",
    "error_vertical_m": "rover_vertical_m",
}


def epochs_on(epochs: int, grid: str) -> str:
    """At how many epochs and on which cells a map was looked at."""
    return f"{counted(epochs, 'epoch')} on {grid}"


def statistics(dataset: "xr.Dataset") -> dict[str, Any]:
    """Area- and time-weighted numbers of a map, as in the JSON of ``compass map``."""
    shares = dataset.global_fold_share
    dops = {
        str(name): {
            f"p{int(q)}": float(dataset.global_dop.sel(dop=name, global_percentile=q))
            for q in dataset.global_percentile.values
        }
        for name in dataset.dop.values
    }
    return {
        "count": {
            "min": int(dataset.count_min.min()),
            "mean": float(dataset.global_count_mean),
            "max": int(dataset.count_max.max()),
        },
        "fold_share": {str(k): float(shares.sel(global_fold=k)) for k in folds_met(dataset)},
        "availability": float(dataset.global_availability),
        "longest_gap_s": float(dataset.longest_gap.max()),
        "mean_response_time_s": float(
            (dataset.mean_response_time.mean("lon") * dataset.cell_share * dataset.lon.size).sum()
        ),
        **dops,
        **error_statistics(dataset),
        **protection_statistics(dataset),
    }


def folds_met(dataset: "xr.Dataset") -> list[int]:
    """Satellites that are in view somewhere, and those wanted."""
    shares, wanted = dataset.global_fold_share, dataset.attrs["wanted_fold"]
    known = zip(shares.global_fold.values.tolist(), shares.values.tolist(), strict=True)
    return [int(k) for k, share in known if k and (k <= wanted or share > 0.0)]


def error_statistics(dataset: "xr.Dataset") -> dict[str, Any]:
    """Percentiles of the errors of fixes over area and time, with their sampling errors."""
    if "global_error" not in dataset:
        return {}
    names = [f"p{int(q)}" for q in dataset.global_percentile.values]
    found: dict[str, Any] = {}
    for name in dataset.error.values.tolist():
        of = dataset.sel(error=name)
        found[name] = dict(zip(names, of.global_error.values.tolist(), strict=True))
        found[name]["sampling"] = dict(
            zip(names, of.global_error_sampling.values.tolist(), strict=True)
        )
        found[name]["share"] = float(of.global_error_share)
        found[name]["share_sampling"] = float(of.global_error_share_sampling)
    for name, most in ROVER.items():
        found[most] = FACTOR_95 * found[name]["p95"]
    return (
        found
        | no_fix(dataset)
        | _budget(dataset)
        | {"error_limit_m": dataset.attrs["error_limit_m"]}
    )


def _budget(dataset: "xr.Dataset") -> dict[str, Any]:
    """What a fix is made of: the range's error, its parts, and by how much geometry enlarges it."""
    parts = dataset.part.values.tolist()
    if not np.isfinite(sigma := float(dataset.range_error_rms)):
        return {}
    by_error = {}
    for name in dataset.error.values.tolist():
        of = dataset.sel(error=name)
        by_error[name] = {
            "parts": dict(zip(parts, of.fix_part.values.tolist(), strict=True)),
            "geometry": {
                f"p{int(q)}": float(of.global_error.sel(global_percentile=q)) / sigma
                for q in dataset.global_percentile.values
            },
        }
    of_range = dict(zip(parts, dataset.range_part.values.tolist(), strict=True))
    return {"fix_budget": {"range_error_m": sigma, "range_parts": of_range, **by_error}}


def protection_statistics(dataset: "xr.Dataset") -> dict[str, Any]:
    """Percentiles of the protection levels over area and time, and shares that they make."""
    if "global_protection" not in dataset:
        return {}
    names = [f"p{int(q)}" for q in dataset.global_percentile.values]
    found: dict[str, Any] = {
        name: dict(
            zip(names, dataset.global_protection.sel(level=name).values.tolist(), strict=True)
        )
        for name in dataset.level.values.tolist()
    }
    shares = dataset.global_protection_share
    return found | {
        "detection_share": float(shares.sel(protected="detectable")),
        "protection_share": float(shares.sel(protected="both")),
        "protection_horizontal_share": float(shares.sel(protected="horizontal")),
        "protection_vertical_share": float(shares.sel(protected="vertical")),
        **no_level(dataset),
        **_after_loss(dataset),
    }


def in_view_share(dataset: "xr.Dataset", count: int) -> float:
    """Share of area and time with so many satellites in view or more."""
    shares = dataset.global_fold_share.values
    return float(shares[count]) if count < shares.size else 0.0


def no_fix(dataset: "xr.Dataset") -> dict[str, float]:
    """Share of area and time with a fix, and why there is none in the rest."""
    fixed, four = float(dataset.global_fix_share), in_view_share(dataset, 4)
    masked, plain = dataset.four_in_view.values.tolist()
    return {
        "fix_share": fixed,
        "fewer_than_four_share": 1.0 - four,
        "masked_share": plain - masked,
        "singular_share": max(four - fixed, 0.0),
    }


def no_level(dataset: "xr.Dataset") -> dict[str, float]:
    """Share of area and time with protection levels, and why there are none in the rest."""
    level, five = float(dataset.global_level_share), in_view_share(dataset, 5)
    able = float(dataset.global_protection_share.sel(protected="detectable"))
    return {
        "level_share": level,
        "fewer_than_five_share": 1.0 - five,
        "unchecked_share": max(five - able, 0.0),
        "two_faults_share": max(able - level, 0.0),
    }


def _after_loss(dataset: "xr.Dataset") -> dict[str, Any]:
    """Shares without the satellite whose loss leaves least, if losses were looked at."""
    if "loss_protection_share" not in dataset:
        return {}
    shares = dataset.loss_protection_share
    both, able = shares.sel(protected="both").values, shares.sel(protected="detectable").values
    worst = int(np.lexsort((able, both))[0])
    return {
        "after_loss": {
            "satellite": str(dataset.lost.values[worst]),
            "detection_share": float(able[worst]),
            "protection_share": float(both[worst]),
            "protection_horizontal_share": float(shares.sel(protected="horizontal").values[worst]),
            "protection_vertical_share": float(shares.sel(protected="vertical").values[worst]),
            "detection_share_most": float(able.max()),
            "protection_share_most": float(both.max()),
        }
    }
