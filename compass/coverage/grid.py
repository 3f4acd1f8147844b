"""Grids of the sphere whose cell areas are exact."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compass.errors import ArgumentError


@dataclass(frozen=True)
class Grid:
    """Cells between parallels and equally spaced meridians.

    Attributes
    ----------
    kind
        ``equal-angle`` or ``equal-area``.
    latitude_edges
        From -pi/2 to pi/2, shape (rows + 1,), radians.
    columns
        Cells in a row.
    """

    kind: str
    latitude_edges: NDArray[np.float64]
    columns: int

    @property
    def rows(self) -> int:
        """Number of latitude rows."""
        return self.latitude_edges.size - 1

    @property
    def latitude(self) -> NDArray[np.float64]:
        """Where each row is sampled, radians, shape (rows,).

        The middle of its edges in latitude (equal angle) or in sine of latitude (equal area).
        """
        if self.kind == "equal-area":
            sines = np.sin(self.latitude_edges)
            return np.asarray(np.arcsin((sines[1:] + sines[:-1]) / 2), dtype=np.float64)
        return np.asarray(
            (self.latitude_edges[1:] + self.latitude_edges[:-1]) / 2, dtype=np.float64
        )

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
        """Share of the sphere in one cell of each row: ``(sin b2 - sin b1) / (2 columns)``."""
        return np.diff(np.sin(self.latitude_edges)) / (2 * self.columns)


def equal_angle_grid(step: float) -> Grid:
    """Cells of `step` by `step` radians.

    Raises
    ------
    ArgumentError
        180 degrees is not a whole number of steps, or the step is outside 0.05 to 90 degrees.
    """
    rows = _whole_steps(step)
    return Grid("equal-angle", np.linspace(-np.pi / 2, np.pi / 2, rows + 1), 2 * rows)


def equal_area_grid(step: float) -> Grid:
    """Cells of one area: rows equally spaced in sine of latitude, columns `step` radians wide.

    Lambert's cylindrical equal-area cells, as many as on the equal-angle grid of this step.
    Errors as `equal_angle_grid`.
    """
    rows = _whole_steps(step)
    edges = np.arcsin(np.linspace(-1.0, 1.0, rows + 1))
    return Grid("equal-area", edges, 2 * rows)


def make_grid(kind: str, step_deg: float) -> Grid:
    """Return the grid of this kind (``equal-angle`` or ``equal-area``) and step in degrees."""
    makers = {"equal-angle": equal_angle_grid, "equal-area": equal_area_grid}
    if kind not in makers:
        raise ArgumentError(f"grid = {kind!r}: allowed {', '.join(makers)}")
    return makers[kind](float(np.radians(step_deg)))


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
