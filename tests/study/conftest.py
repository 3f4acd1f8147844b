"""A small study, and a lander short of time: quick enough for interpreted kernels."""

import pytest
from trade_processes import CANDIDATES, STUDY, Trade

from compass.inputs.scenario import read_scenario_text
from compass.inputs.study import read_study_text

TEXT = """
name = "tiny"
[study]
patterns = ["walker-delta"]
satellites = [5, 6, 7]
inclination_deg = [40, 55]
orbits = ["areosynchronous"]
mask_deg = 5
fold = {fold}
{more}
[map]
step_deg = 45
epochs = 2
[[constraint]]
figure = "fold_proven"
at_least = 1
[[objective]]
figure = "satellites"
[[objective]]
figure = "mask_margin_deg"
"""

ENTRY = """
[entry]
scenario = "entry-compass.toml"
samples = 4
finalists = 3
[compare]
design = "compass-15-5-1.toml"
"""


@pytest.fixture
def tiny(designs):
    """Give a study of 52 candidates."""

    def make(more="", fold=1, entry=False):
        text = TEXT.format(more=more, fold=fold) + (ENTRY if entry else "")
        return read_study_text(text, "tiny.toml", designs)

    return make


@pytest.fixture(scope="session")
def short(designs):
    """Make a scenario of 20 steps from designs/landing.toml, with changes of its text."""
    text = (designs / "landing.toml").read_text()
    text = text.replace("duration_s = 320", "duration_s = 40\nstep_s = 2")
    text = text.replace('[[trigger]]\nname = "parachute deployment"\nmach = 2\n', "")
    text = text.replace('[beacons]\ndesign = "compass-15-5-1.toml"\n', "")

    def make(*changes):
        changed = text
        for old, new in changes:
            assert old in changed
            changed = changed.replace(old, new)
        return read_scenario_text(changed)

    return make


@pytest.fixture(scope="session")
def killed_study(tmp_path_factory):
    """Give the file of a study that takes a few seconds, long enough to be disturbed."""
    path = tmp_path_factory.mktemp("study") / "study.toml"
    path.write_text(STUDY)
    return path


@pytest.fixture(scope="session")
def undisturbed(killed_study, tmp_path_factory):
    """Give its results when nothing happens to it."""
    trade = Trade(killed_study, tmp_path_factory.mktemp("whole") / "store")
    summary = trade.start("--workers", 1).finish()
    assert summary["candidates"] == summary["computed"]["screen"] == CANDIDATES
    assert summary["feasible"] == summary["computed"]["map"] > 50
    assert set(trade.evaluations().values()) == {1}
    return trade.results()
