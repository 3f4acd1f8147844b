"""``compass judge`` as a user runs it."""

import json

import pytest
from scipy.stats import chi2

from compass.api.outlook import Glance
from compass.inputs import read_design
from compass.study import judge_worst, ranking, rival

INF = float("inf")
LANDER = "landing.toml"


@pytest.fixture
def files(designs, tmp_path, monkeypatch):
    """A short scenario and two small designs; only what is cheap when interpreted."""
    text = (designs / LANDER).read_text().replace("duration_s = 320", "duration_s = 20\nstep_s = 2")
    text = text.replace("mass = 2", "").replace(
        '[[trigger]]\nname = "parachute deployment"\nmach = 2\n', ""
    )
    text = text.replace('[beacons]\ndesign = "compass-15-5-1.toml"\n', "")
    (tmp_path / "lander.toml").write_text(text)
    for size in (2, 3):
        (tmp_path / f"{size}.toml").write_text(
            f"""
name = "{size} satellites"
[constellation]
pattern = "walker-delta"
satellites = {size}
planes = 1
phasing = 0
inclination_deg = 50
radius_km = 20428
[coverage]
fold = 1
"""
        )
    surface = {
        "fold": {"wanted": 1, "outcome": "refuted"},
        "mask_margin_deg": None,
        "gdop": {"p50": 2.0, "p50_bracket": [1.9, 2.1], "p95": INF, "p95_bracket": [INF, INF]},
        "availability": 0.9,
        "availability_bracket": [0.85, 0.95],
    }
    monkeypatch.setattr(ranking, "judge_surface", lambda *_, **__: surface)
    for name, value in (("MOMENTS", 1), ("BATCH", 2), ("SURVIVORS", 2)):
        monkeypatch.setattr(judge_worst, name, value)
    monkeypatch.setattr(rival, "COARSE", 0.7)
    monkeypatch.setattr(rival, "FINE", 0.35)
    original = ranking.worst_entry
    monkeypatch.setattr(ranking, "worst_entry", lambda *a, **o: original(*a, rounds=1, **o))
    return tmp_path


def test_landers_come_down_at_the_sites_and_in_the_regions_named(run, files):
    asked = (
        "judge", files / "2.toml", "-s", files / "lander.toml", "--site", "Gale=-4.6,137.4",
        "--region", "lat:10:30", "--samples", 4, "--finalists", 0,
    )  # fmt: skip
    status, out, _ = run(*asked, "--json")
    assert status == 0
    found = json.loads(out)
    assert found["ground"] == ["Gale", "lat:10:30"]
    (row,) = found["designs"]
    assert [area["name"] for area in row["areas"]] == found["ground"]
    assert row["areas"][0]["fold"]["met"] is False
    for worst in (row["worst_found"], row["after_loss"]["worst_found"]):
        at_gale = abs(worst["latitude_deg"] + 4.6) < 1e-3
        assert at_gale or 10 - 1e-3 < worst["latitude_deg"] < 30 + 1e-3
    status, out, _ = run(*asked)
    assert "at Gale, lat:10:30 and at any time?" in out and "At sites and in regions" in out
    status, _, err = run(*asked[:4], "--site", "Gale")
    assert status == 2 and "no [[station]] of that name; there are none" in err


def test_json_has_the_promised_keys(run, files):
    status, out, _ = run(
        "judge", files / "2.toml", files / "3.toml", "-s", files / "lander.toml",
        "--samples", 2, "--runs", 2, "--finalists", 1, "--json",
    )  # fmt: skip
    assert status == 0
    found = json.loads(out)
    assert found["samples"] == 2 and found["deployment"] == "20 s after entry"
    first, second = found["designs"]
    assert first["rank"] == 1 and second["rank"] == 2
    for row in (first, second):
        assert {"min", "median"} <= set(row["in_view"])
        assert {"p50", "p95", "worst", "worst_epoch_s"} <= set(row["crlb_position_m"])
        assert {"p50", "p95"} <= set(row["crlb_velocity_m_s"])
        assert {"unobservable_share", "fisher_log_det", "fisher_trace", "after_loss"} <= set(row)
    assert {"p50", "p95"} <= set(first["ekf_position_m"])
    low, high = chi2.ppf([0.025, 0.975], 6 * first["runs"]) / first["runs"]
    assert first["nees_interval"] == {"low": pytest.approx(low), "high": pytest.approx(high)}
    assert first["consistent"] is (
        first["nees_interval"]["low"] <= first["nees"] <= first["nees_interval"]["high"]
    )
    assert second["ekf_position_m"] == {"p50": None, "p95": None} and second["nees"] is None
    assert first["surface"]["gdop"]["p95"] is None


def test_tables_and_the_answer(run, files):
    status, out, _ = run(
        "judge", files / "2.toml", files / "3.toml", "-s", files / "lander.toml",
        "--samples", 2, "--runs", 2, "--finalists", 1, "--density-sigma", 0.2,
    )  # fmt: skip
    assert status == 0
    assert "density unknown by 20 %" in out and "L/D unknown" not in out
    assert "Users on the surface" in out
    assert "Within 10 m at deployment, anywhere and at any time?" in out
    assert "2 satellites: no: beyond it in" in out


def test_rival_is_written_and_ranked(run, files):
    path = files / "rival.toml"
    status, out, err = run(
        "judge", files / "3.toml", "-s", files / "lander.toml", "--samples", 2,
        "--finalists", 0, "--rival", path, "--json",
    )  # fmt: skip
    assert status == 0
    assert f"wrote {path}" in err
    names = [row["design"] for row in json.loads(out)["designs"]]
    assert len(names) == 2
    best = read_design(path)
    assert best.name == names[0] and best.constellation.size == 3


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["2.toml", "-s", "nowhere.toml"], "nowhere.toml"),
        (["2.toml", "-s", "2.toml"], "2.toml: is a design, not a scenario of landing"),
        (["2.toml", "-s", "lander.toml", "--samples", "0"], "samples = 0: allowed 1 to"),
        (
            ["2.toml", "-s", "lander.toml", "--goal-m", "nan"],
            "--goal-m = nan: must be a finite number",
        ),
        (["2.toml", "-s", "lander.toml", "--goal-m", "inf"], "must be a finite number"),
        (["2.toml", "-s", "lander.toml", "--seed", "-1"], "seed = -1: allowed 0 to"),
        (["2.toml", "-s", "lander.toml", "--runs", "1000000000"], "allowed 1 to 100000"),
        (["2.toml", "-s", "lander.toml", "--finalists", "-1"], "finalists = -1: allowed 0 to"),
        (["2.toml", "no.toml", "-s", "none.toml"], "none.toml: no such file; check the path\nno."),
        (
            ["2.toml", "-s", "lander.toml", "--rival", "r.toml", "--rival-radius-km", "nan"],
            "--rival-radius-km = nan: must be a finite number",
        ),
        (["2.toml", "-s", "late.toml"], "late.toml: entry at "),
        (
            ["2.toml", "-s", "lander.toml", "--lift-sigma", "-1"],
            "--lift-sigma = -1: allowed 0 to 10",
        ),
        (["2.toml", "-s", "lander.toml", "--density-sigma", "1e300"], "allowed 0 to 10"),
        (["2.toml", "-s", "lander.toml", "--rival", "2.toml"], "2.toml"),
        (["2.toml", "-s", "lander.toml", "--rival-radius-km", "26000"], "give --rival too"),
        (["-s", "lander.toml"], "Missing argument"),
    ],
)
def test_bad_input_is_said_in_one_message(run, files, monkeypatch, arguments, message):
    monkeypatch.chdir(files)
    lander = (files / "lander.toml").read_text()
    (files / "late.toml").write_text(f'{lander}\n[[trigger]]\nname = "parachute"\nmach = 2\n')
    status, out, err = run("judge", *arguments)
    assert status == 2 and out == ""
    assert message in err and "Traceback" not in err


def test_options_are_refused_before_a_rival_is_looked_for(run, files, monkeypatch):
    monkeypatch.setattr(rival, "judge_entries", None)
    horizon = (files / "2.toml").read_text() + "horizon_deg = [[0, 5], [90, 10]]\n"
    (files / "hills.toml").write_text(horizon)
    for design, options, message in (
        ("2.toml", ["--goal-m", 0], "--goal-m = 0: allowed above 0"),
        ("hills.toml", [], "a mask by azimuth cannot be carried over"),
    ):
        status, _, err = run(
            "judge", files / design, "-s", files / "lander.toml", "--samples", 2,
            "--rival", files / "r.toml", *options,
        )  # fmt: skip
        assert status == 2 and message in err
        assert not (files / "r.toml").exists()


def test_page_on_request(run, files, monkeypatch):
    monkeypatch.setattr("compass.pages.judge.glance", lambda d: Glance(d, 0.0, 40.0, "3 in view"))
    folder = files / "pages" / "judged"
    status, out, err = run(
        "judge", files / "2.toml", files / "3.toml", "-s", files / "lander.toml",
        "--samples", 2, "--runs", 2, "--finalists", 1, "-o", folder, "--json",
    )  # fmt: skip
    assert status == 0 and f"report: {folder / 'index.html'}" in err
    page = (folder / "index.html").read_text()
    assert "Users on the surface" in page and "no mask has it" in page
    assert "no time: at the epoch 3 in view" in page
    assert json.loads(out)["designs"][0]["answer"] in page
    assert (folder / "judge-map.png").read_bytes().startswith(b"\x89PNG")


def test_page_s_folder_is_checked_before_the_work(run, files, monkeypatch):
    monkeypatch.setattr(ranking, "judge_entries", None)
    status, out, err = run(
        "judge", files / "2.toml", "-s", files / "lander.toml", "-o", files / "3.toml" / "x",
    )  # fmt: skip
    assert status == 2 and out == ""
    assert "3.toml is a file; give another folder for the report" in err
