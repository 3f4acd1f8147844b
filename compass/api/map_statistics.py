"""Numbers over all area and time of the maps of a design."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from compass.coverage.drawn import Drawn
from compass.coverage.errors import ERRORS
from compass.coverage.fix_budget import PARTS
from compass.quantities.draws import (
    CONFIDENCE,
    mean_of,
    percentiles,
    quantile_bounds,
    share_of,
)
from compass.quantities.percentile import percentile
from compass.ranging import FACTOR_95
from compass.words import counted

if TYPE_CHECKING:
    import xarray as xr

#: Errors, and what of them 95 % of a rover's fixes stay below for 95 % of area and time.
ROVER = {
    "error_horizontal_m": "rover_horizontal_m",
    "error_vertical_m": "rover_vertical_m",
}

#: Shares of area and time with a fault detectable, and with levels within the alert limits, as
#: kernels and draws name them.
PROTECTED = {
    "detection_share": "detectable",
    "protection_share": "both",
    "protection_horizontal_share": "horizontal",
    "protection_vertical_share": "vertical",
}


def epochs_on(epochs: int, grid: str) -> str:
    """At how many epochs and on which cells a map was looked at."""
    return f"{counted(epochs, 'epoch')} on {grid}"


def statistics(dataset: "xr.Dataset", drawn: Drawn | None = None) -> dict[str, Any]:
    """Area- and time-weighted numbers of a map, as in the JSON of ``compass map``.

    Shares and percentiles are those of what was drawn, with their bounds; without any, of cells.
    """
    shares, dops = dataset.cells_fold_share, dataset.dop.values.tolist()
    if drawn:
        folds = [share_of(str(k), drawn.count >= k) for k in folds_met(dataset)]
        good = drawn.values["pdop"] <= dataset.attrs["pdop_threshold"]
        known = {
            "fold_share": {key: value for each in folds for key, value in each.items()},
            **share_of("availability", good),
        }
        dilutions = {name: percentiles(drawn.values[name], _percents(dataset)) for name in dops}
    else:
        known = {
            "fold_share": {str(k): float(shares.sel(global_fold=k)) for k in folds_met(dataset)},
            "availability": float(dataset.cells_availability),
        }
        dilutions = {name: _of_cells(dataset, dataset.cells_dop.sel(dop=name)) for name in dops}
    least, most = extremes_met(dataset)
    mean = {"mean": float(dataset.cells_count_mean)}
    if drawn:
        mean = mean_of("mean", drawn.count, len(drawn.satellites))
    return {
        "count": {"min": least, **mean, "max": most},
        **known,
        "longest_gap_s": float(dataset.longest_gap.values.max()),
        "mean_response_time_s": float(
            dataset.mean_response_time.values.sum(axis=1) @ dataset.cell_share.values
        ),
        **dilutions,
        **error_statistics(dataset, drawn),
        **protection_statistics(dataset, drawn),
    }


def _percents(dataset: "xr.Dataset") -> list[int]:
    """Which percentiles a map tells."""
    return list(dataset.global_percentile.values.tolist())


def _of_cells(dataset: "xr.Dataset", values: "xr.DataArray") -> dict[str, Any]:
    """Percentiles of cells and epochs."""
    return {f"p{q}": float(values.sel(global_percentile=q)) for q in _percents(dataset)}


def folds_met(dataset: "xr.Dataset") -> list[int]:
    """Satellites that are in view somewhere, and those wanted."""
    shares, wanted = dataset.cells_fold_share, dataset.attrs["wanted_fold"]
    known = zip(shares.global_fold.values.tolist(), shares.values.tolist(), strict=True)
    return [int(k) for k, share in known if k and (k <= wanted or share > 0.0)]


def extremes_met(dataset: "xr.Dataset") -> tuple[int, int]:
    """Fewest and most satellites in view at any cell and epoch."""
    return int(dataset.count_min.values.min()), int(dataset.count_max.values.max())


def error_statistics(dataset: "xr.Dataset", drawn: Drawn | None = None) -> dict[str, Any]:
    """Percentiles of the errors of fixes over area and time, as of `statistics`."""
    if "cells_error" not in dataset:
        return {}
    found: dict[str, Any] = {}
    limit = dataset.attrs["error_limit_m"]
    for name in dataset.error.values.tolist():
        if drawn:
            values = drawn.values[name]
            share = share_of("share", values <= limit)
            if len(drawn.satellites) < 4:
                share = {"share": 0.0, "share_bracket": [0.0, 0.0]}
            found[name] = percentiles(values, _percents(dataset)) | share
            continue
        of = dataset.sel(error=name)
        found[name] = _of_cells(dataset, of.cells_error) | {"share": float(of.cells_error_share)}
    for name, most in ROVER.items():
        of_rover = found[name]
        found[most] = FACTOR_95 * of_rover["p95"]
        if "p95_interval" in of_rover:
            found[f"{most}_interval"] = [FACTOR_95 * end for end in of_rover["p95_interval"]]
    return found | no_fix(drawn) | _budget(dataset, drawn) | {"error_limit_m": limit}


def _budget(dataset: "xr.Dataset", drawn: Drawn | None) -> dict[str, Any]:
    """What a fix is made of: the range's error, its parts, and by how much geometry enlarges it.

    Geometry of a percentile is its ratio to the median error of a range: bounds of both, each wrong
    in half as many cases as others, leave it bounds that hold as others do.
    """
    made = drawn.budget if drawn else None
    if drawn is None or made is None or not made.range_error.size:
        return {}
    tail = 0.25 * (1.0 - CONFIDENCE)
    known = percentiles(made.range_error, (50,))
    sigma, (low, high) = known["p50"], quantile_bounds(made.range_error, 50, tail)
    # so few fixes leave no bound
    nearest, farthest = 1.0 / low if low > 0.0 else np.inf, 1.0 / high

    def geometry(values: NDArray[np.float64]) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for q in _percents(dataset):
            least, most = quantile_bounds(values, q, tail)
            found[f"p{q}"] = float(percentile(values, q)) / sigma
            lower = least if least == np.inf else max(least, 0.0) * farthest
            found[f"p{q}_interval"] = [lower, most * nearest]
        return found

    def parts(shares: NDArray[np.float64]) -> dict[str, Any]:
        return {
            key: value
            for part, own in zip(PARTS, shares.T, strict=True)
            for key, value in mean_of(part, own, 1.0).items()
        }

    by_error = {
        name: {"parts": parts(made.of_fixes[:, k]), "geometry": geometry(drawn.values[name])}
        for k, name in enumerate(ERRORS)
    }
    sizes = {"range_error_m": known["p50"], "range_error_m_interval": known["p50_interval"]}
    return {"fix_budget": {**sizes, "range_parts": parts(made.of_ranges), **by_error}}


def protection_statistics(dataset: "xr.Dataset", drawn: Drawn | None = None) -> dict[str, Any]:
    """Percentiles of the protection levels over area and time, and shares, as of `statistics`."""
    if "cells_protection" not in dataset:
        return {}
    shares = dataset.cells_protection_share
    found: dict[str, Any] = {}
    for name in dataset.level.values.tolist():
        if drawn:
            found[name] = percentiles(drawn.values[name], _percents(dataset))
        else:
            found[name] = _of_cells(dataset, dataset.cells_protection.sel(level=name))
    for name, protected in PROTECTED.items():
        if drawn:
            found |= share_of(name, drawn.protected[protected])
        else:
            found[name] = float(shares.sel(protected=protected))
    return found | no_level(dataset, drawn) | (_after_loss(drawn) if drawn else {})


def in_view_share(dataset: "xr.Dataset", count: int) -> float:
    """Share of area and time with so many satellites in view or more."""
    shares = dataset.cells_fold_share.values
    return float(shares[count]) if count < shares.size else 0.0


def no_fix(drawn: Drawn | None) -> dict[str, Any]:
    """Share of area and time with a fix, and why there is none in the rest, as of `statistics`."""
    if drawn is None or len(drawn.satellites) < 4:
        nowhere = ("fix_share", "singular_share", "masked_share")
        known = dict.fromkeys(nowhere, 0.0) | {"fewer_than_four_share": 1.0}
        return known | {f"{name}_bracket": [share, share] for name, share in known.items()}
    fixed, four = np.isfinite(drawn.values["pdop"]), drawn.count >= 4
    return {
        **share_of("fix_share", fixed),
        **share_of("fewer_than_four_share", ~four),
        **share_of("singular_share", four & ~fixed),
        **share_of("masked_share", ~four & (drawn.risen >= 4)),
    }


def no_level(dataset: "xr.Dataset", drawn: Drawn | None = None) -> dict[str, Any]:
    """Share of area and time with protection levels, and why there are none in the rest.

    As of `statistics`.
    """
    if drawn:
        enough, checked = drawn.count >= 5, drawn.protected["detectable"]
        some = np.isfinite(drawn.values["protection_vertical_m"])
        return {
            **share_of("level_share", some),
            **share_of("fewer_than_five_share", ~enough),
            **share_of("unchecked_share", enough & ~checked),
            **share_of("two_faults_share", checked & ~some),
        }
    level, five = float(dataset.cells_level_share), in_view_share(dataset, 5)
    able = float(dataset.cells_protection_share.sel(protected="detectable"))
    return {
        "level_share": level,
        "fewer_than_five_share": 1.0 - five,
        "unchecked_share": max(five - able, 0.0),
        "two_faults_share": max(able - level, 0.0),
    }


def after_each_loss(drawn: Drawn) -> dict[str, list[dict[str, Any]]]:
    """Shares of `PROTECTED` without each satellite in turn, with bounds that hold for all at once.

    Bounds of each are wrong in so many fewer cases that the best and the worst have bounds too.
    """
    return {
        name: [share_of("share", hits, len(drawn.satellites)) for hits in drawn.left[protected].T]
        for name, protected in PROTECTED.items()
    }


def _after_loss(drawn: Drawn) -> dict[str, Any]:
    """Shares without the satellite whose loss leaves least, if losses were looked at."""
    if not drawn.left:
        return {}
    shares = after_each_loss(drawn)
    ranked = np.array([[one["share"] for one in shares[name]] for name in PROTECTED])
    worst = int(np.lexsort(ranked[:2])[0])
    found: dict[str, Any] = {"satellite": drawn.satellites[worst]}
    for name, each in shares.items():
        found |= {name: each[worst]["share"], f"{name}_interval": each[worst]["share_interval"]}
    for name in ("detection_share", "protection_share"):
        most = max(shares[name], key=lambda one: one["share"])
        ends = [max(one["share_interval"][k] for one in shares[name]) for k in (0, 1)]
        found |= {f"{name}_most": most["share"], f"{name}_most_interval": ends}
    return {"after_loss": found}
