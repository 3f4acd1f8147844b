"""Linear covariance: against a batch, another program in other coordinates, and turned about."""

from dataclasses import replace
from decimal import Decimal, localcontext

import numpy as np
import pytest

from compass.core.entry.flow import advance_transition
from compass.core.entry.kinds import RANGE
from compass.core.entry.measure import PLACES, measured
from compass.core.entry.rates import LIFT, World
from compass.entry.atmosphere import Atmosphere
from compass.entry.beacons import Beacons
from compass.entry.covariance import axes_covariance, linear_covariance, noise_roots
from compass.entry.instruments import Features, Instrument
from compass.entry.layout import Layout, Part, block
from compass.entry.link import Link
from compass.entry.mars_air import PROFILE, WINDS
from compass.entry.model import EntryModel
from compass.entry.radio import WAKE
from compass.entry.schedule import Measurements, in_view
from compass.entry.trajectory import fly
from compass.entry.views import cartesian_of, spherical_jacobian, spherical_of
from compass.errors import ArgumentError
from compass.links import Radio
from compass.papers import yu2018_filter as spherical
from compass.ranging import Receiver
from tests.entry.one_run import ideal_measurements

PRIOR = axes_covariance(1000.0, 0.5)


@pytest.fixture(scope="module")
def case(world, orbiter_flight, orbiter_beacons):
    beacons = orbiter_beacons()
    return world(), orbiter_flight, beacons, np.ones((241, 3), bool)


def test_bound_is_the_information_of_a_batch(case, table5):
    """Without process noise: prior plus all measurements, mapped to the start by differences."""
    model, flight, beacons, every = case
    measurements = Measurements(50.0, 0.05, interval=20.0)
    taken = measurements.taken(every, beacons.times)
    bound = linear_covariance(model, flight.path, beacons, taken, measurements, PRIOR)
    start, columns, final = cartesian_of(table5), [], []
    for j, h in enumerate([10.0] * 3 + [0.01] * 3):
        up, down = (
            fly(model, spherical_of(start + sign * h * np.eye(6)[j]), beacons.times).path
            for sign in (1, -1)
        )
        columns.append(
            (ideal_measurements(up, beacons) - ideal_measurements(down, beacons)) / (2 * h)
        )
        final.append((up[-1] - down[-1]) / (2 * h))
    rows = np.array(columns)[:, taken] / np.array([50.0, 0.05])
    information = np.linalg.inv(PRIOR) + np.einsum("amk,bmk->ab", rows, rows)
    phi = np.array(final).T
    batch = phi @ np.linalg.inv(information) @ phi.T
    scale = np.sqrt(np.outer(np.diag(batch), np.diag(batch)))
    # the differences are good to some 1e-6, the condition number of the problem is about 1e3
    np.testing.assert_allclose(bound.covariance[-1] / scale, batch / scale, atol=2e-3)


@pytest.mark.parametrize("rotation", ["none", "coriolis", "full", "published-coriolis"])
@pytest.mark.parametrize("kind", [(50.0, None), (None, 0.05), (50.0, 0.05)])
def test_it_is_the_bound_of_the_spherical_filter(world, table5, orbiter_beacons, rotation, kind):
    """Another program, on latitude, longitude and angles, with process noise; F turns as J' F J."""
    model = world(rotation, bank_times=(0.0, 100.0), bank_angles=(0.4, -0.6))
    beacons = orbiter_beacons(model.omega)
    flight = fly(model, table5, beacons.times)
    noise = np.array([1.0, 1e-14, 1e-14, 1e-2, 1e-10, 1e-10])
    measurements, every = Measurements(*kind), np.ones((241, 3), bool)
    found = linear_covariance(model, flight.path, beacons, every, measurements, PRIOR, noise)
    other = spherical.cramer_rao_bound(
        model,
        flight.states,
        beacons,
        every,
        measurements,
        spherical.initial_covariance(flight.states[0], 1000.0, 0.5),
        noise,
    )
    jacobian = spherical_jacobian(flight.path)
    turned = jacobian @ other.covariance @ np.swapaxes(jacobian, 1, 2)
    scale = np.sqrt(np.einsum("tii->ti", turned))
    size = scale[:, :, None] * scale[:, None, :]
    # both take one Runge-Kutta step a second, whose errors of fourth order differ between
    # coordinates: some 1e-6 of the covariance
    np.testing.assert_allclose(found.covariance / size, turned / size, atol=1e-5)
    np.testing.assert_allclose(found.position_sigma, other.position_sigma, rtol=1e-6)
    np.testing.assert_allclose(found.velocity_sigma, other.velocity_sigma, rtol=1e-6)


def turned(rotation, flight, beacons, model, start):
    """The same entry with its beacons, turned about Mars's centre."""
    path = np.concatenate([start[:3] @ rotation.T, start[3:] @ rotation.T])
    moved = Beacons(
        beacons.names, beacons.times, beacons.r @ rotation.T, beacons.v @ rotation.T, beacons.moving
    )
    return fly(model, spherical_of(path), flight.times), moved


@pytest.mark.parametrize("seed", range(6))
def test_turning_everything_turns_the_answer(world, table5, orbiter_beacons, seed):
    """Point mass, sphere, no spin: any rotation, poles included, changes nothing but directions."""
    model = world("none", bank_times=(0.0, 60.5), bank_angles=(0.3, -0.8))
    beacons = orbiter_beacons(0.0)
    flight = fly(model, table5, beacons.times)
    start, rng = cartesian_of(table5), np.random.default_rng(seed)
    if seed == 0:  # the middle of the flight straight over the pole
        up = flight.path[120, :3] / np.linalg.norm(flight.path[120, :3])
        east = np.cross([0.0, 0.0, 1.0], up)
        east /= np.linalg.norm(east)
        rotation = np.array([east, np.cross(up, east), up])
    else:
        rotation, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        rotation *= np.sign(np.linalg.det(rotation))
    other, moved = turned(rotation, flight, beacons, model, start)
    both = np.kron(np.eye(2), rotation)
    # a start read as angles is rounded by 1e-15 of 3.5e6 m, which the flight triples
    np.testing.assert_allclose(other.path @ both, flight.path, rtol=0, atol=1e-6)
    measurements, every = Measurements(50.0, 0.1), np.ones((241, 3), bool)
    bounds = [
        linear_covariance(model, f.path, b, every, measurements, PRIOR)
        for f, b in ((flight, beacons), (other, moved))
    ]
    np.testing.assert_allclose(bounds[0].position_sigma, bounds[1].position_sigma, rtol=1e-7)
    np.testing.assert_allclose(bounds[0].velocity_sigma, bounds[1].velocity_sigma, rtol=1e-7)


@pytest.mark.parametrize("angle", [0.7, -2.5])
def test_on_a_turning_planet_turns_about_the_pole_change_nothing(
    world, table5, orbiter_beacons, angle
):
    model, beacons = world("full"), orbiter_beacons()
    flight = fly(model, table5, beacons.times)
    c, s = np.cos(angle), np.sin(angle)
    rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    other, moved = turned(rotation, flight, beacons, model, cartesian_of(table5))
    np.testing.assert_allclose(
        other.path @ np.kron(np.eye(2), rotation), flight.path, rtol=0, atol=1e-6
    )
    every, measurements = np.ones((241, 3), bool), Measurements(50.0)
    one, two = (
        linear_covariance(model, f.path, b, every, measurements, PRIOR).position_sigma
        for f, b in ((flight, beacons), (other, moved))
    )
    np.testing.assert_allclose(one, two, rtol=1e-7)


@pytest.mark.parametrize("about_the_pole", [False, True])
@pytest.mark.parametrize("seed", range(2))
def test_turning_all_sensors_and_airs_turns_the_answer(
    world, table5, orbiter_beacons, about_the_pole, seed
):
    """Link, both ways, height, velocity, sight; clock, axes, bias, wandering air in a table.

    Winds, zonals and spin know the pole, and leave turns about it.
    """
    rng, table = np.random.default_rng(100 + seed), np.array(PROFILE).T
    radius = world().planet_radius
    air = Atmosphere(
        2e-4, 3437.2e3, 7500.0, tuple(radius + 1e3 * table[0]), tuple(table[1]),
        winds=tuple((radius + 1e3 * km, east, north) for km, east, north in WINDS)
        if about_the_pole else (),
    )  # fmt: skip
    model = replace(
        world("full" if about_the_pole else "none", bank_times=(0.0, 70.5), bank_angles=(1, -0.6)),
        atmosphere=air, j2=1.96e-3 * about_the_pole,
    )  # fmt: skip
    if about_the_pole:
        c, s = np.cos(2.0 + seed), np.sin(2.0 + seed)
        rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    else:
        rotation, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        rotation *= np.sign(np.linalg.det(rotation))
    beacons = orbiter_beacons(model.omega)
    flight = fly(model, table5, beacons.times)
    low = flight.path[[150, 220], :3] / np.linalg.norm(flight.path[[150, 220], :3], axis=1)[:, None]
    lat, lon = np.arcsin(low[:, 2]), np.arctan2(low[:, 1], low[:, 0])
    sights = Features(("rim", "peak"), tuple(lat), tuple(lon), (0.0, 500.0))
    radio = Radio(("satellite", "station"), 4e8, 10.0, -25.0, 25.0)
    receiver = Receiver(chip=300.0, spacing=0.5)
    instruments = (
        Instrument("two_way_range", 5.0), Instrument("two_way_rate", 0.01),
        Instrument("altimeter", 10.0, 0.01, 40e3), Instrument("velocimeter", 0.2, 0.002, 40e3),
        Instrument("features", 1e-3, below=80e3),
    )  # fmt: skip
    parts = (
        Part("air", (0.05,), scales=(8.2e3, 3e5)), Part("lift", (0.01,)), Part("clock", (3e4, 0.3)),
        Part("bias", (3.0,), considered=True), Part("attitude", (1e-3,) * 3),
    )  # fmt: skip
    layout, found = Layout(parts, 3), []
    other, moved = turned(rotation, flight, beacons, model, cartesian_of(table5))
    for f, b, turn in ((flight, beacons, np.eye(3)), (other, moved, rotation)):
        measurements = Measurements(
            10.0, 0.1, 3.0, instruments=instruments, features=sights.moved(radius, turn),
            link=Link(radio, receiver, np.radians(120.0), electrons=WAKE, thickness=1.0),
        )  # fmt: skip
        seen = measurements.reaching(in_view(b, f.states, radius), b, f.path, model)
        taken = measurements.taken(seen, b.times)
        _, variances, _ = measurements.heard(b, taken, f.path, model)
        bound = linear_covariance(
            model, f.path, b, taken, measurements, PRIOR, np.array([1, 0, 0, 1e-4, 0, 0]), layout
        )
        found.append((seen, np.isfinite(variances), bound))
    (seen, heard, one), (seen_too, heard_too, two) = found
    assert seen.any() and heard[:, -1].any() and heard[:, 3:5].any()
    np.testing.assert_array_equal(seen, seen_too)
    np.testing.assert_array_equal(heard, heard_too)
    whole = np.eye(layout.size)
    whole[:3, :3] = whole[3:6, 3:6] = rotation
    at = layout.place("attitude")
    whole[at : at + 3, at : at + 3] = rotation
    back = np.swapaxes(whole.T @ two.covariance @ whole, 1, 2)
    size = np.sqrt(np.einsum("tii->ti", one.covariance))
    scale = size[:, :, None] * size[:, None, :]
    np.testing.assert_allclose(back / scale, one.covariance / scale, rtol=0, atol=1e-5)


def exact_run(path, prior, p, bank, times, sources, variance):
    """The recursion of ranges alone in decimals of 60 digits, (6, 6)."""
    exact = np.vectorize(Decimal, otypes=[object])
    covariance, phi, state = exact(prior), np.empty((6, 8)), np.empty(6)
    with localcontext() as context:
        context.prec = 60
        for t in range(times.size):
            if t > 0:
                advance_transition(
                    path[t - 1],
                    World(p, 0.0, p[LIFT]),
                    bank,
                    times[t - 1],
                    times[t],
                    1.0,
                    state,
                    phi,
                )
                move = exact(phi[:, :6])
                covariance = move @ covariance @ move.T
            for source in sources[t]:
                row = np.zeros(6)
                measured(RANGE, path[t], source, 0, np.full(PLACES, -1), p, 0.0, row)
                gain = covariance @ exact(row)
                covariance = covariance - np.outer(gain, gain) / (exact(row) @ gain + variance)
    return covariance.astype(float)


@pytest.mark.parametrize(("prior", "sigma"), [(1e3, 50.0), (1e6, 0.01), (1e8, 0.001)])
def test_a_root_bears_ranges_of_a_millimetre(case, prior, sigma):
    """Against 60 digits; the covariance itself is lost where eleven orders lie between."""
    model, flight, beacons, every = case
    first = axes_covariance(prior, 1e-3 * prior)
    short, measurements = slice(0, 30), Measurements(sigma)
    some = Beacons(
        beacons.names, beacons.times[short], beacons.r[short], beacons.v[short], beacons.moving
    )
    path = np.ascontiguousarray(flight.path[short])
    exact = exact_run(
        path, first, model.flight_parameters(), model.vehicle.bank_schedule(), some.times,
        some.states, Decimal(sigma) ** 2,
    )  # fmt: skip
    size = np.sqrt(np.diag(exact))
    plain, root = (
        linear_covariance(
            model, path, some, every[short], measurements, first, square_root=square_root
        ).covariance[-1]
        for square_root in (False, True)
    )
    # fine measurements take finer steps of the flow, which moves the covariance by 1e-6
    np.testing.assert_allclose(root / np.outer(size, size), exact / np.outer(size, size), atol=1e-4)
    if prior > 1e7:
        off = np.abs(plain - exact) / np.outer(size, size)
        assert not off.max() < 0.1


def test_a_root_considers_what_a_covariance_considers(case):
    """All blocks, a wandering density and process noise."""
    model, flight, beacons, every = case
    parts = (
        Part("air", (0.05,), scales=(8.2e3, 3e5)), Part("lift", (0.01,), considered=True),
        Part("clock", (3e4, 0.3)), Part("bias", (3.0,), considered=True),
    )  # fmt: skip
    noise = np.array([1.0, 0, 0, 1e-4, 0, 0])
    given = model, flight.path, beacons, every, Measurements(50.0, 0.1), PRIOR, noise
    plain, root = (
        linear_covariance(*given, Layout(parts, 3), square_root=square_root).covariance
        for square_root in (False, True)
    )
    size = np.sqrt(np.einsum("tii->ti", plain))
    scale = size[:, :, None] * size[:, None, :]
    np.testing.assert_allclose(root / scale, plain / scale, rtol=0, atol=1e-7)


def test_process_noise_and_fewer_measurements_loosen_the_bound(case):
    model, flight, beacons, every = case
    measurements = Measurements(50.0)
    arguments = (model, flight.path, beacons)
    plain = linear_covariance(*arguments, every, measurements, PRIOR)
    noisy = linear_covariance(
        *arguments, every, measurements, PRIOR, np.array([0, 0, 0, 0.01, 0, 0])
    )
    sparse = linear_covariance(
        *arguments,
        Measurements(50.0, interval=10).taken(every, beacons.times),
        measurements,
        PRIOR,
    )
    assert np.all(noisy.velocity_sigma[1:] > plain.velocity_sigma[1:])
    assert np.all(sparse.position_sigma[1:] > plain.position_sigma[1:])
    # the specification's figures, Monte Carlo themselves: 18.3 m, 0.497 m/s; 8.01 m, 0.0540 m/s
    np.testing.assert_allclose(plain.position_sigma[[60, 240]], [18.3, 8.01], rtol=0.06)
    np.testing.assert_allclose(plain.velocity_sigma[[60, 240]], [0.497, 0.0540], rtol=0.06)


PARTS = (
    Part("air", (0.2,)),
    Part("lift", (0.02,)),
    Part("clock", (30.0, 0.1)),
    Part("bias", (10.0,)),
)


def batch(model, start, beacons, estimated, considered, sigma_range):
    """Posterior at the end by one least squares over all ranges, with Schmidt's gain for none.

    Derivatives by central differences of flights; considered parameters enter as noise of all
    ranges together, which is the same as Schmidt's filter once everything is in.
    """
    n = beacons.size
    size = 8 + 2 + n
    scale = np.array([10.0] * 3 + [0.01] * 3 + [1e-3, 1e-4] + [1.0] * (2 + n))
    times = beacons.times

    def flown(d):
        air, craft = model.atmosphere, model.vehicle
        changed = EntryModel(
            type(craft)(0.016, craft.lift_to_drag + d[7]),
            air.changed(density_bias=np.expm1(d[6])),
            model.rotation,
            model.gm,
            model.planet_radius,
            model.rotation_rate,
        )
        path = fly(changed, spherical_of(start + d[:6]), times).path
        z = ideal_measurements(path, beacons)[..., 0] + d[8] + d[9] * times[:, None] + d[10:]
        clock = [d[8] + d[9] * times[-1], d[9]]
        return z, np.concatenate([path[-1], d[6:8], clock, d[10:]])

    rows, ends = [], []
    for j in range(size):
        step = scale[j] * np.eye(size)[j]
        (up, end_up), (down, end_down) = flown(step), flown(-step)
        rows.append((up - down).ravel() / (2 * scale[j]))
        ends.append((end_up - end_down) / (2 * scale[j]))
    h, phi = np.array(rows).T, np.array(ends).T
    prior = np.concatenate([[1000.0] * 3, [0.5] * 3, [0.2, 0.02, 30.0, 0.1], np.full(n, 10.0)]) ** 2
    kept = estimated + considered
    information = np.diag(1 / prior[kept]) + h[:, kept].T @ h[:, kept] / sigma_range**2
    return phi[np.ix_(kept, kept)] @ np.linalg.inv(information) @ phi[np.ix_(kept, kept)].T


def test_further_blocks_are_those_of_a_batch(world, table5, orbiter_beacons):
    """Air, lift, clock and biases estimated: against least squares over all ranges."""
    model, fine = world(), orbiter_beacons()
    beacons = Beacons(fine.names, fine.times[::8], fine.r[::8], fine.v[::8], fine.moving)
    flight = fly(model, table5, beacons.times)
    layout = Layout(PARTS, 3)
    taken = np.ones((31, 3), bool)
    found = linear_covariance(
        model, flight.path, beacons, taken, Measurements(50.0), PRIOR, layout=layout
    )
    everything = list(range(13))
    other = batch(model, cartesian_of(table5), beacons, everything, [], 50.0)
    scale = np.sqrt(np.outer(np.diag(other), np.diag(other)))
    # differences to 1e-6 times a condition number of 1e3
    np.testing.assert_allclose(found.covariance[-1] / scale, other / scale, atol=5e-3)


def test_a_spread_that_grows_with_height_stays_what_it_is(case):
    """Unheard, the density's variance is that of its profile at every height, from the first on."""
    model, flight, beacons, every = case
    radius = np.linalg.norm(flight.path[:, :3], axis=1)
    rows = tuple(
        (model.planet_radius + km * 1e3, sigma)
        for km, sigma in ((0.0, 0.02), (60.0, 0.1), (130.0, 0.5))
    )
    part = Part("air", (0.5,), scales=(8200.0, 3e5), profile=rows)
    wanted = np.exp(np.interp(radius, *np.array([(r, np.log(s)) for r, s in rows]).T))
    part = replace(part, sigma=(float(wanted[0]),))
    layout, none = Layout((part,), 3), np.zeros_like(every)
    unheard = linear_covariance(
        model, flight.path, beacons, none, Measurements(50.0), PRIOR, layout=layout
    )
    np.testing.assert_allclose(np.sqrt(unheard.covariance[:, 6, 6]), wanted, rtol=1e-12)
    # what is passed is forgotten: with a spread that ends small all is known nearly as well
    ends = [
        linear_covariance(
            model, flight.path, beacons, every, Measurements(50.0), PRIOR, layout=Layout((one,), 3)
        ).position_sigma[-1]
        for one in (part, replace(part, profile=(), sigma=(0.5,)))
    ]
    assert ends[0] < ends[1]
    negative = ((*rows[0][:1], -1.0), *rows[1:])
    both = (8200.0, 3e5)
    for profile, scales in ((rows[::-1], both), (rows, ()), (negative, both)):
        with pytest.raises(ArgumentError, match="air: a profile of sigmas is of density"):
            Part("air", (0.5,), scales=scales, profile=profile)


def test_considering_costs_and_never_more_than_ignoring_is_off(case):
    """A considered block lies between known and useless; its own variance stays."""
    model, flight, beacons, every = case
    measurements = Measurements(50.0)

    def end(*parts):
        layout = Layout(parts, 3)
        run = linear_covariance(
            model, flight.path, beacons, every, measurements, PRIOR, layout=layout
        )
        return run.covariance[-1], layout

    known, _ = end()
    estimated, _ = end(Part("bias", (10.0,)))
    considered, layout = end(Part("bias", (10.0,), considered=True))
    sizes = [np.trace(p[:3, :3]) for p in (known, estimated, considered)]
    assert sizes[0] < sizes[1] < sizes[2]
    assert layout.estimated == 6 and layout.size == 9
    np.testing.assert_allclose(considered[6:, 6:], 100.0 * np.eye(3), atol=1e-9)
    assert np.linalg.eigvalsh(considered).min() > 0


def test_layouts_name_their_blocks():
    layout = Layout((Part("bias", (5.0,), considered=True), Part("clock", (3.0, 0.1))), 4)
    assert [layout.place(name) for name in ("position", "velocity", "clock", "bias", "air")] == [
        0, 3, 6, 8, -1,
    ]  # fmt: skip
    assert layout.numbers().tolist() == [8, -1, -1, 6, 8, -1, -1, -1, -1]
    frame = Part("frame", (1e-6,) * 3, considered=True, told=(True, False))
    assert Layout((frame,), 2).numbers().tolist() == [6, -1, -1, -1, -1, -1, -1, -1, 6, 1, 0]
    np.testing.assert_allclose(np.diag(layout.covariance(PRIOR))[6:], [9, 0.01] + [25] * 4)
    with pytest.raises(ArgumentError, match="block = 'wind': allowed position, velocity, air"):
        block("wind")
    several = Layout((Part("bias", (5.0, 6.0, 7.0)),), 3)
    np.testing.assert_allclose(np.diag(several.covariance(PRIOR))[6:], [25, 36, 49])
    with pytest.raises(ArgumentError, match="bias: 3 sigmas for 4 states"):
        Layout(several.parts, 4)
    with pytest.raises(ArgumentError, match="is always there"):
        Part("position", (1.0,))
    with pytest.raises(ArgumentError, match="clock: 1 sigmas; give 2"):
        Part("clock", (1.0,))
    with pytest.raises(ArgumentError, match=r"air: sigma = 0\.0 1: must be positive"):
        Part("air", (0.0,))
    with pytest.raises(ArgumentError, match="two of density alone, both positive"):
        Part("air", (0.1,), scales=(8e3, 0.0))
    with pytest.raises(ArgumentError, match="block = 'air': given twice"):
        Layout((Part("air", (0.1,)), Part("air", (0.2,))))


def test_process_noise_is_turned_to_cartesian_axes(orbiter_flight):
    noise = np.array([1.0, 1e-14, 1e-14, 1e-2, 1e-10, 1e-10])
    roots = noise_roots(orbiter_flight.path, orbiter_flight.times, noise)
    assert not roots[0].any()
    jacobian = spherical_jacobian(orbiter_flight.path[5])
    np.testing.assert_allclose(
        roots[5] @ roots[5].T, jacobian @ np.diag(noise) @ jacobian.T, rtol=1e-12
    )
    assert noise_roots(orbiter_flight.path, orbiter_flight.times, 0.0).shape == (241, 0, 6)
    with pytest.raises(ArgumentError, match="position_sigma = 0"):
        axes_covariance(0.0, 0.5)


def test_air_wanders_as_gauss_and_markov_say(orbiter_flight):
    """From any epoch to any later one: the correlation that the way between them leaves."""
    flight, times = orbiter_flight.path, orbiter_flight.times
    layout = Layout((Part("air", (0.1,), scales=(8.2e3, 3e5)),))
    walk, fade = layout.steps(flight, times)
    variance = 0.01
    for k in range(1, len(flight)):
        variance = fade[k] ** 2 * variance + walk[k, 6]
    assert variance == pytest.approx(0.01)  # stationary
    r = np.linalg.norm(flight[:, :3], axis=1)
    level = np.exp(-np.abs(np.diff(r)) / 8.2e3)
    assert np.all(fade[1:] < level) and np.all(fade[1:] > level * np.exp(-6.5e3 / 3e5))
    falls = Layout((Part("air", (0.1,), scales=(8.2e3, np.inf)),)).steps(flight, times)[1]
    assert np.prod(falls[:80]) == pytest.approx(np.exp(-(r[0] - r[79]) / 8.2e3), rel=1e-9)
    assert np.all(Layout((Part("air", (0.1,)),)).steps(flight, times)[1] == 1.0)
    axes = (Part("attitude", (1e-3,) * 3), Part("gyro", (1e-6,) * 3, walk=1e-5))
    walk = Layout(axes).steps(flight, times)[0]
    assert walk[:, 6:9].sum(axis=0) == pytest.approx([1e-10 * times[-1]] * 3)
    assert not walk[:, 9:].any()
    with pytest.raises(ArgumentError, match='"gyro": needs "attitude"'):
        Layout(axes[1:])
    with pytest.raises(ArgumentError, match="walk = 1: of gyros alone"):
        Part("lift", (0.1,), walk=1)
