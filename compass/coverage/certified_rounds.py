"""Boxes split round by round, by threads and within a budget; who works changes no sum."""

from contextlib import closing

import numpy as np
from numpy.typing import NDArray

from compass.core.certified.shares import BOX, GIVEN, INSIDE, refine
from compass.core.compiling import worked
from compass.cores import shared
from compass.coverage.certified_question import Question

#: Boxes that one piece of work starts from: fixed, so that sums do not depend on who works.
PIECE = 2048

#: Satellites up to which pieces are whole: a box takes as much longer as there are more of them,
#: and the clock is looked at between pieces.
WHOLE = 64

#: Bytes of open boxes that are held at once: where geometry is all but singular for long, a width
#: takes more boxes than any memory holds.
OPEN = 1e9

#: What it means that a search stopped, by `Rounds.stopped`.
_ENDED = {
    "time": "the time allowed was over",
    "boxes": "as many boxes of places and moments as allowed had been looked at",
    "memory": f"the boxes still open took {OPEN / 1e9:g} GB, and more are not held",
    "resolution": "smaller boxes could not be told apart",
    "interrupted": "it was interrupted",
}


def ended(stopped: str) -> str:
    """Why a search ended with its bounds wider apart than wanted, in words."""
    return f"ended early: {_ENDED.get(stopped, stopped)}"


def fewer(boxes: int, satellites: int) -> int:
    """Boxes of a piece of work that takes as long with many satellites as `boxes` with `WHOLE`."""
    return max(1, boxes * WHOLE // max(satellites, WHOLE))


class Rounds:
    """A question whose boxes are split, round by round.

    Attributes
    ----------
    question, workers
        What is asked, and how many threads work.
    end
        When to stop, as `compass.core.compiling.worked` tells it.
    left
        Boxes that may still be looked at.
    stopped
        Empty, or why a round was not done: ``time``, ``boxes``, ``memory`` or ``interrupted``.
    """

    def __init__(self, question: Question, workers: int) -> None:
        self.question, self.workers = question, workers
        self.end, self.left, self.stopped = np.inf, np.inf, ""
        if not question.no_fix:  # compiled before any clock runs
            self.refine(np.empty((0, BOX)), np.ones(1), [1.0])

    def begin(self, budget_s: float, budget_boxes: float) -> None:
        """Begin a budget: so many seconds from now, and boxes."""
        self.end, self.left, self.stopped = worked() + budget_s, budget_boxes, ""

    def refine(
        self,
        leaves: NDArray[np.float64],
        eps: NDArray[np.float64],
        limits: list[float],
        *,
        fresh: bool = False,
        whole: bool = False,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Refine all leaves, piece by piece in their order; what the budget leaves undone stays.

        Parameters
        ----------
        leaves, eps, fresh, whole
            As of `compass.core.certified.shares.refine`.
        limits
            As many as `eps` has.

        Returns
        -------
        leaves, sums
            Boxes now, and what `refine` says is settled.
        """
        sums = np.zeros(leaves.shape[1] - INSIDE + 1)
        if self.left <= 0:
            self.stopped = "boxes"
            return leaves, sums
        arrays = self.question.squares(limits), self.question.problem()
        size = fewer(PIECE, self.question.satellites)
        pieces = [leaves[k : k + size] for k in range(0, max(len(leaves), 1), size)]
        kept: list[NDArray[np.float64]] = []
        held = float(leaves.nbytes)

        def work(piece: NDArray[np.float64]) -> tuple[NDArray, NDArray] | None:
            if worked() > self.end:
                return None
            return refine(piece, fresh, whole, eps, self.question.speed, *arrays)

        with closing(shared(work, pieces, self.workers)) as results:
            try:
                for piece in pieces:
                    if sums[-1] >= self.left:
                        self.stopped = "boxes"
                        break
                    if held > OPEN:
                        self.stopped = "memory"
                        break
                    done = next(results)
                    self.stopped = self.stopped or ("" if done else "time")
                    kept.append(done[1] if done else piece)
                    held += kept[-1].nbytes - piece.nbytes
                    sums += done[0] if done else 0.0
            except KeyboardInterrupt:
                self.stopped = "interrupted"
        self.left -= sums[-1]
        return np.concatenate(kept + pieces[len(kept) :]), sums


def open_at_most(leaves: NDArray[np.float64]) -> float:
    """Return the largest measure that is open in a box at one of the limits."""
    count = (leaves.shape[1] - GIVEN) // 2
    given = leaves[:, GIVEN : GIVEN + count] + leaves[:, GIVEN + count :]
    return float((leaves[:, INSIDE, np.newaxis] - given).max(initial=0.0))
