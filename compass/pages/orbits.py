"""Pictures of a constellation: in three dimensions, as ground tracks, and its caps and gaps."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from numpy.typing import NDArray

from compass.coverage.cap import cap_radius
from compass.coverage.gap import gap, gap_outline
from compass.design import Design
from compass.document.blocks import Picture
from compass.document.numbers import significant
from compass.frames import latitude_longitude
from compass.orbits import orbital_period, positions_mci, positions_mcmf, repeat_period
from compass.pictures.maps import LARGE
from compass.pictures.mars_map import MarsMap
from compass.pictures.style import CYCLE, FAINT, INK, MARS, look, new_figure, picture
from compass.units import KM
from compass.words import counted

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Tracks that miss their start by less than this, degrees (60 mm on the ground), close.
CLOSED_DEG = 1e-6
#: Beyond this many satellites their names would cover the picture.
MAX_NAMED = 30


def groups(design: Design) -> list[list[int]]:
    """Satellites that share a colour: those of a plane, or each one where there are no planes."""
    pattern = design.constellation.pattern
    if pattern is None:
        return [[k] for k in range(design.constellation.size)]
    s = pattern.per_plane
    return [list(range(k * s, (k + 1) * s)) for k in range(pattern.planes)]


def orbit_picture(design: Design) -> Picture:
    """Draw the orbits and satellites in the inertial frame at the epoch, Mars to scale."""
    c, radius = design.constellation, design.figure.equatorial_radius / KM
    reach = float(c.apoapsis_radius.max()) / KM
    now = positions_mci(c, [0.0])[:, 0] / KM
    sight = _viewpoint(24.0, -50.0)
    with look():
        figure = new_figure(5.4, 4.9)
        axes = figure.add_subplot(projection="3d", computed_zorder=False)
        axes.view_init(elev=24, azim=-50)
        axes.set_proj_type("ortho")
        _globe(axes, radius)
        for n, group in enumerate(groups(design)):
            colour = CYCLE[n % len(CYCLE)]
            lead = group[0]
            period = float(orbital_period(c.semi_major_axis[lead], c.gm))
            path = positions_mci(c, np.linspace(0, period, 241))[lead] / KM
            for piece, front in _pieces(path, _hidden(path, sight, radius)):
                axes.plot(*piece.T, color=colour, lw=1.3, alpha=1.0 if front else 0.18,
                          zorder=5 if front else 1)  # fmt: skip
            for k in group:
                hidden = bool(_hidden(now[k][None], sight, radius)[0])
                axes.plot(*now[k][:, None], "o", ms=6, color=colour, mec="white", mew=0.8,
                          alpha=0.25 if hidden else 1.0, zorder=1 if hidden else 6)  # fmt: skip
        limit = reach * 0.78
        axes.set(xlim=(-limit, limit), ylim=(-limit, limit), zlim=(-limit, limit))
        axes.set_box_aspect((1, 1, 1), zoom=0.88)  # room for the words beside it
        axes.set_xlabel("x, km", labelpad=8)
        axes.set_ylabel("y, km", labelpad=8)
        axes.set_zlabel("z (spin axis), km", labelpad=10)
        axes.tick_params(labelsize=8)
        axes.locator_params(nbins=5)
        axes.set_title(f"{design.name}: orbits at the epoch")
    return picture(
        figure,
        "orbits",
        "Orbits in the inertial frame",
        "Satellites at the epoch, one colour a plane; Mars to scale, what it hides drawn faint.",
    )


def _viewpoint(elevation_deg: float, azimuth_deg: float) -> NDArray[np.float64]:
    e, a = np.radians([elevation_deg, azimuth_deg])
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def _hidden(
    points: NDArray[np.float64], sight: NDArray[np.float64], radius: float
) -> NDArray[np.bool_]:
    """Which points the globe hides from a far viewer in direction `sight`."""
    along = points @ sight
    aside = np.linalg.norm(points - along[:, None] * sight, axis=1)
    return (along < 0) & (aside < radius)


def _pieces(
    path: NDArray[np.float64], hidden: NDArray[np.bool_]
) -> list[tuple[NDArray[np.float64], bool]]:
    """Cut a path where it goes behind the globe; True for what is in front."""
    cuts = np.flatnonzero(np.diff(hidden)) + 1
    starts = [0, *cuts.tolist()]
    stops = [*(cuts + 1).tolist(), len(path)]
    return [(path[a:b], not hidden[a]) for a, b in zip(starts, stops, strict=True)]


def _globe(axes: "Axes", radius: float) -> None:
    lon, lat = np.meshgrid(np.linspace(0, 2 * np.pi, 73), np.linspace(-np.pi / 2, np.pi / 2, 37))
    axes.plot_surface(  # type: ignore[attr-defined]
        radius * np.cos(lat) * np.cos(lon), radius * np.cos(lat) * np.sin(lon),
        radius * np.sin(lat), color="#c8744f", lw=0, antialiased=True, shade=True, zorder=3,
    )  # fmt: skip


def track_picture(design: Design) -> Picture:
    """Draw the ground tracks over one repeat period (at most ten revolutions)."""
    c = design.constellation
    repeat = repeat_period(c)
    slowest = float(orbital_period(c.semi_major_axis, c.gm).max())
    duration = min(repeat.duration, 10 * slowest)
    steps = int(np.clip(duration / slowest * 360, 360, 4000))
    lat, lon = latitude_longitude(positions_mcmf(c, np.linspace(0, duration, steps)))
    lat, lon = np.degrees(lat), np.degrees(lon)
    with look():
        figure = new_figure(*LARGE)
        axes = figure.add_subplot()
        chart = MarsMap(axes, design.figure.name)
        chart.relief()
        chart.graticule()
        for n, group in enumerate(groups(design)):
            colour = CYCLE[n % len(CYCLE)]
            for k in group:
                chart.track(lon[k], lat[k], colors=colour, linewidths=1.1, alpha=0.85)
            chart.points(lon[group, 0], lat[group, 0], marker="o", ms=6.5, mfc=colour, mec="white")
            if c.size <= MAX_NAMED:
                for k in group:
                    x, y = chart.project(lon[k, 0], lat[k, 0])
                    figure.names.append(
                        axes.annotate(c.satellite_names[k], (float(x), float(y)), (5, 5),
                                      textcoords="offset points", fontsize=9, color=colour,
                                      weight="bold", zorder=8)
                    )  # fmt: skip
        chart.places()  # whose names give way to those of satellites
        axes.set_title(f"{design.name}: ground tracks over {duration / 3600:.2f} h")
    miss = float(np.degrees(repeat.closure))
    closed = "close" if miss < CLOSED_DEG else f"miss their start by {significant(miss, 3)}°"
    return picture(
        figure,
        "ground-tracks",
        "Ground tracks",
        "Satellites at the epoch and their tracks; after "
        f"{counted(repeat.sidereal_days, 'rotation')} of Mars and "
        f"{counted(repeat.revolutions, 'revolution')} the tracks {closed}.",
        wide=True,
    )


def cap_picture(design: Design) -> Picture:
    """Draw the caps of one plane on the sphere, and the gap they leave, seen from the pole."""
    c, radius = design.constellation, design.figure.equatorial_radius
    first = groups(design)[0]
    r = positions_mci(c, [0.0])[first, 0]
    distance = np.linalg.norm(r, axis=1)
    u = r / distance[:, None]
    caps = cap_radius(distance, radius, design.mask.lowest)
    pole = np.array([0.0, 0.0, 1.0])
    if len(first) > 1:
        normal = np.cross(u[0], u[1])
        length = float(np.linalg.norm(normal))
        pole = normal / length if length > 1e-9 else np.array([0.0, 0.0, 1.0])
    away = u[0] - (u[0] @ pole) * pole
    if np.linalg.norm(away) < 1e-9:
        away = np.array([1.0, 0.0, 0.0])
    tilt = np.radians(28.0)
    up = away / np.linalg.norm(away)
    sight = np.cos(tilt) * pole - np.sin(tilt) * up
    frame = np.array([np.cross(up, sight), np.cross(sight, np.cross(up, sight)), sight])
    per_plane = c.pattern.per_plane if c.pattern else 0
    geometry = (
        gap(float(c.semi_major_axis[0]), radius, per_plane, design.mask.lowest)
        if per_plane >= 3
        else None
    )
    with look():
        figure = new_figure(5.2, 5.2)
        axes = figure.add_subplot()
        axes.set_aspect("equal")
        axes.set_axis_off()
        turn = np.linspace(0, 2 * np.pi, 361)
        disc = np.column_stack([np.cos(turn), np.sin(turn)])
        axes.add_patch(PathPatch(Path(disc), facecolor="#f3ddd0", edgecolor=INK, lw=1.0))
        _sphere_grid(axes, frame, pole, up)
        for n in range(len(first)):
            rim = _circle(u[n], float(caps[n]), turn)
            colour = CYCLE[n % len(CYCLE)]
            _on_disc(axes, rim @ frame.T, colour, c.satellite_names[first[n]])
            spot = frame @ u[n]
            if spot[2] > 0:
                axes.plot(*spot[:2], "o", ms=7, color=colour, mec="white", zorder=5)
        if geometry is not None:
            outline = gap_outline(u[0], pole, geometry, 90) @ frame.T
            axes.add_patch(
                PathPatch(
                    Path(outline[:, :2], closed=True),
                    facecolor=MARS,
                    alpha=0.55,
                    edgecolor=MARS,
                    lw=1.6,
                )
            )
            centre = frame @ pole
            axes.annotate("gap", centre[:2], ha="center", va="center", color="white", weight="bold")
        axes.set(xlim=(-1.08, 1.08), ylim=(-1.08, 1.08))
        axes.set_title(f"{design.name}: caps of one plane and the gap they leave")
        axes.legend(loc="lower left", frameon=False, title="cap of")
    left = (
        f"Each gap is a polygon of {geometry.sides} arcs with corners "
        f"{np.degrees(geometry.vertex):.2f}° from the plane's pole."
        if geometry
        else "This plane leaves no closed gap polygon."
    )
    return picture(
        figure,
        "cap-and-gap",
        "Caps and gap of one plane",
        f"Seen from 28° off the plane's pole. Rims of the caps (half-arc "
        f"{np.degrees(float(caps[0])):.3f}°), broken where behind. {left}",
    )


def _circle(
    centre: NDArray[np.float64], angle: float, turn: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Points at `angle` from a unit vector, shape (turn, 3)."""
    helper = np.eye(3)[np.argmin(np.abs(centre))]
    a = np.cross(centre, helper)
    a /= np.linalg.norm(a)
    b = np.cross(centre, a)
    ring = np.cos(turn)[:, None] * a + np.sin(turn)[:, None] * b
    return np.cos(angle) * centre + np.sin(angle) * ring


def _on_disc(axes: "Axes", seen: NDArray[np.float64], colour: str, label: str) -> None:
    """Draw a curve on the sphere: solid in front, broken behind."""
    front = np.where((seen[:, 2] >= 0)[:, None], seen[:, :2], np.nan)
    back = np.where((seen[:, 2] < 0)[:, None], seen[:, :2], np.nan)
    axes.plot(*front.T, color=colour, lw=1.8, label=label, zorder=4)
    axes.plot(*back.T, color=colour, lw=0.9, ls=(0, (4, 3)), alpha=0.6, zorder=2)


def _sphere_grid(
    axes: "Axes", frame: NDArray[np.float64], pole: NDArray[np.float64], up: NDArray[np.float64]
) -> None:
    turn = np.linspace(0, 2 * np.pi, 181)
    across = np.cross(pole, up)
    lines = [_circle(pole, np.radians(c), turn) for c in range(15, 180, 15)]
    for azimuth in np.radians(np.arange(0, 180, 30)):
        side = np.cos(azimuth) * up + np.sin(azimuth) * across
        lines.append(np.cos(turn)[:, None] * pole + np.sin(turn)[:, None] * side)
    drawn = []
    for line in lines:
        seen = line @ frame.T
        drawn.append(np.where((seen[:, 2] >= 0)[:, None], seen[:, :2], np.nan))
    axes.add_collection(LineCollection(drawn, colors=FAINT, linewidths=0.4, zorder=1))
