"""Verdicts and free variables of the trade report."""

import numpy as np
import pytest

from compass.inputs.study import read_study_text
from compass.report import trade_pictures
from compass.report.trade import _against, _verdict, trade_report
from compass.study.candidates import ROW
from compass.study.choice import Finalist
from compass.study.store import Store
from compass.study.trade import run_trade
from compass.study.workers import Here

TEXT = """
name = "sampled"
[study]
patterns = ["walker-delta"]
satellites = { least = 6, most = 9 }
inclination_deg = { least = 30, most = 70 }
radius_km = { least = 9000, most = 21000 }
fold = 1
[sampling]
method = "latin-hypercube"
samples = 60
[map]
step_deg = 45
epochs = 2
[[constraint]]
figure = "availability"
at_least = 0
[[objective]]
figure = "satellites"
[[objective]]
figure = "gdop_p50"
"""


@pytest.fixture
def coarse(monkeypatch):
    """Coarse maps: what they look like is not tested here."""
    monkeypatch.setattr(trade_pictures, "EPOCHS", 3)
    monkeypatch.setattr(trade_pictures, "CELL_DEG", 30.0)


def finalist(satellites, gdop):
    row = np.array([(0, satellites, 1, 0, 50.0, 20000.0, 0.0)], ROW)[0]
    return Finalist("x", row, {"satellites": float(satellites), "gdop_p50": gdop})


@pytest.mark.parametrize(
    ("other", "verdict"),
    [
        ((10, 4.0), "loses in all"),
        ((12, 5.0), "beats it in all"),
        ((10, 6.0), "a trade"),
        ((11, 4.5), "equal"),
        ((11, np.nan), "not comparable"),
    ],
)
def test_verdicts(other, verdict):
    study = read_study_text(TEXT)
    assert _verdict(study, finalist(11, 4.5), finalist(*other)) == verdict


def test_words():
    study = read_study_text(TEXT)
    text = _against(study, finalist(10, 4.5), finalist(10, 3.0))
    assert text == "satellites equal; gdop_p50 worse: 4.5 against 3 (+50.0 %)"
    assert "gdop_p50 inf against 3" in _against(study, finalist(9, np.inf), finalist(10, 3.0))


def test_free_variables_are_shown_in_classes(tmp_path, coarse):
    import contextlib

    class Bars:
        def __call__(self, *_):
            return contextlib.nullcontext(self)

        def update(self, n):
            pass

    study = read_study_text(TEXT)
    with Store(tmp_path, study) as store:
        run_trade(study, store, Here(study), Bars())
    page, sections, summary = trade_report(study, tmp_path)
    assert summary["feasible"] == summary["candidates"] == 60
    stems = {p.stem for s in sections for p in s.pictures}
    assert "sensitivity-gdop-p50" in stems
    assert "inclination" in page
