"""How well a user who stands still knows his place from ranges and Doppler gathered over time.

Fewer than four satellites give no fix at a moment, but the sight lines turn while the user stands:
so a constellation serves before it is complete.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.clocks import Clock
from compass.core.error import SHARED
from compass.core.gather import EACH, OWN, gather
from compass.design import Design
from compass.frames import mcmf_from_mci, prime_meridian_angle
from compass.signal.budget import mean_age_covariance, receiver_numbers
from compass.signal.determination import clock_noise
from compass.signal.ranges import radial_along_cross, shared_numbers
from compass.sites import Site

#: How far the place is known before, m: east and north, and up where no height is given.
SIDEWAYS, UPWARDS = 1e5, 1e4

#: Half the time over which partials are differenced for Doppler, s.
HALF = 1.0


@dataclass(frozen=True)
class Sights:
    """What is measured of satellites from a site, and how well.

    Attributes
    ----------
    times
        Seconds after the epoch, shape (t,).
    rows
        Partials of range and range rate: place (east, north, up), own clock and its rate, the
        satellite's radial, along, cross and clock error; shape (t, n, 2, 9).
    variances
        m^2 and (m/s)^2, infinite where not seen, shape (t, n, 2).
    """

    times: NDArray[np.float64]
    rows: NDArray[np.float64]
    variances: NDArray[np.float64]

    @property
    def seen(self) -> NDArray[np.int64]:
        """Satellites in view, shape (t,)."""
        return np.asarray(np.isfinite(self.variances[..., 0]).sum(axis=1))


def sights_from(design: Design, site: Site, times: NDArray[np.float64], doppler: float) -> Sights:
    """Ranges and Doppler of all satellites of a design that a site sees.

    The errors of a satellite's broadcast orbit and clock are constant over the time; what they do
    to Doppler is how their share in the range changes. The ionosphere is left out.

    Parameters
    ----------
    design
        With a signal.
    site
        Whose horizon counts.
    times
        Seconds after the epoch, shape (t,).
    doppler
        One sigma of a range rate, m/s.
    """
    before, now, after = (_lines(design, site, times + d)[0] for d in (-HALF, 0.0, HALF))
    distance, r = _lines(design, site, times)[1:]
    rows = np.zeros((times.size, design.constellation.size, 2, OWN + EACH))
    rate = (after - before) / (2 * HALF)
    for kind, part in enumerate((now, rate)):
        rows[:, :, kind, :3], rows[:, :, kind, OWN : OWN + 3] = part[..., :3], part[..., 3:]
    rows[:, :, 0, 3], rows[:, :, 1, 4], rows[:, :, 0, OWN + 3] = 1.0, 1.0, 1.0
    elevation, azimuth = (each.T for each in site.elevation_azimuth(r))
    noise, zenith, a, b = receiver_numbers(design)
    with np.errstate(divide="ignore"):
        own = (noise + zenith / np.sin(elevation)) ** 2 + a * distance**2 + b * distance**4
    seen = elevation >= site.mask.at(azimuth)
    variances = np.stack([own, np.full_like(own, doppler**2)], axis=-1)
    return Sights(times, rows, np.where(seen[..., None], variances, np.inf))


def _lines(design: Design, site: Site, times: NDArray[np.float64]) -> tuple[Any, Any, Any]:
    """Partials of ranges by place and by orbit errors (t, n, 6), distances (t, n), places."""
    c = design.constellation
    angle = prime_meridian_angle(c.epoch, times)
    r, v = design.motion.states(c, times)
    fixed = mcmf_from_mci(r, angle)
    axes = radial_along_cross(r, v)
    turned = np.stack([mcmf_from_mci(axes[..., k, :], angle) for k in range(3)], axis=-2)
    line = fixed - site.r_mcmf
    distance = np.linalg.norm(line, axis=-1)
    u = line / distance[..., None]
    place = -u @ np.array(site.enu_mcmf).T
    orbit = np.einsum("ntki,nti->ntk", turned, u)
    both = np.concatenate([place, orbit], axis=-1)
    return np.moveaxis(both, 0, 1), distance.T, fixed


def standing_covariance(
    design: Design, sights: Sights, clock: Clock | None, height: float | None
) -> NDArray[np.float64]:
    """Covariance of the place (east, north, up) after every epoch, m^2, shape (t, 3, 3).

    Parameters
    ----------
    design
        Whose signal says how well orbits and clocks are known.
    sights
        What is measured.
    clock
        The user's: its offset and rate are unknown before, then it wanders as it does; None: it is
        another one at every epoch.
    height
        One sigma of a known height, m; None where it is as unknown as `UPWARDS`.
    """
    assert design.signal is not None
    n = design.constellation.size
    p = np.zeros((OWN + EACH * n, OWN + EACH * n))
    p[(0, 1, 2), (0, 1, 2)] = SIDEWAYS**2, SIDEWAYS**2, (UPWARDS if height is None else height) ** 2
    for s, each in enumerate(mean_age_covariance(design.signal, n)):
        part = slice(OWN + EACH * s, OWN + EACH * (s + 1))
        p[part, part] = each
    step = float(sights.times[1] - sights.times[0])
    out = np.empty((sights.times.size, 3, 3))
    gather(p, sights.rows, sights.variances, step, clock_noise(clock, step), clock is None, out)
    out[:, (0, 1), (0, 1)] += shared_numbers(design)[SHARED]  # no time of standing takes it away
    return out
