"""Patterns as kernels take them, many in one call."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Patterns(NamedTuple):
    """Walker patterns: whether each is a star, its t, p, f and inclination (rad), (m,) each."""

    star: NDArray[np.bool_]
    satellites: NDArray[np.int64]
    planes: NDArray[np.int64]
    phasing: NDArray[np.int64]
    inclination: NDArray[np.float64]
