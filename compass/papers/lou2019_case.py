"""The entry of Lou et al. 2019: its tables, as printed and as they should be."""

import numpy as np

from compass.entry.atmosphere import Atmosphere
from compass.entry.model import EntryModel
from compass.entry.vehicle import Vehicle
from compass.papers.lou_case import Imu, NavigationCase, beacons_from_states
from compass.papers.lou_filters import SCALE, Algorithm, FilterSettings, Weighting

GM, PLANET_RADIUS, SECONDS = 4.282829e13, 3397.2e3, 300
LIFT_TO_DRAG, DRAG_AREA, DENSITY = 0.156, 0.016, 2e-4
#: Longitude and latitude, degrees: as printed (beacons hidden), and where they are visible.
PRINTED_POINT, A0 = (-89.872, -28.02), (0.0, 0.0)

BEACONS = ("surface 1", "surface 2", "orbiter 1", "orbiter 2")
POSITIONS_KM = np.array(
    [(3300, 420, 1350), (3290, 570, 755), (7855.7, -461.8, 749.82), (3492.7, 3659.2, 215.11)]
)
VELOCITIES = np.array([(0, 0, 0), (0, 0, 0), (66.2, 2206.4, -413), (-605.1, 97, 3232.8)])
RANGE_VARIANCE = np.array([20.0, 20.0, 40.0, 40.0])
ACCELERATION_VARIANCE = np.full(3, 1e-6)

#: P0 and Q as printed, in the order of the state.
PUBLISHED_P0 = np.array([1e4, 1e-6, 1e-6, 1e2, 1e-2, 1e-2, 1e-2, 1e-2])
PUBLISHED_Q = np.array([1e2, 1e-8, 1e-8, 10.0, 1e-4, 1e-4, 1e-4, 1e-4])
_DEGREES = np.radians(0.2) ** 2
RECOMMENDED_P0 = np.array([1e6, _DEGREES, _DEGREES, 100.0, _DEGREES, _DEGREES, 0.04, 4e-4])
RECOMMENDED_Q = np.array([1.0, 1e-14, 1e-14, 1e-2, 1e-10, 1e-10, 1e-6, 1e-6])


def entry_model(
    density: float = DENSITY, ld: float = LIFT_TO_DRAG, area: float = DRAG_AREA
) -> EntryModel:
    """Model of the paper: planet at rest, exponential atmosphere, bank angle 0."""
    air = Atmosphere(density, 3437.2e3, 7500.0)
    return EntryModel(Vehicle(area, ld), air, "none", GM, PLANET_RADIUS)


def case(
    point: tuple[float, float] = A0, *, noisy_truth: bool = False, bias: float = 0.0
) -> NavigationCase:
    """Table 1's truth from a longitude and latitude in degrees.

    `noisy_truth` gives the truth the recommended process noise; `bias` is that of every
    accelerometer, m/s^2 (-0.03 in the paper: 30 sigma of its own R).
    """
    lon, lat = np.radians(point)
    start = [3518.2e3, lon, lat, 5515.0, np.radians(-11.8), np.radians(5.156)]
    times = np.arange(SECONDS + 1.0)
    return NavigationCase(
        name="Lou et al. 2019",
        truth=entry_model(),
        start=np.array(start),
        beacons=beacons_from_states(BEACONS, POSITIONS_KM * 1e3, VELOCITIES, times, GM),
        range_sigma=np.sqrt(RANGE_VARIANCE),
        imu=Imu((1e-3, 1e-3, 1e-3), (bias, bias, bias)),
        process_noise=RECOMMENDED_Q if noisy_truth else np.zeros(8),
    )


def published_filter(
    algorithm: Algorithm, point: tuple[float, float] = A0, *, linear: bool = True
) -> FilterSettings:
    """Table 1's estimate with the printed P0, Q, R, in SI; rho0 itself is the state if `linear`."""
    lon, lat = np.radians(np.array(point) - 0.2)
    start = [3519.2e3, lon, lat, 5525.0, np.radians(-12.0), np.radians(5.356)]
    return FilterSettings(
        algorithm=algorithm,
        model=entry_model(2.2e-4, 0.17, 0.0176),
        start=start,
        p0=PUBLISHED_P0,
        process_noise=PUBLISHED_Q,
        acceleration_variance=ACCELERATION_VARIANCE,
        range_variance=RANGE_VARIANCE,
        published_linear_density=linear,
    )


def recommended_filter(
    algorithm: Algorithm,
    point: tuple[float, float] = A0,
    *,
    weighting: Weighting | None = None,
) -> FilterSettings:
    """Match the truth: ln rho0 as state, starts drawn from P0, weights in scaled units."""
    lon, lat = np.radians(point)
    start = [3518.2e3, lon, lat, 5515.0, np.radians(-11.8), np.radians(5.156)]
    return FilterSettings(
        algorithm=algorithm,
        model=entry_model(),
        start=start,
        p0=RECOMMENDED_P0,
        process_noise=RECOMMENDED_Q,
        acceleration_variance=ACCELERATION_VARIANCE,
        range_variance=RANGE_VARIANCE,
        random_start=True,
        weighting=weighting,
        scale=SCALE[:8],
    )
