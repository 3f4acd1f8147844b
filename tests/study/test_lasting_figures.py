"""What studies say of real orbits: the quick law of keeping, and days that are proven."""

from dataclasses import replace

import numpy as np
import pytest

import compass
from compass.bodies import MARS_ROTATION_RATE
from compass.core.gravity import field_acceleration
from compass.core.patterns import Patterns
from compass.core.resonance import push_on_patterns
from compass.errors import DesignError
from compass.inputs.study import read_study, read_study_text
from compass.orbits.forces import ForceModel
from compass.orbits.gravity import built_in_field
from compass.orbits.motion import Motion
from compass.orbits.period import secular_rates
from compass.orbits.resonance import slow_pushes
from compass.study import lasting
from compass.study.candidates import ROW, make_constellation
from compass.study.lasting import (
    YEAR,
    keeping_law,
    orbits_figures,
    paths_left_alone,
    proven_days,
)
from compass.study.results import read_results
from compass.study.stages import evaluate

FIELD = built_in_field().truncated(8)
SYNCHRONOUS = 20427.7


def rows(*radii, kind=(0, 15, 5, 1), inclination=45.0):
    return np.array([(*kind, inclination, radius, 0.0) for radius in radii], ROW)


def mean_push(field, radius, inclination, u0, node0):
    """Mean push along the track of a circle that keeps pace with Mars, by plain sums over a day."""
    terms, scale = field.terms(), field.gm / field.radius**2
    total = 0.0
    steps = np.linspace(0.0, 2 * np.pi, 240, endpoint=False)
    for x in steps:
        u, node = u0 + x, node0 - x
        cu, su, cn, sn = np.cos(u), np.sin(u), np.cos(node), np.sin(node)
        ci, si = np.cos(inclination), np.sin(inclination)
        p = radius * np.array([cn * cu - sn * su * ci, sn * cu + cn * su * ci, su * si])
        t = np.array([-cn * su - sn * cu * ci, -sn * su + cn * cu * ci, cu * si])
        total += t @ field_acceleration(*p, terms, field.degree + 1, field.radius, scale)
    return total / steps.size


@pytest.mark.parametrize("inclination_deg", [0.0, 45.0, 110.0])
def test_the_resonant_terms_are_the_mean_of_a_day(inclination_deg):
    field = built_in_field().truncated(4)
    a, i = SYNCHRONOUS * 1e3, np.radians(inclination_deg)
    slow = slow_pushes(field, [a], [i])
    alike = slow.waves[0, :, 0] == slow.waves[0, :, 1]
    assert np.all(alike[:2])
    for u0, node0 in ((0.3, 1.0), (2.0, 4.0)):
        angle = slow.waves[0] @ [u0, node0]
        push = slow.pushes[0, :, 0] * np.cos(angle) - slow.pushes[0, :, 1] * np.sin(angle)
        known = mean_push(field, a, i, u0, node0)
        assert push[alike].sum() == pytest.approx(known, rel=1e-6, abs=1e-13)


def test_a_beat_swings_as_far_and_as_long_as_orbits_do():
    """20,227.7 km: J22 swings the argument of latitude by 1.5 deg with a beat of 34.5 d (own)."""
    slow = slow_pushes(FIELD, [20227.7e3], [np.pi / 4])
    assert slow.waves[0, 0].tolist() == [2.0, 2.0]
    assert np.degrees(slow.swings[0, 0]) == pytest.approx(1.5, abs=0.1)
    assert 2 * np.pi / slow.rates[0, 0] / 86400 == pytest.approx(34.5, abs=0.3)


def test_over_the_equator_the_law_is_that_of_areostationary_satellites():
    """38.0 m/s a year at 212.5 E, next to nothing at 342.1 E (Silva and Romero 2013)."""
    node, periapsis, anomaly = secular_rates(20429.4e3, 0.0, 0.0)
    assert node + periapsis + anomaly == pytest.approx(MARS_ROTATION_RATE.value, rel=1e-4)
    slow = slow_pushes(FIELD, [20429.4e3], [0.0])
    found = np.empty(2)
    for k, longitude in enumerate((212.5, 342.1)):
        push_on_patterns(
            Patterns(*(np.array([n]) for n in (False, 1, 1, 0, 0.0))), np.array([0]),
            -np.radians(longitude), np.array([0.05]), slow.swings, slow.waves, slow.pushes,
            found[k : k + 1],
        )  # fmt: skip
    assert found[0] * YEAR == pytest.approx(38.0, rel=0.01)
    assert found[1] * YEAR < 0.1


def test_near_a_resonance_keeping_costs_and_far_from_it_nothing():
    """0.9 to 26.1 m/s an Earth year by slot of the published pattern (own, first ten days)."""
    spare = np.radians(np.full(5, 6.18))
    found = keeping_law(rows(SYNCHRONOUS, 20027.0, 20827.0, 12868.9, 17000.0), spare)
    assert found[0] == pytest.approx(26.1, rel=0.03)
    assert found[[1, 2, 4]].tolist() == [0.0, 0.0, 0.0]
    assert 1.0 < found[3] < 10.0  # two turns a day
    assert np.isnan(keeping_law(rows(SYNCHRONOUS), np.array([np.nan]))[0])
    assert np.isnan(keeping_law(rows(SYNCHRONOUS), np.array([-0.01]))[0])


STUDY = """
name = "lasting"
[study]
patterns = ["walker-delta"]
satellites = [5]
planes = [5]
phasing = [1]
inclination_deg = [43.66]
radius_km = [20027, 20427.7]
fold = 1
[orbits]
days = {days}
[[constraint]]
figure = "days_proven"
at_least = {days}
[[objective]]
figure = "delta_v_keeping_m_s_year"
"""


def test_a_study_names_what_it_is_put_through():
    study = read_study_text(STUDY.format(days=1))
    assert study.stages == ("screen", "map", "orbits")
    assert study.orbits.days == 1.0
    screened = evaluate("screen", study, rows(20027.0, SYNCHRONOUS, kind=(0, 5, 5, 1)))
    low, high = screened.figures["delta_v_keeping_m_s_year"]
    assert low == 0.0 < high
    assert "days_proven" not in screened.figures


def test_a_study_says_how_its_candidates_move_and_how_they_come_there():
    plain = read_study_text(STUDY.format(days=1))
    assert plain.motion == Motion("numerical")
    told = read_study_text(
        STUDY.format(days=1) + '[motion]\nmodel = "numerical"\nsun = false\ngravity_degree = 4\n'
        "[deployment]\nlongest_wait_days = 30\n"
    )
    assert told.motion == Motion("numerical", ForceModel(FIELD.truncated(4), sun=False))
    assert told.launching.longest_wait == 30 * 86400.0
    assert told.digest != plain.digest
    with pytest.raises(DesignError, match='sun = false: counts with model = "numerical" only'):
        read_study_text(STUDY.format(days=1) + "[motion]\nsun = false\n")


def test_the_law_follows_the_field_of_the_study():
    """Of a field of zonals alone nothing keeps pace with Mars."""
    zonal = replace(FIELD, c=np.where(np.arange(9) == 0, FIELD.c, 0.0), s=0.0 * FIELD.s)
    motion = Motion("numerical", ForceModel(zonal))
    assert keeping_law(rows(SYNCHRONOUS), np.radians([6.18]), motion)[0] == 0.0


@pytest.mark.slow
def test_resonant_candidates_do_not_last(tmp_path, monkeypatch):
    """A mask that leaves a degree of margin: in resonance it goes, 400 km lower it does not."""
    study = read_study_text(STUDY.format(days=60) + "[map]\nstep_deg = 45\nepochs = 1\n")
    candidates = rows(20027.0, SYNCHRONOUS, kind=(0, 5, 5, 1), inclination=43.66)
    candidates["mask_deg"] = evaluate("screen", study, candidates).figures["mask_margin_deg"] - 0.9
    days = orbits_figures(study, candidates)["days_proven"]
    assert days[0] == 60.0
    assert 1.0 < days[1] < 60.0
    # a part of the days, if it is lost in it, is as good as all
    c, mask = make_constellation(candidates[1]), float(np.radians(candidates["mask_deg"][1]))
    asked = (c, study.fold, 60.0, study.figure, mask)
    monkeypatch.setattr(lasting, "SHORT", 1.0)
    assert proven_days(*asked) == pytest.approx(days[1], abs=2e-5)
    assert [until for until, _ in paths_left_alone(c, 60.0)] == [3.75, 15.0, 60.0]
    # without the field's longitudes nothing pushes along the track
    smooth = read_study_text(study.text + '[motion]\nmodel = "j2"\n')
    assert orbits_figures(smooth, candidates)["days_proven"].tolist() == [60.0, 60.0]
    path = tmp_path / "s.toml"
    mask = float(candidates["mask_deg"].min())
    path.write_text(study.text.replace("fold = 1", f"fold = 1\nmask_deg = {mask}"))
    store = tmp_path / "store"
    run = compass.trade(path, store=store, workers=1).to_dict()
    assert (run["candidates"], run["reached"]["orbits"]) == (2, 2)
    results = read_results(read_study(path), store)
    assert results.feasible.values.tolist() == [True, False]
    page = compass.report(path, store=store, output=tmp_path / "page").page.read_text()
    assert "none needed" in page
    assert "days proven" in page


def test_no_orbit_has_no_pushes_and_is_no_error():
    """A block of candidates may have none whose orbits are to be looked at."""
    field = built_in_field().truncated(4)
    none, one = slow_pushes(field, [], []), slow_pushes(field, [2e7], [0.7])
    assert none.rates.shape == (0, *one.rates.shape[1:]) and none.waves.shape[0] == 0
