import numpy as np
import pytest

import compass
from compass import ephemeris, walker_delta
from compass.bodies import MARS_GM, MARS_J2, MARS_ROTATION_RATE, sidereal_day
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY as DAY
from compass.frames import latitude_longitude
from compass.inputs import read_design
from compass.orbits import (
    areosynchronous_radius,
    keplerian,
    orbital_period,
    positions_mcmf,
    repeat_period,
    states_mci,
)
from compass.orbits.forces import ForceModel
from compass.orbits.gravity import built_in_field
from compass.orbits.motion import Motion, as_motion
from compass.orbits.period import closing_days, secular_rates

FIELD = built_in_field().truncated(2, 0)
OBLATE = Motion("numerical", ForceModel(FIELD, False, False, 0.0, "none"))


def one(a=8e6, e=0.2, i=1.0, **more):
    return keplerian(a, e, i, 0.5, 0.4, 0.3, **more)


def test_areosynchronous_radius():
    # 20 428 km to the kilometre; GM and rate are known to 1e-8, so 1e-3 km is the model's own
    radius = areosynchronous_radius()
    assert radius == pytest.approx(20_427_685, abs=1)
    assert orbital_period(radius) == pytest.approx(sidereal_day(), rel=1e-12)


@pytest.mark.parametrize("inclination", [0.0, np.pi / 4, np.pi / 2])
def test_areosynchronous_radius_with_j2_keeps_pace_with_mars(inclination):
    a = areosynchronous_radius(j2=True, inclination=inclination)
    node, periapsis, anomaly = secular_rates(a, 0.0, inclination)
    assert periapsis + anomaly == pytest.approx(MARS_ROTATION_RATE.value - node, rel=1e-12)


def test_areostationary_satellite_stands_still_over_mars():
    c = walker_delta(1, 1, 0, inclination_deg=0.0, orbit="areosynchronous")
    _, lon = latitude_longitude(positions_mcmf(c, np.linspace(0, 3 * sidereal_day(), 9)))
    # the periodic terms of W: at most the sum of amplitude times rate, 1.1e-12 rad/s, for 3 days
    assert np.ptp(np.unwrap(lon[0])) < 3e-7


def test_models_agree_to_first_order_in_j2():
    c, times = one(), np.linspace(0, 4e4, 5)
    plain, drift, exact = (states_mci(c, times, m)[0][0] for m in ("two-body", "j2", OBLATE))
    # J2 moves a satellite by about 3/2 J2 (R/a)^2 n t a; the secular model takes most of that
    assert np.linalg.norm(plain - exact, axis=-1).max() > 2e4
    short_periodic = 20 * MARS_J2.value * 8e6
    assert np.linalg.norm(drift - exact, axis=-1).max() < short_periodic


def test_secular_node_rate_equals_integration():
    # circular and long enough that short-periodic wiggles do not matter
    c = keplerian(1e7, 0.0, 1.0, 0.0, 0.0, 0.0)
    period = float(orbital_period(1e7))
    r, v = states_mci(c, np.array([0.0, 40 * period]), OBLATE)
    h = np.cross(r[0], v[0])
    node = np.unwrap(np.arctan2(h[:, 0], -h[:, 1]))
    rate = secular_rates(1e7, 0.0, 1.0)[0]
    # second order in J2: J2 (R/a)^2 = 2e-4 of the rate, plus short-periodic 1e-4 rad in 0.03 rad
    assert (node[1] - node[0]) / (40 * period) == pytest.approx(rate, rel=5e-3)


def test_numerical_motion_keeps_energy_and_axial_momentum():
    c = one()
    r, v = (x[0] for x in states_mci(c, np.linspace(-2e4, 5e4, 8), OBLATE))
    z2 = r[:, 2] ** 2 / (r * r).sum(-1)
    d = np.linalg.norm(r, axis=-1)
    bulge = FIELD.gm * -np.sqrt(5) * FIELD.c[2, 0] * 3.396e6**2 / (2 * d**3) * (3 * z2 - 1)
    energy = (v * v).sum(-1) / 2 - FIELD.gm / d + bulge
    np.testing.assert_allclose(energy, energy[0], rtol=1e-12)
    momentum = np.cross(r, v)[:, 2]
    np.testing.assert_allclose(momentum, momentum[0], rtol=1e-12)


@pytest.mark.parametrize("model", ["two-body", "j2", OBLATE])
def test_a_trajectory_passes_where_its_motion_says(model):
    motion, c = as_motion(model), one(e=0.5)
    path = motion.trajectory(c, 0.0, 1e5)
    times = np.linspace(0.0, 1e5, 77)
    r, v = path.states(times)
    known, speed = states_mci(c, times, model)
    assert np.linalg.norm(r - known, axis=-1).max() <= path.errors.max()
    assert np.abs(v - speed).max() < 1e-5
    assert path.errors.max() < 1e-3


@pytest.mark.parametrize(("e", "halved"), [(0.0, 1), (0.7, 1), (0.8, 2)])
def test_stretches_do_not_shrink_where_only_rounding_is_left(e, halved):
    """A thousand days and a century on, a stretch is as long as on the first day.

    Near the periapsis of a long ellipse rounding is more than is known beforehand, and found by
    one halving that is of no use.
    """
    c = keplerian(2e7, e, 0.7, 0.0, 0.3, 1.0)
    for day in (1000.0, 36525.0):
        first, later = (
            Motion("two-body").trajectory(c, t * DAY, (t + 1) * DAY) for t in (0.0, day)
        )
        assert len(later.errors) <= halved * len(first.errors)
        times = np.linspace(later.start, later.stop, 50)
        off = np.linalg.norm(later.states(times)[0] - states_mci(c, times, "two-body")[0], axis=-1)
        assert off.max() <= later.errors.max() < 0.1


@pytest.mark.parametrize("model", ["two-body", "numerical"])
def test_paths_that_do_not_fit_are_refused_before_anything_is_followed(model):
    asked = r"days = 4e\+09: the paths of 1 satellite would take .* GB of memory, there are "
    with pytest.raises(ArgumentError, match=asked):
        Motion(model).trajectory(one(), 0.0, 4e9 * DAY)


def test_an_integration_is_kept_for_who_asks_the_same():
    assert OBLATE.trajectory(one(), 0.0, 1e5) is OBLATE.trajectory(one(), 0.0, 5e4)
    assert OBLATE.trajectory(one(), 0.0, 1e5) is not OBLATE.trajectory(one(e=0.21), 0.0, 1e5)


def test_a_span_must_have_a_length_and_one_direction():
    with pytest.raises(ArgumentError, match="the end must come later"):
        OBLATE.trajectory(one(), 1e5, 1e5)
    with pytest.raises(ArgumentError, match="followed one way from the epoch"):
        OBLATE.trajectory(one(), -1e5, 1e5)


def test_an_ephemeris_is_its_table():
    path = Motion("j2").trajectory(one(), 0.0, 1e5)
    motion = Motion("ephemeris", table=path)
    assert motion.trajectory(one(), 10.0, 1e5) is path
    assert motion.title == path.source == "mean motion under J2"
    assert motion.states(one(), [5.0])[0] == pytest.approx(path.states([5.0])[0])
    with pytest.raises(ArgumentError, match="more than the ephemerides cover"):
        motion.trajectory(one(), 0.0, 1.1e5)
    with pytest.raises(ArgumentError, match="there is no table"):
        Motion("ephemeris")


def test_motions_are_named():
    assert Motion().title == "two-body motion"
    assert OBLATE.title == "numerical motion: GMM-3 (Genova et al. 2016) to degree 2"


def test_repeat_period():
    synchronous = walker_delta(15, 5, 1, inclination_deg=45.8, radius_km=20427)
    repeat = repeat_period(synchronous)
    assert (repeat.sidereal_days, repeat.revolutions) == (1, 1)
    assert repeat.closure < np.radians(0.05)
    half = areosynchronous_radius() * 2 ** (-2 / 3)
    assert (
        repeat_period(walker_delta(3, 3, 0, inclination_deg=45.8, radius_km=half / 1e3)).revolutions
        == 2
    )
    low = repeat_period(walker_delta(1, 1, 0, inclination_deg=45.8, radius_km=4196))
    assert 1 <= low.sidereal_days <= 10
    two_thirds = areosynchronous_radius() * (2 / 3) ** (2 / 3)
    assert (
        repeat_period(
            walker_delta(1, 1, 0, inclination_deg=45.8, radius_km=two_thirds / 1e3)
        ).sidereal_days
        == 2
    )


def test_closing_days_of_many_constellations_at_once():
    radii = np.linspace(4e6, 3e7, 40)
    motion = np.sqrt(MARS_GM.value / radii**3)
    days, closure = closing_days(motion[:, None])
    for k, radius in enumerate(radii):
        alone = repeat_period(keplerian(radius, 0, 0.8, 0, 0, 0))
        assert (days[k], closure[k]) == (alone.sidereal_days, alone.closure)
        turns = np.arange(1, 11) * sidereal_day() * motion[k] / (2 * np.pi)
        misses = 360 * np.abs(turns - np.rint(turns))
        first = np.flatnonzero(misses <= 1)
        assert days[k] == (first[0] if first.size else misses.argmin()) + 1
    pair, _ = closing_days([motion[[0, 7]], motion[[3, 3]]])
    assert pair.shape == (2,) and pair[1] == days[3]


def test_ephemeris_is_a_dataset_with_units():
    data = ephemeris(one(satellite_names=["A"]), [0.0, 60.0])
    assert data.r_mci.sel(satellite="A").shape == (2, 3)
    assert data.v_mci.attrs["units"] == "m s-1"
    norms = [np.linalg.norm(data[name], axis=-1) for name in ("r_mci", "r_mcmf")]
    np.testing.assert_allclose(*norms, rtol=1e-14)


def test_unknown_model_is_refused():
    with pytest.raises(ArgumentError, match="allowed two-body, j2, numerical"):
        states_mci(one(), [0.0], "sgp4")


def test_a_repeat_misses_in_the_sky_not_in_mean_anomaly(designs):
    """Draim's four: 19.49 deg of mean anomaly are 34.41 deg where the satellite is fastest."""
    c = read_design(designs / "draim-four.toml").constellation
    repeat = repeat_period(c)
    assert np.degrees(repeat.closure) == pytest.approx(34.41, abs=0.005)
    starts = np.linspace(0, 2 * np.pi / c.mean_motion[0], 4001)
    worst = 0.0
    for shift in range(c.size):
        here, _ = states_mci(c, starts)
        there, _ = states_mci(c, starts + repeat.duration)
        one, two = here[shift], there[shift]
        cosine = (one * two).sum(-1) / np.linalg.norm(one, axis=-1) / np.linalg.norm(two, axis=-1)
        worst = max(worst, np.degrees(np.arccos(np.clip(cosine, -1, 1))).max())
    assert np.degrees(repeat.closure) == pytest.approx(worst, abs=0.01)


def test_a_repeat_has_a_revolution_in_it():
    """An orbit of 57 sols: one rotation of Mars, and no revolution, was a repeat."""
    period = 57 * sidereal_day()
    axis = (MARS_GM.value * (period / (2 * np.pi)) ** 2) ** (1 / 3)
    repeat = repeat_period(one(a=axis, e=0.4))
    assert (repeat.sidereal_days, repeat.revolutions) == (57, 1)
    assert repeat.closure < 1e-6
    mixed = keplerian([axis, 1e7], [0.4, 0.0], 1.0, 0.0, 0.0, 0.0)
    assert repeat_period(mixed).sidereal_days >= 29


@pytest.mark.parametrize("inclination_deg", [0.0, 45.0, 97.0])
def test_the_radius_in_kilometres_and_degrees(inclination_deg):
    """What a user types carries its unit; the track then closes after one rotation of Mars."""
    radius_km = compass.areosynchronous_radius_km(j2=True, inclination_deg=inclination_deg)
    node, periapsis, anomaly = secular_rates(1e3 * radius_km, 0.0, np.radians(inclination_deg))
    assert node + periapsis + anomaly == pytest.approx(MARS_ROTATION_RATE.value, rel=1e-12)
    with pytest.raises(ArgumentError, match="inclination_deg = 181"):
        compass.areosynchronous_radius_km(inclination_deg=181.0)


@pytest.mark.parametrize("model", ["two-body", "j2"])
def test_ellipses_over_a_mars_year_take_no_more_stretches_a_turn_than_over_a_day(model):
    """A phase of hundreds of turns is rounded; no shorter stretch makes it any better."""
    c = keplerian(20427.7e3, 0.05, 0.8, 0.0, 0.0, [0.0, 1.0])
    day, year = (Motion(model).trajectory(c, 0.0, days * 86400.0) for days in (1, 687))
    assert len(year.breaks) - 1 <= 2 * 687 * (len(day.breaks) - 1)
    times = np.array([600.5, 687.0]) * 86400.0
    off = np.abs(year.states(times)[0] - states_mci(c, times, model)[0])
    assert off.max() < year.errors.max()
