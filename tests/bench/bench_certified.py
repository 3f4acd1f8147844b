"""A hundred random designs: shares between proven bounds against random points, and their time."""

from time import process_time

import numpy as np
import pytest

from compass.coverage.certified_share import certified_share
from compass.frames import FIGURES
from compass.orbits import walker_delta
from tests.coverage.test_certified_geometry import samples

SPHERE, POINTS, SPREADS = FIGURES["iau-sphere"], 8000, 5.0


def any_design(seed):
    """A pattern of 8 to 30 satellites from 1,500 km up, a mask and a limit."""
    generator = np.random.default_rng(seed)
    planes = int(generator.integers(2, 11))
    count = planes * int(generator.integers(-(-8 // planes), 30 // planes + 1))
    pattern = walker_delta(
        count,
        planes,
        int(generator.integers(0, planes)),
        inclination_deg=float(generator.uniform(15, 100)),
        altitude_km=float(generator.uniform(1500, 21600)),
    )
    mask, limit = float(np.radians(generator.uniform(0, 15))), float(generator.uniform(2, 20))
    return pattern, mask, limit


@pytest.mark.parametrize("first", range(0, 100, 10))
def test_random_points_lie_between_proven_bounds(first):
    """Width 2e-3, within a minute each but for one very low design in ten."""
    certified_share(any_design(0)[0], 6.0, budget_boxes=1)  # compiled before the clock runs
    times = []
    for seed in range(first, first + 10):
        pattern, mask, limit = any_design(seed)
        began = process_time()
        found = certified_share(
            pattern, limit, mask=mask, figure=SPHERE, width=2e-3, budget_s=120.0
        )
        times.append(process_time() - began)
        pdop = samples(pattern, SPHERE, mask, POINTS, seed)[1]
        share = float((pdop <= limit).mean())
        error = np.sqrt(max(share * (1 - share), 1 / POINTS) / POINTS)
        assert found.low - SPREADS * error <= share <= found.high + SPREADS * error, seed
        assert found.width <= 2e-3 or found.stopped == "time", seed
    print(f"median {np.median(times):.3f} s, longest {max(times):.2f} s")
    assert sum(time > 60.0 for time in times) <= 1
