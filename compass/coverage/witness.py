"""Counter-examples: a moment and a place with too few satellites in view, checked plainly."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.coverage.fold import clearances
from compass.coverage.region import GLOBE, Region
from compass.frames import latitude_longitude, mcmf_from_mci, prime_meridian_angle
from compass.orbits import Constellation, positions_mci

#: A satellite is hidden for sure if it is this far below the mask, radians: the rounding of the
#: positions and of one arc tangent is some 1e-14.
SURE = 1e-12

#: Moves of one length at most; 63 of the first, 0.05, go around the sphere halfway.
MOVES = 64


@dataclass(frozen=True)
class Witness:
    """A moment and a place where the fold is too low.

    Attributes
    ----------
    time
        Seconds after the epoch.
    latitude, longitude
        Planetocentric and east, Mars-fixed, radians.
    fold
        Satellites in view there.
    satellites
        Their names.
    shortfall
        How far the best hidden satellite that is needed stands below the mask, radians.
    """

    time: float
    latitude: float
    longitude: float
    fold: int
    satellites: tuple[str, ...]
    shortfall: float

    def as_dict(self) -> dict[str, Any]:
        """Plain values with degrees and hours."""
        return {
            "time_s": self.time,
            "latitude_deg": float(np.degrees(self.latitude)),
            "longitude_deg": float(np.degrees(self.longitude)),
            "fold": self.fold,
            "satellites": list(self.satellites),
            "shortfall_deg": float(np.degrees(self.shortfall)),
        }


def find_witness(
    constellation: Constellation,
    sphere_radius: float,
    mask: float,
    fold: int,
    time: float,
    start: NDArray[np.float64],
    region: Region = GLOBE,
    stretch: float = 1.0,
) -> Witness | None:
    """Walk from a point to where `fold` satellites are missed by most, and confirm the miss.

    Parameters
    ----------
    constellation, sphere_radius, mask, fold
        What is claimed: at least `fold` satellites above the mask.
    time
        Seconds after the epoch.
    start
        Unit vector to begin at, in the inertial frame.
    region
        Where the claim is made.
    stretch
        Ratio of the equatorial radius, `sphere_radius`, to the polar one.

    Returns
    -------
    witness
        None if no point on the way has fewer than `fold` satellites in view, by `SURE`.
    """
    positions = positions_mci(constellation, [time])[:, 0]
    angle = float(prime_meridian_angle(constellation.epoch, time))
    names = constellation.satellite_names
    return witness_among(
        positions,
        names,
        angle,
        sphere_radius,
        mask,
        fold,
        time,
        start,
        region,
        stretch=stretch,
    )


def witness_among(
    positions: NDArray[np.float64],
    names: tuple[str, ...],
    angle: float,
    sphere_radius: float,
    mask: float,
    fold: int,
    time: float,
    start: NDArray[np.float64],
    region: Region = GLOBE,
    sure: float = SURE,
    stretch: float = 1.0,
) -> Witness | None:
    """`find_witness` of satellites at inertial positions, metres, shape (n, 3).

    Parameters
    ----------
    positions, names
        Where, and their names.
    angle
        Of the prime meridian, radians.
    sphere_radius, mask, fold, time, start, region, stretch
        As in `find_witness`.
    sure
        By how much the satellites must be missed, radians.
    """

    def missing(points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Clearance of the fold-th best satellite; infinite outside the region."""
        clearance = clearances(positions, sphere_radius, mask, points, stretch)
        best = (
            -np.sort(-clearance, axis=-1)[..., fold - 1]
            if fold <= len(positions)
            else np.full(points.shape[:-1], -np.pi)
        )
        framed = mcmf_from_mci(points, angle) if region.mars_fixed else points
        return np.where(region.contains(framed), best, np.inf)

    place = np.array(start, dtype=float)
    value = float(missing(place))
    step, left = 0.05, MOVES
    compass_rose = np.linspace(0.0, 2 * np.pi, 12, endpoint=False)
    while step > 1e-7:
        east = np.cross([0.0, 0.0, 1.0] if abs(place[2]) < 0.9 else [1.0, 0.0, 0.0], place)
        east /= np.linalg.norm(east)
        north = np.cross(place, east)
        ways = np.outer(np.cos(compass_rose), east) + np.outer(np.sin(compass_rose), north)
        around = np.cos(step) * place + np.sin(step) * ways
        values = missing(around)
        # where two satellites are equally needed the way down is a narrow valley, in which moves
        # gain ever less: any place on it is a counter-example, so they need not be many
        if values.min() < value and left:
            value, place = float(values.min()), around[values.argmin()]
            left -= 1
        else:
            step, left = step * 0.5, MOVES
    if value > -sure:
        return None
    seen = clearances(positions, sphere_radius, mask, place, stretch) >= 0
    latitude, longitude = latitude_longitude(mcmf_from_mci(place, angle))
    return Witness(
        time=float(time),
        latitude=float(latitude),
        longitude=float(longitude),
        fold=int(seen.sum()),
        satellites=tuple(np.array(names)[seen].tolist()),
        shortfall=-value,
    )
