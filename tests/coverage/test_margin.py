"""Margins: the specification's numbers, samples, losses one by one."""

import itertools

import numpy as np
import pytest

from compass.coverage.cap import cap_radius
from compass.coverage.certificate import fold_range, prove_fold
from compass.coverage.fold import clearances
from compass.coverage.margin import (
    after_losses,
    covering_radius,
    highest_mask,
    lowest_altitude,
    lowest_orbit,
)
from compass.coverage.region import read_region
from compass.coverage.symmetry import Span, shortest_span
from compass.errors import ArgumentError
from compass.orbits import (
    keplerian,
    orbital_period,
    positions_mci,
    rosette,
    walker_delta,
    walker_star,
)

R = 3396.2e3
DEGREE = np.radians(1.0)


def seed_design():
    return walker_delta(15, 5, 1, inclination_deg=45, radius_km=20428)


def small_design():
    return walker_delta(6, 3, 1, inclination_deg=52, radius_km=20428)


@pytest.mark.slow
def test_covering_radius_of_the_seed_design():
    # specification, section 3: 74.250 deg and a mask of 6.24 deg
    found = covering_radius(seed_design(), 4)
    assert np.degrees(found.radius) == pytest.approx(74.250, abs=6e-4)
    assert 0 <= found.radius - found.at_least <= 1e-6
    margin = highest_mask(seed_design(), 4, sphere_radius=R)
    assert np.degrees(margin) == pytest.approx(6.24, abs=5e-3)
    for change, outcome in ((-1e-6, "proven"), (2e-6, "refuted")):
        claim = prove_fold(seed_design(), 4, sphere_radius=R, mask=margin + change)
        assert claim.outcome == outcome


def test_the_place_is_as_far_as_it_says():
    c = small_design()
    for fold in (1, 2, 3):
        found = covering_radius(c, fold, tolerance=1e-3)
        r = positions_mci(c, [found.time])[:, 0]
        distance = np.arccos(r @ found.place / np.linalg.norm(r, axis=1))
        assert np.sort(distance)[fold - 1] == pytest.approx(found.at_least, abs=1e-9)


def test_no_sample_is_farther():
    c = small_design()
    rng = np.random.default_rng(3)
    p = rng.normal(size=(3000, 3))
    p /= np.linalg.norm(p, axis=1, keepdims=True)
    r = positions_mci(c, rng.uniform(0, 1e5, 60))
    r /= np.linalg.norm(r, axis=-1, keepdims=True)
    far = np.sort(np.arccos(np.clip(np.einsum("stk,pk->tps", r, p), -1, 1)), axis=-1)
    for fold in (1, 2, 4, 6):
        found = covering_radius(c, fold, tolerance=1e-3)
        assert far[..., fold - 1].max() <= found.radius
        # and samples come near
        assert far[..., fold - 1].max() >= found.radius - 0.06


def test_known_covering_radii():
    fixed = Span(0.0, 0.0, False, "")
    six = keplerian(
        1e7, 0.0, [0, 0, 0, 0, 1.5707963267948966, 1.5707963267948966], 0.0, 0.0,
        np.radians([0, 90, 180, 270, 90, 270]),
    )  # fmt: skip
    octahedron = np.arccos(1 / np.sqrt(3))
    assert covering_radius(six, 1, span=fixed).at_least == pytest.approx(octahedron, abs=1e-12)
    one = walker_delta(1, 1, 0, inclination_deg=57.3, radius_km=10000)
    alone = covering_radius(one, 1)
    assert alone.at_least == pytest.approx(np.pi)
    assert alone.radius <= np.pi  # half a turn covers all there is: no bound needs to say more
    two = walker_delta(2, 1, 0, inclination_deg=57.3, radius_km=10000)
    assert covering_radius(two, 1, span=fixed).at_least == pytest.approx(np.pi / 2)
    assert covering_radius(two, 2, span=fixed).at_least == pytest.approx(np.pi)
    apart = keplerian(1e7, 0.0, 0.0, 0.0, 0.0, [0.0, 1.0])
    # far midpoint of two satellites a radian apart
    assert covering_radius(apart, 1, span=fixed).at_least == pytest.approx(np.pi - 0.5)
    assert covering_radius(apart, 3, span=fixed).radius == np.inf
    assert highest_mask(apart, 3, sphere_radius=R) is None


def test_a_bracket_without_enough_intervals_stays_a_bracket():
    c = small_design()
    rough, fine = covering_radius(c, 2, max_intervals=4), covering_radius(c, 2, tolerance=1e-2)
    assert rough.at_least <= fine.radius
    assert rough.radius >= fine.at_least
    assert rough.radius - rough.at_least > 1e-6


def test_lowest_altitude_inverts_the_cap():
    for mask in (0.0, 0.1):
        height = lowest_altitude(1.1, R, mask)
        assert cap_radius(R + height, R, mask) == pytest.approx(1.1, abs=1e-14)
    assert lowest_altitude(1.5, R, 0.1) is None


def test_highest_mask_of_a_region_by_halving():
    c = small_design()
    band = read_region("lat:40:90")
    # a coarse tolerance: the halving is the same
    mask = highest_mask(c, 1, sphere_radius=R, region=band, tolerance=2e-3)
    claim = {"sphere_radius": R, "region": band}
    assert prove_fold(c, 1, mask=mask, **claim).outcome == "proven"
    assert prove_fold(c, 1, mask=mask + 3e-3, **claim).outcome == "refuted"


def test_two_on_one_side_are_seen_through_the_ground_only():
    """Against samples of the plain triangle: the user opposite the pair looks almost straight down."""
    c = keplerian([1e7, 1e7], 0.1, 0.0, 0.0, 0.0, [0.0, 0.1])
    sphere = 9.0e6 - 1.0
    mask = highest_mask(c, 1, sphere_radius=sphere, tolerance=1e-3)
    around = np.linspace(0, 2 * np.pi, 4001)
    places = np.stack([np.cos(around), np.sin(around), 0 * around], axis=-1)
    times = np.linspace(0, float(orbital_period(1e7)), 201)
    sampled = min(
        clearances(positions_mci(c, [t])[:, 0], sphere, 0.0, places).max(axis=1).min()
        for t in times
    )
    assert sampled - 2e-3 < mask <= sampled < np.radians(-85)


def star():
    return walker_star(12, 3, 2, inclination_deg=75, altitude_km=10000)


def test_the_lowest_orbit_in_a_limited_time_is_proven_at_its_own_pace():
    """Lower satellites move faster and show more of what there is in the same time."""
    found = lowest_orbit(star(), 1, sphere_radius=R, duration=720.0)
    from_the_cap = lowest_altitude(
        covering_radius(star(), 1, span=shortest_span(star(), duration=720.0)).radius, R
    )
    assert found > from_the_cap + 1e4
    for height, outcome in ((found, "proven"), (found + 3e4, "proven"), (found - 100.0, "refuted")):
        c = walker_star(12, 3, 2, inclination_deg=75, altitude_km=height / 1e3)
        span = shortest_span(c, duration=720.0)
        assert prove_fold(c, 1, sphere_radius=R, span=span).outcome == outcome
    for guess in (from_the_cap, 3 * found):
        assert lowest_orbit(star(), 1, sphere_radius=R, duration=720.0, guess=guess) == found


def test_the_lowest_orbit_for_ever_is_that_of_the_cap_rounded_up():
    c = walker_delta(5, 5, 1, inclination_deg=43.66, radius_km=20428)
    exact = lowest_altitude(covering_radius(c, 1).radius, R)
    found = lowest_orbit(c, 1, sphere_radius=R, guess=exact)
    assert exact - 20.0 <= found <= exact + 120.0
    assert found % 100.0 == 0.0
    assert lowest_orbit(c, 6, sphere_radius=R) is None
    assert lowest_orbit(c, 4, sphere_radius=R) is None  # not from any height
    oval = keplerian([1e7, 1e7], 0.1, 0.0, 0.0, 0.0, [0.0, 0.1])
    assert lowest_orbit(oval, 1, sphere_radius=R) is None


def test_a_delay_is_no_symmetry_of_a_limited_time():
    """Against every satellite by itself; for ever all twelve are alike, in 12 minutes not."""
    c = rosette(12, 3, "1/4", inclination_deg=50.73, orbit="areosynchronous")
    assert len(after_losses(c, 1, 1, sphere_radius=R, tolerance=0.1)) == 1
    found = after_losses(c, 1, 1, sphere_radius=R, duration=720.0, tolerance=0.1)
    least = {
        name: fold_range(
            c.without([k]),
            sphere_radius=R,
            span=shortest_span(c.without([k]), duration=720.0),
            greatest=False,
        )[0]
        for k, name in enumerate(c.satellite_names)
    }
    assert sum(loss.alike for loss in found) == 12
    assert sorted(loss.least for loss in found for _ in range(loss.alike)) == sorted(least.values())
    assert len(set(least.values())) == 2
    for loss in found:
        assert loss.least == least[loss.satellites[0]]


def test_losses_against_every_set_one_by_one():
    c = small_design()
    found = after_losses(c, 2, 1, sphere_radius=R, tolerance=0.05)
    assert sum(loss.alike for loss in found) == 15
    least = [
        fold_range(c.without(pair), sphere_radius=R, greatest=False)[0]
        for pair in itertools.combinations(range(6), 2)
    ]
    counted = [loss.least for loss in found for _ in range(loss.alike)]
    assert sorted(counted) == sorted(least)
    assert found[0].least == min(least)
    worst = [c.satellite_names.index(name) for name in found[0].satellites]
    assert fold_range(c.without(worst), sphere_radius=R)[0] == min(least)
    assert found[0].as_dict()["min_fold"] == min(least)[0]


@pytest.mark.slow
def test_a_loss_costs_at_most_one_and_all_satellites_are_alike():
    full = fold_range(small_design(), sphere_radius=R)[0]
    (loss,) = after_losses(small_design(), 1, 1, sphere_radius=R)
    assert loss.alike == 6
    assert full[0] - 1 <= loss.least[0] <= full[0]


def test_losses_in_a_region_have_no_common_radius():
    found = after_losses(
        small_design(), 6, 1, sphere_radius=R, region=read_region("lat:-10:10"), progress=list
    )
    assert found[0].least == (0, 0)
    assert found[0].radius is None
    assert found[0].as_dict()["cap_radius_min_deg"] is None


def test_more_losses_than_satellites():
    with pytest.raises(ArgumentError, match="losses = 7"):
        after_losses(small_design(), 7, 1, sphere_radius=R)
