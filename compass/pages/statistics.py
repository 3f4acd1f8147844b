"""The numbers of a coverage map over the whole sphere, for tables and JSON alike."""

from typing import TYPE_CHECKING, Any

from compass.document.blocks import Table

if TYPE_CHECKING:
    import xarray as xr

NAMES = {"gdop": "GDOP", "pdop": "PDOP", "hdop": "HDOP", "vdop": "VDOP", "tdop": "TDOP"}


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
        "fold_share": {
            int(k): float(shares.sel(global_fold=k))
            for k in shares.global_fold.values
            if k and (k <= dataset.attrs["wanted_fold"] or float(shares.sel(global_fold=k)) > 0)
        },
        **dops,
        "availability": float(dataset.global_availability),
        "longest_gap_s": float(dataset.longest_gap.max()),
        "mean_response_time_s": float(
            (dataset.mean_response_time.mean("lon") * dataset.cell_share * dataset.lon.size).sum()
        ),
    }


def statistics_tables(dataset: "xr.Dataset") -> tuple[Table, ...]:
    """The same numbers as tables for reading."""
    numbers = statistics(dataset)
    threshold, fold = dataset.attrs["pdop_threshold"], dataset.attrs["wanted_fold"]
    count = numbers["count"]
    percentiles = [f"p{int(q)}" for q in dataset.global_percentile.values]
    return (
        Table(
            "Satellites in view, over area and time",
            ("figure of merit", "value"),
            (
                ("fewest", count["min"]),
                ("mean", count["mean"]),
                ("most", count["max"]),
                *((f"share with at least {k}", v) for k, v in numbers["fold_share"].items()),
                (f"availability (PDOP at most {threshold:g})", numbers["availability"]),
                (f"longest gap below {fold} in view, s", numbers["longest_gap_s"]),
                (f"mean response time to {fold} in view, s", numbers["mean_response_time_s"]),
            ),
        ),
        Table(
            "Dilution of precision: percentiles over area and time",
            ("", *percentiles),
            tuple((NAMES[str(name)], *numbers[str(name)].values()) for name in dataset.dop.values),
        ),
    )
