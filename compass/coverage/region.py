"""Parts of the sphere: bands of latitude, polygons with great-circle edges, and unions of them."""

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.coverage.polygon import convex_parts
from compass.errors import ArgumentError
from compass.frames import direction, latitude_longitude
from compass.words import latitude_words

if TYPE_CHECKING:
    from compass.core.fold import Sides

_FORMS = (
    "write globe, lat:MIN:MAX, or polygon:LAT,LON;LAT,LON;... of three or more corners, in degrees"
)


@dataclass(frozen=True)
class Region:
    """The points p with ``normals[k] . p >= floors[k]`` for every k; all of the sphere without k.

    Attributes
    ----------
    name
        What to call it.
    normals, floors
        Unit vectors, shape (m, 3), and cosines, shape (m,).
    mars_fixed
        Whether it turns with Mars and so is not the same in the inertial frame.
    """

    name: str
    normals: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 3)))
    floors: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    mars_fixed: bool = False

    @property
    def sides(self) -> "Sides":
        """Its sides as kernels take them: arrays of one type to the compiler, not read-only."""
        from compass.core.fold import Sides  # files are read without the compiler

        return Sides(np.array(self.normals), np.array(self.floors))

    @property
    def is_globe(self) -> bool:
        """Whether it is the whole sphere."""
        return self.floors.size == 0

    @property
    def is_mirrored(self) -> bool:
        """Whether the southern half mirrors the northern one, for any rotation about the pole."""
        if self.mars_fixed:
            return False
        north = {(round(n[2]), f) for n, f in zip(self.normals, self.floors, strict=True)}
        return north == {(-sign, f) for sign, f in north}

    def stretched(self, stretch: float) -> "Region":
        """Return the region on the sphere that an ellipsoid becomes, stretched along its pole.

        A plane through the centre stays one, and a circle of latitude stays one at its reduced
        latitude, ``tan beta = stretch tan phi``.
        """
        if stretch == 1.0 or self.is_globe:
            return self
        normals, floors = np.array(self.normals), np.array(self.floors)
        level = np.abs(normals[:, 2]) == 1.0
        normals[~level, 2] /= stretch
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        rise = floors * stretch
        along = np.hypot(rise, np.sqrt(1.0 - floors**2))
        return replace(self, normals=normals, floors=np.where(level, rise / along, floors))

    def latitudes(self) -> tuple[float, float]:
        """Least and greatest latitude of any point, radians.

        The extremes lie at a corner, where a great-circle edge comes nearest to a pole, or at one.
        """
        if not self.mars_fixed:
            south, north = -np.pi / 2, np.pi / 2
            for normal, floor in zip(self.normals, self.floors, strict=True):
                if normal[2] > 0:
                    south = float(np.arcsin(floor))
                else:
                    north = float(-np.arcsin(floor))
            return south, north
        n, pole = self.normals, np.array([0.0, 0.0, 1.0])
        corners = np.cross(n, np.roll(n, -1, axis=0))
        turns = pole - n * n[:, 2:]
        candidates = np.concatenate([corners, turns, [pole]])
        candidates = np.concatenate([candidates, -candidates])
        length = np.linalg.norm(candidates, axis=1)
        candidates = candidates[length > 1e-12] / length[length > 1e-12, np.newaxis]
        inside = np.all(candidates @ n.T >= self.floors - 1e-12, axis=1)
        latitude, _ = latitude_longitude(candidates[inside])
        return float(latitude.min()), float(latitude.max())

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether unit vectors (..., 3) lie inside or on the rim."""
        return np.asarray(np.all(np.asarray(points) @ self.normals.T >= self.floors, axis=-1))


GLOBE = Region("whole sphere")


def latitude_band(south: float, north: float) -> Region:
    """Region between two latitudes, radians.

    Raises
    ------
    ArgumentError
        The latitudes are not in order or not in [-pi/2, pi/2].
    """
    if not -np.pi / 2 <= south < north <= np.pi / 2:
        raise ArgumentError(
            f"region = lat:{np.degrees(south):g}:{np.degrees(north):g}: latitudes must lie "
            "between -90 and 90 degrees, the southern one first"
        )
    rims = []
    if south > -np.pi / 2:
        rims.append((1.0, np.sin(south)))
    if north < np.pi / 2:
        rims.append((-1.0, -np.sin(north)))
    return Region(
        f"{latitude_words(float(np.degrees(south)), 'g')} to "
        f"{latitude_words(float(np.degrees(north)), 'g')}",
        np.array([[0.0, 0.0, sign] for sign, _ in rims]).reshape(-1, 3),
        np.array([floor for _, floor in rims]),
    )


def convex_polygon(latitudes: ArrayLike, longitudes: ArrayLike) -> Region:
    """Region inside great-circle arcs between corners (radians, in either sense of rotation).

    Raises
    ------
    ArgumentError
        Fewer than three corners, corners at one place or opposite ones, or not convex.
    """
    corners = direction(latitudes, longitudes)
    if len(corners) < 3:
        raise ArgumentError(f"region = polygon of {len(corners)} corners: needs three or more")
    following = np.roll(corners, -1, axis=0)
    normals = np.cross(corners, following)
    norms = np.linalg.norm(normals, axis=1, keepdims=True)
    if np.any(norms < 1e-9):
        raise ArgumentError(
            "region = polygon: two corners in a row are the same or opposite places"
        )
    normals /= norms
    sides = corners @ normals.T
    for k in range(len(corners)):
        sides[k, k] = sides[(k + 1) % len(corners), k] = 0.0
    turns = (np.cross(normals, np.roll(normals, -1, axis=0)) * following).sum(axis=1)
    if np.all(sides <= 1e-12):  # corners run clockwise
        normals, sides, turns = -normals, -sides, -turns
    if np.any(sides < -1e-12) or np.any(turns < 1e-12):
        raise ArgumentError(
            "region = polygon: not convex, or corners on one great circle; split it into convex "
            "polygons and ask for each"
        )
    return Region("polygon", normals, np.zeros(len(normals)), mars_fixed=True)


def polygon(latitudes: ArrayLike, longitudes: ArrayLike) -> tuple[Region, ...]:
    """Regions that together make a polygon of any shape (corners in radians, either sense).

    Raises
    ------
    ArgumentError
        As `compass.coverage.polygon.convex_parts`.
    """
    parts = convex_parts(latitudes, longitudes)
    return tuple(convex_polygon(*latitude_longitude(corners)) for corners in parts)


def read_region(text: str) -> Region:
    """Region in one convex part from its text; see `read_regions`.

    Raises
    ------
    ArgumentError
        As `read_regions`, or a polygon that is not convex.
    """
    parts = read_regions(text)
    if len(parts) > 1:
        raise ArgumentError(
            f"region = {text}: not convex; split it into convex polygons and ask for each, or put "
            "it in a [[requirement]]"
        )
    return parts[0]


def read_regions(text: str) -> tuple[Region, ...]:
    """Convex parts of a region from its text, degrees.

    ``globe``, ``lat:MIN:MAX`` or ``polygon:LAT,LON;LAT,LON;...`` of any shape, across the
    antimeridian or around a pole too.

    Raises
    ------
    ArgumentError
        Anything else, or a polygon whose sides cross.
    """
    kind, _, rest = text.partition(":")
    try:
        if text == "globe":
            return (GLOBE,)
        if kind == "lat":
            south, north = (float(part) for part in rest.split(":"))
            return (latitude_band(np.radians(south), np.radians(north)),)
        if kind == "polygon":
            corners = [[float(x) for x in pair.split(",")] for pair in rest.split(";")]
            latitudes, longitudes = np.array(corners).reshape(len(corners), 2).T
            if not (np.all(np.abs(latitudes) <= 90) and np.all(np.isfinite(longitudes))):
                raise ArgumentError(f"region = {text}: latitudes must lie between -90 and 90")
            return polygon(np.radians(latitudes), np.radians(longitudes))
    except ArgumentError:
        raise
    except ValueError as error:
        raise ArgumentError(f"region = {text}: cannot be read; {_FORMS}") from error
    raise ArgumentError(f"region = {text}: unknown kind; {_FORMS}")
