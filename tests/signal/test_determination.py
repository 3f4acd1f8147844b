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
from compass.orbits.forces import ForceModel
from compass.orbits.gravity import built_in_field, built_in_sigmas
from compass.orbits.motion import Motion
from compass.orbits.states import from_states
from compass.orbits.trajectory import integrate
from compass.orbits.transition import driven, gradient, transitions, turned_quadrupole
from compass.ranging import Signal
from compass.signal.determination import clock_noise, determine_orbits, implied_signal
from compass.signal.links import clear_of, measurement_rows
from compass.signal.ranges import radial_along_cross
from compass.signal.unknown_forces import DEGREE, field_variances, pushes_along
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


def arc(sense, bias=0.0, position=0.0, gravity=0.0):
    """Two satellites, stations, crosslinks, Doppler; all that `follow` takes and its covariance."""
    d = design(2, 2)
    tracking = Tracking(
        stations=Tracker(range=1.0, doppler=1e-4, bias=bias, time=2.0, position=position),
        crosslinks=Tracker(range=1.5, time=1.0), process_noise=0.0, considered=sense,
        step=1800.0, duration=43200.0, radiation=0.3, gravity=gravity,
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
    small, drive = transitions(g, h), driven(g, pushes_along(d, d.motion, halves, r), h)
    rows = measurement_rows(d, tracking, times, r[:, ::2], v[:, ::2])
    size, fields = STATES * c.size, field_variances(tracking.gravity)
    variances = np.concatenate([rows.considered, fields])
    whole, stack, considered = np.eye(size), [], []
    pushed = np.zeros((size, len(variances)))  # what is considered has done to the states by then
    for t in range(steps + 1):
        if t:
            step = np.zeros((size, size))
            for s in range(c.size):
                at = STATES * s
                step[at : at + 6, at : at + 6] = small[s, t - 1]
                step[at + 6 : at + 8, at + 6 : at + 8] = [[1, h], [0, 1]]
                step[at : at + 6, at + 8], step[at + 8, at + 8] = drive[s, t - 1, :, 0], 1.0
            whole, pushed = step @ whole, step @ pushed
            for s in range(c.size):
                pushed[STATES * s : STATES * s + 6, -len(fields) :] += drive[s, t - 1, :, 1:]
        for m in range(rows.first[t], rows.first[t + 1]):
            dense = np.zeros(size + len(variances))
            for column, value in zip(rows.columns[m], rows.values[m], strict=True):
                if column >= 0:
                    dense[column] += value
            dense /= np.sqrt(rows.variances[m])
            stack.append(dense[:size] @ whole)
            considered.append(dense[size:] + dense[:size] @ pushed)
    one = [tracking.prior] * 3 + [tracking.prior_speed] * 3 + [tracking.prior_clock]
    prior = np.tile([*one, SPEED_OF_LIGHT.value * 1e-10, tracking.radiation], c.size)
    root = np.linalg.qr(np.vstack([np.diag(1 / prior), stack]), mode="r")
    inverse = np.linalg.inv(root)
    p = inverse @ inverse.T
    # an estimate's error is what is considered does to it, less what it does to the truth
    gain = whole @ -p @ np.array(stack).T @ np.array(considered) + pushed
    known = whole @ p @ whole.T
    return known, known + gain @ np.diag(variances) @ gain.T


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


@pytest.mark.parametrize(
    "off",
    [{"bias": 5.0}, {"position": 10.0}, {"gravity": 3e4}, {"bias": 2.0, "gravity": 1e4}],
    ids=" and ".join,
)
def test_blind_to_what_is_considered_is_the_classical_consider_batch(off):
    d, tracking, blind = arc("blind", **off)
    _, expected = batch(d, tracking)
    found = sum(np.trace(blind.covariance[-1, s, :3, :3]) for s in range(2))
    assert found == pytest.approx(position_trace(expected), rel=1e-6)
    # knowing the sigma can only help the gain, and both are worse than no bias at all
    schmidt, none = arc("schmidt", **off)[2], arc("schmidt")[2]
    traces = [np.trace(x.covariance[-1, :, :3, :3].sum(axis=0)) for x in (none, schmidt, blind)]
    assert traces[0] < traces[1] <= traces[2]


def moved_by(forces, r0, v0, times):
    """Places and velocities of satellites under forces, integrated, (n, t, 3) each."""
    names = tuple(map(str, range(len(r0))))
    path = integrate(r0, v0, forces, float(times[-1]), epoch=0.0, satellite_names=names)
    return path.states(times)


def changed(forces, radiation, gm, coefficients):
    """Forces with sunlight's scale, GM (relative) and coefficients of the field changed by these."""
    field = forces.field
    c, s = field.c.copy(), field.s.copy()
    for (kind, n, m, _), change in zip(built_in_sigmas(DEGREE), coefficients, strict=True):
        (c if kind == "C" else s)[n, m] += change
    other = replace(field, gm=field.gm * (1 + gm), c=c, s=s)
    return replace(forces, field=other, radiation=forces.radiation * (1 + radiation))


FORCES = ForceModel(field=built_in_field().truncated(DEGREE), radiation=0.5)


def test_what_is_not_known_of_forces_moves_satellites_as_integrated():
    """Each number changed both ways, half a day: degree 3 and the third bodies' gradients apart."""
    d, h, steps = design(2, 2), 1800.0, 24
    c = replace(d.constellation, gm=FORCES.field.gm)
    r0, v0 = (x[:, 0] for x in elliptic(c, np.zeros(1)))
    halves = 0.5 * h * np.arange(2 * steps + 1)
    r, _ = moved_by(FORCES, r0, v0, halves)
    g = gradient(r, turned_quadrupole(built_in_field(), 0.0, halves), FORCES.field.gm)
    unit = pushes_along(d, Motion("numerical", forces=FORCES), halves, r)
    small, drive = transitions(g, h), driven(g, unit, h)
    total = np.zeros((2, 6, unit.shape[-1]))
    for t in range(steps):
        total = small[:, t] @ total + drive[:, t]
    sizes = [0.1, 1e-6] + [1e-7] * (unit.shape[-1] - 2)
    for k, size in enumerate(sizes):
        one = np.zeros(unit.shape[-1])
        one[k] = size
        ends = [
            np.concatenate(moved_by(changed(FORCES, x[0], x[1], x[2:]), r0, v0, halves), axis=-1)
            for x in (one, -one)
        ]
        expected = (ends[0] - ends[1])[:, -1] / (2 * size)
        for part in (slice(0, 3), slice(3, 6)):
            scale = np.abs(expected[:, part]).max()
            np.testing.assert_allclose(total[:, part, k], expected[:, part], atol=3e-3 * scale)


@pytest.mark.slow
def test_estimates_from_drawn_data_scatter_as_the_covariance_says():
    """Least squares on integrated motion, whose field, sunlight and trackers are other than held.

    Ranges of three stations and a link, clocks, places and biases off; slopes are differences of
    what is measured: nothing of the covariance's own is in it. The mean square of whitened errors
    of places and clocks is 1, with a standard error of sqrt(2 / (8 runs)) or somewhat more.
    """
    # of the same phase: satellites that meet at the nodes are linked along no line of sight
    d = design(2, 2)
    c = walker_delta(2, 2, 0, inclination_deg=45, radius_km=20427)
    d = replace(d, constellation=c)
    motion = Motion("numerical", forces=FORCES)
    tracking = Tracking(
        stations=Tracker(range=3.0, bias=2.0, time=3.0, position=1.0), crosslinks=Tracker(range=3.0),
        process_noise=0.0, considered="blind", step=1800.0, duration=43200.0, radiation=0.2,
        gravity=1e3,
    )  # fmt: skip
    c = replace(c, gm=FORCES.field.gm)
    times = tracking.step * np.arange(25)
    angle = prime_meridian_angle(c.epoch, times)
    turned = np.zeros((25, 3, 3))
    turned[:, 0, 0] = turned[:, 1, 1] = np.cos(angle)
    turned[:, 1, 0], turned[:, 0, 1], turned[:, 2, 2] = np.sin(angle), -np.sin(angle), 1
    start = np.concatenate([x[:, 0] for x in elliptic(c, np.zeros(1))], axis=-1)
    sites = np.stack([site.r_mcmf for site in SITES])
    fields = np.sqrt(field_variances(tracking.gravity))

    def paths(x, off):
        """Places, and clocks, of nine numbers a satellite and of errors of the field."""
        both = [
            moved_by(changed(FORCES, one[8], off[0], off[1:]), s[None, :3], s[None, 3:], times)[0]
            for one, s in zip(x, start + x[:, :6], strict=True)
        ]
        return np.concatenate(both), x[:, 6, None] + x[:, 7, None] * times

    def measured(x, off, moved=0.0):
        r, clock = paths(x, off)
        places = np.einsum("tij,kj->kti", turned, sites + moved)
        ranges = np.linalg.norm(r[:, None] - places, axis=-1)
        link = np.linalg.norm(r[1] - r[0], axis=-1)
        return np.concatenate([ranges[seen], clock[:, None].repeat(3, 1)[seen], link[linked]])

    seen, linked = np.ones((2, 3, 25), bool), np.ones(25, bool)
    still, none = np.zeros((2, STATES)), np.zeros(len(fields))
    r = paths(still, none)[0]
    away = r[:, None] - np.einsum("tij,kj->kti", turned, sites)
    up = np.einsum("tij,kj->kti", turned, np.stack([site.enu_mcmf[2] for site in SITES]))
    seen = (away * up).sum(-1) / np.linalg.norm(away, axis=-1) >= np.sin(np.radians(10))
    linked = clear_of(d.figure, r[0], r[1])
    one = [tracking.prior] * 3 + [tracking.prior_speed] * 3 + [tracking.prior_clock]
    prior = np.tile([*one, SPEED_OF_LIGHT.value * 1e-10, tracking.radiation], 2)
    sizes = np.tile([10.0] * 3 + [1e-3] * 3 + [10.0, 1e-3, 0.05], 2)
    slopes = np.stack(
        [
            (measured(s.reshape(2, STATES), none) - measured(-s.reshape(2, STATES), none))
            / (2 * s.sum())
            for s in np.diag(sizes)
        ],
        axis=1,
    )
    normal = np.linalg.inv(slopes.T @ slopes / 9.0 + np.diag(prior**-2.0))
    rng, errors, runs = np.random.default_rng(6), [], 60
    # the same least squares finds the fewest steps that matter: slopes change by 1e-4 over these
    for _ in range(runs):
        truth = 0.1 * prior * rng.standard_normal(prior.size)
        off = fields * rng.standard_normal(len(fields))
        moved = tracking.stations.position * rng.standard_normal((3, 3))
        # a bias of ranges a station, shared by both satellites
        bias = tracking.stations.bias * rng.standard_normal(3)
        extra = np.broadcast_to(bias[None, :, None], seen.shape)[seen]
        heard = measured(truth.reshape(2, STATES), off, moved)
        heard[: extra.size] += extra
        heard += 3.0 * rng.standard_normal(heard.size)
        # what was known before is as wrong as its sigma says
        guess = truth + prior * rng.standard_normal(prior.size)
        found = truth
        for _ in range(2):
            misfit = heard - measured(found.reshape(2, STATES), none)
            found = found + normal @ (slopes.T @ misfit / 9.0 + (guess - found) / prior**2)
        (end, clock), (now, kept) = (
            paths(found.reshape(2, STATES), none), paths(truth.reshape(2, STATES), off)
        )  # fmt: skip
        errors.append(np.column_stack([(end - now)[:, -1], (clock - kept)[:, -1]]))
    claimed = determine_orbits(d, tracking, motion=motion)
    r, v = (x[:, -1] for x in motion.states(d.constellation, times))
    axes = np.zeros((2, 4, 4))
    axes[:, :3, :3], axes[:, 3, 3] = radial_along_cross(r, v), 1.0
    white = np.stack(
        [
            np.linalg.solve(np.linalg.cholesky(p), a @ e)
            for each in errors
            for p, a, e in zip(claimed.covariance[-1], axes, each, strict=True)
        ]
    )
    assert (white**2).mean() == pytest.approx(1.0, abs=4 * np.sqrt(2 / (8 * runs)))
    # and without what is considered or estimated of forces the claim would be far too good
    exact = determine_orbits(d, replace(tracking, radiation=0.0, gravity=0.0), motion=motion)
    assert (claimed.sigma[-1, :, :3] > 1.2 * exact.sigma[-1, :, :3]).any()


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
    rows = measurement_rows(d, tracking, times, r, v)
    counts = rows.counts
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
        for k, satellite in enumerate(satellites):
            own = [w for w in found if w.second == satellite.name]
            spans = [span for w in own for span in w.spans]
            seen = np.any([(times >= a) & (times <= b) for a, b in spans], axis=0)
            assert (rows.tracked[kind][k] != seen).sum() <= 2
    pairs = [(satellites[i], satellites[j]) for i in range(3) for j in range(i + 1, 3)]
    found = windows(pairs, span, figure=d.figure)
    expected = sum(int(((times >= a) & (times <= b)).sum()) for w in found for a, b in w.spans)
    assert abs(counts["crosslinks"] - expected) <= 2


def test_satellites_that_meet_are_not_linked():
    """Two planes half a turn apart, whose satellites meet at the nodes at the epoch."""
    d = design(2, 2)
    links = Tracking(crosslinks=Tracker(range=1.0), duration=43200.0, step=1800.0)
    found = determine_orbits(d, links)
    linked = found.tracked["crosslinks"]
    apart = np.linalg.norm(
        np.diff(d.motion.states(d.constellation, found.times)[0], axis=0)[0], axis=1
    )
    assert apart[0] < 1.0 and not linked[:, 0].any() and linked[:, 1].all()
    assert found.counts["crosslinks"] == (apart >= 1e5).sum() and np.isfinite(found.sigma).all()


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
radiation_sigma = 0.2
gravity_sigmas = 5
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
    assert (t.radiation, t.gravity) == (0.2, 5)
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
        ("earth = { range_m = 1 }\nradiation_sigma = -1", "", "radiation_sigma = -1: must be"),
        ("earth = { range_m = 1 }\ngravity_sigmas = -1", "", "gravity_sigmas = -1: must be"),
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


def test_that_less_tracking_knows_more_is_explained():
    """A second tracker off by a kilometre spoils what one without bias tells a gain blind to it."""
    good = Tracker(range=1.0, time=1.0)
    tracking = Tracking(
        stations=good, earth=replace(good, bias=1e3), considered="blind", duration=10800.0
    )
    said = "better known with less tracking: radial without Earth"
    spoilt = compass.determine(replace(design(3, 3), tracking=tracking), update_h=0.0)
    assert said in " ".join(spoilt.notes()) and "considered and never corrected" in str(spoilt)
    exact = replace(tracking, earth=good)
    whole = compass.determine(replace(design(3, 3), tracking=exact), update_h=0.0)
    assert "better known with less tracking" not in " ".join(whole.notes())


def test_the_command_tells_sigmas_and_writes_the_signal(tmp_path):
    path = tmp_path / "d.toml"
    path.write_text(TEXT.format(text=RICH, more=f"[access]\nearth = true # kept\n{STATION}"))
    found = compass.determine(path, update_h=1.0)
    told = found.to_dict()
    assert set(told["by_tracking"]) >= {"without Earth", "Earth alone"}
    assert told["by_tracking"]["Earth alone"]["clock_sigma_m"] is None
    known = ("were gravity known", "were sunlight's push known", "were trackers without bias")
    assert all(
        told["by_tracking"][name]["along_sigma_m"] <= told["along_sigma_m"] for name in known
    )
    assert "known before to 20 %" in str(found) and "off by 5 of their formal" in str(found)
    assert len(told["per_satellite"]) == 2 and told["predicted"]["hours"] == 1
    assert "What each kind of tracking buys" in str(found)
    found.write(tmp_path / "o.toml")
    again = compass.read_design(tmp_path / "o.toml")
    assert again.signal == found.signal and again.tracking == found.design.tracking
    assert again.access.earth and "# kept" in (tmp_path / "o.toml").read_text()
    assert "[signal]" in replace(found, design=replace(found.design, text="")).design_text()
    assert found.plot().get_legend() is not None
    found.save_plot(tmp_path / "o.png", "schedule")
    assert (tmp_path / "o.png").stat().st_size > 1000
    labels = [line.get_text() for line in found.plot(name="components").get_legend().get_texts()]
    assert labels == ["radial", "along", "cross", "clock"]
    with pytest.raises(ArgumentError, match="allowed tracking, components, schedule"):
        found.plot(name="sigma")
    assert found.dataset.tracked.sel(tracker="earth").sum() == told["measurements"]["earth"] / 2


def test_without_clocks_no_signal_follows(tmp_path):
    read = read_design_text(TEXT.format(text="earth = { range_m = 1 }\nstep_s = 3600", more=""))
    found = compass.determine(read, days=0.2, update_h=0.0)
    assert found.to_dict()["clock_sigma_m"] is None and "nothing measures the clocks" in str(found)
    with pytest.raises(ArgumentError, match=r"no \[signal\] follows"):
        found.write(tmp_path / "x.toml")
    for option, message in (({"days": -1.0}, "days = -1"), ({"update_h": -1.0}, "update_h = -1")):
        with pytest.raises(ArgumentError, match=message):
            compass.determine(read, **option)
