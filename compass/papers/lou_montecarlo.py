"""Monte Carlo of a navigation case: many runs, their errors and whether the claims hold."""

from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from compass.core.papers.lou_measurement import ACCELERATIONS
from compass.core.papers.lou_montecarlo import (
    START_DRAWS,
    TRUTH_STATES,
    Tally,
    make_trace,
    run_block,
)
from compass.cores import cores
from compass.entry.consistency import nees_bounds
from compass.entry.faults import Fault
from compass.errors import ArgumentError
from compass.papers.lou_case import NavigationCase
from compass.papers.lou_filters import STATE_NAMES, STATE_UNITS, FilterSettings, divergence_message

if TYPE_CHECKING:
    import xarray as xr

#: Runs a thread does at a time. Statistics are merged block after block in the order of the runs,
#: so this number, not that of the threads, fixes the rounding.
BLOCK = 32
MOST_RUNS = 10_000_000
#: Divergence messages that are kept; all are counted.
MESSAGES = 20


@dataclass(frozen=True)
class _Block:
    tally: Tally
    ends: NDArray[np.int64]
    last: NDArray[np.float64]
    first_run: int


def monte_carlo(
    case: NavigationCase,
    settings: FilterSettings,
    runs: int,
    seed: int = 0,
    *,
    faults: Sequence[Fault] = (),
    see_through: bool = False,
    threads: int | None = None,
    progress: bool = False,
) -> "xr.Dataset":
    """Fly, measure and filter a case many times.

    Run i draws from a stream of its own, the i-th child of `seed`, so results depend neither on
    the number of threads nor, run by run, on the number of runs or the filter. Only statistics
    are kept (Welford's recurrences, merged by Chan's), so memory does not grow with the runs.

    Parameters
    ----------
    case, settings
        The truth, and the filter.
    runs
        How many.
    seed
        Of the random numbers.
    faults
        What goes wrong, in every run.
    see_through
        Let ranges pass through the planet; see `NavigationCase.world`.
    threads
        Worker threads; as many as processors if None.
    progress
        Show a progress bar on a terminal's stderr.

    Returns
    -------
    xarray.Dataset
        Over (time, state): `rmse`, `bias`, `sigma` (root of the mean variance the filter claims),
        `capture` (share of errors within 3 sigma); over time: `position_rmse` (m), `nees` with
        `nees_low` and `nees_high` at 95 %; over (time, beacon): `weight`; over (time, sensor):
        `arrival` and `refused`; `miss` and `miss_covariance` (east, north, up at the end) with
        the `claimed_covariance`. Runs that diverged are left out and told in the attributes
        `diverged` and `divergences`.

    Raises
    ------
    ArgumentError
        No runs, or settings that do not fit the case.
    """
    from tqdm import tqdm

    if not 1 <= runs <= MOST_RUNS:
        raise ArgumentError(f"runs = {runs}: allowed 1 to {MOST_RUNS}")
    m = case.beacons.size
    if np.size(settings.range_variance) != m:
        raise ArgumentError(
            f"range_variance: {np.size(settings.range_variance)} values for {m} beacons; "
            "give one each"
        )
    algorithm, kernel_settings, belief = settings.kernel_arguments(case.step)
    world = case.world(faults, see_through)
    total = _empty_tally(len(case.times), settings.states, m)
    messages: list[str] = []
    diverged = 0

    def do_block(first: int) -> _Block:
        count = min(BLOCK, runs - first)
        normals, uniforms = _draws(seed, first, count, len(case.times) - 1, m)
        tally = _empty_tally(len(case.times), settings.states, m)
        ends, last = np.empty(count, np.int64), np.zeros((count, belief.x0.size))
        trace = make_trace(settings.states, belief.x0.size, len(case.times), m)
        run_block(
            algorithm, kernel_settings, world, belief, normals, uniforms, trace, tally, ends, last
        )
        return _Block(tally, ends, last, first)

    workers = cores(threads)
    bar = tqdm(total=runs, unit="run", disable=None if progress else True, leave=False)
    with bar, ThreadPoolExecutor(workers) as pool:
        for block in _in_order(pool, do_block, range(0, runs, BLOCK), 2 * workers):
            total = merged(total, block.tally)
            for index in np.flatnonzero(block.ends >= 0):
                diverged += 1
                if len(messages) < MESSAGES:
                    time = float(block.ends[index]) * case.step
                    said = divergence_message(settings, time, block.last[index])
                    messages.append(f"run {block.first_run + int(index)}: {said}")
            bar.update(block.ends.size)
    return _dataset(case, settings, total, runs, seed, diverged, messages)


def _in_order(pool: ThreadPoolExecutor, work: object, items: range, ahead: int) -> Iterator[_Block]:
    """Yield results in the order of the items, with at most `ahead` of them under way."""
    waiting: deque[Future[_Block]] = deque()
    remaining = iter(items)
    for item in islice(remaining, ahead):
        waiting.append(pool.submit(work, item))  # type: ignore[arg-type]
    while waiting:
        result = waiting.popleft().result()
        for item in islice(remaining, 1):
            waiting.append(pool.submit(work, item))  # type: ignore[arg-type]
        yield result


def _draws(
    seed: int, first: int, count: int, steps: int, m: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Draw normal and uniform numbers of `count` runs, each from its own child of the seed."""
    normals = np.empty((count, START_DRAWS + steps * (TRUTH_STATES + ACCELERATIONS + m)))
    uniforms = np.empty((count, steps * m))
    for i in range(count):
        stream = np.random.SeedSequence(seed, spawn_key=(first + i,))
        generator = np.random.Generator(np.random.PCG64DXSM(stream))
        generator.standard_normal(out=normals[i])
        generator.random(out=uniforms[i])
    return normals, uniforms


def _empty_tally(epochs: int, n: int, m: int) -> Tally:
    rows = ACCELERATIONS + m
    shapes = [
        (1,),
        (epochs, n),
        (epochs, n),
        (epochs, n),
        (epochs, n),
        (epochs,),
        (epochs, 2),
        (epochs, m),
        (epochs, rows),
        (epochs, rows),
        (4, 3),
        (3, 3),
    ]
    return Tally(*(np.zeros(shape) for shape in shapes))


def merged(a: Tally, b: Tally) -> Tally:
    """Statistics of two sets of runs together.

    Means are weighed by their runs, second moments by
    ``M2 = M2_a + M2_b + delta^2 n_a n_b / (n_a + n_b)`` (Chan, Golub and LeVeque 1983).
    """
    n_a, n_b = float(a.runs[0]), float(b.runs[0])
    if n_b == 0:
        return a
    share, cross = n_b / (n_a + n_b), n_a * n_b / (n_a + n_b)
    delta_miss = b.miss[0] - a.miss[0]

    def mean(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        return x + share * (y - x)

    nees_delta = b.nees[:, 0] - a.nees[:, 0]
    nees = np.stack(
        [
            mean(a.nees[:, 0], b.nees[:, 0]),
            a.nees[:, 1] + b.nees[:, 1] + cross * nees_delta**2,
        ],
        axis=-1,
    )
    spread = a.miss[1:] + b.miss[1:] + cross * np.outer(delta_miss, delta_miss)
    return Tally(
        runs=a.runs + b.runs,
        mean=mean(a.mean, b.mean),
        m2=a.m2 + b.m2 + cross * (b.mean - a.mean) ** 2,
        variance=mean(a.variance, b.variance),
        captured=mean(a.captured, b.captured),
        position=mean(a.position, b.position),
        nees=nees,
        weights=mean(a.weights, b.weights),
        arrivals=mean(a.arrivals, b.arrivals),
        gated=mean(a.gated, b.gated),
        miss=np.concatenate([mean(a.miss[0], b.miss[0])[None], spread]),
        claimed=mean(a.claimed, b.claimed),
    )


def _dataset(
    case: NavigationCase,
    settings: FilterSettings,
    tally: Tally,
    runs: int,
    seed: int,
    diverged: int,
    messages: list[str],
) -> "xr.Dataset":
    import xarray as xr

    n, kept = settings.states, int(tally.runs[0])
    if not kept:
        lost = np.full_like  # nothing is known where no run survived
        tally = Tally(*(lost(part, np.nan) for part in tally))
    count = max(kept, 1)
    low, high = nees_bounds(n, count)
    by_state, by_beacon, by_sensor = ("time", "state"), ("time", "beacon"), ("time", "sensor")
    axes = ("direction", "direction_2")

    def named(long_name: str, units: str = "") -> dict[str, str]:
        return {"long_name": long_name, **({"units": units} if units else {})}

    spread = tally.miss[1:] / max(count - 1, 1)
    return xr.Dataset(
        {
            "rmse": (by_state, np.sqrt(tally.mean**2 + tally.m2 / count), named("RMSE")),
            "bias": (by_state, tally.mean, named("mean error")),
            "sigma": (by_state, np.sqrt(tally.variance), named("1 sigma claimed")),
            "capture": (by_state, tally.captured, named("share of errors within 3 sigma", "1")),
            "position_rmse": ("time", np.sqrt(tally.position), named("position RMSE", "m")),
            "nees": ("time", tally.nees[:, 0], named("mean NEES", "1")),
            "weight": (by_beacon, tally.weights, named("mean fusion weight", "1")),
            "arrival": (by_sensor, tally.arrivals, named("share of arrivals", "1")),
            "refused": (by_sensor, tally.gated, named("share refused by the gate", "1")),
            "miss": ("direction", tally.miss[0], named("mean error at the end", "m")),
            "miss_covariance": (axes, spread, named("covariance of errors at the end", "m2")),
            "claimed_covariance": (axes, tally.claimed, named("mean covariance claimed", "m2")),
        },
        coords={
            **_coordinates(case, settings),
            "direction": ["east", "north", "up"],
            "direction_2": ["east", "north", "up"],
        },
        attrs={
            "case": case.name,
            "algorithm": settings.algorithm,
            "weighting": settings.chosen_weighting,
            "runs": runs,
            "seed": seed,
            "diverged": diverged,
            "divergences": messages,
            "nees_low": low,
            "nees_high": high,
        },
    )


def _coordinates(case: NavigationCase, settings: FilterSettings) -> dict[str, object]:
    """Time, states with their units, beacons and sensors."""
    n = settings.states
    names = list(STATE_NAMES[:n])
    units = list(STATE_UNITS[:n])
    if settings.published_linear_density:
        names[6], units[6] = "rho0", "kg/m^3"
    return {
        "time": ("time", case.times, {"units": "s", "long_name": "time after entry"}),
        "state": names,
        "unit": ("state", units),
        "beacon": list(case.beacons.names),
        "sensor": ["drag", "side", "lift", *case.beacons.names],
    }
