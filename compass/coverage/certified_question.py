"""What a certified figure is asked about, laid out once for the kernels.

A dilution of precision, or an error in metres: then kernels see the dilution of rows weighed by
their ranges' sigmas over the least of these, whose square times that variance, and with what all
satellites share, is the error's.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from itertools import pairwise
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from compass.core.certified.groups import Problem
from compass.core.certified.shares import BOX, FOLD, INSIDE, measure
from compass.coverage.certified_domain import Domain, domain_of
from compass.coverage.certified_places import Place
from compass.coverage.certified_ranges import ERROR_DOPS, Ranges
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
    ranges: Ranges | None
    figure: Figure
    mask: Mask | float
    beam: float | None
    place: Place
    motion: AnyMotion
    height: float
    closed: bool
    since: float
    duration: float | None
    symmetric: bool


class Question:
    """A dilution of precision, or an error in metres, over a place and time, at any limit.

    Parameters
    ----------
    constellation
        The orbits.
    dop
        ``gdop``, ``pdop``, ``hdop``, ``vdop`` or ``tdop``; an error of `ERROR_DOPS`; or ``fold``,
        of which limits are kept by so many satellites in view, or more.
    ranges
        The ranges that errors are of; of no use to dilutions.
    figure
        The ellipsoid over which users stand.
    mask
        A mask, or a constant elevation in radians.
    beam
        Half angle of the satellites' antennas about the way down, radians; None all around.
    place
        A region, a `Circle`, a `Spot` or a `Tile`.
    motion, height, closed, since, duration, symmetric
        As in `domain_of`.

    Raises
    ------
    ArgumentError
        An unknown dilution, an error without ranges or along paths, or as `domain_of`.
    """

    def __init__(
        self,
        constellation: Constellation,
        *,
        dop: str = "pdop",
        ranges: Ranges | None = None,
        figure: Figure = DEFAULT_FIGURE,
        mask: Mask | float = 0.0,
        beam: float | None = None,
        place: Place = GLOBE,
        motion: AnyMotion = "two-body",
        height: float = 0.0,
        closed: bool = False,
        since: float = 0.0,
        duration: float | None = None,
        symmetric: bool = True,
    ) -> None:
        if dop not in (known := (*DOPS, *ERROR_DOPS, "fold")):
            raise ArgumentError(f"dop = {dop!r}: allowed {', '.join(known)}")
        if dop in ERROR_DOPS and ranges is None:
            raise ArgumentError(f"{dop}: needs the errors of ranges")
        self.constellation, self.figure, self.height = constellation, figure, height
        self.ranges = ranges if dop in ERROR_DOPS else None
        self.horizon = mask if isinstance(mask, Mask) else Mask.constant(mask)
        self.domain: Domain = domain_of(
            constellation,
            figure,
            place,
            mirrored=self.horizon.is_constant,
            symmetric=symmetric and (self.ranges is None or self.ranges.keeps_symmetry),
            motion=motion,
            height=height,
            closed=closed,
            since=since,
            duration=duration,
        )
        self.beam = beam
        self.name, self.folds = dop, dop == "fold"
        self.dop = FOLD if self.folds else DOPS.index(ERROR_DOPS.get(dop, dop))
        self.scale, self.shared = 1.0, 0.0
        if self.ranges is not None:
            self._weigh(self.ranges)
        self.speed = 0.5 * float(self.domain.orbits[:, 10].mean())
        self.satellites = constellation.size
        self.no_fix = self.satellites < 4 and not self.folds

    def _weigh(self, ranges: Ranges) -> None:
        """Give orbits the columns of their ranges; variances count in that of the best range."""
        d = self.domain
        if len(d.paths) and not ranges.is_isotropic:
            raise ArgumentError(
                f"{self.name}: along integrated or given paths it is certified only where orbits "
                "are as well known in all directions; compass map samples it"
            )
        nearest = float((d.orbits[:, 0] * (1.0 - d.orbits[:, 1])).min()) - 1.0 - d.height
        self.scale = ranges.least(max(nearest, 0.0))
        self.shared = ranges.shared_in(self.name)
        columns = ranges.columns(d.orbits, self.scale)
        self.domain = replace(d, orbits=np.hstack([d.orbits, columns]))

    def belt(self, south: float, north: float) -> "Question":
        """Return the same question at every longitude between two geodetic latitudes."""
        part = copy(self)
        sides = np.vstack([[south, north], self.domain.sides[1:]])
        part.domain = replace(self.domain, sides=sides, weighed=None)
        return part

    def check(self, limit: float) -> None:
        """Refuse a limit that nothing keeps, or all.

        Raises
        ------
        ArgumentError
            A dilution or a fold below 1, an error that is not positive.
        """
        if self.folds and not limit >= 1.0:
            raise ArgumentError(f"fold = {limit:g}: satellites to ask for are 1 or more")
        if self.ranges is not None and not limit > 0.0:
            raise ArgumentError(f"limit = {limit:g}: an error to ask for is above 0 m")
        if self.ranges is None and not limit >= 1.0:
            raise ArgumentError(
                f"limit = {limit:g}: a dilution of precision to ask for is 1 or more"
            )

    def dilution(self, value: float) -> float:
        """Return what kernels know a value by; one that cannot be reached is next to nothing."""
        return float(np.sqrt(max(value * value - self.shared, 1e-12 * self.scale) / self.scale))

    def value(self, dilution: float) -> float:
        """Return the value that kernels know by a dilution."""
        return float(np.sqrt(dilution * dilution * self.scale + self.shared))

    def squares(self, limits: Sequence[float]) -> NDArray[np.float64]:
        """What kernels know limits by, shape (m,): squares, but folds as they are."""
        if self.folds:
            return np.array(limits, dtype=float)
        return np.array([self.dilution(limit) ** 2 for limit in limits])

    def problem(self) -> Problem:
        """What all kernels take last."""
        d, horizon = self.domain, self.horizon
        beam = -1.0 if self.beam is None else float(np.cos(self.beam))
        numbers = np.array([d.flattening, d.slack, d.height, float(self.dop), beam])
        if self.ranges is not None:
            numbers = np.append(numbers, self.ranges.shared_row(self.scale))
        rows = (
            [[0.0], [horizon.lowest]]
            if horizon.is_constant
            else [horizon.azimuth, horizon.elevation]
        )
        mask = np.array(rows, dtype=float)
        return Problem(d.orbits, d.circles, d.breaks, d.paths, d.normals, numbers, mask)

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
            box[INSIDE] = measure(box, d.flattening)[0]
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
