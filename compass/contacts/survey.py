"""All access questions about a constellation at once: who links with whom, and what it comes to."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, product

from compass.bodies import SOLAR_DAY
from compass.contacts.nodes import (
    DriftModel,
    Node,
    check_duration,
    earth_node,
    moon_node,
    path_nodes,
    satellite_nodes,
    station_node,
)
from compass.contacts.windows import Windows, windows
from compass.errors import ArgumentError
from compass.frames import DEFAULT_FIGURE, Figure
from compass.links import Wanted
from compass.moons import MoonModel
from compass.orbits.constellation import Constellation
from compass.orbits.trajectory import Trajectory
from compass.sites import Site

#: Pairs at most: beyond it memory, not time, would run out.
MAX_PAIRS = 100_000


_NOTHING_MORE = Wanted()


@dataclass(frozen=True)
class Survey:
    """Windows of all pairs of a network.

    Attributes
    ----------
    nodes
        The network's nodes.
    windows
        One a pair, in the order stations, moons, Earth, crosslinks.
    duration
        Seconds.
    epoch
        Time 0, TDB seconds past J2000.
    """

    nodes: tuple[Node, ...]
    windows: tuple[Windows, ...]
    duration: float
    epoch: float = 0.0

    @property
    def sols(self) -> float:
        """Length of the span in mean solar days of Mars."""
        return self.duration / SOLAR_DAY.value

    def names(self, kind: str) -> list[str]:
        """Names of the nodes of a kind."""
        return [node.name for node in self.nodes if node.kind == kind]

    def of(self, name: str, kind: str = "satellite") -> list[Windows]:
        """Windows of a node with all nodes of a kind."""
        others = set(self.names(kind))
        return [
            w
            for w in self.windows
            if (w.first == name and w.second in others) or (w.second == name and w.first in others)
        ]

    def without(self, kind: str) -> list[Windows]:
        """Windows of all pairs but those with nodes of a kind."""
        out = set(self.names(kind))
        return [w for w in self.windows if w.first not in out and w.second not in out]


def _check_names(nodes: Sequence[Node]) -> None:
    """Refuse two nodes of one name, with what each is."""
    called: dict[str, list[str]] = {}
    for node in nodes:
        called.setdefault(node.name, []).append(node.kind)
    twice = [
        f"two nodes named {name}, a {' and a '.join(kinds)}"
        for name, kinds in called.items()
        if len(kinds) > 1
    ]
    if twice:
        raise ArgumentError(
            f"access: {'; '.join(twice)}; stations have their names from [[station]] and --station "
            "(stations): give each another"
        )


def survey(
    constellation: Constellation,
    sites: Sequence[Site],
    duration: float,
    wanted: Wanted = _NOTHING_MORE,
    *,
    figure: Figure = DEFAULT_FIGURE,
    model: DriftModel = "two-body",
    path: Trajectory | None = None,
    start: float = 0.0,
    moon_model: MoonModel = "precessing",
    workers: int | None = None,
) -> Survey:
    """Find the windows of all pairs asked for.

    Stations link with satellites, moons and the Earth; moons and the Earth with satellites and
    with each other; satellites with each other if `wanted` says so.

    Parameters
    ----------
    constellation
        Its epoch is time 0.
    sites
        Stations.
    duration
        Seconds.
    wanted
        What else to link.
    figure
        Mars's figure for the limb.
    model, moon_model
        How satellites and moons move.
    path, start
        Paths of the satellites, followed from `start` seconds after the epoch on, which is then
        time 0; instead of `model`.
    workers
        Threads.

    Raises
    ------
    ArgumentError
        There is nothing or too much to link, two nodes have one name, or as in `windows`.
    """
    check_duration(duration)
    epoch = constellation.epoch + start
    satellites = (
        satellite_nodes(constellation, model) if path is None else path_nodes(path, start, duration)
    )
    stations = [station_node(site, epoch, duration) for site in sites]
    moons = [moon_node(name, epoch, duration, moon_model) for name in wanted.moons]
    earth = [earth_node(epoch, duration)] if wanted.earth else []
    nodes = [*stations, *moons, *earth, *satellites]
    _check_names(nodes)
    pairs = [
        *product(stations, [*satellites, *moons, *earth]),
        *product(moons, [*satellites, *earth]),
        *combinations(moons, 2),
        *product(earth, satellites),
        *(combinations(satellites, 2) if wanted.crosslinks else ()),
    ]
    if not pairs:
        raise ArgumentError(
            "access: nothing to link; add a [[station]] or use --station, --moon, --earth or "
            "--crosslinks"
        )
    if len(pairs) > MAX_PAIRS:
        raise ArgumentError(
            f"access: {len(pairs)} pairs; at most {MAX_PAIRS} at once; leave out crosslinks or "
            "some stations"
        )
    seen = windows(
        pairs,
        duration,
        figure=figure,
        atmosphere_height=wanted.atmosphere_height,
        workers=workers,
    )
    return Survey(tuple(nodes), tuple(seen), duration, epoch)
