"""Goals at sites and in regions, and entries that lead there: by flights written out."""

import numpy as np
import pytest

from compass.coverage.region import read_regions
from compass.entry.arrivals import Arrivals, draw_arrivals
from compass.entry.ground import MOST_POINTS, Ground, aimed
from compass.errors import ArgumentError
from compass.frames import direction, latitude_longitude

GALE = (-0.08, 2.4)
BENT = read_regions("polygon:0,170;0,-150;20,-160;40,-150;40,170")


def test_goals_are_taken_by_turns_and_spread_evenly():
    ground = Ground(
        ("Gale", "bent", "band"), (GALE, None, None), ((), BENT, read_regions("lat:0:30"))
    )
    goals = ground.draw(601, 3)
    assert np.all(goals.latitude[::3] == GALE[0]) and np.all(goals.longitude[::3] == GALE[1])
    points = direction(goals.latitude[1::3], goals.longitude[1::3])
    assert len(BENT) > 1 and np.all(np.any([part.contains(points) for part in BENT], axis=0))
    band = np.sin(goals.latitude[2::3])
    assert band.min() >= 0 and band.max() <= 0.5
    # as even as its area: a tenth of the sines in each tenth, to some of two hundred
    assert np.abs(np.histogram(band, 10, (0, 0.5))[0] - 20).max() <= 4
    drawn = draw_arrivals(601, 3)
    assert np.array_equal(goals.phase, drawn.phase) and np.array_equal(goals.azimuth, drawn.azimuth)
    again = ground.draw(601, 3)
    assert np.array_equal(goals.longitude, again.longitude)


def test_goals_outside_are_put_back():
    ground = Ground(("Gale", "band"), (GALE, None), ((), read_regions("lat:0:30")))
    tried = Arrivals(*np.array([[0.1, 0.9], [1.0, 2.0], [3.0, 4.0], [0.5, 0.6]]))
    kept = ground.kept(tried, Arrivals(*np.full((4, 2), 0.2)))
    assert kept.latitude.tolist() == [0.1, 0.2] and kept.longitude.tolist() == [1.0, 0.2]
    assert kept.azimuth.tolist() == [3.0, 4.0]


def test_a_region_that_no_point_meets_is_refused(monkeypatch):
    monkeypatch.setattr("compass.entry.ground.MOST_POINTS", 64)
    grain = read_regions("polygon:0,0;0,0.001;0.001,0")
    with pytest.raises(ArgumentError, match="region = grain: too small to land in; name a site"):
        Ground(("grain",), (None,), (grain,)).draw(4, 0)
    assert MOST_POINTS > 64


def test_entries_lead_to_their_goals_on_the_azimuth_wanted():
    """Flights along great circles, longer towards the north, on ground that turns below."""

    def end(entries):
        length = 0.18 + 0.01 * np.sin(entries.latitude)
        up = direction(entries.latitude, entries.longitude)
        east = np.cross([0.0, 0.0, 1.0], up)
        east /= np.linalg.norm(east, axis=1, keepdims=True)
        north = np.cross(up, east)
        ahead = np.sin(entries.azimuth)[:, None] * east + np.cos(entries.azimuth)[:, None] * north
        at = np.cos(length)[:, None] * up + np.sin(length)[:, None] * ahead
        on = np.cos(length)[:, None] * ahead - np.sin(length)[:, None] * up
        return at, on

    def fly(entries):
        latitude, longitude = latitude_longitude(end(entries)[0])
        return latitude, longitude - 0.01 * np.cos(entries.latitude)

    rng = np.random.default_rng(1)
    goals = Arrivals(
        rng.uniform(-1.5, 1.5, 50), rng.uniform(-3, 3, 50), *rng.uniform(0, 6, (2, 50))
    )
    entries = aimed(fly, goals)
    came = direction(*fly(entries))
    assert np.linalg.norm(came - direction(goals.latitude, goals.longitude), axis=1).max() < 1e-5
    at, on = end(entries)
    east = np.cross([0.0, 0.0, 1.0], at)
    north = np.cross(at, east)
    azimuth = np.arctan2((on * east).sum(axis=1), (on * north).sum(axis=1))
    off = np.angle(np.exp(1j * (azimuth - goals.azimuth)))
    assert np.median(np.abs(off)) < 0.02  # the ground's turn leans it by that
    assert np.array_equal(entries.phase, goals.phase)
