"""Landings that once went wrong without a word, from scenario to answer."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from compass.api.land_facts import entry_facts
from compass.api.land_flight import assess_scenario, disperse_scenario, entry_section
from compass.entry.consistency import nees_bounds
from compass.entry.fused_runs import monte_carlo
from compass.entry.trajectory import fly, trajectory_dataset
from compass.errors import DesignError
from compass.inputs.fusion import fusion_plan
from compass.inputs.scenario import read_scenario_text
from compass.pages.landing import answers
from compass.study.judge import check_measurements

# whole landings, and filters that blow up: too slow and too loud where kernels are interpreted
pytestmark = pytest.mark.slow

DESIGNS = Path(__file__).parents[2] / "designs"

PLAIN = """
name = "a landing"
[planet]
rotation = "full"
[vehicle]
drag_area_per_mass_m2_kg = 0.016
lift_to_drag = 0.156
bank_deg = 0
[atmosphere]
reference_density_kg_m3 = 2e-4
reference_radius_km = 3437.2
scale_height_km = 7.5
[entry]
radius_km = 3522
longitude_deg = -90.07
latitude_deg = -28.22
speed_m_s = 6000
flight_path_deg = -15
heading_deg = 4.956
heading_from = "east"
duration_s = 240
step_s = 8
[measurements]
range_sigma_m = 50
interval_s = 8
[filter]
position_sigma_m = 1000
velocity_sigma_m_s = 0.5
[monte_carlo]
runs = 40
[[orbiter]]
name = "one"
altitude_km = 17000
inclination_deg = 30
raan_deg = -90
latitude_argument_deg = 0
"""
OTHERS = "".join(
    f'[[orbiter]]\nname = "{name}"\naltitude_km = 17000\ninclination_deg = {inclination}\n'
    f"raan_deg = {raan}\nlatitude_argument_deg = {argument}\n"
    for name, inclination, raan, argument in (
        ("two", 60, -60, -20), ("three", 50, -120, -40), ("four", 80, -100, -60),
    )
)  # fmt: skip


def changed(*changes, text=PLAIN):
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return text


def section_of(scenario, runs=None):
    found = assess_scenario(scenario, runs)
    return found, entry_section(scenario, found, pictures=False).paragraphs


@pytest.mark.parametrize(
    "change",
    [
        (("runs = 40", "runs = 40"),),
        (("position_sigma_m = 1000", "position_sigma_m = 1e9"), ("velocity_sigma_m_s = 0.5",
         "velocity_sigma_m_s = 1e6")),
    ],
    ids=["one beacon", "a prior of a million kilometres"],
)  # fmt: skip
def test_inconsistent_filters_claim_nothing(change):
    scenario = read_scenario_text(changed(*change))
    found, (first, second, *others) = section_of(scenario)
    assert not found.consistency.holds
    assert "no accuracy is claimed" in first
    assert "observable throughout" not in " ".join(others)
    assert "by a consistent filter it would be known to" in others[0]
    told = entry_facts(scenario, found)["observability"]["sentence"]
    assert "which is no accuracy" in told and told in others
    assert sum(one.holds is False for one in answers(found)) == 3  # place, errors, observed
    assert second.startswith("The filter is inconsistent and makes no claim of accuracy: ")
    lost = "1e9" in change[0][1]
    assert ("comes down nobody knows where" in first) is found.accuracy.anywhere is lost
    assert not lost or "km" not in first
    assert (entry_facts(scenario, found)["landing"]["delivery"] is None) is lost


def test_a_truth_with_more_air_is_told_and_four_satellites_are_believed():
    good, (first, second, *others) = section_of(read_scenario_text(PLAIN + OTHERS))
    assert good.consistency.holds and second.startswith("The filter is consistent")
    assert "observable throughout" in " ".join(others) and "down: known to" in others[0]
    assert good.claim_m >= np.linalg.norm(good.accuracy.knowledge.along_cross_down)
    assert f"knows its place to {good.claim_m:.3g} m" in first
    thick = "[truth]\ndensity_bias = 0.2\n" + "[measurements]"
    bad, words = section_of(
        read_scenario_text(changed(("[measurements]", thick)) + OTHERS), runs=10
    )
    assert not bad.consistency.holds and "too sure of itself" in words[1]
    assert "10 of 10 runs lost their way" in words[1]
    assert bad.consistency.ratio > 10


@pytest.mark.parametrize("step", [1, 30])
def test_bank_switches_between_epochs_leave_one_truth(step):
    """The Monte Carlo's truth is the reported flight, whose peak does not depend on the step."""
    banks = ("bank_deg = 0", "bank_deg = [[0, -60], [80.5, 60], [140.5, -60]]")
    steps = (("step_s = 8", f"step_s = {step}"), ("interval_s = 8", f"interval_s = {step}"))
    scenario = read_scenario_text(changed(banks, *steps) + OTHERS)
    found, _ = section_of(scenario, runs=20)
    assert found.consistency.holds
    tables = entry_section(scenario, found, pictures=False).tables
    [peak] = [table.rows[0] for table in tables if table.title == "Largest loads"]
    fine = trajectory_dataset(fly(scenario.truth, scenario.state, np.arange(0.0, 240.0, 0.05)))
    assert peak[1] == pytest.approx(float(fine.g_load.max()), rel=1e-5)
    # a truth some hundred metres off would be tens of sigmas
    assert found.monte_carlo.position_rms[-1] < 2 * found.bound.position_sigma[-1]


def test_missed_triggers_and_strange_values_are_told():
    slow = (
        '[[trigger]]\nname = "crawl"\nspeed_m_s = 1\n[[trigger]]\nname = "high"\naltitude_km = 50\n'
    )
    text = changed(
        ("[measurements]", slow + "[measurements]"), ("speed_m_s = 6000", "speed_m_s = 3000")
    )
    scenario = read_scenario_text(text)
    found, words = section_of(scenario, runs=2)
    assert [event.name for event in found.flight.events] == ["high"]
    assert "Not reached: crawl: speed 1 m/s is not fallen to by 240 s." in words
    assert any("entry.speed_m_s = 3000: beyond what entries at Mars have been" in w for w in words)
    assert entry_facts(scenario, found)["missed_triggers"]


def test_a_start_by_vectors_and_a_lander_without_drag_are_looked_at_too():
    text = (DESIGNS / "entry-compass.toml").read_text()
    text = text.replace("[5775.31, 1124.27, 1175.48]", "[1775.31, 124.27, 175.48]")
    text = text.replace('"compass-15-5-1.toml"', f'"{DESIGNS}/compass-15-5-1.toml"')
    speed, drag = read_scenario_text(text.replace("m2_kg = 0.016", "m2_kg = 0")).notes
    assert speed.startswith("entry.speed_m_s = 1788: beyond")
    assert drag.startswith("vehicle.ballistic_coefficient_kg_m2 = inf: beyond")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("speed_m_s = 6000", "speed_m_s = 6", "at least 100"),
        ("scale_height_km = 7.5", "scale_height_km = 7500", "at most 100"),
        ("drag_area_per_mass_m2_kg = 0.016", "drag_area_per_mass_m2_kg = 62.5", "at most 1"),
        ("drag_area_per_mass_m2_kg = 0.016", "ballistic_coefficient_kg_m2 = 0.016", "at least 1"),
    ],
)
def test_what_cannot_be_is_refused(old, new, said):
    with pytest.raises(DesignError, match=said):
        read_scenario_text(changed((old, new)))


def test_a_table_is_flown_as_given(tmp_path):
    (tmp_path / "air.txt").write_text("0 0.0155\n20 0.0021\n40 2.6e-4\n60 2.6e-5\n80 1.9e-6\n")
    beside = read_scenario_text(
        changed(("scale_height_km = 7.5", 'scale_height_km = 7.5\ntable = "air.txt"')),
        folder=tmp_path,
    )
    radius = beside.model.planet_radius
    found = beside.model.atmosphere.density(radius + np.array([0.0, 20e3, 40e3, 80e3]))
    np.testing.assert_allclose(found, [0.0155, 0.0021, 2.6e-4, 1.9e-6], rtol=1e-12)
    assert len(beside.notes) == 3
    assert all("not used beside a table" in note for note in beside.notes)
    three = "reference_density_kg_m3 = 2e-4\nreference_radius_km = 3437.2\nscale_height_km = 7.5"
    alone = read_scenario_text(changed((three, 'table = "air.txt"')), folder=tmp_path)
    assert alone.notes == ()
    with pytest.raises(DesignError, match=r"atmosphere\.scale_height_km: missing"):
        read_scenario_text(changed(("scale_height_km = 7.5\n", "")))


def test_a_scenario_without_air_flies_in_that_of_mars():
    """The mean profile, told so; its weight is the pressure at the ground that it came with."""
    head, tail = PLAIN.split("[atmosphere]")
    bare = read_scenario_text(head + tail[tail.index("[entry]") :])
    assert any("mean profile of Mars-GRAM" in note for note in bare.notes)
    air, r0 = bare.model.atmosphere, bare.model.planet_radius
    r = r0 + np.linspace(0.0, 125e3, 5001)
    weight = np.trapezoid(air.density(r) * bare.model.gm / r**2, r)
    assert weight == pytest.approx(566.9, rel=0.05)  # a mean of many airs, each in balance
    slow = fly(bare.model, bare.state, np.arange(0.0, 300.0, 10.0)).speed[-1]
    assert slow < 1000
    with pytest.raises(DesignError, match="or none of the three for a mean profile"):
        read_scenario_text(changed(("scale_height_km = 7.5\n", "")))


@pytest.mark.parametrize("seed", range(3))
def test_one_run_says_what_many_runs_find(seed):
    """Linear covariance and Monte Carlo, over landings drawn anywhere: position and delivery."""
    rng = np.random.default_rng(seed)
    lat, lon = np.degrees(np.arcsin(rng.uniform(-1, 1))), rng.uniform(-180, 180)
    text = changed(
        ("latitude_deg = -28.22", f"latitude_deg = {lat}"),
        ("longitude_deg = -90.07", f"longitude_deg = {lon}"),
        ("heading_deg = 4.956", f"heading_deg = {rng.uniform(0, 360)}"),
        ("bank_deg = 0", f"bank_deg = [[0, 60], [{rng.uniform(60, 200)}, -60]]"),
        ("range_sigma_m = 50", f"range_sigma_m = {rng.uniform(5, 50)}"),
    )
    text = text[: text.index("[[orbiter]]")]
    text += '[beacons]\ndesign = "compass-15-5-1.toml"\n'
    position, velocity = rng.uniform(200, 1000), rng.uniform(0.1, 0.5)
    text = changed(
        ("position_sigma_m = 1000", f"position_sigma_m = {position}"),
        ("velocity_sigma_m_s = 0.5", f"velocity_sigma_m_s = {velocity}"),
        text=text,
    )
    text += f'[[trigger]]\nname = "parachute"\nspeed_m_s = {rng.uniform(1000, 4000)}\n'
    text += f"[dispersion]\nentries = 1000\nposition_m = {position}\nvelocity_m_s = {velocity}\n"
    scenario = read_scenario_text(text, folder=DESIGNS)
    found = assess_scenario(scenario, 200)
    assert found.consistency.holds
    ratio = found.monte_carlo.position_rms[5:] / found.bound.position_sigma[5:]
    # a root of a mean square of one dominant direction over 200 runs: 5 % each, five of these
    assert np.abs(ratio - 1).max() < 0.25
    # 1000 entries that scatter as the prior says: a sigma is good to 2.2 %, five of these
    scattered, linear = disperse_scenario(scenario, found), found.accuracy.delivery.ellipse
    assert scattered.reached.all()
    for axis in ("semi_major", "semi_minor"):
        assert getattr(scattered.ellipse, axis) == pytest.approx(getattr(linear, axis), rel=0.11)


@pytest.mark.parametrize("kind", ["iterated-ekf", "square-root-ekf"])
def test_ranges_of_a_centimetre_are_borne(kind):
    """Five orders between prior and ranges, and claims of a millimetre that hold, in layers too."""
    text = changed(
        ("range_sigma_m = 50", "range_sigma_m = 0.01"),
        ("[monte_carlo]", f'kind = "{kind}"\n[monte_carlo]'),
    )
    if kind == "square-root-ekf":
        text = text[: text.index("[atmosphere]")] + text[text.index("[entry]") :]
    found, _ = section_of(read_scenario_text(text + OTHERS))
    assert found.consistency.holds and found.bound.position_sigma[-1] < 0.01


INSTRUMENTS = """
two_way = { range_sigma_m = 5, range_rate_sigma_m_s = 0.01 }
altimeter = { sigma_m = 10, share = 0.01, below_km = 20, interval_s = 8 }
velocimeter = { sigma_m_s = 0.2, share = 0.002, below_km = 30, interval_s = 8 }
features = { sigma_deg = 0.1, below_km = 60, interval_s = 16 }
"""


def test_a_landing_with_all_its_instruments():
    """Altimeter, velocimeter, camera and radio both ways: read, counted, told, consistent."""
    more = INSTRUMENTS + (
        '[[feature]]\nname = "rim"\nlatitude_deg = -27\nlongitude_deg = -78\nheight_km = -2\n'
    )
    text = changed(
        ("interval_s = 8\n", "interval_s = 8\n" + more), ("[monte_carlo]",
        "attitude = { sigma_deg = 0.05 }\nclock = { sigma_m = 3e4, drift_sigma_m_s = 0.3 }\n"
        "[monte_carlo]"),
    )  # fmt: skip
    scenario = read_scenario_text(text + OTHERS)
    found, _ = section_of(scenario)
    plain, _ = section_of(read_scenario_text(PLAIN + OTHERS))
    assert found.consistency.holds and found.whole.holds and found.whole.states == 11
    assert found.bound.position_sigma[-1] < 0.5 * plain.bound.position_sigma[-1]
    readings = entry_facts(scenario, found)["readings"]
    assert readings["height over the sphere"] > 0
    assert readings["directions to surface features"] % 3 == 0
    [table] = [
        t
        for t in entry_section(scenario, found, pictures=False).tables
        if t.title == "Beside one-way radio"
    ]
    assert len(table.rows) == 5
    check_measurements(scenario)


def test_air_that_wanders_is_worth_less_than_a_factor():
    """Along a flight the bound of one unknown factor is far too good (6.2 m against 16.7)."""
    text = (DESIGNS / "entry-compass.toml").read_text()
    bounds = []
    for more in ("sigma = 0.1", "sigma = 0.1\nscale_km = 8.2", "sigma = 0.1\nscale_km = 1000"):
        scenario = read_scenario_text(f"{text}\n[filter.density]\n{more}\n", folder=DESIGNS)
        bounds.append(assess_scenario(scenario, 2).bound.position_sigma)
    assert bounds[0][240] == pytest.approx(6.17, abs=0.01)
    assert bounds[1][240] == pytest.approx(16.7, abs=0.05)
    assert bounds[0][240] < bounds[2][240] < bounds[1][240]
    # a few per cent of air that wander are told apart, and the claims hold
    calm = f"{text}\n[filter.density]\nsigma = 0.02\nscale_km = 8.2\nalong_km = 300\n"
    found, _ = section_of(read_scenario_text(calm, folder=DESIGNS), 60)
    assert found.consistency.holds


def test_the_ground_is_a_place_to_land():
    """Where a flight is not stopped before, and past deployment where it goes on."""
    flat = ("bank_deg = 0", "bank_deg = 90"), ("duration_s = 240", "duration_s = 400")
    found, words = section_of(read_scenario_text(changed(*flat) + OTHERS), runs=2)
    assert found.accuracy.name == "ground" and found.accuracy.projected and found.ground is None
    assert words[0].startswith("At ground (")
    assert abs(found.accuracy.knowledge.along_cross_down[2]) < 1e-3  # on it, neither over nor under
    chute = '[[trigger]]\nname = "parachute"\nmach = 2\n[measurements]'
    scenario = read_scenario_text(changed(*flat, ("[measurements]", chute)) + OTHERS)
    both, words = section_of(scenario, runs=2)
    assert both.accuracy.name == "parachute" and both.ground.time == found.accuracy.time
    assert any(word.startswith("On the ground (") for word in words)
    facts = entry_facts(scenario, both)["landing"]["ground"]
    assert facts["time_s"] == found.accuracy.time


FUSION = """
[[beacon]]
name = "surface"
latitude_deg = -27
longitude_deg = -84
[beacons]
mask_deg = 60
[fusion]
filters = ["ekf"]
p0_si = [1e6, 1e-6, 1e-6, 100, 1e-6, 1e-6]
process_noise_si = [1, 1e-14, 1e-14, 1e-2, 1e-10, 1e-10]
acceleration_sigma_m_s2 = 1e-3
"""


def test_fusion_honours_masks_schedule_and_noise():
    """[beacons], [measurements] and the step mean the same with accelerometers as without."""
    text = PLAIN + OTHERS + FUSION
    masked, plain = (
        fusion_plan(read_scenario_text(t)) for t in (text, text.replace("mask_deg = 60", ""))
    )
    assert masked.case.visible[:, 0].sum() < plain.case.visible[:, 0].sum()
    np.testing.assert_allclose(masked.case.sigma[:, 0], 50.0)
    # variances a second: eight times as much in eight seconds
    filtered = masked.filters[0]
    steps = np.diff(masked.case.times)
    assert steps[0] == 8.0 and filtered.noise[0] == 1.0
    known = filtered.problem(masked.case)
    up = masked.case.flight.path[1, :3] / np.linalg.norm(masked.case.flight.path[1, :3])
    assert ((up @ known.noise[1, :3]) ** 2).sum() == pytest.approx(8.0)
    late = fusion_plan(read_scenario_text(text.replace("interval_s = 8", "interval_s = 16")))
    truth = late.case.truth(late.filters[0].layout, np.zeros((late.case.times.size, 6)))
    heard = np.isfinite(truth.world.variances[:, : late.case.beacons.size])
    assert not heard[1::2].any() and heard[::2].any()
    ends = [
        float(monte_carlo(p.case, p.filters[0], 2, 0)[0].position_rmse[-1]) for p in (masked, plain)
    ]
    assert ends[0] != ends[1]
    both = text.replace("range_sigma_m = 50", "range_sigma_m = 50\nrange_rate_sigma_m_s = 0.1")
    rated = fusion_plan(read_scenario_text(both))
    better = monte_carlo(rated.case, rated.filters[0], 2, 0)[0]
    poorer = monte_carlo(plain.case, plain.filters[0], 2, 0)[0]
    assert better.sigma[-1, 3:6].max() < 0.5 * poorer.sigma[-1, 3:6].max()


def test_a_fused_filter_finds_its_clock():
    """Drawn anew in each run, estimated beside density and L/D, and its claims hold."""
    eight = FUSION.replace("1e-6, 1e-6]", "1e-6, 1e-6, 0.01, 1e-4]").replace(
        "1e-10, 1e-10]", "1e-10, 1e-10, 1e-8, 1e-8]"
    )
    more = "clock = { sigma_m = 3e4, drift_sigma_m_s = 0.3 }\nnoisy_truth = true\n"
    text = PLAIN + OTHERS + eight.replace('["ekf"]\n', f'["iterated"]\nrandom_start = true\n{more}')
    plan = fusion_plan(read_scenario_text(text.replace("mask_deg = 60", "")))
    found, first = monte_carlo(plan.case, plan.filters[0], 60, 3)
    assert list(found.state.values[-4:]) == ["ln density", "L/D", "clock", "clock drift"]
    low, high = nees_bounds(10, 60, 0.999)
    assert low < float(found.nees[-1]) < high and found.attrs["diverged"] == 0
    # 3e4 m at first; at the end as well as the ranges tell the place
    assert np.abs(first.error[0, -2]) < 1e3 and found.rmse[-1, -2] < 60.0
    without = fusion_plan(read_scenario_text(text.replace("mask_deg = 60", "").replace(more, "")))
    assert without.filters[0].states == 8
    fixed = replace(plan.filters[0], random_start=False)
    starts = fixed.starts(np.ones((2, 13)))
    np.testing.assert_allclose(starts[:, -2:], [[3e4, 0.3]] * 2)
    np.testing.assert_array_equal(starts[:, :6], [fixed.first] * 2)


def test_a_mask_of_a_design_holds_in_landing_as_in_judging(tmp_path):
    design = """
name = "{name}"
[constellation]
pattern = "walker-delta"
satellites = 15
planes = 5
phasing = 1
inclination_deg = 45
radius_km = 20427
[coverage]
mask_deg = {mask}
"""
    seen = {}
    for mask in (0, 30):
        (tmp_path / "d.toml").write_text(design.format(name="ring", mask=mask))
        text = PLAIN[: PLAIN.index("[[orbiter]]")] + '[beacons]\ndesign = "d.toml"\n'
        scenario = read_scenario_text(text, folder=tmp_path)
        found = assess_scenario(scenario, 2)
        seen[mask] = found.seen.sum(axis=1)
    assert seen[0].min() >= 6
    assert seen[30].max() <= 4


def test_what_is_not_known_counts():
    """Clock, density, L/D and biases: estimated or considered, in bound, filter and answer."""
    blocks = """clock = { sigma_m = 30, drift_sigma_m_s = 0.1 }
density = { sigma = 0.02 }
lift_to_drag = { sigma = 0.002 }
range_bias = { sigma = 10, considered = true }
[monte_carlo]
"""
    text = PLAIN + OTHERS
    assert "[monte_carlo]\n" in text
    more = read_scenario_text(text.replace("[monte_carlo]\n", blocks))
    plain, _ = section_of(read_scenario_text(text))
    found, _ = section_of(more)
    layout = more.settings.layout(4)
    assert (layout.size, layout.estimated) == (14, 10)
    assert found.whole.states == 10
    assert np.all(found.bound.position_sigma >= plain.bound.position_sigma)
    assert found.consistency.holds
    # delivery, too: density and L/D move the vehicle
    assert found.accuracy.delivery.cep > plain.accuracy.delivery.cep
    off = replace(found, whole=replace(found.whole, nees=5 * found.whole.nees))
    told = entry_section(more, off, pictures=False).paragraphs
    assert any("All 10 states that it estimates together are inconsistent" in w for w in told)
    assert entry_facts(more, off)["consistency"]["whole_state_consistent"] is False
    check_measurements(more)  # of biases that are considered, too
