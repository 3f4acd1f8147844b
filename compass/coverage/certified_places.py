"""Where a certified figure is taken: regions, circles of latitude, spots and tiles."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compass.coverage.region import Region, latitude_band
from compass.errors import ArgumentError
from compass.frames import Figure, planetographic_latitude


@dataclass(frozen=True)
class Circle:
    """All places of a latitude (planetocentric, radians)."""

    latitude: float


@dataclass(frozen=True)
class Spot:
    """One place that turns with Mars: planetocentric latitude and east longitude, radians."""

    latitude: float
    longitude: float


@dataclass(frozen=True)
class Tile:
    """Between two latitudes and from a western to an eastern longitude, turning with Mars."""

    south: float
    north: float
    west: float
    east: float


Place = Region | Circle | Spot | Tile


def _check_tile(tile: Tile) -> None:
    if not (tile.south < tile.north and tile.west < tile.east <= tile.west + 2 * np.pi):
        raise ArgumentError(
            "tile: give south below north, and west below east by at most 360 degrees"
        )


def for_ever(place: Place) -> Place:
    """What stands for a place when tracks do not close: it meets every longitude alike.

    Of a polygon its latitudes, which in shares weigh by its width in longitude.
    """
    if isinstance(place, Spot):
        return Circle(place.latitude)
    if isinstance(place, Tile):
        _check_tile(place)
        return latitude_band(place.south, place.north)
    if isinstance(place, Region) and place.mars_fixed:
        return latitude_band(*place.latitudes())
    return place


def sides_of(
    place: Place, figure: Figure
) -> tuple[float, float, float, float, NDArray[np.float64]]:
    """Geodetic latitudes, longitudes and great-circle edges of a place."""

    def geodetic(latitude: float) -> float:
        if not -np.pi / 2 <= latitude <= np.pi / 2:
            raise ArgumentError(
                f"latitude_deg = {np.degrees(latitude):g}: allowed -90 to 90 degrees"
            )
        return float(planetographic_latitude(latitude, figure))

    none, turn = np.empty((0, 3)), 2 * np.pi
    if isinstance(place, Circle):
        b = geodetic(place.latitude)
        return b, b, 0.0, turn, none
    if isinstance(place, Spot):
        b = geodetic(place.latitude)
        return b, b, place.longitude, place.longitude, none
    if isinstance(place, Tile):
        _check_tile(place)
        return geodetic(place.south), geodetic(place.north), place.west, place.east, none
    if place.mars_fixed:
        if np.any(place.floors != 0.0):
            raise ArgumentError(f"region = {place.name}: edges must be great circles")
        return -np.pi / 2, np.pi / 2, 0.0, turn, np.ascontiguousarray(place.normals)
    south, north = place.latitudes()
    return geodetic(south), geodetic(north), 0.0, turn, none
