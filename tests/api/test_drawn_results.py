"""Results that draw themselves, made by hand: no kernel, so these run interpreted too."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

import compass
from compass.api.check import CheckResult
from compass.api.horizon import HorizonResult
from compass.api.keep_result import KeepResult
from compass.api.lasting import LastingResult
from compass.api.optimize import OptimizeResult
from compass.api.reproduce import ReproduceResult
from compass.api.requirement_search import RequirementSearchResult
from compass.api.search_result import SearchResult
from compass.api.trade import TradeResult
from compass.conventions import dated
from compass.design import Upkeep
from compass.papers.verdict import claim, compare, computed


def bars(axes):
    return [bar.get_width() for bar in axes.patches]


@pytest.fixture
def axes():
    return Figure().add_subplot()


@pytest.fixture
def design():
    stations = [
        compass.Site.of("flat", latitude_deg=0, longitude_deg=0, mask_deg=3),
        compass.Site.of("wall", latitude_deg=5, longitude_deg=9, mask_deg=[(0, 0), (180, 20)]),
    ]
    pattern = compass.walker_delta(6, 3, 1, inclination_deg=50, radius_km=20000)
    return compass.Design(pattern, stations=stations)


def test_satellites_stand_where_their_elements_say(design, axes):
    (line,) = compass.show(design).plot(axes=axes).lines
    assert sorted(set(np.round(line.get_xdata(), 9))) == [0.0, 120.0, 240.0]
    # Walker's f: the second plane is 60 degrees of 360/6 ahead
    assert sorted(np.round(line.get_ydata(), 6)) == [0.0, 60.0, 120.0, 180.0, 240.0, 300.0]


def test_margins_of_requirements_are_bars_and_a_missed_one_is_told_apart(design, axes):
    def verdict(name, met, margin):
        wanted = SimpleNamespace(name=name)
        return SimpleNamespace(requirement=wanted, word=str(met), met=met, margin=margin)

    verdicts = (verdict("a", True, 0.1), verdict("b", False, None), verdict("c", False, -0.1))
    drawn = CheckResult(design, verdicts).plot(axes=axes)
    assert bars(drawn) == pytest.approx([np.degrees(0.1), 0.0, -np.degrees(0.1)])
    one, _, three = (bar.get_facecolor() for bar in drawn.patches)
    assert one != three
    assert [label.get_text() for label in drawn.get_yticklabels()] == [
        "a: True",
        "b: False",
        "c: False",
    ]


def test_what_keeping_costs_is_a_bar_a_satellite(design, axes):
    spent = np.arange(6.0)
    kept = SimpleNamespace(delta_v=spent, delta_v_across=np.zeros(6), duration=365.25 * 86400.0)
    found = KeepResult(design, "two-body", kept, 1.0, Upkeep())
    assert bars(found.plot(axes=axes)) == pytest.approx(spent.tolist())


def test_candidates_of_a_search_are_bars(design, axes):
    one = SimpleNamespace(constellation=design.constellation, mask_margin=0.2)
    found = SearchResult(1, 0.0, 20000.0, "iau-sphere", "walker-delta", 6, 0, (one,))
    assert bars(found.plot(axes=axes)) == pytest.approx([np.degrees(0.2)])


def test_horizons_are_lines_and_a_dataset_over_azimuth(design, axes):
    found = HorizonResult(design, "ground.nc")
    assert found.dataset.horizon.sel(station="wall", azimuth=180.0) == pytest.approx(20.0)
    assert found.dataset.horizon.sel(station="flat").values == pytest.approx([3.0, 3.0])
    assert [line.get_label() for line in found.plot(axes=axes).lines] == ["flat", "wall"]


def test_a_search_for_the_best_is_a_line_a_start(axes):
    starts = [SimpleNamespace(history=[3.0, 2.0, 1.0]), SimpleNamespace(history=[90.0, 1.5])]
    best = SimpleNamespace(starts=starts, objective="cost")
    drawn = OptimizeResult(None, None, best).plot(axes=axes)
    assert len(drawn.lines) == 4 and drawn.get_yscale() == "log"


def test_a_study_draws_its_front(axes):
    results = xr.Dataset(
        {
            "satellites": ("candidate", [15.0, 16.0, 17.0]),
            "gdop_p95": ("candidate", [60.0, 5.0, np.inf]),
            "front": ("candidate", [0, 0, -1]),
        }
    )
    wanted = [SimpleNamespace(figure="satellites"), SimpleNamespace(figure="gdop_p95")]
    study = SimpleNamespace(name="small", objectives=wanted)
    drawn = TradeResult(study, None, None, results).plot(axes=axes)
    feasible, front = drawn.lines
    assert len(feasible.get_xdata()) == len(front.get_xdata()) == 2
    assert drawn.get_yscale() == "log" and drawn.get_title() == "small"


def test_times_that_say_their_epoch_become_dates():
    made = xr.Dataset(
        coords={"time": ("time", [0.0, 60.0], {"units": "s"})},
        attrs={"epoch_tdb": "2030-01-01T00:00:00"},
    )
    later = xr.decode_cf(dated(made)).time.values[1]
    assert later == np.datetime64("2030-01-01T00:01:00")
    assert made.time.attrs == {"units": "s"}  # the one given stays as it is


def test_days_proven_are_a_bar_up_to_the_loss(design, axes):
    day = 86400.0
    lasting = SimpleNamespace(
        fold=4, start=day, stop=31 * day, proven_until=20 * day, lost_at=25 * day,
        unsettled=((20 * day, 22 * day), (23 * day, 25 * day)),
    )  # fmt: skip
    drawn = LastingResult(design, 4, 5.0, "j2", lasting).plot(axes=axes)
    assert bars(drawn) == pytest.approx([19.0, 2.0, 2.0])
    assert [line.get_xdata()[0] for line in drawn.lines] == [25.0]
    told = [text.get_text() for text in drawn.get_legend().get_texts()]
    assert sorted(told) == ["lost", "open", "proven"]


def test_constellations_that_meet_requirements_are_bars_and_radii_by_size(design, axes):
    pattern = design.constellation
    met = SimpleNamespace(constellation=pattern, margin=0.1)
    none = SimpleNamespace(met=(), next_best=None)
    question = SimpleNamespace(radius=2e7)
    one = RequirementSearchResult(question, SimpleNamespace(met=(met,), next_best=met))
    assert bars(one.plot(axes=axes)) == pytest.approx([np.degrees(0.1)] * 2)
    several = RequirementSearchResult(
        question, one.outcome, (one, RequirementSearchResult(question, none))
    )
    assert bars(several.plot(axes=Figure().add_subplot())) == [6, 0]


def test_numbers_of_a_paper_stand_where_their_tolerances_put_them(axes):
    rows = (
        compare("Half", "Table 2", "9.5", 9.525, "deg"),
        compare("Period", "Table 1", "20", 22.0, "h"),
        claim("Most", "Section 3", "over 7", 6.0, "1", "above 7", lambda most: most > 7),
        computed("Other", "none", 24.6, "h"),
    )
    drawn = ReproduceResult("x", "A paper", rows).plot(axes=axes)
    places = {float(line.get_ydata()[0]): float(line.get_xdata()[0]) for line in drawn.lines}
    assert places == pytest.approx({0.0: 0.5, 1.0: 4.0})
    assert not list(ReproduceResult("x", "A paper", rows[2:]).plot().lines)
