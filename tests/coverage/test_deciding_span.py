"""The span that decides: against the unreduced period, and the rosettes' trap."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.coverage.certificate import prove_fold
from compass.coverage.margin import covering_radius
from compass.coverage.region import GLOBE, read_region
from compass.coverage.symmetry import MOST_REVOLUTIONS, Span, shortest_span, unlike_subsets
from compass.errors import ArgumentError
from compass.orbits import keplerian, orbital_period, rosette, walker_delta, walker_star
from compass.orbits.symmetry import phase_steps

RADIUS = 2e7
PERIOD = float(orbital_period(RADIUS))
WHOLE = Span(0.0, PERIOD, True, "no symmetry")


def radius_at(constellation, time):
    """Covering radius at one moment."""
    return covering_radius(constellation, 1, span=Span(time, time, False, "")).at_least


@pytest.mark.parametrize(
    ("make", "counts"),
    [
        (walker_delta, (6, 3, 1)),
        (walker_delta, (6, 2, 0)),
        (walker_delta, (8, 4, 2)),
        (walker_delta, (5, 5, 2)),
        (walker_star, (6, 3, 1)),
        (walker_star, (8, 2, 1)),
        (walker_star, (9, 3, 2)),
        (rosette, (8, 8, 6)),
        (rosette, (6, 6, 4)),
    ],
)
def test_every_moment_looks_like_one_in_the_span(make, counts):
    c = make(*counts, inclination_deg=57.3, radius_km=RADIUS / 1e3)
    span = shortest_span(c)
    parts = round(PERIOD / (span.stop - span.start) / 2)
    period, middle = PERIOD / parts, span.start
    for offset in (0.013, 0.21, 0.47):
        first = radius_at(c, middle + offset * period)
        # repeated, and run backwards about the start of the span
        for time in (offset + 1, offset + 2, -offset, 3 - offset):
            assert radius_at(c, middle + time * period) == pytest.approx(first, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    "c",
    [
        walker_delta(12, 3, 1, inclination_deg=51.6, radius_km=RADIUS / 1e3),
        walker_star(8, 2, 1, inclination_deg=85.9, radius_km=RADIUS / 1e3),
        rosette(8, 8, 6, inclination_deg=61.9, radius_km=RADIUS / 1e3),
        rosette(12, 12, 9, inclination_deg=51.6, radius_km=RADIUS / 1e3),
        rosette(12, 3, "1/4", inclination_deg=51.6, radius_km=RADIUS / 1e3),
    ],
    ids=lambda c: c.name,
)
def test_covering_radius_of_the_span_is_that_of_the_period(c):
    short, whole = covering_radius(c, 1), covering_radius(c, 1, span=WHOLE)
    assert short.radius == pytest.approx(whole.radius, abs=1e-6)


@pytest.mark.parametrize(
    ("n", "m", "steps"), [(8, 6, 4), (8, 3, 8), (12, 9, 4), (12, 8, 3), (12, 5, 12), (5, 0, 1)]
)
def test_a_rosette_repeats_after_gcd_steps(n, m, steps):
    c = rosette(n, n, m, inclination_deg=57.3, radius_km=RADIUS / 1e3)
    assert phase_steps(c) == steps


@pytest.mark.parametrize(("n", "m"), [(8, 6), (12, 9)])
def test_one_step_is_not_enough_for_8_and_12(n, m):
    """The trap: 2 pi/N is no period of these, and taking it for one gives wrong radii."""
    c = rosette(n, n, m, inclination_deg=61.9, radius_km=RADIUS / 1e3)
    wrong = Span(0.0, PERIOD / (2 * np.lcm(n, 2)), True, "wrong")
    right = covering_radius(c, 1, span=shortest_span(c)).radius
    assert covering_radius(c, 1, span=wrong).radius < right - 1e-3 or radius_at(
        c, 0.3 * PERIOD / n
    ) != pytest.approx(radius_at(c, 1.3 * PERIOD / n), abs=1e-6)


def test_spans_of_other_constellations():
    no_pattern = walker_delta(6, 3, 1, inclination_deg=57.3, radius_km=RADIUS / 1e3).without([0])
    half = shortest_span(no_pattern)
    # the one that is lost stands on a line of nodes, so what is left runs backwards about it
    assert half.stop - half.start == pytest.approx(PERIOD / 4)
    assert half.for_all_time
    assert radius_at(no_pattern, 1000.0) == pytest.approx(
        radius_at(no_pattern, 1000.0 + PERIOD / 2), abs=1e-12
    )
    ellipse = keplerian(RADIUS, 0.2, 1.0, [0.0, 1.0], 0.0, 0.0)
    assert shortest_span(ellipse).stop == pytest.approx(PERIOD)
    two = keplerian([RADIUS, 1.1 * RADIUS], 0.0, 1.0, [0.0, 1.0], 0.0, 0.0)
    assert not shortest_span(two).for_all_time
    assert shortest_span(two.without([0, 1])) == Span(
        0.0, 0.0, True, "no satellite, nothing changes"
    )


def test_spans_of_regions():
    c = walker_delta(6, 3, 1, inclination_deg=57.3, radius_km=RADIUS / 1e3)
    assert shortest_span(c, read_region("lat:-30:30")) == shortest_span(c, GLOBE)
    north = shortest_span(c, read_region("lat:30:90"))
    assert north.stop == pytest.approx(PERIOD / 6)
    assert north.for_all_time
    assert not shortest_span(c, read_region("polygon:0,0;0,60;50,30")).for_all_time


def test_a_duration_is_taken_as_it_is():
    c = walker_delta(6, 3, 1, inclination_deg=57.3, radius_km=RADIUS / 1e3)
    assert shortest_span(c, duration=100.0).stop == 100.0
    with pytest.raises(ArgumentError, match=r"duration_h = -0\.000277778"):
        shortest_span(c, duration=-1.0)


def test_a_duration_past_what_repeats_decides_for_ever():
    c = walker_delta(6, 3, 1, inclination_deg=57.3, radius_km=RADIUS / 1e3)
    short, whole = shortest_span(c, duration=PERIOD / 6 - 1), shortest_span(c)
    assert (short.for_all_time, short.stop) == (False, PERIOD / 6 - 1)
    for duration in (PERIOD / 6 + 1, 3.6e6, 1e300):
        long = shortest_span(c, duration=duration)
        assert (long.for_all_time, long.start, long.stop) == (True, whole.start, whole.stop)
        assert "reaches past" in long.reason
    ellipse = keplerian(RADIUS, 0.2, 1.0, [0.0, 1.0], 0.0, 0.0)
    assert shortest_span(ellipse, duration=1e9).stop == pytest.approx(PERIOD)


def test_where_nothing_repeats_a_duration_has_an_end():
    two = keplerian([RADIUS, 1.1 * RADIUS], 0.0, 1.0, [0.0, 1.0], 0.0, 0.0)
    most = MOST_REVOLUTIONS * PERIOD
    assert shortest_span(two, duration=most * 0.999).stop == most * 0.999
    with pytest.raises(ArgumentError, match=r"allowed up to .* h, 500 revolutions of the fastest"):
        shortest_span(two, duration=most * 1.001)
    polygon = read_region("polygon:0,0;0,60;50,30")
    c = walker_delta(6, 3, 1, inclination_deg=57.3, radius_km=RADIUS / 1e3)
    with pytest.raises(ArgumentError, match="nothing repeats here"):
        shortest_span(c, polygon, 1e300)


@settings(max_examples=30)
@given(
    st.sampled_from([(6, 3, 1), (8, 4, 2), (9, 3, 2), (5, 5, 2)]),
    st.booleans(),
    st.floats(20, 160),
    st.integers(0, 8),
    st.sampled_from([0.0, 1e-11, 1e-7, 0.05]),
    st.floats(0, 6.28),
    st.randoms(use_true_random=False),
)
@pytest.mark.slow
def test_a_name_decides_nothing(counts, is_star, inclination_deg, which, off, turn, random):
    """What the span decides is what the whole revolution decides, whatever the elements came of.

    One satellite is put out of place, all are turned about the pole and shuffled; the radius that
    is needed over the deciding span is that of the whole period, in which nothing is reduced.
    """
    make = walker_star if is_star else walker_delta
    c = make(*counts, inclination_deg=inclination_deg, radius_km=RADIUS / 1e3)
    anomaly = c.mean_anomaly.copy()
    anomaly[which % c.size] += off
    order = list(range(c.size))
    random.shuffle(order)
    moved = replace(c, mean_anomaly=anomaly)
    mixed = keplerian(RADIUS, 0.0, c.inclination[order], c.raan[order] + turn, 0.0, anomaly[order])
    found = [covering_radius(x, 1, tolerance=1e-3) for x in (moved, mixed)]
    whole = covering_radius(moved, 1, span=WHOLE, tolerance=1e-3)
    for one in found:
        assert one.radius >= whole.at_least - 1e-12
        assert one.at_least <= whole.radius + 1e-12


def test_a_satellite_out_of_place_is_refuted_as_without_a_name():
    """3 degrees on one of fifteen; the pattern's own span would have proven it."""
    c = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
    anomaly = c.mean_anomaly.copy()
    anomaly[0] += np.radians(3)
    moved = replace(c, mean_anomaly=anomaly)
    claim = {"sphere_radius": 3396.2e3, "mask": np.radians(5.736)}
    assert prove_fold(c, 4, **claim).outcome == "proven"
    assert prove_fold(moved, 4, **claim).outcome == "refuted"
    believed = shortest_span(c)
    assert prove_fold(moved, 4, **claim, span=believed).outcome == "proven"


@pytest.mark.parametrize(
    "c",
    [
        walker_delta(6, 3, 1, inclination_deg=57.3, radius_km=RADIUS / 1e3),
        walker_delta(6, 2, 1, inclination_deg=57.3, radius_km=RADIUS / 1e3),
        walker_star(6, 3, 1, inclination_deg=74.5, radius_km=RADIUS / 1e3),
    ],
    ids=lambda c: c.pattern.kind + str(c.pattern.planes),
)
def test_subsets_alike_leave_constellations_alike(c):
    from itertools import combinations

    from compass.coverage.symmetry import _relabellings

    kinds = unlike_subsets(c, 2).sets
    assert sum(kinds.values()) == 15
    moves = _relabellings(c, GLOBE, None)[0].tolist()
    spread = {}
    for pair in combinations(range(6), 2):
        kind = min(tuple(sorted(move[s] for s in pair)) for move in moves)
        left = c.without(pair)
        samples = [radius_at(left, t * PERIOD / 48) for t in range(24)]
        spread.setdefault(kind, []).append(max(samples))
    assert set(spread) == set(kinds)
    for values in spread.values():
        assert np.ptp(values) < 1e-9


def test_satellites_of_a_delta_pattern_are_all_alike():
    c = walker_delta(15, 5, 1, inclination_deg=57.3, radius_km=RADIUS / 1e3)
    assert unlike_subsets(c, 1).sets == {(0,): 15}
    assert len(unlike_subsets(c, 1, read_region("polygon:0,0;0,60;50,30")).sets) == 15


def test_too_many_or_too_few_subsets():
    c = walker_delta(60, 60, 1, inclination_deg=57.3, radius_km=RADIUS / 1e3)
    with pytest.raises(ArgumentError, match="ask for fewer losses"):
        unlike_subsets(c, 5)
    with pytest.raises(ArgumentError, match="losses = 61: allowed 0 to 60"):
        unlike_subsets(c, 61)
