"""``compass trade`` and ``compass report STUDY`` as a user runs them."""

import json
import re

import pytest

from compass.api.outlook import Glance
from compass.pages import trade_pictures
from compass.study import stages
from compass.study.workers import Processes
from compass.words import counted
from tests.one_process import OneProcess

STUDY = """
name = "Tiny <study>"
[study]
patterns = ["walker-delta", "walker-star"]
satellites = [5, 6, 7]
inclination_deg = [40, 55]
orbits = ["areosynchronous", "half"]
mask_deg = 5
fold = {fold}
[map]
step_deg = 45
epochs = 2
[[constraint]]
figure = "fold_proven"
at_least = 1
[[objective]]
figure = "satellites"
[[objective]]
figure = "delta_v_total_m_s"
[[objective]]
figure = "mask_margin_deg"
"""


@pytest.fixture
def coarse(monkeypatch):
    """Coarse maps, no orbits followed: what they look like is not tested here."""
    monkeypatch.setattr(trade_pictures, "EPOCHS", 3)
    monkeypatch.setattr(trade_pictures, "CELL_DEG", 30.0)
    monkeypatch.setattr("compass.pages.trade_finalists.glance", lambda d: Glance(d, 31.7, 40.0, ""))


@pytest.fixture
def study(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def write(text=STUDY, fold=1):
        path = tmp_path / "tiny.toml"
        path.write_text(text.format(fold=fold))
        return path

    return write


def test_trade_then_report(study, run, tmp_path, designs, coarse):
    compare = str(designs / "compass-15-5-1.toml")
    path = study(STUDY + f"[compare]\ndesign = '{compare}'\n")
    status, out, err = run("trade", path, "--workers", 1, "--json")
    assert status == 0, err
    result = json.loads(out)
    # patterns t/p/f of 5, 6 and 7 satellites: 6 + 12 + 8; two kinds, but stars of one plane are deltas;
    # two inclinations, two orbits
    assert result["candidates"] == result["computed"]["screen"] == (2 * 26 - 3) * 4
    assert result["feasible"] == result["reached"]["map"] > len(result["front"]) > 0
    assert (tmp_path / "trades/tiny/trade.nc").is_file()
    status, out, _ = run("trade", path, "--workers", 1)
    assert status == 0 and "Pareto front" in out and "196 candidates" in out
    status, out, err = run("report", path, "--json")
    assert status == 0, err
    summary = json.loads(out)
    assert summary["candidates"] == 196 and summary["feasible"] == result["feasible"]
    assert summary["first_front"] == len(result["front"])
    assert all(f["certificate"] == "proven" for f in summary["finalists"])
    assert summary["compared_with"]["figures"]["satellites"] == 15
    folder = tmp_path / "reports/tiny"
    page = (folder / "index.html").read_text()
    assert "Tiny &lt;study&gt;" in page and "Recommendation" in page
    for title in (
        "Pareto fronts",
        "The best by objective",
        "Sensitivity",
        "the change from COMPASS",
    ):
        assert title in page
    assert json.loads((folder / "summary.json").read_text()) | {"page": summary["page"]} == summary
    pictures = {p.stem for p in folder.glob("*.*g")}
    assert {"finalist-maps", "sensitivity-share", "front-satellites-delta-v-total-m-s"} <= pictures
    status, out, _ = run("report", path)
    assert status == 0 and out.startswith("report: reports/tiny")


def test_nothing_meets_the_constraints(study, run, coarse):
    path = study(fold=6)
    status, out, _ = run("trade", path, "--workers", 1, "--json")
    assert status == 1
    assert json.loads(out)["feasible"] == 0 and json.loads(out)["front"] == []
    status, out, _ = run("report", path, "--json")
    assert status == 0 and json.loads(out)["finalists"] == []


def test_an_objective_that_no_candidate_has(study, run):
    text = STUDY.replace('figure = "fold_proven"\nat_least = 1', 'figure = "planes"\nat_least = 1')
    path = study(text.replace("mask_margin_deg", "cap_radius_min_deg"), fold=9)
    status, out, err = run("trade", path, "--workers", 1, "--json")
    assert status == 1 and json.loads(out)["feasible"] == 196 and json.loads(out)["front"] == []
    assert "meets every constraint has a value of cap_radius_min_deg; choose another" in err


def test_candidates_that_raise_say_why(study, run, monkeypatch):
    def broken(study, rows):
        raise ZeroDivisionError("by nothing")

    monkeypatch.setitem(stages.FINDERS, "map", broken)  # which a process of its own would not see
    monkeypatch.setattr("compass.api.trade.Processes", lambda study, _: OneProcess(study))
    status, out, err = run("trade", study(), "--json")
    assert status == 1 and json.loads(out)["feasible"] == 0
    count = json.loads(out)["failed"]["map"]
    assert f"{counted(count, 'candidate')} raised an error" in err
    assert "the first: ZeroDivisionError: by nothing" in err


def test_a_large_pool_is_offered_by_default(study, run, monkeypatch):
    monkeypatch.setattr("compass.api.trade.cores", lambda asked: asked or 1)
    status, out, _ = run("trade", study(), "--store", "elsewhere", "--json")
    assert status == 0 and json.loads(out)["store"] == "elsewhere"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--workers", 0], "--workers = 0: allowed 1 to 1024"),
        (["--workers", 1, "--scheduler", "tcp://a:1"], "--workers and --scheduler: not both"),
        (
            ["--tls-ca", "a.pem"],
            "--tls-ca, --tls-cert, --tls-key and --scheduler: all four go together\n",
        ),
        (
            ["--scheduler", "tls://a:1", "--tls-ca", "a", "--tls-cert", "b", "--tls-key", "c"],
            "a: no such file; give a certificate",
        ),
        (["--scheduler", "here"], "not an address; write it as tcp://host:port"),
    ],
)
def test_wrong_options(study, run, options, message):
    if "here" in options:
        pytest.importorskip("distributed")
    status, out, err = run("trade", study(), *options)
    assert status == 2 and out == "" and message in err


def test_wrong_files(study, run, tmp_path):
    status, _, err = run("trade", tmp_path / "none.toml")
    assert status == 2 and "no such file" in err
    status, _, err = run("trade", study(STUDY.replace("[5, 6, 7]", "[5]\nplanes = 2")))
    assert status == 2 and "study: no candidate" in err
    assert not (tmp_path / "trades").exists()
    status, _, err = run("report", study())
    assert status == 2 and "no such store; run `compass trade" in err


def test_a_store_of_another_study(study, run):
    assert run("trade", study(), "--workers", 1)[0] == 0
    status, out, err = run("trade", study(fold=2), "--workers", 1)
    assert status == 2 and out == "" and "the store of another study" in err


def test_a_design_has_no_store(run, designs):
    status, _, err = run("report", designs / "compass-15-5-1.toml", "--store", "x")
    assert status == 2 and "is not a study" in err


@pytest.mark.parametrize("option", ["--step-deg", "--epochs"])
def test_only_a_design_s_maps_are_as_fine_as_an_option_says(study, run, designs, option):
    for path in (study(), designs / "landing.toml"):
        status, out, err = run("report", path, option, 3)
        assert status == 2 and out == ""
        assert f"{option}: {path} is not a design" in err and "leave it out" in err


def test_a_damaged_store_is_said(study, run, tmp_path):
    path = study()
    assert run("trade", path, "--workers", 1)[0] == 0
    store = tmp_path / "trades/tiny/candidates.jsonl"
    whole = store.read_bytes()
    store.write_bytes(whole[:-10])
    status, _, err = run("trade", path, "--workers", 1)
    assert status == 0 and "1 damaged line ignored" in err
    assert len(store.read_bytes()) == pytest.approx(len(whole), abs=20)


def test_a_lander_that_never_deploys_is_refused_at_once(study, run, tmp_path, designs):
    text = (designs / "landing.toml").read_text().replace("duration_s = 320", "duration_s = 5")
    text = text.replace("compass-15-5-1.toml", str(designs / "compass-15-5-1.toml"))
    (tmp_path / "lander.toml").write_text(text)
    status, out, err = run("trade", study(STUDY + '[entry]\nscenario = "lander.toml"\n'))
    assert status == 2 and out == ""
    assert "lander.toml: entry at " in err and "has not come by 5 s to deployment" in err
    assert not (tmp_path / "trades").exists()


def test_a_lander_that_cannot_be_judged_is_refused_at_once(study, run, tmp_path, designs):
    text = (
        (designs / "landing.toml")
        .read_text()
        .replace("range_sigma_m = 50", "range_sigma_m = 50\nin_turn = true")
    )
    text = text.replace("compass-15-5-1.toml", str(designs / "compass-15-5-1.toml"))
    (tmp_path / "lander.toml").write_text(text)
    status, out, err = run("trade", study(STUDY + '[entry]\nscenario = "lander.toml"\n'))
    assert status == 2 and out == ""
    assert "lander.toml: measurements.in_turn = true" in err and "set it to false" in err
    assert not (tmp_path / "trades").exists()


def test_candidates_whose_workers_died_are_named(study, run, monkeypatch):
    honest = Processes.run

    def lose_the_first(self, stage, batches, until):
        for k, (rows, found) in enumerate(honest(self, stage, batches, until)):
            yield rows, None if stage == "map" and k == 0 else found

    monkeypatch.setattr(Processes, "run", lose_the_first)
    status, out, err = run("trade", study(), "--workers", 1, "--json")
    result = json.loads(out)
    assert status == 1 and result["unfinished"] > len(result["lethal"]) == 5
    assert f"{counted(result['unfinished'], 'candidate')} left out, whose workers died" in err
    assert re.search(r"\n  walker-\w+ \d/\d/\d at \d+ deg, radius [\d.]+ km, mask 5 deg\n", err)
    assert err.endswith("\n  ...\n")
    monkeypatch.setattr(Processes, "run", honest)
    status, _, err = run("trade", study(), "--workers", 1)
    assert status == 0 and "left out" not in err
