"""The gaps that the satellites of one plane leave around its poles.

Evenly spaced satellites of a plane whose caps meet leave two gaps, one around each pole of
the plane: polygons of as many sides as there are satellites, each side an arc of a cap's rim.
Three satellites leave triangles.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from compass.coverage.cap import cap_radius
from compass.errors import ArgumentError
from compass.frames import latitude_longitude
from compass.orbits import Constellation

if TYPE_CHECKING:
    from shapely import MultiPolygon


@dataclass(frozen=True)
class Gap:
    """Geometry of the gap around one pole of a plane; two a plane.

    Angles in radians, lengths in metres, areas in square metres.

    Attributes
    ----------
    sides
        Satellites in the plane, and so sides of the gap.
    depth
        From the plane's pole to the middle of a side, ``R (pi/2 - lambda)``.
    base
        Side of the flat polygon with this inradius, ``2 tan(pi/s) depth``.
    flat_area
        Area of that flat polygon, ``s tan(pi/s) depth^2``.
    area
        Exact area on the sphere.
    vertex
        Colatitude of the corners from the plane's pole: ``sin c = cos(lambda) / cos(pi/s)``.
    half_arc
        lambda of the caps.
    sphere_radius
        R.
    """

    sides: int
    depth: float
    base: float
    flat_area: float
    area: float
    vertex: float
    half_arc: float
    sphere_radius: float

    @property
    def fraction(self) -> float:
        """Share of the sphere in one gap."""
        return self.area / (4 * np.pi * self.sphere_radius**2)


def plane_closes(half_arc: float, per_plane: int) -> bool:
    """Whether the caps of a plane's evenly spaced satellites meet: ``lambda >= pi / s``."""
    return half_arc >= np.pi / per_plane


def gap(orbit_radius: float, sphere_radius: float, per_plane: int, mask: float = 0.0) -> Gap | None:
    """Gap polygon of a plane of evenly spaced satellites, or None where there is none.

    There are no polygons if the caps do not meet (the plane leaves one region uncovered that
    runs between the caps from pole to pole), which `plane_closes` tells.

    The exact area is by Gauss and Bonnet: each side is an arc of a small circle of geodesic
    curvature ``-cot(lambda)/R`` seen from inside the gap, so with interior angle ``beta`` at
    a corner and rim arc ``2 delta`` a side

    ``area / R^2 = 2 pi - s (pi - beta) + 2 s delta cos(lambda)``.

    Parameters
    ----------
    orbit_radius, sphere_radius
        Metres.
    per_plane
        Satellites in the plane, s.
    mask
        Elevation mask, radians.

    References
    ----------
    Kelly and Bevilacqua 2018, eqs. 6 and 7 (depth and base, for s = 3).
    """
    lam = float(cap_radius(orbit_radius, sphere_radius, mask))
    s = per_plane
    if s < 3 or not plane_closes(lam, s):
        return None
    half = np.pi / s
    vertex = float(np.arcsin(min(1.0, np.cos(lam) / np.cos(half))))
    # Spherical triangle plane pole - satellite - corner, with sides pi/2, lambda and vertex:
    # delta is its angle at the satellite, eta its angle at the corner.
    delta = float(np.arccos(min(1.0, np.cos(vertex) / np.sin(lam))))
    eta = float(np.arccos(max(-1.0, -1.0 / (np.tan(lam) * np.tan(vertex)))))
    # A side leaves the corner at a right angle to the direction of its satellite.
    beta = 2.0 * (eta - np.pi / 2)
    excess = 2 * np.pi - s * (np.pi - beta) + 2 * s * delta * np.cos(lam)
    depth = sphere_radius * (np.pi / 2 - lam)
    return Gap(
        sides=s,
        depth=depth,
        base=float(2 * np.tan(half) * depth),
        flat_area=float(s * np.tan(half) * depth**2),
        area=float(excess) * sphere_radius**2,
        vertex=vertex,
        half_arc=lam,
        sphere_radius=sphere_radius,
    )


def published_gap_circumference(geometry: Gap, inclination: float) -> float:
    """Length of the parallel of the gaps as Kelly and Bevilacqua 2018 print it (eq. 9), metres.

    ``2 pi (R i - l)`` takes an arc for the radius of a parallel; see `gap_circumference`.
    """
    return 2 * np.pi * (geometry.sphere_radius * inclination - geometry.depth)


def gap_circumference(geometry: Gap, inclination: float) -> float:
    """Length of the parallel at the colatitude ``i - l/R`` of the gaps' inner sides, metres.

    ``2 pi R sin(i - l/R)``; nan where the gaps reach over the planet's poles (i <= l/R).
    """
    radius = geometry.sphere_radius
    colatitude = inclination - geometry.depth / radius
    if not 0 < colatitude < np.pi:
        return float("nan")
    return float(2 * np.pi * radius * np.sin(colatitude))


def gap_outline(
    satellite: NDArray[np.float64], pole: NDArray[np.float64], geometry: Gap, points: int = 60
) -> NDArray[np.float64]:
    """Unit vectors around a gap, shape (sides * points, 3), counter-clockwise about `pole`.

    At azimuth a from a satellite, the rim is at colatitude c(a) from the plane's pole with
    ``sin c cos a = cos(lambda)``, ``|a| <= pi/s``.

    Parameters
    ----------
    satellite, pole
        Unit vectors: one satellite of the plane, and the pole that the gap surrounds.
    geometry
        From `gap`.
    points
        Points a side.
    """
    half = np.pi / geometry.sides
    local = np.linspace(-half, half, points, endpoint=False)
    colatitude = np.arcsin(np.cos(geometry.half_arc) / np.cos(local))
    azimuth = (local + 2 * half * np.arange(geometry.sides)[:, np.newaxis]).ravel()
    c = np.tile(colatitude, geometry.sides)[:, np.newaxis]
    across = np.cross(pole, satellite)
    ring = np.cos(azimuth)[:, np.newaxis] * satellite + np.sin(azimuth)[:, np.newaxis] * across
    return np.cos(c) * pole + np.sin(c) * ring


def spherical_polygon(outline: NDArray[np.float64]) -> "MultiPolygon":
    """Make a longitude-latitude shape (degrees, within [-180, 180]) of an outline on the sphere.

    The interior is to the left of the outline. A shape across the antimeridian is cut there; one
    around a pole is closed along it.

    Parameters
    ----------
    outline
        Unit vectors, shape (n, 3), not repeating the first.
    """
    from shapely import MultiPolygon, Polygon, box
    from shapely.affinity import translate
    from shapely.ops import unary_union

    latitude, longitude = latitude_longitude(outline)
    lat = np.degrees(np.append(latitude, latitude[0]))
    lon = np.degrees(np.unwrap(np.append(longitude, longitude[0])))
    turns = round((lon[-1] - lon[0]) / 360.0)
    world = box(-180, -90, 180, 90)
    if turns:  # around a pole: +1 eastwards is the north pole, to the left
        pole = 90.0 * turns
        # three times around, so that no seam but the world's edge is left
        lon = np.concatenate([lon - 360.0 * turns, lon[1:], lon[1:] + 360.0 * turns])
        lat = np.concatenate([lat, lat[1:], lat[1:]])
        lon = np.concatenate([lon, [lon[-1], lon[0]]])
        lat = np.concatenate([lat, [pole, pole]])
    shape = Polygon(np.column_stack([lon, lat])).buffer(0)
    copies = [0] if turns else range(-2, 3)
    parts = [translate(shape, xoff=360.0 * k).intersection(world) for k in copies]
    whole = unary_union([part for part in parts if part.area > 0])
    return whole if isinstance(whole, MultiPolygon) else MultiPolygon([whole])


def gap_polygons(
    constellation: Constellation,
    r_mcmf: NDArray[np.float64],
    sphere_radius: float,
    mask: float = 0.0,
) -> list["MultiPolygon"]:
    """Gaps of every plane of a symmetric pattern at one instant, two a plane, in degrees.

    Parameters
    ----------
    constellation
        A pattern (`Constellation.pattern` is not None).
    r_mcmf
        Mars-fixed positions of its satellites at the instant, shape (n, 3), metres.
    sphere_radius
        Metres.
    mask
        Elevation mask, radians.

    Raises
    ------
    ArgumentError
        The constellation has no planes to speak of: explicit elements.
    """
    pattern = constellation.pattern
    if pattern is None:
        raise ArgumentError("gaps: explicit elements form no evenly spaced planes; use a pattern")
    geometry = gap(float(constellation.semi_major_axis[0]), sphere_radius, pattern.per_plane, mask)
    if geometry is None:
        return []
    u = r_mcmf / np.linalg.norm(r_mcmf, axis=1, keepdims=True)
    shapes = []
    for plane in range(pattern.planes):
        first, second = u[plane * pattern.per_plane], u[plane * pattern.per_plane + 1]
        pole = np.cross(first, second)
        pole /= np.linalg.norm(pole)
        shapes += [spherical_polygon(gap_outline(first, p, geometry)) for p in (pole, -pole)]
    return shapes
