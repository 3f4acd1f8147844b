"""Monte Carlo of a fused filter: many runs, their errors and whether the claims hold."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.fused_runs import Drawn, Outcome, fused_runs
from compass.core.entry.measure import AXES
from compass.cores import cores
from compass.document.numbers import significant
from compass.entry.consistency import LOST, nees_bounds
from compass.entry.faults import Fault
from compass.entry.fused import CLOCK, STATE_NAMES, STATE_UNITS, FusedFilter
from compass.entry.inertial import InertialCase
from compass.entry.views import along_cross_down, local_axes
from compass.errors import ArgumentError

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

#: Runs a thread does at a time. Sums are added block after block in the order of the runs, so
#: this number, not that of the threads, fixes the rounding.
BLOCK = 32
MOST_RUNS = 1_000_000
#: Messages of lost runs that are kept; all are counted.
MESSAGES = 20
#: Normal numbers a run draws for its start and for its truth an epoch, whatever its filter; those
#: of a clock, which is not shaken, are drawn last.
DRAWS, CLOCKS = CLOCK, len(STATE_NAMES) - CLOCK


def monte_carlo(
    case: InertialCase,
    settings: FusedFilter,
    runs: int,
    seed: int = 0,
    *,
    faults: Sequence[Fault] = (),
    see_through: bool = False,
    threads: int | None = None,
    progress: bool = False,
) -> "tuple[xr.Dataset, xr.Dataset]":
    """Fly, measure and filter a case many times.

    Run i draws from a stream of its own, the i-th child of `seed`, so results depend neither on
    the number of threads nor, run by run, on the number of runs or the filter. Only sums are kept,
    so memory does not grow with the runs.

    Parameters
    ----------
    case, settings
        The truth, and the filter.
    runs, seed
        How many, and of the random numbers.
    faults
        What goes wrong, in every run.
    see_through
        Let signals pass through the planet; see `InertialCase.truth`.
    threads
        Worker threads; as many as processors if None.
    progress
        Show a progress bar on a terminal's stderr.

    Returns
    -------
    statistics
        Over (time, state): `rmse`, `bias`, `sigma` (root of the mean variance the filter claims),
        `capture` (share of errors within 3 sigma); over time: `position_rmse` (m), `nees` with
        `nees_low` and `nees_high` at 95 %; over (time, beacon): `weight`; over (time, sensor):
        `arrival` and `refused`; `miss` and `miss_covariance` (east, north, up at the end) with
        the `claimed_covariance`. Runs that were lost, not finite or off by more than
        `compass.entry.consistency.LOST` of what they claim at the end, are left out and told in the
        attributes `diverged` and `divergences`.
    first
        Run 0 in full. Over (time, state): `error` and `sigma`; (time, beacon): `weight`; (time,
        sensor): `arrived` and `refused`; over time: `nees`. Nan once it is lost, told in the
        attribute `divergence`.

    Raises
    ------
    ArgumentError
        No runs, or too many.
    """
    from tqdm import tqdm

    if not 1 <= runs <= MOST_RUNS:
        raise ArgumentError(f"runs = {runs}: allowed 1 to {MOST_RUNS}")
    path = case.flight.path
    arrangement, known, p0 = settings.arrangement(), settings.problem(case), settings.covariance
    truth = case.truth(settings.layout, settings.offset(case), faults, see_through)
    axes = np.ascontiguousarray(along_cross_down(path))
    up = local_axes(path[-1, :3])
    sensors = AXES + case.beacons.size + len(case.instruments)

    def work(first: int) -> Outcome:
        count = min(BLOCK, runs - first)
        out = _outcome(count, case.times.size, case.beacons.size, sensors, settings.states)
        drawn = _drawn(case, settings, known.variances.shape, seed, first, count)
        fused_runs(
            arrangement, truth, known, p0, settings.kind.lost_is_zero, axes, drawn, out
        )  # fmt: skip
        return out

    sums: dict[str, Array] = {}
    lost: list[str] = []
    single: Outcome | None = None
    bar = tqdm(total=runs, unit="run", disable=None if progress else True, leave=False)
    with bar, ThreadPoolExecutor(cores(threads)) as pool:
        for first, out in zip(
            range(0, runs, BLOCK), pool.map(work, range(0, runs, BLOCK)), strict=True
        ):
            single = single or _chosen(out, np.arange(len(out.ends)) == 0)
            gone = _lost(out, settings.states)
            for k in np.flatnonzero(gone):
                lost.append(f"run {first + int(k)}: {_when(case, settings, out, int(k))}")
            for name, value in _sums(_chosen(out, ~gone), up, axes[-1]).items():
                sums[name] = sums[name] + value if name in sums else value
            bar.update(len(gone))
    assert single is not None
    said = _when(case, settings, single, 0) if _lost(single, settings.states)[0] else ""
    return (
        _statistics(case, settings, sums, runs, seed, lost),
        _first(case, settings, single, said),
    )


def _drawn(
    case: InertialCase,
    settings: FusedFilter,
    shape: tuple[int, ...],
    seed: int,
    first: int,
    count: int,
) -> Drawn:
    """What `count` runs have by chance, measurements of the shape (t, n, c)."""
    epochs, n, c = shape
    others = n if case.instruments else n - 1
    rows = AXES + others * (c - AXES)
    starts, draws, noises, uniforms = _draws(seed, first, count, (epochs, rows), case.beacons.size)
    shaken = np.concatenate([draws, np.zeros((*draws.shape[:2], CLOCKS))], axis=2)
    measured = np.zeros((count, *shape))
    measured[:, :, :others, :-AXES] = noises[..., AXES:].reshape(count, epochs, others, c - AXES)
    measured[:, :, -1, -AXES:] = noises[..., :AXES]
    return Drawn(
        settings.starts(starts), shaken[..., settings.numbers], measured, uniforms,
        starts[:, 6:8] * np.array(settings.known_to),
    )  # fmt: skip


def _draws(
    seed: int, first: int, count: int, shape: tuple[int, ...], m: int
) -> tuple[Array, Array, Array, Array]:
    """Numbers of `count` runs, each from its own stream: start, truth, noise, arrivals."""
    epochs, rows = shape
    normals, clocks = np.empty((count, DRAWS + epochs * (DRAWS + rows))), np.empty((count, CLOCKS))
    uniforms = np.empty((count, epochs, m))
    for k in range(count):
        stream = np.random.SeedSequence(seed, spawn_key=(first + k,))
        generator = np.random.Generator(np.random.PCG64DXSM(stream))
        generator.standard_normal(out=normals[k])
        generator.random(out=uniforms[k])
        generator.standard_normal(out=clocks[k])
    starts = np.concatenate([normals[:, :DRAWS], clocks], axis=1)
    later = normals[:, DRAWS:].reshape(count, epochs, DRAWS + rows)
    return starts, later[..., :DRAWS], later[..., DRAWS:].copy(), uniforms


def _outcome(runs: int, epochs: int, m: int, sensors: int, states: int) -> Outcome:
    over = (runs, epochs)
    return Outcome(
        np.empty(runs, dtype=np.int64),
        np.zeros((*over, states)),
        np.zeros((*over, states)),
        np.zeros(over),
        np.zeros((*over, m)),
        np.zeros((*over, sensors), dtype=bool),
        np.zeros((*over, sensors), dtype=bool),
        np.zeros((runs, 3, 3)),
    )


def _chosen(out: Outcome, runs: NDArray[np.bool_]) -> Outcome:
    """Some of the runs."""
    parts: list[Any] = [part[runs] for part in out]
    return Outcome(*parts)


def _lost(out: Outcome, states: int) -> NDArray[np.bool_]:
    """Which runs were lost, shape (runs,)."""
    return np.asarray((out.ends >= 0) | (out.squares[:, -1] > states * LOST**2))


def _when(case: InertialCase, settings: FusedFilter, out: Outcome, k: int) -> str:
    """Say how run k was lost."""
    if out.ends[k] >= 0:
        return f"{settings.algorithm}: diverged at {case.times[out.ends[k]]:g} s"
    times = significant(float(np.sqrt(out.squares[k, -1] / settings.states)), 3)
    return f"{settings.algorithm}: its error at the end is {times} times what it claims"


def _sums(out: Outcome, up: Array, last: Array) -> dict[str, Array]:
    """Sums over runs of everything the statistics need."""
    e, v = out.errors, out.variances
    # rows of `last` are along track, cross track, down: from them to east, north, up
    miss = e[:, -1, :3] @ last @ up.T
    return {
        "runs": np.array(float(len(e))),
        "error": e.sum(axis=0),
        "square": (e**2).sum(axis=0),
        "variance": v.sum(axis=0),
        "captured": (e**2 <= 9 * v).sum(axis=0).astype(float),
        "nees": out.squares.sum(axis=0),
        "weight": out.weights.sum(axis=0),
        "arrived": out.arrived.sum(axis=0).astype(float),
        "gated": out.gated.sum(axis=0).astype(float),
        "miss": miss.sum(axis=0),
        "spread": miss.T @ miss,
        "claimed": up @ out.last.sum(axis=0) @ up.T,
    }


def _statistics(
    case: InertialCase,
    settings: FusedFilter,
    sums: dict[str, Array],
    runs: int,
    seed: int,
    lost: list[str],
) -> "xr.Dataset":
    import xarray as xr

    kept = int(sums.pop("runs"))
    count = max(kept, 1)
    # nothing is known where no run survived
    mean = {
        name: value / kept if kept else np.full_like(value, np.nan) for name, value in sums.items()
    }
    low, high = nees_bounds(settings.states, count)
    by_state, by_beacon, by_sensor = ("time", "state"), ("time", "beacon"), ("time", "sensor")
    axes = ("direction", "direction_2")

    def named(long_name: str, units: str = "") -> dict[str, str]:
        return {"long_name": long_name, **({"units": units} if units else {})}

    spread = (mean["spread"] - np.outer(mean["miss"], mean["miss"])) * count / max(count - 1, 1)
    position = np.sqrt(mean["square"][:, :3].sum(axis=1))
    return xr.Dataset(
        {
            "rmse": (by_state, np.sqrt(mean["square"]), named("RMSE")),
            "bias": (by_state, mean["error"], named("mean error")),
            "sigma": (by_state, np.sqrt(mean["variance"]), named("1 sigma claimed")),
            "capture": (by_state, mean["captured"], named("share of errors within 3 sigma", "1")),
            "position_rmse": ("time", position, named("position RMSE", "m")),
            "nees": ("time", mean["nees"], named("mean NEES", "1")),
            "weight": (by_beacon, mean["weight"], named("mean fusion weight", "1")),
            "arrival": (by_sensor, mean["arrived"], named("share of arrivals", "1")),
            "refused": (by_sensor, mean["gated"], named("share refused by the gate", "1")),
            "miss": ("direction", mean["miss"], named("mean error at the end", "m")),
            "miss_covariance": (axes, spread, named("covariance of errors at the end", "m2")),
            "claimed_covariance": (axes, mean["claimed"], named("mean covariance claimed", "m2")),
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
            "diverged": len(lost),
            "divergences": lost[:MESSAGES],
            "nees_low": low,
            "nees_high": high,
        },
    )


def _first(case: InertialCase, settings: FusedFilter, out: Outcome, message: str) -> "xr.Dataset":
    import xarray as xr

    end = int(out.ends[0])
    gone = slice(end, None) if end >= 0 else slice(0, 0)
    error, sigma, weight, nees = (
        part[0].copy() for part in (out.errors, np.sqrt(out.variances), out.weights, out.squares)
    )
    for part in (error, sigma, weight, nees):
        part[gone] = np.nan
    return xr.Dataset(
        {
            "error": (("time", "state"), error),
            "sigma": (("time", "state"), sigma),
            "weight": (("time", "beacon"), weight),
            "arrived": (("time", "sensor"), out.arrived[0]),
            "refused": (("time", "sensor"), out.gated[0]),
            "nees": ("time", nees),
        },
        coords=_coordinates(case, settings),
        attrs={"algorithm": settings.algorithm, "divergence": message},
    )


def _coordinates(case: InertialCase, settings: FusedFilter) -> dict[str, object]:
    """Time, states with their units, beacons and sensors."""
    own = settings.numbers
    return {
        "time": ("time", case.times, {"units": "s", "long_name": "time after entry"}),
        "state": [STATE_NAMES[k] for k in own],
        "unit": ("state", [STATE_UNITS[k] for k in own]),
        "beacon": list(case.beacons.names),
        "sensor": ["drag", "side", "lift", *case.beacons.names, *case.instruments],
    }
