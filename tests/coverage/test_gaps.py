"""Gaps of cells against their history, against events found otherwise, and at the span's ends."""

from itertools import groupby

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.bodies import MARS_ROTATION_RATE
from compass.contacts.nodes import satellite_nodes, station_node
from compass.contacts.spans import any_of, outside
from compass.contacts.windows import windows
from compass.core.gaps import finish_gaps, follow_gaps, new_state
from compass.coverage.count import count_map
from compass.coverage.gaps import (
    GapTrack,
    coverage_gaps,
    gap_epochs,
    next_prime,
    shortest_pass,
)
from compass.coverage.grid import make_grid
from compass.coverage.rows import by_threads
from compass.coverage.view import view
from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.inputs import read_design
from compass.orbits.constellation import Constellation
from compass.sites import Mask, Site
from compass.study.mapping import MapOptions, make_map

R = FIGURES["iau-sphere"].equatorial_radius
COARSE = make_grid("equal-angle", 15)


def circular(radius, inclination, nodes, anomalies, eccentricity=0.0):
    n = len(anomalies)
    full = np.ones(n)
    return Constellation(
        "some", radius * full, eccentricity * full, inclination * full, np.array(nodes) * full,
        0 * full, np.array(anomalies, dtype=float),
        satellite_names=tuple(f"S{k}" for k in range(n)),
    )  # fmt: skip


def by_history(series, fold, ring):
    """Longest, mean and response of one cell's counts, in epochs, from the definition."""
    below = series < fold
    if below.all():
        return np.full(3, np.inf)
    if ring:
        below = np.roll(below, -int(np.argmin(below)))
    runs = [sum(1 for _ in run) for out, run in groupby(below) if out]
    mean = np.mean(runs) if runs else 0.0
    last = runs[-1] if below[-1] and not ring else 0
    seen = sum(r * r for r in runs) - last * last
    return np.array([max(runs, default=0), mean, seen / (2 * (series.size - last))])


@given(
    seed=st.integers(0, 10**6),
    fold=st.integers(1, 3),
    ring=st.booleans(),
    pieces=st.integers(1, 4),
    walled=st.booleans(),
)
@settings(max_examples=25, deadline=None)
def test_following_in_pieces_is_the_history_of_every_cell(seed, fold, ring, pieces, walled):
    rng = np.random.default_rng(seed)
    c = circular(rng.uniform(5e6, 2e7), rng.uniform(0, 3), *rng.uniform(0, 6, (2, 4)))
    mask = Mask((0.0, 2.0), (0.1, 0.5)) if walled else Mask.constant(0.1)
    grid = make_grid("equal-angle", 30)
    times = np.arange(23) * rng.uniform(500, 4000)
    seen = view(c, times, R, mask)
    row = int(rng.integers(grid.rows))
    state, gaps = new_state(grid.columns), np.empty((3, grid.columns))
    lat, lon = grid.latitude[row], grid.longitude
    for part in np.array_split(np.arange(23), pieces):
        follow_gaps(seen.r[part], seen.cos_cap[part], seen.rows(grid)[row], fold, state)
    finish_gaps(state, 23, ring, gaps)
    for j in range(grid.columns):
        site = Site("cell", float(lat), float(lon[j]), mask=mask, figure=FIGURES["iau-sphere"])
        series = np.array([site.sees(r * R).sum() for r in seen.r])
        assert np.allclose(gaps[:, j], by_history(series, fold, ring))


def test_maps_of_gaps_count_what_count_maps_count():
    c = circular(6e6, 0.5, [0, 1, 2], [0, 1, 2])
    track = GapTrack(c, R, span=8 * 3600.0, ring=True, fold=1, epochs=8)
    made = coverage_gaps(track, COARSE)
    # by rows that somebody else does, in blocks
    other = coverage_gaps(track, COARSE, by=by_threads(2, lambda rows: None))
    np.testing.assert_array_equal(made.longest, other.longest)
    counts = count_map(view(c, np.arange(8) * 3600.0, R), COARSE)
    for i, j in np.ndindex(made.longest.shape):
        longest, mean, response = by_history(counts[:, i, j], 1, True) * 3600
        assert made.longest[i, j] == longest
        assert made.mean[i, j] == pytest.approx(mean)
        assert made.response[i, j] == pytest.approx(response)
    assert made.step == 3600 and made.ring


def test_gaps_are_those_of_events_to_a_step(designs):
    """Against windows found by root isolation: two methods that share no code below the orbits."""
    design = read_design(designs / "relay-orbiters.toml")
    c, span = design.constellation, 86400.0
    grid = make_grid("equal-angle", 30)
    track = GapTrack(c, R, span=span, ring=False, fold=1, mask=design.mask)
    found = coverage_gaps(track, grid)
    assert found.step < 60
    for i, j in [(0, 0), (2, 3), (3, 7), (5, 11)]:
        site = Site(
            "cell", float(grid.latitude[i]), float(grid.longitude[j]), mask=design.mask,
            figure=FIGURES["iau-sphere"],
        )  # fmt: skip
        station = station_node(site, c.epoch, span)
        pairs = [(station, node) for node in satellite_nodes(c)]
        seen = any_of([w.spans for w in windows(pairs, span, figure=FIGURES["iau-sphere"])])
        gaps = outside(seen, span)
        lengths = gaps[:, 1] - gaps[:, 0]
        assert found.longest[i, j] == pytest.approx(lengths.max(), abs=2 * found.step)
        # a gap is off by a step at each end, all of them to one side at worst
        last = lengths[-1] if gaps[-1, 1] == span else 0.0
        response = ((lengths**2).sum() - last**2) / (2 * (span - last))
        slack = 4 * found.step * lengths.sum() / (2 * (span - last))
        assert found.response[i, j] == pytest.approx(response, abs=slack + found.step)


@pytest.mark.slow
def test_a_map_at_few_epochs_tells_gaps_as_at_many_and_warns(designs):
    """Gaps taken from 109 epochs were 18.98 h, and 2.54 h the mean wait.

    Joined at the ends of a span that does not repeat, 20,011 epochs made 6.84 h of 6.23.
    """
    import compass

    path = designs / "relay-orbiters.toml"
    made = compass.map(path, step_deg=10, fold=1)
    design = read_design(path)
    span = made.dataset.attrs["period_s"]
    track = GapTrack(design.constellation, R, span, False, 1, design.mask, epochs=20_011)
    fine = coverage_gaps(track, make_grid("equal-angle", 10))
    told, step = made.to_dict(), made.dataset.attrs["gap_step_s"] + fine.step
    assert told["longest_gap_s"] == pytest.approx(float(fine.longest.max()), abs=step)
    assert told["longest_gap_s"] / 3600 == pytest.approx(6.23, abs=0.01)
    assert told["mean_response_time_s"] / 3600 == pytest.approx(
        0.68, abs=0.02
    )  # a month says 0.680
    text = str(made)
    known = f"at cells, at each to {made.dataset.attrs['gap_step_s']:.3g} s"
    rows = [line for line in text.splitlines() if known in line]
    assert len(rows) == 2 and all("±" in row and "not known" not in row for row in rows)
    gaps = ("longest_gap_s", "mean_response_time_s")
    assert all(known in told["evidence"][name] for name in gaps)
    assert "WARNING: the epochs are" in text and "gaps are followed every" in text
    assert "WARNING" not in str(compass.map(designs / "compass-15-5-1.toml", step_deg=30))


def test_a_span_that_does_not_repeat_has_ends():
    """One pass a span: a cell that has it in the middle has a gap at both ends, or one."""
    c = circular(6e6, 0.0, [0.0], [0.0])
    span = 2 * np.pi / (c.mean_motion[0] - MARS_ROTATION_RATE.value)
    cut, joined = (
        coverage_gaps(GapTrack(c, R, float(span), ring, fold=1, epochs=401), COARSE)
        for ring in (False, True)
    )
    assert np.all(cut.longest <= joined.longest)
    both = np.isfinite(cut.longest) & (cut.longest < joined.longest)
    # where a gap lies at both ends, joining makes one of two
    assert both.any()


def test_only_what_is_verified_to_repeat_is_a_ring(designs):
    design = read_design(designs / "compass-15-5-1.toml")
    few = {"step_deg": 30, "epochs": 3}
    assert make_map(design, MapOptions(**few)).dataset.attrs["gap_span_repeats"] == 1
    for more in ({"duration_h": 24.62}, {"motion": "j2"}):
        assert make_map(design, MapOptions(**few, **more)).dataset.attrs["gap_span_repeats"] == 0


def test_epochs_are_chosen_by_the_quickest_pass():
    low, high = circular(4e6, 1.0, [0], [0]), circular(2e7, 1.0, [0], [0])
    quick = shortest_pass(low, R, 0.0)
    # acos(R/r) = 31.9 deg twice, at 14.6 + 173.8 deg/h
    assert quick == pytest.approx(2 * 31.9 / (14.6 + 164.2) * 3600, rel=0.03)
    assert gap_epochs(low, R, Mask(), 86400.0) == next_prime(int(np.ceil(16 * 86400 / quick)))
    assert gap_epochs(high, R, Mask(), 86400.0) == 109
    stretched = circular(8e6, 1.0, [0], [0], 0.5)
    assert shortest_pass(stretched, R, 0.0) < shortest_pass(circular(4e6, 1.0, [0], [0]), R, 0.0)
    assert shortest_pass(low.without([0]), R, 0.0) == np.inf
    assert [next_prime(n) for n in (2, 4, 109, 110)] == [2, 5, 109, 113]


def test_a_fold_below_one_is_told():
    with pytest.raises(ArgumentError, match="fold = 0: must be a whole number from 1"):
        GapTrack(circular(2e7, 0, [0], [0]), R, span=1.0, ring=False, fold=0)
