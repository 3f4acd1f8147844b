"""The largest dilution of precision: brackets, witnesses evaluated by themselves, claims settled."""

import itertools
import math
import re

import numpy as np
import pytest

from compass.coverage import certified_rounds as rounds_module
from compass.coverage import certified_worst as worst_module
from compass.coverage.certificate import Outcome
from compass.coverage.certified_places import Circle, Spot, Tile
from compass.coverage.certified_question import DOPS, Question
from compass.coverage.certified_rounds import PIECE, Rounds
from compass.coverage.certified_witness import dilution_at
from compass.coverage.certified_worst import certified_always, certified_worst
from compass.coverage.region import convex_polygon, latitude_band
from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.orbits import positions_mcmf, walker_delta
from compass.orbits.constellation import keplerian
from compass.orbits.motion import Motion
from compass.sites import Mask, Site

SPHERE = FIGURES["iau-sphere"]


def walker(t, p, f, inclination=55.0, radius=20427.0):
    return walker_delta(t, p, f, inclination_deg=inclination, radius_km=radius)


def by_triangle(constellation, site, time, dop):
    """A dilution by the triangle of the rows, from Mars-fixed positions."""
    r = positions_mcmf(constellation, [time])[:, 0]
    sights = r[site.sees(r)] - site.r_mcmf
    rows = np.column_stack(
        [sights / np.linalg.norm(sights, axis=1, keepdims=True), np.ones(len(sights))]
    )
    half = np.linalg.inv(np.linalg.qr(rows)[1])
    inverse = half @ half.T
    up = site.enu_mcmf[2]
    position, vertical = np.trace(inverse[:3, :3]), up @ inverse[:3, :3] @ up
    squares = [np.trace(inverse), position, position - vertical, vertical, inverse[3, 3]]
    return math.sqrt(squares[DOPS.index(dop)])


@pytest.mark.slow
@pytest.mark.parametrize("dop", DOPS)
def test_no_random_place_is_worse_and_the_witness_is_as_bad_as_said(dop):
    pattern, mask = walker(24, 6, 1), math.radians(5)
    found = certified_worst(pattern, dop=dop, mask=mask)
    assert found.low <= found.high <= 1.001 * found.low + 1e-12
    w = found.witness
    assert w.value == pytest.approx(found.low, rel=1e-6)
    there = Site("", w.latitude, w.longitude, 0.0, Mask.constant(mask), SPHERE)
    assert by_triangle(pattern, there, w.time, dop) == pytest.approx(found.low, rel=1e-6)
    generator = np.random.default_rng(1)
    for _ in range(300):
        latitude = math.asin(generator.uniform(-1, 1))
        site = Site("", latitude, generator.uniform(0, 6.28), 0.0, Mask.constant(mask), SPHERE)
        time = generator.uniform(0, 1e6)
        assert dilution_at(pattern, site, time, Motion(), dop)[0] <= found.high


@pytest.mark.slow
@pytest.mark.parametrize(
    ("inclination", "band", "mask", "sampled"), [(18.4, 30, 10, 452.0), (26.0, 45, 5, 659.0)]
)
def test_what_passes_on_a_grid_is_refuted_and_has_no_bound(inclination, band, mask, sampled):
    pattern = walker_delta(14, 14, 8, inclination_deg=inclination, orbit="areosynchronous")
    place = latitude_band(-math.radians(band), math.radians(band))
    claim = certified_always(pattern, 6.0, mask=math.radians(mask), place=place)
    assert claim.outcome == Outcome.REFUTED
    assert claim.witness.value > 6.0
    worst = certified_worst(pattern, mask=math.radians(mask), place=place)
    assert worst.unbounded and worst.high == math.inf
    w = worst.witness
    assert w.value > sampled
    assert abs(w.latitude) <= math.radians(band) + 1e-12
    assert re.fullmatch(
        r"unbounded near [\d.]+° [NS], [\d.]+° [EW], .* after the epoch", worst.sentence
    )
    site = Site("", w.latitude, w.longitude, 0.0, Mask.constant(math.radians(mask)), SPHERE)
    assert by_triangle(pattern, site, w.time, "pdop") > sampled


@pytest.mark.slow
def test_claims_on_either_side_of_the_worst_value_are_settled():
    pattern = walker(24, 6, 1)
    worst = certified_worst(pattern)
    assert certified_always(pattern, worst.high * 1.001).outcome == Outcome.PROVEN
    refuted = certified_always(pattern, worst.low * 0.999)
    assert refuted.outcome == Outcome.REFUTED
    assert refuted.witness.value > refuted.limit


@pytest.mark.slow
def test_workers_find_the_same_and_finer_goes_on_from_coarser():
    pattern = walker(24, 6, 1)
    one, two = (certified_worst(pattern, precision=0.02, workers=n) for n in (1, 2))
    assert (one.low, one.high, one.boxes) == (two.low, two.high, two.boxes)
    assert one.leaves.tobytes() == two.leaves.tobytes()
    finer = certified_worst(pattern, precision=1e-4, start=one)
    assert one.low <= finer.low <= finer.high <= one.high
    assert finer.high <= finer.low * (1 + 1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("motion", ["two-body", "j2", "numerical"])
def test_a_place_over_a_span_of_any_motion_has_a_worst_moment(motion):
    pattern, hours = walker(24, 6, 1), 6.0
    figure, spot = FIGURES["iau-ellipsoid"], Spot(0.5, 1.0)
    mask = Mask((0.0, 2.0, 4.0), (0.0, 0.2, 0.1))
    found = certified_worst(
        pattern, figure=figure, mask=mask, place=spot, motion=motion, duration=hours * 3600
    )
    assert found.witness.value == pytest.approx(found.low, rel=1e-5)
    assert found.high <= 1.001 * found.low + 1e-9
    site = Site("", spot.latitude, spot.longitude, 0.0, mask, figure)
    times = np.linspace(0.0, hours * 3600, 200)
    values = [dilution_at(pattern, site, t, Motion(motion), "pdop")[0] for t in times]
    assert found.low * 0.9 <= max(values) <= found.high


def test_fewer_than_four_in_view_are_infinite_and_told():
    found = certified_worst(walker(6, 3, 1), place=Circle(0.3))
    assert found.low == found.high == math.inf
    assert "infinite" in found.sentence and "satellites in view" in found.sentence
    assert len(found.witness.satellites) < 4
    assert found.witness.as_dict()["value"] == math.inf
    claim = certified_always(walker(6, 3, 1), 5.0, place=Circle(0.3))
    assert claim.outcome == Outcome.REFUTED


def test_without_time_nothing_is_known():
    found = certified_worst(walker(6, 3, 1), place=Circle(0.3), budget_s=0.0)
    assert (found.low, found.high, found.witness) == (0.0, math.inf, None)
    assert "ended early: the time allowed was over" in found.sentence
    claim = certified_always(walker(6, 3, 1), 5.0, place=Circle(0.3), budget_s=0.0)
    assert claim.outcome == Outcome.UNDECIDED


def ticking(monkeypatch, module):
    """A clock that is a second further each time someone looks."""
    clock = itertools.count()
    monkeypatch.setattr(module, "worked", lambda: float(next(clock)))


@pytest.mark.slow
@pytest.mark.parametrize("satellites", [60, 3000])
def test_the_clock_is_looked_at_as_often_with_many_satellites(monkeypatch, satellites):
    """One piece of work in a budget of one look: satellites times boxes are the same."""
    ticking(monkeypatch, worst_module)
    many = walker(satellites, 10, 1)
    found = certified_worst(many, place=Circle(0.3), budget_s=1.5)
    assert found.stopped == "time"
    assert 1 <= found.boxes <= worst_module.FEW * 64 / satellites + 2
    rounds, leaves = Rounds(Question(many, place=Circle(0.3)), 1), np.ones((3000, 10))
    monkeypatch.setattr(rounds_module, "refine", lambda piece, *_: (np.ones(5), piece))
    ticking(monkeypatch, rounds_module)
    rounds.end = 0.5
    open_, sums = rounds.refine(leaves, np.array([1e-3]), [6.0])
    assert (len(open_), rounds.stopped) == (3000, "time")
    assert sums[0] == 1  # one look in time, at a piece
    sizes = []
    monkeypatch.setattr(
        rounds_module, "refine", lambda piece, *_: (np.ones(5), sizes.append(len(piece)) or piece)
    )
    rounds.end = math.inf
    rounds.refine(leaves, np.array([1e-3]), [6.0])
    assert sum(sizes) == 3000
    assert max(sizes) == max(1, min(PIECE, PIECE * 64 // satellites))


def test_an_interrupted_search_keeps_what_it_has(monkeypatch):
    from compass.coverage import certified_worst as module

    def interrupted(leaves, best, *_):
        if len(leaves):
            raise KeyboardInterrupt
        return best, 0, False, leaves

    monkeypatch.setattr(module, "pursue", interrupted)
    found = certified_worst(walker(6, 3, 1), place=Circle(0.2))
    assert (found.stopped, found.high) == ("interrupted", math.inf)


def test_a_budget_in_boxes_leaves_a_bracket():
    found = certified_worst(walker(12, 3, 1), place=Tile(0.1, 0.2, 1.0, 1.2), budget_boxes=1)
    assert found.stopped in ("boxes", "")
    assert found.low <= found.high
    polygon = convex_polygon([0.1, 0.1, 0.2], [1.0, 1.1, 1.0])
    site = certified_worst(walker(12, 3, 1), place=polygon, duration=900.0, budget_boxes=300)
    assert 0.09 < site.witness.latitude < 0.21
    assert 0.99 < site.witness.longitude < 1.11


def test_what_cannot_be_asked_is_refused():
    pattern = walker(6, 3, 1)
    with pytest.raises(ArgumentError, match="precision"):
        certified_worst(pattern, precision=0.0)
    with pytest.raises(ArgumentError, match=r"limit = 0\.5"):
        certified_always(pattern, 0.5)
    with pytest.raises(ArgumentError, match="height"):
        certified_worst(pattern, height=-2.1e4)  # below any ground of Mars
    with pytest.raises(ArgumentError, match="since"):
        certified_worst(pattern, since=-1.0)
    oval = keplerian(np.full(5, 4.5e6), 0.1, 1.0, np.arange(5.0), 0.0, np.arange(5.0))
    with pytest.raises(ArgumentError, match="altitude_km = 700: among the satellites"):
        certified_worst(oval, height=7e5)
