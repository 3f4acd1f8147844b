"""Grids of Mars whose cell areas are exact, on a sphere or an ellipsoid of revolution."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.errors import ArgumentError


@dataclass(frozen=True)
class Grid:
    """Cells between parallels and equally spaced meridians.

    Attributes
    ----------
    kind
        ``equal-angle`` or ``equal-area``.
    latitude_edges
        From -pi/2 to pi/2, shape (rows + 1,), planetocentric, radians.
    columns
        Cells in a row.
    polar
        Polar radius in units of the equatorial one: 1 on a sphere.
    """

    kind: str
    latitude_edges: NDArray[np.float64]
    columns: int
    polar: float = 1.0

    @property
    def title(self) -> str:
        """Kind and number of its cells, in words."""
        return f"{self.kind}, {self.rows} by {self.columns} cells"

    @property
    def rows(self) -> int:
        """Number of latitude rows."""
        return self.latitude_edges.size - 1

    @property
    def latitude(self) -> NDArray[np.float64]:
        """Where each row is sampled, radians, shape (rows,).

        The middle of its edges in latitude (equal angle) or in area (equal area).
        """
        if self.kind == "equal-area":
            areas = area_south_of(self.latitude_edges, self.polar)
            return latitude_of_area((areas[1:] + areas[:-1]) / 2, self.polar)
        return np.asarray(
            (self.latitude_edges[1:] + self.latitude_edges[:-1]) / 2, dtype=np.float64
        )

    @property
    def places(self) -> NDArray[np.float64]:
        """How a user stands in each row, shape (rows, 5): see `compass.core.runs`."""
        latitude = self.latitude
        cos, sin, b2 = np.cos(latitude), np.sin(latitude), self.polar**2
        if b2 == 1:
            return np.stack([cos, sin, cos, sin, np.ones(self.rows)], axis=-1)
        distance = 1 / np.sqrt(cos**2 + sin**2 / b2)
        up = np.stack([cos, sin / b2], axis=-1)  # the gradient of x^2 + y^2 + z^2/b^2
        up /= np.linalg.norm(up, axis=-1, keepdims=True)
        return np.column_stack([up, distance * cos, distance * sin, distance**2])

    @property
    def longitude(self) -> NDArray[np.float64]:
        """Cell centres from -180 degrees eastwards, radians, shape (columns,)."""
        step = 2 * np.pi / self.columns
        return np.asarray(-np.pi + step * (np.arange(self.columns) + 0.5), dtype=np.float64)

    @property
    def longitude_edges(self) -> NDArray[np.float64]:
        """Cell borders, radians, shape (columns + 1,)."""
        return np.linspace(-np.pi, np.pi, self.columns + 1)

    @property
    def cell_share(self) -> NDArray[np.float64]:
        """Share of the surface in one cell of each row."""
        return np.diff(area_south_of(self.latitude_edges, self.polar)) / (2 * self.columns)


def area_south_of(latitude: ArrayLike, polar: float = 1.0) -> NDArray[np.float64]:
    """Area from the equator to a planetocentric latitude, over half of all: -1 to 1.

    On a sphere ``sin(phi)``; on an ellipsoid, with ``e^2 = 1 - b^2`` and g the latitude of the
    normal, ``q(g)/q(pi/2)``: the sine of the authalic latitude, of
    ``q = sin(g)/(1 - e^2 sin^2(g)) + artanh(e sin(g))/e``.

    References
    ----------
    Snyder 1987, Map Projections: A Working Manual, USGS Professional Paper 1395, eqs. 3-11, 3-12.
    """
    phi = np.asarray(latitude, dtype=float)
    if polar == 1:
        return np.asarray(np.sin(phi))
    e = np.sqrt(1 - polar**2)

    def q(sine: ArrayLike) -> NDArray[np.float64]:
        return np.asarray(sine / (1 - (e * sine) ** 2) + np.arctanh(e * sine) / e)

    return q(np.sin(np.arctan2(np.sin(phi), polar**2 * np.cos(phi)))) / q(1.0)


def latitude_of_area(area: ArrayLike, polar: float = 1.0) -> NDArray[np.float64]:
    """Inverse of `area_south_of`, radians."""
    wanted = np.asarray(area, dtype=float)
    if polar == 1:
        return np.asarray(np.arcsin(wanted))
    low, high = np.full(wanted.shape, -np.pi / 2), np.full(wanted.shape, np.pi / 2)
    for _ in range(60):  # the area grows with latitude
        middle = (low + high) / 2
        short = area_south_of(middle, polar) < wanted
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    return np.asarray((low + high) / 2)


def equal_angle_grid(step: float, polar: float = 1.0) -> Grid:
    """Cells of `step` by `step` radians, on a figure of this polar radius over equatorial radius.

    Raises
    ------
    ArgumentError
        180 degrees is not a whole number of steps, or the step is outside 0.05 to 90 degrees.
    """
    rows = _whole_steps(step)
    return Grid("equal-angle", np.linspace(-np.pi / 2, np.pi / 2, rows + 1), 2 * rows, polar)


def equal_area_grid(step: float, polar: float = 1.0) -> Grid:
    """Cells of one area: rows equally spaced in area from pole to pole, columns `step` wide.

    Lambert's cylindrical equal-area cells, as many as on the equal-angle grid of this step.
    Parameters and errors as `equal_angle_grid`.
    """
    rows = _whole_steps(step)
    edges = latitude_of_area(np.linspace(-1.0, 1.0, rows + 1), polar)
    edges[0], edges[-1] = -np.pi / 2, np.pi / 2
    return Grid("equal-area", edges, 2 * rows, polar)


def make_grid(kind: str, step_deg: float, polar: float = 1.0) -> Grid:
    """Return the grid of this kind (``equal-angle`` or ``equal-area``) and step in degrees.

    `polar` is the figure's polar radius in units of the equatorial one.
    """
    makers = {"equal-angle": equal_angle_grid, "equal-area": equal_area_grid}
    if kind not in makers:
        raise ArgumentError(f"grid = {kind!r}: allowed {', '.join(makers)}")
    return makers[kind](float(np.radians(step_deg)), polar)


def _whole_steps(step: float) -> int:
    degrees = float(np.degrees(step))
    if not 0.05 - 1e-12 <= degrees <= 90 + 1e-9:
        raise ArgumentError(f"step = {degrees:g} deg: allowed 0.05 to 90 degrees")
    rows = round(180 / degrees)
    if abs(rows * degrees - 180) > 1e-6:
        raise ArgumentError(
            f"step = {degrees:g} deg: 180 degrees is not a whole number of steps; "
            f"the nearest that fits is {180 / rows:.10g}"
        )
    return rows
