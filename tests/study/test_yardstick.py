"""The design to compare with: as a candidate, or by itself where it is no pattern."""

from dataclasses import replace

import numpy as np
import pytest

from compass.document import Bracket, Value
from compass.inputs import read_design
from compass.inputs.study import Objective
from compass.orbits import keplerian
from compass.pages.trade_finalists import known as shown
from compass.quantities.merits import merits_of
from compass.study.yardstick import yardstick


def test_a_pattern_goes_the_way_of_the_candidates(tiny):
    measure = yardstick(tiny(entry=True))
    # COMPASS, Kelly and Bevilacqua 2018: 15 satellites in 5 planes at 45 deg
    assert measure.role == "COMPASS 15/5/1" and measure.notation.startswith("delta 45°: 15/5/1")
    assert measure.figures["fold_proven"] == 1.0
    assert (measure.variables["phasing"], measure.variables["mask_deg"]) == (1, 5)
    assert measure.variables["radius_km"] == 20427
    assert yardstick(tiny()) is None


def rolled(c):
    """The same satellites in an order that no layout of planes has."""
    names = ("semi_major_axis", "eccentricity", "inclination", "raan", "argument_of_periapsis")
    moved = {name: np.roll(getattr(c, name), 1) for name in (*names, "mean_anomaly")}
    return replace(c, satellite_names=c.satellite_names[-1:] + c.satellite_names[:-1], **moved)


@pytest.mark.slow
def test_by_elements_as_by_pattern(tiny):
    """The same satellites, not told that they are a pattern: other functions, the same figures."""
    study = tiny(entry=True)
    known = yardstick(study)
    c = rolled(study.compare.constellation)
    found = yardstick(replace(study, compare=replace(study.compare, constellation=c)))
    assert (found.kind, found.notation) == ("elements", "15 satellites by their elements")
    for name in ("satellites", "planes", "fold_proven", *merits_of("entry")):
        assert found.figures[name] == pytest.approx(known.figures[name], rel=1e-8), name
    # the screen brackets the cap radius lambda = acos(R/r cos e) - e to 5e-4 rad, and at R/r = 1/6
    # abs(d lambda/d e) is at least 1 - (R/r)/sqrt(1 - (R/r)^2) = 0.83
    assert found.figures["mask_margin_deg"] == pytest.approx(
        known.figures["mask_margin_deg"], abs=np.degrees(5e-4) / 0.83
    )
    # 2 moments of the candidates' way against 127: within what moments differ by
    for name in ("count_mean", "availability"):
        assert found.figures[name] == pytest.approx(known.figures[name], rel=0.1), name
    assert np.isnan(found.figures["delta_v_total_m_s"])


@pytest.mark.slow
def test_what_a_study_sorts_by_lies_between_proven_bounds(tiny):
    """As of the candidates; of the same satellites by elements too, all zones of latitude there."""
    study = tiny(entry=True)
    names = ("gdop_p95_zone", "availability")
    objectives = tuple(Objective(name, sign) for name, sign in zip(names, (1, -1), strict=True))
    study = replace(study, entry=None, objectives=objectives)
    known = yardstick(study)
    c = rolled(study.compare.constellation)
    found = yardstick(replace(study, compare=replace(study.compare, constellation=c)))
    for name in names:
        (low, high), (other_low, other_high) = known.brackets[name], found.brackets[name]
        assert max(low, other_low) <= min(high, other_high)
        assert high - low < 0.05 * high and other_high - other_low < 0.05 * other_high
        assert known.figures[name] == 0.5 * (low + high)
        assert known.errors[name] == 0.5 * (high - low)
        value = shown(study, name, known)
        assert str(value) == str(Value(value.quantity, value.value, Bracket(low, high)))
        assert " to " in str(value)


@pytest.mark.slow
def test_planes_are_told_apart_by_their_poles(tiny):
    study = tiny(entry=True)
    tilt = np.radians([0, 0, 0, 30, 30, 150, 180])
    node = np.radians([0, 90, 200, 0, 360, 0, 77])  # one, one and the same twice, two backwards
    some = keplerian(20e6, 0.0, tilt, node, 0.0, np.arange(7.0))
    design = replace(study.compare, constellation=some)
    study = replace(study, entry=None, compare=design)
    assert yardstick(study).figures["planes"] == 4


@pytest.mark.slow
def test_draims_four(tiny, designs):
    """Draim 1987: four satellites on ellipses see all of the planet once at any time, not twice."""
    draim = read_design(designs / "draim-four.toml")
    study = replace(tiny(fold=1), compare=draim)
    space = replace(study.space, mask_deg=(0.0,))
    once = yardstick(replace(study, space=space))
    assert once.figures["fold_proven"] == 1.0
    assert yardstick(replace(study, space=space, fold=2)).figures["fold_proven"] == 0.0
    assert np.isnan(once.variables["phasing"])
    assert once.figures["count_mean"] > 1 and once.figures["gdop_p95_zone"] == np.inf
