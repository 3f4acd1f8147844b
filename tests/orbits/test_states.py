"""Elements from states: the way back from every kind of ellipse."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.errors import ArgumentError
from compass.orbits import keplerian, states_mci
from compass.orbits.states import from_states


@settings(deadline=None, max_examples=80)
@given(
    st.floats(3.5e6, 3e7),
    st.sampled_from([0.0, 0.01, 0.3, 0.8]),
    st.sampled_from([0.0, 0.4, np.pi / 2, 2.5, np.pi]),
    st.floats(0, 6.2),
    st.floats(0, 6.2),
    st.floats(0, 6.2),
)
def test_states_survive_the_round_trip(a, e, i, node, argument, anomaly):
    times = [0.0, 1000.0]
    r, v = states_mci(keplerian(a, e, i, node, argument, anomaly), times)
    again = from_states(r[:, 0], v[:, 0])
    r2, v2 = states_mci(again, times)
    np.testing.assert_allclose(r2, r, atol=1e-7 * a)
    np.testing.assert_allclose(v2, v, atol=1e-7 * np.abs(v).max())


@pytest.mark.parametrize("velocity", [[0, 9000, 0], [100.0, 0, 0], [0, 0, 0], [np.nan, 0, 0]])
def test_what_is_no_ellipse_is_refused(velocity):
    with pytest.raises(ArgumentError, match=r"state 1: .* is not on an ellipse about Mars"):
        from_states([[4e6, 0, 0]], [velocity])
