"""Speed of the window finder, against plain sampling of the same pairs in NumPy."""

import time

import numpy as np

from compass.bodies import SOLAR_DAY
from compass.contacts.nodes import satellite_nodes, station_node
from compass.contacts.windows import windows
from compass.frames import mcmf_from_mci, prime_meridian_angle
from compass.orbits import walker_delta
from compass.sites import Mask, Site

DURATION = 30 * SOLAR_DAY.value
STEP = 10.0
CONSTELLATION = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
SITES = [
    Site(f"S{k}", np.radians(lat), np.radians(lon), mask=Mask.constant(np.radians(5)))
    for k, (lat, lon) in enumerate([(90, 0), (45, 80), (0, 137), (-20, 250), (-60, 300)])
]


def find():
    stations = [station_node(site, 0.0, DURATION) for site in SITES]
    pairs = [(s, satellite) for s in stations for satellite in satellite_nodes(CONSTELLATION)]
    return windows(pairs, DURATION)


def sample():
    """Elevations every 10 s on circles, and where they cross the mask: good to 10 s only."""
    times = np.arange(0.0, DURATION, STEP)
    angle = prime_meridian_angle(0.0, times)
    c = CONSTELLATION
    counts = []
    for k in range(c.size):
        u = c.mean_anomaly[k] + c.mean_motion[k] * times
        x, y = np.cos(u), np.sin(u)
        cn, sn = np.cos(c.raan[k]), np.sin(c.raan[k])
        ci, si = np.cos(c.inclination[k]), np.sin(c.inclination[k])
        r = c.semi_major_axis[k] * np.stack([cn * x - sn * ci * y, sn * x + cn * ci * y, si * y], 1)
        fixed = mcmf_from_mci(r, angle)
        for site in SITES:
            seen = site.sees(fixed)
            counts.append(np.count_nonzero(seen[1:] & ~seen[:-1]) + seen[0])
    return counts


def test_windows_of_75_pairs_over_30_sols(benchmark):
    """15 satellites, 5 sites, 30 sols: well under a second, and far faster than sampling."""
    find()  # compile
    found = benchmark(find)
    begin = time.perf_counter()
    counts = sample()
    sampled = time.perf_counter() - begin
    ratio = sampled / benchmark.stats.stats.median
    print(f"\n{benchmark.stats.stats.median * 1e3:.1f} ms; sampling every 10 s: {ratio:.0f} times")
    in_order = np.array(counts).reshape(15, 5).T.ravel()
    assert sum(w.count for w in found) == in_order.sum()
    assert benchmark.stats.stats.median < 0.5
    assert ratio > 10
