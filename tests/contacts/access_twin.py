"""Slow, obvious twins of the access kernels: positions, sight and shadow, sampled."""

import numpy as np

from compass.frames import mcmf_from_mci, prime_meridian_angle


def positions(constellation, times):
    """Inertial positions, (satellite, time, 3), by Newton on Kepler's equation."""
    c = constellation
    m = c.mean_anomaly[:, None] + c.mean_motion[:, None] * times
    e = c.eccentricity[:, None]
    anomaly = m + e * np.sin(m)
    for _ in range(12):
        anomaly -= (anomaly - e * np.sin(anomaly) - m) / (1 - e * np.cos(anomaly))
    a = c.semi_major_axis[:, None]
    x, y = a * (np.cos(anomaly) - e), a * np.sqrt(1 - e * e) * np.sin(anomaly)
    w, o, i = (v[:, None] for v in (c.argument_of_periapsis, c.raan, c.inclination))
    u, v = x * np.cos(w) - y * np.sin(w), x * np.sin(w) + y * np.cos(w)
    return np.stack(
        [
            np.cos(o) * u - np.sin(o) * np.cos(i) * v,
            np.sin(o) * u + np.cos(o) * np.cos(i) * v,
            np.sin(i) * v,
        ],
        axis=-1,
    )


def station_sees(constellation, site, times):
    """Whether the site sees each satellite, (satellite, time)."""
    fixed = mcmf_from_mci(
        positions(constellation, times), prime_meridian_angle(constellation.epoch, times)
    )
    return site.sees(fixed)


def ray_clear(p, q, equatorial, polar):
    """Whether the segment from p to q (..., 3) stays outside an ellipsoid, at its nearest point."""
    weight = np.array([1 / equatorial**2, 1 / equatorial**2, 1 / polar**2])
    d = q - p
    along = np.clip(-(weight * p * d).sum(-1) / np.maximum((weight * d * d).sum(-1), 1e-30), 0, 1)
    nearest = p + along[..., None] * d
    return (weight * nearest * nearest).sum(-1) >= 1


def in_shadow(p, sun, radius, sun_radius, total):
    """Whether the Sun's disc is touched (or wholly hidden) by Mars's, from apparent sizes."""
    to_sun = sun - p
    distance = np.linalg.norm(to_sun, axis=-1)
    r = np.linalg.norm(p, axis=-1)
    apart = np.arccos(np.clip(-(p * to_sun).sum(-1) / (r * distance), -1, 1))
    mars, disc = np.arcsin(radius / r), np.arcsin(sun_radius / distance)
    return apart < mars + (-disc if total else disc)


def covered(spans, times, slack=2e-3):
    """Whether each time lies in a span, and whether it is clear of every edge by `slack`."""
    inside = np.zeros(times.size, dtype=bool)
    clear = np.ones(times.size, dtype=bool)
    for start, end in spans:
        inside |= (times >= start) & (times <= end)
        clear &= (np.abs(times - start) > slack) & (np.abs(times - end) > slack)
    return inside, clear
