"""How satellites move: on ellipses, drifting ellipses, under forces, or as a table says.

Whatever the motion, it answers the same question: `Motion.trajectory`, the paths of a constellation
over a span.
"""

from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from threading import Lock
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.digest import digest_of
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY
from compass.orbits.constellation import Constellation

if TYPE_CHECKING:
    from compass.orbits.forces import ForceModel
    from compass.orbits.trajectory import Trajectory

MotionModel = Literal["two-body", "j2", "numerical", "ephemeris"]
MODELS: tuple[MotionModel, ...] = get_args(MotionModel)

#: Integrated trajectories that are kept, newest last: pages ask for the same one again and again.
_KEPT: "OrderedDict[str, Trajectory]" = OrderedDict()
MOST_KEPT = 8
_KEEPING = Lock()


@dataclass(frozen=True)
class Motion:
    """How satellites move.

    Attributes
    ----------
    model
        ``two-body``; ``j2``: mean elements that drift at J2's secular rates; ``numerical``: under
        `forces`, from the elements taken as osculating at the epoch; ``ephemeris``: as `table`
        says.
    forces
        Of numerical motion.
    table
        Of an ephemeris.
    """

    model: MotionModel = "two-body"
    forces: "ForceModel | None" = None
    table: "Trajectory | None" = None

    def __post_init__(self) -> None:
        """Refuse an unknown model; give numerical motion the default forces."""
        if self.model not in MODELS:
            raise ArgumentError(f"motion = {self.model!r}: allowed {', '.join(MODELS)}")
        if self.model == "ephemeris" and self.table is None:
            raise ArgumentError(
                'motion = ephemeris: there is no table; give a design of pattern = "ephemeris"'
            )
        if self.model == "numerical" and self.forces is None:
            from compass.orbits.forces import ForceModel

            object.__setattr__(self, "forces", ForceModel())

    @property
    def title(self) -> str:
        """The motion in words: under what, or from where."""
        if self.table is not None:
            return self.table.source
        if self.forces is not None:
            return f"numerical motion: {self.forces.describe()}"
        return {"two-body": "two-body motion", "j2": "mean motion under J2"}[self.model]

    def or_of(self, model: MotionModel | None) -> "Motion":
        """Return this motion, or another if another model is named."""
        return self if model in (None, self.model) else Motion(model)

    @property
    def is_closed_form(self) -> bool:
        """Whether a moment costs the same whichever others are asked for: nothing is integrated."""
        return self.model in ("two-body", "j2")

    def states(
        self, constellation: Constellation, times: ArrayLike
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Inertial positions (m) and velocities (m/s) at seconds after the epoch, (n, t, 3)."""
        from compass.orbits.ellipse import elliptic

        seconds = np.atleast_1d(np.asarray(times, dtype=float))
        if self.is_closed_form:
            return elliptic(constellation, seconds, drifting=self.model == "j2")
        if self.table is not None:
            if seconds.size:
                check_span(self.table, float(seconds.min()), float(seconds.max()))
            return self.table.of(constellation.satellite_names).states(seconds)
        low, high = min(seconds.min(initial=0.0), 0.0), max(seconds.max(initial=0.0), 0.0)
        if low == high == 0.0:
            high = 1.0
        if low == 0.0:
            return self.trajectory(constellation, low, high).states(seconds)
        r = np.empty((constellation.size, seconds.size, 3))
        v = np.empty_like(r)
        for chosen, end in ((seconds < 0.0, low), (seconds >= 0.0, max(high, 1.0))):
            path = self.trajectory(constellation, min(end, 0.0), max(end, 0.0))
            r[:, chosen], v[:, chosen] = path.states(seconds[chosen])
        return r, v

    def trajectory(
        self,
        constellation: Constellation,
        start: float,
        stop: float,
        progress: Callable[[Sequence[Any]], Any] = iter,
        tolerance: float | None = None,
    ) -> "Trajectory":
        """Paths over a span that reaches from `start` to `stop`, seconds after the epoch, or more.

        Integrated ones are followed from the epoch, to `tolerance` as of `integrate` if given, and
        kept for the next who asks for the same.

        Raises
        ------
        ArgumentError
            A span outside the table, on both sides of the epoch under forces, or with a fall.
        """
        from compass.orbits.ellipse import elliptic
        from compass.orbits.trajectory import TOLERANCE, integrate, through

        if stop <= start:
            raise ArgumentError(
                f"span: from {start / SECONDS_PER_DAY:g} to {stop / SECONDS_PER_DAY:g} days after "
                "the epoch; the end must come later"
            )
        if self.table is not None:
            check_span(self.table, start, stop)
            return self.table.of(constellation.satellite_names)
        c = constellation
        if self.forces is None:
            drifting = self.model == "j2"
            return through(
                lambda t: elliptic(c, t, drifting=drifting)[0],
                start,
                stop,
                piece=1.0 / float(c.mean_motion.max(initial=1e-9)),
                epoch=c.epoch,
                satellite_names=c.satellite_names,
                source=self.title,
                progress=progress,
            )
        if start < 0.0 < stop:
            raise ArgumentError("span: orbits under forces are followed one way from the epoch")
        end = start if start < 0.0 else stop
        r, v = elliptic(replace(c, gm=self.forces.field.gm), np.zeros(1))
        wanted = TOLERANCE if tolerance is None else tolerance
        key = digest_of((c.epoch, c.satellite_names, r, v, self.forces, wanted))
        with _KEEPING:
            known = _KEPT.get(key)
        if known is None or not known.start <= end <= known.stop:
            known = integrate(
                r[:, 0],
                v[:, 0],
                self.forces,
                end,
                epoch=c.epoch,
                satellite_names=c.satellite_names,
                tolerance=wanted,
                progress=progress,
            )
        with _KEEPING:
            _KEPT[key] = known
            _KEPT.move_to_end(key)
            while len(_KEPT) > MOST_KEPT:
                _KEPT.popitem(last=False)
        return known


#: A motion, or the name of one that needs no more than its name.
AnyMotion = Motion | MotionModel


def as_motion(motion: AnyMotion) -> Motion:
    """Motion of its name."""
    return motion if isinstance(motion, Motion) else Motion(motion)


def check_span(path: "Trajectory", start: float, stop: float) -> None:
    """Raise `ArgumentError` unless a trajectory covers a span of seconds after its epoch."""
    if start < path.start - 1e-3 or stop > path.stop + 1e-3:
        raise ArgumentError(
            f"span: {start / SECONDS_PER_DAY:.9g} to {stop / SECONDS_PER_DAY:.9g} days is more "
            f"than the ephemerides cover, {path.start / SECONDS_PER_DAY:.9g} to "
            f"{path.stop / SECONDS_PER_DAY:.9g} days after the epoch; ask for less, or give longer "
            "files"
        )
