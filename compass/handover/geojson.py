"""GeoJSON on Mars: satellites, footprints and gaps at a moment, and ground tracks."""

import json
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from compass.coverage.cap import cap
from compass.coverage.gap import gap, gap_polygons, spherical_polygon
from compass.design import Design
from compass.frames import latitude_longitude
from compass.handover.instants import iso, tdb
from compass.orbits import positions_mcmf
from compass.orbits.motion import AnyMotion

if TYPE_CHECKING:
    from shapely import MultiPolygon

#: Corners of a footprint.
CORNERS = 360

#: Decimals of a degree: 0.06 mm on the ground.
DECIMALS = 9

#: A satellite that moves by less, degrees, stands still: 60 m. Its track would be a point.
STILL = 1e-3

CRS_NAME = "urn:ogc:def:crs:IAU:2015:49900"

_NOTE = (
    "Longitude east and planetocentric latitude in degrees on a sphere of Mars, not WGS 84, which "
    "RFC 7946 knows alone: the member crs of GeoJSON 2008 says so. Winding and the cut at the "
    "antimeridian are as in RFC 7946. Footprints and gaps are for the lowest elevation mask."
)


def geojson(design: Design, times: NDArray[np.float64], motion: AnyMotion = "two-body") -> str:
    """Feature collection in the CRS of the Mars sphere, IAU_2015:49900.

    Sub-satellite points, caps and gaps (of a pattern whose planes have them) at the first of
    `times`; tracks through all of them, none of a satellite that stands still over Mars.

    Parameters
    ----------
    design
        What to export.
    times
        Seconds after the epoch, increasing, shape (t,).
    motion
        As in `orbits.states_mci`.

    References
    ----------
    RFC 7946, sections 3.1.6 (right-hand rule), 3.1.9 (antimeridian), 4 (coordinates); The
    GeoJSON Format Specification, 2008, section 3 (crs).
    """
    c, sphere, mask = design.constellation, design.figure.equatorial_radius, design.mask.lowest
    r = positions_mcmf(c, times, motion)
    latitude, longitude = latitude_longitude(r)
    lon, lat = np.degrees(longitude), np.degrees(latitude)
    when = iso(tdb(c.epoch, times[:1]))[0]
    features = []
    for k, name in enumerate(c.satellite_names):
        distance = float(np.linalg.norm(r[k, 0]))
        geometry = cap(distance, sphere, mask)
        about = {"satellite": name, "epoch_tdb": when}
        point = {"type": "Point", "coordinates": _places(lon[k, :1], lat[k, :1])[0]}
        features.append(_feature(f"satellite/{name}", point, about | {"radius_km": distance / 1e3}))
        outline = _circle(r[k, 0] / distance, geometry.half_arc)
        features.append(
            _feature(
                f"footprint/{name}",
                _polygons(spherical_polygon(outline)),
                about
                | {
                    "half_angle_deg": float(np.degrees(geometry.half_arc)),
                    "mask_deg": float(np.degrees(mask)),
                    "area_km2": geometry.area / 1e6,
                },
            )
        )
        track = _track(lon[k], lat[k])
        if track:
            lines = {"type": "MultiLineString", "coordinates": track}
            span = {"duration_h": float(times[-1] - times[0]) / 3600}
            features.append(_feature(f"ground track/{name}", lines, about | span))
    features += _gaps(design, r[:, 0], when)
    collection = {
        "type": "FeatureCollection",
        "name": design.name,
        "crs": {"type": "name", "properties": {"name": CRS_NAME}},
        "metadata": {
            "body": "Mars",
            "note": _NOTE,
            "sphere_radius_m": sphere,
            "epoch_tdb": when,
        },
        "features": features,
    }
    return json.dumps(collection, ensure_ascii=False, allow_nan=False)


def _gaps(design: Design, r_mcmf: NDArray[np.float64], when: str) -> list[dict[str, Any]]:
    """Features of the gaps, two a plane."""
    c, sphere, mask = design.constellation, design.figure.equatorial_radius, design.mask.lowest
    if c.pattern is None:
        return []
    geometry = gap(float(c.semi_major_axis[0]), sphere, c.pattern.per_plane, mask)
    if geometry is None:
        return []
    features = []
    for n, shape in enumerate(gap_polygons(c, r_mcmf, sphere, mask)):
        plane, side = n // 2 + 1, "about its pole" if n % 2 == 0 else "opposite"
        about = {
            "plane": plane,
            "side": side,
            "sides": geometry.sides,
            "area_km2": geometry.area / 1e6,
            "epoch_tdb": when,
        }
        features.append(_feature(f"gap/P{plane}/{side}", _polygons(shape), about))
    return features


def _feature(identity: str, geometry: dict[str, Any], about: dict[str, Any]) -> dict[str, Any]:
    kind = {"kind": identity.partition("/")[0], "body": "Mars", "crs": CRS_NAME}
    return {"type": "Feature", "id": identity, "properties": kind | about, "geometry": geometry}


def _circle(axis: NDArray[np.float64], radius: float) -> NDArray[np.float64]:
    """Unit vectors around an axis at an angle (radians), counter-clockwise seen from outside."""
    helper = np.eye(3)[np.argmin(np.abs(axis))]
    across = np.cross(axis, helper)
    across /= np.linalg.norm(across)
    azimuth = np.linspace(0, 2 * np.pi, CORNERS, endpoint=False)[:, np.newaxis]
    ring = np.cos(azimuth) * across + np.sin(azimuth) * np.cross(axis, across)
    return np.cos(radius) * axis + np.sin(radius) * ring


def _polygons(shape: "MultiPolygon") -> dict[str, Any]:
    """Geometry with outer rings counter-clockwise; one polygon alone is not a multiple."""
    from shapely.geometry.polygon import orient

    rings = []
    for part in shape.geoms:
        turned = orient(part, 1.0)
        rings.append(
            [_places(*np.array(ring.coords).T) for ring in (turned.exterior, *turned.interiors)]
        )
    if len(rings) == 1:
        return {"type": "Polygon", "coordinates": rings[0]}
    return {"type": "MultiPolygon", "coordinates": rings}


def _track(lon: NDArray[np.float64], lat: NDArray[np.float64]) -> list[list[list[float]]]:
    """Lines of a ground track, cut where it crosses the antimeridian; none if it stands still."""
    x = np.unwrap(lon, period=360)
    if max(np.ptp(x), np.ptp(lat)) < STILL:
        return []
    world = np.floor((x + 180) / 360)
    pieces: list[list[list[float]]] = []
    begin, head = 0, np.empty((0, 2))
    for k in np.flatnonzero(np.diff(world)).tolist():
        edge = 180 + 360 * min(world[k], world[k + 1])
        share = (edge - x[k]) / (x[k + 1] - x[k])
        cross = lat[k] + share * (lat[k + 1] - lat[k])
        east = 180.0 if x[k + 1] > x[k] else -180.0
        body = np.column_stack([x[begin : k + 1] - 360 * world[k], lat[begin : k + 1]])
        pieces.append(_places(*np.vstack([head, body, [[east, cross]]]).T))
        begin, head = k + 1, np.array([[-east, cross]])
    body = np.column_stack([x[begin:] - 360 * world[-1], lat[begin:]])
    pieces.append(_places(*np.vstack([head, body]).T))
    return pieces


def _places(lon: NDArray[np.float64], lat: NDArray[np.float64]) -> list[list[float]]:
    places: list[list[float]] = np.round(np.column_stack([lon, lat]), DECIMALS).tolist()
    return places
