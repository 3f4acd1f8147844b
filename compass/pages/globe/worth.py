"""What ranges are worth, as plain values from which the globe works out errors in metres."""

import base64
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.clocks import SECONDS_PER_DAY
from compass.core import error
from compass.design import Design
from compass.planets import sun_mci
from compass.signal.budget import mean_age_covariance
from compass.signal.ranges import range_errors
from compass.units import KM


def worth(design: Design, duration: float) -> dict[str, Any] | None:
    """Everything `compass.core.error` has of a range, in metres and kilometres; None without any.

    Covariances are of radial, along, cross and clock, one for all satellites where they are alike.
    The Sun's directions are inertial, at even times from the first to the last.
    """
    if design.signal is None:
        return None
    c, square = design.constellation, (design.figure.equatorial_radius / KM) ** 2
    covariance = mean_age_covariance(design.signal, c.size)
    alike = bool((covariance == covariance[0]).all())
    ranges = range_errors(design, [0.0])
    numbers = ranges.numbers.tolist()
    sun = sun_mci(c.epoch, np.linspace(0.0, duration, 2 + int(duration / SECONDS_PER_DAY)))
    return {
        "covariance": packed(covariance[:1] if alike else covariance),
        "noise_m": numbers[error.NOISE],
        "zenith_m": numbers[error.ZENITH],
        "loop_m2_km2": numbers[error.LOOP] / square,
        "loop_m2_km4": numbers[error.LOOP2] / square**2,
        "delay_m2": numbers[error.DELAY2],
        "shell2": numbers[error.SHELL2],
        "horizontal_m2": 2.0 * numbers[error.SHARED],
        "time_m2": numbers[error.SHARED_TIME],
        "lowest_sine": error.LOWEST_SINE,
        "lit": packed(ranges.lit),
        "sun": packed(sun / np.linalg.norm(sun, axis=1, keepdims=True)),
    }


def packed(values: NDArray[Any]) -> str:
    """Bytes of an array as text."""
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode("ascii")
