"""Dilution of precision at scattered places: the kernel against linear algebra."""

import numpy as np
import pytest

from compass.core.gdop import dops_over
from compass.orbits import positions_mci, walker_delta

R = 3396.2e3


def dops(r, places, mask):
    """Fold, GDOP and PDOP at moments, shape (t, n, 3), and places, shape (q, 3): three (t, q)."""
    fold = np.empty((len(r), len(places)), np.int64)
    gdop, pdop = np.empty((2, *fold.shape))
    dops_over(np.ascontiguousarray(r), places, R, np.sin(mask), fold, gdop, pdop)
    return fold, gdop, pdop


def plain_dops(r, place, mask):
    sight = r - R * place
    unit = sight / np.linalg.norm(sight, axis=1, keepdims=True)
    unit = unit[unit @ place >= np.sin(mask)]
    if len(unit) < 4:
        return len(unit), np.inf, np.inf
    h = np.hstack([unit, np.ones((len(unit), 1))])
    q = np.diag(np.linalg.inv(h.T @ h))
    return len(unit), np.sqrt(q.sum()), np.sqrt(q[:3].sum())


@pytest.mark.parametrize("count", [1, 5, 130])  # less than a tile of places, and more
def test_kernel_against_numpy(count):
    c = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20428)
    r = positions_mci(c, [1234.0, 40000.0]).transpose(1, 0, 2)
    places = np.random.default_rng(count).normal(size=(count, 3))
    places /= np.linalg.norm(places, axis=1, keepdims=True)
    for mask in (0.0, 0.15):
        fold, gdop, pdop = dops(r, places, mask)
        for t in range(2):
            for q in range(count):
                expected = plain_dops(r[t], places[q], mask)
                assert fold[t, q] == expected[0]
                assert (gdop[t, q], pdop[t, q]) == pytest.approx(expected[1:], rel=1e-7)


def test_singular_geometry_is_infinite():
    # four lines of sight on one cone about the vertical
    turn = np.radians([0, 90, 180, 270])
    up = np.array([0.0, 0.0, 1.0])
    r = R * up + 1e7 * np.stack([np.cos(turn), np.sin(turn), np.ones(4)], axis=1)
    fold, gdop, pdop = dops(r[np.newaxis], up[np.newaxis], 0.0)
    assert (fold[0, 0], gdop[0, 0], pdop[0, 0]) == (4, np.inf, np.inf)
