"""The flight: computed check values, a Cartesian twin, events and loads."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compass.bodies import MARS_J2, MARS_J2_RADIUS
from compass.core.entry.rates import World, acceleration, acceleration_partials
from compass.entry.model import EntryModel
from compass.entry.start import Trigger
from compass.entry.state import azimuth_from_heading, longitude_degrees, state_from_cartesian
from compass.entry.trajectory import fly, loads, trajectory_dataset
from compass.entry.views import cartesian_of, spherical_of
from compass.errors import ArgumentError

AT_240_S = {
    "coriolis": [
        *(3434954.43234, -73.4101612894, -25.6165051699),
        *(1597.6750789, -0.435474452976, 13.4934088883),
    ],
    "published-coriolis": [
        *(3431434.27727, -74.0279930284, -25.6655990456),
        *(1342.33821366, -1.91706887503, 14.0658226906),
    ],
    "full": [
        *(3435149.06865, -73.3843081465, -25.6088007694),
        *(1610.44058298, -0.353049957584, 13.5350526544),
    ],
}


def published_form(state):
    """Metres, m/s and degrees, psi from east."""
    r, lon, lat, v, gamma, psi = state[:6]
    heading = azimuth_from_heading(psi, "east")
    return np.array([r, *np.degrees([lon, lat]), v, *np.degrees([gamma, heading])])


@pytest.mark.parametrize("rotation", AT_240_S)
def test_state_at_240_s_to_a_millimetre(world, table2, rotation):
    flight = fly(world(rotation), table2, [0.0, 240.0])
    off = published_form(flight.states[-1]) - AT_240_S[rotation]
    # 1 mm, 1e-9 deg; the speed to its printed digits
    assert np.all(np.abs(off) <= [1e-3, 1e-9, 1e-9, 1e-7, 1e-9, 1e-9])
    assert flight.ending == ""


def test_a_flight_that_cannot_be_integrated_ends_where_it_could(monkeypatch, world, table2):
    """No step is small enough for no error at all: the last state is that of an earlier moment."""
    monkeypatch.setattr("compass.entry.trajectory.RELATIVE_TOLERANCE", 0.0)
    monkeypatch.setattr("compass.entry.trajectory.ABSOLUTE_TOLERANCE", np.full(6, 1e-100))
    flight = fly(world("full"), table2, [0.0, 40.0, 80.0])
    assert "could not be integrated any further" in flight.ending
    assert flight.times.tolist() == [0.0] and len(flight.states) == 1
    assert published_form(flight.states[0]) == pytest.approx(published_form(table2))


@pytest.mark.parametrize("rotation", ["none", "full"])
@pytest.mark.parametrize("bank_deg", [0.0, 50.0])
def test_spherical_equations_equal_cartesian_ones_in_the_rotating_frame(
    world, table2, rotation, bank_deg
):
    """Newton's law with Coriolis and centrifugal forces, by another integrator, in vectors."""
    bank = np.radians(bank_deg)
    model = world(rotation, bank_angles=(bank,))
    spin = np.array([0.0, 0.0, model.omega])

    def force(_, y):
        r, v = y[:3], y[3:]
        radius, speed = np.linalg.norm(r), np.linalg.norm(v)
        density = 2e-4 * np.exp((3437.2e3 - radius) / 7500.0)
        drag = 0.5 * density * 0.016 * speed**2
        along = v / speed
        up = r / radius - (r @ along) / radius * along
        up /= np.linalg.norm(up)
        right = np.cross(along, up)
        lift = 0.156 * drag * (np.cos(bank) * up + np.sin(bank) * right)
        gravity = -model.gm * r / radius**3
        fictitious = -2 * np.cross(spin, v) - np.cross(spin, np.cross(spin, r))
        return np.concatenate([v, gravity - drag * along + lift + fictitious])

    start = cartesian_of(table2)
    twin = solve_ivp(force, (0, 240), start, method="DOP853", rtol=1e-12, atol=1e-6).y[:, -1]
    found = cartesian_of(fly(model, table2, [0.0, 240.0]).states[-1])
    # the twin's own local error, 1e-12 of 3.5e6 m, gathered over some 50 steps
    assert np.linalg.norm(found[:3] - twin[:3]) < 1e-3
    assert np.linalg.norm(found[3:] - twin[3:]) < 1e-5


def test_what_the_rotation_is_worth(world, table2):
    """The distances between the models at 240 s that the specification states."""
    ends = {
        rotation: cartesian_of(fly(world(rotation), table2, [0.0, 240.0]).states[-1])[:3]
        for rotation in ("none", "coriolis", "full", "published-coriolis")
    }
    apart = {key: np.linalg.norm(value - ends["coriolis"]) for key, value in ends.items()}
    assert apart["full"] == pytest.approx(1.48e3, abs=5)
    assert apart["none"] == pytest.approx(64.6e3, abs=50)
    assert apart["published-coriolis"] == pytest.approx(33.7e3, abs=50)


def test_without_air_energy_and_momentum_stay(world, table2):
    model = world("none")
    still = EntryModel(
        type(model.vehicle)(0.0, 0.0), model.atmosphere, "none", model.gm, model.planet_radius
    )
    flight = fly(still, table2, np.linspace(0, 150, 31))
    c = cartesian_of(flight.states)
    energy = 0.5 * (c[:, 3:] ** 2).sum(1) - model.gm / np.linalg.norm(c[:, :3], axis=1)
    momentum = np.cross(c[:, :3], c[:, 3:])
    assert np.ptp(energy) < 1e-11 * abs(energy[0])
    assert np.all(np.ptp(momentum, axis=0) < 1e-11 * np.linalg.norm(momentum[0]))


def test_table_5_decodes(table5):
    assert table5[0] == pytest.approx(3522.004e3, abs=0.5)
    assert table5[3] == pytest.approx(6000.0, abs=0.01)
    assert np.degrees(table5[4]) == pytest.approx(-15.0, abs=2e-4)
    back = cartesian_of(table5)
    np.testing.assert_allclose(
        back[:3], np.array([-3.92, -3103.37, -1665.41]) * 1e3, rtol=0, atol=1e-8
    )
    np.testing.assert_allclose(back[3:], [5775.31, 1124.27, 1175.48], rtol=1e-13)


def test_ballistic_would_be_underground(world, table5):
    model = world()
    ballistic = EntryModel(
        type(model.vehicle)(0.016, 0.0), model.atmosphere, "coriolis", model.gm, 3397.2e3
    )
    flight = fly(ballistic, table5, np.arange(241.0))
    assert "reached the ground" in flight.ending
    assert flight.times[-1] < 240
    assert flight.events[-1].name == "ground"
    assert flight.events[-1].state[0] == pytest.approx(3397.2e3, abs=1e-6)
    assert flight.times[-1] <= flight.events[-1].time


def test_triggers_are_found_where_they_are(world, table2):
    model = world()
    triggers = [
        Trigger("40 km", "altitude", 40e3),
        Trigger("half", "speed", 2757.5),
        Trigger("Mach 10", "mach", 10.0),
        Trigger("never", "speed", 1.0),
    ]
    flight = fly(model, table2, [0.0, 240.0], triggers=triggers)
    events = {event.name: event for event in flight.events}
    assert "never" not in events
    assert flight.missed == ("never: speed 1 m/s is not fallen to by 240 s",)
    assert events["40 km"].state[0] - model.planet_radius == pytest.approx(40e3, abs=1e-6)
    assert events["half"].state[3] == pytest.approx(2757.5, abs=1e-9)
    assert events["Mach 10"].state[3] == pytest.approx(10 * model.atmosphere.speed_of_sound)
    for event in flight.events:
        there = fly(model, table2, [0.0, event.time]).states[-1]
        np.testing.assert_allclose(event.state, there, rtol=1e-10)
    assert [e.time for e in flight.events] == sorted(e.time for e in flight.events)


def test_a_skip_is_noted_and_flown_on(world, table2):
    shallow = table2.copy()
    shallow[4] = np.radians(-1.0)
    flight = fly(world(), shallow, np.arange(0.0, 1201.0, 10.0))
    assert [event.name for event in flight.events] == ["skip-out"]
    assert flight.times.size == 121


@pytest.mark.parametrize(
    ("lift", "gamma_deg", "speed", "word"),
    [(0.5, -89.99, 1.0, "vertical"), (0.0, -45.0, 5e-4, "standstill")],
)
def test_singular_flights_stop_with_a_word(world, table2, lift, gamma_deg, speed, word):
    model = world("none")
    airless = type(model.vehicle)(0.0, lift)
    still = EntryModel(airless, model.atmosphere, "none", model.gm, 3397.2e3)
    state = table2.copy()
    state[3], state[4] = speed, np.radians(gamma_deg)
    flight = fly(still, state, np.arange(0.0, 150.0))
    assert word in flight.ending
    assert 0 < flight.times.size < 150
    assert np.isfinite(flight.states).all()


def test_bank_commands_switch_exactly_at_their_times(world, table2):
    whole = fly(
        world(bank_times=(0.0, 60.5), bank_angles=(0.3, -0.8)), table2, [0.0, 50.0, 120.0]
    ).states[-1]
    half = fly(world(bank_angles=(0.3,)), table2, [0.0, 60.5]).states[-1]
    rest = fly(world(bank_angles=(-0.8,)), half, [60.5, 120.0]).states[-1]
    np.testing.assert_allclose(whole, rest, rtol=1e-12)


def test_mirrored_banks_fly_mirrored_paths(world, table2):
    """Without rotation, from the equator due east: north and south are alike."""
    state = table2.copy()
    state[2], state[5] = 0.0, np.pi / 2
    right = fly(world("none", bank_angles=(0.5,)), state, [0.0, 240.0]).states[-1]
    left = fly(world("none", bank_angles=(-0.5,)), state, [0.0, 240.0]).states[-1]
    assert right[2] < 0  # positive bank turns clockwise: from east to the south
    np.testing.assert_allclose(right[[0, 1, 3, 4]], left[[0, 1, 3, 4]], rtol=1e-12)
    assert right[2] == pytest.approx(-left[2], rel=1e-9)


def test_dataset_has_units_loads_and_heating(world, table2):
    flight = fly(world(), table2, np.arange(241.0))
    data = trajectory_dataset(flight)
    assert all(v.attrs["units"] and v.attrs["long_name"] for v in data.variables.values())
    # by hand at 100 s
    x = flight.states[100]
    density = 2e-4 * np.exp((3437.2e3 - x[0]) / 7500.0)
    at = data.isel(time=100)
    assert float(at.density) == pytest.approx(density, rel=1e-12)
    drag = 0.5 * density * 0.016 * x[3] ** 2
    assert float(at.g_load) == pytest.approx(drag * np.hypot(1, 0.156) / 9.80665, rel=1e-12)
    assert float(at.heat_flux) == pytest.approx(1.9027e-4 * np.sqrt(density) * x[3] ** 3, rel=1e-12)
    # what is lost in speed is what drag and gravity took: the peak of heat comes before that of g
    assert 0 < float(data.heat_flux.idxmax()) < float(data.g_load.idxmax())
    assert np.all(np.diff(data.heat_load) > 0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ((0, 3397.2e3), "not above the ground"),
        ((3, 0.0), "entry.speed_m_s = 0: must be above 0"),
        ((4, -np.pi / 2), "vertical, the heading is undefined"),
        ((1, np.nan), "every component must be a finite number"),
    ],
)
def test_impossible_starts_are_refused(world, table2, change, message):
    state = table2.copy()
    state[change[0]] = change[1]
    with pytest.raises(ArgumentError, match=message):
        fly(world(), state, [0.0, 10.0])


def test_times_must_increase(world, table2):
    with pytest.raises(ArgumentError, match="increase strictly"):
        fly(world(), table2, [0.0, 10.0, 10.0])


def test_longitudes_are_shown_within_a_turn():
    shown = longitude_degrees(np.radians([-180.0, 0.0, 179.0, 190.0, 359.0, 372.0, -190.0]))
    np.testing.assert_allclose(shown, [-180, 0, 179, -170, -1, 12, 170], atol=1e-12)


def test_headings_convert_both_ways():
    angles = np.radians([-170.0, -5.0, 0.0, 90.0, 179.0])
    for convention in ("north", "east"):
        there = azimuth_from_heading(angles, convention)
        np.testing.assert_allclose(azimuth_from_heading(there, convention), angles, atol=1e-15)
    assert azimuth_from_heading(0.0, "east") == pytest.approx(np.pi / 2)
    with pytest.raises(ArgumentError, match="heading_from = 'south': allowed north, east"):
        azimuth_from_heading(0.0, "south")


def test_undefined_cartesian_states_are_refused():
    with pytest.raises(ArgumentError, match="place or direction is undefined"):
        state_from_cartesian([0, 0, 0], [1.0, 0, 0])
    with pytest.raises(ArgumentError, match="place or direction is undefined"):
        state_from_cartesian([3.5e6, 0, 0], [0, 0, 0])


@pytest.mark.parametrize("place", [[0, 0, 3.5e6], [0, 0, -3.5e6], [1.0, 2.0, 3.5e6]])
def test_poles_are_places_like_others(place):
    state = state_from_cartesian(place, [1e3, -2e3, -500.0])
    back = cartesian_of(state)
    np.testing.assert_allclose(back[:3], place, rtol=0, atol=1e-8)
    np.testing.assert_allclose(back[3:], [1e3, -2e3, -500.0], rtol=1e-12)
    np.testing.assert_allclose(spherical_of(back), state, rtol=1e-9, atol=1e-9)


@pytest.mark.slow
def test_peak_loads_do_not_depend_on_the_times_asked_for(world, table2):
    """From coarse output as from fine; the peak itself against a fine grid of another flight."""
    fine = fly(world(), table2, np.arange(0.0, 240.01, 0.01))
    peaks = trajectory_dataset(fine)
    for step in (1.0, 30.0):
        borne = loads(fly(world(), table2, np.arange(0.0, 241.0, step)))
        for name in ("g_load", "dynamic_pressure", "heat_flux"):
            value, when = borne.largest(name)
            assert value == pytest.approx(float(peaks[name].max()), rel=1e-6)
            assert when == pytest.approx(float(peaks[name].idxmax()), abs=0.02)
        # the trapezoidal rule over 0.25 s: (0.25 s / 20 s)^2 / 12
        assert borne.largest("heat_load")[0] == pytest.approx(float(peaks.heat_load[-1]), rel=2e-5)


def test_flattened_mars_turns_about_its_pole_alone(world, table2):
    """With J2 and spin a turn about the pole changes nothing, another turn does; by SciPy too."""
    model = replace(world("full"), j2=MARS_J2.value)
    times = np.array([0.0, 60.0])
    here = fly(model, table2, times)
    turned = fly(model, table2 + np.eye(6)[1], times)
    c, s = np.cos(1.0), np.sin(1.0)
    turn = np.kron(np.eye(2), [[c, -s, 0], [s, c, 0], [0, 0, 1]])
    np.testing.assert_allclose(turned.path, here.path @ turn.T, rtol=1e-11, atol=1e-6)
    point = fly(replace(model, j2=0.0), table2, times)
    assert 1 < np.linalg.norm(here.path[-1, :3] - point.path[-1, :3]) < 100
    air, craft, omega = model.atmosphere, model.vehicle, np.array([0, 0, model.rotation_rate])

    def potential(r):
        size = np.linalg.norm(r)
        ratio = (MARS_J2_RADIUS.value / size) ** 2 * MARS_J2.value
        return model.gm / size * (1 - ratio * (1.5 * (r[2] / size) ** 2 - 0.5))

    def rates(_, y):
        r, v = y[:3], y[3:]
        pull = [(potential(r + d) - potential(r - d)) / 200.0 for d in 100.0 * np.eye(3)]
        along = v / np.linalg.norm(v)
        up = r / np.linalg.norm(r)
        above = (up - (up @ along) * along) / np.linalg.norm(up - (up @ along) * along)
        drag = 0.5 * air.density(np.linalg.norm(r)) * craft.drag_area_per_mass * (v @ v)
        turning = -2 * np.cross(omega, v) - np.cross(omega, np.cross(omega, r))
        return np.concatenate([v, drag * (craft.lift_to_drag * above - along) + turning + pull])

    other = solve_ivp(rates, times, here.path[0], "DOP853", times, rtol=1e-11, atol=1e-8).y[:, -1]
    np.testing.assert_allclose(here.path[-1, :3], other[:3], rtol=0, atol=1e-3)


def windy(world, winds, rotation="full"):
    model = world(rotation)
    return replace(model, atmosphere=replace(model.atmosphere, winds=winds))


WINDS = ((3397.2e3, -20.0, 10.0), (3427.2e3, 60.0, -40.0), (3497.2e3, -30.0, 100.0))


def test_no_wind_is_still_air_to_the_byte(world, table2):
    still, zero = (
        fly(model, table2, np.arange(0.0, 241.0, 8.0)).path
        for model in (world("full"), windy(world, ((3397.2e3, 0.0, 0.0), (3500e3, 0.0, 0.0))))
    )
    np.testing.assert_array_equal(still, zero)


def test_partials_in_wind_are_derivatives(world, table2):
    """Against central differences, between the rows of the winds and beyond them."""
    p = windy(world, WINDS).flight_parameters()
    for k in (60, 110, 200):
        x = fly(windy(world, WINDS), table2, [0.0, float(k)]).path[-1]
        found, up, down = np.empty((3, 8)), np.empty(3), np.empty(3)
        acceleration_partials(x, World(p, 0.1, 0.156), 0.6, 0.8, found)
        for j in range(6):
            step = (5.0 if j < 3 else 0.01) * np.eye(6)[j]
            acceleration(x + step, World(p, 0.1, 0.156), 0.6, 0.8, up)
            acceleration(x - step, World(p, 0.1, 0.156), 0.6, 0.8, down)
            slope = (up - down) / (2 * step[j])
            np.testing.assert_allclose(found[:, j], slope, rtol=0, atol=1e-6 * abs(found).max())


def test_a_wind_that_turns_with_more_spin_is_still_air(world, table2):
    """Air that goes round at a rate of its own is a wind to the east of that rate times q."""
    model = world("none")
    lat = table2[2]
    eastward = 1e-5 * table2[0] * np.cos(lat)
    p = windy(world, ((3e6, eastward, 0.0),), "none").flight_parameters()
    x, spin = fly(model, table2, [0.0]).path[0], np.array([0.0, 0.0, 1e-5])
    blown, carried = np.empty(3), np.empty(3)
    acceleration(x, World(p, 9.0, 0.156), 0.6, 0.8, blown)
    moved = np.concatenate([x[:3], x[3:] - np.cross(spin, x[:3])])
    acceleration(moved, World(model.flight_parameters(), 9.0, 0.156), 0.6, 0.8, carried)
    np.testing.assert_allclose(blown, carried, rtol=1e-9)


@pytest.mark.parametrize("angle", [0.7, -2.5])
def test_winds_turn_with_the_planet_about_its_pole(world, table2, angle):
    model, times = windy(world, WINDS), np.arange(0.0, 241.0, 24.0)
    flight, still = (fly(m, table2, times) for m in (model, world("full")))
    turned = table2.copy()
    turned[1] += angle
    other = fly(model, turned, times)
    c, s = np.cos(angle), np.sin(angle)
    both = np.kron(np.eye(2), np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
    np.testing.assert_allclose(other.path @ both, flight.path, rtol=0, atol=1e-5)
    assert np.linalg.norm(flight.path[-1, :3] - still.path[-1, :3]) > 100.0
    assert loads(flight).largest("g_load")[0] != loads(still).largest("g_load")[0]


def test_impossible_winds_are_refused(world):
    with pytest.raises(ArgumentError, match="winds: altitudes must increase"):
        windy(world, WINDS[::-1])
    with pytest.raises(ArgumentError, match="leave the winds out"):
        windy(world, WINDS, "published-coriolis")
