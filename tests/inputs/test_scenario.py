"""Scenario files: what they become, and every fault said at once."""

from pathlib import Path

import numpy as np
import pytest

from compass.entry.views import cartesian_of, spherical_jacobian
from compass.errors import ArgumentError, DesignError
from compass.inputs.fusion import fusion_plan
from compass.inputs.scenario import provenance, read_scenario, read_scenario_text

DESIGNS = Path(__file__).parents[2] / "designs"
GROUND = (DESIGNS / "entry-ground-beacons.toml").read_text()
ORBITERS = (DESIGNS / "entry-orbiters.toml").read_text()


def read(text, **options):
    return read_scenario_text(text, "s.toml", **options)


def changed(old, new, text=GROUND):
    assert old in text
    return text.replace(old, new, 1)


@pytest.mark.parametrize("path", sorted(DESIGNS.glob("entry-*.toml")), ids=lambda p: p.stem)
def test_every_scenario_reads(path):
    scenario = read_scenario(path)
    beacons = scenario.beacons()
    assert beacons.size >= 1
    assert beacons.r.shape == (scenario.times.size, beacons.size, 3)
    assert scenario.digest in provenance(scenario, "compass land")["scenario_sha256"]


def test_the_ground_case_becomes_the_chapters_numbers():
    scenario = read(GROUND)
    r, lon, lat, v, gamma, psi = scenario.state
    assert (r, v) == (3518.2e3, 5515.0)
    np.testing.assert_allclose(np.degrees([lon, lat, gamma]), [-89.872, -28.02, -11.8])
    assert np.degrees(psi) == pytest.approx(90 - 5.156)
    assert scenario.model.rotation == "coriolis"
    assert scenario.times.size == 241
    back = np.linalg.inv(spherical_jacobian(cartesian_of(scenario.state)))
    np.testing.assert_allclose(
        np.sqrt(np.diag(back @ scenario.settings.covariance0 @ back.T)),
        [1000, *np.radians([0.2, 0.2]), 10, *np.radians([0.2, 0.2])],
    )
    assert scenario.settings.iterations == 1


def test_cartesian_starts_altitudes_and_headings_from_north():
    scenario = read(ORBITERS)
    np.testing.assert_allclose(
        cartesian_of(scenario.state)[3:], [5775.31, 1124.27, 1175.48], rtol=1e-12
    )
    text = changed("radius_km = 3518.2\n", "altitude_km = 121\n")
    text = changed('heading_from = "east"', 'heading_from = "north"', text)
    scenario = read(text)
    assert scenario.state[0] == pytest.approx(3518.2e3)
    assert np.degrees(scenario.state[5]) == pytest.approx(5.156)


def test_state_vectors_and_circles_give_the_same_orbits():
    scenario = read(ORBITERS)
    before = scenario.beacons()
    text = ORBITERS
    for k in range(3):
        r, v = before.r[0, k], before.v[0, k] + np.cross([0, 0, 7.088218e-5], before.r[0, k])
        head, _, rest = text.partition(f'name = "Orbiter {k + 1}"\n')
        lines = rest.split("\n")
        vectors = f"position_km = {(r / 1e3).tolist()}\nvelocity_m_s = {v.tolist()}"
        text = head + f'name = "Orbiter {k + 1}"\n' + "\n".join([vectors, *lines[4:]])
    after = read(text).beacons()
    np.testing.assert_allclose(after.r, before.r, rtol=0, atol=1e-3)
    np.testing.assert_allclose(after.v, before.v, rtol=0, atol=1e-6)


def test_a_design_stands_where_mars_has_turned_to():
    from compass.inputs import read_design
    from compass.orbits import positions_mcmf

    scenario = read_scenario(DESIGNS / "entry-compass.toml")
    design = read_design(DESIGNS / "compass-15-5-1.toml")
    exact = positions_mcmf(design.constellation, scenario.times)
    # the scenario's rotation rate has seven digits, and W's small terms stand still: 240 s
    np.testing.assert_allclose(scenario.beacons().r, np.moveaxis(exact, 0, 1), atol=0.5)


def test_atmosphere_tables_banks_and_truth(tmp_path):
    (tmp_path / "air.txt").write_text("0 1e-2\n40 2e-4\n120 1e-9\n")
    text = changed("scale_height_km = 7.5\n", 'scale_height_km = 7.5\ntable = "air.txt"\n')
    text = changed("bank_deg = 0", "bank_deg = [[0, 10], [60, -20]]", text)
    text = changed("drag_area_per_mass_m2_kg = 0.016", "ballistic_coefficient_kg_m2 = 62.5", text)
    text = changed("[entry]", "[truth]\ndensity_bias = 0.1\n\n[entry]", text)
    scenario = read(text, folder=tmp_path)
    air = scenario.model.atmosphere
    assert air.density(3397.2e3 + 120e3) == pytest.approx(1e-9)
    assert scenario.truth.atmosphere.density(3437.2e3) == pytest.approx(2.2e-4)
    np.testing.assert_allclose(np.degrees(scenario.model.vehicle.bank([0, 99])), [10, -20])
    assert scenario.model.vehicle.drag_area_per_mass == pytest.approx(0.016)
    with pytest.raises(DesignError, match=r"s\.toml: .*air\.txt: cannot be read"):
        read(text, folder=tmp_path / "elsewhere")


def test_triggers_of_every_kind():
    text = changed(
        "[[beacon]]",
        '[[trigger]]\nname = "a"\naltitude_km = 40\n[[trigger]]\nname = "m"\nmach = 5\n[[beacon]]',
    )
    found = read(text).triggers
    assert [(t.quantity, t.level) for t in found] == [
        ("speed", 2000.0),
        ("altitude", 40e3),
        ("mach", 5.0),
    ]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "radius_km = 3518.2\n",
            "",
            "entry: needs exactly one of altitude_km, radius_km; found none",
        ),
        (
            "radius_km = 3518.2",
            "radius_km = 3518.2\naltitude_km = 1",
            "radius_km; found altitude_km and",
        ),
        ("radius_km = 3518.2", "radius_km = 121", "entry.radius_km = 121: not above the ground"),
        ("radius_km = 3518.2", "radius_km = 3518200", r"entry\.radius_km = 3518200: .* at most"),
        (
            "latitude_deg = -28.02",
            "latitude_deg = 90",
            "latitude_deg = 90: at a pole.*position_sigma_m",
        ),
        (
            "range_sigma_m = 100",
            "range_sigma_m = 100\nstart_s = 241",
            r"measurements\.start_s = 241: is after entry\.duration_s = 240; nothing would",
        ),
        (
            "range_sigma_m = 100",
            "range_sigma_m = 100\nstart_s = 100\nstop_s = 99",
            r"measurements\.stop_s = 99: is before start_s = 100; nothing would",
        ),
        ("latitude_deg = -28.02\n", "", r"entry\.latitude_deg: missing; needed beside the others"),
        ("speed_m_s = 5515", "speed_m_s = 0", r"entry\.speed_m_s = 0: must be at least 100"),
        (
            "flight_path_deg = -11.8",
            "flight_path_deg = -90",
            r"entry\.flight_path_deg = -90.*above -90",
        ),
        (
            'heading_from = "east"',
            'heading_from = "west"',
            r"heading_from = 'west': allowed: 'north'",
        ),
        ("step_s = 1", "step_s = 1e-4", "step_s = 0.0001: must be .*|allowed 1 to 100000"),
        ("duration_s = 240", "duration_s = 0.5", r"entry\.step_s = 1: 0 steps in duration_s = 0.5"),
        ("drag_area_per_mass_m2_kg = 0.016 ", "", "vehicle: needs exactly one of drag_area"),
        ("bank_deg = 0", "bank_deg = [[5, 1], [5, 2]]", r"vehicle\.bank_deg.*increase strictly"),
        ("bank_deg = 0", "bank_deg = []", "at least one"),
        (
            "speed_m_s = 2000",
            "",
            r"trigger\[1\]: needs exactly one of altitude_km, speed_m_s, mach",
        ),
        ('name = "east"', 'name = "north-west"', r"beacon\[3\]\.name = 'north-west': used twice"),
        (
            "longitude_deg = -73.4",
            "longitude_deg = -73.4\nheight_km = -1",
            "height_km = -1.*at least 0",
        ),
        (
            "range_sigma_m = 100",
            "",
            "measurements: needs range_sigma_m, range_rate_sigma_m_s or both",
        ),
        ("range_sigma_m = 100", "range_sigma_m = 0", "range_sigma_m = 0.*above 0"),
        (
            "range_sigma_m = 100",
            "range_sigma_m = 100\nstart_s = 9\nstop_s = 5",
            "measurements.stop_s = 5: is before start_s = 9; nothing would be measured, put it after",
        ),
        (
            "interval_s = 1",
            "interval_s = 1.5",
            r"measurements\.interval_s = 1\.5: must be a whole number of entry\.step_s = 1; the "
            "nearest is 2",
        ),
        (
            "interval_s = 1",
            "interval_s = 0.5",
            r"measurements\.interval_s = 0\.5: .*the nearest is 1",
        ),
        ("radius_sigma_m = 1000", "", r"filter\.radius_sigma_m: missing"),
        (
            "radius_sigma_m = 1000",
            "radius_sigma_m = 1\nposition_sigma_m = 1",
            "filter: needs either .*found some of both",
        ),
        ('kind = "ekf"', 'kind = "ekf"\niterations = 4', "only for kind = "),
        ("runs = 500", "runs = 0", r"monte_carlo\.runs = 0.*at least 1"),
        ("[optimize]", "[optimise]", r"unknown key; did you mean \[optimize\]"),
        ('what = "ground"', 'what = "orbiters"', r"optimize\.altitude_km: missing"),
        ("scale_height_km = 7.5", "scale_height_km = -7.5", r"atmosphere\.scale_height_km = -7.5"),
    ],
)
def test_faults_are_said_with_their_field(old, new, message):
    with pytest.raises(DesignError, match=message) as error:
        read(changed(old, new))
    assert all(fault.startswith("s.toml: ") for fault in error.value.faults)


def test_cartesian_and_spherical_do_not_mix():
    text = changed("duration_s = 240", "radius_km = 3500\nduration_s = 240", ORBITERS)
    with pytest.raises(DesignError, match=r"entry\.radius_km = 3500: not beside position_km"):
        read(text)
    text = changed(
        "position_km = [-3.92, -3103.37, -1665.41]", "position_km = [0, 0, 3500]", ORBITERS
    )
    assert read(text).state[2] == pytest.approx(np.pi / 2)  # a place like any other


def test_all_faults_at_once():
    text = changed("speed_m_s = 5515", "speed_m_s = -1")
    text = changed("range_sigma_m = 100", "range_sigma_m = -1", text)
    text = changed('name = "east"', 'name = "north-west"', text)
    with pytest.raises(DesignError) as error:
        read(text)
    assert len(error.value.faults) == 3


def test_impossible_orbits_are_refused():
    text = changed("altitude_km = 725\nraan_deg = 49.329", "raan_deg = 49.329", ORBITERS)
    with pytest.raises(DesignError, match=r"orbiter\[1\]\.altitude_km: missing"):
        read(text)
    text = ORBITERS.partition("[[orbiter]]")[0] + (
        '[[orbiter]]\nname = "x"\nposition_km = [4000, 0, 0]\nvelocity_m_s = [0, 9000, 0]\n'
        "[measurements]" + ORBITERS.partition("[measurements]")[2]
    )
    with pytest.raises(DesignError, match="not on an ellipse about Mars"):
        read(text)
    low = read(
        changed("velocity_m_s = [0, 9000, 0]", "velocity_m_s = [0, 1, 0]", text).replace(
            "4000", "3400"
        )
    )
    with pytest.raises(ArgumentError, match="beacon x: comes down to radius"):
        low.beacons()


def test_a_missing_design_is_named():
    text = changed("[[beacon]]", '[beacons]\ndesign = "no.toml"\n\n[[beacon]]')
    with pytest.raises(DesignError, match=r"s\.toml: no\.toml: no such file"):
        read(text)


def test_iterations_of_the_iterated_filter():
    text = changed('kind = "ekf"', 'kind = "iterated-ekf"\niterations = 7')
    assert read(text).settings.iterations == 7


INSTRUMENTS = """
two_way = { range_rate_sigma_m_s = 0.01 }
altimeter = { sigma_m = 10, share = 0.02, below_km = 8 }
velocimeter = { sigma_m_s = 0.2, interval_s = 2 }
features = { sigma_deg = 0.1, interval_s = 5 }
link = { frequency_mhz = 401, eirp_dbw = 10, g_over_t_db_k = -25, required_db_hz = 30, chip_m = 300 }
[[feature]]
name = "rim"
latitude_deg = -27
longitude_deg = 275
height_km = -2
[filter]
kind = "unscented"
attitude = { sigma_deg = 0.05, considered = true }
"""


def test_instruments_and_features_become_records():
    scenario = read(changed("[filter]\n", INSTRUMENTS).replace('kind = "ekf"', ""))
    two_way, altimeter, velocimeter, camera = scenario.measurements.instruments
    assert (two_way.kind, two_way.sigma) == ("two_way_rate", 0.01)
    assert (altimeter.sigma, altimeter.share, altimeter.below) == (10.0, 0.02, 8e3)
    assert (velocimeter.sigma, velocimeter.interval) == (0.2, 2.0)
    assert camera.sigma == pytest.approx(np.radians(0.1))
    place = scenario.measurements.features.places(scenario.model.planet_radius)
    assert np.linalg.norm(place) == pytest.approx(scenario.model.planet_radius - 2e3)
    assert scenario.settings.method == "unscented"
    link = scenario.measurements.link
    assert (link.radio.frequency, link.receiver.chip, link.electrons) == (401e6, 300.0, None)
    assert np.isinf(link.beamwidth) and read(GROUND).measurements.link is None
    [axes] = scenario.settings.parts
    assert (axes.name, axes.considered) == ("attitude", True)
    assert axes.sigma == pytest.approx([np.radians(0.05)] * 3)


def test_a_spread_of_the_air_by_height():
    more = "[filter]\ndensity = {{ {}, scale_km = 8.2 }}\n"
    [part] = read(changed("[filter]\n", more.format('sigma_by_km = "mars"'))).settings.parts
    assert part.sigma == (0.4,) and len(part.profile) == 12  # 121 km and above
    rows = "sigma_by_km = [[0, 0.02], [100, 0.2]]"
    [own] = read(changed("[filter]\n", more.format(rows))).settings.parts
    half = own.profile[0][0] + 50e3
    assert own.sigma_at(np.array([half]))[0] == pytest.approx(np.sqrt(0.02 * 0.2))
    both = more.format("sigma = 0.1, " + rows).replace(", scale_km = 8.2", "")
    with pytest.raises(DesignError) as told:
        read(changed("[filter]\n", both))
    assert "filter.density: needs exactly one of sigma, sigma_by_km" in str(told.value)
    assert "filter.density.scale_km: missing; needed beside sigma_by_km" in str(told.value)
    with pytest.raises(DesignError) as told:
        read(changed("[filter]\n", more.format("sigma_by_km = [[10, 0.1], [5, 0]]")))
    field = "filter.density.sigma_by_km"
    assert f"{field} = [[10, 0.1], [5, 0]]: altitudes must increase strictly" in str(told.value)
    assert f"{field}[2][2] = 0: must be above 0" in str(told.value)


def test_winds_are_flown_as_given_and_as_they_are():
    text = changed("[atmosphere]\n", "[atmosphere]\nwinds_by_km = [[0, 10, 5], [700, -80, 0]]\n")
    scenario = read(text + "\n[truth]\nwinds_by_km = [[0, 0, 0]]\n")
    r0 = scenario.model.planet_radius
    assert scenario.model.atmosphere.winds == ((r0, 10.0, 5.0), (r0 + 700e3, -80.0, 0.0))
    assert scenario.truth.atmosphere.winds == ((r0, 0.0, 0.0),)
    assert read(text).truth.atmosphere.winds == scenario.model.atmosphere.winds
    with pytest.raises(DesignError, match="winds: altitudes must increase") as told:
        read(text.replace("[700, -80, 0]", "[0, -80, 0]"))
    assert "atmosphere.winds_by_km = [[0, 10, 5], [0, -80, 0]]: winds" in str(told.value)
    truth = GROUND + "\n[truth]\nwinds_by_km = [[1, 0, 0], [0, 1, 1]]\n"
    with pytest.raises(DesignError, match=r"truth\.winds_by_km = \[\[1, .* must increase strictly"):
        read(truth)
    swapped = changed('rotation = "coriolis"', 'rotation = "published-coriolis"', text)
    with pytest.raises(DesignError, match=r"planet\.rotation = .*leave atmosphere\.winds_by_km"):
        read(swapped)
    published = (DESIGNS / "lou2019-recommended.toml").read_text()
    blown = changed("[atmosphere]\n", '[atmosphere]\nwinds_by_km = "mars"\n', published)
    assert len(read(blown, folder=DESIGNS).model.atmosphere.winds) == 9


def test_a_link_alone_makes_the_noise_of_ranges():
    """Left out beside any other radio it stays out; nothing at all is told."""
    [link] = [line for line in INSTRUMENTS.splitlines() if line.startswith("link")]
    text = changed("range_sigma_m = 100\n", link + "\n")
    assert read(text).measurements.range_sigma == 0.0
    rates = text.replace("[measurements]\n", "[measurements]\nrange_rate_sigma_m_s = 0.1\n")
    assert read(rates).measurements.range_sigma is None
    with pytest.raises(DesignError, match="or both, or two_way or link"):
        read(changed("range_sigma_m = 100\n", ""))


def test_faults_of_instruments_are_said_together():
    text = changed("[filter]\n", INSTRUMENTS).replace('kind = "ekf"', "")
    text = text.replace('kind = "unscented"', 'kind = "relinearised-ekf"\niterations = 3')
    text = text.replace("range_rate_sigma_m_s = 0.01", "").replace(
        "interval_s = 5", "interval_s = 1.5"
    )
    text = text.replace("[[feature]]", "[[beacon]]").replace("height_km = -2\n", "")
    text += "[filter.density]\nsigma = 0.2\nscale_km = 8\n"
    with pytest.raises(DesignError) as told:
        read(text)
    for words in (
        "measurements.two_way: needs range_sigma_m",
        "measurements.features.interval_s = 1.5: must be a whole number",
        "feature: missing; measurements.features needs",
        "filter.iterations = 3: only for kind",
        "filter.kind = 'relinearised-ekf': with process noise or a density that wanders",
    ):
        assert words in str(told.value)
    alone = changed(
        "[filter]\n", '[[feature]]\nname = "a"\nlatitude_deg = 0\nlongitude_deg = 0\n[filter]\n'
    )
    with pytest.raises(DesignError, match=r"measurements\.features: missing; needed beside"):
        read(alone)
    published = (DESIGNS / "lou2019-recommended.toml").read_text()
    more = read(published + "\n[measurements.altimeter]\nsigma_m = 10\n", folder=DESIGNS)
    assert fusion_plan(more).case.instruments == ("own readings",)


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ("[-11, 0, 0]", "[1][1] = -11: allowed -10 to 1000 km"),
        ("[5, 0, -501]", "[1][3] = -501: allowed -500 to 500 m/s"),
        ("[5, 0]", "[1] = [5, 0]: must have at least 3 values"),
        ("5", "[1] = 5: must be a list"),
    ],
)
def test_a_wrong_row_of_winds_gets_one_message_with_the_bounds_of_its_column(row, said):
    text = changed("[atmosphere]\n", f"[atmosphere]\nwinds_by_km = [{row}]\n")
    with pytest.raises(DesignError) as told:
        read(text)
    (fault,) = told.value.faults
    assert f"atmosphere.winds_by_km{said}" in fault
