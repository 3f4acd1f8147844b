"""``compass fold`` as a user runs it."""

import json
import math
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from compass.cli.main import program
from compass.errors import CompassError

DESIGN = """
name = "small"
figure = "kelly2018-sphere"
[constellation]
pattern = "walker-delta"
satellites = 6
planes = 6
phasing = 4
inclination_deg = 52
radius_km = 20428
[coverage]
{coverage}
"""

ELLIPSES = """
name = "two ellipses"
[constellation]
pattern = "elements"
[[constellation.satellite]]
name = "A"
semi_major_axis_km = 12000
eccentricity = 0.3
inclination_deg = 60
[[constellation.satellite]]
name = "B"
semi_major_axis_km = 12100
inclination_deg = 60
mean_anomaly_deg = 90
[coverage]
fold = 1
"""


@pytest.fixture
def design(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(DESIGN.format(coverage="fold = 1"))
    return path


def run(*arguments):
    return CliRunner().invoke(program, ["fold", *(str(a) for a in arguments)])


def test_proven_is_0_and_the_json_is_complete(design):
    result = run(design, "--losses", 1, "--json")
    assert result.exit_code == 0
    found = json.loads(result.stdout)
    assert found["outcome"] == "proven"
    assert {
        "outcome",
        "fold",
        "mask_deg",
        "min_fold",
        "max_fold",
        "cap_radius_min_deg",
        "mask_margin_deg",
        "witness",
        "intervals",
        "after_losses",
    } <= set(found)
    assert found["for_all_time"] is True
    assert found["min_fold"] == 1
    assert sum(found["fold_share"]) == pytest.approx(1.0)
    assert found["fold_share"][0] == 0.0
    assert found["witness"] is None
    # the elevation at the rim of that cap, of the triangle of centre, user and satellite
    cap = math.radians(found["cap_radius_min_deg"])
    rim = math.degrees(math.atan2(math.cos(cap) - 3396.19 / 20428, math.sin(cap)))
    assert found["mask_margin_deg"] == pytest.approx(rim, abs=1e-3)
    (after,) = found["after_losses"]
    assert after["losses"] == 1
    assert after["min_fold"] == 0
    assert after["worst"] == [["P1S1"]]
    assert after["sets"][0]["alike"] == 6


def test_refuted_is_1_with_a_witness(design):
    result = run(design, "--fold", 4, "--mask-deg", 10, "--json")
    assert result.exit_code == 1
    found = json.loads(result.stdout)
    assert (found["outcome"], found["fold"], found["mask_deg"]) == ("refuted", 4, 10)
    assert found["witness"]["fold"] < 4
    assert len(found["witness"]["satellites"]) == found["witness"]["fold"]


def test_the_text_says_what_was_used(design):
    result = run(design, "--losses", 2)
    assert result.exit_code == 0
    for words in ("PROVEN", "for all time", "decides", " interval", "1e-09 rad", "worst first"):
        assert words in result.stdout
    refuted = run(design, "--fold", 4)
    assert "witness" in refuted.stdout
    assert "REFUTED" in refuted.stdout


def test_a_region_and_a_duration(design):
    result = run(design, "--region", "lat:-20:20", "--duration-h", 1, "--json")
    assert result.exit_code == 0
    found = json.loads(result.stdout)
    assert found["for_all_time"] is False
    assert found["stop_s"] == 3600.0
    assert found["cap_radius_min_deg"] is None
    assert "over 1 h from the epoch" in run(design, "--duration-h", 1).stdout


def test_orbits_without_a_common_period_are_settled_over_a_stated_time(tmp_path):
    path = tmp_path / "two.toml"
    path.write_text(ELLIPSES)
    result = run(path)
    assert result.exit_code == 1
    assert "over" in result.stdout
    assert " of Mars, after which the ground tracks" in " ".join(result.stdout.split())


def test_a_mask_by_azimuth_takes_the_safe_side(tmp_path):
    path = tmp_path / "mask.toml"
    outcomes = []
    for horizon in ("[[0, 0], [180, 1]]", "[[0, 0], [180, 80]]", "[[0, 70], [180, 80]]"):
        path.write_text(DESIGN.format(coverage=f"fold = 1\nhorizon_deg = {horizon}"))
        result = run(path, "--json")
        found = json.loads(result.stdout)
        outcomes.append(found["outcome"])
        assert result.exit_code == (0 if found["outcome"] == "proven" else 1)
    assert outcomes == ["proven", "undecided", "refuted"]


def test_an_undecided_claim_names_what_is_left(design, monkeypatch):
    from compass.coverage import continuous

    plain = continuous.prove_fold

    def impatient(*arguments, **options):
        return plain(*arguments, **options, max_intervals=1)

    monkeypatch.setattr(continuous, "prove_fold", impatient)
    margin = json.loads(run(design, "--json").stdout)["mask_margin_deg"]
    result = run(design, "--mask-deg", margin - 1e-4)
    assert result.exit_code == 1
    assert "UNDECIDED" in result.stdout
    assert "unsettled" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--fold", "0"], "fold = 0"),
        (["--mask-deg", "95"], "--mask-deg = 95"),
        (["--mask-deg", "nan"], "--mask-deg = nan"),
        (["--losses", "-1"], "losses = -1"),
        (["--losses", "7"], "losses = 7"),
        (["--region", "moon"], "region = moon"),
        (["--duration-h", "0"], "--duration-h = 0"),
    ],
)
def test_bad_options(design, arguments, message):
    result = run(design, *arguments)
    assert isinstance(result.exception, CompassError)
    assert message in str(result.exception)
    assert not result.stdout


def test_a_missing_file_is_2_with_one_line():
    done = subprocess.run(
        [sys.executable, "-m", "compass.cli.main", "fold", "nowhere.toml"],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        cwd=Path(__file__).parents[2],
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.strip().count("\n") == 0
    assert "no such file" in done.stderr
