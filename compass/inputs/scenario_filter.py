"""The filter of a scenario file: its method, first covariance, and what else is not known."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from compass.entry.covariance import axes_covariance
from compass.entry.filters import Filter, Method
from compass.entry.layout import Part
from compass.entry.mars_air import SPREAD
from compass.entry.views import cartesian_of, spherical_jacobian
from compass.errors import ArgumentError
from compass.frames import HOUR
from compass.inputs.scenario_models import (
    FilterTable,
)
from compass.units import KM

_METHODS: dict[str, Method] = {
    "ekf": "plain",
    "iterated-ekf": "plain",
    "relinearised-ekf": "relinearised",
    "unscented": "unscented",
    "square-root-ekf": "square-root",
    "information-ekf": "information",
}


#: Cosine of a latitude below which sigmas of longitude and heading say nothing.
POLAR = 1e-9


def filter_of(table: FilterTable, state: NDArray[np.float64], planet_radius: float) -> Filter:
    """Filter that a table [filter] asks for."""
    if table.position_sigma_m is not None and table.velocity_sigma_m_s is not None:
        covariance = axes_covariance(table.position_sigma_m, table.velocity_sigma_m_s)
    else:
        degrees = np.radians(
            [
                table.longitude_sigma_deg or 0.0,
                table.latitude_sigma_deg or 0.0,
                table.flight_path_sigma_deg or 0.0,
                table.heading_sigma_deg or 0.0,
            ]
        )
        radius, speed = table.radius_sigma_m or 0.0, table.speed_sigma_m_s or 0.0
        if abs(np.cos(state[2])) < POLAR:
            raise ArgumentError(
                f"entry.latitude_deg = {np.degrees(state[2]):g}: at a pole longitude and heading "
                "are undefined, and so are sigmas of them; give filter.position_sigma_m and "
                "filter.velocity_sigma_m_s"
            )
        jacobian = spherical_jacobian(cartesian_of(state[:6]))
        root = jacobian * np.array([radius, *degrees[:2], speed, *degrees[2:]])
        covariance = root @ root.T
    return Filter(
        covariance,
        np.array(table.process_noise_si or [0.0] * 6),
        table.iterations if table.kind in ("iterated-ekf", "square-root-ekf") else 1,
        _parts(table, state, planet_radius),
        _METHODS[table.kind],
    )


def _parts(
    table: FilterTable, state: NDArray[np.float64], planet_radius: float
) -> tuple[Part, ...]:
    """Quantities that are not known, beside position and velocity."""
    blocks = (("lift", table.lift_to_drag), ("bias", table.range_bias))
    parts = [Part(name, (b.sigma,), b.considered) for name, b in blocks if b is not None]
    if (air := table.density) is not None:
        scales = (air.scale_km or np.inf, air.along_km or np.inf)
        wanders = np.isfinite(scales).any()
        own = tuple(KM * scale for scale in scales) if wanders else ()
        rows = SPREAD if air.sigma_by_km == "mars" else air.sigma_by_km or ()
        profile = tuple((planet_radius + KM * float(km), float(sigma)) for km, sigma in rows)
        part = Part("air", (air.sigma or 1.0,), air.considered, own, profile)
        first = float(part.sigma_at(state[:1])[0])
        parts.insert(0, replace(part, sigma=(first,)))
    if (clock := table.clock) is not None:
        parts.append(Part("clock", (clock.sigma_m, clock.drift_sigma_m_s), clock.considered))
    if (axes := table.attitude) is not None:
        parts.append(Part("attitude", (float(np.radians(axes.sigma_deg)),) * 3, axes.considered))
    if (gyros := table.gyros) is not None:
        drift, walk = np.radians([gyros.drift_sigma_deg_h / HOUR, gyros.walk_deg_sqrt_h / 60.0])
        parts.append(Part("gyro", (float(drift),) * 3, gyros.considered, walk=float(walk)))
    if (felt := table.accelerometers) is not None:
        parts.append(Part("imu", (felt.sigma_m_s2,) * 3, felt.considered))
    return tuple(parts)
