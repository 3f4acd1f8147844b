"""What radio beacons let a lander know: observability matrices, their degree and blind spots."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.entry_geometry import cartesian_jacobian
from compass.core.entry_observability import (
    EXACT,
    LINEAR,
    PUBLISHED_QUADRATIC,
    QUADRATIC,
    exact_matrix,
    observe_epochs,
)
from compass.core.jacobi_svd import jacobi_svd
from compass.entry.beacons import Beacons
from compass.entry.model import EntryModel
from compass.entry.views import cartesian_of
from compass.errors import ArgumentError

Method = Literal["exact", "quadratic", "published-quadratic", "linear"]
Scaling = Literal["si", "nondimensional"]
_CODES = {
    "exact": EXACT,
    "quadratic": QUADRATIC,
    "published-quadratic": PUBLISHED_QUADRATIC,
    "linear": LINEAR,
}

#: Length (m) and time (s) that make the nondimensional form.
LENGTH, TIME = 3.4e6, 100.0

#: Factors of range rows, range-rate rows, each further order, and the six columns.
_SCALES = {
    "si": np.ones(9),
    "nondimensional": np.array(
        [1 / LENGTH, TIME / LENGTH, TIME, LENGTH, 1.0, 1.0, LENGTH / TIME, 1.0, 1.0]
    ),
}

#: Singular values below this share of the largest in the nondimensional form count as zero: some
#: thousand roundings; a lone beacon on a turning planet still shows about 5e-11.
RANK_TOLERANCE = 1e-12

STATE_NAMES = ("radius", "longitude", "latitude", "speed", "flight-path angle", "azimuth")


@dataclass(frozen=True)
class Observability:
    """Observability along a trajectory.

    Attributes
    ----------
    singular_values
        Of the matrix at each epoch, descending, shape (t, 6).
    degree
        ``delta = sigma_min / sigma_max``, shape (t,): depends on `scaling`.
    rank
        Shape (t,): found in the nondimensional form whatever `scaling` is.
    index
        Eq. 54, ``I = sum [n_i . (n_j x n_k)]^2 = det(sum n n^T)``, shape (t,).
    method, scaling
        As asked for.
    """

    singular_values: NDArray[np.float64]
    degree: NDArray[np.float64]
    rank: NDArray[np.int_]
    index: NDArray[np.float64]
    method: Method
    scaling: Scaling


def observability(
    model: EntryModel,
    states: ArrayLike,
    beacons: Beacons,
    taken: ArrayLike | None = None,
    *,
    ranges: bool = True,
    rates: bool = False,
    method: Method = "exact",
    scaling: Scaling = "si",
    orders: int = 6,
    threads: int = 2,
) -> Observability:
    """Singular values, degree, rank and geometric index at every epoch.

    The matrix stacks ``grad L_f^k h``, k = 0 to ``orders - 1``, of every measurement (eq. 12).

    Parameters
    ----------
    model
        The world.
    states
        Entry states at the beacons' times, shape (t, 6) or (t, 8).
    beacons
        Where the beacons are.
    taken
        Which are measured, shape (t, n); all if left out.
    ranges, rates
        What is measured of each.
    method
        ``exact``; ``quadratic``, ``published-quadratic`` and ``linear`` for beacons at rest and
        ranges only.
    scaling
        ``si``: metres, seconds, radians; ``nondimensional``: lengths in 3.4e6 m, time in 100 s.
    orders
        Number of Lie derivatives, the zeroth included.
    threads
        Threads to spread the epochs over; the result does not depend on it.

    Raises
    ------
    ArgumentError
        An unknown method or scaling, or an approximation asked of moving beacons or rates.
    """
    x = np.ascontiguousarray(model.full_state(np.atleast_2d(states)))
    count, n = x.shape[0], beacons.size
    used = np.ones((count, n), dtype=bool) if taken is None else np.asarray(taken, dtype=bool)
    _check(method, scaling, beacons, rates)
    use_range, use_rate = used & ranges, used & rates
    banks = model.vehicle.bank(beacons.times)
    singular, index = np.empty((2, count, 6)), np.empty(count)

    def work(block: NDArray[np.int_]) -> None:
        part = slice(block[0], block[-1] + 1)
        observe_epochs(
            x[part],
            model.parameters(),
            banks[part],
            beacons.r[part],
            beacons.v[part],
            beacons.moving,
            use_range[part],
            use_rate[part],
            orders,
            _CODES[method],
            np.stack([_SCALES["si"], _SCALES["nondimensional"]]),
            singular[:, part],
            index[part],
        )

    blocks = np.array_split(np.arange(count), max(1, min(threads, count // 32)))
    with ThreadPoolExecutor(len(blocks)) as pool:
        list(pool.map(work, blocks))
    alike = singular[1]
    rank = (alike > RANK_TOLERANCE * alike[:, :1]).sum(axis=1)
    chosen = singular[0 if scaling == "si" else 1]
    largest = np.where(chosen[:, 0] > 0, chosen[:, 0], 1.0)
    return Observability(chosen, chosen[:, -1] / largest, rank, index, method, scaling)


def _check(method: str, scaling: str, beacons: Beacons, rates: bool) -> None:
    if method not in _CODES:
        raise ArgumentError(f"method = {method!r}: allowed {', '.join(get_args(Method))}")
    if scaling not in get_args(Scaling):
        raise ArgumentError(f"scaling = {scaling!r}: allowed {', '.join(get_args(Scaling))}")
    if method != "exact" and (beacons.moving.any() or rates):
        raise ArgumentError(
            f"method = {method!r}: only for ranges to beacons at rest; use method 'exact'"
        )


@dataclass(frozen=True)
class BlindSpots:
    """What cannot be seen at one epoch.

    Attributes
    ----------
    matrix
        The observability matrix in SI, rows ``grad L_f^k h`` by order, then beacon.
    lie
        The Lie derivatives themselves, one a row.
    rank
        Its rank.
    directions
        Null directions as changes of the state, one a row, shape (6 - rank, 6), SI; each moves
        the lander by about a kilometre or a metre a second.
    words
        Each in plain words.
    weakest
        The direction seen worst of all, in plain words; empty if there are null directions.
    """

    matrix: NDArray[np.float64]
    lie: NDArray[np.float64]
    rank: int
    directions: NDArray[np.float64]
    words: tuple[str, ...]
    weakest: str


def blind_spots(
    model: EntryModel,
    state: ArrayLike,
    beacons: Beacons,
    epoch: int = 0,
    taken: ArrayLike | None = None,
    *,
    ranges: bool = True,
    rates: bool = False,
    orders: int = 6,
) -> BlindSpots:
    """Rank and null directions of the exact observability matrix at one of the beacons' times.

    Parameters as in `observability`, but for one state (6 or 8), the index `epoch` of its time,
    and `taken` of shape (n,).
    """
    x = model.full_state(state)
    n = beacons.size
    used = np.ones(n, dtype=bool) if taken is None else np.asarray(taken, dtype=bool)
    matrix, lie = np.zeros((2 * n * orders, 6)), np.zeros(2 * n * orders)
    if n:
        exact_matrix(
            x,
            model.parameters(float(model.vehicle.bank(beacons.times[epoch]))),
            beacons.r[epoch],
            beacons.v[epoch],
            beacons.moving,
            used & ranges,
            used & rates,
            orders,
            6,
            matrix,
            lie,
        )
    kept = np.flatnonzero(np.tile(np.repeat(used, 2) & np.tile([ranges, rates], n), orders))
    matrix, lie = matrix[kept], lie[kept]
    scale = _SCALES["nondimensional"]
    columns = scale[3:]
    measured = int((used & ranges).sum() + (used & rates).sum())
    powers = np.repeat(scale[2] ** np.arange(orders), measured)
    kinds = np.tile(np.tile([0, 1], n)[np.repeat(used, 2) & np.tile([ranges, rates], n)], orders)
    scaled = matrix * scale[kinds][:, None] * powers[:, None] * columns
    work = np.zeros((6, max(6, len(scaled))))
    work[:, : len(scaled)] = scaled.T
    values, vectors = np.empty(6), np.empty((6, 6))
    jacobi_svd(work, values, vectors)
    rank = int((values > RANK_TOLERANCE * values[0]).sum()) if values[0] > 0 else 0
    null = vectors[rank:] * columns
    seen = beacons.chosen(used)
    directions, words = _describe(x, null, seen, epoch)
    weakest = "" if words else _describe(x, vectors[5:] * columns, seen, epoch)[1][0]
    return BlindSpots(matrix, lie, rank, directions, words, weakest)


def _describe(
    x: NDArray[np.float64], null: NDArray[np.float64], beacons: Beacons, epoch: int
) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Null directions sorted into turns about a beacon's axis and the rest, and said in words."""
    if not len(null):
        return null, ()
    if len(null) == 6:
        return null, ("nothing at all is measured: position and velocity are both unobservable",)
    jacobian = np.empty((6, 6))
    cartesian_jacobian(x, jacobian)
    size = np.array([1e3, 1e3, 1e3, 1.0, 1.0, 1.0])
    moved = (jacobian @ null.T).T / size  # km and m/s
    place = cartesian_of(x)
    basis = np.linalg.qr(moved.T)[0].T
    found: list[NDArray] = []
    words: list[str] = []
    axes = {beacons.names[k]: beacons.r[epoch, k] for k in range(beacons.size)}
    if len(axes) == 1:
        (name, r), *_ = axes.items()
        axis = r / np.linalg.norm(r)
        turn = np.concatenate([np.cross(axis, place[:3]), np.cross(axis, place[3:])]) / size
        turn /= np.linalg.norm(turn)
        if np.linalg.norm(basis @ turn) > 1 - 1e-6:
            found.append(turn)
            words.append(
                "a rotation of position and velocity together about the axis from Mars's centre "
                f"to beacon {name}"
            )
    for vector in basis:
        rest = vector - sum((vector @ f) * f for f in found)
        if np.linalg.norm(rest) > 1e-6:
            unit = rest / np.linalg.norm(rest)
            found.append(unit)
            words.append(_in_words(unit, place))
    directions = np.linalg.solve(jacobian, (np.array(found) * size).T).T
    return directions, tuple(words)


def _in_words(moved: NDArray[np.float64], place: NDArray[np.float64]) -> str:
    """Say a direction (km, m/s) in the lander's local axes."""
    up = place[:3] / np.linalg.norm(place[:3])
    east = np.cross([0.0, 0.0, 1.0], up)
    east /= np.linalg.norm(east)
    local = np.array([up, east, np.cross(up, east)])
    parts = []
    for quantity, unit, vector in (
        ("position", "km", local @ moved[:3]),
        ("velocity", "m/s", local @ moved[3:]),
    ):
        terms = [
            f"{value:+.2f} {unit} {axis}"
            for value, axis in zip(vector, ("up", "east", "north"), strict=True)
            if abs(value) >= 0.005
        ]
        if terms:
            parts.append(f"{quantity} {', '.join(terms)}")
    return "a shift of " + " with ".join(parts)
