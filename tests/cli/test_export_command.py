"""``compass export`` as a user runs it."""

import json
import os

import numpy as np
import pytest

import compass

SHORT = ["--duration-h", 2, "--step-s", 600]


@pytest.fixture
def seed(designs):
    return designs / "compass-15-5-1.toml"


def test_oem_is_a_folder_of_messages(run, seed, tmp_path):
    folder = tmp_path / "oem"
    code, out, err = run("export", seed, "--format", "oem", "-o", folder, *SHORT, "--json")
    assert (code, err) == (0, "")
    result = json.loads(out)
    assert (result["files"], result["epochs"], result["step_s"]) == (15, 13, 600)
    assert result["stop_tdb"] == "2000-01-01T14:00:00.000000"
    assert len(list(folder.glob("*.oem"))) == 15
    assert "OBJECT_NAME = P1S1" in (folder / "01-P1S1.oem").read_text()
    # a second run does not write among files that may be another constellation's
    code, _, err = run("export", seed, "--format", "oem", "-o", folder)
    assert code == 2
    assert "has files in it; give a new folder" in err


def test_czml_and_geojson(run, seed, tmp_path):
    for kind in ("czml", "geojson"):
        path = tmp_path / f"x.{kind}"
        code, out, err = run("export", seed, "--format", kind, "-o", path, *SHORT)
        assert (code, out) == (0, "")
        assert f"wrote {path}" in err
        assert json.loads(path.read_text(encoding="utf-8"))


def test_toml_reads_as_the_same_design(run, seed, tmp_path):
    path = tmp_path / "again.toml"
    code, out, _ = run("export", seed, "--format", "toml", "-o", path, "--json")
    assert code == 0
    assert json.loads(out)["format"] == "toml"
    one, other = compass.read_design(seed), compass.read_design(path)
    assert one.constellation.pattern == other.constellation.pattern
    assert one.stations == other.stations


def test_motion_is_used_from_a_day_on(run, designs, tmp_path):
    design = designs / "relay-orbiters.toml"
    ends = []
    for motion in ("two-body", "j2"):
        path = tmp_path / f"{motion}.czml"
        options = ["--motion", motion, "--duration-h", 2, "--start-day", 20]
        assert run("export", design, "--format", "czml", "-o", path, *options)[0] == 0
        packets = json.loads(path.read_text(encoding="utf-8"))
        ends.append(packets[2]["position"]["cartesian"][-3:])
        # readers count from the first moment, which the packet names
        assert packets[2]["position"]["epoch"].startswith("2000-01-21T11:58:55.816")
        assert packets[2]["position"]["cartesian"][::4][:1] == [0.0]
    c = compass.read_design(design).constellation
    end = [20 * 86400 + 7200]
    expected = compass.ephemeris(c, end, "j2").r_mcmf.values[0, 0]
    np.testing.assert_allclose(ends[1], expected, rtol=0, atol=5.1e-4)
    assert np.linalg.norm(np.subtract(*ends)) > 1e4


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--format", "toml", "--start-day", "3"], "--start-day = 3.0: a design file holds orbits"),
        (["--format", "oem", "--start-day", "-3"], "--start-day = -3: allowed 0 to 36525 days"),
        (["--format", "toml", "--duration-h", "2"], "--duration-h = 2.0: a design file holds orbits"),
        (["--format", "czml", "--duration-h", "-1"], "--duration-h = -1: allowed above 0"),
        (["--format", "czml", "--step-s", "inf"], "--step-s = inf: must be a finite number"),
        (["--format", "oem", "--step-s", "0.01"], "more than 2000000"),
        (["--format", "kml"], "is not one of"),
        ([], "Missing option '--format'"),
    ],
)  # fmt: skip
def test_bad_options(run, seed, tmp_path, arguments, message):
    code, out, err = run("export", seed, "-o", tmp_path / "x", *arguments)
    assert (code, out) == (2, "")
    assert message in err
    assert not list(tmp_path.iterdir())


def test_bad_outputs(run, seed, tmp_path):
    cases = [
        ("czml", tmp_path, "is a directory"),
        ("czml", seed, "is an input itself"),
        ("toml", tmp_path / "no" / "x.toml", "does not exist"),
        ("oem", seed, "is a file"),
        ("oem", tmp_path / "no" / "oem", "does not exist"),
    ]
    for kind, output, message in cases:
        code, _, err = run("export", seed, "--format", kind, "-o", output)
        assert code == 2
        assert message in err
    code, _, err = run("export", tmp_path / "no.toml", "--format", "toml", "-o", tmp_path / "y")
    assert code == 2
    assert "no such file" in err
    assert not os.listdir(tmp_path)
