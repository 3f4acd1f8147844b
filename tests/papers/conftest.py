"""What every row of every paper must stand: other numbers, another verdict."""

from dataclasses import replace
from itertools import permutations, product

import pytest

from compass.papers.verdict import Verdict

NAN = float("nan")
AGREES = {Verdict.REPRODUCED, Verdict.FITTED}


def other_numbers(row):
    """Finite numbers that might have been found instead."""
    found = row.found
    n = len(found)
    yield from (tuple(range(1, n + 1)), tuple(range(n, 0, -1)))
    for k in (-1.0, 0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 7.0, 13.0, 15.0, 241.0, 251.0, 301.0, 1e4, 1e30):
        yield (k,) * n
        yield from ((*found[:i], k, *found[i + 1 :]) for i in range(n))
    for factor in (-1.0, 0.01, 0.1, 0.5, 0.9, 1.1, 2.0, 10.0, 100.0, 1e6, 1e12):
        yield from ((*found[:i], factor * found[i], *found[i + 1 :]) for i in range(n))
    if n <= 4:
        yield from permutations(found)
    else:
        yield from product((0.0, 1.0), repeat=n)


def check_row(row):
    if row.published is None:
        assert row.verdict is Verdict.COMPUTED
        return
    lost = replace(row, found=(NAN,) * len(row.found))
    assert lost.verdict is Verdict.DIFFERS, f"{row.item}: holds of nothing found"
    verdicts = {replace(row, found=found).verdict for found in other_numbers(row)}
    made = row.erratum.makes if row.erratum else None
    if made is None and row.holds:
        assert len(verdicts | {row.verdict}) > 1, f"{row.item}: one verdict for all numbers"
    if row.tolerance is None:
        assert verdicts & AGREES or row.verdict in AGREES, f"{row.item}: cannot agree"
        return
    exact = replace(row, found=(float(row.published),))
    assert exact.verdict in AGREES, f"{row.item}: cannot agree"
    if row.erratum is None or made is not None:
        far = 3 * row.tolerance + 2 * max(abs(row.found[0]), abs(made or 0.0))
        moved = replace(row, published=f"{far:.17g}")
        assert moved.verdict is Verdict.DIFFERS, f"{row.item}: holds of another published number"


@pytest.fixture
def every_row_can_fail():
    """Check of rows: each can agree and differ, and none holds of nothing or of another number."""

    def check(rows):
        assert rows
        items = [row.item for row in rows]
        assert len(set(items)) == len(items)
        for row in rows:
            check_row(row)

    return check
