"""What radio beacons let a lander know: observability matrices, their degree and blind spots."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.entry.observe import lie_gradients, observe_epochs, read_matrix
from compass.core.jacobi_svd import jacobi_svd
from compass.entry.beacons import Beacons
from compass.entry.model import EntryModel
from compass.entry.views import cartesian_of, local_axes, spherical_jacobian

#: Length (m) and time (s) that make the form without units.
LENGTH, TIME = 3.4e6, 100.0

#: Factors of range rows, range-rate rows and each further order, in SI and without units.
_ROWS = np.array([[1.0, 1.0, 1.0], [1 / LENGTH, TIME / LENGTH, TIME]])

#: Position and velocity in units of length and time.
_UNITS = np.diag([LENGTH] * 3 + [LENGTH / TIME] * 3)

#: Singular values below this share of the largest, without units, count as zero: some thousand
#: roundings; a lone beacon on a turning planet still shows about 5e-11.
RANK_TOLERANCE = 1e-12


@dataclass(frozen=True)
class Observability:
    """Observability along a trajectory.

    Attributes
    ----------
    singular_values
        Of the matrix of position and velocity at each epoch, lengths in 3.4e6 m and times in
        100 s, descending, shape (t, 6): the same however the axes are turned.
    degree
        ``sigma_min / sigma_max`` of these, shape (t,).
    spherical_degree
        The same in radius, longitude, latitude, speed, flight-path angle and heading, SI, as the
        papers have it, shape (t,): it depends on the latitude and is 0 at the poles.
    rank
        Shape (t,).
    index
        Eq. 54, ``I = sum [n_i . (n_j x n_k)]^2 = det(sum n n^T)``, shape (t,).
    """

    singular_values: NDArray[np.float64]
    degree: NDArray[np.float64]
    spherical_degree: NDArray[np.float64]
    rank: NDArray[np.int_]
    index: NDArray[np.float64]


def observability(
    model: EntryModel,
    states: ArrayLike,
    beacons: Beacons,
    taken: ArrayLike | None = None,
    *,
    ranges: bool = True,
    rates: bool = False,
    orders: int = 6,
    threads: int = 2,
) -> Observability:
    """Singular values, degrees, rank and geometric index at every epoch.

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
    orders
        Number of Lie derivatives, the zeroth included.
    threads
        Threads to spread the epochs over; the result does not depend on it.
    """
    path = whole_path(model, np.atleast_2d(states))
    count, n = path.shape[0], beacons.size
    used = np.ones((count, n), dtype=bool) if taken is None else np.asarray(taken, dtype=bool)
    use_range, use_rate = used & ranges, used & rates
    p, banks = model.flight_parameters(), model.vehicle.bank(beacons.times)
    views = np.stack([spherical_jacobian(path[:, :6]), np.broadcast_to(_UNITS, (count, 6, 6))])
    singular, index = np.empty((2, count, 6)), np.empty(count)

    def work(block: NDArray[np.int_]) -> None:
        part = slice(block[0], block[-1] + 1)
        observe_epochs(
            path[part],
            p,
            banks[part],
            beacons.r[part],
            beacons.v[part],
            beacons.moving,
            use_range[part],
            use_rate[part],
            orders,
            views[:, part],
            _ROWS,
            singular[:, part],
            index[part],
        )

    blocks = np.array_split(np.arange(count), max(1, min(threads, count // 32)))
    with ThreadPoolExecutor(len(blocks)) as pool:
        list(pool.map(work, blocks))
    largest = np.where(singular[..., 0] > 0, singular[..., 0], 1.0)
    spherical, plain = singular[..., -1] / largest
    rank = (singular[1] > RANK_TOLERANCE * singular[1, :, :1]).sum(axis=1)
    return Observability(singular[1], plain, spherical, rank, index)


def whole_path(model: EntryModel, states: ArrayLike) -> NDArray[np.float64]:
    """States as `compass.core.entry.series.flow_series` takes them, (..., 8)."""
    x = model.full_state(states) if np.shape(states)[-1] < 8 else np.asarray(states, dtype=float)
    path = np.empty((*x.shape[:-1], 8))
    path[..., :6] = cartesian_of(x)
    path[..., 6] = x[..., 6] - model.atmosphere.log_reference_density
    path[..., 7] = x[..., 7]
    return path


@dataclass(frozen=True)
class BlindSpots:
    """What cannot be seen at one epoch.

    Attributes
    ----------
    matrix
        The observability matrix of position and velocity in SI, rows ``grad L_f^k h`` by order,
        then beacon.
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
    x = whole_path(model, state)
    n = beacons.size
    used = np.ones(n, dtype=bool) if taken is None else np.asarray(taken, dtype=bool)
    use_range, use_rate = used & ranges, used & rates
    matrix, lie = np.zeros((2 * n * orders, 6)), np.zeros(2 * n * orders)
    if n:
        bank = float(model.vehicle.bank(beacons.times[epoch]))
        lie_gradients(
            x,
            model.flight_parameters(),
            bank,
            beacons.r[epoch],
            beacons.v[epoch],
            beacons.moving,
            use_range,
            use_rate,
            orders,
            matrix,
            lie,
        )
    work, values, vectors = np.zeros((6, max(6, len(matrix)))), np.empty(6), np.empty((6, 6))
    read_matrix(matrix, use_range, use_rate, orders, _UNITS, _ROWS[1], work)
    kept = np.flatnonzero(np.tile(np.stack([use_range, use_rate], axis=1).ravel(), orders))
    jacobi_svd(work, values, vectors)
    rank = int((values > RANK_TOLERANCE * values[0]).sum()) if values[0] > 0 else 0
    seen = beacons.chosen(used)
    directions, words = _describe(x[:6], vectors[rank:] @ _UNITS, seen, epoch)
    weakest = "" if words else _describe(x[:6], vectors[5:] @ _UNITS, seen, epoch)[1][0]
    return BlindSpots(matrix[kept], lie[kept], rank, directions, words, weakest)


def _describe(
    place: NDArray[np.float64], null: NDArray[np.float64], beacons: Beacons, epoch: int
) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Null directions sorted into turns about a beacon's axis and the rest, and said in words."""
    if not len(null):
        return null, ()
    if len(null) == 6:
        return null, ("nothing at all is measured: position and velocity are both unobservable",)
    size = np.array([1e3, 1e3, 1e3, 1.0, 1.0, 1.0])
    basis = np.linalg.qr((null / size).T)[0].T  # km and m/s
    blocks: list[NDArray] = []
    words: list[str] = []
    axes = {beacons.names[k]: beacons.r[epoch, k] for k in range(beacons.size)}
    if len(axes) == 1:
        (name, r), *_ = axes.items()
        axis = r / np.linalg.norm(r)
        turn = np.concatenate([np.cross(axis, place[:3]), np.cross(axis, place[3:])]) / size
        turn /= np.linalg.norm(turn)
        if np.linalg.norm(basis @ turn) > 1 - 1e-6:
            blocks.append(turn)
            words.append(
                "a rotation of position and velocity together about the axis from Mars's centre "
                f"to beacon {name}"
            )
    for vector in basis:
        rest = vector - sum((vector @ f) * f for f in blocks)
        if np.linalg.norm(rest) > 1e-6:
            unit = rest / np.linalg.norm(rest)
            blocks.append(unit)
            words.append(_in_words(unit, place))
    return np.array(blocks) * size, tuple(words)


def _in_words(moved: NDArray[np.float64], place: NDArray[np.float64]) -> str:
    """Say a direction (km, m/s) in the lander's local axes."""
    local = local_axes(place[:3])[[2, 0, 1]]
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
