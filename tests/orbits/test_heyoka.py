"""A second program: heyoka's Taylor integrator with its own gravity, Sun and light."""

import numpy as np
import pytest

from compass.bodies import ASTRONOMICAL_UNIT
from compass.frames import SECONDS_PER_DAY as DAY
from compass.orbits.forces import ForceModel, Sky
from compass.orbits.gravity import built_in_field
from compass.orbits.trajectory import integrate
from tests.reference import orbits as reference


@pytest.mark.slow
def test_heyoka_agrees_to_a_centimetre_over_a_hundred_days():
    """Gravity to degree 4, the Sun on a circle, its light, no moons; kilometres and days there."""
    hy = pytest.importorskip("heyoka")
    field = built_in_field().truncated(4)
    distance, rate, gm_sun = 1.52 * ASTRONOMICAL_UNIT.value, 2 * np.pi / (687 * DAY), 1.327e20

    def sun(t):
        angle = 1.0 + rate * np.asarray(t)
        return distance * np.stack(
            [np.cos(angle), 0.9 * np.sin(angle), 0.3 * np.sin(angle)], axis=-1
        )

    sky = Sky(reference.meridian, sun, np.zeros((0, 20)), (), gm_sun)
    r, v = np.array([12000e3, 0.0, 0.0]), np.array([0.0, 1300.0, 1500.0])
    forces = ForceModel(field, True, True, 0.026, "none")
    ours = integrate(r, v, forces, 100 * DAY, epoch=reference.EPOCH, sky=sky)

    # their units: 1000 km and hours, so that numbers are near one
    long, hour = 1e6, 3600.0
    x, y, z, u, w, q = hy.make_vars("x", "y", "z", "u", "w", "q")
    angle = (reference.MERIDIAN % (2 * np.pi)) + reference.SPIN * hour * hy.time
    c, s = hy.cos(angle), hy.sin(angle)
    turned = [c * x + s * y, c * y - s * x, z]
    pairs = [
        [field.c[n, m] if n > 1 else float(n == m == 0), field.s[n, m]]
        for n in range(5)
        for m in range(n + 1)
    ]
    pull = hy.model.sh_gravity_acc(turned, pairs, field.gm / long**3 * hour**2, field.radius / long)
    place = 1.0 + rate * hour * hy.time
    far = [distance / long * f for f in (hy.cos(place), 0.9 * hy.sin(place), 0.3 * hy.sin(place))]
    away = [x - far[0], y - far[1], z - far[2]]
    near3 = hy.sum([a * a for a in away]) ** -1.5
    far3 = hy.sum([a * a for a in far]) ** -1.5
    light = 0.026 * 1361.0 / 299792458.0 * ASTRONOMICAL_UNIT.value**2 / long**3 * hour**2
    mass = gm_sun / long**3 * hour**2
    inertial = [c * pull[0] - s * pull[1], s * pull[0] + c * pull[1], pull[2]]
    rates = [
        inertial[k] + (light - mass) * near3 * away[k] - mass * far3 * far[k] for k in range(3)
    ]
    theirs = hy.taylor_adaptive(
        list(zip((x, y, z, u, w, q), (u, w, q, *rates), strict=True)),
        [*(r / long), *(v / long * hour)],
        compact_mode=True,  # else it compiles for longer than it flies
    )
    for days in (1.0, 10.0, 100.0):
        theirs.propagate_until(days * DAY / hour)
        here = ours.states([days * DAY])[0][0, 0]
        assert np.linalg.norm(here - theirs.state[:3] * long) < 0.01
