"""Counts and dilution of precision, 1 degree x 15 satellites x 96 epochs, against NumPy twins.

Ratios are of the best times in one run, so that a noisy machine cannot favour either side.
"""

import resource
import subprocess
import sys
import time

import numpy as np
import pytest

from compass import walker_delta
from compass.coverage.count import count_map
from compass.coverage.grid import equal_angle_grid
from compass.coverage.maps import coverage_map
from compass.coverage.view import view
from compass.frames import direction

RADIUS, ORBIT, EPOCHS = 3396.2e3, 20427e3, 96


@pytest.fixture(scope="module")
def case():
    c = walker_delta(15, 5, 1, inclination_deg=45, radius_km=ORBIT / 1e3)
    grid = equal_angle_grid(np.radians(1.0))
    seen = view(c, np.arange(EPOCHS) * 88642.66 / EPOCHS, RADIUS)
    points = direction(grid.latitude[:, None], grid.longitude).reshape(-1, 3)
    return seen, grid, points


def best(function, times):
    def once():
        start = time.perf_counter()
        function()
        return time.perf_counter() - start

    return min(once() for _ in range(times))


def numpy_counts(seen, points):
    """Matrix product and compare, the best that NumPy does."""
    for u, cap in zip(seen.directions, seen.cos_cap, strict=True):
        (points @ u.T >= cap).sum(axis=1, dtype=np.int16)


def numpy_gdop(seen, points):
    """Normal matrices of all points at once, batched inverses."""
    for r, u, cap in zip(seen.r, seen.directions, seen.cos_cap, strict=True):
        visible = points @ u.T >= cap
        sights = r - points[:, None]
        sights /= np.linalg.norm(sights, axis=-1, keepdims=True)
        g = np.concatenate([sights, np.ones((*visible.shape, 1))], axis=-1) * visible[..., None]
        normal = np.swapaxes(g, 1, 2) @ g
        np.sqrt(np.trace(np.linalg.inv(normal + 1e-12 * np.eye(4)), axis1=1, axis2=2))


def report(benchmark, twin, name):
    ratio = twin / benchmark.stats.stats.min
    benchmark.extra_info["numpy_s"] = round(twin, 4)
    benchmark.extra_info["ratio"] = round(ratio, 1)
    print(f"\n{name}: numpy {twin:.4f} s, kernel {benchmark.stats.stats.min:.4f} s, x{ratio:.1f}")
    return ratio


def test_count(benchmark, case):
    seen, grid, points = case
    benchmark.pedantic(count_map, (seen, grid), rounds=15, warmup_rounds=2)
    assert report(benchmark, best(lambda: numpy_counts(seen, points), 5), "count") >= 10


def test_all_dilutions_of_precision_with_statistics(benchmark, case):
    """The whole map: five DOPs, percentiles, shares, gaps; against GDOP alone in NumPy."""
    seen, grid, points = case
    benchmark.pedantic(coverage_map, (seen, grid), rounds=5, warmup_rounds=1)
    report(benchmark, best(lambda: numpy_gdop(seen, points), 1), "map with five DOPs")


def test_gdop(benchmark, case):
    from concurrent.futures import ThreadPoolExecutor

    from compass.core.dop import dop_over_time

    seen, grid, points = case
    users = seen.rows(grid)

    def fill(rows):
        # a row at a time, as the map does: results stay in the cache
        counts = np.empty((EPOCHS, grid.columns), np.int16)
        dops = np.empty((EPOCHS, 5, grid.columns))
        for i in rows:
            dop_over_time(seen.r, seen.cos_cap, users[i], counts, dops)

    def whole():
        with ThreadPoolExecutor(2) as pool:
            list(pool.map(fill, np.array_split(np.arange(grid.rows), 12)))

    benchmark.pedantic(whole, rounds=9, warmup_rounds=1)
    ratio = report(benchmark, best(lambda: numpy_gdop(seen, points), 1), "five DOPs, no statistics")
    # 30 operations a line of sight, 80 a user and epoch
    cells = points.shape[0] * EPOCHS
    flops = cells * (30 * float(np.mean(1 - seen.cos_cap)) / 2 * seen.r.shape[1] + 80)
    print(f"about {flops / benchmark.stats.stats.min / 1e9:.1f} Gflop/s")
    assert ratio >= 100


def test_memory_at_a_quarter_degree(tmp_path):
    script = (
        "import sys; sys.argv = ['compass', 'map', 'designs/compass-15-5-1.toml', '--step-deg',"
        f" '0.25', '-o', '{tmp_path / 'm.nc'}']\nfrom compass.cli.main import main\nmain()"
    )
    subprocess.run([sys.executable, "-c", script], check=True, capture_output=True)
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    print(f"\npeak memory at 0.25 degree: {peak:.0f} MB")
    assert peak < 500
