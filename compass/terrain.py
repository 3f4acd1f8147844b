"""The horizon that terrain draws around a place."""

from dataclasses import dataclass, replace
from math import degrees

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.errors import ArgumentError, whole_number
from compass.frames import Figure, direction, planetographic_latitude
from compass.sites import Mask, Site
from compass.words import latitude_words, longitude_words, place_words

#: Nodes of a grid that are turned into the place's frame at once: 24 bytes each.
PATCH = 2_000_000


@dataclass(frozen=True)
class Terrain:
    """Heights at the nodes of a grid, joined by plane triangles.

    Attributes
    ----------
    latitude, longitude
        Planetocentric and east, radians, shape (rows, columns).
    height
        Above the reference figure along its normal, metres, shape (rows, columns); nan where
        unknown.
    figure
        The figure.
    label
        The file's name.
    closed
        Whether the last column neighbours the first, all around Mars.
    """

    latitude: NDArray[np.float64]
    longitude: NDArray[np.float64]
    height: NDArray[np.float64]
    figure: Figure
    label: str = "terrain"
    closed: bool = False

    def r_mcmf(self, rows: slice) -> NDArray[np.float64]:
        """Mars-fixed positions of some rows of nodes, metres, shape (rows, columns, 3)."""
        latitude, longitude, height = (
            np.concatenate([grid[rows], grid[rows, :1]], axis=1) if self.closed else grid[rows]
            for grid in (self.latitude, self.longitude, self.height)
        )
        return surface_points(latitude, longitude, height, self.figure)


@dataclass(frozen=True)
class Horizon:
    """What terrain hides around a place, by azimuth.

    Attributes
    ----------
    azimuth
        Radians clockwise from north, even steps from 0, shape (n,).
    elevation
        Of the horizon exactly at each azimuth, radians, shape (n,).
    within
        Highest elevation from each azimuth to the next, radians, shape (n,).
    """

    azimuth: NDArray[np.float64]
    elevation: NDArray[np.float64]
    within: NDArray[np.float64]

    @property
    def envelope(self) -> NDArray[np.float64]:
        """Elevations at the azimuths that, joined by lines, nowhere pass below the terrain."""
        return np.maximum(self.within, np.roll(self.within, 1))

    def mask(self, safe: bool = False) -> Mask:
        """Mask along the horizon, or along its envelope; below the horizontal it is 0."""
        elevation = np.maximum(self.envelope if safe else self.elevation, 0.0)
        return Mask(tuple(self.azimuth.tolist()), tuple(elevation.tolist()))


def surface_points(
    latitude: ArrayLike, longitude: ArrayLike, height: ArrayLike, figure: Figure
) -> NDArray[np.float64]:
    """Mars-fixed positions, metres, shape (..., 3), at heights along the figure's normal.

    Parameters
    ----------
    latitude, longitude, height
        Planetocentric latitude of the point of the figure below and east longitude, radians;
        metres.
    """
    lat = np.asarray(latitude, dtype=float)
    a, b = figure.equatorial_radius, figure.polar_radius
    radius = a * b / np.hypot(b * np.cos(lat), a * np.sin(lat))
    up = direction(planetographic_latitude(lat, figure), longitude)
    return radius[..., np.newaxis] * direction(lat, longitude) + np.asarray(height)[..., None] * up


def on_ground(site: Site, terrain: Terrain, above: float = 0.0) -> Site:
    """Return the site standing `above` metres over the terrain.

    Raises
    ------
    ArgumentError
        The grid does not hold the site, or its heights there are unknown.
    """
    return replace(site, height=ground(site, terrain) + above)


def ground(site: Site, terrain: Terrain) -> float:
    """Height of the terrain under a site, metres over the figure.

    The triangle of the grid that the site's normal meets is found by its corners' directions.
    """
    up = site.enu_mcmf[2]
    foot = site.r_mcmf - site.height * up
    rows, columns = terrain.height.shape
    for first in range(0, rows - 1, patch_rows(columns)):
        r = terrain.r_mcmf(slice(first, first + patch_rows(columns) + 1)) - foot
        east_north = r @ site.enu_mcmf[:2].T
        near = (r @ up) > -foot @ up  # the same side of Mars
        heights = _height_at_origin(east_north, r @ up, near)
        if heights is not None:
            return heights
    south, north, west, east = (
        np.degrees(end(grid))
        for grid in (terrain.latitude, terrain.longitude)
        for end in (np.nanmin, np.nanmax)
    )
    raise ArgumentError(
        f"{terrain.label}: holds no heights around {site.name}, "
        f"{place_words(degrees(site.latitude), degrees(site.longitude), 'g')}, but some "
        f"between {latitude_words(south)} and {latitude_words(north)}, "
        f"{longitude_words(west)} and {longitude_words(east)}; "
        "give a grid that does"
    )


def _height_at_origin(
    p: NDArray[np.float64], up: NDArray[np.float64], near: NDArray[np.bool_]
) -> float | None:
    """Height where the triangles (corners p east and north, shape (r, c, 2)) hold the origin."""
    for second in ((0, 1), (1, 0)):
        corners = [_corner(p, 0, 0), _corner(p, *second), _corner(p, 1, 1)]
        heights = [_corner(up, 0, 0), _corner(up, *second), _corner(up, 1, 1)]
        # twice the areas of the origin with each side, signed
        a, b, c = (_across(corners[k], corners[(k + 1) % 3]) for k in (1, 2, 0))
        total = a + b + c
        with np.errstate(invalid="ignore", divide="ignore"):
            inside = (a * total >= 0) & (b * total >= 0) & (c * total >= 0) & (total != 0)
            height = (a * heights[0] + b * heights[1] + c * heights[2]) / total
        where = np.nonzero(inside & _corner(near, 0, 0) & np.isfinite(height))
        if where[0].size:
            return float(height[where][0])
    return None


def _across(p: NDArray[np.float64], q: NDArray[np.float64]) -> NDArray[np.float64]:
    """``p x q`` of vectors in a plane, shape (..., 2)."""
    return p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]


def _corner(grid: NDArray, row: int, column: int) -> NDArray:
    """The grid of one corner of every cell."""
    rows, columns = grid.shape[:2]
    return grid[row : rows - 1 + row, column : columns - 1 + column]


def patch_rows(columns: int) -> int:
    """Rows of a grid that make a patch."""
    return max(1, PATCH // max(columns, 1))


def horizon(site: Site, terrain: Terrain, azimuths: int = 360) -> Horizon:
    """Horizon of a site over terrain: straight lines of sight over the curved figure.

    The air is too thin to bend them. Every edge of the triangulated grid counts
    (`compass.core.terrain`), so nothing between rays is missed.

    Parameters
    ----------
    site
        The eye, at its height over the figure; see `on_ground`.
    terrain
        On the site's figure.
    azimuths
        Number of azimuths, evenly from north.

    Raises
    ------
    ArgumentError
        Different figures, a site below or off the terrain, fewer than 4 azimuths.
    """
    from compass.core.terrain import raise_horizon

    whole_number("azimuths", azimuths, 4)
    if terrain.figure != site.figure:
        raise ArgumentError(
            f"{terrain.label}: heights over {terrain.figure.name}, but {site.name} stands on "
            f"{site.figure.name}; use one figure for both"
        )
    depth = ground(site, terrain) - site.height
    if depth > 1e-6 * (1.0 + abs(site.height)):
        raise ArgumentError(
            f"{site.name}: height {site.height:g} m is {depth:g} m below the terrain of "
            f"{terrain.label}; stand it on the ground"
        )
    exact, within = np.full(azimuths, -np.inf), np.full(azimuths, -np.inf)
    rows, columns = terrain.height.shape
    step = patch_rows(columns)
    for first in range(0, rows - 1, step):
        r = (terrain.r_mcmf(slice(first, first + step + 1)) - site.r_mcmf) @ site.enu_mcmf.T
        east, north, up = (np.ascontiguousarray(r[..., k]) for k in range(3))
        raise_horizon(east, north, up, exact, within)
    azimuth = np.arange(azimuths, dtype=np.float64) * (2.0 * np.pi / azimuths)
    return Horizon(azimuth, np.arctan(exact), np.arctan(within))
