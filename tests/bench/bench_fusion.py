"""Speed of the entry filters: one step, thousands of runs, and the ratio to plain NumPy."""

from time import perf_counter, process_time

import numpy as np
import pytest

from compass.core.papers.lou_measurement import predict_measurements
from compass.core.papers.spherical import rk4_step_transition
from compass.papers import lou2019_case as paper
from compass.papers.lou2019 import noiseless, step_seconds
from compass.papers.lou_montecarlo import monte_carlo

CASE = paper.case(noisy_truth=True)
#: Microseconds a step at most, on one core; the paper's MATLAB: 41 700, 19 000, 60 000.
LIMITS = {"ekf": 5.0, "dcifaif": 15.0, "ci": 80.0}


def numpy_ekf(z):
    """The centralised filter with NumPy's matrices (dynamics and slopes from the same kernels)."""
    _, s, belief = paper.recommended_filter("ekf").kernel_arguments(1.0)
    x, p = belief.x0.copy(), belief.p0.copy()
    q, r = np.diag(s.q), np.diag(np.concatenate([s.r_acc, s.r_range]))
    moved, phi, h, slopes = np.empty(8), np.empty((8, 8)), np.empty(7), np.empty((7, 8))
    for k in range(1, len(z)):
        rk4_step_transition(x, belief.p, 1.0, moved, phi)
        p = phi @ p @ phi.T + q
        predict_measurements(moved, 8, belief.p, False, CASE.beacons.r[k], h, slopes)
        gain = np.linalg.solve(slopes @ p @ slopes.T + r, slopes @ p).T
        rest = np.eye(8) - gain @ slopes
        x, p = moved + gain @ (z[k] - h), rest @ p @ rest.T + gain @ r @ gain.T
    return x


def numpy_dcifaif(z):
    """DCIFAIF with NumPy's matrices."""
    _, s, belief = paper.recommended_filter("dcifaif").kernel_arguments(1.0)
    x, p, w = belief.x0.copy(), belief.p0.copy(), np.full(4, 0.25)
    q, u = np.diag(s.q), s.scale
    moved, phi, h, slopes = np.empty(8), np.empty((8, 8)), np.empty(7), np.empty((7, 8))
    for k in range(1, len(z)):
        rk4_step_transition(x, belief.p, 1.0, moved, phi)
        shared = phi @ p @ phi.T
        predict_measurements(moved, 8, belief.p, False, CASE.beacons.r[k], h, slopes)
        states, ys = [], []
        for i in range(4):
            rows = [0, 1, 2, 3 + i]
            big_h, r = slopes[rows], np.diag([*s.r_acc, s.r_range[i]])
            own = shared / w[i] + q
            gain = np.linalg.solve(big_h @ own @ big_h.T + r, big_h @ own).T
            rest = np.eye(8) - gain @ big_h
            own = rest @ own @ rest.T + gain @ r @ gain.T
            states.append(moved + gain @ (z[k, rows] - h[rows]))
            ys.append(np.linalg.inv(own) * np.outer(u, u))
        y = np.array(ys)
        norm = [np.abs(one).sum(axis=1).max() for one in (*y, y.sum(axis=0), *(y.sum(axis=0) - y))]
        w = norm[4] - np.array(norm[5:]) + np.array(norm[:4])
        w = np.maximum(w / w.sum(), 1e-3)
        fused = np.linalg.inv(np.einsum("i,iab->ab", w, y))
        pull = np.einsum("i,iab,ib->a", w, y, (np.array(states) - states[0]) / u)
        x, p = states[0] + u * (fused @ pull), fused * np.outer(u, u)
    return x


TWINS = {"ekf": numpy_ekf, "dcifaif": numpy_dcifaif}


@pytest.mark.parametrize("algorithm", list(LIMITS))
def test_step(algorithm, benchmark):
    settings = paper.recommended_filter(algorithm)
    step_seconds(settings, CASE, 1)  # compiled
    seconds = benchmark.pedantic(step_seconds, (settings, CASE, 40), rounds=1)
    print(f"\n{algorithm}: {seconds * 1e6:.2f} microseconds a step")
    assert seconds * 1e6 <= LIMITS[algorithm]


@pytest.mark.parametrize("algorithm", list(TWINS))
def test_against_numpy(algorithm, benchmark):
    settings, z, twin = paper.recommended_filter(algorithm), noiseless(CASE), TWINS[algorithm]
    twin(z[:3])
    ours = step_seconds(settings, CASE, 40)
    theirs = np.inf
    for _ in range(3):
        begin = perf_counter()
        twin(z)
        theirs = min(theirs, (perf_counter() - begin) / (len(z) - 1))
    benchmark.pedantic(step_seconds, (settings, CASE, 1), rounds=1)
    print(f"\n{algorithm}: NumPy {theirs * 1e6:.1f} microseconds a step, ratio {theirs / ours:.1f}")
    # the twins share the compiled dynamics and slopes: this is the filter's algebra alone
    assert ours < theirs


@pytest.mark.parametrize(("algorithm", "seconds"), [("ekf", 4.0), ("dcifaif", 10.0)])
def test_five_thousand_runs(algorithm, seconds, benchmark):
    settings = paper.recommended_filter(algorithm)
    monte_carlo(CASE, settings, 2)
    begin = process_time()
    data = benchmark.pedantic(monte_carlo, (CASE, settings, 5000, 1), {"threads": 2}, rounds=1)
    took = (process_time() - begin) / 2  # of each of two cores, whatever else they do
    wall = benchmark.stats.stats.min
    print(f"\n{algorithm}: 5000 runs of 300 steps: {took:.1f} s of two cores, {wall:.1f} s in all")
    assert data.attrs["diverged"] == 0
    assert took <= 1.25 * seconds  # "about"
