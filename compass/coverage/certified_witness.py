"""A place and moment that shows a dilution of precision, and the dilution there by itself."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.coverage.certified_ranges import Ranges
from compass.frames import mcmf_from_mci, prime_meridian_angle
from compass.orbits import Constellation
from compass.orbits.motion import Motion
from compass.sites import Site


@dataclass(frozen=True)
class WorstWitness:
    """A place and moment with a dilution of precision, evaluated there by itself.

    Attributes
    ----------
    time
        Seconds after the epoch.
    latitude, longitude
        Planetocentric and east, Mars-fixed, radians.
    value
        The dilution; inf with fewer than four in view.
    satellites
        Names of those in view.
    """

    time: float
    latitude: float
    longitude: float
    value: float
    satellites: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """Plain values with degrees."""
        return {
            "time_s": self.time,
            "latitude_deg": float(np.degrees(self.latitude)),
            "longitude_deg": float(np.degrees(self.longitude)),
            "value": self.value,
            "satellites": list(self.satellites),
        }


def in_view(
    constellation: Constellation,
    site: Site,
    time: float,
    motion: Motion,
    beam: float | None = None,
) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Mars-fixed places of the satellites in view of a site at a moment, and their names.

    Of those alone in whose beam of that half angle it is, if any.
    """
    angle = prime_meridian_angle(constellation.epoch, time)
    r = mcmf_from_mci(motion.states(constellation, [time])[0][:, 0], angle)
    seen = site.sees(r)
    if beam is not None:
        lines = r - site.r_mcmf
        down = (lines * r).sum(axis=1) / np.linalg.norm(r, axis=1)
        seen &= down >= np.cos(beam) * np.linalg.norm(lines, axis=1)
    return r[seen], tuple(np.array(constellation.satellite_names)[seen].tolist())


def dilution_at(
    constellation: Constellation,
    site: Site,
    time: float,
    motion: Motion,
    dop: str,
    ranges: Ranges | None = None,
    beam: float | None = None,
) -> tuple[float, tuple[str, ...]]:
    """A dilution at a site and moment by inverting the normal matrix, and who is in view.

    With ranges of rows over their sigmas: an error in metres, without what all satellites share.
    """
    r, names = in_view(constellation, site, time, motion, beam)
    sights = r - site.r_mcmf
    units = sights / np.linalg.norm(sights, axis=1, keepdims=True)
    rows = np.column_stack([units, np.ones(len(units))])
    if len(rows) < 4:
        return np.inf, names
    if ranges is not None:
        rows = rows / ranges.sigmas(constellation, site, time, motion)[:, np.newaxis]
    _, singular, turns = np.linalg.svd(rows)
    if singular[-1] < 1e-12 * singular[0]:
        return np.inf, names
    up = np.append(site.enu_mcmf[2], 0.0)
    spread = turns / singular[:, np.newaxis]  # inverse of the normal matrix is spread' spread
    position = float((spread[:, :3] ** 2).sum())
    clock, vertical = float((spread[:, 3] ** 2).sum()), float(((spread @ up) ** 2).sum())
    squares = {
        "gdop": position + clock,
        "pdop": position,
        "hdop": position - vertical,
        "vdop": vertical,
        "tdop": clock,
    }
    return float(np.sqrt(squares[dop])), names
