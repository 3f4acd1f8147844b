"""Open boxes in a file: finer goes on from coarser, and nothing else is taken for it."""

import math

import numpy as np
import pytest

from compass.coverage import certified_effort
from compass.coverage.certified_effort import Effort
from compass.coverage.certified_percentile import certified_percentile
from compass.coverage.certified_places import Circle
from compass.coverage.certified_share import certified_share
from compass.errors import ArgumentError, OutputError
from compass.orbits import walker_delta

RING = walker_delta(5, 5, 1, inclination_deg=50, radius_km=20000)
PATTERN = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
PLACE = Circle(0.2)


def figures(pattern, effort, limit=6.0, **asked):
    """All figures of a place, as far as an effort goes."""
    return (
        effort.share(pattern, limit, width=0.1, budget_boxes=2000, place=PLACE, **asked),
        effort.percentiles(
            pattern, (50.0,), precision=0.1, budget_boxes=2000, place=PLACE, dop="gdop", **asked
        )[50.0],
        effort.worst(pattern, budget_boxes=200, place=PLACE, **asked),
    )


@pytest.mark.slow
def test_finer_goes_on_from_a_file_as_from_the_result(tmp_path):
    file = tmp_path / "open.npz"
    coarse = figures(PATTERN, Effort(1e-3, file=file), 2.5)
    first = file.read_bytes()
    fine = figures(PATTERN, Effort(1e-5, file=file, workers=2), 2.5)
    assert fine[0].boxes > coarse[0].boxes
    direct = certified_share(PATTERN, 2.5, place=PLACE, width=1e-5, start=coarse[0])
    assert (fine[0].low, fine[0].high, fine[0].boxes) == (direct.low, direct.high, direct.boxes)
    assert fine[0].leaves.tobytes() == direct.leaves.tobytes()
    for one, other in zip(fine[:2], coarse[:2], strict=True):
        assert other.low <= one.low <= one.high <= other.high
    fresh = certified_percentile(PATTERN, 50.0, place=PLACE, precision=1e-3)
    assert fine[1].low <= fresh.high and fresh.low <= fine[1].high
    assert fine[2].boxes >= coarse[2].boxes
    assert coarse[2].stopped == "boxes"  # and as many more come nearer
    assert fine[2].high - fine[2].low < 0.1 * (coarse[2].high - coarse[2].low)
    # the same steps write the same bytes, whoever works
    file.unlink()
    figures(PATTERN, Effort(1e-3, file=file, workers=2), 2.5)
    assert file.read_bytes() == first


def test_what_is_asked_once_is_known_the_next_time(tmp_path, monkeypatch):
    file = tmp_path / "open.npz"
    before = figures(RING, Effort(0.5, file=file))
    with np.load(file) as held:
        names = set(held.files)
    again = Effort(0.5, file=file)
    again.interrupted = True  # no time for anything new
    after = figures(RING, again)
    assert [(a.low, a.high) for a in after] == [(b.low, b.high) for b in before]
    # another question finds nothing there, and takes nothing away
    other = figures(RING, again, mask=0.1)
    assert (other[0].low, other[0].high, other[0].stopped) == (0.0, 1.0, "time")
    with np.load(file) as held:
        assert names < set(held.files)
    monkeypatch.setattr(certified_effort, "version", lambda: "another")
    late = Effort(0.5, file=file)
    late.interrupted = True
    assert figures(RING, late)[0].width == 1.0


def test_an_interruption_ends_what_follows_with_what_is_known(monkeypatch):
    def interrupted(leaves, *_):
        if len(leaves):
            raise KeyboardInterrupt
        return np.zeros(5), leaves

    effort = Effort(0.5)
    monkeypatch.setattr("compass.coverage.certified_rounds.refine", interrupted)
    found = figures(RING, effort)
    assert [one.stopped for one in found] == ["interrupted", "time", "time"]
    assert (found[0].low, found[0].high) == (0.0, 1.0)
    assert effort.interrupted
    assert effort.always(RING, 6.0, budget_boxes=10, place=PLACE).stopped == "time"


def test_progress_is_told_by_what_is_open():
    parts = []
    effort = Effort(0.05, progress=lambda title, part: parts.append((title, part)))
    figures(RING, effort)
    shares = [part for title, part in parts if title == "share"]
    assert shares == sorted(shares) and shares[0] >= 0 and shares[-1] == 1.0
    assert [title for title, _ in parts][-2:] == ["percentiles", "largest"]


def test_bounds_as_wide_as_all_there_is_are_all_of_the_way():
    """Shares by fold come ten times less near: with a width of 0.1, to 1."""
    parts = []
    effort = Effort(0.1, progress=lambda title, part: parts.append(part))
    effort.folds(RING, [4], width=1e-3, budget_boxes=1000, place=PLACE)
    assert parts and set(parts) == {1.0}


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"width": 0.0}, "width = 0: allowed above 0 up to below 1"),
        ({"width": math.nan}, "width = nan"),
        ({"width": 1.0}, "width = 1"),
        ({"budget_s": -1.0}, "budget_s = -1: allowed above 0"),
    ],
)
def test_an_effort_out_of_range_is_refused(options, match):
    with pytest.raises(ArgumentError, match=match):
        Effort(**options)


@pytest.mark.parametrize("content", [b"", b"none", b"PK\x03\x04 torn"])
def test_a_file_of_something_else_is_refused(tmp_path, content):
    file = tmp_path / "open.npz"
    file.write_bytes(content)
    with pytest.raises(ArgumentError, match="not a file of open boxes"):
        Effort(file=file)
    np.savez(file, other=np.zeros(3))
    with pytest.raises(ArgumentError, match="not a file of open boxes"):
        Effort(file=file)
    with pytest.raises(OutputError, match="does not exist"):
        Effort(file=tmp_path / "nowhere" / "open.npz")
