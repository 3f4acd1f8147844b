"""Finalists as designs, beside the design that a study compares with."""

from dataclasses import replace

from compass.inputs.study import read_study_text
from compass.pages import trade_finalists as module

STUDY = """
name = "t"
[study]
patterns = ["walker-delta"]
satellites = 5
inclination_deg = 50
orbits = ["half"]
[[objective]]
figure = "satellites"
[entry]
scenario = "landing.toml"
[compare]
design = "compass-15-5-1.toml"
"""


def test_a_yardstick_that_is_called_as_a_finalist_is(designs, monkeypatch):
    study = read_study_text(STUDY, folder=designs)
    old = replace(study.compare, label="finalist-1.toml")
    own = module.Entrant(None, replace(old, name="another"), "proven")
    monkeypatch.setattr(module, "rank_designs", lambda *_, **__: {})
    _, judged = module.rank_finalists(replace(study, compare=old), [own], print)
    assert [d.label for d in judged] == ["finalist-1.toml", "./finalist-1.toml"]
    assert judged[0].name == "another"
