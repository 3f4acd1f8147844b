"""Station-keeping: costs against the law of a constant push, and the published pattern."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import compass
from compass.cli.main import program
from compass.document import text
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY as DAY
from compass.frames import prime_meridian_angle
from compass.inputs import read_design_text
from compass.orbits import states_mci
from compass.orbits.constellation import keplerian
from compass.orbits.forces import ForceModel
from compass.orbits.gravity import built_in_field
from compass.orbits.keeping import _into_plane, _Slots, keep_kinds, keep_slots
from compass.orbits.trajectory import integrate
from compass.study.candidates import ROW
from compass.study.lasting import keeping_law

STILL = """
name = "still"
epoch = 2030-01-01T12:00:00
[constellation]
pattern = "elements"
[[constellation.satellite]]
name = "A"
semi_major_axis_km = 20429.4
inclination_deg = 0
mean_anomaly_deg = {anomaly}
[coverage]
fold = 1
"""


def over(longitude_deg):
    """One satellite that begins over an east longitude."""
    epoch = read_design_text(STILL.format(anomaly=0)).constellation.epoch
    anomaly = (longitude_deg + float(np.degrees(prime_meridian_angle(epoch)))) % 360
    return read_design_text(STILL.format(anomaly=anomaly)).constellation


@pytest.mark.slow
def test_the_largest_push_over_the_equator_costs_38_metres_a_second_a_year():
    """212.5 E: 0.0756 deg/day^2, 1.204e-6 m/s^2 (Newton's method on the averaged field, own).

    A constant push u'' in a box of half width w is met by a burn every ``4 sqrt(w / u'')``.
    """
    forces = ForceModel(built_in_field().truncated(8), False, False, 0.0, "none")
    width, days = np.radians(0.4), 150.0
    found = keep_slots(over(212.5), forces, days * DAY, width)
    year = 365.25 / days
    assert found.push[0] * 365.25 * DAY == pytest.approx(38.0, rel=0.04)
    interval = 4 * np.sqrt(0.4 / 0.0756)
    # the count is whole, the first arc begins inside, and a look a turn finds the edge up to a day
    # late, a tenth of the interval: three burns more or less
    assert found.burns[0] == pytest.approx(days / interval, abs=3.1)
    assert found.delta_v[0] * year == pytest.approx(38.0, rel=0.12)
    # eight turns go by before the first burn: half of u'' times their square
    assert found.worst[0] < np.radians(0.5 * 0.0756 * 8.6**2)


@pytest.mark.slow
def test_a_stable_longitude_costs_next_to_nothing():
    """342.10 E, 17.9 W, is stable (Silva and Romero 2013; Alvarellos 2010)."""
    forces = ForceModel(built_in_field().truncated(8), False, False, 0.0, "none")
    found = keep_slots(over(342.1), forces, 150 * DAY, np.radians(0.4))
    assert found.delta_v[0] < 0.3


PUBLISHED = """
name = "published"
epoch = 2030-01-01T12:00:00
[constellation]
pattern = "walker-delta"
satellites = 15
planes = 5
phasing = 1
inclination_deg = 45
radius_km = 20427.7
[coverage]
fold = 4
"""


SHORT = (
    PUBLISHED.replace("satellites = 15", "satellites = 5").replace("fold = 4", "fold = 1")
    + '[motion]\nmodel = "numerical"\ngravity_degree = 2\nmoons = false\nradiation_m2_kg = 0\n'
)


@pytest.mark.slow
def test_the_published_pattern_costs_what_its_first_push_and_the_law_foretell(tmp_path):
    """0.9 to 26.1 m/s an Earth year by slot, mean 15.6, from the push of the first ten days (own)."""
    path = tmp_path / "d.toml"
    path.write_text(PUBLISHED)
    run = CliRunner().invoke(
        program, ["keep", str(path), "--years", "1", "--box-deg", "1", "--json"]
    )
    assert run.exit_code == 0, run.output
    out = json.loads(run.stdout)
    costs = [row["delta_v_m_s_year"] for row in out["per_satellite"]]
    assert max(costs) == pytest.approx(26.1, rel=0.15)
    assert out["delta_v_mean_m_s_year"] == pytest.approx(15.6, rel=0.15)
    assert min(costs) < 4.0
    # what studies say of it by a law
    row = np.array([(0, 15, 5, 1, 45.0, 20427.7, 0.0)], ROW)
    law = keeping_law(row, np.radians([6.18]))[0]
    assert out["delta_v_keeping_m_s_year"] == pytest.approx(law, rel=0.1)
    assert out["margin_deg"] == pytest.approx(6.18, abs=0.01)
    # the simulation against the push it met, burn for burn
    for row in out["per_satellite"]:
        assert row["delta_v_m_s_year"] == pytest.approx(row["push_m_s_year"], abs=4.0)
        exhaust = 9.80665 * 220.0
        spent = row["delta_v_m_s_year"] * out["years"]
        assert row["propellant_kg"] == pytest.approx(100 * np.expm1(spent / exhaust))


def test_a_turn_into_a_plane_costs_its_angle_and_no_speed():
    """2 v sin(angle / 2), where the satellite crosses the plane."""
    c = keplerian(1.2e7, 0.0, 0.7, 0.3, 0.0, 0.5, gm=built_in_field().gm)
    forces = ForceModel(built_in_field().truncated(2, 0), False, False, 0.0, "none")
    r, v = (a[:, 0] for a in states_mci(c, [0.0]))
    path = integrate(r, v, forces, 3e4)
    before = np.cross(r[0], v[0])
    pole = np.array([0.3, -0.4, 0.85])
    pole /= np.linalg.norm(pole)
    there, speed, cost = _into_plane(path, pole, 1.0, forces)
    after = np.cross(there, speed)
    angle = np.arccos(before @ pole / np.linalg.norm(before))
    # in a revolution oblateness turns a plane by 3 pi J2 (R/a)^2 cos i sin i, 0.0008 rad
    assert np.arccos(after @ pole / np.linalg.norm(after)) < 0.005
    assert cost == pytest.approx(2 * np.linalg.norm(v) * np.sin(angle / 2), abs=2.0)
    energy = [
        np.dot(w, w) / 2 - forces.field.gm / np.linalg.norm(x)
        for x, w in ((r[0], v[0]), (there, speed))
    ]
    assert energy[1] == pytest.approx(energy[0], rel=2e-3)


@pytest.mark.slow
def test_planes_are_turned_back_where_they_leave_their_slots():
    c = read_design_text(PUBLISHED).constellation
    free, kept = (
        keep_slots(c, ForceModel(), 60 * DAY, 0.05, across=across)
        for across in (np.inf, np.radians(0.03))
    )
    assert free.burns_across.sum() == 0
    assert np.degrees(free.tilt.max()) > 0.06
    # one revolution more than the box at most, and the short-period swing of the poles
    assert np.degrees(kept.tilt.max()) < 0.06
    speed = c.mean_motion[0] * c.semi_major_axis[0]
    each = kept.delta_v_across.sum() / kept.burns_across.sum()
    assert np.radians(0.03) < each / speed < np.radians(0.06)


@pytest.mark.slow
def test_errors_of_burns_are_met_and_repeat_with_their_seed():
    design = read_design_text(
        PUBLISHED + "[keeping]\nexecution_error = 0.1\nnavigation_error_m = 20000\nyears = 0.3\n"
    )

    def run(**options):
        return compass.keep(design, box_deg=0.5, **options)

    first, again, other = run(years=0.1), run(years=0.1), run(years=0.1, seed=1)
    assert first.to_dict() == again.to_dict()
    assert first.delta_v_m_s_year != other.delta_v_m_s_year
    one, exact = run(), run(execution_error=0.0, navigation_error_m=0.0)
    assert np.mean(one.delta_v_m_s_year) == pytest.approx(np.mean(exact.delta_v_m_s_year), rel=0.2)
    assert one.holds
    assert "good to 10 %, places known to 20000 m" in text(one.document()).replace("\n  ", " ")


@pytest.mark.slow
def test_untouched_radii_stand_beside():
    found = compass.keep(read_design_text(SHORT), years=0.1, box_deg=0.05, radius_km=[20800.0])
    assert found.to_dict()["untouched"][0]["days_proven"] > 0.0
    assert "Untouched instead, trimmed once" in text(found.document())


@pytest.mark.slow
def test_the_smallest_burn_is_the_least():
    found = compass.keep(read_design_text(SHORT), years=0.1, box_deg=0.05, smallest_burn_m_s=3.0)
    burnt = found.keeping.burns > 0
    assert burnt.any()
    assert np.all(found.keeping.delta_v[burnt] >= 2.8 * found.keeping.burns[burnt])


def test_a_short_simulation_prints_its_costs():
    design = read_design_text(SHORT)
    found = compass.keep(design, years=0.1, box_deg=0.05)
    words = text(found.document())
    assert "m/s an Earth year a satellite" in words
    worst = np.degrees(np.hypot(found.keeping.worst, found.keeping.tilt).max())
    assert worst > 0.05  # beyond where they are turned back
    assert f"turned back 0.05 deg along the track from its slot, {worst:.3g} deg off" in words
    assert found.keeping.burns.sum() > 0
    assert found.years == pytest.approx(0.1, abs=0.002)
    assert found.to_dict()["per_satellite"][0]["days_between_burns"]
    assert found.holds


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"years": 0.0}, "years = 0: allowed 0.1 to 100"),
        ({"dry_mass_kg": 0.0}, r"dry_mass_kg = 0: allowed 0\.001 to 1000000"),
        ({"box_deg": -1.0}, "box_deg = -1: allowed above 0"),
    ],
)
def test_keep_refuses(options, message):
    with pytest.raises(ArgumentError, match=message):
        compass.keep(read_design_text(PUBLISHED), **options)


def test_unlike_orbits_cannot_be_kept_as_slots():
    oval = STILL.format(anomaly=0).replace("inclination_deg", "eccentricity = 0.1\ninclination_deg")
    with pytest.raises(ArgumentError, match="box_deg: missing; orbits that are oval"):
        compass.keep(read_design_text(oval))
    forces = ForceModel()
    with pytest.raises(ArgumentError, match="revolutions; give at least 30 of them"):
        keep_slots(over(0.0), forces, 5 * DAY, 0.1)
    c = keplerian([2e7, 2.1e7], 0, 0.1, 0, 0, 0)
    with pytest.raises(ArgumentError, match="needs orbits of one period"):
        keep_slots(c, forces, 50 * DAY, 0.1)


def test_an_impulse_changes_the_mean_motion_of_an_oval_orbit_as_the_controller_counts():
    """``dn = -3 n a v dv / GM``: the energy law, at any place of the orbit."""
    gm, a, e = 4.2828372854e13, 2e7, 0.3
    n = np.sqrt(gm / a**3)
    for r in (a * (1 - e), a, a * (1 + e)):
        v, dv = np.sqrt(gm * (2 / r - 1 / a)), 1e-3
        faster = 1 / (2 / r - (v + dv) ** 2 / gm)
        lever = gm / (n * a * v)
        assert np.sqrt(gm / faster**3) - n == pytest.approx(-3.0 * dv / lever, rel=1e-4)


@pytest.mark.slow
def test_kinds_of_orbits_are_kept_each_by_itself():
    """An areostationary ring and an oval orbit: as if each were a design of its own."""
    forces = ForceModel(built_in_field().truncated(3), False, False, 0.0, "none")
    ring = keplerian(20428.1e3, 0.0, 0.0, 0.0, 0.0, np.radians([0.0, 120.0, 240.0]))
    oval = keplerian(12000e3, 0.3, 0.9, 0.0, 1.0, np.radians([0.0, 180.0]))
    both = keplerian(
        [20428.1e3, 12000e3, 20428.1e3, 12000e3, 20428.1e3],
        [0.0, 0.3, 0.0, 0.3, 0.0],
        [0.0, 0.9, 0.0, 0.9, 0.0],
        0.0,
        [0.0, 1.0, 0.0, 1.0, 0.0],
        np.radians([0.0, 0.0, 120.0, 180.0, 240.0]),
    )
    asked = (forces, 60 * DAY, np.radians(0.5))
    found = keep_kinds(both, *asked)
    for places, alone in (
        ([0, 2, 4], keep_slots(ring, *asked)),
        ([1, 3], keep_slots(oval, *asked)),
    ):
        whole = alone.delta_v * found.duration / alone.duration
        assert found.delta_v[places] == pytest.approx(whole, rel=1e-6, abs=1e-9)
        assert found.worst[places] == pytest.approx(alone.worst, rel=1e-6)
    # burns hold the oval pair, whose osculating axes J2 sets apart, within what it learnt in
    assert found.burns[[1, 3]].min() > 0
    assert np.degrees(found.worst[[1, 3]]).max() < 3.0


def test_numbers_of_the_law_are_finite():
    r, _ = states_mci(over(212.5), [0.0])
    angle = float(prime_meridian_angle(over(212.5).epoch))
    longitude = np.degrees(np.arctan2(r[0, 0, 1], r[0, 0, 0]) - angle) % 360
    assert longitude == pytest.approx(212.5, abs=1e-6)


@pytest.mark.parametrize(
    ("fold", "message"),
    [
        (0, "fold = 0: allowed 1 to 10000"),
        (2.5, "fold = 2.5: must be a whole number"),
        (99, "fold = 99: the pattern has it at no mask, so no slot has any room"),
    ],
)
def test_a_fold_that_leaves_no_room_is_refused(designs, fold, message):
    with pytest.raises(ArgumentError, match=message):
        compass.keep(designs / "compass-15-5-1.toml", fold=fold, years=0.1)


def test_no_box_is_made_of_a_margin_that_is_none(designs):
    """The design is for five sites; asked for the whole sphere no margin is left."""
    said = "fold = 4: the whole sphere does not have it above 10 deg, so no slot has any room"
    with pytest.raises(ArgumentError, match=said):
        compass.keep(designs / "five-landing-sites.toml", years=0.1, mask_deg=10.0)


def test_a_slot_that_has_left_an_unstable_point_is_kept_by_few_burns_again():
    """Under a constant push every ``4 sqrt(w / u'')``, though it once came out on the other side.

    Burns fall on the day after the edge is met: up to a day in an interval of 24.
    """
    width, bend, axis = np.radians(3.0), np.radians(0.08), 2.04e7
    controller = _Slots(1, axis, width, 0.0)
    controller.reach[:] = 0.5
    place, speed, burnt = np.zeros(1), np.zeros(1), []
    for day in range(700):
        kick = controller.look(day * DAY, place, place, np.ones(1))
        if kick[0]:
            burnt.append(day)
        # the impulse comes half a step after the look
        after = speed + 0.5 * bend - 3.0 * kick * DAY / axis
        place, speed = place + 0.5 * (speed + after) + 0.125 * bend, after + 0.5 * bend
    assert np.diff(burnt)[0] < 20
    assert controller.reach[0] == 1.0
    assert np.diff(burnt)[-5:] == pytest.approx(4.0 * np.sqrt(width / bend), abs=1.0)


def test_what_no_forces_are_known_of_is_not_kept():
    oblate = read_design_text(STILL.format(anomaly=0) + '[motion]\nmodel = "j2"\n')
    with pytest.raises(ArgumentError, match=r"^keep: needs forces, which mean motion under J2"):
        compass.keep(oblate, box_deg=1.0)
