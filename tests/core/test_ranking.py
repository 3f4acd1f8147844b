import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from compass.core.ranking import BINS, add_to_histogram, histogram_quantile, select


@given(arrays(float, st.integers(1, 40), elements=st.floats(0, 10) | st.just(np.inf)), st.data())
def test_select_equals_sorting(values, data):
    k = data.draw(st.integers(0, values.size - 1))
    assert select(values.copy(), k) == np.sort(values)[k]


@given(st.integers(0, 10**6), st.sampled_from([0.01, 0.3, 0.5, 0.9, 0.99]))
def test_histogram_quantile_is_within_its_stated_error(seed, q):
    # spread over all that dilutions can be: 1/sqrt(10,000) to what counts as singular
    values = np.exp(np.random.default_rng(seed).uniform(np.log(0.01), np.log(4e6), 400))
    histogram = np.zeros(BINS + 1)
    add_to_histogram(values, 0.25, histogram)
    assert histogram.sum() == pytest.approx(100.0)
    exact = np.sort(values)[int(np.ceil(q * 400)) - 1]
    assert histogram_quantile(histogram, q) == pytest.approx(exact, rel=4.9e-4)


def test_infinities_count():
    histogram = np.zeros(BINS + 1)
    add_to_histogram(np.array([1.0, 2.0, 3.0, np.inf]), 1.0, histogram)
    assert histogram_quantile(histogram, 0.5) == pytest.approx(2.0, rel=5e-4)
    assert histogram_quantile(histogram, 0.75) == pytest.approx(3.0, rel=5e-4)
    assert histogram_quantile(histogram, 0.8) == np.inf


def test_clamped_and_empty():
    histogram = np.zeros(BINS + 1)
    assert np.isnan(histogram_quantile(histogram, 0.5))
    add_to_histogram(np.array([1e-9, 1e30]), 1.0, histogram)
    assert histogram[0] == 1
    assert histogram[BINS - 1] == 1
