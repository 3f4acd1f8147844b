"""Coverage pictures: counts, dilution of precision, fold by latitude and over time."""

from typing import TYPE_CHECKING

from compass.document.blocks import Picture
from compass.pictures.maps import map_figure
from compass.pictures.style import CYCLE, FAINT, INK, MARS, look, new_figure, picture
from compass.quantities import quantity

if TYPE_CHECKING:
    import xarray as xr

    from compass.coverage.grid import Grid


def map_pictures(dataset: "xr.Dataset", grid: "Grid", figure_name: str) -> list[Picture]:
    """Count (fewest, mean) and dilution-of-precision maps over the period."""
    threshold = dataset.attrs["pdop_threshold"]
    made = [
        picture(
            map_figure(
                dataset.count_min.values,
                grid,
                "Fewest satellites in view over the period",
                "satellites",
                figure_name=figure_name,
                scale="counts",
            ),
            "count-min",
            "Fewest satellites in view",
            "The smallest number of satellites in view at any epoch, by cell.",
        ),
        picture(
            map_figure(
                dataset.count_mean.values,
                grid,
                "Mean satellites in view over the period",
                "satellites, mean over the period",
                figure_name=figure_name,
                scale="linear",
            ),
            "count-mean",
            "Mean satellites in view",
            "The mean number of satellites in view over the period, by cell.",
        ),
    ]
    for name, q in (("gdop", 50), ("gdop", 95), ("pdop", 95), ("hdop", 95), ("vdop", 95)):
        text = f"{quantity(name).title}, {q}th percentile over time"
        made.append(
            picture(
                map_figure(
                    dataset[name].sel(percentile=q).values,
                    grid,
                    text,
                    quantity(name).title,
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
                scale="share",
            ),
            "availability",
            "Availability",
            f"Share of the period with a position dilution of at most {threshold:g}.",
        )
    )
    return made


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
