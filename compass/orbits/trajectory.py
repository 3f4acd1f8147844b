"""Trajectories: where satellites are, as one polynomial for each stretch of time.

However it came about (by forces, by a formula, from a table), a trajectory answers the same
questions: where at a time, from when to when, how far from the truth, and how fast at most.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike, NDArray

from compass.core.collocation import PASS_END, Arcs, collocate
from compass.core.path import path_states
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY, mcmf_from_mci, prime_meridian_angle
from compass.memory import check_fits
from compass.orbits.forces import ForceModel, Sky, sky_of
from compass.words import counted

#: Nodes of a step. With 16 a quarter of a revolution leaves out less than a micrometre.
NODES = 16

#: What the last terms of a step's series may measure, m: at 1e-6 the ends of steps are exact to
#: rounding, at `COARSE` they are not (60 m in a Mars year), for a third of the time. First step in
#: radians of the fastest satellite's turn.
TOLERANCE, COARSE, FIRST = 1e-6, 1e-3, 1.6

#: Moments of a stretch from which its distances are bounded, and where they lie in it.
LOOKS = 8
LOOKED = (2.0 * np.arange(LOOKS) + 1.0) / LOOKS - 1.0

#: Steps that a call of the kernel has room for, and seconds between two signs of life.
CHUNK, WINDOW = 256, 25.0 * SECONDS_PER_DAY


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Paths of n satellites in the Mars-centred inertial frame of an epoch.

    Attributes
    ----------
    breaks
        Ends of the stretches, increasing, seconds after the epoch, shape (p + 1,).
    paths
        Legendre coefficients of the position on each stretch, m, shape (p, n, 3, k).
    errors
        How far the polynomials may be from what they stand for, m, shape (p, n).
    epoch
        TDB seconds past J2000.
    satellite_names
        One a satellite.
    source
        What they stand for, in words.
    estimated
        How `errors` were estimated, in words, if they are no bound; empty otherwise.
    """

    breaks: NDArray[np.float64]
    paths: NDArray[np.float64]
    errors: NDArray[np.float64]
    epoch: float
    satellite_names: tuple[str, ...]
    source: str
    estimated: str = ""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Trajectory) and self._values == other._values

    def __hash__(self) -> int:
        return hash(self._values)

    @property
    def _values(self) -> tuple[object, ...]:
        arrays = (self.breaks, self.paths, self.errors)
        words = (self.satellite_names, self.source, self.estimated)
        return (self.epoch, *words, *(array.tobytes() for array in arrays))

    @property
    def size(self) -> int:
        """Number of satellites."""
        return int(self.paths.shape[1])

    @property
    def start(self) -> float:
        """First moment, seconds after the epoch."""
        return float(self.breaks[0])

    @property
    def stop(self) -> float:
        """Last moment, seconds after the epoch."""
        return float(self.breaks[-1])

    def only(self, *satellites: int) -> "Trajectory":
        """Return the paths of some satellites by their places."""
        chosen = list(satellites)
        return replace(
            self,
            paths=_frozen(np.ascontiguousarray(self.paths[:, chosen])),
            errors=_frozen(np.ascontiguousarray(self.errors[:, chosen])),
            satellite_names=tuple(self.satellite_names[k] for k in chosen),
        )

    def of(self, names: Sequence[str]) -> "Trajectory":
        """Return the paths of the satellites of these names.

        Raises
        ------
        ArgumentError
            One that is not among them.
        """
        if tuple(names) == self.satellite_names:
            return self
        places = {name: k for k, name in enumerate(self.satellite_names)}
        if unknown := [name for name in names if name not in places]:
            raise ArgumentError(
                f"satellites = {', '.join(unknown)}: {self.source} are of "
                f"{', '.join(self.satellite_names)}; name some of these"
            )
        return self.only(*(places[name] for name in names))

    def states(self, times: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Inertial positions (m) and velocities (m/s), shape (satellite, time, 3).

        Raises
        ------
        ArgumentError
            A time outside the span.
        """
        seconds = np.atleast_1d(np.asarray(times, dtype=float))
        slack = 1e-6
        if seconds.size and (
            seconds.min() < self.start - slack or seconds.max() > self.stop + slack
        ):
            wrong = seconds.min() if seconds.min() < self.start - slack else seconds.max()
            raise ArgumentError(
                f"time = {wrong / SECONDS_PER_DAY:.9g} days: the orbits are known from "
                f"{self.start / SECONDS_PER_DAY:.9g} to {self.stop / SECONDS_PER_DAY:.9g} days "
                "after the epoch; choose a time inside"
            )
        return path_states(self.breaks, self.paths, np.clip(seconds, self.start, self.stop))

    def positions_mcmf(self, times: ArrayLike) -> NDArray[np.float64]:
        """Mars-fixed positions, m, shape (satellite, time, 3)."""
        seconds = np.atleast_1d(np.asarray(times, dtype=float))
        angle = prime_meridian_angle(self.epoch, seconds)
        return mcmf_from_mci(self.states(seconds)[0], angle)

    def bounds(self, start: float, stop: float) -> NDArray[np.float64]:
        """Bounds over an interval: distance from below and above, speed, acceleration; (n, 4).

        Sums of the magnitudes of the Legendre coefficients of velocity and acceleration on every
        stretch that the interval meets, for no Legendre polynomial exceeds 1; the distance by
        those of speed from the nearest of `LOOKS` moments of each stretch. m, m/s and m/s^2.
        """
        first = int(np.searchsorted(self.breaks, start, side="right")) - 1
        last = int(np.searchsorted(self.breaks, stop, side="left"))
        first, last = max(first, 0), max(min(last, len(self.paths)), first + 1)
        bounds = np.full((self.size, 4), [np.inf, 0.0, 0.0, 0.0])
        for k in range(first, last):
            half = 0.5 * (self.breaks[k + 1] - self.breaks[k])
            path = np.moveaxis(self.paths[k], -1, 0)
            speed = np.linalg.norm(legendre.legder(path), axis=-1).sum(axis=0) / half
            pull = np.linalg.norm(legendre.legder(path, 2), axis=-1).sum(axis=0) / half**2
            away = np.linalg.norm(np.moveaxis(legendre.legval(LOOKED, path), -1, 0), axis=-1)
            reach = speed * half / LOOKS + self.errors[k]
            bounds[:, 0] = np.minimum(bounds[:, 0], away.min(axis=0) - reach)
            for column, bound in enumerate((away.max(axis=0) + reach, speed, pull), start=1):
                bounds[:, column] = np.maximum(bounds[:, column], bound)
        return bounds


@cache
def _rule() -> tuple[NDArray[np.float64], tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """``rule`` and ``light`` of `compass.core.collocation.collocate`."""
    nodes, weights = legendre.leggauss(NODES)
    values = legendre.legvander(nodes, NODES - 1)
    to_series = (np.arange(NODES) + 0.5)[:, None] * values.T * weights
    twice = legendre.legint(to_series, 2, lbnd=-1, axis=0)
    rule = np.concatenate([[nodes, weights, weights * (1.0 - nodes)], twice])
    project = np.zeros((NODES, NODES + 1))
    for k in range(NODES):
        project[k, : k + 2] = (k + 0.5) * legendre.legint(np.eye(NODES)[k], lbnd=0)[: k + 2]
    return np.ascontiguousarray(rule), (project, np.ascontiguousarray(values))


def integrate(
    r_mci: ArrayLike,
    v_mci: ArrayLike,
    forces: ForceModel,
    stop: float,
    *,
    epoch: float = 0.0,
    start: float = 0.0,
    sky: Sky | None = None,
    satellite_names: Sequence[str] = (),
    tolerance: float = TOLERANCE,
    progress: Callable[[Sequence[Any]], Any] = iter,
) -> Trajectory:
    """Follow satellites under forces from their states at `start` to `stop`.

    Gauss-Legendre collocation of order 32, its steps sized so that the polynomial leaves out less
    than `tolerance`. `Trajectory.errors` adds to that what unfinished sweeps and rounding can have
    grown to: a step's error in position d moves a satellite by up to ``6 n d t`` along its track
    t later (Clohessy and Wiltshire 1960), and all steps count as if they erred the same way. Where
    `tolerance` is above `TOLERANCE` the ends of steps count as off by all of it.

    Parameters
    ----------
    r_mci, v_mci
        States at `start`, m and m/s, shape (n, 3).
    forces
        What acts.
    stop, start
        Seconds after the epoch; `stop` may be earlier.
    epoch
        TDB seconds past J2000 of the frame.
    sky
        Where Sun, moons and meridian are; the program's own if left out.
    satellite_names
        One a satellite.
    tolerance
        Metres.
    progress
        Wraps the list of stretches of time, as tqdm does.

    Raises
    ------
    ArgumentError
        A satellite falls to Mars's centre, `stop` is `start`, or more steps than this machine has
        memory for.
    """
    if stop == start:
        raise ArgumentError("motion: a span of 0 days; give a longer one")
    states = np.concatenate(
        [np.atleast_2d(np.asarray(r_mci, float)), np.atleast_2d(np.asarray(v_mci, float))], axis=1
    )
    names = tuple(satellite_names) or tuple(f"S{k + 1:02d}" for k in range(len(states)))
    turn = (
        np.linalg.norm(np.cross(states[:, :3], states[:, 3:]), axis=1)
        / (np.linalg.norm(states[:, :3], axis=1) ** 2)
    ).max(initial=1e-9)
    wish, longest, time = FIRST / turn, 4.0 * FIRST / turn, start
    _check_memory(len(states), start, stop, wish)
    rule, light = _rule()
    tables = forces.tables(sky or sky_of(epoch, 0.5 * (start + stop)), start, stop)
    parts: list[tuple[NDArray[np.float64], ...]] = []
    count = max(int(np.ceil(abs(stop - start) / WINDOW)), 1)
    ends = np.linspace(start, stop, count + 1)[1:]
    for end in progress(list(ends)):
        while time != end:
            breaks = np.empty(CHUNK + 1)
            paths = np.empty((CHUNK, len(states), 3, NODES + 2))
            errors = np.empty((CHUNK, len(states)))
            arcs = Arcs(breaks, paths, errors)
            steps, time, wish = collocate(
                states, time, end, wish, longest, tolerance, rule, light, tables, arcs
            )
            if not steps:
                raise ArgumentError(
                    f"motion: the orbits cannot be followed past {time / SECONDS_PER_DAY:.6g} "
                    "days; a satellite falls to Mars; check its elements"
                )
            parts.append((breaks[: steps + 1], paths[:steps], errors[:steps]))
    breaks = np.concatenate([parts[0][0][:1], *(part[0][1:] for part in parts)])
    paths = np.concatenate([part[1] for part in parts])
    errors = np.concatenate([part[2] for part in parts])
    number = np.arange(1, len(errors) + 1)[:, None]
    unfinished = 1e-3 * PASS_END * np.linalg.norm(states[:, :3], axis=1)
    unfinished = unfinished + (tolerance if tolerance > TOLERANCE else 0.0)
    elapsed = np.abs(breaks[1:] - breaks[0])[:, None]
    errors = errors + unfinished * number * (4.0 + 3.0 * turn * elapsed)
    if stop < start:
        breaks, paths, errors = breaks[::-1], paths[::-1], errors[::-1]
        paths = paths * (-1.0) ** np.arange(NODES + 2)
    return Trajectory(
        _frozen(breaks),
        _frozen(paths),
        _frozen(errors),
        epoch,
        names,
        f"integrated: {forces.describe()}",
    )


def _frozen(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Contiguous read-only array."""
    array = np.ascontiguousarray(values)
    array.flags.writeable = False
    return array


def through(
    positions: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    start: float,
    stop: float,
    *,
    piece: float,
    epoch: float,
    satellite_names: Sequence[str],
    source: str,
    tolerance: float = TOLERANCE,
    progress: Callable[[Sequence[Any]], Any] = iter,
) -> Trajectory:
    """Trajectory through the positions that a formula gives.

    Each stretch takes the polynomial through the formula's positions at Gauss nodes; stretches are
    halved until on all of them its last two terms measure less than `tolerance` above what a
    phase's rounding makes of them, or little that no halving makes less. Their size, and that of
    the rounding, counts as error: what follows falls off at least as fast as from the one to the
    other.

    Parameters
    ----------
    positions
        Inertial positions, m, of seconds (t,), shape (n, t, 3).
    start, stop
        Seconds after the epoch.
    piece
        Length of stretch to begin with, s.
    epoch, satellite_names, source
        As in `Trajectory`.
    tolerance
        Metres.
    progress
        Wraps the list of windows of many stretches, as tqdm does.

    Raises
    ------
    ArgumentError
        More stretches than this machine has memory for.
    """
    _check_memory(len(satellite_names), start, stop, piece)
    count = max(int(np.ceil((stop - start) / (CHUNK * piece))), 1)
    edges = np.linspace(start, stop, count + 1)
    windows = progress(list(pairwise(edges.tolist())))
    parts = [_polynomials(positions, left, right, piece, tolerance) for left, right in windows]
    return Trajectory(
        _frozen(np.concatenate([[start], *(breaks[1:] for breaks, _, _ in parts)])),
        _frozen(np.concatenate([paths for _, paths, _ in parts])),
        _frozen(np.concatenate([errors for _, _, errors in parts])),
        epoch,
        tuple(satellite_names),
        source,
    )


def _polynomials(
    positions: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    start: float,
    stop: float,
    piece: float,
    tolerance: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Breaks, coefficients and errors of the stretches of a window, as `through` describes."""
    nodes, weights = legendre.leggauss(NODES + 2)
    values = legendre.legvander(nodes, NODES + 1)
    to_series = (np.arange(NODES + 2) + 0.5)[:, None] * values.T * weights
    count, before = max(int(np.ceil((stop - start) / piece)), 1), np.inf
    while True:
        breaks = np.linspace(start, stop, count + 1)
        middle, half = 0.5 * (breaks[1:] + breaks[:-1]), 0.5 * np.diff(breaks)
        times = middle[:, None] + half[:, None] * nodes
        r = positions(times.ravel())
        polynomials = np.einsum("kj,npjc->pnck", to_series, r.reshape(len(r), count, NODES + 2, 3))
        errors = np.abs(polynomials[..., -2:]).sum(axis=(-1, -2))
        # phases of 1e3 turns are good to 7e-13, which the last terms see tenfold
        turns = max(abs(start), abs(stop)) / (2.0 * np.pi * piece)
        rounding = 1e-11 * max(1.0, 1e-3 * turns) * np.abs(polynomials).sum(axis=(-1, -2))
        worst = float(np.max(errors - rounding, initial=0.0))
        # what is little and does not fall off as stretches do is rounding too
        little = worst < 1e-9 * float(np.abs(polynomials).max(initial=0.0))
        if worst <= tolerance or (little and worst > 0.25 * before):
            return breaks, polynomials, errors + rounding
        count, before = 2 * count, worst


def _check_memory(satellites: int, start: float, stop: float, stretch: float) -> None:
    """Refuse a span whose polynomials, held twice while they are joined, do not fit here."""
    needed = 2 * 8 * 3 * (NODES + 2) * satellites * abs(stop - start) / stretch
    days = abs(stop - start) / SECONDS_PER_DAY
    asked = f"days = {days:g}: the paths of {counted(satellites, 'satellite')}"
    check_fits(needed, asked, "ask for fewer")
