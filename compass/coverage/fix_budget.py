"""The budget of a fix: how much of its error each part of the ranges' errors makes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compass.core import error
from compass.core.runs import HIGH, OUT, UP_OUT, UP_Z
from compass.coverage.errors import ERRORS
from compass.coverage.grid import make_grid
from compass.coverage.view import View
from compass.design import Design
from compass.frames import east_north_up
from compass.signal.budget import TERMS
from compass.signal.ranges import RangeErrors

Array = NDArray[np.float64]

#: Parts of a fix's variance, in order: those of ranges, and what all satellites share.
PARTS = (*TERMS, "shared")

#: Cells of the sample of users, degrees, and the most ranges that are looked at.
STEP_DEG, MOST_RANGES = 10.0, 300_000


@dataclass(frozen=True)
class FixBudget:
    """What fixes are made of, over a sample of users and moments.

    Attributes
    ----------
    range_error
        Root mean square error of the ranges that fixes are made of, m, one sigma.
    range_shares
        Of the mean variance of those ranges, of `PARTS`, shape (5,).
    shares
        Mean share of the variance of fixes, shape (error, 5), in the order of `ERRORS`.
    four, four_unmasked
        Share of area and time with four satellites in view, and with four above the plain horizon.
    """

    range_error: float
    range_shares: Array
    shares: Array
    four: float
    four_unmasked: float


def fix_budget(design: Design, seen: View, ranges: RangeErrors) -> FixBudget:
    """Split the errors of fixes over Mars by their sources, in the mean over area and time.

    With ``x = S z``, S the least-squares solution and z the ranges, the fix's covariance
    ``S R S'`` is a sum over the parts of R: every part keeps its own share, whatever the geometry.
    Orbit and clock, correlated after a determination, share what they make together as their own
    variances stand. Moments without a fix have no share.

    Parameters
    ----------
    design
        With a signal.
    seen, ranges
        The satellites and the errors of their ranges at the same epochs.

    Returns
    -------
    FixBudget
        Nan where there is no fix at all.
    """
    places, ups = _users(design, seen.height)
    skip = max(1, int(np.ceil(len(places) * seen.r[..., 0].size / MOST_RANGES)))
    epochs = slice(None, None, skip)
    variances, fixed, heard, kept, risen = variances_by_part(
        seen.r[epochs], seen, RangeErrors(ranges.forms[epochs], ranges.sun[epochs], ranges.lit,
                                          ranges.numbers), places, ups,
    )  # fmt: skip
    fours = float((kept.sum(axis=2) >= 4).mean()), float((risen.sum(axis=2) >= 4).mean())
    if not fixed.any():
        none = np.full((1 + len(ERRORS), len(PARTS)), np.nan)
        return FixBudget(np.nan, none[0], none[1:], *fours)
    shares = variances[fixed] / variances[fixed].sum(axis=2, keepdims=True)
    of_ranges = heard[kept & fixed[..., None]].mean(axis=0)
    total = of_ranges.sum()
    return FixBudget(float(np.sqrt(total)), of_ranges / total, shares.mean(axis=0), *fours)


def _users(design: Design, height: float) -> tuple[Array, Array]:
    """Places at a height, in units of the equatorial radius, and up; each of the same area."""
    figure = design.figure
    grid = make_grid("equal-area", STEP_DEG, figure.polar_radius / figure.equatorial_radius)
    longitude = np.repeat(grid.longitude, grid.rows)[:, None]
    around = np.cos(longitude), np.sin(longitude), np.ones_like(longitude)
    row = np.tile(grid.places, (grid.columns, 1))
    places, ups = (
        np.hstack(around) * row[:, columns]
        for columns in ([OUT, OUT, HIGH], [UP_OUT, UP_OUT, UP_Z])
    )
    return places + height * ups, ups


def variances_by_part(
    r: Array, seen: View, ranges: RangeErrors, places: Array, ups: Array
) -> tuple[Array, NDArray[np.bool_], Array, NDArray[np.bool_], NDArray[np.bool_]]:
    """Variances of fixes by error and part, m^2; which are fixes; those of ranges; who is in view.

    And who has risen above the plain horizon, or a mask below it, whatever a mask above it.

    Parameters
    ----------
    r
        Satellites, Mars-fixed, in units of the equatorial radius, shape (t, n, 3).
    seen
        Whose mask and beam count.
    ranges
        At these epochs.
    places, ups
        Users, in the same units, and their unit vectors up, shape (u, 3).

    Returns
    -------
    variances, fixed, heard, in_view, risen
        Shapes (t, u, 4, 5), (t, u), (t, u, n, 5), (t, u, n), (t, u, n).
    """
    numbers = ranges.numbers
    line = r[:, None] - places[None, :, None]
    d = np.linalg.norm(line, axis=-1)
    u = line / d[..., None]
    sine = np.einsum("tuni,ui->tun", u, ups)
    mask = np.sin(_mask(seen, u, ups))
    in_view, risen = sine >= mask, sine >= np.minimum(mask, 0.0)
    if seen.beam is not None:
        down = np.einsum("tuni,tni->tun", u, r) / np.linalg.norm(r, axis=-1)[:, None]
        lit_by = down >= np.cos(seen.beam)
        in_view, risen = in_view & lit_by, risen & lit_by
    heard = np.zeros((*sine.shape, len(PARTS)))
    q = ranges.forms[:, None]
    ux, uy, uz = np.moveaxis(u, -1, 0)
    clock = np.broadcast_to(q[..., 9], sine.shape)
    orbit = q[..., 0] * ux**2 + q[..., 1] * uy**2 + q[..., 2] * uz**2
    orbit += 2.0 * (q[..., 3] * ux * uy + q[..., 4] * ux * uz + q[..., 5] * uy * uz)
    together = orbit + clock + 2.0 * (ux * q[..., 6] + uy * q[..., 7] + uz * q[..., 8])
    apart = np.maximum(orbit + clock, 1e-300)
    heard[..., 0], heard[..., 1] = together * clock / apart, together * orbit / apart
    above = np.maximum(sine, error.LOWEST_SINE)
    noise = numbers[error.NOISE] + numbers[error.ZENITH] / above
    heard[..., 2] = noise**2 + d**2 * (numbers[error.LOOP] + numbers[error.LOOP2] * d**2)
    if numbers[error.DELAY2]:
        noon = np.einsum("ti,ui->tu", ranges.sun, ups)
        lit = np.interp(noon, np.linspace(-1.0, 1.0, ranges.lit.size), ranges.lit)
        slant = 1.0 - numbers[error.SHELL2] * (1.0 - sine**2)
        heard[..., 3] = numbers[error.DELAY2] * lit[..., None] / slant
    total = heard.sum(axis=-1)
    weight = np.where(in_view, 1.0 if numbers[error.EQUAL] else 1.0 / total, 0.0)
    rows = np.concatenate([-u, np.ones((*sine.shape, 1))], axis=-1)
    normal = np.einsum("tun,tuni,tunj->tuij", weight, rows, rows)
    fixed = (in_view.sum(axis=2) >= 4) & (np.linalg.cond(normal) < 1e12)
    normal[~fixed] = np.eye(4)
    solved = np.einsum("tuij,tunj,tun->tuni", np.linalg.inv(normal), rows, weight)
    height = np.einsum("tuni,ui->tun", solved[..., :3], ups) ** 2
    whole = (solved[..., :3] ** 2).sum(axis=-1)
    gains = np.stack([whole - height, height, whole, solved[..., 3] ** 2], axis=2)
    variances = np.einsum("tuen,tunp->tuep", gains, heard)
    variances[..., 4] = np.array(
        [2.0 * numbers[error.SHARED], 0.0, 2.0 * numbers[error.SHARED], numbers[error.SHARED_TIME]]
    )
    return variances, fixed, heard, in_view, risen


def _mask(seen: View, u: Array, ups: Array) -> Array:
    """Elevation of the horizon under each line of sight, rad."""
    if seen.elevations.size == 1:
        return np.broadcast_to(seen.elevations[0], u.shape[:3])
    axes = east_north_up(np.arcsin(ups[:, 2]), np.arctan2(ups[:, 1], ups[:, 0]))
    azimuth = np.arctan2(*(np.einsum("tuni,ui->tun", u, axes[:, k]) for k in (0, 1)))
    return np.interp(azimuth, seen.azimuths, seen.elevations, period=2.0 * np.pi)
