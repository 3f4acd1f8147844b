"""Ranges and link budgets."""

import numpy as np
import pytest

from compass.bodies import SPEED_OF_LIGHT
from compass.contacts.nodes import earth_node, satellite_nodes, station_node
from compass.contacts.radio import carrier_to_noise, free_space_loss, track
from compass.links import Radio
from compass.orbits import keplerian
from compass.sites import Site


def test_free_space_loss_is_the_engineers_formula():
    """32.45 dB + 20 log10(d/km) + 20 log10(f/MHz): ITU-R P.525-4, eq. 4, constant rounded there."""
    for km, mhz in ((384400.0, 2200.0), (35786.0, 6000.0), (1.0, 400.0)):
        expected = 32.45 + 20 * np.log10(km) + 20 * np.log10(mhz)
        assert free_space_loss(km * 1e3, mhz * 1e6) == pytest.approx(expected, abs=0.005)


def test_carrier_to_noise_adds_up():
    """20 dBW, 10 dB/K, 20 000 km at 8.4 GHz: 20 - 196.96 + 10 + 228.60 = 61.64 dB Hz."""
    radio = Radio(("station", "satellite"), 8.4e9, 20.0, 10.0, 30.0)
    assert carrier_to_noise(radio, 2e7) == pytest.approx(61.64, abs=0.01)
    assert carrier_to_noise(radio, 4e7) == pytest.approx(61.64 - 6.0206, abs=0.01)


def test_range_rate_is_the_rate_of_range():
    c = keplerian(1.2e7, 0.4, 1.0, 0.2, 0.3, 0.4)
    (satellite,) = satellite_nodes(c)
    duration, step = 30000.0, 0.5
    times = np.linspace(100.0, duration - 100, 40)
    for one in (station_node(Site("s", 0.3, 1.0), 0.0, duration), earth_node(0.0, duration)):
        path = track(one, satellite, times)
        ahead, behind = (track(one, satellite, times + s).distance for s in (step, -step))
        # central difference: a third of h^2 f'''/6 is below 1e-6 m/s; rounding 2e-5 m to the Earth
        np.testing.assert_allclose(
            path.range_rate, (ahead - behind) / (2 * step), rtol=0, atol=1e-3
        )
        np.testing.assert_allclose(path.light_time * SPEED_OF_LIGHT.value, path.distance)


def test_radios_serve_their_kinds():
    radio = Radio(("satellite", "station"), 1e9, 0.0, 0.0, 0.0)
    (satellite,) = satellite_nodes(keplerian(1e7, 0, 0, 0, 0, 0))
    station = station_node(Site("s", 0.0, 0.0), 0.0, 1.0)
    assert radio.serves(station.kind, satellite.kind)
    assert radio.serves(satellite.kind, station.kind)
    assert not radio.serves(satellite.kind, satellite.kind)
