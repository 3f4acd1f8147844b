"""The one percentile there is: the nearest rank."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


def percentile(values: ArrayLike, percent: float, axis: int | None = None) -> NDArray[Any]:
    """Smallest of the values along an axis that so many of 100 do not exceed.

    ``x(k)``, the k-th smallest, k the smallest whole number with ``100 k >= percent n``, as in
    kernels (`compass.core.ranking.nearest_rank`): a value that occurs; infinities are values.

    Parameters
    ----------
    values
        At least one along the axis.
    percent
        From 0 to 100.
    axis
        Of all values without.

    References
    ----------
    Hyndman and Fan 1996, The American Statistician 50, 361-365, definition 1.
    """
    order = np.sort(values, axis=axis)
    along = 0 if axis is None else axis
    n = order.shape[along]
    return np.take(order, max(int(-(-percent * n // 100)), 1) - 1, axis=along)
