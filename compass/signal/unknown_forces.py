"""What is not known of the forces on satellites: sunlight's scale, and the field of gravity."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.bodies import MARS_EQUATORIAL_RADIUS, MARS_GM, SUN_RADIUS
from compass.core.pushes import pushes
from compass.design import Design
from compass.frames import prime_meridian_angle
from compass.orbits.forces import SHADOWS, ForceModel
from compass.orbits.gravity import built_in_field, built_in_sigmas, unit_terms
from compass.orbits.motion import Motion
from compass.planets import sun_mci

Array = NDArray[Any]

#: Highest degree of the coefficients whose errors are considered.
DEGREE = 3


def forces_of(motion: Motion) -> ForceModel:
    """Forces of a motion; of one without, those that numerical motion takes of itself."""
    return motion.forces or ForceModel()


def field_variances(sigmas: float) -> Array:
    """Variances of GM (relative) and of the field's coefficients, shape (1 + g,).

    Parameters
    ----------
    sigmas
        How many formal ones their errors have: GM's of DE440, coefficients' of the built-in field.
    """
    formal = [MARS_GM.uncertainty / MARS_GM.value]
    formal += [sigma for *_, sigma in built_in_sigmas(DEGREE)]
    return np.asarray((sigmas * np.array(formal)) ** 2)


def pushes_along(design: Design, motion: Motion, times: Array, r: Array) -> Array:
    """Accelerations a unit of sunlight's scale, GM (relative) and each coefficient of the field.

    Parameters
    ----------
    design
        Its epoch.
    motion
        Whose forces say how sunlight pushes and Mars shades.
    times
        Seconds after the epoch, shape (t,).
    r
        Inertial places, m, shape (n, t, 3).

    Returns
    -------
    Array
        Shape (n, t, 3, 2 + g), m/s^2.
    """
    forces, field, epoch = forces_of(motion), built_in_field(), design.constellation.epoch
    names = built_in_sigmas(DEGREE)
    terms = np.stack([unit_terms(kind, n, m, DEGREE) for kind, n, m, _ in names])
    out = np.empty((*r.shape, 2 + len(names)))
    pushes(
        np.ascontiguousarray(r),
        np.ascontiguousarray(sun_mci(epoch, times)),
        prime_meridian_angle(epoch, times) + field.meridian,
        forces.sunlight,
        SHADOWS.index(forces.shadow),
        np.array([MARS_EQUATORIAL_RADIUS.value, SUN_RADIUS.value]),
        terms,
        DEGREE + 1,
        field.radius,
        field.gm,
        out,
    )
    return out
