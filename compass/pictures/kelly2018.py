"""Pictures of Figures 1 and 4 to 9 of Kelly and Bevilacqua 2018, from their data."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle
from numpy.typing import NDArray

from compass.bodies import KELLY2018_RADIUS
from compass.coverage.grid import equal_angle_grid
from compass.document import Picture
from compass.pictures.maps import draw_map
from compass.pictures.style import CYCLE, FAINT, INK, MARS, SKY, look, new_figure, picture

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

#: Where the constellation is looked at from: longitude and latitude, degrees.
EYE = (-35.0, 25.0)
_CAPTION = "Computed here after Figure {} of Kelly and Bevilacqua 2018."


def draw_figure(number: int, title: str, data: "xr.Dataset") -> Picture:
    """Draw one of the figures.

    Parameters
    ----------
    number
        1 or 4 to 9.
    title
        What it shows.
    data
        As `compass.papers.kelly2018_figures` makes it.
    """
    if number in (1, 4):
        figure = _space(data)
    elif number == 5:
        figure = _planes(data)
    else:
        figure = _profile(data)
    with look():
        figure.suptitle(f"Figure {number}. {title}")
    return picture(figure, f"figure-{number}", title, _CAPTION.format(number), wide=True)


def seen(places: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Places on the sheet, right and up in Mars radii, and whether Mars is before them.

    A parallel view from `EYE`; places have shape (..., 3), metres.
    """
    longitude, latitude = np.radians(EYE)
    towards = np.array(
        [
            np.cos(latitude) * np.cos(longitude),
            np.cos(latitude) * np.sin(longitude),
            np.sin(latitude),
        ]
    )
    right = np.array([-np.sin(longitude), np.cos(longitude), 0.0])
    up = np.cross(towards, right)
    x, y, z = (places @ axis / KELLY2018_RADIUS.value for axis in (right, up, towards))
    return x, y, (z < 0) & (np.hypot(x, y) < 1)


def _space(data: "xr.Dataset") -> "Figure":
    """Mars, orbits where there are any, satellites, and links where there are any."""
    figure = new_figure(7.4, 6.2)
    with look():
        axes = figure.add_subplot()
        axes.add_patch(Circle((0, 0), 1, facecolor=MARS, edgecolor="none", alpha=0.85, zorder=2))
        if "track" in data:
            for k, track in enumerate(data.track.values):
                _line(axes, track, CYCLE[k], f"plane {k + 1}")
        satellites = data.satellite_place.values
        x, y, hidden = seen(satellites)
        axes.plot(x[~hidden], y[~hidden], "o", color=INK, ms=6, zorder=5, label="satellite")
        axes.plot(x[hidden], y[hidden], "o", mfc="none", mec=INK, ms=6, zorder=1)
        if "in_view" in data:
            for k, (name, colour) in enumerate(
                zip(data.site.values, (SKY, "#009E73"), strict=True)
            ):
                _links(axes, data, k, str(name), colour)
        axes.set_aspect("equal")
        axes.set_axis_off()
        axes.legend(loc="lower left", frameon=False, fontsize=8)
    return figure


def _line(axes: Axes, track: Array, colour: str, label: str) -> None:
    """An orbit: full before and beside Mars, left out behind it."""
    x, y, hidden = seen(track)
    axes.plot(
        np.where(hidden, np.nan, x), np.where(hidden, np.nan, y), color=colour, lw=1.4, zorder=3,
        label=label,
    )  # fmt: skip


def _links(axes: Axes, data: "xr.Dataset", site: int, name: str, colour: str) -> None:
    """A site on the ground and lines to the satellites in view of it."""
    (at_x,), (at_y,), _ = seen(data.ground_place.values[site : site + 1])
    linked = data.in_view.values[site]
    x, y, _ = seen(data.satellite_place.values[linked])
    for k in range(len(x)):
        axes.plot([at_x, x[k]], [at_y, y[k]], color=colour, lw=0.9, zorder=4)
    label = f"{name}: {linked.sum()} in view"
    axes.plot([at_x], [at_y], "s", color=colour, mec="white", ms=8, zorder=6, label=label)


def _planes(data: "xr.Dataset") -> "Figure":
    """Maps of the satellites in view, two and three in the plane."""
    figure = new_figure(8.6, 8.6)
    grid = equal_angle_grid(np.radians(180.0 / data.sizes["lat"]))
    for k, satellites in enumerate(data.satellites.values):
        with look():
            axes = figure.add_subplot(2, 1, k + 1)
        values = data["count"].values[k]
        bare = float((values == 0).mean(axis=1) @ grid.cell_share * grid.columns)
        draw_map(
            axes, values, grid,
            f"{satellites} satellites: {100 * bare:.1f} % of the sphere without any",
            "satellites in view", figure_name="kelly2018-sphere", scale="counts",
        )  # fmt: skip
    return figure


def _profile(data: "xr.Dataset") -> "Figure":
    """Bars of the windows, one row a satellite, one colour a station."""
    stations = list(dict.fromkeys(str(name) for name in data.first.values))
    satellites = list(dict.fromkeys(str(name) for name in data.second.values))
    rows = np.repeat(np.arange(data.sizes["pair"]), data["count"].values)
    figure = new_figure(8.6, 4.8)
    with look():
        axes = figure.add_subplot()
        thick = 0.8 / len(stations)
        for s, station in enumerate(stations):
            for k, satellite in enumerate(satellites):
                pair = (data.first.values == station) & (data.second.values == satellite)
                mine = pair[rows]
                start, end = (data[name].values[mine] / 3600 for name in ("start", "end"))
                axes.broken_barh(
                    list(zip(start, end - start, strict=True)), (k - 0.4 + s * thick, thick),
                    color=CYCLE[s], lw=0, label=station if k == 0 else None,
                )  # fmt: skip
        axes.set_yticks(range(len(satellites)), labels=satellites, fontsize=7)
        axes.invert_yaxis()
        axes.set_xlim(0, data.attrs["duration_s"] / 3600)
        axes.set_xlabel("time, h")
        axes.grid(axis="x", color=FAINT, lw=0.4)
        if len(stations) > 1:
            figure.legend(loc="outside lower center", ncols=len(stations), frameon=False)
    return figure
