"""Protection levels: the equation solved elsewhere, and faults that are injected."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import norm

import compass
from compass.core.integrity import protect
from compass.coverage.drawn import drawn
from compass.coverage.grid import make_grid
from compass.coverage.protection import LEVELS, SHARES, promise_numbers, protection_map
from compass.coverage.view import view
from compass.design import Design
from compass.errors import ArgumentError, DesignError
from compass.handover.toml import design_toml
from compass.inputs import read_design_text
from compass.integrity import Integrity
from compass.orbits import walker_delta
from compass.quantities.draws import share_bounds
from compass.ranging import Receiver, Signal
from compass.signal.ranges import range_errors
from compass.sites import Mask


def sky(n, seed):
    """Rows east, north, up, clock of n satellites spread over the sky, and their variances."""
    rng = np.random.default_rng(seed)
    azimuth = 2 * np.pi * (np.arange(n) / n + 0.1 * rng.random(n))
    sine = np.linspace(0.15, 0.95, n)[rng.permutation(n)]
    out = np.sqrt(1 - sine**2)
    g = np.stack([-out * np.sin(azimuth), -out * np.cos(azimuth), -sine, np.ones(n)], axis=1)
    return g, rng.uniform(4.0, 60.0, n)


def separations(g, variances):
    """Fix of all ranges and of all but each: estimators (n + 1, 4, n), the first of all."""
    n = len(g)
    found = []
    for left_out in (None, *range(n)):
        w = 1 / variances
        if left_out is not None:
            w = w * (np.arange(n) != left_out)
        found.append(np.linalg.inv(g.T @ (w[:, None] * g)) @ g.T * w)
    return np.array(found)


@pytest.mark.parametrize(("bias", "shared"), [(0.0, 0.0), (0.7, 900.0)])
@pytest.mark.parametrize("n", [5, 8])
def test_levels_solve_the_equation(n, bias, shared):
    """Fixes without one range by leaving it out, the root by Brent's method; to 1e-6 of it.

    An error that all satellites share moves every fix alike and no difference of two.
    """
    g, variances = sky(n, n)
    promise = Integrity(bias=bias)
    numbers, levels = promise_numbers(promise, n), np.empty(3)
    unmonitored = promise.unmonitored(n) / promise.hazard
    assert protect(g, variances, shared, numbers, unmonitored, levels)
    S = separations(g, variances)
    for q, share in enumerate((0.25, 0.25, 0.5)):
        sigma = np.sqrt((S[:, q] ** 2 * variances).sum(axis=1) + (shared if q < 2 else 0.0))
        apart = np.sqrt((((S[1:] - S[0])[:, q]) ** 2 * variances).sum(axis=1))
        threshold = norm.isf(share * promise.alarm / (2 * n)) * apart
        b = np.abs(S[:, q]).sum(axis=1) * bias
        allowed = share * promise.hazard * (1 - unmonitored)

        def excess(level, s=sigma, t=threshold, b=b, allowed=allowed):
            faults = promise.fault * norm.sf((level - t - b[1:]) / s[1:])
            return 2 * norm.sf((level - b[0]) / s[0]) + faults.sum() - allowed

        assert levels[q] == pytest.approx(brentq(excess, 0.0, 1e5), rel=2e-6)


def test_injected_faults_are_missed_no_more_often_than_is_allowed():
    """At 1e-3, the worst bias of each satellite: 20,000 draws see a miss of 1 % to 7 % of itself.

    A miss is an error beyond the level while no test of that direction alarms.
    """
    n, draws = 8, 20_000
    g, variances = sky(n, 3)
    promise = Integrity(hazard=1e-3, fault=2e-3, alarm=1e-2)
    numbers, levels = promise_numbers(promise, n), np.empty(3)
    unmonitored = promise.unmonitored(n) / promise.hazard
    assert protect(g, variances, 0.0, numbers, unmonitored, levels)
    S = separations(g, variances)
    rng = np.random.default_rng(11)
    noise = rng.standard_normal((draws, n)) * np.sqrt(variances)
    for q, share in enumerate((0.25, 0.25, 0.5)):
        rows = S[:, q]
        apart = rows[1:] - rows[0]
        threshold = numbers[5 + q] * np.sqrt((apart**2 * variances).sum(axis=1))
        fix, tests = noise @ rows[0], noise @ apart.T

        def missed(shift, moved, fix=fix, tests=tests, threshold=threshold, q=q):
            quiet = (np.abs(tests + moved) <= threshold).all(axis=1)
            return float(((np.abs(fix + shift) > levels[q]) & quiet).mean())

        risk = missed(0.0, np.zeros(n))
        alarms = (np.abs(tests) > threshold).any(axis=1).mean()
        assert alarms <= share * promise.alarm + 4 * np.sqrt(share * promise.alarm / draws)
        worst = []
        for k in range(n):
            biases = np.linspace(0, 2 * (threshold[k] + levels[q]) / max(abs(rows[0, k]), 1e-3), 25)
            worst.append(max(missed(b * rows[0, k], b * apart[:, k]) for b in biases))
        risk += promise.fault * sum(worst)
        allowed = share * promise.hazard * (1 - unmonitored)
        assert sum(worst) > 0, "no fault was ever missed: nothing is tested"
        assert risk <= allowed * 1.1


def test_a_range_that_the_others_cannot_check_has_no_level():
    """Four ranges in a plane and one out of it, which alone tells what is across."""
    turn = np.linspace(0, 2 * np.pi, 5)[:-1]
    flat = np.stack([np.sin(turn), np.cos(turn), -0.5 * np.ones(4), np.ones(4)], axis=1)
    g = np.vstack([flat, [[0, 0, -1.0, 1]]])
    levels = np.empty(3)
    numbers = promise_numbers(Integrity(), 5)
    assert not protect(g, np.full(5, 9.0), 0.0, numbers, 0.0, levels) and np.isinf(levels).all()
    assert not protect(g[:4], np.full(4, 9.0), 0.0, numbers, 0.0, levels)
    assert not protect(flat[[0, 1, 2, 3, 0]], np.full(5, 9.0), 0.0, numbers, 0.0, levels)
    # where two faults at once use all of the risk up, a fault can be noticed and nothing promised
    g, variances = sky(6, 1)
    assert protect(g, variances, 0.0, numbers, 1.0, levels) and np.isinf(levels).all()


def test_two_faults_at_once():
    """1.0e-7 with five in view and 2.8e-7 with eight, at 1e-4 each."""
    loose = Integrity(hazard=1e-5, fault=1e-4)
    assert loose.unmonitored(5) == pytest.approx(1.0e-7, rel=0.01)
    assert loose.unmonitored(8) == pytest.approx(2.8e-7, rel=0.01)
    p = 0.2
    exact = 1 - (1 - p) ** 7 - 7 * p * (1 - p) ** 6
    assert Integrity(hazard=0.9, fault=p).unmonitored(7) == pytest.approx(exact)
    assert Integrity().unmonitored(1) == 0.0


#: What all satellites have wrong alike about each axis, rad: 3.4 m on the ground.
TURN = 1e-6


def promised(mask=5.0, satellites=15):
    c = walker_delta(satellites, 5, 1, inclination_deg=45, radius_km=20427)
    signal = Signal(
        ephemeris=(2, 8, 5), clock_sigma=3, receiver=Receiver(0.5, 0.5), ionosphere=1.0,
        common_orientation=TURN,
    )  # fmt: skip
    return Design(
        constellation=c, name="d", figure="kelly2018-sphere",
        mask=Mask.constant(np.radians(mask)), signal=signal,
    )  # fmt: skip


def test_the_map_is_what_each_user_gets():
    """Every cell of one epoch from lines of sight written out; single precision."""
    d, times = promised(), [1234.0]
    seen = view(d.constellation, times, d.figure.equatorial_radius, d.mask)
    grid = make_grid("equal-angle", 45)
    ranges = range_errors(d, times)
    promise = Integrity(alert_horizontal=100.0, alert_vertical=200.0)
    made = protection_map(seen, grid, ranges, promise, workers=1)
    numbers = promise_numbers(promise, 15)
    levels, able = np.empty((2, 4, 8)), np.zeros((4, 8))
    for i, latitude in enumerate(grid.latitude):
        for j, longitude in enumerate(grid.longitude):
            up = np.array([np.cos(latitude) * np.cos(longitude),
                           np.cos(latitude) * np.sin(longitude), np.sin(latitude)])  # fmt: skip
            east = np.array([-np.sin(longitude), np.cos(longitude), 0.0])
            away = seen.r[0] - up
            distance = np.linalg.norm(away, axis=1)
            u = away / distance[:, None]
            sine = u @ up
            used = sine >= np.sin(d.mask.lowest)
            g = np.column_stack([-u @ east, -u @ np.cross(up, east), -sine, np.ones(15)])[used]
            q = ranges.forms[0][used]
            turned = np.empty(used.sum())
            for k, (line, form) in enumerate(zip(u[used], q, strict=True)):
                Q = np.array([[form[0], form[3], form[4]], [form[3], form[1], form[5]],
                              [form[4], form[5], form[2]]])  # fmt: skip
                noise = 0.5 + 0.5 / sine[used][k]
                place = 0.5 * (up @ ranges.sun[0] + 1) * (len(ranges.lit) - 1)
                lit = np.interp(place, np.arange(len(ranges.lit)), ranges.lit)
                shell = 1 - ranges.numbers[5] * (1 - sine[used][k] ** 2)
                turned[k] = line @ Q @ line + 2 * form[6:9] @ line + form[9] + noise**2
                turned[k] += ranges.numbers[4] * lit / shell
            found = np.empty(3)
            unmonitored = promise.unmonitored(int(used.sum())) / promise.hazard
            shared = (d.figure.equatorial_radius * TURN) ** 2
            able[i, j] = protect(g, turned, shared, numbers, unmonitored, found)
            levels[:, i, j] = np.hypot(found[0], found[1]), found[2]
    for k, name in enumerate(LEVELS):
        np.testing.assert_allclose(made[name].sel(percentile=50), levels[k], rtol=1e-5)
    np.testing.assert_array_equal(made.detection_share, able)
    both = (levels[0] <= 100) & (levels[1] <= 200)
    np.testing.assert_array_equal(made.protection_share, both)
    weights = np.repeat(grid.cell_share[:, None], 8, axis=1)
    shares = made.cells_protection_share
    assert float(shares.sel(protected="detectable")) == pytest.approx((weights * able).sum())
    assert float(shares.sel(protected="both")) == pytest.approx((weights * both).sum())


DESIGN = """
name = "d"
[constellation]
pattern = "walker-delta"
satellites = {satellites}
planes = {satellites}
phasing = 1
inclination_deg = 50
radius_km = 20427
{signal}
[integrity]
{text}
"""
SIGNAL = "[signal]\nclock_m = 3\nephemeris_m = [2, 8, 5]\nreceiver = { noise_m = 0.5 }\n"


def test_a_design_with_a_promise_is_mapped_and_written(tmp_path):
    text = "p_hmi = 1e-6\np_sat = 1e-5\np_fa = 1e-4\nhorizontal_share = 0.4\nbias_m = 0.1"
    read = read_design_text(DESIGN.format(satellites=12, signal=SIGNAL, text=text))
    assert read.integrity == Integrity(1e-6, 1e-5, 1e-4, 0.4, 0.1)
    assert read_design_text(design_toml(read)).integrity == read.integrity
    found = compass.map(read, step_deg=60, epochs=2, duration_h=2, budget_s=0.01)
    told = found.to_dict()
    assert 0 < told["detection_share"] <= 1
    assert told["protection_vertical_m"]["p50"] is None or told["protection_vertical_m"]["p50"] > 0
    assert "Protection levels, m" in str(found) and "P_HMI 1e-06" in str(found)
    found.save_plot(tmp_path / "p.png", "protection_horizontal_m")


@pytest.mark.parametrize(
    ("satellites", "signal", "text", "message"),
    [
        (4, SIGNAL, "", "integrity: 4 satellites; a fault is noticed with five in view or more"),
        (12, "", "", r"integrity: needs the errors of ranges; add a table \[signal\]"),
        (12, SIGNAL, "p_sat = 1e-4", "two of five satellites fail at once with 1e-07"),
        (12, SIGNAL, "p_hmi = 0.0", "integrity.p_hmi = 0.0: must be above 0"),
        (12, SIGNAL, "p_hm = 1", "integrity.p_hm = 1: unknown key"),
    ],
)
def test_a_wrong_promise_gets_a_message(satellites, signal, text, message):
    with pytest.raises(DesignError, match=message):
        read_design_text(DESIGN.format(satellites=satellites, signal=signal, text=text))


def test_satellites_of_elements_are_counted():
    text = DESIGN.format(satellites=12, signal=SIGNAL, text="")
    head, tail = text.split("[constellation]")
    elements = '[constellation]\npattern = "elements"\n[[constellation.satellite]]\nname = "a"\n'
    elements += "semi_major_axis_km = 20000\ninclination_deg = 0\n[signal]"
    with pytest.raises(DesignError, match="integrity: 1 satellite;"):
        read_design_text(head + elements + tail.split("[signal]")[1])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Integrity(hazard=0.0), "hazard = 0: allowed above 0"),
        (lambda: Integrity(bias=-1.0), "bias_m = -1"),
        (lambda: Integrity(alert_vertical=0.0), "must be above 0"),
        (lambda: Integrity(fault=1e-4), "lower p_sat"),
    ],
)
def test_what_no_promise_can_be(make, message):
    with pytest.raises(ArgumentError, match=message):
        make()


def test_four_satellites_are_too_few_for_a_map():
    c = walker_delta(4, 4, 1, inclination_deg=50, radius_km=20427)
    d = Design(constellation=c, signal=Signal(clock_sigma=1.0))
    seen = view(c, [0.0], d.figure.equatorial_radius, d.mask)
    with pytest.raises(ArgumentError, match="4 satellites; a fault is noticed"):
        protection_map(seen, make_grid("equal-angle", 90), range_errors(d, [0.0]), Integrity())


@pytest.mark.slow
def test_after_a_loss_the_others_are_by_themselves(monkeypatch):
    """By hand: a design without that satellite."""
    text = DESIGN.format(
        satellites=10, signal=SIGNAL, text="alert_horizontal_m = 5e3\nalert_vertical_m = 2e4"
    )
    read = read_design_text(text)
    monkeypatch.setattr("compass.coverage.drawn.DRAWS", 500)
    found = compass.map(read, each_loss=True, step_deg=30, epochs=3, duration_h=5, budget_s=0.01)
    shares = found.dataset.loss_protection_share
    for lost in (0, 4):
        c = read.constellation.without([lost])
        other = drawn(replace(read, constellation=c), (0.0, 18000.0)).protected
        expected = [other[name].mean() for name in SHARES]
        np.testing.assert_allclose(shares.values[lost], expected, atol=1e-12)
    told = found.to_dict()
    both = shares.sel(protected="both").values
    assert told["after_loss"]["protection_share"] == both.min() < told["protection_share"]
    worst = told["after_loss"]["satellite"]
    assert float(shares.sel(lost=worst, protected="both")) == both.min()
    assert f"One faulty satellite after the worst loss, of {worst}" in str(found)
    # bounds of ten losses at once are wider than those of one
    low, high = told["after_loss"]["protection_share_interval"]
    alone = share_bounds(both.min(), 500)
    assert low < alone[0] < both.min() < alone[1] < high
    kept = found.dataset.loss_protection_share_low.sel(lost=worst, protected="both")
    assert float(kept) == low


def test_five_satellites_less_one_notice_nothing():
    found = compass.map(
        read_design_text(DESIGN.format(satellites=5, signal=SIGNAL, text="")),
        each_loss=True, step_deg=60, epochs=2, duration_h=2,
    )  # fmt: skip
    assert found.to_dict()["after_loss"]["detection_share"] == 0.0
    assert "fewer than five satellites are left" in str(found)
    bare = read_design_text(DESIGN.format(satellites=6, signal=SIGNAL, text="").split("[integ")[0])
    with pytest.raises(
        ArgumentError, match=r"each_loss: .* add tables \[signal\] and \[integrity\]"
    ):
        compass.map(bare, each_loss=True, step_deg=60, epochs=2)
