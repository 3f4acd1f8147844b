"""A constellation's motion in the form the certificate kernels take, in the frame that suits."""

import numpy as np

from compass.core.certificate import Frame, Orbits
from compass.coverage.region import GLOBE, Region
from compass.coverage.symmetry import Span
from compass.frames import prime_meridian_angle
from compass.orbits import Constellation

#: Bound on the second derivative of W, rad/s^2: the sum over its trigonometric terms of amplitude
#: times rate squared (Archinal et al. 2018, Table 1), 2.30e-19, rounded up.
MERIDIAN_CURVATURE = 3e-19


def motion_of(
    constellation: Constellation, span: Span, region: Region = GLOBE, *, about_pole: bool = False
) -> tuple[Orbits, Frame]:
    """Orbits of a constellation, and the frame in which a region stands still over a span.

    The frame's error bounds the departure of Mars's rotation from uniform in the span, and what
    the symmetries miss that the span stands on.

    Any turning frame will do for the whole sphere and any that turns about the pole for a band
    of latitude: the one that follows the satellites on average makes their motion smallest. A
    polygon needs the Mars-fixed frame; there W is taken as the chord over the span, which
    departs from it by at most an eighth of its curvature times the span squared. An ellipsoid
    looks the same only from a frame that turns about its pole (`about_pole`).
    """
    c = constellation
    elements = np.array(
        [
            c.semi_major_axis,
            c.eccentricity,
            c.inclination,
            c.raan,
            c.argument_of_periapsis,
            c.mean_anomaly,
            c.mean_motion,
        ]
    )
    si, ci = np.sin(c.inclination), np.cos(c.inclination)
    poles = np.stack([si * np.sin(c.raan), -si * np.cos(c.raan), ci], axis=-1)
    orbits = Orbits(elements, poles, c.gm)
    if region.mars_fixed:
        length = span.stop - span.start
        first, last = prime_meridian_angle(c.epoch, [span.start, span.stop])
        rate = (last - first) / length
        spin = np.array([0.0, 0.0, rate])
        error = MERIDIAN_CURVATURE * length**2 / 8 + 2 * np.spacing(abs(last))
        angle = float(np.mod(first - rate * span.start, 2 * np.pi))
        return orbits, Frame(spin, angle, float(error) + span.mismatch)
    spin = (c.mean_motion[:, np.newaxis] * poles).mean(axis=0) if c.size else np.zeros(3)
    if about_pole or not region.is_globe:
        spin = spin * [0.0, 0.0, 1.0]
    return orbits, Frame(spin, float("nan"), span.mismatch)
