"""Every kind of measurement: rows against differences, turned about, and what it is worth."""

from dataclasses import replace

import numpy as np
import pytest

from compass.core.entry.kinds import ACCELERATION, BEARING, ECHO, HEIGHT, RANGE
from compass.core.entry.measure import BIAS, CLOCK, FRAME, PLACES, ideal_values, measured
from compass.entry.beacons import Beacons
from compass.entry.consistency import consistency
from compass.entry.covariance import axes_covariance, linear_covariance
from compass.entry.filters import Filter
from compass.entry.instruments import KINDS, Features, Instrument
from compass.entry.layout import Layout, Part
from compass.entry.link import Link
from compass.entry.navigation import run_monte_carlo
from compass.entry.radio import STAGNATION, critical_density
from compass.entry.schedule import Measurements
from compass.entry.trajectory import fly
from compass.entry.views import cartesian_of, spherical_of
from compass.errors import ArgumentError
from compass.links import Radio
from compass.ranging import Receiver
from tests.entry.one_run import run_filter

PRIOR = axes_covariance(1000.0, 0.5)
PARTS = (
    Part("air", (0.1,)),
    Part("lift", (0.01,)),
    Part("clock", (30.0, 0.1)),
    Part("bias", (10.0,)),
    Part("imu", (1e-2,) * 3),
    Part("attitude", (1e-3,) * 3),
    Part("gyro", (1e-6,) * 3, walk=1e-5),
)
LAYOUT = Layout((*PARTS, Part("frame", (1e-3,) * 3, told=(False, True))), 2)
NUMBERS = range(ACCELERATION + 3)
BANK = 0.7


@pytest.mark.parametrize("kind", NUMBERS)
def test_rows_are_the_derivatives_of_what_is_predicted(kind, world):
    """Against central differences at a state with clocks, biases and turned axes, 30 km up.

    The source's frame is turned too.
    """
    rng, p = np.random.default_rng(kind), world().flight_parameters()
    up = rng.normal(size=3)
    x = np.concatenate(
        [
            3.43e6 * up / np.linalg.norm(up),
            rng.normal(size=3) * 3e3,
            rng.normal(size=LAYOUT.size - 6),
        ]
    )
    x[6:8] *= 0.1
    x[-9:] *= 1e-3
    source = np.concatenate([rng.normal(size=3) * 2e7, rng.normal(size=3) * 1e3])
    places, row = LAYOUT.numbers(), np.zeros(LAYOUT.size)

    def value(state):
        return measured(kind, state, source, 1, places, p, BANK, np.zeros(state.size))

    assert measured(kind, x, source, 1, places, p, BANK, row) == value(x)
    for j in range(x.size):
        step = [1.0, 0.01, 1e-3][0 if j < 3 else 1 if j < 6 else 2]
        up, down = x.copy(), x.copy()
        up[j] += step
        down[j] -= step
        found = (value(up) - value(down)) / (2 * step)
        # a value of size V is rounded by 1e-16 V, its slope by that over the step
        rounding = 1e-15 * abs(value(x)) / step
        assert found == pytest.approx(row[j], rel=1e-6, abs=1e-9 * abs(row).max() + rounding)


def test_what_enters_a_kind_and_what_does_not(world):
    """No clock both ways; biases of ranges alone; height over the centre."""
    places = LAYOUT.numbers()
    x, source = np.arange(1.0, LAYOUT.size + 1), np.zeros(6)
    rows = {kind: np.zeros(LAYOUT.size) for kind in NUMBERS}
    p = world().flight_parameters()
    values = {
        kind: measured(kind, x, source, 0, places, p, BANK, rows[kind])
        for kind in NUMBERS
        if kind < ACCELERATION
    }
    assert rows[RANGE][places[CLOCK]] == 1.0 and rows[ECHO][places[CLOCK]] == 0.0
    assert rows[RANGE][places[BIAS]] == rows[ECHO][places[BIAS]] == 1.0
    assert values[RANGE] - values[ECHO] == pytest.approx(x[places[CLOCK]])
    assert values[HEIGHT] == pytest.approx(np.sqrt(14.0))
    # the other beacon is told in a frame that may be turned, this one is not
    at = places[FRAME]
    assert not any(row[at : at + 3].any() for row in rows.values())
    assert len(places) == PLACES + 2 and LAYOUT.estimated == LAYOUT.size


@pytest.fixture(scope="module")
def case(world, table5, orbiter_beacons):
    """Epochs 24 s apart on a planet at rest, and features under the flight."""
    fine, model = orbiter_beacons(0.0), world("none")
    beacons = Beacons(fine.names, fine.times[::24], fine.r[::24], fine.v[::24], fine.moving)
    flight = fly(model, table5, beacons.times)
    lon, lat = flight.states[::3, 1], flight.states[::3, 2] + 0.01
    features = Features(tuple("abcd"), tuple(lat), tuple(lon), (0.0, 1e3, -2e3, 0.0))
    return model, flight, beacons, features


def everything(features, **changes):
    kinds = (
        Instrument("two_way_range", 5.0),
        Instrument("two_way_rate", 0.01),
        Instrument("altimeter", 10.0, share=0.01, below=40e3),
        Instrument("velocimeter", 0.2, share=0.001, interval=48.0),
        Instrument("features", 1e-3),
        Instrument("accelerometers", 0.1),
    )
    return Measurements(50.0, 0.1, instruments=kinds, features=features, **changes)


def test_all_kinds_turn_with_the_problem(case):
    """On a sphere at rest any rotation of flight, beacons and features changes no sigma."""
    model, flight, beacons, features = case
    rotation, _ = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))
    rotation *= np.sign(np.linalg.det(rotation))
    turned = Beacons(
        beacons.names, beacons.times, beacons.r @ rotation.T, beacons.v @ rotation.T, beacons.moving
    )
    places = features.places(model.planet_radius) @ rotation.T
    size = np.linalg.norm(places, axis=1)
    moved = Features(
        features.names,
        tuple(np.arcsin(places[:, 2] / size)),
        tuple(np.arctan2(places[:, 1], places[:, 0])),
        features.height,
    )
    both = np.kron(np.eye(2), rotation)
    start = spherical_of(both @ cartesian_of(flight.states[0, :6]))
    other = fly(model, start, beacons.times)
    layout = Layout(PARTS[4:], beacons.size)
    taken = np.ones((beacons.times.size, beacons.size), bool)
    sigmas = []
    for flown, heard, seen in ((flight, beacons, features), (other, turned, moved)):
        measurements = everything(seen)
        found = linear_covariance(
            model, flown.path, heard, taken, measurements, PRIOR, layout=layout
        )
        sigmas.append([found.position_sigma, found.velocity_sigma])
        _, variances, _ = measurements.heard(heard, taken, flown.path, model)
        count = dict(measurements.readings(variances))
        assert (
            count["velocity over the ground"] == 3 * 6 and 0 < count["height over the sphere"] < 11
        )
        assert 0 < count["directions to surface features"] < 3 * 4 * 11
    np.testing.assert_allclose(sigmas[0], sigmas[1], rtol=1e-7)


def test_every_instrument_is_worth_something(case):
    """Each makes the bound smaller; ranges both ways need no clock."""
    model, flight, beacons, features = case
    whole = everything(features)
    taken = np.ones((beacons.times.size, beacons.size), bool)

    def end(measurements, parts=()):
        layout = Layout(parts, beacons.size)
        run = linear_covariance(
            model, flight.path, beacons, taken, measurements, PRIOR, layout=layout
        )
        return run.position_sigma[-1], run.velocity_sigma[-1]

    plain = end(Measurements(50.0, 0.1))
    for one in whole.instruments:
        alone = end(Measurements(50.0, 0.1, instruments=(one,), features=features))
        assert alone[0] < plain[0] or alone[1] < plain[1]
    # ranges both ways are those of a lander whose clock is known
    clock = (Part("clock", (3e4, 0.3)),)
    two_way = Measurements(None, None, instruments=(Instrument("two_way_range", 50.0),))
    np.testing.assert_allclose(end(two_way, clock), end(Measurements(50.0)), rtol=1e-9)
    assert end(Measurements(50.0), clock)[0] > end(two_way, clock)[0]


def test_biases_are_of_beacons_alone_where_features_are_seen_too(case):
    """A truth without biases asks for none of sources that have no range."""
    model, flight, beacons, features = case
    taken = np.ones((beacons.times.size, beacons.size), bool)
    heard = Measurements(50.0, instruments=(Instrument("features", 1e-3),), features=features)
    settings = Filter(PRIOR, np.zeros(6), parts=(Part("bias", (10.0,)),))
    mc = run_monte_carlo(model, flight, beacons, taken, heard, settings, runs=2)
    assert consistency(mc.nees_all, flight.times, mc.estimated, mc.diverged).holds


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_linear_covariance_is_what_the_filter_reaches(case, seed):
    """Over random choices of instruments, noise, blocks and ways of filtering: one run for many.

    Of 40 runs NEES stays in its interval, and errors at the end are those of the covariance; air
    and lift are known so well that 24 s of flight are linear in them.
    """
    model, flight, beacons, features = case
    rng, whole = np.random.default_rng(seed), everything(features)
    size = np.exp(rng.normal(0.0, 0.5))
    kinds = [one for one in whole.instruments if rng.random() < 0.7]
    own = tuple(replace(one, sigma=one.sigma * size) for one in kinds)
    heard = Measurements(50.0 * size, 0.1 * size, instruments=own, features=features)
    taken = rng.random((beacons.times.size, beacons.size)) < 0.8
    choice = (
        Part("air", (0.002,)), Part("lift", (5e-4,)), Part("clock", (3e4, 0.3)),
        Part("bias", (10.0,)), Part("imu", (0.05,) * 3),
    )  # fmt: skip
    held = (Part("attitude", (1e-3,) * 3), Part("gyro", (1e-5,) * 3, walk=1e-4))
    parts = (*(part for part in choice if rng.random() < 0.6), *held)
    method = ("plain", "square-root", "information")[seed % 3]
    settings = Filter(PRIOR, np.zeros(6), 3, parts, method)
    mc = run_monte_carlo(model, flight, beacons, taken, heard, settings, runs=40, seed=seed)
    assert consistency(mc.nees, flight.times, 6, mc.diverged).holds
    assert consistency(mc.nees_all, flight.times, mc.estimated, mc.diverged).holds
    layout = settings.layout(beacons.size)
    bound = linear_covariance(model, flight.path, beacons, taken, heard, PRIOR, layout=layout)
    # of 40 runs and at least one dominant axis: the variance is good to sqrt(2/40), four sigma
    assert abs((mc.position_rms[-1] / bound.position_sigma[-1]) ** 2 - 1) < 4 * np.sqrt(2 / 40)


def test_a_filter_fed_from_outside_hears_all_kinds(case):
    """Exact readings of every kind along the flight leave the filter on it."""
    model, flight, beacons, features = case
    measurements = everything(features)
    taken = np.ones((beacons.times.size, beacons.size), bool)
    sources, variances, kinds = measurements.heard(beacons, taken, flight.path, model)
    z = np.empty(variances.shape)
    p, bank = model.flight_parameters(), model.vehicle.bank_schedule()
    nothing = Layout().numbers()
    ideal_values(flight.path, sources, kinds, nothing, p, bank, np.array(beacons.times), z)
    settings = Filter(PRIOR, np.zeros(6))
    states, _ = run_filter(model, flight.path[0], beacons, taken, measurements, settings, z)
    assert np.abs(states - flight.path)[:, :3].max() < 0.02  # Runge-Kutta steps of a filter
    # the same by any algebra, of readings with noise and all that may be estimated
    z += np.sqrt(np.nan_to_num(variances)) * np.random.default_rng(1).standard_normal(z.shape)
    found = [
        run_filter(
            model, flight.path[0], beacons, taken, measurements,
            Filter(PRIOR, np.zeros(6), 2, PARTS, method), z,
        )
        for method in ("plain", "information", "square-root")
    ]  # fmt: skip
    for k in range(2):
        sigma = np.sqrt(np.einsum("tii->ti", found[0][1]))
        scale = sigma if k == 0 else sigma[:, :, None] * sigma[:, None, :]
        for other in found[1:]:
            np.testing.assert_allclose(other[k] / scale, found[0][k] / scale, rtol=0, atol=1e-4)


def test_gyros_that_do_not_drift_are_axes_that_stand_still(case):
    """And a drift, or a walk, leaves the axes less well known at the end."""
    model, flight, beacons, features = case
    taken = np.ones((beacons.times.size, beacons.size), bool)
    few = Measurements(
        1e5, features=features,
        instruments=(Instrument("features", 1e-3), Instrument("velocimeter", 1.0)),
    )  # fmt: skip

    def sigma(*parts):
        layout = Layout(parts, beacons.size)
        found = linear_covariance(model, flight.path, beacons, taken, few, PRIOR, layout=layout)
        return found.covariance[-1], layout

    axes = Part("attitude", (5e-3,) * 3)
    still, _ = sigma(axes)
    firm, _ = sigma(axes, Part("gyro", (1e-15,) * 3))
    np.testing.assert_allclose(firm[:9, :9], still, rtol=1e-6)
    loose, layout = sigma(axes, Part("gyro", (1e-4,) * 3))
    at = layout.place("attitude")
    assert np.all(np.diag(loose)[at : at + 3] > 1.2 * np.diag(still)[at : at + 3])
    walking, _ = sigma(axes, Part("gyro", (1e-15,) * 3, walk=1e-3))
    assert np.all(np.diag(walking)[at : at + 3] > 1.2 * np.diag(still)[at : at + 3])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"kind": "sextant"}, "kind = 'sextant': allowed two_way_range"),
        ({"sigma": 0.0}, "altimeter: sigma = 0.0: must be positive"),
        ({"interval": np.inf}, "altimeter: interval = inf: must be positive"),
        ({"share": -0.1}, "altimeter: share = -0.1: must be 0 or more"),
    ],
)
def test_impossible_instruments_are_refused(change, message):
    with pytest.raises(ArgumentError, match=message):
        Instrument(**{"kind": "altimeter", "sigma": 1.0} | change)


def test_records_name_the_kernels_numbers_once():
    numbers = [number for kind in KINDS for number in kind.numbers]
    assert sorted(numbers) == list(range(2, ACCELERATION + 3)) and BEARING in numbers


@pytest.fixture(scope="module")
def make_link():
    def make(**changes):
        radio = Radio(("satellite", "station"), 400e6, 10.0, -25.0, 30.0)
        return Link(radio, Receiver(chip=300.0, spacing=0.5), **changes)

    return make


def test_ranges_are_as_good_as_their_link(case, make_link):
    """By hand: distance, antenna, plasma, loop; and the bound is that of these variances."""
    model, flight, beacons, _ = case
    air, r0, path = model.atmosphere, model.planet_radius, flight.path
    level = make_link().carrier_to_noise(beacons, path, air, r0)
    line = beacons.r[4, 1] - path[4, :3]
    far = np.linalg.norm(line)
    loss = 20 * np.log10(4 * np.pi * far * 400e6 / 299792458.0)
    assert level[4, 1] == pytest.approx(10.0 - loss - 25.0 + 228.599167, abs=1e-6)
    found = make_link().range_variance(beacons, path, air, r0)
    strength = 10 ** (level[4, 1] / 10)
    # Kaplan and Hegarty: chip^2 B D / (2 C/N0) (1 + 2 / (T C/N0 (2 - D)))
    by_hand = 300**2 * 0.5 / (2 * strength) * (1 + 2 / (0.02 * strength * 1.5))
    assert found[4, 1] == pytest.approx(by_hand)
    # half of the power at half of the width off the axis, all of it on the axis, none behind
    for pointing, axis in (("aft", -path[4, 3:]), ("zenith", path[4, :3])):
        narrow = make_link(beamwidth=1.2, pointing=pointing)
        off = np.arccos(line @ axis / far / np.linalg.norm(axis))
        lost = level[4, 1] - narrow.carrier_to_noise(beacons, path, air, r0)[4, 1]
        power = np.log(0.5) / np.log(np.cos(0.6))
        assert lost == pytest.approx(-10 * power * np.log10(max(np.cos(off), 0.0)))
    pin = make_link(beamwidth=1e-9).range_variance(beacons, path, air, r0)
    assert np.isnan(pin).all()  # nobody stands on the axis itself
    # plasma thick enough lets nothing through where it is denser than the critical density
    dark = make_link(electrons=STAGNATION, thickness=5.0)
    missing = np.isnan(dark.range_variance(beacons, path, air, r0)).all(axis=1)
    r, v = np.linalg.norm(path[:, :3], axis=1), np.linalg.norm(path[:, 3:], axis=1)
    assert np.array_equal(missing, STAGNATION(air.density(r), v) > critical_density(400e6))
    assert 0 < missing.sum() < missing.size
    taken = np.ones((beacons.times.size, beacons.size), bool)
    noisy = Measurements(50.0, link=make_link())
    alike = [
        linear_covariance(model, path, beacons, taken, m, PRIOR).position_sigma[-1]
        for m in (Measurements(50.0), noisy, Measurements(float(np.sqrt(2500 + found.max()))))
    ]
    assert alike[0] < alike[1] < alike[2]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"pointing": "nadir"}, "pointing = 'nadir': allowed aft, zenith"),
        ({"beamwidth": 4.0}, "beamwidth = 229.183 deg: allowed above 0"),
        ({"thickness": -1.0}, "thickness = -1 m: must be 0 or more"),
    ],
)
def test_impossible_links_are_refused(make_link, change, message):
    with pytest.raises(ArgumentError, match=message):
        make_link(**change)
