"""Long spans are settled stretch by stretch, which changes no answer and lets others speak."""

import re
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compass.coverage.certificate import prove_fold
from compass.coverage.margin import covering_radius
from compass.coverage.stretches import MOST_PAIRS, between_breaks, check_pairs, revolutions
from compass.coverage.symmetry import Span
from compass.errors import ArgumentError
from compass.orbits import keplerian, orbital_period

R = 3396190.0
#: No two alike, so that no revolution repeats another.
UNLIKE = keplerian([1.1e7, 1.5e7, 2e7], 0.0, [0.4, 1.0, 1.7], [0.0, 2.0, 4.0], 0.0, [0.0, 1.0, 2.0])
TURN = float(orbital_period(1.1e7))


def span(start, stop):
    return Span(start, stop, False, "asked for")


@given(st.floats(0.0, 1e6), st.floats(0.0, 1e6))
def test_revolutions_fill_a_span(start, length):
    found = revolutions(UNLIKE, start, start + length)
    assert (found[0][0], found[-1][1]) == (start, start + length)
    assert all(one[1] == other[0] for one, other in pairwise(found))
    assert max(stop - begin for begin, stop in found) <= TURN * (1 + 1e-9)


@given(st.lists(st.floats(0.0, 10.0), min_size=2, max_size=30, unique=True), st.floats(0.1, 20.0))
def test_inner_ends_are_breaks(breaks, longest):
    breaks = np.sort(breaks)
    found = between_breaks(breaks, breaks[0], breaks[-1], longest)
    ends = [end for stretch in found for end in stretch]
    assert (ends[0], ends[-1]) == (breaks[0], breaks[-1])
    assert set(ends) <= set(breaks.tolist())
    assert all(a < b for a, b in found)


def test_the_covering_radius_is_the_greatest_of_all_revolutions():
    parts = revolutions(UNLIKE, 0.0, 2.5 * TURN)
    alone = [covering_radius(UNLIKE, 1, span=span(*part), tolerance=1e-3) for part in parts]
    found = covering_radius(UNLIKE, 1, span=span(0.0, 2.5 * TURN), tolerance=1e-3)
    worst = max(alone, key=lambda one: one.at_least)
    assert worst.at_least - 1e-3 <= found.at_least <= found.radius
    assert found.radius <= max(one.radius for one in alone) + 1e-3
    assert np.ptp([one.at_least for one in alone]) > 0.01  # or the last would do for all


def test_an_interruption_between_two_revolutions_is_heard():
    seen = []

    def watch(parts):
        for part in parts:
            seen.append(part)
            if len(seen) == 2:
                raise KeyboardInterrupt
            yield part

    with pytest.raises(KeyboardInterrupt):
        prove_fold(
            UNLIKE,
            1,
            sphere_radius=R,
            mask=-1.5,
            span=span(0.0, 3 * TURN),
            progress=watch,
        )
    assert seen == revolutions(UNLIKE, 0.0, 3 * TURN)[:2]


@given(st.integers(1, 10_000), st.integers(1, 500))
def test_the_size_that_a_refusal_names_is_the_largest_allowed(satellites, moments):
    if moments * satellites**2 <= MOST_PAIRS:
        check_pairs(satellites, moments)
        return
    with pytest.raises(ArgumentError, match=f"satellites = {satellites}: .* pairs; al") as refused:
        check_pairs(satellites, moments)
    allowed = int(re.search(r"which is (\d+) satellites", str(refused.value))[1])
    check_pairs(allowed, moments)
    with pytest.raises(ArgumentError, match="allowed up to"):
        check_pairs(allowed + 1, moments)


def test_ten_thousand_satellites_are_refused_before_any_work():
    many = keplerian(1e7, 0.0, 1.0, 0.0, 0.0, np.linspace(0.0, 6.28, 10_000))
    began = []
    with pytest.raises(ArgumentError, match="satellites = 10000: a proof compares every two"):
        prove_fold(many, 4, sphere_radius=R, progress=began.append)
    assert not began
