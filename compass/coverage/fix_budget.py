"""The budget of a fix: how much of its error each part of the ranges' errors makes."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from compass.core import error
from compass.core.error import Ranges
from compass.signal.budget import TERMS

Array = NDArray[np.float64]

#: Parts of a fix's variance, in order: those of ranges, and what all satellites share.
PARTS = (*TERMS, "shared")


@dataclass(frozen=True)
class FixBudget:
    """What k fixes of users at random places and moments are made of.

    Attributes
    ----------
    range_error
        Of one range of each, any of them by the same chance, m, one sigma, shape (k,).
    of_ranges
        Of `PARTS` the share of a range's variance, mean over the ranges of each, shape (k, 5).
    of_fixes
        And of the variance of each, shape (k, error, 5), in the order of errors.
    """

    range_error: Array
    of_ranges: Array
    of_fixes: Array

    @classmethod
    def joined(cls, parts: Sequence["FixBudget"]) -> "FixBudget":
        """Fixes of all parts together."""
        names = (field.name for field in fields(cls))
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def fix_budget(
    r: Array, seen: NDArray[np.bool_], ranges: Ranges, places: Array, ups: Array, chance: Array
) -> FixBudget:
    """Split the errors of fixes by their sources.

    With ``x = S z``, S the least-squares solution and z the ranges, the fix's covariance
    ``S R S'`` is a sum over the parts of R: every part keeps its own share, whatever the geometry.
    Orbit and clock, correlated after a determination, share what they make together as their own
    variances stand. Moments without a fix have no share.

    Parameters
    ----------
    r, seen, ranges, places, ups
        As of `variances_by_part`.
    chance
        Numbers in [0, 1) by which a range of each fix is chosen, shape (t,).
    """
    variances, fixed, heard = variances_by_part(r, seen, ranges, places, ups)
    variances, heard, seen = variances[fixed], heard[fixed], seen[fixed]
    count = seen.sum(axis=1)
    total = heard.sum(axis=2)
    mean = (heard / total[..., None] * seen[..., None]).sum(axis=1) / count[:, None]
    chosen = (seen.cumsum(axis=1) > (chance[fixed] * count).astype(int)[:, None]).argmax(axis=1)
    return FixBudget(
        np.sqrt(total[np.arange(count.size), chosen]),
        mean,
        variances / variances.sum(axis=2, keepdims=True),
    )


def variances_by_part(
    r: Array, seen: NDArray[np.bool_], ranges: Ranges, places: Array, ups: Array
) -> tuple[Array, NDArray[np.bool_], Array]:
    """Variances of fixes by error and part, m^2; which are fixes; and those of ranges.

    Parameters
    ----------
    r, seen
        Satellites, Mars-fixed, in units of the equatorial radius, shape (t, n, 3), and which are
        in view, shape (t, n).
    ranges
        At these moments.
    places, ups
        The user of each moment, in the same units, and its unit vector up, shape (t, 3).

    Returns
    -------
    variances, fixed, heard
        Shapes (t, 4, 5), (t,), (t, n, 5).
    """
    numbers = ranges.numbers
    line = r - places[:, None]
    d = np.linalg.norm(line, axis=-1)
    u = line / d[..., None]
    sine = np.einsum("tni,ti->tn", u, ups)
    heard = np.zeros((*sine.shape, len(PARTS)))
    q = ranges.q
    ux, uy, uz = np.moveaxis(u, -1, 0)
    clock = q[..., 9]
    orbit = q[..., 0] * ux**2 + q[..., 1] * uy**2 + q[..., 2] * uz**2
    orbit += 2.0 * (q[..., 3] * ux * uy + q[..., 4] * ux * uz + q[..., 5] * uy * uz)
    together = orbit + clock + 2.0 * (ux * q[..., 6] + uy * q[..., 7] + uz * q[..., 8])
    apart = np.maximum(orbit + clock, 1e-300)
    heard[..., 0], heard[..., 1] = together * clock / apart, together * orbit / apart
    above = np.maximum(sine, error.LOWEST_SINE)
    noise = numbers[error.NOISE] + numbers[error.ZENITH] / above
    heard[..., 2] = noise**2 + d**2 * (numbers[error.LOOP] + numbers[error.LOOP2] * d**2)
    if numbers[error.DELAY2]:
        noon = np.einsum("ti,ti->t", ranges.sun, ups)
        lit = np.interp(noon, np.linspace(-1.0, 1.0, ranges.lit.size), ranges.lit)
        slant = 1.0 - numbers[error.SHELL2] * (1.0 - sine**2)
        heard[..., 3] = numbers[error.DELAY2] * lit[:, None] / slant
    total = heard.sum(axis=-1)
    weight = np.where(seen, 1.0 if numbers[error.EQUAL] else 1.0 / total, 0.0)
    rows = np.concatenate([-u, np.ones((*sine.shape, 1))], axis=-1)
    normal = np.einsum("tn,tni,tnj->tij", weight, rows, rows)
    fixed = (seen.sum(axis=1) >= 4) & (np.linalg.cond(normal) < 1e12)
    normal[~fixed] = np.eye(4)
    solved = np.einsum("tij,tnj,tn->tni", np.linalg.inv(normal), rows, weight)
    height = np.einsum("tni,ti->tn", solved[..., :3], ups) ** 2
    whole = (solved[..., :3] ** 2).sum(axis=-1)
    gains = np.stack([whole - height, height, whole, solved[..., 3] ** 2], axis=1)
    variances = np.einsum("ten,tnp->tep", gains, heard)
    variances[..., 4] = np.array(
        [2.0 * numbers[error.SHARED], 0.0, 2.0 * numbers[error.SHARED], numbers[error.SHARED_TIME]]
    )
    return variances, fixed, heard
