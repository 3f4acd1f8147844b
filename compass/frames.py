"""Frames of Mars: inertial, rotating, latitude and longitude, east-north-up, and the map CRS.

Mars-centred inertial (``r_mci``): z along the spin pole of the epoch, x along the ascending
node of Mars's equator on the ICRF equator. Mars-centred Mars-fixed (``r_mcmf``): turned from
it about z by the prime-meridian angle W. Longitude is east-positive, latitude planetocentric.
"""

from dataclasses import dataclass
from datetime import datetime
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.bodies import KELLY2018_RADIUS, MARS_EQUATORIAL_RADIUS, MARS_POLAR_RADIUS
from compass.errors import ArgumentError

if TYPE_CHECKING:
    from pyproj import CRS

#: Seconds.
HOUR = 3600.0
SECONDS_PER_DAY = 86400.0
SECONDS_PER_CENTURY = 36525.0 * SECONDS_PER_DAY
J2000 = datetime(2000, 1, 1, 12)


@dataclass(frozen=True)
class Figure:
    """A reference figure of Mars: ellipsoid of revolution, semi-axes in metres.

    Maps, proofs and sites use the figure.
    """

    name: str
    equatorial_radius: float
    polar_radius: float
    iau_code: int | None
    title: str

    @property
    def words(self) -> str:
        """Its title without its radii."""
        return self.title.split(",")[0]

    @property
    def is_sphere(self) -> bool:
        """Whether both semi-axes are equal."""
        return self.equatorial_radius == self.polar_radius

    @property
    def stretch(self) -> float:
        """Factor along the pole that makes it a sphere of the equatorial radius."""
        return self.equatorial_radius / self.polar_radius


FIGURES = {
    figure.name: figure
    for figure in (
        Figure(
            "iau-sphere",
            MARS_EQUATORIAL_RADIUS.value,
            MARS_EQUATORIAL_RADIUS.value,
            49900,
            "IAU 2015 sphere, 3396.19 km",
        ),
        Figure(
            "iau-ellipsoid",
            MARS_EQUATORIAL_RADIUS.value,
            MARS_POLAR_RADIUS.value,
            49902,
            "IAU 2015 ellipsoid, 3396.19 km by 3376.20 km, planetocentric latitude",
        ),
        Figure(
            "kelly2018-sphere",
            KELLY2018_RADIUS.value,
            KELLY2018_RADIUS.value,
            None,
            "sphere of Kelly and Bevilacqua 2018, 3396.2 km",
        ),
    )
}

#: What a file, a site or a function means that names no figure.
DEFAULT_FIGURE = FIGURES["iau-sphere"]


def figure_of(figure: Figure | str) -> Figure:
    """Return a figure, looked up in `FIGURES` if it is a name.

    Raises
    ------
    ArgumentError
        There is none of that name.
    """
    if isinstance(figure, Figure):
        return figure
    if figure not in FIGURES:
        raise ArgumentError(f"figure = {figure!r}: not known; allowed {', '.join(FIGURES)}")
    return FIGURES[figure]


class FigureByName:
    """A dataclass's field that holds a figure and takes its name too, as files do."""

    def __get__(self, holder: object, kind: type | None = None) -> Figure:
        return DEFAULT_FIGURE if holder is None else vars(holder)["figure"]

    def __set__(self, holder: object, figure: Figure | str) -> None:
        vars(holder)["figure"] = figure_of(figure)


#: Stands as such a field's default.
BY_NAME = FigureByName()


# Rows: amplitude deg, phase deg, rate deg per Julian century (Archinal et al. 2018, Table 1).
_POLE_RA = np.array(
    [
        [0.000068, 198.991226, 19139.4819985],
        [0.000238, 226.292679, 38280.8511281],
        [0.000052, 249.663391, 57420.7251593],
        [0.000009, 266.183510, 76560.6367950],
        [0.419057, 79.398797, 0.5042615],
    ]
)
_POLE_DEC = np.array(
    [
        [0.000051, 122.433576, 19139.9407476],
        [0.000141, 43.058401, 38280.8753272],
        [0.000031, 57.663379, 57420.7517205],
        [0.000005, 79.476401, 76560.6495004],
        [1.591274, 166.325722, 0.5042615],
    ]
)
_MERIDIAN = np.array(
    [
        [0.000145, 129.071773, 19140.0328244],
        [0.000157, 36.352167, 38281.0473591],
        [0.000040, 56.668646, 57420.9295360],
        [0.000001, 67.364003, 76560.2552215],
        [0.000001, 104.792680, 95700.4387578],
        [0.584542, 95.391654, 0.5042615],
    ]
)


def seconds_past_j2000(when: datetime) -> float:
    """Return TDB seconds past J2000 (2000-01-01 12:00 TDB) of a naive TDB date and time."""
    return (when - J2000).total_seconds()


def spin_pole(epoch: float) -> tuple[float, float]:
    """Right ascension and declination of Mars's north pole in ICRF, radians.

    Parameters
    ----------
    epoch
        TDB seconds past J2000.

    References
    ----------
    Archinal et al. 2018, Report of the IAU Working Group on Cartographic Coordinates and
    Rotational Elements: 2015, Table 1.
    """
    centuries = epoch / SECONDS_PER_CENTURY
    ra = 317.269202 - 0.10927547 * centuries + _trigonometric(np.sin, _POLE_RA, centuries)
    dec = 54.432516 - 0.05827105 * centuries + _trigonometric(np.cos, _POLE_DEC, centuries)
    return float(np.radians(ra)), float(np.radians(dec))


def prime_meridian_angle(epoch: float, times: ArrayLike = 0.0) -> NDArray[np.float64]:
    """Angle W from the inertial x axis to the prime meridian, radians, not reduced modulo 2 pi.

    ``W = 176.049863 deg + 350.891982443297 deg/day d + small trigonometric terms``

    Parameters
    ----------
    epoch
        TDB seconds past J2000.
    times
        Seconds after the epoch, any shape.
    """
    seconds = np.asarray(times, dtype=float) + epoch
    centuries = seconds / SECONDS_PER_CENTURY
    degrees = 176.049863 + 350.891982443297 * (seconds / SECONDS_PER_DAY)
    return np.radians(degrees + _trigonometric(np.sin, _MERIDIAN, centuries))


def _trigonometric(function: np.ufunc, rows: NDArray, centuries: ArrayLike) -> NDArray:
    """Sum of amplitude times `function`(phase + rate T) over `rows`, degrees."""
    t = np.asarray(centuries)[..., np.newaxis]
    return (rows[:, 0] * function(np.radians(rows[:, 1] + rows[:, 2] * t))).sum(axis=-1)


def mci_from_icrf(epoch: float) -> NDArray[np.float64]:
    """Rotation matrix that takes ICRF components to Mars-centred inertial ones at `epoch`."""
    ra, dec = spin_pole(epoch)
    node, tilt = ra + np.pi / 2, np.pi / 2 - dec
    cn, sn, ct, st = np.cos(node), np.sin(node), np.cos(tilt), np.sin(tilt)
    return np.array([[cn, sn, 0.0], [-sn * ct, cn * ct, st], [sn * st, -cn * st, ct]])


def mcmf_from_mci(r_mci: ArrayLike, angle: ArrayLike) -> NDArray[np.float64]:
    """Rotate vectors from the inertial to the Mars-fixed frame.

    Parameters
    ----------
    r_mci
        Vectors, shape (..., 3), any unit.
    angle
        Prime-meridian angle W, radians, broadcast against the leading shape of `r_mci`.
    """
    r = np.asarray(r_mci, dtype=float)
    c, s = np.cos(angle), np.sin(angle)
    x, y = r[..., 0], r[..., 1]
    return np.stack([c * x + s * y, c * y - s * x, r[..., 2] * np.ones_like(c)], axis=-1)


def direction(latitude: ArrayLike, longitude: ArrayLike) -> NDArray[np.float64]:
    """Unit vector, shape (..., 3), of a planetocentric latitude and east longitude in radians."""
    lat, lon = np.broadcast_arrays(
        np.asarray(latitude, dtype=float), np.asarray(longitude, dtype=float)
    )
    return np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=-1)


def latitude_longitude(r: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Planetocentric latitude and east longitude in (-pi, pi], radians, of vectors (..., 3)."""
    v = np.asarray(r, dtype=float)
    return (
        np.arctan2(v[..., 2], np.hypot(v[..., 0], v[..., 1])),
        np.arctan2(v[..., 1], v[..., 0]),
    )


def planetographic_latitude(planetocentric: ArrayLike, figure: Figure) -> NDArray[np.float64]:
    """Latitude of the surface normal where the planetocentric latitude is given, radians.

    ``tan(phi_g) = (a/b)^2 tan(phi_c)``
    """
    lat = np.asarray(planetocentric, dtype=float)
    ratio = (figure.equatorial_radius / figure.polar_radius) ** 2
    return np.arctan2(ratio * np.sin(lat), np.cos(lat))


def planetocentric_latitude(planetographic: ArrayLike, figure: Figure) -> NDArray[np.float64]:
    """Inverse of `planetographic_latitude`: ``tan(phi_c) = (b/a)^2 tan(phi_g)``, radians."""
    lat = np.asarray(planetographic, dtype=float)
    ratio = (figure.polar_radius / figure.equatorial_radius) ** 2
    return np.arctan2(ratio * np.sin(lat), np.cos(lat))


def east_north_up(latitude: ArrayLike, longitude: ArrayLike) -> NDArray[np.float64]:
    """Rows east, north, up of the local frame, shape (..., 3, 3).

    Parameters
    ----------
    latitude
        Latitude of the *up* direction, radians: planetographic on an ellipsoid.
    longitude
        East longitude, radians.
    """
    lat, lon = np.broadcast_arrays(
        np.asarray(latitude, dtype=float), np.asarray(longitude, dtype=float)
    )
    zero = np.zeros_like(lon)
    east = np.stack([-np.sin(lon), np.cos(lon), zero], axis=-1)
    up = direction(lat, lon)
    return np.stack([east, np.cross(up, east), up], axis=-2)


@cache
def mars_crs(figure_name: str = "iau-sphere") -> "CRS":
    """Geographic coordinate reference system of a reference figure (pyproj), east-positive.

    ``IAU_2015:49900`` for the sphere, ``IAU_2015:49902`` for the ellipsoid; the sphere of a
    paper takes the IAU definition with its own radius.
    """
    from pyproj import CRS

    figure = FIGURES[figure_name]
    if figure.iau_code is not None:
        return CRS.from_authority("IAU_2015", figure.iau_code)
    definition = CRS.from_authority("IAU_2015", 49900).to_json_dict()
    del definition["id"]
    definition["name"] = f"Mars / {figure.title}"
    definition["datum"]["name"] = figure.name
    definition["datum"]["ellipsoid"] = {
        "name": figure.title,
        "radius": figure.equatorial_radius,
    }
    return CRS.from_json_dict(definition)


@cache
def map_crs(figure_name: str = "iau-sphere", central_longitude_deg: float = 0.0) -> "CRS":
    """Equal-area world map of Mars (Mollweide on the sphere of the figure's radius), metres."""
    from pyproj import CRS

    radius = FIGURES[figure_name].equatorial_radius
    return CRS.from_proj4(
        f"+proj=moll +lon_0={central_longitude_deg} +R={radius} +units=m +no_defs"
    )
