"""Variances of ranges as kernels want them: each satellite's form in the Mars-fixed frame."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core import error
from compass.core.ionosphere import sunlit_table
from compass.design import Design
from compass.frames import mcmf_from_mci, prime_meridian_angle
from compass.orbits.motion import Motion
from compass.planets import sun_mci
from compass.signal.budget import mean_age_covariance, receiver_numbers
from compass.signal.ionosphere import SCALE_HEIGHT, SHELL, zenith_delay

#: Entries of the table of the Sun's zenith angle.
LIT = 1024

Weighting = Literal["variance", "equal"]


@dataclass(frozen=True)
class RangeErrors:
    """Errors of ranges to every satellite at some epochs.

    Attributes
    ----------
    forms
        Q (xx, yy, zz, xy, xz, yz), q and p of ``u'Q u + 2 q.u + p``, m^2, of unit vectors from user
        to satellite, Mars-fixed, shape (epoch, satellite, 10).
    sun
        Directions of the Sun, Mars-fixed, shape (epoch, 3).
    lit
        Share of the ionosphere's variance by the Sun's zenith angle: see `compass.core.ionosphere`.
    numbers
        What all ranges share: see `compass.core.error`.
    """

    forms: NDArray[np.float64]
    sun: NDArray[np.float64]
    lit: NDArray[np.float64]
    numbers: NDArray[np.float64]


def range_errors(
    design: Design,
    times: ArrayLike,
    motion: Motion | None = None,
    weights: Weighting = "variance",
) -> RangeErrors:
    """Errors of the ranges of a design with a signal, at seconds after the epoch.

    Parameters
    ----------
    design
        With a signal.
    times
        Seconds, shape (t,).
    motion
        Instead of the design's.
    weights
        ``variance``: the fix knows the variances; ``equal``: it weighs all ranges alike.

    Raises
    ------
    ArgumentError
        A receiver's loop without its link; covariances for another number of satellites.
    """
    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    angle = prime_meridian_angle(design.constellation.epoch, seconds)
    return RangeErrors(
        _forms(design, seconds, angle, motion or design.motion),
        _sun(design, seconds, angle),
        sunlit_table((design.figure.equatorial_radius + SHELL) / SCALE_HEIGHT, LIT),
        shared_numbers(design, weights),
    )


def radial_along_cross(r: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit vectors along and across orbits, rows radial, along, cross, shape (..., 3, 3)."""
    radial = r / np.linalg.norm(r, axis=-1, keepdims=True)
    cross = np.cross(r, v)
    cross /= np.linalg.norm(cross, axis=-1, keepdims=True)
    return np.stack([radial, np.cross(cross, radial), cross], axis=-2)


def _forms(
    design: Design, seconds: NDArray[np.float64], angle: NDArray[np.float64], motion: Motion
) -> NDArray[np.float64]:
    """Covariances turned from radial, along, cross into the Mars-fixed frame, (t, n, 10)."""
    assert design.signal is not None
    c = design.constellation
    r, v = motion.states(c, seconds)
    axes = np.moveaxis(radial_along_cross(r, v), 2, 0)  # (n, t, 3, 3) to (3, n, t, 3)
    fixed = np.stack([mcmf_from_mci(each, angle) for each in axes], axis=2)
    p = mean_age_covariance(design.signal, c.size)
    inertial = np.swapaxes(fixed, 2, 3)
    turned = np.swapaxes(inertial @ p[:, np.newaxis, :3, :3] @ fixed, 0, 1)
    with_clock = np.swapaxes(inertial @ p[:, np.newaxis, :3, 3, np.newaxis], 0, 1)[..., 0]
    forms = np.empty((seconds.size, c.size, 10))
    for k, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))):
        forms[..., k] = turned[..., i, j]
    forms[..., 6:9], forms[..., 9] = with_clock, p[:, 3, 3]
    return forms


def _sun(
    design: Design, seconds: NDArray[np.float64], angle: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Directions of the Sun, (t, 3); looked up only where the ionosphere delays."""
    assert design.signal is not None
    if not _delay(design):
        return np.zeros((seconds.size, 3))
    sun = sun_mci(design.constellation.epoch, seconds)
    turned = mcmf_from_mci(sun, angle)
    return np.asarray(turned / np.linalg.norm(turned, axis=-1, keepdims=True))


def _delay(design: Design) -> float:
    """Delay of the ionosphere that is left in, straight up below the Sun, m."""
    assert design.signal is not None
    signal = design.signal
    return 0.0 if signal.dual else zenith_delay(signal.ionosphere, signal.frequency)


def shared_numbers(design: Design, weights: Weighting = "variance") -> NDArray[np.float64]:
    """Numbers that all ranges share, as `compass.core.error` names them."""
    assert design.signal is not None
    radius = design.figure.equatorial_radius
    noise, zenith, a, b = receiver_numbers(design)
    numbers = np.zeros(error.NUMBERS)
    numbers[error.NOISE], numbers[error.ZENITH] = noise, zenith
    numbers[error.LOOP], numbers[error.LOOP2] = a * radius**2, b * radius**4
    numbers[error.DELAY2] = _delay(design) ** 2
    numbers[error.SHELL2] = (radius / (radius + SHELL)) ** 2
    numbers[error.SHARED] = (radius * design.signal.common_orientation) ** 2
    numbers[error.SHARED_TIME] = design.signal.common_time**2
    numbers[error.EQUAL] = float(weights == "equal")
    return numbers


def aloft_numbers(numbers: NDArray[np.float64]) -> NDArray[np.float64]:
    """Numbers of `shared_numbers` for who is in orbit, where noise is that of the zenith.

    No ionosphere lies between orbiters and satellites above the shell.
    """
    aloft = numbers.copy()
    aloft[error.NOISE] += aloft[error.ZENITH]
    aloft[error.ZENITH] = aloft[error.DELAY2] = 0.0
    return aloft
