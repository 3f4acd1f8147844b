"""The entry of Lou et al. 2017: its tables, its blackout, and filters that work on it."""

import numpy as np
from numpy.typing import NDArray

from compass.entry.atmosphere import Atmosphere
from compass.entry.case import NavigationCase, two_body_positions
from compass.entry.filters import SCALE, Algorithm, FilterSettings
from compass.entry.imu import Imu
from compass.entry.model import EntryModel
from compass.entry.vehicle import Vehicle

GM, PLANET_RADIUS, SECONDS = 4.282829e13, 3397.2e3, 250
BEACONS = ("orbiter 1", "orbiter 2", "orbiter 3")
POSITIONS_KM = np.array(
    [(780.44, 13276.13, 1267.20), (3492.70, 3659.20, 215.11), (3927.85, -230.90, 374.91)]
)
VELOCITIES = np.array([(-317.7, -50, 1697.2), (-605.1, 97, 3232.8), (93.6, 3120.8, -584.1)])
RANGE_VARIANCE = np.full(3, 40.0)
#: Table 2's state: r, lon, lat, V, gamma, psi.
START = np.array([3522.2e3, 0.0, 0.0, 5900.0, np.radians(-16.0), np.radians(5.156)])
#: Start errors of section 5 and the same as sigma (flight-path angle and azimuth: 1 deg in the
#: text, 0.5 deg in Table 2; the larger is taken for both).
START_ERROR = np.array([1e3, *np.radians([0.02, 0.02]), 20.0, *np.radians([1.0, 1.0])])
#: Reference density, L/D and ballistic coefficient are each known to 10 %.
PARAMETER_ERROR = 0.1

#: Six states that work although the parameters are wrong: noise that covers the wrong drag.
SIX_Q = np.array([10.0, 1e-12, 1e-12, 25.0, 1e-5, 1e-8])
SIX_ACCELERATION_VARIANCE = np.full(3, 400.0)
#: Process noise too small for the wrong drag, which shows the paper's Figure 7.
SMALL_Q = np.array([1.0, 1e-14, 1e-14, 1e-2, 1e-10, 1e-10])
EIGHT_Q = np.array([1.0, 1e-14, 1e-14, 1e-2, 1e-10, 1e-10, 1e-6, 1e-6])
EIGHT_ACCELERATION_VARIANCE = np.full(3, 1e-4)


def entry_model(error: float = 0.0) -> EntryModel:
    """Model of the paper; density, L/D and C_D S/m larger than true by the share `error`."""
    factor = 1.0 + error
    air = Atmosphere(2e-4 * factor, 3437.2e3, 7500.0)
    return EntryModel(Vehicle(0.016 * factor, 0.156 * factor), air, "none", GM, PLANET_RADIUS)


def beacon_positions(times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Table 3 over time, metres, shape (K+1, 3, 3), as two bodies move."""
    columns = [
        two_body_positions(r * 1e3, v, times, GM)
        for r, v in zip(POSITIONS_KM, VELOCITIES, strict=True)
    ]
    return np.stack(columns, axis=1)


def case(*, plasma: bool = True) -> NavigationCase:
    """Table 2's truth with the bias of section 5, its ranges through the wake's plasma."""
    times = np.arange(SECONDS + 1.0)
    clear = NavigationCase(
        "Lou et al. 2017",
        entry_model(),
        START,
        BEACONS,
        beacon_positions(times),
        np.sqrt(RANGE_VARIANCE),
        Imu((1e-3, 1e-3, 1e-3), (0.003, 0.003, 0.003)),
    )
    return clear.through_plasma() if plasma else clear


def six_state_filter(
    algorithm: Algorithm,
    q: NDArray[np.float64] = SIX_Q,
    acceleration_variance: NDArray[np.float64] = SIX_ACCELERATION_VARIANCE,
) -> FilterSettings:
    """Six states and parameters 10 % wrong, as in the paper; its Q and R are not printed."""
    return FilterSettings(
        algorithm,
        entry_model(PARAMETER_ERROR),
        START + START_ERROR,
        START_ERROR**2,
        q,
        acceleration_variance,
        RANGE_VARIANCE,
        scale=SCALE[:6],
    )


def recommended_filter(algorithm: Algorithm) -> FilterSettings:
    """Eight states: ln rho0 and L/D are estimated with 10 % of sigma."""
    wrong = entry_model(PARAMETER_ERROR)
    tail = [(2 * PARAMETER_ERROR) ** 2, (0.156 * PARAMETER_ERROR) ** 2]
    return FilterSettings(
        algorithm,
        wrong,
        START + START_ERROR,
        np.concatenate([START_ERROR**2, tail]),
        EIGHT_Q,
        EIGHT_ACCELERATION_VARIANCE,
        RANGE_VARIANCE,
        scale=SCALE[:8],
    )
