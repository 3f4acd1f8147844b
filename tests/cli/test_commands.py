import functools
import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray as xr

import compass
from compass.document.plain import plain
from compass.errors import found_so_far

SMALL = ["--step-deg", 15, "--epochs", 6]
HEAVY = {"numba", "scipy", "xarray", "matplotlib", "pydantic", "numpy", "shapely", "pyproj"}


@pytest.fixture(scope="module")
def seed(designs):
    return designs / "compass-15-5-1.toml"


def test_help_lists_the_commands_and_imports_nothing_heavy():
    script = (
        "import sys\nsys.argv = ['compass', '--help']\nfrom compass.cli.main import main\n"
        "try:\n    main()\nfinally:\n"
        "    print(sorted({m.split('.')[0] for m in sys.modules}), file=sys.stderr)"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    for name in ("map", "report", "reproduce", "show"):
        assert name in done.stdout
    assert not HEAVY & set(eval(done.stderr))


def test_a_name_that_no_file_can_have(run, seed, tmp_path):
    name = tmp_path / ("x" * 300)
    for arguments in (
        ["export", seed, "--format", "toml"], ["export", seed, "--format", "oem"],
        ["report", seed],
    ):  # fmt: skip
        code, out, err = run(*arguments, "-o", name)
        assert (code, out) == (2, "")
        assert err.startswith(f"{name}: File name too long; give another") and "\n" not in err[:-1]


def test_show_json_has_the_agreed_keys(run, seed):
    code, out, _ = run("show", seed, "--json")
    assert code == 0
    result = json.loads(out)
    assert set(result) >= {"constellation", "cap", "gap"}
    assert set(result["cap"]) >= {
        "half_cone_deg", "half_arc_deg", "tangent_km", "radius_km", "depth_km", "arc_km",
    }  # fmt: skip
    assert result["cap"]["area_km2"]["exact"] == pytest.approx(6.042224e7, rel=1e-6)
    assert result["cap"]["area_km2"]["published"] == pytest.approx(7.14697e7, rel=1e-6)
    assert result["cap"]["fraction"]["exact"] == pytest.approx(0.41687, abs=1e-6)
    assert result["gap"]["area_km2"]["exact"] == pytest.approx(1.680403e6, rel=1e-6)
    assert set(result["gap"]) >= {
        "depth_km", "base_km", "vertex_deg", "limit_circumference_km", "circumference_km",
    }  # fmt: skip
    assert any(row["verdict"] == "erratum" for row in result["comparison"])


def test_show_for_every_kind_of_design(run, designs):
    for path in sorted(designs.glob("*.toml")):
        if "[constellation]" not in path.read_text():
            continue
        code, out, _ = run("show", path)
        assert code == 0
        assert "satellites" in out
        code, out, _ = run("show", path, "--json")
        assert code == 0
        json.loads(out)


def test_show_has_elements_in_full(designs):
    """As Draim's file gives them, and as it takes to make its orbits anew."""
    shown = compass.show(designs / "draim-four.toml")
    (table,) = shown.geometry_tables()
    rows = [dict(zip(table.header, row, strict=True)) for row in table.rows]
    names = ("inclination, deg", "RAAN, deg", "argument of periapsis, deg", "mean anomaly, deg")
    assert [[float(row[name].value) for name in names] for row in rows] == [
        [31.3, 0.0, 270.0, 0.0],
        [31.3, 90.0, 90.0, 270.0],
        [31.3, 180.0, 270.0, 180.0],
        [31.3, 270.0, 90.0, 90.0],
    ]


def test_show_says_why_there_are_no_gaps(run, tmp_path, seed):
    text = (
        seed.read_text().replace("planes = 5", "planes = 15").replace("phasing = 1", "phasing = 1")
    )
    path = tmp_path / "single.toml"
    path.write_text(text)
    code, out, _ = run("show", path)
    assert code == 0
    assert "caps of 1 satellite a plane do not meet" in out


@pytest.mark.slow  # interpreted, nothing is certified
def test_map_writes_file_and_picture(run, seed, tmp_path):
    nc, png = tmp_path / "m.nc", tmp_path / "m.png"
    code, out, _ = run("map", seed, *SMALL, "-o", nc, "--figure", png, "--time-series", "--json")
    assert code == 0
    result = json.loads(out)
    assert result["count"]["min"] >= 4
    assert result["fold_share"]["4"] == pytest.approx(1.0)
    for name in ("gdop", "pdop", "hdop", "vdop", "tdop"):
        ranks = {"p50", "p90", "p95", "p99"}
        known = "interval" if name in ("hdop", "vdop") else "bracket"
        assert ranks <= set(result[name]) <= ranks | {f"{rank}_{known}" for rank in ranks}
    assert 0.9 < result["availability"] <= 1
    assert png.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    with xr.open_dataset(nc, engine="h5netcdf") as data:
        assert data.attrs["design_text"] == seed.read_text()
        assert data.attrs["command_line"].startswith("compass map")
        assert data.gdop_series.shape == (6, 12, 24)


def test_map_prints_tables_for_reading(run, seed):
    code, out, _ = run("map", seed, *SMALL, "--grid", "equal-area", "--motion", "j2")
    assert code == 0
    assert "at least 4 in view" in out
    assert "GDOP" in out


def test_higher_mask_sees_fewer(run, seed):
    means = []
    for mask in (0, 20):
        _, out, _ = run("map", seed, *SMALL, "--mask-deg", mask, "--json")
        means.append(json.loads(out)["count"]["mean"])
    assert means[0] > means[1] + 1


def test_infinite_percentiles_are_null(run, designs):
    code, out, _ = run("map", designs / "areostationary-trio.toml", *SMALL, "--json")
    assert code == 0
    assert json.loads(out)["gdop"]["p50"] is None


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--step-deg", "0"], "--step-deg = 0: allowed 0.05 to 90"),
        (["--step-deg", "7"], "nearest that fits"),
        (["--mask-deg", "95"], "--mask-deg = 95: allowed above -90 up to below 90"),
        (["--mask-deg", "nan"], "--mask-deg = nan"),
        (["--epochs", "0"], "--epochs = 0: allowed 1 to"),
        (["--epochs", "many"], "not a valid integer"),
        (["--duration-h", "0"], "--duration-h = 0: allowed above 0"),
        (["--fold", "0"], "--fold = 0: allowed 1 to"),
        (["--pdop-max", "0"], "--pdop-max = 0: allowed 1 to"),
        (["--grid", "hex"], "is not one of"),
        (["--time-series"], "needs a file to write to"),
        (["-o", "{design}"], "is an input itself"),
        (["-o", "{folder}"], "is a directory"),
        (["-o", "{folder}/no/x.nc"], "does not exist"),
        (["-o", "{folder}/x", "--figure", "{folder}/x"], "give another name"),
        ([*SMALL, "--figure", "{folder}/x", "--of", "dop"], "--of = 'dop': not a map; allowed"),
        ([*SMALL, "--of", "pdop"], "--of pdop: needs a picture; add --figure FILE.png"),
    ],
)
def test_bad_options_are_one_message_and_exit_2(run, seed, tmp_path, arguments, message):
    filled = [str(a).format(design=seed, folder=tmp_path) for a in arguments]
    code, out, err = run("map", seed, *filled)
    assert (code, out) == (2, "")
    assert message in err
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("command", "name", "second"),
    [
        ("series", "x.csv", "--figure"),
        ("determine", "x.toml", "--figure"),
        ("drift", "x.nc", "--elements"),
    ],
)
def test_no_output_is_written_over_by_another(run, designs, tmp_path, command, name, second):
    path, design = tmp_path / name, designs / "tracked-15-5-1.toml"
    code, out, err = run(command, design, "-o", path, second, path)
    assert (code, out) == (2, "")
    assert f"{path}: is two outputs at once; give another name" in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["show", "map", "report"])
def test_bad_design_is_one_message_and_exit_2(run, tmp_path, command):
    path = tmp_path / "bad.toml"
    path.write_text("name = 3\n")
    code, out, err = run(command, path)
    assert (code, out) == (2, "")
    assert err.count("bad.toml") == 2  # name is no text; constellation is missing
    assert run(command, tmp_path / "none.toml")[0] == 2


@pytest.mark.slow
def test_reproduce_prints_every_row_and_its_json(run, monkeypatch):
    monkeypatch.setattr(compass, "reproduce", functools.cache(compass.reproduce))  # long work once
    code, out, _ = run("reproduce", "kelly2018", "--json")
    result = json.loads(out)
    assert code == 1  # two statements are neither reproduced nor shown to be wrong
    assert result["paper"] == "kelly2018"
    assert result["differs"] == 2
    assert set(result["rows"][0]) >= {
        "item", "published", "computed", "unit", "criterion", "verdict", "reason", "difference",
    }  # fmt: skip
    code, out, _ = run("reproduce", "kelly2018")
    assert code == 1
    assert "60,422,2" in out
    assert run("reproduce", "nobody1999")[0] == 2


def test_reproduce_exits_1_if_a_number_differs(run, monkeypatch):
    from compass.papers import kelly2018
    from compass.papers.verdict import compare

    monkeypatch.setattr(kelly2018, "rows", lambda: [compare("x", "Table 9", "1.0", 2.0)])
    code, out, _ = run("reproduce", "kelly2018")
    assert code == 1
    assert "differs: no reason on record" in out


def test_unknown_command_and_version(run):
    assert run("fly")[0] == 2
    code, out, _ = run("--version")
    assert code == 0
    assert out.startswith("compass, version")


def test_interruption_is_said_and_has_its_own_exit_code(run, seed, monkeypatch):
    def interrupt(*_, **__):
        with found_so_far(lambda: "this much is known"):
            raise KeyboardInterrupt

    monkeypatch.setattr("compass.api.show.given_in_metres", interrupt)
    code, _, err = run("show", seed)
    assert code == 130
    assert "this much is known\ninterrupted; nothing half-written was left behind\n" in err


@pytest.mark.slow
def test_closed_pipe_is_no_error(seed):
    script = f"{sys.executable} -m compass.cli.main show {seed} | head -1"
    done = subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True)
    assert done.stderr == ""


@pytest.mark.slow
def test_killed_map_leaves_the_old_file(seed, tmp_path):
    path = tmp_path / "m.nc"
    path.write_text("old")
    arguments = ["map", str(seed), "--step-deg", "0.5", "--time-series", "-o", str(path)]
    with subprocess.Popen([sys.executable, "-m", "compass.cli.main", *arguments]) as process:
        deadline = time.monotonic() + 60
        while len(list(tmp_path.iterdir())) < 2 and time.monotonic() < deadline:
            time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
        process.wait(10)
    assert path.read_text() == "old"


def test_plain_values_for_json():
    made = plain({"a": np.float64("inf"), 2: (np.int64(3), float("nan")), "c": np.array([1.5])})
    assert made == {"a": None, "2": [3, None], "c": [1.5]}


def test_unwritable_output_is_refused_before_any_work(run, seed, tmp_path, monkeypatch):
    real = os.access
    monkeypatch.setattr("os.access", lambda path, mode: mode != os.W_OK and real(path, mode))
    code, _, err = run("map", seed, *SMALL, "-o", tmp_path / "x.nc")
    assert code == 2
    assert "not writable" in err


@pytest.mark.parametrize(
    "line",
    [
        "search --require {wanted} --max-satellites 4 --radius-km 20427 -o {wanted}",
        "horizon {design} --terrain {heights} -o {heights}",
        "judge {design} -s {scenario} --rival {scenario}",
        "judge {design} -s {scenario} --rival {named}",
        "land {scenario} -o {named}",
    ],
)
def test_what_is_read_is_not_written_over(run, designs, tmp_path, line):
    """By options, and by files that those given name: a scenario's constellation was lost."""
    kept = {"wanted": "five-landing-sites.toml", "design": "draim-four.toml",
            "scenario": "landing.toml", "named": "compass-15-5-1.toml"}  # fmt: skip
    files = {key: tmp_path / name for key, name in kept.items()} | {"heights": tmp_path / "h.nc"}
    for key, file in files.items():
        file.write_text((designs / kept[key]).read_text() if key in kept else "heights")
    before = {file: file.read_text() for file in files.values()}
    code, out, err = run(*line.format(**files).split())
    assert (code, out) == (2, "")
    assert "is an input itself; choose another output name" in err
    assert {file: file.read_text() for file in tmp_path.iterdir()} == before


def test_compilation_is_announced_once_and_only_while_the_command_runs(run, monkeypatch):
    from numba.core import event

    from compass.papers import kelly2018

    def compile_two():
        for _ in range(2):
            with event.trigger_event("numba:compile"):
                pass
        return []

    monkeypatch.setattr(kelly2018, "rows", compile_two)
    _, out, err = run("reproduce", "kelly2018", "--json")
    assert json.loads(out)["rows"] == []
    assert err.count("compiling kernels") == 1
    with event.trigger_event("numba:compile"):
        pass
