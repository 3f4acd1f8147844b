"""The entry of Lou et al. 2017: its tables, its blackout, and filters that work on it."""

import numpy as np
from numpy.typing import NDArray

from compass.entry.atmosphere import Atmosphere
from compass.entry.model import EntryModel
from compass.entry.vehicle import Vehicle
from compass.papers.lou_case import Imu, NavigationCase, beacons_from_states
from compass.papers.lou_filters import SCALE, Algorithm, FilterSettings

GM, PLANET_RADIUS, SECONDS = 4.282829e13, 3397.2e3, 250
BEACONS = ("orbiter 1", "orbiter 2", "orbiter 3")
POSITIONS_KM = np.array(
    [(780.44, 13276.13, 1267.20), (3492.70, 3659.20, 215.11), (3927.85, -230.90, 374.91)]
)
VELOCITIES = np.array([(-317.7, -50, 1697.2), (-605.1, 97, 3232.8), (93.6, 3120.8, -584.1)])
RANGE_VARIANCE = np.full(3, 40.0)
#: Table 2's state: r, lon, lat, V, gamma, psi.
START = np.array([3522.2e3, 0.0, 0.0, 5900.0, np.radians(-16.0), np.radians(5.156)])
#: Table 2's sigma (flight-path angle and azimuth: 1 deg in the text, 0.5 deg in Table 2).
START_SIGMA = np.array([1e3, *np.radians([0.02, 0.02]), 20.0, *np.radians([0.5, 0.5])])
#: Sigma of ln(rho0 C_D S/m), each factor known to 10 %, and of L/D.
DENSITY_SIGMA, LIFT_SIGMA = 0.1 * 2**0.5, 0.0156

#: Six states that work although the parameters are wrong: noise that covers the wrong drag.
SIX_Q = np.array([10.0, 1e-12, 1e-12, 25.0, 1e-5, 1e-8])
SIX_ACCELERATION_VARIANCE = np.full(3, 400.0)
#: Process noise too small for the wrong drag, which shows the paper's Figure 7.
SMALL_Q = np.array([1.0, 1e-14, 1e-14, 1e-2, 1e-10, 1e-10])
EIGHT_Q = np.array([1.0, 1e-14, 1e-14, 1e-2, 1e-10, 1e-10, 1e-6, 1e-6])
EIGHT_ACCELERATION_VARIANCE = np.full(3, 1e-4)


def entry_model() -> EntryModel:
    """Model of the paper: planet at rest, exponential atmosphere, bank angle 0."""
    air = Atmosphere(2e-4, 3437.2e3, 7500.0)
    return EntryModel(Vehicle(0.016, 0.156), air, "none", GM, PLANET_RADIUS)


def case(*, plasma: bool = True) -> NavigationCase:
    """Table 2's truth with the bias of section 5, its ranges through the wake's plasma."""
    times = np.arange(SECONDS + 1.0)
    clear = NavigationCase(
        name="Lou et al. 2017",
        truth=entry_model(),
        start=START,
        beacons=beacons_from_states(BEACONS, POSITIONS_KM * 1e3, VELOCITIES, times, GM),
        range_sigma=np.sqrt(RANGE_VARIANCE),
        imu=Imu((1e-3, 1e-3, 1e-3), (0.003, 0.003, 0.003)),
    )
    return clear.through_plasma() if plasma else clear


def six_state_filter(
    algorithm: Algorithm,
    q: NDArray[np.float64] = SIX_Q,
    acceleration_variance: NDArray[np.float64] = SIX_ACCELERATION_VARIANCE,
) -> FilterSettings:
    """Six states with parameters 10 % uncertain, as in the paper; its Q and R are not printed.

    Density and C_D S/m enter as their product alone: two errors of 10 % are one of sqrt(2) 10 %.
    """
    return FilterSettings(
        algorithm=algorithm,
        model=entry_model(),
        start=START,
        p0=START_SIGMA**2,
        process_noise=q,
        acceleration_variance=acceleration_variance,
        range_variance=RANGE_VARIANCE,
        random_start=True,
        parameter_sigma=(DENSITY_SIGMA, LIFT_SIGMA),
        scale=SCALE[:6],
    )


def recommended_filter(algorithm: Algorithm) -> FilterSettings:
    """Eight states: ln rho0 and L/D are estimated, from the uncertainties of Table 2."""
    return FilterSettings(
        algorithm=algorithm,
        model=entry_model(),
        start=START,
        p0=np.concatenate([START_SIGMA**2, [DENSITY_SIGMA**2, LIFT_SIGMA**2]]),
        process_noise=EIGHT_Q,
        acceleration_variance=EIGHT_ACCELERATION_VARIANCE,
        range_variance=RANGE_VARIANCE,
        random_start=True,
        scale=SCALE[:8],
    )
