"""Errors of the fixes of users over time: at a site, on a route over the ground, in orbit."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compass.core.error import NUMBERS, Ranges, errors_over_time
from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import (
    Figure,
    direction,
    east_north_up,
    latitude_longitude,
    mcmf_from_mci,
    planetographic_latitude,
    prime_meridian_angle,
)
from compass.orbits.constellation import Constellation
from compass.orbits.motion import Motion
from compass.orbits.positions import states_mci
from compass.signal.ranges import Weighting, aloft_numbers, range_errors
from compass.sites import Mask, Site

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Mover:
    """A user over time.

    Attributes
    ----------
    name
        What to call it.
    r
        Mars-fixed positions, m, shape (t, 3).
    axes
        East, north and up there, rows, shape (t, 3, 3).
    mask
        The horizon of a user on the ground; None of one in orbit, from whom Mars alone hides.
    """

    name: str
    r: Array
    axes: Array
    mask: Mask | None = None

    @property
    def aloft(self) -> bool:
        """Whether it is in orbit: looks down, over no horizon of the ground."""
        return self.mask is None or self.mask.lowest < 0.0


def standing(site: Site, epochs: int) -> Mover:
    """Return a site as a user over so many epochs."""
    return Mover(
        site.name,
        np.tile(site.r_mcmf, (epochs, 1)),
        np.tile(site.enu_mcmf, (epochs, 1, 1)),
        site.mask,
    )


def on_route(name: str, places: Sequence[tuple[float, float]], figure: Figure, mask: Mask,
             gone: Array) -> Mover:  # fmt: skip
    """Return a rover on its way along great circles through places.

    Parameters
    ----------
    name
        What to call it.
    places
        Planetocentric latitude and east longitude, radians; two or more.
    figure, mask
        The ground, and the horizon that it takes along.
    gone
        Parts of the way that it has behind it, 0 to 1, one an epoch.

    Raises
    ------
    ArgumentError
        Two places of the route in a row lie opposite each other, or all at one point.
    """
    corners = np.array([direction(lat, lon) for lat, lon in places])
    legs = np.arccos(np.clip((corners[1:] * corners[:-1]).sum(axis=1), -1.0, 1.0))
    if np.any(legs > np.pi - 1e-6):
        raise ArgumentError(
            f"route {name}: two places in a row lie opposite each other; name one between them"
        )
    past = np.concatenate([[0.0], np.cumsum(legs)])
    if past[-1] < 1e-9:
        raise ArgumentError(f"route {name}: leads nowhere; give a station for one who stays")
    along = past[-1] * gone
    k = np.clip(np.searchsorted(past, along, side="right") - 1, 0, len(legs) - 1)
    angle = legs[k]
    share = np.divide(along - past[k], angle, out=np.zeros(gone.size), where=angle > 0)
    # the mean of two directions by angle: sin((1 - s) a) u + sin(s a) w over sin a
    sine = np.where(angle > 0, np.sin(angle), 1.0)
    first = np.where(angle > 0, np.sin((1.0 - share) * angle) / sine, 1.0)
    second = np.where(angle > 0, np.sin(share * angle) / sine, 0.0)
    unit = first[:, None] * corners[k] + second[:, None] * corners[k + 1]
    lat, lon = latitude_longitude(unit)
    a, b = figure.equatorial_radius, figure.polar_radius
    radius = a * b / np.hypot(b * np.cos(lat), a * np.sin(lat))
    axes = east_north_up(planetographic_latitude(lat, figure), lon)
    return Mover(name, radius[:, None] * unit, axes, mask)


def in_orbit(orbit: Constellation, epoch: float, times: Array, figure: Figure) -> Mover:
    """Return an orbiter on its ellipse, its elements at `epoch`; east, north and up as a sphere's.

    Raises
    ------
    ArgumentError
        It comes down to the surface.
    """
    name = orbit.satellite_names[0]
    if (low := float(orbit.periapsis_radius.min())) <= figure.equatorial_radius:
        raise ArgumentError(
            f"orbiter {name}: comes down to radius {low / 1e3:g} km; must stay above "
            f"{figure.equatorial_radius / 1e3:g} km"
        )
    r, _ = states_mci(orbit, times)
    fixed = mcmf_from_mci(r[0], prime_meridian_angle(epoch, times))
    return Mover(name, fixed, east_north_up(*latitude_longitude(fixed)))


@dataclass(frozen=True)
class Sights:
    """The satellites over time, and which of them a user has in view.

    Attributes
    ----------
    r
        Mars-fixed positions, in equatorial radii, shape (t, n, 3).
    seen
        Who is in view, shape (t, n).
    around
        How many would be, did their antennas reach all around, shape (t,).
    ranges
        What their ranges are worth.
    """

    r: Array
    seen: NDArray[np.bool_]
    around: NDArray[np.int64]
    ranges: Ranges


def sights_along(
    design: Design,
    mover: Mover,
    times: Array,
    motion: Motion | None = None,
    *,
    beam: float | None = None,
) -> Sights:
    """Who is in view of a user at every epoch; parameters as of `errors_along`."""
    moved = motion or design.motion
    return Sights(*seen_along(design, mover, times, moved, beam), ranges_at(design, times, moved))


def ranges_at(
    design: Design, times: Array, motion: Motion, weights: Weighting = "variance"
) -> Ranges:
    """What ranges are worth at every epoch, as kernels take it."""
    worth = range_errors(design, times, motion, weights)
    return Ranges(worth.forms, worth.sun, worth.lit, worth.numbers)


def seen_along(
    design: Design,
    mover: Mover,
    times: Array,
    motion: Motion,
    beam: float | None = None,
    beacons: Sequence[Site] = (),
) -> tuple[Array, NDArray[np.bool_], NDArray[np.int64]]:
    """Where satellites are at every epoch and who is in view, first three of `Sights`.

    And after them beacons on the ground, which reach all around, but not who stands at one.
    """
    c, radius = design.constellation, design.figure.equatorial_radius
    angle = prime_meridian_angle(c.epoch, times)
    r = np.moveaxis(mcmf_from_mci(motion.states(c, times)[0], angle), 0, 1)
    ground = np.reshape([beacon.r_mcmf for beacon in beacons], (-1, 3))
    r = np.concatenate([r, np.broadcast_to(ground, (len(r), *ground.shape))], axis=1)
    line = r - mover.r[:, None]
    distance = np.linalg.norm(line, axis=2)
    u = line / np.maximum(distance, 1e-9)[..., None]
    if mover.mask is None:
        closest = np.einsum("tni,ti->tn", u, mover.r)
        miss2 = np.einsum("ti,ti->t", mover.r, mover.r)[:, None] - closest**2
        seen = (closest >= 0.0) | (miss2 > radius**2)
    else:
        east, north, up = np.moveaxis(np.einsum("tij,tnj->tni", mover.axes, u), 2, 0)
        azimuth = np.mod(np.arctan2(east, north), 2 * np.pi)
        seen = np.arcsin(np.clip(up, -1.0, 1.0)) >= mover.mask.at(azimuth)
    seen[:, c.size :] &= distance[:, c.size :] > 1.0
    around = seen.sum(axis=1)
    if beam is not None:
        within = np.einsum("tni,tni->tn", r, u) / np.linalg.norm(r, axis=2) >= np.cos(beam)
        seen[:, : c.size] &= within[:, : c.size]
    return np.ascontiguousarray(r / radius), seen, around


def errors_along(
    design: Design,
    mover: Mover,
    times: Array,
    motion: Motion | None = None,
    *,
    beam: float | None = None,
) -> tuple[NDArray[np.int64], Array, NDArray[np.int64]]:
    """Satellites in view and errors of a fix at every epoch, one sigma.

    Weighted least squares with the true variances, as of maps (`compass.core.error`). An orbiter
    has its receiver's noise at the zenith, and no ionosphere.

    Parameters
    ----------
    design
        With a signal.
    mover
        The user at these epochs.
    times
        Seconds after the epoch, shape (t,).
    motion
        Instead of the design's.
    beam
        Half angle of the satellites' antennas about the way down, rad; all around if left out.

    Returns
    -------
    count, errors, around
        In view, shape (t,); horizontal, vertical, position and time error, m, shape (t, 4),
        infinite without a fix; how many would be in view of antennas that reach all around, (t,).
    """
    sights = sights_along(design, mover, times, motion, beam=beam)
    return sights.seen.sum(axis=1), fix_errors(design, mover, sights), sights.around


def metre_ranges(moments: int, satellites: int) -> Ranges:
    """Ranges of one metre all: errors of a fix are dilutions then."""
    forms = np.zeros((moments, satellites, 10))
    forms[..., 9] = 1.0
    return Ranges(forms, np.zeros((moments, 3)), np.zeros(2), np.zeros(NUMBERS))


def dilutions_along(design: Design, mover: Mover, sights: Sights) -> dict[str, Array]:
    """Dilutions of a user's fixes at every epoch by name; infinite without one.

    `sights` are with `metre_ranges`.
    """
    horizontal, vertical, position, time = fix_errors(design, mover, sights).T
    return {
        "gdop": np.hypot(position, time),
        "pdop": position,
        "hdop": horizontal,
        "vdop": vertical,
        "tdop": time,
    }


def heard_by(mover: Mover, sights: Sights) -> Ranges:
    """What a user's ranges are worth: in orbit with noise of the zenith, and no ionosphere."""
    ranges = sights.ranges
    return ranges._replace(numbers=aloft_numbers(ranges.numbers)) if mover.aloft else ranges


def fix_errors(design: Design, mover: Mover, sights: Sights) -> Array:
    """Horizontal, vertical, position and time error of a user's fixes, m, shape (t, 4)."""
    out = np.empty((len(mover.r), 4))
    errors_over_time(
        np.ascontiguousarray(mover.r / design.figure.equatorial_radius),
        np.ascontiguousarray(mover.axes[:, 2]),
        sights.r,
        sights.seen,
        heard_by(mover, sights),
        out,
    )
    return out
