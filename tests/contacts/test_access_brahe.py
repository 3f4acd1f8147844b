"""Windows of an Earth station against brahe's, the kernel given the Earth's rotation."""

import numpy as np
import pytest

from compass.contacts.nodes import Node
from compass.contacts.windows import windows
from compass.core.motion import ELLIPSE, SITE, WIDTH
from compass.frames import FIGURES
from compass.sites import Mask, Site

brahe = pytest.importorskip("brahe")

DAY = 86400.0


def pole_frame(epoch):
    """Rotation from ECI to the Earth-fixed frame at `epoch`."""
    return np.array(brahe.rotation_eci_to_ecef(epoch))


@pytest.mark.parametrize(
    ("elements", "mask_deg"),
    [
        ([6878e3, 0.001, 97.4, 15.0, 30.0, 45.0], 5.0),
        ([26560e3, 0.01, 55.0, 80.0, 10.0, 200.0], 10.0),
        ([26600e3, 0.7, 63.4, 200.0, 270.0, 10.0], 0.0),
    ],
)
def test_windows_are_brahes(elements, mask_deg):
    """In the frame of the Earth's crust at the start, which then turns about its own axis.

    Over a day that leaves out 0.1 arcseconds of precession: 3 m, or some milliseconds of a
    crossing; brahe refines to a millisecond. It takes the span's ends as edges, as here.
    """
    brahe.set_global_eop_provider_from_static_provider(brahe.StaticEOPProvider.from_zero())
    start = brahe.Epoch.from_datetime(2024, 1, 1, 0, 0, 0.0, 0.0, brahe.TimeSystem.UTC)
    propagator = brahe.KeplerianPropagator.from_keplerian(
        start, np.array(elements), brahe.AngleFormat.DEGREES, 60.0
    )
    lon, lat = 10.0, 50.0
    location = brahe.PointLocation(lon, lat, 100.0)
    theirs = brahe.location_accesses(
        location,
        propagator,
        start,
        start + DAY,
        brahe.ElevationConstraint(mask_deg),
        config=brahe.AccessSearchConfig(initial_time_step=10.0, time_tolerance=1e-4),
    )
    turn = pole_frame(start)
    quarter = pole_frame(start + DAY / 4) @ turn.T  # Earth-fixed: turns by minus the angle
    rate = (np.arctan2(quarter[0, 1], quarter[0, 0]) % (2 * np.pi)) / (DAY / 4)

    row = np.zeros(WIDTH)
    a, e, *angles = elements
    i, node, periapsis, anomaly = np.radians(angles)
    row[:8] = ELLIPSE, a, e, np.cos(i), np.sin(i), node, periapsis, anomaly
    row[10] = np.sqrt(brahe.GM_EARTH / a**3)
    row[11:] = turn.ravel()
    satellite = Node("satellite", "satellite", row, row[10] * 10, a * (1 - e))

    x, y, z = brahe.position_geodetic_to_ecef(
        np.array([lon, lat, 100.0]), brahe.AngleFormat.DEGREES
    )
    station_row = np.zeros(WIDTH)
    station_row[:6] = SITE, np.hypot(x, y), z, np.arctan2(y, x), *_up(lat)
    station_row[6:8] = DAY / 2, DAY / 2
    station_row[8:10] = rate * DAY / 2, rate * DAY / 2
    site = Site("station", 0.0, 0.0, mask=Mask.constant(np.radians(mask_deg)))
    station = Node("station", "station", station_row, rate, np.linalg.norm([x, y, z]), site=site)
    (ours,) = windows([(station, satellite)], DAY, figure=FIGURES["iau-sphere"])

    spans = np.array([[w.window_open - start, w.window_close - start] for w in theirs])
    assert len(spans) == ours.count > 1
    np.testing.assert_allclose(ours.spans, spans, atol=0.01)
    highest = [w.properties.elevation_max for w in theirs]
    # brahe's is the highest of samples; ours is never below it
    assert np.all(np.degrees(ours.max_elevation) >= np.array(highest) - 1e-3)


def _up(latitude_deg):
    return np.cos(np.radians(latitude_deg)), np.sin(np.radians(latitude_deg))
