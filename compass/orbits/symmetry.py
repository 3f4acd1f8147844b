"""How circular orbits of one radius carry themselves into one another: found and verified.

A satellite's place is its node and its argument of latitude, (Omega, u). Two kinds of moves of all
satellites at once are looked for in the elements themselves; nothing is believed of a name.

* A shift: turned about the pole by an angle and moved along the orbits by a phase, satellite s
  stands where another stood: ``(Omega + turn, u + phase)``. So the constellation looks, turned
  about the pole, as it looked earlier by that phase.
* A mirror: half a turn about the line of nodes at ``turn/2`` takes (Omega, u), of a satellite that
  moves forwards, to ``(turn - Omega, phase - u)``, of one that moves backwards. So before and after
  the moment at which ``u`` has grown by ``-phase/2``, the constellation looks alike.

Besides, u + pi is always the antipode. Each move is compared with every satellite; how far they
miss, ``|dOmega| + |du| + |di|``, bounds the angle between the directions to them for ever, since
all of them keep one pace. Whoever uses a move adds that to what he proves.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from compass.core.moves import verified_moves
from compass.orbits.constellation import Constellation

#: Moves that miss by more than this are none, radians: 2 mm at the areosynchronous radius.
TOLERANCE = 1e-10

#: What sums and remainders of angles below 4 pi may be wrong by, radians.
ROUNDING = 1e-14

#: Satellites beyond which no move but the one that leaves all alone is looked for.
MOST_SATELLITES = 2000


@dataclass(frozen=True)
class Moves:
    """Moves of one kind that carry a constellation into itself.

    Attributes
    ----------
    turn, phase
        Radians in [0, 2 pi), shape (m,).
    image
        The satellite in whose place satellite s comes to stand, shape (m, n).
    mismatch
        By how much none of them is missed by more, radians.
    """

    turn: NDArray[np.float64]
    phase: NDArray[np.float64]
    image: NDArray[np.int64]
    mismatch: float

    def __len__(self) -> int:
        return int(self.turn.size)


def one_period(constellation: Constellation) -> bool:
    """Whether all orbits have the same period, after which everything repeats."""
    a = constellation.semi_major_axis
    return a.size == 0 or bool(np.all(a == a[0]))


def one_circle(constellation: Constellation) -> bool:
    """Whether all orbits are circles of one radius, so that all caps are alike for ever."""
    return constellation.is_circular and one_period(constellation)


def shifts(constellation: Constellation) -> Moves:
    """Turns about the pole with a phase that bring the constellation back, the first by nothing.

    Parameters
    ----------
    constellation
        Any; of orbits that are not circles of one radius only the move that does nothing.
    """
    return _moves(_laid_flat(constellation))[0]


def mirrors(constellation: Constellation) -> Moves:
    """Half turns about lines of nodes that run the constellation backwards; maybe none."""
    return _moves(_laid_flat(constellation))[1]


def phase_steps(constellation: Constellation) -> int:
    """Into how many equal parts of a revolution it repeats, up to a turn about the pole."""
    return int(np.round(2 * np.pi / widest_gap(shifts(constellation).phase)))


def widest_gap(phases: NDArray[np.float64]) -> float:
    """Greatest distance between neighbours among phases on the circle, radians."""
    ordered = np.sort(np.mod(phases, 2 * np.pi))
    return float(np.diff(ordered, append=ordered[0] + 2 * np.pi).max())


def alike_longitudes(constellation: Constellation, revolutions: int, rotations: int) -> float:
    """Width of the longitudes on Mars that stand for all of them, of closed tracks, radians.

    In the time that a satellite takes for a phase, Mars turns by rotations over revolutions of it:
    nodes and phases together count as ``node + phase rotations/revolutions``.
    """
    moves = shifts(constellation)
    part = rotations / revolutions
    along = np.concatenate([moves.turn + part * moves.phase, [2 * np.pi * part, 2 * np.pi]])
    apart = np.minimum(np.mod(along, 2 * np.pi), 2 * np.pi)
    return float(np.min(apart[apart > 1e-6], initial=2 * np.pi))


def _laid_flat(c: Constellation) -> Constellation:
    """The constellation, in the equator if all of it is inclined alike: its moves are the same."""
    if c.size and one_circle(c) and np.ptp(c.inclination) == 0.0 and c.inclination[0] != 0.0:
        return replace(c, inclination=np.zeros(c.size))
    return c


@lru_cache(maxsize=64)
def _moves(c: Constellation) -> tuple[Moves, Moves]:
    """Shifts and mirrors, from the elements alone."""
    n = c.size
    nothing = Moves(np.zeros(1), np.zeros(1), np.arange(n)[np.newaxis], 0.0)
    none = Moves(np.zeros(0), np.zeros(0), np.zeros((0, n), dtype=np.int64), 0.0)
    if n == 0 or n > MOST_SATELLITES or not one_circle(c):
        return nothing, none
    place = np.stack([c.raan, c.argument_of_periapsis + c.mean_anomaly, c.inclination], axis=1)
    # every move is known by where it takes the first satellite
    forwards = place - place[0]
    backwards = place + place[0]
    forwards[:, 2] = backwards[:, 2] = 0.0
    return _verified(place, forwards, 1.0), _verified(place, backwards, -1.0)


def _verified(place: NDArray[np.float64], tried: NDArray[np.float64], sign: float) -> Moves:
    """Moves ``tried + sign place`` that meet a satellite with every satellite.

    Parameters
    ----------
    place
        Node, argument of latitude and inclination, radians, shape (n, 3).
    tried
        Turn, phase and 0 of each move, radians, shape (m, 3).
    sign
        1 for shifts, -1 for mirrors.
    """
    n = len(place)
    standing = _wrapped(place)
    tried = _wrapped(tried)
    # the first satellite's company in its place makes no move of its own
    tried = tried[np.sort(np.unique(tried, axis=0, return_index=True)[1])]
    # the angle that takes more values leaves fewer satellites to compare with
    axis = int(np.argmax([np.unique(standing[:, k].round(9)).size for k in range(2)]))
    images = np.empty((len(tried), n), dtype=np.int64)
    order = np.argsort(standing[:, axis], kind="stable")
    miss = verified_moves(standing, order, axis, tried, sign, TOLERANCE, images)
    kept = np.isfinite(miss)
    moves = tried[kept]
    worst = float(miss[kept].max()) + ROUNDING if kept.any() else 0.0
    return Moves(moves[:, 0], moves[:, 1], images[kept], worst)


def _wrapped(place: NDArray[np.float64]) -> NDArray[np.float64]:
    """Places with node and argument of latitude in [0, 2 pi)."""
    wrapped = np.array(place)
    angles = np.mod(wrapped[..., :2], 2 * np.pi)
    wrapped[..., :2] = np.where(angles >= 2 * np.pi, 0.0, angles)  # of -1e-17 it is 2 pi
    return wrapped
