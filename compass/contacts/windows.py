"""Windows: the spans of time in which two nodes see each other."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compass.bodies import SUN_RADIUS
from compass.contacts.nodes import Node, check_duration
from compass.core.events import find_windows
from compass.core.sight import ECLIPSE, ELEVATION, HORIZON, LIMB
from compass.cores import cores
from compass.errors import ArgumentError
from compass.frames import DEFAULT_FIGURE, Figure

Pair = tuple[Node, Node]

#: Metres. Mars's umbra reaches R d / (R_sun - R) = 1.01e9 m where Mars is nearest the Sun.
UMBRA_LENGTH = 1e9


@dataclass(frozen=True)
class Windows:
    """Spans of sight of one pair of nodes, in order, over ``0 <= t <= duration``.

    Attributes
    ----------
    first, second
        Names of the nodes.
    start, end
        Seconds after the epoch, shape (w,). A window open at 0 or at `duration` is cut there.
    culmination, max_elevation
        Time (s) and value (rad) of the highest elevation over the station, shape (w,); nan
        where no end is a station.
    duration
        Length of the span, seconds.
    """

    first: str
    second: str
    start: NDArray[np.float64]
    end: NDArray[np.float64]
    culmination: NDArray[np.float64]
    max_elevation: NDArray[np.float64]
    duration: float

    @property
    def count(self) -> int:
        """Number of windows."""
        return int(self.start.size)

    @property
    def length(self) -> NDArray[np.float64]:
        """Lengths of the windows, seconds, shape (w,)."""
        return self.end - self.start

    @property
    def spans(self) -> NDArray[np.float64]:
        """Starts and ends, seconds, shape (w, 2), for `compass.contacts.spans`."""
        return np.stack([self.start, self.end], axis=1)


def windows(
    pairs: Sequence[Pair],
    duration: float,
    *,
    figure: Figure = DEFAULT_FIGURE,
    atmosphere_height: float = 0.0,
    workers: int | None = None,
) -> list[Windows]:
    """Find the windows of each pair, by isolating the roots of a sight function.

    A station sees what stands above its mask. Two other nodes see each other past the limb of
    the figure, raised by `atmosphere_height`. Rise, set and culmination are good to 1 ms for the
    motion modelled; no window or gap longer than 1 ms is missed. A ray within 1 cm of limb or
    mask counts as in sight.

    Parameters
    ----------
    pairs
        Nodes to link; of two stations, and of the Sun, nothing can be asked here.
    duration
        Span from the epoch of the nodes, seconds, at most 1000 sols.
    figure
        Mars's figure for the limb.
    atmosphere_height
        How far above the figure a ray must pass, metres.
    workers
        Threads; the result does not depend on it.

    Raises
    ------
    ArgumentError
        The duration is out of range, a pair cannot be linked, or a node dips below the limb.
    """
    check_duration(duration)
    ordered = [_station_first(pair) for pair in pairs]
    equator = figure.equatorial_radius + atmosphere_height
    stretch = equator / (figure.polar_radius + atmosphere_height)
    masks: list[NDArray[np.float64]] = []
    kinds, numbers = [], np.zeros((len(ordered), 5))
    for k, (one, two) in enumerate(ordered):
        if one.kind == "station":
            kind, values = _over_mask(one, masks)
        else:
            for node in (one, two):
                _check_above(node, equator, atmosphere_height)
            kind, values = LIMB, (equator, stretch, max(one.lowest, two.lowest))
        kinds.append(kind)
        numbers[k, : len(values)] = values
    return _solve(ordered, kinds, numbers, masks, duration, workers)


def eclipses(
    satellites: Sequence[Node],
    sun: Node,
    duration: float,
    *,
    figure: Figure = DEFAULT_FIGURE,
    total: bool = False,
    workers: int | None = None,
) -> list[Windows]:
    """Spans in which each satellite stands in Mars's shadow.

    Parameters
    ----------
    satellites
        Satellites or moons.
    sun
        The Sun's node (`compass.contacts.nodes.sun_node`).
    duration
        Seconds.
    figure
        The shadow is that of the sphere of its equatorial radius.
    total
        Whether to count the umbra alone, where the Sun is wholly hidden; else the penumbra
        too.
    workers
        Threads.

    Raises
    ------
    ArgumentError
        The duration is out of range, or an orbit dips below the surface or leaves the umbra.
    """
    check_duration(duration)
    radius = figure.equatorial_radius
    for node in satellites:
        _check_above(node, radius, 0.0)
        if node.highest > UMBRA_LENGTH:
            raise ArgumentError(
                f"{node.name}: rises to {node.highest / 1e3:.6g} km, past the tip of Mars's umbra; "
                f"eclipses are found up to {UMBRA_LENGTH / 1e3:g} km"
            )
    numbers = np.zeros((len(satellites), 5))
    numbers[:, :3] = radius, SUN_RADIUS.value, 1.0 if total else -1.0
    pairs = [(node, sun) for node in satellites]
    lit = _solve(pairs, [ECLIPSE] * len(pairs), numbers, [], duration, workers)
    return [_complement(w) for w in lit]


def _complement(w: Windows) -> Windows:
    edges = np.concatenate([[0.0], w.spans.ravel(), [w.duration]]).reshape(-1, 2)
    edges = edges[edges[:, 1] > edges[:, 0]]
    nothing = np.full(len(edges), np.nan)
    return Windows(
        first=w.first,
        second=w.second,
        start=edges[:, 0],
        end=edges[:, 1],
        culmination=nothing,
        max_elevation=nothing,
        duration=w.duration,
    )


def _station_first(pair: Pair) -> Pair:
    one, two = pair
    if two.kind == "station":
        one, two = two, one
    if one is two or two.kind == "station" or "sun" in (one.kind, two.kind):
        raise ArgumentError(
            f"link {one.name} - {two.name}: {one.kind} to {two.kind} cannot be asked for; link a "
            "station, a satellite, a moon or the Earth with another, stations only with those"
        )
    return one, two


def _over_mask(station: Node, masks: list[NDArray[np.float64]]) -> tuple[int, tuple[float, ...]]:
    """Kind and parameters of sight above a station's mask; a profile is added to `masks`."""
    mask = station.mask
    if mask.is_constant:
        return ELEVATION, (float(np.sin(mask.lowest)),)
    azimuth, elevation = np.array(mask.azimuth), np.array(mask.elevation)
    run = np.diff(azimuth, append=azimuth[0] + 2 * np.pi)
    slope = np.abs(np.diff(elevation, append=elevation[0]) / run).max()
    first = sum(len(m) for m in masks)
    masks.append(np.stack([azimuth, elevation], axis=1))
    return HORIZON, (first, len(azimuth), float(slope), mask.lowest, mask.highest)


def _check_above(node: Node, radius: float, atmosphere_height: float) -> None:
    if node.lowest <= radius:
        raise ArgumentError(
            f"{node.name}: dips to {node.lowest / 1e3:.6g} km from Mars's centre, not above the "
            f"limb at {radius / 1e3:.6g} km (atmosphere_height_km = {atmosphere_height / 1e3:g}); "
            "raise the orbit or lower the atmosphere"
        )


def _solve(
    pairs: Sequence[Pair],
    kinds: Sequence[int],
    numbers: NDArray[np.float64],
    masks: Sequence[NDArray[np.float64]],
    duration: float,
    workers: int | None,
) -> list[Windows]:
    """Give each distinct node a number and run the kernel over blocks of pairs."""
    if not pairs:
        return []
    nodes = list({id(node): node for pair in pairs for node in pair}.values())
    index = {id(node): k for k, node in enumerate(nodes)}
    movers = np.array([node.row for node in nodes])
    first_row = 0
    for k, node in enumerate(nodes):
        if len(node.states):
            movers[k, 1] = first_row
            first_row += len(node.states)
    table = np.concatenate([np.zeros((0, 6)), *(node.states for node in nodes), np.zeros((1, 6))])
    profiles = np.concatenate([np.zeros((0, 2)), *masks, np.zeros((1, 2))])
    rates = np.array([node.rate for node in nodes])
    ends = np.array([[index[id(one)], index[id(two)]] for one, two in pairs])
    kind = np.array(kinds, dtype=np.int64)
    threads = workers or min(cores(), len(pairs))
    blocks = np.array_split(np.arange(len(pairs)), min(4 * threads, len(pairs)))

    def solve(block: NDArray[np.intp]) -> list[Windows]:
        counts, solved = find_windows(
            kind[block],
            ends[block, 0],
            ends[block, 1],
            numbers[block],
            movers,
            table,
            profiles,
            rates,
            0.0,
            duration,
        )
        parts = np.split(solved, np.cumsum(counts)[:-1])
        return [
            Windows(
                first=pairs[k][0].name,
                second=pairs[k][1].name,
                start=start,
                end=end,
                culmination=peak,
                max_elevation=highest,
                duration=duration,
            )
            for k, (start, end, peak, highest) in zip(
                block, (part.T.copy() for part in parts), strict=True
            )
        ]

    with ThreadPoolExecutor(threads) as pool:
        return [w for part in pool.map(solve, blocks) for w in part]
