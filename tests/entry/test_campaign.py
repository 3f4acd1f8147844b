from dataclasses import replace

import numpy as np
import pytest

from compass.entry.arrivals import Arrivals, draw_arrivals
from compass.entry.campaign import fly_campaign, vehicle_axes
from compass.entry.covariance import axes_covariance
from compass.entry.start import Trigger
from compass.entry.trajectory import fly
from compass.entry.views import spherical_of
from compass.errors import ArgumentError

TIMES = np.arange(0.0, 41.0, 2.0)


@pytest.fixture
def start(table5):
    return table5, axes_covariance(1000.0, 0.5)


def test_arrivals_are_even_and_reproducible():
    arrivals = draw_arrivals(1024, 3)
    again = draw_arrivals(1024, 3)
    assert np.array_equal(arrivals.latitude, again.latitude)
    assert not np.array_equal(arrivals.latitude, draw_arrivals(1024, 4).latitude)
    # a scrambled Sobol set of 2^10 puts the same number of points in each half of each axis
    assert (arrivals.latitude > 0).sum() == 512
    assert (arrivals.longitude > 0).sum() == 512
    assert (arrivals.azimuth > np.pi).sum() == 512
    assert (arrivals.phase < 0.25).sum() == 256
    # and equal area has the mean of sin^2(latitude) at 1/3
    assert np.mean(np.sin(arrivals.latitude) ** 2) == pytest.approx(1 / 3, abs=1e-3)


@pytest.mark.parametrize("count", [0, 10_000])
def test_number_of_samples_is_checked(count):
    with pytest.raises(ArgumentError, match=f"samples = {count}: allowed 1 to 8192"):
        draw_arrivals(count, 0)


def test_on_a_planet_at_rest_every_entry_is_the_same(world, start):
    """Wherever it goes: one of them over the pole."""
    state, covariance = start
    over = Arrivals(np.append(draw_arrivals(3, 0).latitude, np.radians(88.0)), *np.zeros((3, 4)))
    flown = fly_campaign(world("none"), state, covariance, TIMES, over)
    seen = spherical_of(flown.paths)
    assert np.degrees(seen[3, :, 2]).max() > 89.5 and abs(seen[3, -1, 5]) > 3  # and southwards
    inner = [0, 3, 4]
    assert seen[..., inner] == pytest.approx(
        np.broadcast_to(seen[0][:, inner], (4, TIMES.size, 3)), rel=1e-9
    )
    # errors too, in the vehicle's axes
    own = vehicle_axes(flown.paths) @ flown.gains
    spread = own @ np.swapaxes(own, -1, -2)
    scale = np.sqrt(np.einsum("mtii->mti", spread))
    correlation = spread / (scale[..., :, None] * scale[..., None, :])
    assert scale == pytest.approx(np.broadcast_to(scale[0], scale.shape), rel=1e-6)
    assert correlation == pytest.approx(
        np.broadcast_to(correlation[0], correlation.shape), abs=1e-6
    )
    assert scale[0, 0] == pytest.approx([1000] * 3 + [0.5] * 3)


def test_gains_are_derivatives_of_the_flight(world, start):
    """Central differences of flights with another integrator; their error is of second order."""
    state, covariance = start
    model = world("full")
    flown = fly_campaign(
        model, state, covariance, TIMES, draw_arrivals(1, 0), density_sigma=0.2, lift_sigma=0.1
    )
    assert flown.gains.shape == (1, TIMES.size, 6, 8)
    step = 1e-2
    for column in range(8):
        shift = step * flown.spreads[0, :, column]
        pair = []
        for sign in (1, -1):
            x = np.concatenate([flown.paths[0, 0], model.full_state(state)[6:]]) + sign * shift
            full = np.concatenate([spherical_of(x[:6]), x[6:]])
            pair.append(fly(model, full, TIMES[[0, -1]]).path[-1])
        difference = (pair[0] - pair[1]) / (2 * step)
        scale = np.abs(flown.gains[0, -1]).max(axis=1)
        assert np.abs(difference - flown.gains[0, -1, :, column]).max() <= 1e-4 * scale.max()
        assert difference[3:] == pytest.approx(
            flown.gains[0, -1, 3:, column], abs=1e-4 * scale[3:].max()
        )


def test_deployment_is_the_first_epoch_at_the_level(world, start):
    state, covariance = start
    arrivals = draw_arrivals(2, 0)
    for trigger, part, level in (
        (Trigger("low", "altitude", 100e3), slice(3), 3497.2e3),
        (Trigger("slow", "speed", 6020.0), slice(3, 6), 6020.0),
        (Trigger("soft", "mach", 6020.0 / 221.1188), slice(3, 6), 6020.0),
    ):
        flown = fly_campaign(world(), state, covariance, TIMES, arrivals, trigger=trigger)
        for m, stop in enumerate(flown.stops):
            watched = np.linalg.norm(flown.paths[m, :, part], axis=1)
            assert watched[stop] <= level * (1 + 1e-6)
            assert np.all(watched[:stop] > level)
            assert not flown.paths[m, stop + 1 :].any()
        assert trigger.name in flown.deployment


def test_flights_without_deployment_are_refused(world, start):
    state, covariance = start
    arrivals = draw_arrivals(1, 0)
    low = Trigger("low", "altitude", 10e3)
    with pytest.raises(ArgumentError, match="has not come by 40 s to deployment"):
        fly_campaign(world(), state, covariance, TIMES, arrivals, trigger=low)
    steep = state.copy()
    steep[4] = np.radians(-80)
    dense = replace(world(), vehicle=replace(world().vehicle, drag_area_per_mass=1e-6))
    with pytest.raises(ArgumentError, match=r"comes to the ground .* at \d+ s, before deployment"):
        fly_campaign(dense, steep, covariance, TIMES, arrivals)
    with pytest.raises(ArgumentError, match="evenly spaced from 0"):
        fly_campaign(world(), state, covariance, TIMES + 1, arrivals)
    with pytest.raises(ArgumentError, match="lift_sigma = -1: allowed 0 to 10"):
        fly_campaign(world(), state, covariance, TIMES, arrivals, lift_sigma=-1)
