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
    turn
        One sigma of the turn about each axis of the frame that all satellites share, rad.
    """

    clock: tuple[float, float] = (0.0, 0.0)
    satellites: Array = field(default_factory=lambda: np.zeros((4, 4)))
    range_bias: float = 0.0
    turn: float = 0.0

    def __post_init__(self) -> None:
        for name, value in (
            ("clock_m", self.clock[0]),
            ("clock_drift_m_s", self.clock[1]),
            ("range_bias_m", self.range_bias),
            ("common_m.orientation", self.turn),
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
        out = np.zeros((count, COMPONENTS, COMPONENTS))
        out[:, :4, :4] = covariance_roots(given)
        out[:, 4, 4] = self.range_bias
        return out

    def range_sigmas(
        self, beacons: Beacons, path: Array, omega: float, *, one_way: bool = True
    ) -> Array:
        """One sigma of the error of the range to every satellite, m, (n,), in mid-flight."""
        rows = np.column_stack([range_rows(beacons, path, omega), np.ones(beacons.size)])
        roots = self.roots(beacons.size, one_way=one_way)
        return np.asarray(np.linalg.norm(np.einsum("ni,nij->nj", rows, roots), axis=1))

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
        if beacons.size and self.turn:
            told = (True,) * beacons.size
            parts.append(Part("frame", (self.turn,) * 3, considered=True, told=told))
        return tuple(parts)


def covariance_roots(covariances: Array) -> Array:
    """Symmetric square roots of (..., n, n); independent components stay apart."""
    values, vectors = np.linalg.eigh(covariances)
    scaled = vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :]
    return np.asarray(scaled @ np.swapaxes(vectors, -1, -2))


def range_rows(beacons: Beacons, path: Array, omega: float) -> Array:
    """By how much a range grows with its satellite's radial, along, cross and clock error, (n, 4).

    In mid-flight: over an entry the lines hardly turn. A beacon at rest has no such errors: zeros.
    """
    from compass.core.entry.information import directions

    k = len(path) // 2
    axes, out = np.empty((3, 3)), np.zeros((beacons.size, 4))
    for i in np.flatnonzero(beacons.moving):
        directions(np.concatenate([beacons.r[k, i], beacons.v[k, i]]), omega, axes)
        line = path[k, :3] - beacons.r[k, i]
        out[i, :3] = -axes @ line / np.linalg.norm(line)
        out[i, 3] = 1.0
    return out


def range_variances(
    satellites: Array,
    own: float,
    beacons: Beacons,
    path: Array,
    omega: float,
    *,
    one_way: bool = True,
) -> dict[str, Array]:
    """Variance of the error of the range to each beacon by its source, m^2, (n,) each.

    Parameters
    ----------
    satellites
        Covariance of radial, along, cross and clock error, m^2, (n, 4, 4).
    own
        One sigma of a bias of the ranges to each beacon beside them, m.
    beacons, path, omega
        At the epochs of the flight, (t, 6), about a planet that turns so fast, rad/s.
    one_way
        Whether anything is measured one way; else clocks of satellites enter nothing.
    """
    rows = range_rows(beacons, path, omega)
    if not one_way:
        rows[:, 3] = 0.0
    orbits, clocks = rows * [1.0, 1.0, 1.0, 0.0], rows * [0.0, 0.0, 0.0, 1.0]

    def variance(left: Array, right: Array) -> Array:
        return np.asarray(np.einsum("ni,nij,nj->n", left, satellites, right))

    variances = {
        "satellites' orbits": variance(orbits, orbits),
        "satellites' clocks": variance(clocks, clocks),
        "biases of the ranges": np.full(beacons.size, own**2),
    }
    if np.any(variance(orbits, clocks)):  # one makes up for the other: no share of its own
        both = {"satellites' orbits and clocks": variance(rows, rows)}
        variances = both | {"biases of the ranges": variances["biases of the ranges"]}
    return {name: values for name, values in variances.items() if values.any()}


#: A lander whose clock agrees with satellites that are known exactly.
NOTHING = Unknowns()
