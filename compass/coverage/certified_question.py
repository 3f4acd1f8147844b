"""What a certified figure is asked about, laid out once for the kernels."""

from itertools import pairwise
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from compass.core.certified.shares import BOX, measure
from compass.coverage.certified_domain import Domain, domain_of
from compass.coverage.certified_places import Place
from compass.coverage.region import GLOBE
from compass.errors import ArgumentError
from compass.frames import DEFAULT_FIGURE, Figure
from compass.orbits import Constellation
from compass.orbits.motion import AnyMotion
from compass.sites import Mask

#: In the order of the kernels.
DOPS = ("gdop", "pdop", "hdop", "vdop", "tdop")

#: Longest side of the first boxes.
COARSE = 0.5


class Asked(TypedDict, total=False):
    """Options that all certified figures have; what they mean stands at `Question`."""

    dop: str
    figure: Figure
    mask: Mask | float
    place: Place
    motion: AnyMotion
    height: float
    closed: bool
    since: float
    duration: float | None
    symmetric: bool


def check_limit(limit: float) -> None:
    """Refuse a limit that no dilution of precision keeps.

    Raises
    ------
    ArgumentError
        Below 1.
    """
    if not limit >= 1.0:
        raise ArgumentError(f"limit = {limit:g}: a dilution of precision to ask for is 1 or more")


class Question:
    """A dilution of precision over a place and time, at any limit.

    Parameters
    ----------
    constellation
        The orbits.
    dop
        ``gdop``, ``pdop``, ``hdop``, ``vdop`` or ``tdop``.
    figure
        The ellipsoid over which users stand.
    mask
        A mask, or a constant elevation in radians.
    place
        A region, a `Circle`, a `Spot` or a `Tile`.
    motion, height, closed, since, duration, symmetric
        As in `domain_of`.

    Raises
    ------
    ArgumentError
        An unknown dilution, or as `domain_of`.
    """

    def __init__(
        self,
        constellation: Constellation,
        *,
        dop: str = "pdop",
        figure: Figure = DEFAULT_FIGURE,
        mask: Mask | float = 0.0,
        place: Place = GLOBE,
        motion: AnyMotion = "two-body",
        height: float = 0.0,
        closed: bool = False,
        since: float = 0.0,
        duration: float | None = None,
        symmetric: bool = True,
    ) -> None:
        if dop not in DOPS:
            raise ArgumentError(f"dop = {dop!r}: allowed {', '.join(DOPS)}")
        self.constellation, self.figure, self.height = constellation, figure, height
        self.horizon = mask if isinstance(mask, Mask) else Mask.constant(mask)
        self.domain: Domain = domain_of(
            constellation,
            figure,
            place,
            mirrored=self.horizon.is_constant,
            symmetric=symmetric,
            motion=motion,
            height=height,
            closed=closed,
            since=since,
            duration=duration,
        )
        self.dop = DOPS.index(dop)
        self.speed = 0.5 * float(self.domain.orbits[:, 10].mean())
        self.satellites = constellation.size

    def arrays(self, limit: float = 1.0) -> tuple[NDArray[np.float64], ...]:
        """What all kernels take last: orbits, circles, breaks, paths, edges, numbers, mask."""
        d, horizon = self.domain, self.horizon
        numbers = np.array([d.flattening, d.slack, d.height, float(self.dop), limit * limit])
        rows = (
            [[0.0], [horizon.lowest]]
            if horizon.is_constant
            else [horizon.azimuth, horizon.elevation]
        )
        mask = np.array(rows, dtype=float)
        return d.orbits, d.circles, d.breaks, d.paths, d.normals, numbers, mask

    def boxes(self) -> NDArray[np.float64]:
        """Boxes to begin with, shape (m, BOX): parts of at most `COARSE`, all open."""
        d = self.domain
        stretches = [(low, high) for low, high in d.sides]
        steps = [
            _steps(*stretches[0], COARSE),
            _steps(*stretches[1], COARSE),
            np.concatenate(
                [
                    _steps(a, b, COARSE / self.speed)[k > 0 :]
                    for k, (a, b) in enumerate(self._times(*stretches[2]))
                ]
            ),
        ]
        axes = [0.5 * (edges[1:] + edges[:-1]) for edges in steps]
        halves = [0.5 * (edges[1:] - edges[:-1]) for edges in steps]
        boxes = np.zeros((int(np.prod([len(axis) for axis in axes])), BOX))
        boxes[:, :3] = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        boxes[:, 3:6] = np.stack(np.meshgrid(*halves, indexing="ij"), axis=-1).reshape(-1, 3)
        for box in boxes:
            box[9] = measure(box, d.flattening)[0]
        return boxes

    def _times(self, start: float, stop: float) -> list[tuple[float, float]]:
        """Stretches of time in which all paths are smooth."""
        if not len(self.domain.paths):
            return [(start, stop)]
        inside = self.domain.breaks[(self.domain.breaks > start) & (self.domain.breaks < stop)]
        edges = np.concatenate([[start], inside, [stop]])
        return list(pairwise(edges))


def _steps(low: float, high: float, longest: float) -> NDArray[np.float64]:
    """Edges of equal parts no longer than `longest`; two that are one where there is no length."""
    return np.linspace(low, high, max(int(np.ceil((high - low) / longest)), 1) + 1)
