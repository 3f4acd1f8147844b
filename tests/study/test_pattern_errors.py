"""Errors in metres as figures of a study: against matrices, by clock, in entries."""

from dataclasses import replace

import numpy as np
import pytest

from compass.bodies import MARS_GM
from compass.clocks import clock_named
from compass.core.screen import deciding_phases
from compass.coverage.grid import make_grid
from compass.errors import DesignError
from compass.frames import prime_meridian_angle
from compass.inputs.study import read_study_text
from compass.ranging import Receiver, Signal
from compass.study.candidates import batches, candidates
from compass.study.clocks import errors_by_clock
from compass.study.pattern_errors import NAMES, pattern_errors
from compass.study.pattern_judging import judged
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


def test_a_better_clock_is_put_beside_more_satellites(study, rows):
    import xarray as xr

    columns = {name: ("candidate", rows[name]) for name in rows.dtype.names if name != "pattern"}
    columns["pattern"] = ("candidate", ["walker-delta"] * len(rows))
    columns |= {name: ("candidate", v) for name, v in pattern_errors(study, rows).items()}
    columns |= {"front": ("candidate", [0, 1]), "identity": ("candidate", ["a", "b"])}
    (one,) = errors_by_clock(study, xr.Dataset(columns))
    assert (one["identity"], one["satellites"]) == ("a", 15)
    better = replace(study, signal=replace(study.signal, clock=clock_named("dsac")))
    by_hand = pattern_errors(better, rows[:1])["error_horizontal_m.p95"][0]
    assert one["m"]["dsac"] == by_hand < one["m"]["csac"]
    assert one["m"]["csac"] == pattern_errors(study, rows[:1])["error_horizontal_m.p95"][0]
    still = replace(study, signal=replace(study.signal, clock=None, clock_sigma=3.0))
    assert errors_by_clock(still, xr.Dataset(columns)) == []


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
    c = bare.compare.constellation
    doubts = replace(bare.entry.doubts, orbit_m=(1.0, 4.0, 3.0), satellite_clock_m=2.0)
    told = judged(replace(bare, entry=replace(bare.entry, doubts=doubts)), c, 5.0)
    signal = Signal(ephemeris=(1.0, 4.0, 3.0), clock_sigma=2.0, receiver=Receiver(0.5))
    found = judged(replace(bare, signal=signal), c, 5.0)
    assert found == told
    assert found["crlb_position_m.p50"] < judged(bare, c, 5.0)["crlb_position_m.p50"]
