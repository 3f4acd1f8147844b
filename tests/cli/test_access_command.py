"""``compass access`` as a user runs it."""

import csv
import json
import sys

import numpy as np
import pytest
import xarray as xr

from compass.cli.main import main

DESIGN = """
name = "Ring"
[constellation]
pattern = "walker-delta"
satellites = 3
planes = 1
phasing = 0
inclination_deg = 30
orbit = "areosynchronous"
[[station]]
name = "Base"
latitude_deg = 20
longitude_deg = 40
[[link]]
between = ["station", "satellite"]
frequency_mhz = 400
eirp_dbw = 7
g_over_t_db_per_k = -15
"""


@pytest.fixture
def design(tmp_path):
    path = tmp_path / "ring.toml"
    path.write_text(DESIGN)
    return path


def run(monkeypatch, capsys, *arguments):
    monkeypatch.setattr(sys, "argv", ["compass", "access", *map(str, arguments)])
    with pytest.raises(SystemExit) as stop:
        main()
    out, err = capsys.readouterr()
    return stop.value.code, out, err


def test_json_has_every_pair(design, monkeypatch, capsys):
    code, out, _ = run(
        monkeypatch, capsys, design, "--json", "--duration-sols", "2", "--moon", "deimos",
        "--earth", "--crosslinks", "--eclipse", "--station", "Camp=-10,-20,5",
    )  # fmt: skip
    assert code == 0
    found = json.loads(out)
    assert found["duration_sols"] == pytest.approx(2.0)
    assert len(found["pairs"]) == 2 * 5 + 4 + 3 + 3
    for pair in found["pairs"]:
        assert {"windows", "share", "longest_gap_h", "passes_per_sol"} <= set(pair)
        for window in pair["windows"]:
            assert 0 <= window["start_s"] < window["end_s"] <= 2 * 88775.25
            elevation = window["max_elevation_deg"]
            assert (elevation is not None) == (pair["first"] in ("Base", "Camp"))
            assert elevation is None or elevation >= (5 if pair["first"] == "Camp" else 0)
    assert {r["station"] for r in found["earth"]["stations"]} == {"Base", "Camp"}
    assert len(found["latency"]) == 2
    assert len(found["eclipses"]) == 4
    assert {r["first"] for r in found["radio"]} <= {"Base", "Camp"}


def test_text_is_a_summary(design, monkeypatch, capsys):
    code, out, _ = run(
        monkeypatch, capsys, design, "--pairs", "--earth", "--eclipse", "--station", "Camp=-85,170"
    )
    assert code == 0
    for heading in (
        "Ring: access over 10 sols",
        "Satellites in sight",
        "Reaching the Earth",
        "Store and forward between stations",
        "No eclipses of P1S1, P1S2, P1S3",
        "Radio links along their windows",
        "Pairs",
    ):
        assert heading in out
    assert any(line.split()[:2] == ["Base", "P1S1"] for line in out.splitlines())
    assert "0 seasons below 2 deg" in out


def test_many_stations_are_not_compared_with_each_other(design, monkeypatch, capsys):
    stations = [part for k in range(21) for part in ("--station", f"S{k}={k},{k}")]
    code, out, _ = run(monkeypatch, capsys, design, "--duration-sols", "0.1", *stations)
    assert code == 0
    assert "left out: there is too much of it" in out
    assert "Store and forward between stations\n---" not in out


@pytest.mark.parametrize("suffix", [".nc", ".csv", ".json"])
def test_windows_are_written(design, tmp_path, monkeypatch, capsys, suffix):
    path = tmp_path / f"windows{suffix}"
    code, _, err = run(monkeypatch, capsys, design, "--duration-sols", "3", "-o", path)
    assert code == 0
    assert f"wrote {path}" in err
    assert list(tmp_path.glob(".windows*")) == []
    _, text, _ = run(monkeypatch, capsys, design, "--duration-sols", "3", "--json")
    pairs = json.loads(text)["pairs"]
    starts = [w["start_s"] for pair in pairs for w in pair["windows"]]
    if suffix == ".nc":
        with xr.open_dataset(path, engine="h5netcdf", decode_times=False) as dataset:
            np.testing.assert_allclose(dataset["start"], starts)
            assert dataset.attrs["design"] == DESIGN
            assert dataset.attrs["history"].startswith("compass access")
            assert dataset["second"].values.tolist() == ["P1S1", "P1S2", "P1S3"]
    elif suffix == ".csv":
        with path.open() as stream:
            rows = list(csv.DictReader(stream))
        np.testing.assert_allclose([float(row["start_s"]) for row in rows], starts)
    else:
        assert json.loads(path.read_text())["pairs"] == pairs


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--duration-sols", "0"], "--duration-sols = 0: allowed above 0 to 1000 sols"),
        (["--duration-sols", "1e9"], "allowed above 0 to 1000 sols"),
        (["--duration-sols", "nan"], "--duration-sols = nan: must be a finite number"),
        (["--moon", "luna"], "'luna' is not one of 'phobos', 'deimos'"),
        (["--station", "x=91,0"], "latitude_deg = 91: allowed -90 to 90"),
        (["--station", "x=1,0,90"], "mask_deg = 90: allowed 0 up to below 90"),
        (["--station", "x=north,0"], "not NAME=LAT,LON or NAME=LAT,LON,MASK"),
        (
            ["--station", "Base=1,2"],
            "Base, a station and a station; stations have their names from [[station]] and",
        ),
        (["-o", "x.xls"], "must end in .nc, .csv, .json"),
        (["-o", "/no/such/folder/x.nc"], "does not exist"),
    ],
)
def test_bad_options_are_one_message(design, monkeypatch, capsys, arguments, message):
    code, out, err = run(monkeypatch, capsys, design, *arguments)
    assert code == 2
    assert message in err
    assert out == ""


def test_a_design_without_anything_to_link(tmp_path, monkeypatch, capsys):
    path = tmp_path / "bare.toml"
    path.write_text(DESIGN[: DESIGN.index("[[station]]")])
    code, _, err = run(monkeypatch, capsys, path)
    assert code == 2
    assert "nothing to link; add a [[station]] or use --station" in err
    code, out, _ = run(monkeypatch, capsys, path, "--crosslinks", "--duration-sols", "1")
    assert code == 0
    assert "Satellites in sight" not in out
