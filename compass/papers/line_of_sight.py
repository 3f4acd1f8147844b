"""Which straight lines miss a planet: a second way to what an engine says is in sight."""

import numpy as np
from numpy.typing import ArrayLike, NDArray


def misses(start: ArrayLike, end: ArrayLike, radius: float) -> NDArray[np.bool_]:
    """Whether the segments between places (..., 3) stay outside a sphere about the origin.

    The nearest point of the segment a + t (b - a) has ``t = -a.(b - a)/|b - a|^2``, kept in 0 to 1.
    """
    a, b = np.broadcast_arrays(np.asarray(start, dtype=float), np.asarray(end, dtype=float))
    along = b - a
    square = np.maximum((along**2).sum(axis=-1), np.finfo(float).tiny)  # a place to itself
    t = np.clip(-(a * along).sum(axis=-1) / square, 0.0, 1.0)
    return np.asarray(np.linalg.norm(a + t[..., None] * along, axis=-1) > radius)
