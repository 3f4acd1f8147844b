"""Named groups of what the kernels of certified bounds take: the problem, and room to work in."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from compass.core.certified.cuts import CUT, EXPANSION, SCRATCH
from compass.core.certified.sights import USER, WIDTH
from compass.core.jit import inline_kernel

Array = NDArray[np.float64]


class Problem(NamedTuple):
    """What is asked: of which satellites, in which region, of what.

    `orbits`, `circles`, `breaks` and `paths` say how satellites move (see
    `compass.core.certified.sights.states`); `normals` (k, 3) are the edges of the region; `numbers`
    are those of `compass.core.certified.sights`; `mask` are two rows: azimuths and elevations.
    """

    orbits: Array
    circles: Array
    breaks: Array
    paths: Array
    normals: Array
    numbers: Array
    mask: Array


class Room(NamedTuple):
    """Scratch: what every box writes before it reads.

    `user` is from `place`; `q`, `dq` (n, 3) are the satellites' states, `rows` (n + 1, WIDTH) their
    lines of sight and `kinds` (n + 1,) whether they are surely seen (1) or in part (2).
    """

    user: Array
    scratch: Array
    q: Array
    dq: Array
    rows: Array
    kinds: NDArray[np.int64]


@inline_kernel
def make_room(n):
    """Return room for n satellites."""
    return Room(
        np.empty(USER), np.zeros(SCRATCH + CUT + EXPANSION), np.empty((n, 3)), np.empty((n, 3)),
        np.empty((n + 1, WIDTH)), np.empty(n + 1, dtype=np.int64),
    )  # fmt: skip
