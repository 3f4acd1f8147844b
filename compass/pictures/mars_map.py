"""Equal-area maps of Mars: frame, graticule, named places, fields, lines and shapes."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, QuadMesh
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from numpy.typing import ArrayLike, NDArray
from pyproj import Transformer

from compass.frames import map_crs, mars_crs
from compass.pictures.places import PLACES
from compass.pictures.reading import Field
from compass.pictures.relief import finer_shade
from compass.pictures.style import FAINT, INK, PlainFigure, degree_words

if TYPE_CHECKING:
    from shapely import MultiPolygon

_OFFSETS = {
    "InSight": (4, 4),
    "Curiosity": (4, -9),
    "Viking 2": (-4, 3),
    "Utopia Planitia": (-4, -7),
    "Syrtis Major": (-4, -9),
    "Perseverance": (4, 4),
    "Pathfinder": (4, -9),
    "Viking 1": (-4, 4),
    "Spirit": (-4, -9),
}


class MarsMap:
    """A Mollweide (equal-area) map of the whole planet drawn into matplotlib axes.

    Parameters
    ----------
    axes
        Where to draw.
    figure_name
        Reference figure, see `compass.frames.FIGURES`.
    """

    def __init__(self, axes: Axes, figure_name: str = "iau-sphere") -> None:
        sphere = "iau-sphere" if figure_name == "iau-ellipsoid" else figure_name
        self.axes = axes
        self.mesh: QuadMesh | None = None
        self.transformer = Transformer.from_crs(mars_crs(sphere), map_crs(sphere), always_xy=True)
        axes.set_aspect("equal")
        axes.set_axis_off()
        edge = np.linspace(-90, 90, 181)
        self._rim = np.column_stack(
            self.project(
                np.concatenate([np.full(181, 180.0), np.full(181, -180.0)]),
                np.concatenate([edge, edge[::-1]]),
            )
        )
        axes.set_xlim(self._rim[:, 0].min() * 1.01, self._rim[:, 0].max() * 1.01)
        axes.set_ylim(self._rim[:, 1].min() * 1.05, self._rim[:, 1].max() * 1.05)

    def project(
        self, longitude_deg: ArrayLike, latitude_deg: ArrayLike
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Map coordinates in metres."""
        x, y = self.transformer.transform(np.asarray(longitude_deg), np.asarray(latitude_deg))
        return np.asarray(x), np.asarray(y)

    def graticule(self, step_deg: int = 30) -> None:
        """Meridians and parallels every `step_deg` degrees, labelled, and the rim of the map."""
        lines = []
        along_meridian, along_parallel = np.linspace(-90, 90, 91), np.linspace(-180, 180, 181)
        for lon in range(-180 + step_deg, 180, step_deg):
            meridian = self.project(np.full(91, float(lon)), along_meridian)
            lines.append(np.column_stack(meridian))
        for lat in range(-90 + step_deg, 90, step_deg):
            parallel = self.project(along_parallel, np.full(181, float(lat)))
            lines.append(np.column_stack(parallel))
            x, y = self.project(-180.0, float(lat))
            label = self.axes.annotate(
                degree_words("latitude", lat), (float(x), float(y)), (-3, 0),
                textcoords="offset points", ha="right", va="center", fontsize=8, color=INK,
            )  # fmt: skip
            _halo(label)
        for lon in range(-180 + 2 * step_deg, 180, 2 * step_deg):
            x, y = self.project(float(lon), 0.0)
            label = self.axes.annotate(
                degree_words("longitude", lon), (float(x), float(y)), (2, 2),
                textcoords="offset points", fontsize=7.8, color=INK, zorder=4,
            )  # fmt: skip
            _halo(label)
        self.axes.add_collection(
            LineCollection(lines, colors="white", linewidths=0.5, alpha=0.55, zorder=3)
        )
        self.axes.add_collection(
            LineCollection(lines, colors=INK, linewidths=0.25, alpha=0.45, zorder=3)
        )
        self.axes.add_patch(
            PathPatch(
                Path(self._rim, closed=True), facecolor="none", edgecolor=INK, lw=0.8, zorder=5
            )
        )

    def relief(self) -> None:
        """Shade what is drawn by the relief, quietly: colours keep their meaning."""
        shade = finer_shade(2)
        lon, lat = np.meshgrid(np.linspace(0, 360, 361), np.linspace(90, -90, 181))
        turn = shade.shape[1] // 2  # the map begins at 180 degrees west
        light = np.concatenate([shade[:, turn:], shade[:, :turn]], axis=1)
        x, y = self.project(lon - 180.0, lat)
        dark = light < 0.7
        ink = np.zeros((*light.shape, 4))
        ink[..., :3] = np.where(dark, 0.0, 1.0)[..., np.newaxis]
        ink[..., 3] = np.where(dark, 0.55 * (0.7 - light), 0.6 * (light - 0.7))
        self.axes.pcolormesh(x, y, ink, rasterized=True, zorder=1.5)

    def places(self) -> None:
        """Mark the named places: triangles where something has landed, dots elsewhere."""
        figure = self.axes.figure
        for place in PLACES:
            x, y = self.project(place.longitude_deg, place.latitude_deg)
            self.axes.plot(
                x, y, "^" if place.landing else "o", ms=3.2, mfc="white", mec=INK, mew=0.7, zorder=6
            )
            dx, dy = _OFFSETS.get(place.name, (4, -3))
            text = self.axes.annotate(
                place.name, (float(x), float(y)), (dx, dy), textcoords="offset points",
                ha="right" if dx < 0 else "left", fontsize=7.5, color=INK, zorder=7,
            )  # fmt: skip
            _halo(text)
            if isinstance(figure, PlainFigure):
                figure.names.append(text)

    def field(
        self,
        longitude_edges_deg: ArrayLike,
        latitude_edges_deg: ArrayLike,
        values: NDArray[Any],
        label: str = "",
        **options: Any,
    ) -> QuadMesh:
        """Draw values given by cell, shape (row, column), each cell in its true outline.

        `label` says what they are to who points at one, where a colour bar does not.
        """
        lon, lat = np.meshgrid(longitude_edges_deg, latitude_edges_deg)
        x, y = self.project(lon, lat)
        self.mesh = mesh = self.axes.pcolormesh(x, y, values, rasterized=True, zorder=1, **options)
        figure = self.axes.figure
        if isinstance(figure, PlainFigure):
            edges = longitude_edges_deg, latitude_edges_deg
            figure.fields.append(Field(mesh, *edges, values, self._rim, label))
        return mesh

    def track(self, longitude_deg: ArrayLike, latitude_deg: ArrayLike, **options: Any) -> None:
        """Draw a line, cut where it crosses the map's edge."""
        lon, lat = np.asarray(longitude_deg, float), np.asarray(latitude_deg, float)
        cuts = np.flatnonzero(np.abs(np.diff(lon)) > 180) + 1
        pieces = zip(np.split(lon, cuts), np.split(lat, cuts), strict=True)
        lines = [np.column_stack(self.project(a, b)) for a, b in pieces if a.size > 1]
        self.axes.add_collection(LineCollection(lines, zorder=2, **options))

    def names(
        self, words: Sequence[str], longitude_deg: ArrayLike, latitude_deg: ArrayLike
    ) -> None:
        """Write a name beside each point."""
        for word, x, y in zip(words, *self.project(longitude_deg, latitude_deg), strict=True):
            text = self.axes.annotate(
                word, (float(x), float(y)), (5, 4), textcoords="offset points", fontsize=8,
                color=INK, zorder=8,
            )  # fmt: skip
            _halo(text)

    def points(self, longitude_deg: ArrayLike, latitude_deg: ArrayLike, **options: Any) -> None:
        """Mark points."""
        x, y = self.project(longitude_deg, latitude_deg)
        self.axes.plot(x, y, linestyle="none", zorder=6, **options)

    def shapes(self, shapes: Iterable["MultiPolygon"], **options: Any) -> None:
        """Draw longitude-latitude shapes (degrees) with their sides followed on the sphere."""
        from shapely import segmentize

        for shape in shapes:
            for polygon in shape.geoms:
                lon, lat = np.array(segmentize(polygon, 1.0).exterior.coords).T
                outline = np.column_stack(self.project(lon, lat))
                self.axes.add_patch(PathPatch(Path(outline, closed=True), zorder=2, **options))


def _halo(text: Any) -> None:
    from matplotlib.patheffects import withStroke

    text.set_path_effects([withStroke(linewidth=1.6, foreground="white", alpha=0.85)])


def colour_bar(axes: Axes | Sequence[Axes], mesh: Any, label: str, **options: Any) -> Any:
    """Draw a labelled colour bar under a map or several."""
    bar = mesh.get_figure().colorbar(
        mesh, ax=axes, orientation="horizontal", shrink=0.62, aspect=38, pad=0.03, **options
    )
    bar.set_label(label)
    bar.outline.set_edgecolor(FAINT)
    return bar
