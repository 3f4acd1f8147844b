"""Guided and dispersed entries: by their limits, against other flights, turned about."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from compass.api.land import land
from compass.api.land_dispersed import dispersed_facts, dispersed_sentence, distance_words
from compass.api.land_flight import assess_scenario
from compass.core.entry.guide import beyond, heading_error, turned
from compass.entry.accuracy import accuracy
from compass.entry.carried import CarriedFilter
from compass.entry.covariance import axes_covariance, linear_covariance
from compass.entry.dispersed import FAR, Dispersed, fly_dispersed
from compass.entry.guidance import Dispersion, Guidance, with_bank
from compass.entry.layout import Layout
from compass.entry.schedule import Measurements
from compass.entry.start import Trigger
from compass.entry.trajectory import fly
from compass.entry.views import cartesian_of, spherical_of
from compass.errors import ArgumentError, DesignError
from compass.frames import direction
from compass.inputs.fusion import fusion_plan
from compass.inputs.scenario import read_scenario, read_scenario_text
from compass.pages.landing import landing_sections

DESIGNS = Path(__file__).parents[2] / "designs"
FAST = Trigger("fast", "speed", 3000.0)


@pytest.fixture(scope="module")
def guided_lander():
    return read_scenario(DESIGNS / "landing-guided.toml")


def short_of(lander, dispersion, trigger=FAST, **options):
    return fly_dispersed(
        lander.truth, lander.model, lander.state, dispersion, 120.0, trigger=trigger, **options
    )


def test_without_dispersions_every_entry_is_the_planned_one(guided_lander):
    """And that is the flight of the adaptive integrator, to what the steps of 1 s leave."""
    lander, model = guided_lander, guided_lander.model
    assert model.atmosphere.table_radius  # in layers, whose edges no step crosses
    found = short_of(lander, Dispersion(3))
    assert np.abs(found.offsets).max() < 1e-6 and not found.guided
    flight = fly(model, lander.state, [0.0, 120.0], triggers=[FAST])
    [event] = [one for one in flight.events if one.name == FAST.name]
    assert found.times == pytest.approx([event.time] * 3, abs=1e-5)
    planned = cartesian_of(event.state[:6])
    np.testing.assert_allclose(found.ends, np.tile(planned, (3, 1)), rtol=0, atol=0.01)


@pytest.mark.slow
def test_scatter_is_that_of_linear_delivery(guided_lander):
    """Sigmas of the flights, along, across and down, against the covariance on the surface."""
    model, prior = guided_lander.model, axes_covariance(300.0, 0.2)
    times = np.arange(0.0, 121.0)
    flight = fly(model, guided_lander.state, times, triggers=[FAST])
    beacons = guided_lander.beacons(times)
    none = np.zeros((times.size, beacons.size), bool)
    bound = linear_covariance(model, flight.path, beacons, none, Measurements(50.0), prior)
    linear = accuracy(flight, bound, Layout(beacons=beacons.size), prior, 0.0, FAST).delivery
    found = short_of(guided_lander, Dispersion(2000, 300.0, 0.2))
    assert found.reached.all()
    # 2000 draws: a sigma is good to 1/sqrt(4000)
    assert found.ellipse.semi_major == pytest.approx(linear.ellipse.semi_major, rel=0.07)
    assert found.ellipse.semi_minor == pytest.approx(linear.ellipse.semi_minor, rel=0.07)
    assert found.within(50.0) == pytest.approx(linear.cep, rel=0.07)


@pytest.mark.slow
def test_guidance_flies_on_what_its_filter_knows(guided_lander):
    """Errors of the filter come down with the vehicle, and a perfect one changes nothing."""
    lander = guided_lander
    few = replace(lander.dispersion, entries=24)
    assessed = assess_scenario(lander, 2)

    def flown(**changes):
        settings = replace(lander.settings, **changes)
        carried = CarriedFilter(
            assessed.flight, assessed.beacons, assessed.taken, lander.measurements, settings
        )
        return fly_dispersed(
            lander.truth, lander.model, lander.state, few, 300.0, trigger=lander.deployment,
            guidance=lander.guidance, carried=carried, seed=7,
        )  # fmt: skip

    good = flown()
    assert good.reached.all() and good.claims_hold and 3.0 < good.knowledge < 15.0
    sure = flown(parts=(), method="plain")
    assert not sure.claims_hold and sure.knowledge > 300.0
    assert sure.within(50.0) > 2 * good.within(50.0)
    assert "and inconsistent: NEES" in dispersed_sentence(sure)
    # known to a millimetre, and nothing dispersed: as if the state were known as it is
    few = Dispersion(3)
    known = {"covariance0": axes_covariance(1e-3, 1e-6), "parts": ()}
    near, root = (flown(**known, method=method) for method in ("plain", "square-root"))
    np.testing.assert_allclose(root.ends[:, :3], near.ends[:, :3], rtol=0, atol=0.01)
    assert root.nees == pytest.approx(near.nees, rel=1e-3)
    truth = fly_dispersed(
        lander.truth, lander.model, lander.state, few, 300.0, trigger=lander.deployment,
        guidance=lander.guidance,
    )  # fmt: skip
    np.testing.assert_allclose(near.ends[:, :3], truth.ends[:, :3], rtol=0, atol=50.0)
    assert near.knowledge < 0.1


@pytest.mark.slow
def test_guidance_brings_all_to_the_target(guided_lander):
    """The planned one within a cycle's way; the adaptive integrator flies its bank to there too."""
    lander, trigger = guided_lander, guided_lander.deployment
    options = {"trigger": trigger, "guidance": lander.guidance, "seed": 3}
    worlds = lander.truth, lander.model, lander.state
    exact = fly_dispersed(*worlds, Dispersion(3), 300.0, **options)
    assert exact.within(100.0) < 200.0 and not exact.beyond.any()
    bank = lander.planned().model.vehicle.bank_schedule()
    limit = np.degrees(lander.guidance.rate) * 1.0 + 1e-9
    assert np.abs(np.diff(np.degrees(bank[:, 1]))).max() <= limit
    flight = fly(with_bank(lander.truth, bank), lander.state, [0.0, 300.0], triggers=[trigger])
    [event] = [one for one in flight.events if one.name == trigger.name]
    assert event.time == pytest.approx(exact.times[0], abs=1e-3)
    assert np.linalg.norm(cartesian_of(event.state[:6])[:3] - exact.ends[0, :3]) < 1.0
    spread = Dispersion(40, 1000.0, 0.5, 0.05, 0.01)
    there = fly_dispersed(*worlds, spread, 300.0, threads=1, **options)
    again = fly_dispersed(*worlds, spread, 300.0, threads=3, **options)
    assert np.array_equal(there.ends, again.ends)
    open_loop = fly_dispersed(with_bank(lander.truth, bank), *worlds[1:], spread, 300.0,
                              trigger=trigger, seed=3)  # fmt: skip
    assert there.reached.all() and open_loop.reached.all()
    assert there.within(95.0) < 0.25 * open_loop.within(95.0)
    near = np.abs(there.beyond) < FAR
    assert np.hypot(*there.offsets[near].T).max() < 1500.0
    # out of reach of its bank what guidance foresees is what comes of it
    steep = replace(lander.guidance, least=np.radians(60.0))
    short = fly_dispersed(*worlds, Dispersion(3), 300.0, **options | {"guidance": steep})
    assert -short.beyond == pytest.approx(np.hypot(*short.offsets.T), rel=0.15)
    assert short.beyond.max() < -5e3


def test_guidance_turns_with_the_problem(world, table5):
    """On a sphere at rest a turn of start and target turns where each entry comes."""
    model = world("none")
    start, rng = cartesian_of(table5), np.random.default_rng(4)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    both = np.kron(np.eye(2), turn)
    flight = fly(model, table5, [0.0, 150.0])
    # off the plane of flight: straight ahead, rounding would choose the side of the first bank
    aim = flight.path[-1, :3] / np.linalg.norm(flight.path[-1, :3])
    aim += 0.005 * np.cross(start[:3], start[3:]) / np.linalg.norm(np.cross(start[:3], start[3:]))
    aim /= np.linalg.norm(aim)
    ends = []
    for state, target in ((start, aim), (both @ start, turn @ aim)):
        latitude, longitude = np.arcsin(target[2]), np.arctan2(target[1], target[0])
        guidance = Guidance(latitude, longitude, cycle=20.0, felt=0.02)
        slow = Trigger("slow", "speed", 5000.0)
        found = fly_dispersed(
            model, model, spherical_of(state), Dispersion(3), 200.0,
            trigger=slow, guidance=guidance,
        )  # fmt: skip
        assert found.reached.all()
        ends.append(found.ends[0])
    np.testing.assert_allclose(both @ ends[0], ends[1], rtol=0, atol=1.0)


def test_angles_of_the_guidance():
    east = np.array([3.4e6, 0.0, 0.0, -10.0, 100.0, 0.0])  # over 0 E, flying east and down
    north_of_east = Guidance(np.radians(1.0), np.radians(10.0)).numbers()
    assert heading_error(east, north_of_east) == pytest.approx(-np.radians(5.74), abs=1e-3)
    ahead = Guidance(0.0, np.radians(10.0)).numbers()
    assert heading_error(east, ahead) == 0.0
    for place in (8.0, 13.0):
        end = 3.4e6 * direction(0.0, np.radians(place))
        assert beyond(east, end, ahead) == pytest.approx(np.radians(place - 10.0), rel=1e-9)
    assert turned(0.5, -1.0, 0.2) == pytest.approx(0.3) and turned(0.5, 0.6, 0.2) == 0.6


def test_what_dispersed_entries_say():
    ends = np.zeros((4, 6))
    ends[:, :3] = 3.4e6 * direction(np.radians([0.0, 0.1, -0.1, 0.0]), np.radians([0, 0, 0, 0.1]))
    found = Dispersed("parachute", np.ones(4), ends, direction(0.0, 0.0), True)
    way = 3.4e6 * np.radians(0.1)
    expected = np.array([[0, 0], [0, way], [0, -way], [way, 0]])
    np.testing.assert_allclose(found.offsets, expected, rtol=1e-9, atol=1e-6)
    said = dispersed_sentence(found)
    assert said.startswith("Of 4 dispersed guided entries half come to parachute within 5.93 km of")
    # the median of four lies beyond the least, or the greatest, in one of sixteen cases each
    assert found.within_bounds(50.0) == (0.0, np.inf)
    facts = dispersed_facts(found)
    assert facts["within_m"]["p95_interval"][0] <= facts["within_m"]["p95"]
    assert facts["reached_share_interval"] == pytest.approx((0.025**0.25, 1.0))
    lost = replace(found, times=np.array([1.0, 1.0, 1.0, np.nan]), guided=False)
    assert lost.within(95.0) == np.inf
    assert "95 % within no distance" in dispersed_sentence(lost)
    assert dispersed_sentence(lost).endswith("; 1 do not come to it.")
    assert [distance_words(m) for m in (76.5, 999.0, 5934.0)] == ["76.5 m", "999 m", "5.93 km"]
    few = replace(found, times=np.full(4, np.nan))
    assert dispersed_sentence(few) == "Of 4 dispersed guided entries 0 come to parachute."
    assert dispersed_facts(few)["ellipse"] is None and dispersed_facts(found)["reached"] == 4
    assert "limits" not in said and dispersed_facts(found)["beyond_m"] is None
    near = replace(found, beyond=np.array([0.0, -400.0, 0.0, 0.0]))
    assert dispersed_sentence(near).endswith(" keep none of them from the target.")
    far = replace(found, beyond=np.array([0.0, -12.34e3, 700.0, -600.0]))
    assert dispersed_sentence(far).endswith(
        "The bank's limits keep 3 of them from the target: 2 come short, by up to 12.3 km, and 1 "
        "come too far, by up to 0.7 km, as guidance foresees."
    )


def test_what_cannot_be_is_refused(guided_lander):
    with pytest.raises(ArgumentError, match="the planned entry does not come to never by 120 s"):
        short_of(guided_lander, Dispersion(3), Trigger("never", "speed", 1.0))
    with pytest.raises(ArgumentError, match="bank from 90 to 30 deg"):
        Guidance(0.0, 0.0, np.radians(90), np.radians(30))
    with pytest.raises(ArgumentError, match="cycle = 0: must be above 0"):
        Guidance(0.0, 0.0, cycle=0.0)
    text = guided_lander.text.replace("lift_to_drag = 0.24", "lift_to_drag = 0.24\nbank_deg = 3")
    text = text.replace("[guidance]", "[guidance]\nmost_bank_deg = 10")
    with pytest.raises(DesignError) as told:
        read_scenario_text(text, folder=DESIGNS)
    for words in (
        "vehicle.bank_deg = 3: not beside [guidance]",
        "guidance.most_bank_deg = 10: must be above least_bank_deg = 20",
    ):
        assert words in str(told.value)


@pytest.mark.slow
def test_fused_filters_fly_the_bank_that_guidance_finds(guided_lander):
    table = (DESIGNS / "lou2019-recommended.toml").read_text()
    table = table[table.index("[fusion]") : table.index("[[fusion.fault]]")]
    table = "\n".join(line for line in table.splitlines() if not line.startswith("range_sigma"))
    lander = read_scenario_text(guided_lander.text + table, folder=DESIGNS)
    lander = replace(lander, times=lander.times[lander.times <= 120.0])
    plan, planned = fusion_plan(lander), lander.planned().model.vehicle
    assert len(planned.bank_times) > 5
    assert plan.case.flight.model.vehicle == planned
    assert all(one.model.vehicle == planned for one in plan.filters)


def test_a_guided_landing_says_where_entries_come_down(guided_lander):
    """High up, where nothing is felt yet and the bank is held; the lander knows its own bank."""
    text = guided_lander.text.replace("speed_m_s = 406", "altitude_km = 90")
    text = text.replace("duration_s = 300", "duration_s = 30\nstep_s = 5")
    text = text.replace("entries = 200", "entries = 3").replace("runs = 100", "runs = 2")
    text = text.replace("[guidance]", "[guidance]\nstart_g = 10")
    lander = read_scenario_text(text, folder=DESIGNS)
    found = land(lander)
    craft = found.assessment.flight.model.vehicle
    assert craft.bank_times == (0.0,)
    assert np.abs(craft.bank_angles) == pytest.approx([np.radians(60.0)])
    told = " ".join(str(found).split())
    # what guidance makes of it comes first, in words, rows and the picture
    assert told.index("Of 3 dispersed guided entries half come") < told.index("By the planned bank")
    answer, _, flight, *_ = landing_sections(found)
    assert answer.blocks[1].rows[1].question.startswith("Guided, entries come to the target within")
    (drawn,) = answer.pictures
    assert drawn.stem == "landing-arrivals" and "3 dispersed guided entries" in drawn.alt
    assert flight.pictures[0].stem == "landing-ellipse"
    assert found.to_dict()["dispersed"]["reached"] == 3
    assert found.sections(pictures=False)[0].paragraphs[0] == found.claim
    alone = replace(found, dispersed=None)
    assert "dispersed" not in alone.to_dict() and "dispersed" not in alone.claim
