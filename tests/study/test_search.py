"""Search: known minima, brute force over inclination, order, and the written design."""

import numpy as np
import pytest

from compass.core.inclination import ROOM, Witnesses, add_witness, pattern_radius, witnessed
from compass.coverage.cap import cap_radius
from compass.coverage.certificate import prove_fold
from compass.coverage.margin import covering_radius
from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.orbits import areosynchronous_radius, positions_mci, walker_delta
from compass.study import search as module
from compass.study.search import (
    Candidate,
    closest_approach,
    optimal_inclination,
    patterns,
    search,
)

SPHERE = FIGURES["iau-sphere"]
R = SPHERE.equatorial_radius
RADIUS = areosynchronous_radius()


def only(*makers):
    """Stand-in for `patterns` that offers a few, as of five satellites."""
    return lambda _kind, largest, *_args, **_options: iter(makers if largest == 5 else ())


def five(inclination):
    return walker_delta(5, 5, 1, inclination_deg=np.degrees(inclination), radius_km=RADIUS / 1e3)


def three(inclination):
    return walker_delta(3, 3, 1, inclination_deg=np.degrees(inclination), radius_km=RADIUS / 1e3)


def test_counts_of_patterns():
    # sum over t of the sum of its divisors; rosettes are the deltas that a multiplier gives
    assert len(list(patterns("walker-delta", 16, 1e7))) == 220
    assert len(list(patterns("walker-star", 6, 1e7, smallest=6))) == 12
    rosettes = [make(0.5).pattern for make in patterns("rosette", 12, 1e7, smallest=12)]
    assert len({(p.planes, p.phasing) for p in rosettes}) == len(rosettes)
    assert {p.multiplier.limit_denominator(100) for p in rosettes if p.planes == 12} == set(
        range(12)
    )


@pytest.mark.slow
def test_a_pattern_at_its_best(monkeypatch):
    # Ballard 1980, Table I: (5, 5, 1) at 43.66 deg needs caps of 69.15 deg
    monkeypatch.setattr(module, "patterns", only(five, three))
    seen = []

    def progress(work, total):
        seen.append(total)
        return work

    (found,) = search(1, 0.0, radius=RADIUS, figure=SPHERE, largest=5, progress=progress)
    assert seen == [2]
    assert found.proven
    assert np.degrees(found.constellation.inclination[0]) == pytest.approx(43.66, abs=0.011)
    assert np.degrees(found.radius) == pytest.approx(69.15, abs=0.006)
    assert cap_radius(RADIUS, R, found.mask_margin) == pytest.approx(found.radius, abs=1e-12)
    row = found.as_dict()
    assert (row["satellites"], row["planes"], row["phasing"]) == (5, 5, 1)
    # fold 1 leaves most places with fewer than four satellites
    assert row["gdop_p95_bracket"][1] == np.inf
    assert 0.0 <= row["availability_bracket"][0] <= row["availability"] < 1.0


def test_a_pattern_that_needs_more_than_its_caps_is_out(monkeypatch):
    monkeypatch.setattr(module, "patterns", only(five))
    mask = np.radians(12.0)  # caps of 68.7 deg
    assert search(1, mask, radius=RADIUS, figure=SPHERE, largest=5) == []


@pytest.mark.slow
def test_optimal_inclination_against_a_scan():
    for counts, fold in (((8, 8, 6), 1), ((10, 5, 2), 2), ((9, 3, 1), 1)):
        c = walker_delta(*counts, inclination_deg=0.0, radius_km=RADIUS / 1e3)
        best = optimal_inclination(c, fold)
        scan = np.radians(np.arange(2.0, 90.0, 0.25))
        radii = [
            covering_radius(
                walker_delta(*counts, inclination_deg=np.degrees(i), radius_km=RADIUS / 1e3),
                fold,
                tolerance=1e-4,
            ).at_least
            for i in scan
        ]
        found = covering_radius(
            walker_delta(*counts, inclination_deg=np.degrees(best), radius_km=RADIUS / 1e3), fold
        )
        assert found.radius <= min(radii) + 2e-5
        assert found.radius >= min(radii) - np.radians(0.26)


@pytest.mark.slow
def test_fewer_than_15_satellites_have_fourfold_coverage():
    found = search(4, 0.0, radius=RADIUS, figure=SPHERE, largest=14, beyond=1, finalists=3)
    sizes = [c.constellation.size for c in found]
    assert sizes == sorted(sizes)
    assert sizes[0] == 13
    assert [c.proven for c in found[:3]] == [True] * 3
    assert found[3].geometry is None
    margins = [c.mask_margin for c in found if c.constellation.size == 13]
    assert margins == sorted(margins, reverse=True)
    # the certificate is another algorithm: it agrees on both sides of the margin
    best = found[0]
    for change, outcome in ((-1e-5, "proven"), (1e-5, "refuted")):
        claim = prove_fold(best.constellation, 4, sphere_radius=R, mask=best.mask_margin + change)
        assert claim.outcome == outcome


def test_the_search_ends_with_the_smallest_and_so_many_more(monkeypatch):
    """Of sizes 2 to 9, every pattern from 5 satellites on covers; nothing larger is looked at."""
    tried = []

    def best(make, *_):
        c = make(0.9)
        tried.append(c.size)
        return Candidate(c, 1.0, 0.1, 1.0) if c.size >= 5 else None

    monkeypatch.setattr(module, "_best", best)
    for beyond, last in ((0, 5), (2, 7), (9, 9)):
        tried.clear()
        found = search(1, 0.0, radius=RADIUS, figure=SPHERE, largest=9, beyond=beyond, finalists=0)
        assert sorted(set(tried)) == list(range(2, last + 1))
        assert {c.constellation.size for c in found} == set(range(5, last + 1))


@pytest.mark.slow
def test_the_result_does_not_depend_on_the_number_of_threads():
    one, two = (
        search(1, 0.2, radius=RADIUS, figure=SPHERE, largest=6, beyond=1, workers=w) for w in (1, 2)
    )
    assert [c.as_dict() for c in one] == [c.as_dict() for c in two]


def test_the_phase_stands_for_time():
    c = five(0.8)
    least, most, _, _ = pattern_radius(
        c.raan, c.mean_anomaly, 0.8, 1, 0.0, np.pi / 10, 0.0, -1.0, 1e-3, np.inf
    )
    found = covering_radius(c, 1, tolerance=1e-3)
    assert most >= found.at_least - 1e-9
    assert least <= found.radius + 1e-9


@pytest.mark.parametrize(("pattern", "fold"), [((5, 5, 1), 1), ((6, 3, 2), 2), ((8, 4, 3), 3)])
def test_witnesses_bound_the_radius_at_any_inclination(pattern, fold):
    """What a place and moment need at one inclination, all satellites moved to another, is less."""
    c = walker_delta(*pattern, inclination_deg=0.0, radius_km=RADIUS / 1e3)
    witnesses = Witnesses(np.empty((ROOM, 3, c.size)), np.empty(ROOM), np.zeros(1, np.int64))
    angles = np.radians(np.linspace(1.0, 89.0, 8))

    def radius(inclination):
        return pattern_radius(
            c.raan, c.mean_anomaly, inclination, fold, 0.0, 2 * np.pi, 0.0, -1.0, 0.1, np.inf
        )

    assert witnessed(witnesses, 0.5, 0.6, fold, np.inf) == (0.0, -1)
    for angle in angles[::2]:
        least, _, phase, point = radius(angle)
        add_witness(witnesses, c.raan, c.mean_anomaly, phase, point)
        told, _ = witnessed(witnesses, angle, angle, fold, np.inf)
        assert told >= least - 1e-9
        apart = Witnesses(
            witnesses.cosines[int(witnesses.many[0]) - 1 :], witnesses.phases, np.ones(1, int)
        )
        assert witnessed(apart, angle, angle, fold, np.inf)[0] == pytest.approx(least, abs=1e-9)
    add_witness(witnesses, c.raan, c.mean_anomaly, 0.0, np.zeros(3))
    assert witnesses.many[0] == 4  # no place, no witness
    for angle in angles:
        _, most, *_ = radius(angle)
        for half in (0.0, 0.01, 0.2):
            told, _ = witnessed(witnesses, angle - half, angle + half, fold, np.inf)
            assert told <= most + 1e-9
    whole, _ = witnessed(witnesses, angles[0], angles[-1], fold, np.inf)
    assert whole <= min(witnessed(witnesses, a, a, fold, np.inf)[0] for a in angles) + 1e-9


def test_closest_approach_against_positions():
    c = walker_delta(6, 3, 1, inclination_deg=63.0, radius_km=RADIUS / 1e3)
    r = positions_mci(c, np.linspace(0, 1e5, 4000)) / RADIUS
    nearest = max((r[i] * r[j]).sum(axis=-1).max() for i in range(6) for j in range(i))
    assert closest_approach(c) == pytest.approx(np.arccos(nearest), abs=1e-3)
    assert closest_approach(c.without(range(1, 6))) == np.pi
    # all six meet where their planes cross
    assert (
        closest_approach(
            walker_delta(
                6, 6, 0, inclination_deg=np.degrees(1.5707963267948966), radius_km=RADIUS / 1e3
            )
        )
        < 1e-7
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"kind": "flower"}, "pattern = 'flower'"),
        ({"largest": 0}, "max_satellites = 0"),
        ({"largest": 65}, "max_satellites = 65"),
        ({"fold": 0}, "fold = 0"),
        ({"beyond": -1}, "beyond = -1"),
        ({"mask": -0.1}, "mask_deg = -5.7"),
        ({"radius": 1e6}, "must be above the surface"),
    ],
)
def test_bad_arguments(change, message):
    arguments = {"fold": 4, "mask": 0.0, "radius": RADIUS, "largest": 5} | change
    with pytest.raises(ArgumentError, match=message):
        search(arguments.pop("fold"), arguments.pop("mask"), figure=SPHERE, **arguments)
