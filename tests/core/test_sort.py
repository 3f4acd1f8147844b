import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compass.core.sort import FEW, sort_together

numbers = st.floats(allow_nan=False)


@given(st.lists(numbers, max_size=FEW) | st.lists(numbers, min_size=FEW + 1, max_size=3 * FEW))
def test_keys_rise_and_what_goes_along_still_does(keys):
    given_keys = np.array(keys)
    sorted_keys, along = given_keys.copy(), np.arange(given_keys.size)
    sort_together(sorted_keys, along, given_keys.size)
    assert np.array_equal(sorted_keys, np.sort(given_keys))
    assert np.array_equal(given_keys[along], sorted_keys)
    assert np.array_equal(np.sort(along), np.arange(along.size))


@pytest.mark.parametrize("count", [0, 1, FEW, FEW + 1, 90])
def test_what_stands_after_them_stays(count):
    keys = np.random.default_rng(1).integers(0, 9, 100).astype(float)
    found, along = keys.copy(), np.arange(100.0)
    sort_together(found, along, count)
    assert np.array_equal(found[:count], np.sort(keys[:count]))
    assert np.array_equal(found[count:], keys[count:])
    assert np.array_equal(along[count:], np.arange(100.0)[count:])
