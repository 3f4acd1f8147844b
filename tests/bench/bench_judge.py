"""Judged candidates a second, what their filter runs cost, how much of it is kernels.

Every candidate is another Walker pattern on one core, 128 entries each, as a study judges them.
"""

import time
from pathlib import Path

import numpy as np
import pytest

from compass.entry.beacons import orbiting_beacons
from compass.entry.schedule import in_view
from compass.entry.views import spherical_jacobian, spherical_of
from compass.frames import prime_meridian_angle
from compass.inputs import read_design
from compass.inputs.scenario import read_scenario
from compass.orbits import states_mci, walker_delta
from compass.papers.yu2018_filter import cramer_rao_bound
from compass.study import judge as module
from compass.study.judge import campaign_of, judge, judge_entries
from compass.study.judge_filter import judge_filter

DESIGNS = Path(__file__).parents[2] / "designs"
SAMPLES = 128


@pytest.fixture(scope="module")
def lander():
    scenario = read_scenario(DESIGNS / "landing.toml")
    campaign_of(scenario, SAMPLES)
    return scenario


@pytest.fixture(scope="module")
def seed():
    return read_design(DESIGNS / "compass-15-5-1.toml")


def candidates(count):
    angles = np.radians(np.linspace(30, 70, count))
    return [
        walker_delta(15, 5, 1, inclination_deg=np.degrees(float(i)), radius_km=20427)
        for i in angles
    ]


def test_judged_candidates_a_second(lander, seed, benchmark):
    place = {"figure": seed.figure, "mask": seed.mask}
    judge(candidates(1)[0], lander, samples=SAMPLES, **place)

    def study():
        for c in candidates(20):
            judge(c, lander, samples=SAMPLES, **place)

    benchmark(study)
    rate = 20 / benchmark.stats.stats.min
    print(f"\n{rate:.0f} judged candidates a second on one core, {SAMPLES} entries each")
    assert rate > 20


def test_filter_runs_of_a_design(lander, seed):
    """What a judged design costs with its 512 filter runs, and how much of that is filtering."""
    place = {"samples": SAMPLES, "figure": seed.figure, "mask": seed.mask, "threads": 1}
    c = seed.constellation
    judge_filter(c, lander, runs=64, **place)
    start = time.process_time()
    found = judge_filter(c, lander, runs=512, **place)
    spent = time.process_time() - start
    steps = 512 * campaign_of(lander, 64).stops.mean()
    print(f"\n512 filter runs of a design: {spent:.2f} s, {1e6 * spent / steps:.1f} us an epoch")
    assert found["runs"] == 512
    assert spent / steps < 25e-6


def test_share_of_time_outside_kernels(lander, seed, monkeypatch):
    place = {"figure": seed.figure, "mask": seed.mask}
    spent = []

    def timed(kernel):
        def call(*arguments):
            start = time.perf_counter()
            result = kernel(*arguments)
            spent.append(time.perf_counter() - start)
            return result

        return call

    judge(candidates(1)[0], lander, samples=SAMPLES, **place)
    for name in ("information", "bounds", "count_in_view", "states_mci"):
        monkeypatch.setattr(module, name, timed(getattr(module, name)))
    monkeypatch.setattr(np.linalg, "eigvalsh", timed(np.linalg.eigvalsh))
    start = time.perf_counter()
    for c in candidates(50):
        judge(c, lander, samples=SAMPLES, **place)
    share = 1 - sum(spent) / (time.perf_counter() - start)
    print(f"\noutside kernels and LAPACK: {100 * share:.1f} % of judging")
    assert share < 0.2


def test_against_the_recursion_with_losses(lander, seed):
    """The bound and all single losses at once, against the recursive bound for each alone."""
    campaign, c = campaign_of(lander, SAMPLES), seed.constellation
    place = {"figure": seed.figure, "mask": seed.mask}
    found = judge_entries(c, campaign, lander, **place)

    def recursive(m):
        times = campaign.times[: campaign.stops[m] + 1]
        states = spherical_of(campaign.paths[m, : times.size])
        r, v = states_mci(c, found.epochs[m] + times)
        angle = float(prime_meridian_angle(c.epoch, found.epochs[m]))
        beacons = orbiting_beacons(
            r, v, times, omega=lander.model.omega, angle=angle, planet_radius=0.0
        )
        seen = in_view(beacons, states, seed.figure.equatorial_radius)
        spread = np.linalg.solve(spherical_jacobian(campaign.paths[m, 0]), campaign.spreads[m, :6])
        for lost in range(-1, c.size):
            taken = seen & (np.arange(c.size) != lost)
            cramer_rao_bound(
                lander.model, states, beacons, taken, lander.measurements, spread @ spread.T
            )

    recursive(0)
    start = time.perf_counter()
    recursive(1)
    one = time.perf_counter() - start
    best = min(_time(lambda: judge_entries(c, campaign, lander, **place)) for _ in range(5))
    ratio = one * campaign.size / best
    print(f"\nbound and losses: {1e3 * best:.1f} ms, {ratio:.0f} times faster than one by one")
    assert ratio > 20


def _time(function):
    start = time.perf_counter()
    function()
    return time.perf_counter() - start
