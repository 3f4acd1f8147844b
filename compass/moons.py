"""Phobos and Deimos: precessing ellipses on their Laplace planes, or plain circles."""

from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from compass.bodies import (
    DEIMOS_SEMI_MAJOR_AXIS,
    MARS_GM,
    PHOBOS_SEMI_MAJOR_AXIS,
)
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY, mci_from_icrf

MoonName = Literal["phobos", "deimos"]
MoonModel = Literal["precessing", "circular"]

# Sinclair's epoch, JED 2441266.5 (1971 November 11.0), in days past J2000
_EPOCH_DAYS = 2441266.5 - 2451545.0
_DAYS_PER_YEAR = 365.25

#: Constant B1950 to J2000 rotation of equatorial components, FK4 to FK5: Explanatory Supplement
#: to the Astronomical Almanac, 1992, eq. 3.591-4, position part.
J2000_FROM_B1950 = np.array(
    [
        [0.9999256782, -0.0111820611, -0.0048579477],
        [0.0111820610, 0.9999374784, -0.0000271765],
        [0.0048579479, -0.0000271474, 0.9999881997],
    ]
)


def moon_row(
    name: str,
    epoch: float,
    middle: float,
    model: MoonModel = "precessing",
    from_icrf: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """Row of a moon for the kernels (`compass.core.motion`), in the inertial frame of `epoch`.

    ``precessing``: mean longitude L, longitude of periapsis P and node K on the Laplace plane
    drift linearly, with Phobos's secular acceleration and the 54-year term in Deimos's
    longitude; the Laplace plane has node N and inclination J on the B1950 equator. L, N and J
    are taken linear, or constant, about `middle`: over 1000 sols that is good to 0.4 km.
    ``circular``: a circle on Mars's equator at the same mean distance, with two-body motion and
    the true longitude of `middle`.

    Parameters
    ----------
    name
        ``phobos`` or ``deimos``.
    epoch
        TDB seconds past J2000 of the inertial frame and of time 0.
    middle
        Seconds after the epoch.
    model
        How the moon moves.
    from_icrf
        Rotation from ICRF components to those of the frame, shape (3, 3), if it is not that of
        `frames.mci_from_icrf`.

    Raises
    ------
    ArgumentError
        The moon or the model is unknown.

    References
    ----------
    Sinclair 1989, The orbits of the satellites of Mars determined from Earth-based and
    spacecraft observations, Astron. Astrophys. 220:321. Within 20 km (Phobos) and 45 km
    (Deimos) of the numerical ephemeris of Lainey, Dehant and Paetzold 2007 in 2000, and within
    32 and 45 km of JPL Horizons in 2024 (tests).
    """
    from compass.core.motion import ELLIPSE, WIDTH

    if model not in get_args(MoonModel):
        raise ArgumentError(f"model = {model!r}: allowed {', '.join(get_args(MoonModel))}")
    days = (epoch + middle) / SECONDS_PER_DAY - _EPOCH_DAYS
    years = days / _DAYS_PER_YEAR
    if name == "phobos":
        a, e, inclination = PHOBOS_SEMI_MAJOR_AXIS.value, 0.014979, 1.1029
        longitude = 232.412 + 1128.8445566 * days + 0.001237 * years**2
        longitude_rate = 1128.8445566 + 2 * 0.001237 * years / _DAYS_PER_YEAR
        periapsis, periapsis_rate = 278.96 + 0.435258 * days, 0.435258
        node, node_rate = 327.90 - 0.435330 * days, -0.435330
        plane_node, plane_tilt = 47.386 - 0.00140 * years, 37.271 + 0.00080 * years
    elif name == "deimos":
        a, e, inclination = DEIMOS_SEMI_MAJOR_AXIS.value, 0.000391, 1.7901
        periapsis, periapsis_rate = 111.7 + 0.017985 * days, 0.017985
        node, node_rate = 240.38 - 0.018008 * days, -0.018008
        phase = np.radians(node - 43.83)
        longitude = 28.963 + 285.1618875 * days - 0.274 * np.sin(phase)
        longitude_rate = 285.1618875 - 0.274 * np.cos(phase) * np.radians(node_rate)
        plane_node, plane_tilt = 46.367 - 0.00138 * years, 36.623 + 0.00079 * years
    else:
        raise ArgumentError(f"moon = {name!r}: allowed {', '.join(get_args(MoonName))}")
    rates = np.radians([node_rate, periapsis_rate - node_rate, longitude_rate - periapsis_rate])
    angles = np.radians([node, periapsis - node - plane_node, longitude - periapsis])
    rates /= SECONDS_PER_DAY
    plane = _about_z(np.radians(plane_node)) @ _about_x(np.radians(plane_tilt))
    to_frame = mci_from_icrf(epoch) if from_icrf is None else from_icrf
    rotation = to_frame @ J2000_FROM_B1950 @ plane
    row = np.zeros(WIDTH)
    row[:5] = ELLIPSE, a, e, np.cos(np.radians(inclination)), np.sin(np.radians(inclination))
    row[5:8] = np.mod(angles - rates * middle, 2 * np.pi)
    row[8:11] = rates
    row[11:] = rotation.ravel()
    return _circle(row, middle) if model == "circular" else row


def _circle(row: NDArray[np.float64], middle: float) -> NDArray[np.float64]:
    """Row of the equatorial circle at the distance, and the longitude at `middle`, of `row`."""
    from compass.core.motion import mover_state

    x, y = mover_state(row, np.zeros((1, 6)), middle)[:2]
    motion = np.sqrt(MARS_GM.value / row[1] ** 3)
    circle = np.zeros_like(row)
    circle[:4] = row[0], row[1], 0.0, 1.0
    circle[7], circle[10] = np.mod(np.arctan2(y, x) - motion * middle, 2 * np.pi), motion
    circle[11:] = np.eye(3).ravel()
    return circle


def _about_z(angle: float) -> NDArray[np.float64]:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _about_x(angle: float) -> NDArray[np.float64]:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
