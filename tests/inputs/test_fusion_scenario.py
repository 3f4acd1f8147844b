"""The fusion part of scenarios: read, flown, reported; faults of the file said clearly."""

import json
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

from compass.api.land import LandResult
from compass.api.land_fusion import fusion_facts, fusion_section
from compass.cli.main import program
from compass.entry.views import spherical_jacobian, spherical_of
from compass.errors import DesignError
from compass.inputs.fusion import fusion_plan
from compass.inputs.scenario import read_scenario, read_scenario_text
from compass.papers import lou2017_case, lou2019_case
from compass.papers.lou_filters import SCALE
from compass.papers.spherical import spherical_parameters
from compass.study.fusion import run_fusion

DESIGNS = Path(__file__).parents[2] / "designs"


def text_of(name, seconds=8, **changes):
    text = (DESIGNS / f"{name}.toml").read_text()
    text = re.sub(r"duration_s = \d+", f"duration_s = {seconds}", text)
    text = text.replace("start_s = 200", "start_s = 5")
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    return text


def plan_of(name, seconds=8, changes=()):
    text = text_of(name, seconds)
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return fusion_plan(read_scenario_text(text, "x.toml", DESIGNS))


@pytest.mark.parametrize(
    ("name", "case", "settings"),
    [
        ("lou2019-published", lou2019_case.case(bias=-0.03), lou2019_case.published_filter("ekf")),
        (
            "lou2019-printed-point",
            lou2019_case.case(lou2019_case.PRINTED_POINT, bias=-0.03),
            lou2019_case.published_filter("ekf", lou2019_case.PRINTED_POINT),
        ),
        (
            "lou2019-recommended",
            lou2019_case.case(noisy_truth=True),
            lou2019_case.recommended_filter("ekf"),
        ),
        (
            "lou2017-published",
            lou2017_case.case(),
            lou2017_case.six_state_filter("intermittent"),
        ),
        ("lou2017-recommended", lou2017_case.case(), lou2017_case.recommended_filter("ekf")),
    ],
)
def test_scenarios_are_the_papers_entries(name, case, settings):
    plan = fusion_plan(read_scenario(DESIGNS / f"{name}.toml"))
    mine, theirs, ours = plan.filters[0], settings, plan.case
    # the papers' filters fly one Runge-Kutta step a second
    flown = ours.flight.states[:, :6]
    assert np.abs(flown[:, 0] - case.nominal[:, 0]).max() < 5.0
    np.testing.assert_allclose(flown[0], case.nominal[0, :6], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(ours.beacons.r, case.beacons.r, rtol=0, atol=1e-3)
    np.testing.assert_allclose(ours.sigma[:, 0], case.range_sigma, rtol=1e-12)
    np.testing.assert_array_equal(ours.noise, case.process_noise)
    assert tuple(ours.imu_bias) == case.imu.bias and tuple(ours.imu_sigma) == case.imu.sigma
    if case.arrival is not None:
        np.testing.assert_allclose(ours.arrival, case.arrival, rtol=1e-2, atol=1e-6)
    n = mine.states
    start = spherical_of(mine.first)
    turn = np.linalg.inv(spherical_jacobian(mine.first))
    np.testing.assert_allclose(start, theirs.full_start[:6], rtol=1e-9, atol=1e-12)
    spread = turn @ mine.covariance0 @ turn.T
    np.testing.assert_allclose(
        spread / np.outer(SCALE[:6], SCALE[:6]),
        theirs.covariance[:6, :6] / np.outer(SCALE[:6], SCALE[:6]),
        rtol=1e-9, atol=1e-12,
    )  # fmt: skip
    np.testing.assert_allclose(np.diag(mine.covariance)[6:], np.diag(theirs.covariance)[6:n])
    np.testing.assert_array_equal(mine.noise, theirs.process_noise)
    np.testing.assert_allclose(mine.imu_variance, theirs.acceleration_variance, rtol=1e-12)
    np.testing.assert_allclose(
        spherical_parameters(mine.model), spherical_parameters(theirs.model), rtol=1e-12
    )
    assert mine.random_start == theirs.random_start
    np.testing.assert_allclose(mine.known_to, theirs.parameter_sigma, rtol=1e-12)


def test_the_papers_own_state_is_run_by_reproduce_alone():
    text = text_of("lou2019-published").replace(
        "[fusion]\n", "[fusion]\npublished_linear_density = true\n"
    )
    with pytest.raises(DesignError, match=r"published_linear_density: .* compass reproduce"):
        fusion_plan(read_scenario_text(text))


def test_scenarios_without_fusion_have_no_plan():
    assert fusion_plan(read_scenario(DESIGNS / "entry-orbiters.toml")) is None


def test_a_plan_is_flown_and_reported():
    gate = [("[fusion]\n", "[fusion]\ngate_sigma = 8\n"), ('"ekf", "iterated", ', '"ekf", ')]
    found = run_fusion(plan_of("lou2019-recommended", changes=gate), 2, progress=False)
    assert set(found.clear) == {"ekf", "federated", "ci-feedback", "dcifaif", "ci"}
    assert not found.faulty["ekf"].arrival.sel(sensor="orbiter 2")[5:].any()
    section = fusion_section(found)
    stems = [image.stem for image in section.pictures]
    assert stems == [
        "fusion-rmse",
        "fusion-errors",
        "fusion-nees",
        "fusion-errors-fault",
        "fusion-weights",
    ]
    assert all(image.drawn.startswith((b"\x89PNG", b"<svg")) for image in section.pictures)
    titles = [table.title for table in section.tables]
    assert titles[-1].startswith("Measurements refused by the gate, % of epochs (bounds that hold")
    assert "The fault: outage of orbiter 2 from 5 s on." in section.paragraphs
    facts = fusion_facts(found)
    assert facts["visible_epochs"]["surface 1"] == 9
    assert facts["filters"]["ekf"]["runs"] == 2
    assert len(list(found.groups())) == 20


def test_plasma_and_hidden_beacons_are_told():
    changes = [
        ("altitude", "altitude"),
        (
            'filters = ["ekf", "intermittent", "information", "dcifaif"]',
            'filters = ["information"]',
        ),
        (
            'kind = "all-ranges-lost"',
            'kind = "spike"\nbeacon = "orbiter 3"\nstart_s = 3\nsize_m = 9',
        ),
    ]
    changes = changes[1:]
    found = run_fusion(plan_of("lou2017-recommended", 46, changes), 1, progress=False)
    section = fusion_section(found)
    assert section.paragraphs[0] == "Not to be believed: information, whose runs are all lost."
    assert section.paragraphs[1] == "Beacon orbiter 1: in line of sight at 44 of 47 epochs."
    assert section.paragraphs[2].startswith("The plasma dims the ranges for")
    assert "The fault: spike of orbiter 3 by 9 m at 3 s." in section.paragraphs
    assert any("1 of 1 runs of information diverged" in words for words in section.paragraphs)
    assert section.pictures[-1].stem == "fusion-plasma"
    assert section.tables[0].rows[0][6] == "lost"
    # a plain filter that holds does not hide that a fused one does not
    plain = SimpleNamespace(consistency=SimpleNamespace(holds=True))
    assert LandResult(None, plain, found).holds
    assert not LandResult(None, plain, found, strict=True).holds


@pytest.mark.parametrize(
    ("name", "old", "new", "message"),
    [
        (
            "lou2019-recommended",
            "range_sigma_m = [4.47213595499958, ",
            "range_sigma_m = [",
            "3 values for 4 beacons",
        ),
        (
            "lou2019-recommended",
            "p0_si = [1e6, ",
            "p0_si = [",
            "p0_si: 7 values, process_noise_si: 8",
        ),
        ("lou2019-recommended", "p0_si = [1e6, ", "p0_si = [0, ", "not positive definite"),
        ("lou2019-recommended", "p0_si = [1e6, ", "p0_si = [1e6, 1, 1, ", "10 values"),
        (
            "lou2019-recommended",
            'beacon = "orbiter 2"',
            'beacon = "orbiter 9"',
            "beacon = 'orbiter 9': allowed",
        ),
        ("lou2019-recommended", "[fusion]\n", "[fusion]\nweight_floor = 0\n", "weight_floor = 0"),
        ("lou2019-recommended", '"dcifaif"', '"magic"', "fusion.filters"),
        (
            "lou2019-recommended",
            "start_s = 200",
            "start_s = 900",
            "the entry lasts from 0 s to 300 s",
        ),
        (
            "lou2019-recommended",
            "runs = 300",
            "runs = 0",
            "monte_carlo.runs = 0: must be at least 1",
        ),
        ("lou2017-recommended", 'electrons = "wake"', 'electrons = "table"', "radio.table = None"),
        ("lou2017-recommended", 'electrons = "wake"', 'electrons = "soup"', "allowed"),
        (
            "lou2019-recommended",
            "[3492.7, 3659.2, 215.11]\nvelocity_m_s = [-605.1, 97, 3232.8]",
            "[7855.7, -461.8, 749.82]\nvelocity_m_s = [66.2, 2206.4, -413]",
            "beacons orbiter 1 and orbiter 2: at one place",
        ),
    ],
)
def test_faults_of_the_file_are_said(name, old, new, message):
    text = (DESIGNS / f"{name}.toml").read_text()
    assert old in text
    with pytest.raises(DesignError, match=re.escape(message)):
        fusion_plan(read_scenario_text(text.replace(old, new), "x.toml", DESIGNS))


def test_electrons_come_from_a_table_too(tmp_path):
    (tmp_path / "n.csv").write_text("# km, per cm3\n0, 1e5\n60, 1e9\n120, 1e6\n")
    text = text_of("lou2017-recommended").replace(
        'electrons = "wake"', 'electrons = "table"\ntable = "n.csv"'
    )
    label = str(tmp_path / "x.toml")
    plan = fusion_plan(read_scenario_text(text, label, tmp_path))
    assert plan.electrons.altitude == (0.0, 60e3, 120e3)
    assert plan.electrons.electron_density[1] == 1e15
    (tmp_path / "n.csv").write_text("0 1e5\n60 1e9\n50 1e6\n")
    with pytest.raises(DesignError, match="altitude 50000 m after 60000 m"):
        fusion_plan(read_scenario_text(text, label, tmp_path))


def test_the_command_says_what_is_hidden_before_it_starts(tmp_path):
    place = tmp_path / "hidden.toml"
    text = text_of("lou2019-printed-point").replace('"ekf", "dcifaif", "ci"', '"ekf"')
    place.write_text(text)
    out = tmp_path / "hidden.nc"
    result = CliRunner().invoke(
        program, ["land", str(place), "--runs", "1", "--json", "-o", str(out)]
    )
    assert result.exit_code == 0, result.output
    assert "no beacon is ever in line of sight" in result.stderr
    facts = json.loads(result.stdout)
    assert facts["fusion"]["visible_epochs"] == {
        "surface 1": 0,
        "surface 2": 0,
        "orbiter 1": 0,
        "orbiter 2": 0,
    }
    import xarray as xr

    saved = xr.load_dataset(out, engine="h5netcdf", group="fusion/clear/ekf")
    assert saved.attrs["runs"] == 1
