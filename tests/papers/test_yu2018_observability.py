"""Approximate observability matrices of the chapter: check values, and which orders they keep."""

import numpy as np
import pytest

from compass.core.entry.observe import lie_gradients
from compass.core.papers.yu2018_observability import (
    LINEAR,
    PUBLISHED_QUADRATIC,
    QUADRATIC,
    approximate_matrix,
)
from compass.entry.observability import whole_path
from compass.entry.views import spherical_jacobian
from compass.papers import yu2018_case as paper
from compass.papers.spherical import spherical_parameters
from compass.papers.yu2018_observability import approximate_degree


@pytest.mark.parametrize(
    ("method", "degree"),
    [
        ("published-quadratic", 1.085367795e-7),
        ("quadratic", 1.085372509e-7),
        ("linear", 1.085809487e-7),
    ],
)
def test_approximations_at_60_s(method, degree):
    states = paper.ground_flight().states[60:61]
    found = approximate_degree(paper.model(), states, paper.ground_beacons(), method)
    assert found[0] == pytest.approx(degree, rel=1e-9)


def test_approximate_matrices_share_the_first_orders():
    """Orders 0 and 1 agree to rounding; the quadratic keeps more of order 2 than the linear."""
    model, flight = paper.model(), paper.ground_flight()
    r = np.ascontiguousarray(paper.ground_beacons().r[60])
    on, off, lie = np.ones(3, bool), np.zeros(3, bool), np.empty(36)
    gradients, found = np.empty((36, 6)), np.empty((18, 6))
    lie_gradients(
        whole_path(model, flight.states[60]), model.flight_parameters(), 0.0, r, np.zeros((3, 3)),
        off, on, off, 6, gradients, lie,
    )  # fmt: skip
    exact = gradients[::2] @ spherical_jacobian(flight.path[60])
    state, p = flight.states[60], spherical_parameters(model)
    for method, good in ((QUADRATIC, 2), (PUBLISHED_QUADRATIC, 2), (LINEAR, 1)):
        approximate_matrix(state, p, r, 6, method, found)
        rows = slice(0, 3 * good)
        scale = np.abs(exact[rows]).max(axis=0) + 1e-300
        np.testing.assert_allclose(found[rows] / scale, exact[rows] / scale, atol=1e-9)
        assert not np.allclose(found[6:9], exact[6:9], rtol=1e-3)
