"""Orbit determination as covariance: against a batch written out, and estimates from drawn data."""

from dataclasses import replace

import numpy as np
import pytest

import compass
from compass.bodies import SPEED_OF_LIGHT
from compass.clocks import Clock
from compass.contacts.nodes import earth_node, moon_node, satellite_nodes, station_node
from compass.contacts.windows import windows
from compass.core.determine import STATES, in_turn
from compass.core.gravity import field_acceleration
from compass.design import Design
from compass.errors import ArgumentError, DesignError
from compass.frames import prime_meridian_angle
from compass.handover.toml import design_toml
from compass.inputs import read_design_text
from compass.orbits import walker_delta
from compass.orbits.ellipse import elliptic
from compass.orbits.gravity import built_in_field
from compass.orbits.states import from_states
from compass.orbits.transition import gradient, transitions, turned_quadrupole
from compass.ranging import Signal
from compass.signal.determination import clock_noise, determine_orbits, implied_signal
from compass.signal.links import measurement_rows
from compass.sites import Mask, Site
from compass.tracking import Tracker, Tracking

SITES = tuple(
    Site(name, np.radians(lat), np.radians(lon), mask=Mask.constant(np.radians(10)))
    for name, lat, lon in (("a", 0, 0), ("b", 25, 120), ("c", -25, 240))
)
EARTH = Tracker(range=1.0, bias=2.0, doppler=1e-4)


def design(t=15, p=5, sites=SITES):
    c = walker_delta(t, p, min(1, p - 1), inclination_deg=45, radius_km=20427)
    return Design(constellation=c, name="d", figure="kelly2018-sphere", stations=sites)


# ---- transitions ----


def test_the_gradient_is_the_difference_of_accelerations():
    """Of the field to degree 2 without its C21, S21; differences over 10 m are good to 1e-9."""
    field = built_in_field().truncated(2)
    rng = np.random.default_rng(4)
    places = rng.normal(size=(5, 3))
    places *= 9e6 / np.linalg.norm(places, axis=1)[:, None]
    quadrupoles = turned_quadrupole(field, 0.0, np.array([0.0]))
    found = gradient(places[:, None], quadrupoles, field.gm)[:, 0]
    a = quadrupoles[0]

    def pull(x):
        r = np.linalg.norm(x)
        return field.gm * (-x / r**3 + 2 * a @ x / r**5 - 5 * (x @ a @ x) * x / r**7)

    for x, form in zip(places, found, strict=True):
        steps = np.eye(3) * 10.0
        columns = [(pull(x + s) - pull(x - s)) / 20.0 for s in steps]
        np.testing.assert_allclose(form, np.array(columns).T, rtol=1e-6, atol=1e-15)
    # and the pull is that of the spherical harmonics
    angle = float(prime_meridian_angle(0.0, 0.0) + field.meridian)
    terms = field.terms()
    turned = np.array(
        [[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    x = places[0]
    scale = field.gm / field.radius**2
    harmonics = field_acceleration(*(turned @ x), terms, field.degree + 1, field.radius, scale)
    central = -field.gm * x / np.linalg.norm(x) ** 3
    # C21 and S21 are under a thousandth of J2
    beyond = pull(x) - central
    assert np.linalg.norm(turned.T @ harmonics - beyond) < 1e-3 * np.linalg.norm(beyond)


def test_transitions_carry_small_changes_of_ellipses():
    """Two-body: differences of ellipses over a third of a revolution, to 1e-6."""
    c = design().constellation.without(range(1, 15))
    steps, h = 48, 600.0
    r, v = elliptic(c, 0.5 * h * np.arange(2 * steps + 1))
    found = transitions(gradient(r, np.zeros((2 * steps + 1, 3, 3)), c.gm), h)[0]
    whole = np.linalg.multi_dot(found[::-1])
    for k, size in enumerate([10.0] * 3 + [1e-3] * 3):
        ends = []
        for sign in (1, -1):
            state = np.concatenate([r[:, 0], v[:, 0]], axis=1)
            state[0, k] += sign * size
            moved = from_states(state[:, :3], state[:, 3:], gm=c.gm)
            ends.append(np.concatenate(elliptic(moved, np.array([steps * h])), axis=-1)[0, 0])
        column = (ends[0] - ends[1]) / (2 * size)
        scale = np.array([1.0] * 3 + [7e-5] * 3)
        np.testing.assert_allclose(
            whole[:, k] / scale, column / scale, rtol=2e-5, atol=1e-4 * np.abs(column / scale).max()
        )


# ---- the filter against a batch ----


def arc(sense, bias=0.0):
    """Two satellites, stations, crosslinks, Doppler; all that `follow` takes and its covariance."""
    d = design(2, 2)
    tracking = Tracking(
        stations=Tracker(range=1.0, doppler=1e-4, bias=bias, time=2.0),
        crosslinks=Tracker(range=1.5, time=1.0), process_noise=0.0, considered=sense,
        step=1800.0, duration=43200.0,
    )  # fmt: skip
    return d, tracking, determine_orbits(d, tracking)


def batch(d, tracking):
    """Covariance at the arc's end: square-root information of all rows, mapped to the epoch.

    Returned besides: with the considered numbers ignored, but present.
    """
    c, h = d.constellation, tracking.step
    steps = int(tracking.duration / h)
    times, halves = h * np.arange(steps + 1), 0.5 * h * np.arange(2 * steps + 1)
    r, v = elliptic(c, halves)
    g = gradient(r, turned_quadrupole(built_in_field(), c.epoch, halves), c.gm)
    small = transitions(g, h)
    rows = measurement_rows(d, tracking, times, r[:, ::2], v[:, ::2])
    size = STATES * c.size
    whole, stack, considered = np.eye(size), [], []
    for t in range(steps + 1):
        if t:
            step = np.zeros((size, size))
            for s in range(c.size):
                at = STATES * s
                step[at : at + 6, at : at + 6] = small[s, t - 1]
                step[at + 6 : at + 8, at + 6 : at + 8] = [[1, h], [0, 1]]
            whole = step @ whole
        for m in range(rows.first[t], rows.first[t + 1]):
            dense = np.zeros(size + len(rows.considered))
            for column, value in zip(rows.columns[m], rows.values[m], strict=True):
                if column >= 0:
                    dense[column] += value
            dense /= np.sqrt(rows.variances[m])
            stack.append(dense[:size] @ whole)
            considered.append(dense[size:])
    one = [tracking.prior] * 3 + [tracking.prior_speed] * 3 + [tracking.prior_clock]
    prior = np.tile([*one, SPEED_OF_LIGHT.value * 1e-10], c.size)
    root = np.linalg.qr(np.vstack([np.diag(1 / prior), stack]), mode="r")
    inverse = np.linalg.inv(root)
    p = inverse @ inverse.T
    sensitivity = -p @ np.array(stack).T @ np.array(considered)
    total = p + sensitivity @ np.diag(rows.considered) @ sensitivity.T
    return [whole @ each @ whole.T for each in (p, total)]


def position_trace(p):
    places = [k for s in range(2) for k in range(STATES * s, STATES * s + 3)]
    return p[places, places].sum()


@pytest.mark.parametrize("sense", ["schmidt", "blind"])
def test_without_biases_the_filter_is_the_batch(sense):
    d, tracking, found = arc(sense)
    expected, _ = batch(d, tracking)
    for s in range(2):
        at = STATES * s
        assert np.trace(found.covariance[-1, s, :3, :3]) == pytest.approx(
            np.trace(expected[at : at + 3, at : at + 3]), rel=1e-6
        )
        assert found.covariance[-1, s, 3, 3] == pytest.approx(expected[at + 6, at + 6], rel=1e-6)


def test_blind_to_a_bias_is_the_classical_consider_batch():
    d, tracking, blind = arc("blind", bias=5.0)
    _, expected = batch(d, tracking)
    found = sum(np.trace(blind.covariance[-1, s, :3, :3]) for s in range(2))
    assert found == pytest.approx(position_trace(expected), rel=1e-6)
    # knowing the sigma can only help the gain, and both are worse than no bias at all
    schmidt, none = (arc("schmidt", bias=b)[2] for b in (5.0, 0.0))
    traces = [np.trace(x.covariance[-1, :, :3, :3].sum(axis=0)) for x in (none, schmidt, blind)]
    assert traces[0] < traces[1] <= traces[2]


def test_estimates_from_drawn_data_scatter_as_the_covariance_says():
    """Least squares on Kepler's orbit, ranges of three stations with a bias nobody knows of.

    A hundred runs: a sigma is known to 7 %, the mean square of whitened errors to 6 %.
    """
    c = design(1, 1).constellation
    d = Design(constellation=c, name="one", figure="kelly2018-sphere", stations=SITES)
    tracking = Tracking(
        stations=Tracker(range=3.0, bias=2.0), process_noise=0.0, considered="blind",
        step=1800.0, duration=86400.0,
    )  # fmt: skip
    times = tracking.step * np.arange(49)
    angle = prime_meridian_angle(c.epoch, times)
    r0, v0 = (x[0, 0] for x in elliptic(c, np.zeros(1)))
    turned = np.zeros((49, 3, 3))
    turned[:, 0, 0] = turned[:, 1, 1] = np.cos(angle)
    turned[:, 1, 0], turned[:, 0, 1], turned[:, 2, 2] = np.sin(angle), -np.sin(angle), 1
    places = np.stack([turned @ site.r_mcmf for site in SITES])

    def ranges(state):
        moved = from_states(state[None, :3], state[None, 3:], gm=c.gm)
        return np.linalg.norm(elliptic(moved, times)[0] - places, axis=-1)

    true = np.concatenate([r0, v0])
    away = elliptic(c, times)[0] - places
    up = np.stack([turned @ site.enu_mcmf[2] for site in SITES])
    seen = (away * up).sum(-1) / np.linalg.norm(away, axis=-1) >= np.sin(np.radians(10))
    sizes = np.array([10.0] * 3 + [1e-3] * 3)
    partials = np.stack(
        [(ranges(true + s) - ranges(true - s))[seen] / (2 * s.sum()) for s in np.diag(sizes)],
        axis=1,
    )
    prior = np.array([tracking.prior] * 3 + [tracking.prior_speed] * 3)
    rng, errors = np.random.default_rng(6), []
    normal = np.linalg.inv(partials.T @ partials / 9.0 + np.diag(prior**-2.0))
    for _ in range(100):
        start = true + prior * rng.standard_normal(6)
        heard = ranges(true) + 3 * rng.standard_normal(seen.shape) + 2 * rng.standard_normal((3, 1))
        state = start
        for _ in range(4):
            misfit = (heard - ranges(state))[seen]
            state = state + normal @ (partials.T @ misfit / 9.0 + (start - state) / prior**2)
        end, now = (
            elliptic(from_states(x[None, :3], x[None, 3:], gm=c.gm), times[-1:])[0][0, 0]
            for x in (state, true)
        )
        errors.append(end - now)
    found = determine_orbits(d, tracking, motion=d.motion)
    r, v = (x[0, 0] for x in elliptic(c, times[-1:]))
    radial = r / np.linalg.norm(r)
    cross = np.cross(r, v) / np.linalg.norm(np.cross(r, v))
    local = np.array(errors) @ np.array([radial, np.cross(cross, radial), cross]).T
    root = np.linalg.cholesky(found.covariance[-1, 0, :3, :3])
    white = np.linalg.solve(root, local.T)
    # a bias drawn a station a run: mean square 1 with standard error sqrt(2/300), and J2's part of
    # the transition, which these orbits lack, within some per cent
    assert (white**2).mean() == pytest.approx(1.0, abs=5 * np.sqrt(2 / 300))


# ---- who sees whom ----


@pytest.mark.slow
def test_trackers_see_what_the_windows_say():
    d = design(3, 3)
    tracking = Tracking(
        earth=Tracker(range=1.0), stations=Tracker(range=1.0), moons=Tracker(range=1.0),
        crosslinks=Tracker(range=1.0),
    )  # fmt: skip
    times = 600.0 * np.arange(145)
    r, v = elliptic(d.constellation, times)
    counts = measurement_rows(d, tracking, times, r, v).counts
    span = times[-1]
    satellites = satellite_nodes(d.constellation)
    others = {
        "earth": [earth_node(0.0, span)],
        "stations": [station_node(site, 0.0, span) for site in d.stations],
        "moons": [moon_node(name, 0.0, span) for name in ("phobos", "deimos")],
    }
    for kind, nodes in others.items():
        found = windows([(n, s) for n in nodes for s in satellites], span, figure=d.figure)
        expected = sum(int(((times >= a) & (times <= b)).sum()) for w in found for a, b in w.spans)
        # an epoch within a second of a rise or set may count either way
        assert abs(counts[kind] - expected) <= 2, kind
    pairs = [(satellites[i], satellites[j]) for i in range(3) for j in range(i + 1, 3)]
    found = windows(pairs, span, figure=d.figure)
    expected = sum(int(((times >= a) & (times <= b)).sum()) for w in found for a, b in w.spans)
    assert abs(counts["crosslinks"] - expected) <= 2


def test_in_turn_takes_one_at_a_time_and_everyone():
    busy = np.ones((4, 12), bool)
    busy[2, :6] = False
    chosen = in_turn(busy)
    assert np.all(chosen.sum(axis=0) == 1) and not np.any(chosen & ~busy)
    assert chosen[:, 6:].sum(axis=1).min() >= 1


# ---- what comes of it ----


@pytest.mark.slow
def test_more_tracking_is_better_and_in_turn_costs_what_was_found_elsewhere():
    """One complex on each in turn: 1.4 to 5.7 times, rms; stations bring metres."""
    d = design()
    earth = determine_orbits(d, Tracking(earth=EARTH)).rms[-1]
    turn = determine_orbits(d, Tracking(earth=replace(EARTH, schedule="in-turn"))).rms[-1]
    both = determine_orbits(d, Tracking(earth=EARTH, stations=Tracker(range=1.0))).rms[-1]
    ratio = np.linalg.norm(turn[:3]) / np.linalg.norm(earth[:3])
    assert 1.4 <= ratio <= 5.7
    # of its own values (0.24, 1.27, 0.78 with three stations; 2.9, 231, 435 with the Earth alone)
    # places, epoch and samples are not told: the order of magnitude is
    assert np.all(both[:3] < 3.0) and np.all(both[:3] > 0.05)
    assert 10 < earth[1] < 300 and 20 < earth[2] < 600


def test_crosslinks_leave_the_common_turn():
    """Two-body and no process noise: the turn of all orbits stays as it was known before."""
    d = design(3, 3)
    links = Tracking(crosslinks=Tracker(range=0.1), duration=43200.0, step=1800.0)
    known = determine_orbits(d, Tracking(earth=EARTH, duration=43200.0, step=1800.0))
    alone = determine_orbits(d, links)
    # before: 1000 m in each coordinate at 20,427 km, three satellites
    assert alone.orientation.max() > 0.3 * 1000 / 20.427e6 / np.sqrt(3)
    assert known.orientation.max() < alone.orientation.max()


def test_clock_noise_is_what_the_clock_does():
    """An hour in steps of a minute: clocks with white noise and a walk, variance as of the age."""
    clock = Clock(white=1e-11, walk=1e-15)
    p, step = np.zeros((2, 2)), 60.0
    move = np.array([[1, step], [0, 1]])
    for _ in range(60):
        p = move @ p @ move.T + clock_noise(clock, step)
    assert p[0, 0] == pytest.approx(float(clock.variance(3600.0)), rel=1e-9)
    assert not clock_noise(None, step).any()


def test_the_signal_that_follows_is_the_mean_of_the_last_revolution():
    d = replace(design(2, 2), signal=Signal(clock=Clock(white=1e-11), ephemeris=(1, 1, 1)))
    tracking = Tracking(stations=Tracker(range=1.0, time=1.0), step=1800.0, duration=2 * 86400.0)
    found = determine_orbits(d, tracking, prediction=6 * 3600.0)
    signal = implied_signal(found, d, 6 * 3600.0)
    matrix = np.array(signal.covariance[0])
    recent = found.sigma[found.last - 49 : found.last + 1]
    assert np.diag(matrix) == pytest.approx((recent**2).mean(axis=(0, 1)), rel=0.05)
    assert signal.update == 6 * 3600.0 and signal.clock == d.signal.clock
    assert min(signal.ephemeris_rate) >= 0 and max(signal.ephemeris_rate) > 0


# ---- files and the command ----

TEXT = """
name = "two"
figure = "kelly2018-sphere"
[constellation]
pattern = "walker-delta"
satellites = 2
planes = 2
phasing = 1
inclination_deg = 45
radius_km = 20427
{more}
[tracking]
{text}
"""
STATION = '[[station]]\nname = "a"\nlatitude_deg = 0\nlongitude_deg = 0\n'
RICH = """days = 0.25
step_s = 1800
prior_m = 500
prior_mm_s = 50
prior_clock_m = 300
process_noise_m2_s3 = 1e-15
considered = "blind"
earth = { range_m = 1, doppler_mm_s = 0.1, bias_m = 2, schedule = "in-turn" }
stations = { range_m = 1, time_m = 1, time_bias_m = 0.5, position_m = 0.3, one_way = true }
moons = { range_m = 5 }
crosslinks = { range_m = 1, doppler_mm_s = 0.1, time_m = 1, schedule = "in-turn" }
"""


def test_every_key_reaches_the_tracking_and_is_written_again():
    made = read_design_text(TEXT.format(text=RICH, more=STATION))
    t = made.tracking
    assert (t.duration, t.step, t.prior_speed, t.considered) == (21600, 1800, 0.05, "blind")
    assert t.earth == Tracker(1, 1e-4, None, 2, schedule="in-turn")
    assert t.stations == Tracker(1, None, 1, 0, 0.5, 0.3, True)
    assert read_design_text(design_toml(made)).tracking == t


@pytest.mark.parametrize(
    ("text", "more", "message"),
    [
        ("", "", "tracking: nobody tracks; give one of earth, stations, moons, crosslinks"),
        ("earth = {}", "", "tracking.earth: measures nothing"),
        ("earth = { range_m = -1 }", "", "tracking.earth.range_m = -1: must be above 0"),
        ("earth = { range_m = 1, bias_m = -1 }", "", "bias_m = -1: must be at least 0"),
        ("stations = { range_m = 1 }", "", r"the design has none; add a \[\[station\]\]"),
        ("earth = { range_m = 1 }\ndays = 900\nstep_s = 60", "", "1.296e.06 steps in 900 days"),
        ("crosslinks = { range_m = 1, one_way = true }", "", "links are two-way"),
        ("crosslinks = { range_m = 1, position_m = 1 }", "", "satellites are estimated"),
        ("earth = { range = 1 }", "", "tracking.earth.range = 1: unknown key"),
    ],
)
def test_a_wrong_table_gets_a_message(text, more, message):
    with pytest.raises(DesignError, match=message):
        read_design_text(TEXT.format(text=text, more=more))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Tracker(), "measures nothing"),
        (lambda: Tracker(range=-1.0), "must be above 0"),
        (lambda: Tracker(range=1.0, bias=-1.0), "must be 0 or more"),
        (lambda: Tracker(range=1.0, schedule="never"), "schedule = 'never'"),
        (lambda: Tracking(), "nobody tracks"),
        (lambda: Tracking(earth=EARTH, step=0.0), "step_s = 0"),
        (lambda: Tracking(earth=EARTH, step=0.1), "allowed 100000"),
        (lambda: Tracking(earth=EARTH, prior=0.0), "prior = 0"),
        (lambda: Tracking(earth=EARTH, considered="no"), "considered = 'no'"),
        (lambda: Tracking(earth=EARTH, process_noise=-1.0), "process_noise = -1"),
        (lambda: determine_orbits(design()), r"add a table \[tracking\]"),
        (
            lambda: determine_orbits(design(), Tracking(crosslinks=EARTH, step=10.0, duration=9e5)),
            "would take .* GB",
        ),
    ],
)
def test_what_no_tracking_can_be(make, message):
    with pytest.raises(ArgumentError, match=message):
        make()


def test_the_command_tells_sigmas_and_writes_the_signal(tmp_path):
    path = tmp_path / "d.toml"
    path.write_text(TEXT.format(text=RICH, more=f"[access]\nearth = true # kept\n{STATION}"))
    found = compass.determine(path, update_h=1.0)
    told = found.to_dict()
    assert set(told["by_tracking"]) >= {"without earth", "earth alone"}
    assert told["by_tracking"]["earth alone"]["clock_sigma_m"] is None
    assert len(told["per_satellite"]) == 2 and told["predicted"]["hours"] == 1
    assert "What each kind of tracking buys" in str(found)
    found.write(tmp_path / "o.toml")
    again = compass.read_design(tmp_path / "o.toml")
    assert again.signal == found.signal and again.tracking == found.design.tracking
    assert again.access.earth and "# kept" in (tmp_path / "o.toml").read_text()
    assert "[signal]" in replace(found, design=replace(found.design, text="")).design_text()
    assert found.plot().get_legend() is not None
    found.save_plot(tmp_path / "o.png")
    assert (tmp_path / "o.png").stat().st_size > 1000


def test_without_clocks_no_signal_follows(tmp_path):
    read = read_design_text(TEXT.format(text="earth = { range_m = 1 }\nstep_s = 3600", more=""))
    found = compass.determine(read, days=0.2, update_h=0.0)
    assert found.to_dict()["clock_sigma_m"] is None and "nothing measures the clocks" in str(found)
    with pytest.raises(ArgumentError, match=r"no \[signal\] follows"):
        found.write(tmp_path / "x.toml")
    for option, message in (({"days": -1.0}, "days = -1"), ({"update_h": -1.0}, "update_h = -1")):
        with pytest.raises(ArgumentError, match=message):
            compass.determine(read, **option)
