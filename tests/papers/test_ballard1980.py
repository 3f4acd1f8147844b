"""Ballard's tables; every row holds, and the rows that differ differ for the reason given."""

from fractions import Fraction

import numpy as np
import pytest

from compass.coverage.margin import CoveringRadius, covering_radius
from compass.orbits import orbital_period, positions_mci, rosette
from compass.papers import ballard1980 as paper
from compass.papers.ballard1980 import (
    ANY_RADIUS,
    best_rosette,
    polar_network,
    rows,
    smallest_size,
)


def sampled_radius(n, m, inclination_deg, moments=90):
    """Covering radius from a dense grid of places and moments: from below."""
    c = rosette(n, n, m, inclination_deg=inclination_deg, radius_km=ANY_RADIUS / 1e3)
    period = float(orbital_period(ANY_RADIUS))
    r = positions_mci(c, np.linspace(0, period / n, moments)) / ANY_RADIUS
    k = np.arange(40000) + 0.5
    z, turn = 1 - 2 * k / k.size, np.pi * (1 + 5**0.5) * k
    ring = np.sqrt(1 - z * z)
    p = np.stack([ring * np.cos(turn), ring * np.sin(turn), z], axis=1)
    nearest = [(p @ moment.T).max(axis=1).min() for moment in r.transpose(1, 0, 2)]
    return np.degrees(np.arccos(min(nearest)))


@pytest.mark.slow
def test_every_row_holds(every_row_can_fail):
    found = rows()
    every_row_can_fail(found)
    assert [row.item for row in found if not row.holds] == []
    assert sum(row.verdict == "reproduced" for row in found) >= len(found) - 5


@pytest.mark.slow
def test_the_printed_inclination_for_nine_is_not_the_best():
    """The errata by another way: a grid of places instead of triangles."""
    assert sampled_radius(9, 7, 70.30) < sampled_radius(9, 7, 70.70)
    best, covering = best_rosette(9, 9, Fraction(7))
    assert np.degrees(best) == pytest.approx(70.30, abs=0.02)
    assert sampled_radius(9, 7, float(np.degrees(best))) == pytest.approx(
        np.degrees(covering.radius), abs=0.3
    )


@pytest.mark.slow
def test_smallest_sizes_stop_where_told():
    assert smallest_size(1, 4) is None
    assert smallest_size(1, 5) == 5


def test_polar_network_is_the_one_of_table_2():
    c = polar_network(2, 3, np.radians(104.49))
    assert np.degrees(c.raan).tolist() == pytest.approx([0, 0, 0, 104.49, 104.49, 104.49])
    radius = covering_radius(c, 1, tolerance=2e-4).radius
    assert np.degrees(radius) == pytest.approx(66.72, abs=0.02)


def test_rows_compare_what_is_computed(monkeypatch, every_row_can_fail):
    """With the printed numbers in place of computed ones all rows hold; with others they do not."""
    printed = {(n, Fraction(m)): (b, r) for n, _, m, _, _, b, r, _ in paper.TABLE_1}
    shift = 0.0

    def best(n, p, m, fold=1):
        c = rosette(n, p, m, inclination_deg=57.3, radius_km=ANY_RADIUS / 1e3)
        b, r = {3: ("58.56", "84.88"), 4: ("68.38", "85.31"), 2: ("61.81", "75.97")}.get(
            fold
        ) or printed[n, m]
        phase = {n: phases[0] for n, _, _, _, phases, *_ in paper.TABLE_1}.get(n, 0)
        return np.radians(float(b)), CoveringRadius(
            np.radians(float(r) + shift), 0.0, np.radians(phase) / c.mean_motion[0], np.zeros(3)
        )

    radii = {(q * p): float(r) for p, q, r in ((p, q, r) for _, p, q, _, r in paper.TABLE_2)}
    monkeypatch.setattr(paper, "best_rosette", best)
    monkeypatch.setattr(
        paper,
        "covering_radius",
        lambda c, *_, **__: CoveringRadius(np.radians(radii.get(c.size, 0)), 0, 0, np.zeros(3)),
    )
    monkeypatch.setattr(paper, "smallest_size", lambda fold, largest: 2 * fold + 3)
    every_row_can_fail(rows())
    assert {row.verdict for row in rows()} == {"reproduced"}
    shift = 0.02
    monkeypatch.setattr(paper, "smallest_size", lambda fold, largest: None)
    found = {row.item: row for row in rows()}
    assert found["(5, 5, 1): R"].verdict == "differs"
    assert found["(5, 5, 1): lowest altitude for 10 deg elevation"].verdict == "erratum"
    assert not all(row.holds for row in found.values())


def test_pieces_that_the_rows_stand_on(monkeypatch):
    monkeypatch.setattr(paper, "optimal_inclination", lambda *_args, **_options: None)
    assert smallest_size(2, 3) is None
    monkeypatch.setattr(paper, "optimal_inclination", lambda *_args, **_options: 0.76)
    monkeypatch.setattr(paper, "covering_radius", lambda c, fold, tolerance: (c.size, fold))
    assert smallest_size(2, 3) == 1
    assert best_rosette(5, 5, Fraction(1), 2) == (0.76, (5, 2))
