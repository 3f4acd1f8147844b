"""What a lander does not know beside its state and the air: clocks, orbits, biases of ranges."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from compass.entry.beacons import Beacons
from compass.entry.layout import Part
from compass.errors import ArgumentError

Array = NDArray[np.float64]

#: Components of a satellite's error: radial, along, cross, clock, and the bias of its ranges.
COMPONENTS = 5


@dataclass(frozen=True)
class Unknowns:
    """What is constant through an entry and not known to the lander.

    Attributes
    ----------
    clock
        One sigma of the receiver's clock (m) and of its drift (m/s), both estimated; zeros for a
        clock that agrees with the satellites', or two-way ranges.
    satellites
        Covariance of every satellite's radial, along, cross and clock error, m^2, (4, 4) for all
        or (n, 4, 4); independent from one satellite to the next.
    range_bias
        One sigma of a bias of the ranges to each satellite, m.
    """

    clock: tuple[float, float] = (0.0, 0.0)
    satellites: Array = field(default_factory=lambda: np.zeros((4, 4)))
    range_bias: float = 0.0

    def __post_init__(self) -> None:
        for name, value in (
            ("clock_m", self.clock[0]),
            ("clock_drift_m_s", self.clock[1]),
            ("range_bias_m", self.range_bias),
        ):
            if not 0 <= value < float("inf"):
                raise ArgumentError(f"{name} = {value:g}: must be 0 or more, and finite")
        if any(self.clock) and not all(self.clock):
            raise ArgumentError(
                f"clock_m = {self.clock[0]:g}, clock_drift_m_s = {self.clock[1]:g}: give both, or "
                "0 for both: a clock that agrees with the satellites'"
            )
        matrix = np.asarray(self.satellites, dtype=float)
        slack = 1e-9 * max(1.0, float(np.abs(matrix).max()))
        if not np.all(np.isfinite(matrix)) or np.linalg.eigvalsh(matrix).min() < -slack:
            raise ArgumentError("satellites: covariance not finite, or with a variance below 0")

    def clock_sigmas(self) -> Array:
        """Sigmas of the clock's states, shape (2,), or (0,) for a clock that agrees."""
        return np.array(self.clock if any(self.clock) else (), dtype=float)

    def roots(self, count: int, *, one_way: bool = True) -> Array:
        """Square roots of each satellite's `COMPONENTS`, (n, 5, 5); (n, 5, 0) for none.

        Unless anything is measured `one_way`, its clock enters nothing. Beside what is, it is
        counted in ranges there and back too, which makes them a little worse than they are.
        """
        if not (np.any(self.satellites) or self.range_bias):
            return np.zeros((count, COMPONENTS, 0))
        given = np.array(np.broadcast_to(self.satellites, (count, 4, 4)))
        if not one_way:
            given[:, 3], given[:, :, 3] = 0.0, 0.0
        values, vectors = np.linalg.eigh(given)
        out = np.zeros((count, COMPONENTS, COMPONENTS))
        # the symmetric root: independent components stay apart
        out[:, :4, :4] = (vectors * np.sqrt(np.maximum(values, 0.0))[:, None]) @ np.swapaxes(
            vectors, 1, 2
        )
        out[:, 4, 4] = self.range_bias
        return out

    def range_sigmas(
        self, beacons: Beacons, path: Array, omega: float, *, one_way: bool = True
    ) -> Array:
        """One sigma of the error of the range to every satellite, m, (n,), in mid-flight."""
        from compass.core.entry.many import directions

        k = len(path) // 2
        axes = np.empty((3, 3))
        out = np.empty(beacons.size)
        for i, root in enumerate(self.roots(beacons.size, one_way=one_way)):
            both = np.concatenate([beacons.r[k, i], beacons.v[k, i]])
            directions(both, omega, axes)
            line = path[k, :3] - beacons.r[k, i]
            row = np.concatenate([-axes @ line / np.linalg.norm(line), [1.0, 1.0]])
            out[i] = np.linalg.norm(row @ root)
        return out

    def parts(
        self, beacons: Beacons, path: Array, omega: float, *, one_way: bool = True
    ) -> tuple[Part, ...]:
        """Blocks of a filter that knows of this: its clock estimated, the others considered."""
        parts = []
        if any(self.clock) and one_way:
            parts.append(Part("clock", self.clock))
        sigmas = self.range_sigmas(beacons, path, omega, one_way=one_way)
        if beacons.size and sigmas.min() > 0:
            parts.append(Part("bias", tuple(sigmas.tolist()), considered=True))
        return tuple(parts)


#: A lander whose clock agrees with satellites that are known exactly.
NOTHING = Unknowns()
