"""Bounds of percentiles of what was drawn."""

import numpy as np
import pytest

from compass.quantities.draws import (
    mean_of,
    median_bounds,
    percentiles,
    quantile_bounds,
    share_bounds,
)


@pytest.mark.parametrize("draw", [np.random.Generator.normal, np.random.Generator.standard_cauchy])
@pytest.mark.parametrize(("count", "percent"), [(64, 50), (64, 95), (300, 95)])
def test_the_bounds_hold_as_often_as_they_say(draw, count, percent):
    """Of a thousand samples at least 95 in 100, four standard errors off, hold the percentile."""
    rng = np.random.default_rng(5)
    true = {
        np.random.Generator.normal: {50: 0.0, 95: 1.6448536269514722},
        np.random.Generator.standard_cauchy: {50: 0.0, 95: 6.313751514675044},
    }[draw][percent]
    held, short = 0, 0
    for _ in range(1000):
        low, high = quantile_bounds(draw(rng, size=count), percent)
        held += low <= true <= high
        short += np.isfinite(high)
    assert 0.95 - 4 * np.sqrt(0.05 * 0.95 / 1000) <= held / 1000 <= 0.995
    assert short == (1000 if (count, percent) != (64, 95) else 0)


def test_what_no_draw_can_bound_is_infinite():
    found = percentiles(np.arange(4.0))
    assert found["p50"] == 1.0 and found["p95_interval"][1] == np.inf
    assert quantile_bounds(np.arange(4.0), 5)[0] == -np.inf


def test_ranks_by_the_binomial_sums():
    """Of 100 draws the median lies between the 40th and the 61st in 96 of 100 cases (by hand)."""
    assert quantile_bounds(np.arange(1.0, 101.0), 50) == (40.0, 61.0)


def test_bounds_of_a_share_are_where_so_many_would_be_rare():
    from scipy.stats import binom

    for hits, draws in ((3, 10), (0, 7), (7, 7), (40, 90)):
        low, high = share_bounds(hits / draws, draws)
        assert low == 0.0 if hits == 0 else abs(binom.sf(hits - 1, draws, low) - 0.025) < 1e-9
        assert high == 1.0 if hits == draws else abs(binom.cdf(hits, draws, high) - 0.025) < 1e-9
    # they hold in 95 of 100 cases or more, whatever the chance; of 400 draws so many for sure
    rng = np.random.default_rng(2)
    for chance in (0.02, 0.3, 0.9):
        seen = np.array([share_bounds(k / 40, 40) for k in rng.binomial(40, chance, 400)])
        assert ((seen[:, 0] <= chance) & (chance <= seen[:, 1])).mean() > 0.93


def test_bounds_of_a_mean_hold_and_come_near():
    """Of counts by chance the mean is known; a single draw leaves all that is possible."""
    rng, held, width = np.random.default_rng(4), 0, []
    for _ in range(300):
        low, high = mean_of("m", rng.binomial(12, 0.4, 2000), 12)["m_interval"]
        held += low <= 4.8 <= high
        width.append(high - low)
    # of values of one spread the normal law has 2 * 1.96 * sigma / sqrt(n), the bound some more
    assert held >= 285 and max(width) < 2.5 * 3.92 * np.sqrt(12 * 0.24 / 2000)
    assert mean_of("m", np.array([3]), 5) == {"m": 3.0, "m_interval": [0.0, 5.0]}


def counted(rng, entries):
    """Numbers at the moments of entries that hardly change within one, which are of any length."""
    lengths = rng.integers(5, 31, entries)
    level = rng.binomial(8, np.where(lengths > 20, 0.65, 0.4))
    numbers = np.repeat(level, lengths) + rng.integers(-1, 2, lengths.sum())
    return np.bincount(np.clip(numbers, 0, 9), minlength=10), int(lengths.max())


def test_bounds_of_a_median_over_moments_hold_though_those_of_an_entry_are_alike():
    rng = np.random.default_rng(8)
    whole, _ = counted(rng, 400_000)
    share = whole.cumsum() / whole.sum()
    true = int((share < 0.5).sum())
    assert abs(share[true - 1] - 0.5) > 0.01 < abs(share[true] - 0.5)  # it is known for sure
    found = np.array([median_bounds(counts, 100, longest)
                      for counts, longest in (counted(rng, 100) for _ in range(400))])  # fmt: skip
    low, high = found.T
    assert ((low <= true) & (true <= high)).mean() >= 0.95
    assert (high - low).mean() < 3 and low.max() > low.min()
    # as if all moments were independent they would not
    blind = np.array([quantile_bounds(np.repeat(np.arange(10), counts), 50)
                      for counts, _ in (counted(rng, 100) for _ in range(400))])  # fmt: skip
    assert ((blind[:, 0] <= true) & (true <= blind[:, 1])).mean() < 0.9


def test_bounds_of_a_median_of_single_moments_are_those_of_draws():
    for counts in ([3, 0, 40, 57], [0, 0, 100, 0], [10, 45, 3, 42]):
        numbers = np.repeat(np.arange(4.0), counts)
        assert median_bounds(np.array(counts), 100, 1) == quantile_bounds(numbers, 50)
    assert median_bounds(np.array([0, 1, 0, 0, 0]), 1, 1) == (0.0, 4.0)  # all that is possible
