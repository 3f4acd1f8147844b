"""Candidates: the grid against plain loops, samples inside the space, identities that stay."""

import struct
import tracemalloc
from dataclasses import replace
from fractions import Fraction
from hashlib import blake2b
from itertools import product
from math import gcd

import numpy as np
import pytest

from compass import memory
from compass.errors import ArgumentError, DesignError
from compass.inputs.study import read_study_text
from compass.orbits import rosette
from compass.study.candidates import (
    PATTERNS,
    ROW,
    Grid,
    Listed,
    Members,
    batches,
    blocks,
    candidates,
    check_space,
    identities,
    make_constellation,
    pick,
)

TEXT = """
name = "t"
[study]
patterns = {patterns}
satellites = {satellites}
inclination_deg = {inclination}
radius_km = {radius}
mask_deg = [0, 5]
{more}
[[objective]]
figure = "satellites"
"""


def study(patterns='["walker-delta", "walker-star"]', satellites="[4, 6]", inclination="[40, 55.5]",
          radius="[10000, 20000]", more=""):  # fmt: skip
    return read_study_text(TEXT.format_map(locals()), "s.toml")


def test_the_grid_is_every_combination_once():
    found = candidates(study())
    wanted = [
        (kind, t, p, f, i, r, m)
        for kind in (0, 1)
        for t in (4, 6)
        for p in range(1, t + 1)
        if t % p == 0 and (kind == 0 or p > 1)  # a star of one plane is a delta pattern
        for f, i, r, m in product(range(p), (40.0, 55.5), (10000.0, 20000.0), (0.0, 5.0))
    ]
    assert len(found) == len(wanted)
    assert found.rows(0, len(found)).tolist() == wanted
    assert np.concatenate(list(batches(found, 17))).tolist() == wanted
    assert found.rows(5, 8).tolist() == wanted[5:8]


def test_planes_and_phasings_given():
    found = candidates(study(more="planes = [2, 5]\nphasing = [1, 7]"))
    rows = found.rows(0, len(found))
    assert set(rows["planes"]) == {2} and set(rows["phasing"]) == {1}


def test_no_candidate():
    with pytest.raises(DesignError, match=r"s.toml: study: no candidate.*4, 6 goes"):
        candidates(study(more="planes = [5]"))
    with pytest.raises(DesignError, match=r"no candidate.*1, 2, 3, 4, 5 \.\.\."):
        candidates(study(satellites="{least = 1, most = 6}", more="planes = [7]"))


def test_more_candidates_than_a_run_comes_to_the_end_of():
    """Two patterns of 1 to 1000 satellites: 25 million times more than a grid may have."""
    many = study(
        satellites="{least = 1, most = 1000}",
        inclination="{least = 0, most = 90, step = 0.001}",
        radius="{least = 4000, most = 90000, step = 1}",
    )
    with pytest.raises(
        DesignError, match=r"s\.toml: study: 25\d{15} candidates.*take larger steps"
    ):
        check_space(many)
    sampled = replace(many, sampling=many.sampling.model_copy(update={"method": "sobol"}))
    check_space(sampled)


def test_rosettes_are_the_patterns_of_their_multipliers():
    found = candidates(study(patterns='["rosette"]', satellites="[12]"))
    rows = found.rows(0, len(found))
    assert set(rows["pattern"]) == {PATTERNS.index("walker-delta")}
    for row in rows[::7]:
        c = make_constellation(row)
        again = rosette(12, c.pattern.planes, Fraction(c.pattern.multiplier),
                        inclination_deg=np.degrees(c.pattern.inclination), radius_km=(row["radius_km"] * 1e3) / 1e3)  # fmt: skip
        assert c.pattern.phasing == row["phasing"]
        assert np.array_equal(c.mean_anomaly, again.mean_anomaly)
    # (12, 3, m) with m c multiple of 1/4: multipliers 1/4, 3/4, ... with odd numerators
    assert set(rows[rows["planes"] == 3]["phasing"]) == {0, 1, 2}


@pytest.mark.parametrize("method", ["latin-hypercube", "sobol"])
def test_samples_lie_in_the_space_and_repeat(method):
    sampled = study(
        inclination="{ least = 30, most = 60 }",
        radius="{ least = 9000, most = 21000 }",
        more=f'seed = 3\n[sampling]\nmethod = "{method}"\nsamples = 64',
    )
    found = candidates(sampled)
    rows = found.rows(0, len(found))
    assert isinstance(found, Listed) and len(found) == 64
    assert np.all((rows["inclination_deg"] >= 30) & (rows["inclination_deg"] <= 60))
    assert np.ptp(rows["radius_km"]) > 10000
    assert np.all(rows["satellites"] % rows["planes"] == 0)
    assert np.all(rows["phasing"] < rows["planes"])
    assert np.array_equal(rows, candidates(sampled).rows(0, 64))
    # one of equal marginals: each half of the free ranges has half of the samples
    assert (rows["inclination_deg"] < 45).sum() == 32


def test_no_sample_twice():
    coarse = study(more='[sampling]\nmethod = "latin-hypercube"\nsamples = 900')
    found = candidates(coarse)
    assert len(found) < 900
    assert len(set(identities(found.rows(0, len(found))))) == len(found)


def test_identities_are_of_the_candidate_alone():
    row = np.array([(0, 15, 5, 1, 45.0, 20427.68, 5.0)], ROW)
    packed = struct.pack("<Bhhhddd", 0, 15, 5, 1, 45.0, 20427.68, 5.0)
    assert identities(row) == [blake2b(packed, digest_size=8).hexdigest()]
    assert identities(row) == ["081a170ac64e0a63"]  # must never change: stores rest on it
    grid = Grid(study())
    rows = grid.rows(0, len(grid))
    keys = identities(rows)
    assert len(set(keys)) == len(keys)
    assert identities(rows[::-1].copy()) == keys[::-1]
    assert identities(rows[::2]) == keys[::2]


def test_points_of_the_cube_one_by_one(tiny):
    """Against choosing kind, size, planes and phasing in turn, from lists."""
    study = tiny()
    space = replace(study.space, patterns=("walker-star", "rosette"), satellites=(4, 6, 9))
    study = replace(study, space=space)
    choices = blocks(study)
    share = np.random.default_rng(3).random((200, 7))
    share[0], share[1] = 0.0, 1 - 1e-16

    def one(values, u):
        return values[min(int(u * len(values)), len(values) - 1)]

    for row, u in zip(pick(study, choices, share), share, strict=True):
        kind = one([1, 0], u[0])  # a rosette is written down as the delta that it is
        size = one([4, 6, 9], u[1])
        block = one([b for b in choices if (b.pattern, b.satellites) == (kind, size)], u[2])
        assert tuple(row) == (
            kind, size, block.planes, one([f for f in range(block.planes) if f in block.phasings], u[3]),
            one(space.inclination_deg, u[4]), one(space.radius_km, u[5]), one(space.mask_deg, u[6]),
        )  # fmt: skip


@pytest.mark.parametrize("kind", ["walker-delta", "walker-star", "rosette"])
@pytest.mark.parametrize("given", ["", "phasing = [0, 2, 3, 7]"])
def test_phasings_are_those_of_the_definition(kind, given):
    """A rosette's numerator is prime to t/p, as Ballard has it; any of f + kp will do."""
    many = study(patterns=f'["{kind}"]', satellites="{least = 1, most = 24}", more=given)
    found = candidates(many)
    rows = found.rows(0, len(found))[:: found.each]
    wanted = [
        (t, p, f)
        for t in range(1, 25)
        for p in range(1, t + 1)
        if t % p == 0
        for f in range(p)
        if (not given or f in (0, 2, 3, 7))
        and (kind != "rosette" or any(gcd(c, t // p) == 1 for c in range(f, t, p)))
    ]
    assert rows[["satellites", "planes", "phasing"]].tolist() == wanted
    members = Members(many)
    assert members.have(found.rows(0, len(found))).all()
    every = np.array(
        [(0, t, p, f, 40.0, 10000.0, 0.0) for t in range(26) for p in range(26) for f in range(26)],
        ROW,
    )
    every["pattern"] = PATTERNS.index("walker-star" if kind == "walker-star" else "walker-delta")
    have = members.have(every)
    assert every[have][["satellites", "planes", "phasing"]].tolist() == wanted


def test_candidates_are_their_geometry_not_their_spelling():
    """All three kinds: no two candidates stand at the same places, none of a kind alone is missing."""

    def places(names):
        found = candidates(
            study(patterns=names, satellites="[4, 6]", inclination="40", radius="10000")
        )
        rows = found.rows(0, len(found))
        made = [make_constellation(row) for row in rows[rows["mask_deg"] == 0.0]]
        turn = 2 * np.pi
        return [
            frozenset(
                (round(node / turn * 720) % 720, round(u / turn * 720) % 720)
                for node, u in zip(c.raan.tolist(), c.mean_anomaly.tolist(), strict=True)
            )
            for c in made
        ]

    together = places('["rosette", "walker-star", "walker-delta"]')
    assert len(set(together)) == len(together)
    alone = [places(f'["{kind}"]') for kind in PATTERNS]
    assert set(together) == set().union(*alone)
    assert len(together) < sum(len(one) for one in alone)


@pytest.mark.slow
def test_a_space_of_82_million_is_counted_in_little_memory():
    """Sum over t to 10,000 of its divisors' sum: pi^2/12 t^2; in 31 bytes each it is 2.6 GB."""
    wide = study(
        satellites="{least = 1, most = 10000}", patterns='["walker-delta", "rosette"]',
        inclination="40", radius="10000",
    )  # fmt: skip
    tracemalloc.start()
    try:
        found = candidates(wide)
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    delta = sum(10_000 // q * (10_000 // q + 1) // 2 for q in range(1, 10_001))  # of p, q times
    assert 82e6 < delta < 83e6 and len(found) == delta * found.each
    assert most < 200e6
    last = found.rows(len(found) - 1, len(found))
    assert last["satellites"] == last["planes"] == 10_000 and last["phasing"] == 9999


def test_a_space_that_does_not_fit_is_refused_before_anything_is_made(monkeypatch):
    """254 million candidates, counted: 432 GB of tables at the end."""
    monkeypatch.setattr(memory, "limits", lambda: iter([64e9]))
    wide = study(
        satellites="{least = 8, most = 60}", patterns='["walker-delta"]',
        inclination="{least = 20, most = 90, step = 0.1}",
        radius="{least = 12000, most = 24000, step = 200}",
    )  # fmt: skip
    asked = r"254256906 candidates would take 432 GB of memory, there are 64; take larger steps, or"
    with pytest.raises(ArgumentError, match=asked):
        check_space(wide)
    check_space(study())


def test_members_of_ranges_are_within_their_ends():
    drawn = study(
        inclination="{least = 40, most = 50}",
        more='[sampling]\nmethod = "latin-hypercube"\nsamples = 50',
    )
    rows = candidates(drawn).rows(0, 50)
    members = Members(drawn)
    assert members.have(rows).all()
    rows["inclination_deg"] += 10.001
    assert not members.have(rows).any()
