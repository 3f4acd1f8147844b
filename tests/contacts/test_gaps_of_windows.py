"""Statistics of gaps against the same by a fine clock."""

import numpy as np
import pytest

from compass.contacts.gaps import ages, gap_statistics


def test_gaps_are_those_of_a_fine_clock():
    rng = np.random.default_rng(3)
    spans = np.sort(rng.uniform(0, 1000, 24)).reshape(-1, 2)
    found = gap_statistics(spans, 1000.0)
    t = (np.arange(1_000_000) + 0.5) / 1000.0
    inside = ((t[:, None] >= spans[:, 0]) & (t[:, None] < spans[:, 1])).any(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[1], inside, [1]])))
    lengths = (edges[1::2] - edges[::2]) / 1000.0
    assert (found.count, found.cut) == (13, 2) == (len(lengths), 2)
    assert found.share == pytest.approx(inside.mean(), abs=1e-4)
    assert found.longest == pytest.approx(lengths.max(), abs=2e-3)
    assert found.mean == pytest.approx(lengths.mean(), abs=2e-3)
    assert found.p95 == pytest.approx(np.sort(lengths)[12], abs=2e-3)
    later = np.append(spans[:, 0], 1000.0)
    wait = np.where(inside, 0.0, later[np.searchsorted(later, t)] - t)
    assert found.response == pytest.approx(wait.mean(), rel=1e-3)
    old = ages(spans, t)
    earlier = np.where(inside, t, 0.0)
    since = t - np.maximum.accumulate(earlier)
    begun = t >= spans[0, 0]
    assert np.isnan(old[~begun]).all()
    assert np.abs(old - since)[begun].max() < 2e-3
    whole = np.concatenate([t[~begun], old[begun]])  # a span's begin is an end
    assert found.age == pytest.approx(whole.mean(), rel=1e-3)
    assert found.time_average == pytest.approx(2 * found.response)


def test_the_ends_of_a_span_are_ends():
    nothing = gap_statistics(np.empty((0, 2)), 50.0)
    assert (nothing.count, nothing.cut, nothing.share, nothing.longest) == (1, 1, 0.0, 50.0)
    whole = gap_statistics(np.array([[0.0, 50.0]]), 50.0)
    assert (whole.count, whole.longest, whole.mean, whole.p95, whole.response) == (0, 0, 0, 0, 0)
    assert np.isnan(ages(np.empty((0, 2)), np.arange(3.0))).all()
