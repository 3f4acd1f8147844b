"""Adaptive quadrature of many functions at once, evaluated at many moments together."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

#: Nodes of the 15-point Kronrod rule on [-1, 1] from the outermost to the middle, its weights, and
#: those of the 7-point Gauss rule at every second node (Piessens et al., QUADPACK, 1983, QK15).
_NODES = (
    *(0.991455371120812639206854697526329, 0.949107912342758524526189684047851),
    *(0.864864423359769072789712788640926, 0.741531185599394439863864773280788),
    *(0.586087235467691130294144691838259, 0.405845151377397166906606412076961),
    *(0.207784955007898467600689403773245, 0.0),
)
_KRONROD = (
    *(0.022935322010529224963732008058970, 0.063092092629978553290700663189204),
    *(0.104790010322250183839876322541518, 0.140653259715525918745189590510238),
    *(0.169004726639267902826583426598550, 0.190350578064785409913256402421014),
    *(0.204432940075298892414161999234649, 0.209482141084727828012999174891714),
)
_GAUSS = (
    *(0.0, 0.129484966168869693270611432679082),
    *(0.0, 0.279705391489276667901467771423780),
    *(0.0, 0.381830050505118944950369775488975),
    *(0.0, 0.417959183673469387755102040816327),
)

#: Rounds of halving after which what is left is a jump, not a bend.
MOST_ROUNDS = 40


def integrate(
    values: Callable[[NDArray[np.float64]], NDArray[np.float64]], tolerance: float
) -> tuple[NDArray[np.float64], float]:
    """Integrals over [0, 1] and an estimate of the largest error of any of them.

    Gauss-Kronrod rules on intervals, of which in each round the worst are halved until the sum of
    their errors is below `tolerance`. An interval's error is estimated as in QUADPACK, from the
    difference of the two rules and how much the function varies.

    Parameters
    ----------
    values
        Functions at moments: shape (moment,) to (moment, function).
    tolerance
        Of the sum of the intervals' errors, absolute.
    """
    node = np.array([*_NODES, *(-x for x in _NODES[-2::-1])])
    kronrod = np.array([*_KRONROD, *_KRONROD[-2::-1]])
    gauss = np.array([*_GAUSS, *_GAUSS[-2::-1]])

    def rule(low: NDArray[np.float64], width: NDArray[np.float64]) -> tuple[NDArray, NDArray]:
        moments = low[:, np.newaxis] + 0.5 * width[:, np.newaxis] * (1.0 + node)
        f = values(moments.ravel()).reshape(*moments.shape, -1)
        half = 0.5 * width[:, np.newaxis]
        fine = half * np.einsum("k,ikf->if", kronrod, f)
        miss = np.abs(fine - half * np.einsum("k,ikf->if", gauss, f)).max(axis=1)
        mean = fine / width[:, np.newaxis]
        varies = (half * np.einsum("k,ikf->if", kronrod, np.abs(f - mean[:, np.newaxis]))).max(1)
        scale = np.where(varies > 0.0, varies, 1.0)
        return fine, np.where(miss > 0.0, varies * np.minimum(1.0, (200 * miss / scale) ** 1.5), 0)

    low, width = np.zeros(1), np.ones(1)
    part, error = rule(low, width)
    for _ in range(MOST_ROUNDS):
        worst_last = np.argsort(error, kind="stable")
        bad = worst_last[np.cumsum(error[worst_last]) > 0.5 * tolerance]
        if error.sum() <= tolerance or not bad.size:
            break
        half = 0.5 * width[bad]
        fresh_low = np.concatenate([low[bad], low[bad] + half])
        fresh_width = np.concatenate([half, half])
        fresh = rule(fresh_low, fresh_width)
        kept = np.setdiff1d(np.arange(low.size), bad)
        low, width = np.append(low[kept], fresh_low), np.append(width[kept], fresh_width)
        part, error = np.concatenate([part[kept], fresh[0]]), np.append(error[kept], fresh[1])
    # from the start on, so that the sum is the same whatever was halved first
    return part[np.argsort(low)].sum(axis=0), float(error.sum())
