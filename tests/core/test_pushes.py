"""What a satellite gains a unit of a force that is not known, from its place alone."""

import numpy as np
import pytest

from compass.core.forces import CONE, CYLINDER, NO_SHADOW
from compass.core.pushes import pushes

MARS, SUN, GM, SUNLIGHT = 3.4e6, 7e8, 4.28e13, 1e15


@pytest.mark.parametrize("shadow", [NO_SHADOW, CYLINDER, CONE])
def test_sunlight_pushes_away_from_the_sun_and_not_in_the_shadow(shadow):
    """Before Mars, beside it, behind its middle: SUNLIGHT / d^2 away from the Sun, or nothing."""
    sun = np.array([2.2e11, 0.0, 0.0])
    places = np.array([[2e7, 0.0, 1e6], [0.0, 2e7, 1e6], [-2e7, 1e5, 1e5]])
    out, terms = np.empty((3, 1, 3, 2)), np.empty((0, 1, 4))
    pushes(
        places[:, None], sun[None], np.zeros(1), SUNLIGHT, shadow, np.array([MARS, SUN]), terms, 3,
        MARS, GM, out,
    )  # fmt: skip
    away, lit = places - sun, np.array([1.0, 1.0, float(shadow == NO_SHADOW)])
    expected = SUNLIGHT * lit[:, None] * away / np.linalg.norm(away, axis=1, keepdims=True) ** 3
    assert out[:, 0, :, 0] == pytest.approx(expected, rel=1e-12, abs=1e-25)
    pull = -GM * places / np.linalg.norm(places, axis=1, keepdims=True) ** 3
    assert out[:, 0, :, 1] == pytest.approx(pull, rel=1e-12)
