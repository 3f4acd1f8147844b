"""Finalists as designs, beside the design that a study compares with."""

from dataclasses import replace

import numpy as np

from compass.inputs.study import read_study_text
from compass.pages import trade_finalists as module
from compass.study.candidates import ROW
from compass.study.choice import Finalist
from compass.study.results import known_figures

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


def test_a_recommendation_says_proven_bounds_where_it_has_them(designs):
    text = STUDY.replace(
        'figure = "satellites"', 'figure = "satellites"\n[[objective]]\nfigure = "gdop_p95"'
    )
    study = read_study_text(text.replace("patterns", "fold = 4\npatterns"), folder=designs)
    row = np.array([(0, 15, 5, 1, 45.0, 20427.0, 0.0)], ROW)[0]
    figures = dict.fromkeys(known_figures(study), np.nan) | {"satellites": 15.0, "gdop_p95": 2.9}
    first = Finalist("balanced", row, figures, {}, {"gdop_p95": (2.85, 2.95)})
    one = module.Entrant(first, study.compare, "proven")
    said = str(module.recommendation(study, [one], None, None))
    assert "2.85 to 2.95" in said and "2.9;" not in said
    assert "15 satellites in 5 planes" in said


def test_what_a_study_requires_is_handed_over_and_answered(designs):
    """The recommended one as a file that `check` settles alike, its tracks declared closed."""
    required = """
[[station]]
name = "E"
latitude_deg = 0
longitude_deg = 20
[[requirement]]
name = "one"
sites = ["E"]
fold = 1
[[requirement]]
name = "five"
sites = ["E"]
fold = 5
[study]"""
    study = read_study_text(STUDY.replace("[study]", required), folder=designs)
    radius = study.space.radius_km[0]
    row = np.array([(0, 5, 5, 1, 50.0, radius, 0.0)], ROW)[0]
    figures = dict.fromkeys(known_figures(study), np.nan) | {"satellites": 5.0}
    (one,) = module.entrants(study, [Finalist("balanced", row, figures)])
    assert one.design.constellation.repeat == (2, 1)
    assert one.design.requirements == study.requirements
    assert [verdict.met for verdict in one.verdicts] == [True, False]
    said = str(module.recommendation(study, [one], None, None))
    assert "Requirements" in said and "five: missed at E, " in said
    answers = str(module.answer_section(study, [one], None, None, None))
    assert "one: 1 satellite" in answers
