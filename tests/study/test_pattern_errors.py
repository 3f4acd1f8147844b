"""Errors in metres as figures of a study: against matrices, by clock, in entries."""

from dataclasses import replace

import numpy as np
import pytest

from compass.api.trade import clock_blocks
from compass.bodies import MARS_GM
from compass.clocks import clock_named
from compass.core.screen import deciding_phases
from compass.coverage.drawn import drawn
from compass.coverage.grid import make_grid
from compass.design import Design
from compass.errors import DesignError
from compass.frames import prime_meridian_angle
from compass.inputs.study import Objective, read_study_text
from compass.quantities.draws import quantile_bounds
from compass.quantities.percentile import percentile
from compass.ranging import Receiver, Signal
from compass.sites import Mask
from compass.study import draws
from compass.study.bounds import ends
from compass.study.candidates import batches, candidates, make_constellation
from compass.study.clocks import best_by_errors, clock_columns, clock_figures, errors_by_clock
from compass.study.pattern_errors import NAMES, pattern_errors
from compass.study.pattern_judging import entries_of, entry_figures, judged
from compass.study.results import known_figures

TEXT = """
name = "metres"
[study]
patterns = ["walker-delta"]
satellites = 15
planes = 5
phasing = 1
inclination_deg = [50, 55]
orbits = ["areosynchronous"]
mask_deg = 0
[map]
step_deg = 45
epochs = 2
{signal}
[[objective]]
figure = "error_horizontal_m.p95"
"""
SIGNAL = """
[signal]
clock = "csac"
update_h = 6
ephemeris_m = [2, 2, 2]
receiver = { noise_m = 0.5, zenith_m = 0.5 }
"""


@pytest.fixture(scope="module")
def study():
    return read_study_text(TEXT.format(signal=SIGNAL))


@pytest.fixture(scope="module")
def rows(study):
    return next(batches(candidates(study), 10))


def horizontal_p95(study, row):
    """From matrices for every user; orbit errors alike in all directions need no axes.

    A clock's error grows by white noise: the mean over ages is half of that of the oldest data.
    """
    t, p, f = (int(row[name]) for name in ("satellites", "planes", "phasing"))
    first, last = deciding_phases(False, t, p, f)
    tilt, radius = np.radians(row["inclination_deg"]), row["radius_km"] * 1e3
    k = np.arange(t)
    plane, place = k // (t // p), k % (t // p)
    node, around = 2 * np.pi * plane / p, 2 * np.pi * (place * p + plane * f) / t
    clock = study.signal.clock.variance(study.signal.update) / 2
    grid, found = make_grid("equal-area", study.map.step_deg), []
    for phase in first + (last - first) * np.array([0.25, 0.75]):
        u = around + phase
        turned = prime_meridian_angle(0.0, phase / np.sqrt(MARS_GM.value / radius**3))
        r = radius * np.stack([
            np.cos(node) * np.cos(u) - np.sin(node) * np.sin(u) * np.cos(tilt),
            np.sin(node) * np.cos(u) + np.cos(node) * np.sin(u) * np.cos(tilt),
            np.sin(u) * np.sin(tilt),
        ], axis=1)  # fmt: skip
        for latitude in grid.latitude:
            # cells stand at their longitudes of the turning planet; at the epoch by its meridian
            for longitude in grid.longitude + turned:
                up = np.array([
                    np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude),
                    np.sin(latitude),
                ])  # fmt: skip
                line = r - study.figure.equatorial_radius * up
                line /= np.linalg.norm(line, axis=1)[:, None]
                sine = line @ up
                seen = sine >= 0
                if seen.sum() < 4:
                    found.append(np.inf)
                    continue
                rows = np.hstack([-line[seen], np.ones((seen.sum(), 1))])
                weight = 1 / (4 + clock + (0.5 + 0.5 / sine[seen]) ** 2)
                covariance = np.linalg.inv(rows.T @ (weight[:, None] * rows))[:3, :3]
                found.append(np.sqrt(np.trace(covariance) - up @ covariance @ up))
    return np.sort(found)[int(np.ceil(0.95 * len(found))) - 1]


def test_errors_of_patterns_are_those_of_matrices(study, rows):
    """Percentiles are values that occur, in bins 4.9e-4 wide; maps keep single precision."""
    found = pattern_errors(study, rows)
    assert set(found) == set(NAMES) and len(rows) == 2
    expected = [horizontal_p95(study, row) for row in rows]
    np.testing.assert_allclose(found["error_horizontal_m.p95"], expected, rtol=1e-3)
    assert np.isfinite(expected).all()


def front_of(rows, figures):
    """Results of a study whose only candidate on the front is the first."""
    import xarray as xr

    columns = {name: ("candidate", rows[name]) for name in rows.dtype.names if name != "pattern"}
    columns["pattern"] = ("candidate", ["walker-delta"] * len(rows))
    columns |= {name: ("candidate", v) for name, v in figures.items()}
    columns |= {"front": ("candidate", [0, 1]), "identity": ("candidate", ["a", "b"])}
    return xr.Dataset(columns)


def unknown_clocks(study, rows):
    """Columns of clocks that no stage has filled."""
    return {name: np.full(len(rows), np.nan) for name in clock_columns(study)}


def test_a_better_clock_is_put_beside_more_satellites(study, rows):
    found = pattern_errors(study, rows)
    assert errors_by_clock(study, front_of(rows, found | unknown_clocks(study, rows))) == []
    assert best_by_errors(study, front_of(rows, found)).tolist() == rows[:1].tolist()
    found |= clock_figures(study, rows)
    assert "error_horizontal_m.p95.csac" not in found and set(clock_columns(study)) < set(found)
    (one,) = errors_by_clock(study, front_of(rows, found))
    assert (one["identity"], one["satellites"]) == ("a", 15)
    better = replace(study, signal=replace(study.signal, clock=clock_named("dsac")))
    by_hand = pattern_errors(better, rows[:1])["error_horizontal_m.p95"][0]
    assert one["m"]["dsac"] == by_hand < one["m"]["csac"]
    assert one["m"]["csac"] == one["own"] == found["error_horizontal_m.p95"][0]
    still = replace(study, signal=replace(study.signal, clock=None, clock_sigma=3.0))
    assert errors_by_clock(still, front_of(rows, found)) == [*clock_columns(still)] == []
    assert not best_by_errors(still, front_of(rows, found)).size


def test_it_is_said_what_a_clock_buys_against_satellites(study):
    def row(n, own, dsac):
        m = {"csac": own, "dsac": dsac}
        return {"identity": "x", "satellites": n, "figure": "error_time_m.p95", "own": own, "m": m}

    rows = [row(16, 9.0, 5.0), row(15, 20.0, 6.0), row(18, 3.0, 2.0)]
    table, words = clock_blocks(study, rows)
    assert table.rows[1][:2] == ("x", 15) and "time error" in table.title
    assert "(sampled over " in table.title and table.header[-2:] == ("CSAC", "DSAC")
    assert "15 satellites with CSAC have 20" in words.text and "1 more with CSAC" in words.text
    assert "sampled" in words.text and "the best clock, DSAC, makes" in words.text
    assert words.text.endswith("a better clock buys more")
    rows[1]["m"]["dsac"] = 12.0
    assert clock_blocks(study, rows)[1].text.endswith("a better clock buys less")
    assert len(clock_blocks(study, rows[:1])) == 1 and clock_blocks(study, []) == []


def test_without_errors_of_ranges_there_are_none(study, rows):
    assert set(NAMES) < set(known_figures(study))
    bare = replace(study, signal=None, objectives=())
    assert not set(NAMES) & set(known_figures(bare))
    with pytest.raises(DesignError, match=r"without errors of ranges; add a table \[signal\]"):
        read_study_text(TEXT.format(signal=""))
    with pytest.raises(DesignError, match="follows from tracking, which a study has none of"):
        read_study_text(TEXT.format(signal=SIGNAL.replace("[2, 2, 2]", '"determined"')))
    assert np.isnan(pattern_errors(replace(study, signal=None), rows)["error_time_m.p95"]).all()


@pytest.mark.slow
def test_entries_of_a_study_count_its_signal(tiny):
    """As the same numbers given for the entries, and better than with worse ones."""
    bare = tiny(entry=True)
    c, entries = bare.compare.constellation, entries_of(bare)
    doubts = replace(bare.entry.doubts, orbit_m=(1.0, 4.0, 3.0), satellite_clock_m=2.0)
    told = judged(replace(bare, entry=replace(bare.entry, doubts=doubts)), entries, c, 5.0)
    signal = Signal(ephemeris=(1.0, 4.0, 3.0), clock_sigma=2.0, receiver=Receiver(0.5))
    found = judged(replace(bare, signal=signal), entries, c, 5.0)
    assert found == told
    assert found["crlb_position_m.p50"] < judged(bare, entries, c, 5.0)["crlb_position_m.p50"]


@pytest.mark.slow
def test_a_lander_gains_by_a_better_clock(tiny, study, rows):
    """The column of a clock is what is judged with it; satellites' clocks of a chip lose metres."""
    name = "crlb_position_m.p50"
    entry = replace(tiny(entry=True).entry, samples=8)
    asked = replace(study, entry=entry, objectives=(Objective(name, 1),))
    own = entry_figures(asked, rows) | clock_figures(asked, rows)
    (one,) = errors_by_clock(asked, front_of(rows, own))
    better = replace(asked, signal=replace(asked.signal, clock=clock_named("rafs")))
    by_hand = judged(better, entries_of(better), make_constellation(rows[0]), 0.0)[name]
    assert one["figure"] == name and one["own"] == one["m"]["csac"] == own[name][0]
    # from orbits interpolated and as they are: see `assert_as_judged_one_by_one`
    assert one["m"]["rafs"] == pytest.approx(by_hand, rel=1e-8)
    assert one["m"]["rafs"] < 0.9 * one["m"]["csac"]


def test_more_places_and_moments_are_those_drawn_before_and_others(study, rows, monkeypatch):
    """By hand: percentiles of all parts' draws, each from the seed that follows."""
    monkeypatch.setattr(draws, "PART", 60)
    c, mask = make_constellation(rows[0]), float(rows["mask_deg"][0])
    design = Design(c, figure=study.figure, mask=Mask.of(mask), signal=study.signal)
    figure, span = "error_horizontal_m.p95", (0.0, 3600.0)
    parts = [
        drawn(design, span, draws=60, seed=study.seed + k).values["error_horizontal_m"]
        for k in range(draws.DRAWS["draws-2"][1])
    ]
    for level, some in (("draws-1", parts[:1]), ("draws-2", parts)):
        found, values = draws.drawn_fixes(level, study, c, mask, span), np.concatenate(some)
        assert found[figure] == percentile(values, 95)
        assert [found[end] for end in ends(figure)] == list(quantile_bounds(values, 95))
