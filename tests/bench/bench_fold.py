"""Exact fold against counts on a 1-degree grid, its growth with N, and the search.

Ratios are of the best times in one run, so that a noisy machine cannot favour either side.
"""

import time

import numpy as np
import pytest

from compass.core.count import count_rows
from compass.core.fold import Sides, extreme_fold
from compass.coverage.certificate import prove_fold
from compass.coverage.fold import caps_of
from compass.coverage.grid import equal_angle_grid
from compass.coverage.margin import covering_radius
from compass.coverage.share import mean_fold_shares
from compass.frames import FIGURES, direction
from compass.orbits import areosynchronous_radius, from_elements, walker_delta
from compass.study.search import search

R, ORBIT = 3396.2e3, 20427e3
SIZES = (15, 25, 50, 100, 200)


def best(function, times=30):
    def once():
        start = time.perf_counter()
        function()
        return time.perf_counter() - start

    function()
    return min(once() for _ in range(times))


def exact(size):
    """Exact least fold of a constellation at one epoch, as a call without arguments."""
    c = walker_delta(size, size // 5, 1, inclination_deg=55, radius_km=ORBIT / 1e3)
    u, radius = caps_of(c, R, 0.0, 100.0)
    cosines, nothing = np.cos(radius), Sides(np.empty((0, 3)), np.empty(0))
    return lambda: extreme_fold(u, cosines, nothing, True, True, -1)


@pytest.fixture(scope="module")
def grid():
    return equal_angle_grid(np.radians(1.0))


def test_exact_fold_against_the_count_kernel_at_one_epoch(grid):
    c = walker_delta(15, 3, 1, inclination_deg=55, radius_km=ORBIT / 1e3)
    u, radius = caps_of(c, R, 0.0, 100.0)
    cosines = np.cos(radius)
    out = np.empty((1, grid.latitude.size, grid.longitude.size), np.int16)
    rows = (np.sin(grid.latitude), np.cos(grid.latitude))
    columns = (np.cos(grid.longitude), np.sin(grid.longitude), float(grid.longitude[0]))
    points = direction(grid.latitude[:, None], grid.longitude).reshape(-1, 3)
    ours = best(exact(15), 200)
    kernel = best(lambda: count_rows(u[None], cosines[None], *rows, *columns, out))
    twin = best(lambda: (points @ u.T >= cosines).sum(axis=1).min(), 5)
    print(
        f"\nexact fold {1e6 * ours:.1f} us; 1-degree count kernel {1e6 * kernel:.1f} us "
        f"({kernel / ours:.1f}x); NumPy {1e6 * twin:.0f} us ({twin / ours:.0f}x)"
    )
    # and the grid never finds less than there is
    assert out.min() >= exact(15)()[0]
    assert kernel / ours >= 10


def test_cost_grows_no_faster_than_the_cube(tmp_path_factory):
    from compass.pictures.style import INK, MARS, look, new_figure

    seconds = np.array([best(exact(size), 10) for size in SIZES])
    order = np.polyfit(np.log(SIZES), np.log(seconds), 1)[0]
    print(
        "\n" + "; ".join(f"N = {n}: {1e6 * s:.0f} us" for n, s in zip(SIZES, seconds, strict=True))
    )
    figure = new_figure(6.0, 4.0)
    with look():
        axes = figure.add_subplot()
        axes.loglog(SIZES, 1e6 * seconds, "o-", color=MARS, label=f"measured, order {order:.2f}")
        cube = 1e6 * seconds[0] * (np.array(SIZES) / SIZES[0]) ** 3
        axes.loglog(SIZES, cube, "--", color=INK, label="$N^3$")
        axes.set(xlabel="satellites N", ylabel="time of one exact fold, us")
        axes.legend(frameon=False)
        axes.grid(True)
    path = tmp_path_factory.mktemp("bench") / "fold-growth.png"
    figure.savefig(path)
    print(f"order {order:.2f}; plot in {path}")
    assert order <= 3.0


def test_a_certificate_takes_milliseconds(benchmark):
    c = walker_delta(15, 5, 1, inclination_deg=45, radius_km=ORBIT / 1e3)
    found = benchmark(prove_fold, c, 4, sphere_radius=R, mask=np.radians(6.2))
    assert found.outcome == "proven"
    assert benchmark.stats.stats.min < 0.02


@pytest.mark.parametrize(("fold", "largest", "before_s"), [(1, 16, 7), (2, 16, 19), (4, 20, 30)])
def test_all_patterns_up_to_a_size(fold, largest, before_s):
    """A third of what they took on two cores before patterns were dropped by proven bounds."""
    asked = {"radius": areosynchronous_radius(), "figure": FIGURES["iau-sphere"]}
    search(fold, 0.0, largest=5, **asked)
    start = time.perf_counter()
    found = search(fold, 0.0, largest=largest, beyond=largest, **asked)
    seconds = time.perf_counter() - start
    print(
        f"\nall patterns to {largest} satellites, {fold}-fold: {seconds:.1f} s, {len(found)} cover"
    )
    assert seconds < before_s / 3


def test_proofs_of_120_satellites_within_a_second():
    """What took 6.8, 2.2 and, of six satellites at one place, 1.3 s, of processor time."""
    many = walker_delta(120, 10, 1, inclination_deg=55, radius_km=6000)
    six = from_elements(semi_major_axis_km=np.full(6, ORBIT / 1e3), inclination_deg=55)
    for name, asked in (
        ("shares of every fold, 120 satellites", lambda: mean_fold_shares(many, sphere_radius=R)),
        ("covering radius, 120 satellites", lambda: covering_radius(many, 4)),
        ("six satellites at one place", lambda: covering_radius(six, 4)),
    ):
        asked()
        start = time.process_time()
        asked()
        seconds = time.process_time() - start
        print(f"\n{name}: {seconds:.2f} s")
        assert seconds < 1.0
