"""Coverage over real paths: proven, lost to the second, and how far from either."""

from datetime import datetime

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.core.fold import Sides
from compass.core.lasting import ABOUT_POLE, FREE, MovingCaps, caps_between
from compass.core.nearest import covering_radius
from compass.core.path import piece_of, pull_bound
from compass.coverage.cap import cap_radius
from compass.coverage.certificate import Outcome, prove_fold
from compass.coverage.fold import clearances, fold_extremes
from compass.coverage.lasting import RESOLUTION, least_margins, margins_at, prove_span
from compass.coverage.margin import highest_mask
from compass.coverage.region import convex_polygon, latitude_band
from compass.coverage.symmetry import Span
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY as DAY
from compass.frames import direction, mcmf_from_mci, prime_meridian_angle, seconds_past_j2000
from compass.orbits import keplerian, walker_delta
from compass.orbits.forces import ForceModel
from compass.orbits.motion import Motion

SPHERE = 3396190.0
NOON_2030 = seconds_past_j2000(datetime(2030, 1, 1, 12))


def few(radius=20427.7e3, epoch=0.0):
    """Five satellites that keep one in view everywhere, with 11 degrees to spare."""
    return walker_delta(5, 5, 1, inclination_deg=43.66, radius_km=radius / 1e3, epoch=epoch)


def drifting():
    """The same, one of them higher, so that it falls behind by 12 degrees a day."""
    axes = np.full(5, 20427.7e3)
    axes[2] += 480e3
    c = few()
    return keplerian(axes, 0.0, c.inclination, c.raan, 0.0, c.mean_anomaly)


def path_of(constellation, days, model="two-body"):
    return Motion(model).trajectory(constellation, 0.0, days * DAY)


@pytest.mark.slow
def test_the_published_constellation_loses_four_fold_coverage_on_day_31():
    """All on the same osculating elements, node and phase 0 at 2030-01-01T12:00 TDB.

    Two independent programs found the loss between day 30.5 and 31.5, by stepping.
    """
    c = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427.7, epoch=NOON_2030)
    path = Motion("numerical", ForceModel(radiation=0.026)).trajectory(c, 0.0, 40 * DAY)
    found = prove_span(path, 4, sphere_radius=SPHERE)
    assert found.outcome is Outcome.REFUTED
    assert 30.5 < found.days_proven <= found.first_loss_days < 31.5
    assert found.lost_at - found.proven_until <= 1.0
    assert found.witness.fold == 3
    margins = np.degrees(least_margins(path, 4, np.arange(0, 36, 5) * DAY, sphere_radius=SPHERE))
    # the least of 24 phases of the other program, good to 0.3: 6.0 at 10 d, 4.3 to 4.6 at 20
    assert margins[1, 1] == pytest.approx(6.0, abs=0.3)
    assert margins[3, 1] == pytest.approx(4.5, abs=0.4)
    assert margins[5, 1] > 0 > margins[6, 1]


def test_two_body_paths_are_settled_as_by_the_certificate_of_ellipses():
    c = few()
    span = Span(0.0, 0.3 * DAY, False, "")
    best = highest_mask(c, 1, sphere_radius=SPHERE, span=span, tolerance=1e-3)
    path = path_of(c, 0.3)
    for mask, outcome in ((best - 1e-3, Outcome.PROVEN), (best + 3e-3, Outcome.REFUTED)):
        here = prove_span(path, 1, sphere_radius=SPHERE, mask=mask)
        there = prove_fold(c, 1, sphere_radius=SPHERE, mask=mask, span=span)
        assert here.outcome is there.outcome is outcome


@pytest.mark.parametrize(
    "region", [latitude_band(-0.6, 0.6), convex_polygon([0.0, 0.0, 0.5], [0.0, 0.5, 0.2])]
)
def test_parts_of_the_sphere_are_settled_as_by_the_certificate_of_ellipses(region):
    c, span = few(), Span(0.0, 0.2 * DAY, False, "")
    best = highest_mask(c, 2, sphere_radius=SPHERE, span=span, region=region, tolerance=2e-3)
    path = path_of(c, 0.2)
    for mask, outcome in ((best - 2e-3, Outcome.PROVEN), (best + 5e-3, Outcome.REFUTED)):
        here = prove_span(path, 2, sphere_radius=SPHERE, mask=mask, region=region)
        assert here.outcome is outcome
        if here.witness:
            assert here.witness.fold < 2


def test_a_loss_is_the_first_and_stands_between_two_moments_a_second_apart():
    c = drifting()
    path = path_of(c, 6.0, "j2")
    found = prove_span(path, 1, sphere_radius=SPHERE)
    assert found.outcome is Outcome.REFUTED
    assert found.lost_at - found.proven_until <= 1.0
    assert found.witness.fold == 0
    radius = cap_radius(c.semi_major_axis, SPHERE)
    at = [found.proven_until - 1e-3, found.lost_at]
    folds = [fold_extremes(x, radius).least for x in np.moveaxis(path.states(at)[0], 0, 1)]
    assert folds == [1, 0]
    # nothing earlier, by looking
    times = np.linspace(0.0, found.proven_until - 1.0, 300)
    looks = np.moveaxis(path.states(times)[0], 0, 1)
    assert min(fold_extremes(x, radius).least for x in looks) == 1
    # from a later start the same loss; up to an earlier stop none
    later = prove_span(path, 1, sphere_radius=SPHERE, start=found.lost_at - 100.0)
    assert later.lost_at == pytest.approx(found.lost_at, abs=2.0)
    held = prove_span(path, 1, sphere_radius=SPHERE, stop=found.proven_until)
    assert held.outcome is Outcome.PROVEN
    assert held.days_proven == pytest.approx(found.days_proven)
    assert (held.first_loss_days, held.witness) == (None, None)


def test_a_loss_within_the_paths_error_is_left_open():
    """A table good to 30 km can neither keep nor lose what hangs on 10 km."""
    c = drifting()
    path = path_of(c, 6.0, "j2")
    found = prove_span(path, 1, sphere_radius=SPHERE)
    coarse = type(path)(
        path.breaks, path.paths, path.errors + 3e4, 0.0, path.satellite_names, "table", "guess"
    )
    vague = prove_span(coarse, 1, sphere_radius=SPHERE, stop=found.lost_at + 1.0)
    assert vague.outcome is Outcome.UNDECIDED
    assert vague.unsettled
    assert vague.proven_until < found.proven_until
    assert vague.proven_until <= vague.unsettled[0][0]
    assert vague.estimated == "guess"
    sure = prove_span(coarse, 1, sphere_radius=SPHERE)
    assert sure.outcome is Outcome.REFUTED
    assert sure.proven_until < found.proven_until < found.lost_at < sure.lost_at


def test_paths_of_too_many_satellites_are_refused_before_any_work(monkeypatch):
    monkeypatch.setattr("compass.coverage.stretches.MOST_PAIRS", few().size ** 2 - 1)
    with pytest.raises(ArgumentError, match=f"satellites = {few().size}: a proof compares"):
        prove_span(path_of(few(), 1.0), 1, sphere_radius=SPHERE, progress=pytest.fail)


def test_giving_up_is_undecided():
    found = prove_span(path_of(few(), 1.0), 1, sphere_radius=SPHERE, max_intervals=3)
    assert found.outcome is Outcome.UNDECIDED
    assert found.proven_until < DAY


def oval_caps(frame, ground):
    """Caps of the oval orbits over the whole sphere; Mars stands still."""
    paths = OVAL.breaks, OVAL.paths, OVAL.errors, np.zeros(len(OVAL.breaks))
    return MovingCaps(*paths, frame, ground, Sides(np.empty((0, 3)), np.empty(0)))


@settings(max_examples=40)
@given(
    st.floats(0.0, 0.5),
    st.floats(5.0, 3000.0),
    st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3),
)
def test_no_cap_strays_further_than_its_bound(when, half, places):
    """Against the paths themselves, in a frame that turns about the mean of angular velocities."""
    middle = when * DAY
    piece = piece_of(OVAL.breaks, middle)
    half = min(half, middle - OVAL.breaks[piece], OVAL.breaks[piece + 1] - middle)
    n = OVAL.size
    u, radius, stray = np.empty((n, 3)), np.empty(n), np.empty((n, 2))
    pulls = np.array([pull_bound(OVAL.breaks, OVAL.paths, piece, s) for s in range(n)])
    caps = oval_caps(FREE, (SPHERE, 1.0, 0.1, -1.0, 1.0))
    if not caps_between(caps, pulls, piece, middle, half, u, radius, stray):
        return
    r, v = OVAL.states([middle])
    spin = (np.cross(r, v)[:, 0] / (r[:, 0] ** 2).sum(axis=-1, keepdims=True)).mean(axis=0)
    rate = np.linalg.norm(spin)
    for place in places:
        x = OVAL.states([middle + place * half])[0][:, 0]
        distance = np.linalg.norm(x, axis=-1)
        turned = about(spin / rate, -rate * place * half, x / distance[:, None])
        angle = 2 * np.arcsin(np.minimum(np.linalg.norm(turned - u, axis=-1) / 2, 1.0))
        change = np.abs(cap_radius(distance, SPHERE, 0.1) - radius)
        assert np.all(angle + change <= stray[:, 0] + 1e-15)


def about(axis, angle, x):
    """Rodrigues' rotation."""
    c, s = np.cos(angle), np.sin(angle)
    return c * x + s * np.cross(axis, x) + (1 - c) * (x @ axis)[:, None] * axis


OVAL = path_of(
    keplerian([9e6, 15e6, 22e6], [0.3, 0.1, 0.6], [0.4, 1.0, 2.0], 0.3, 0.2, [0.0, 1.0, 2.0]),
    0.6,
)


def test_margin_is_the_cap_less_the_covering_radius_of_the_moment():
    c = few()
    path, times = path_of(c, 0.5), np.array([0.0, 0.11, 0.37]) * DAY
    found = margins_at(path, 1, times, sphere_radius=SPHERE)
    cap = cap_radius(20427.7e3, SPHERE)
    for k, x in enumerate(np.moveaxis(path.states(times)[0], 0, 1)):
        u = np.ascontiguousarray(x / np.linalg.norm(x, axis=-1, keepdims=True))
        radius = covering_radius(u, 1, 0.0, np.pi, np.empty(3))
        assert found[k] == pytest.approx(cap - radius, abs=2e-6)


def test_the_least_margin_is_bracketed_below_every_look():
    path = path_of(drifting(), 3.0, "j2")
    # in six hours the margin falls and rises more than once, and is least away from the middle
    edges = np.arange(1.0, 2.01, 0.25) * DAY
    found = least_margins(path, 1, edges, sphere_radius=SPHERE, tolerance=2e-3)
    assert np.all(found[:, 1] - found[:, 0] <= 2.1e-3)
    for k in range(4):
        looks = np.linspace(edges[k], edges[k + 1], 16)
        seen = margins_at(path, 1, looks, sphere_radius=SPHERE).min()
        # margins change by less than two caps' turning in a third of an hour... and are never below
        assert found[k, 0] <= seen + 1e-6
        assert seen <= found[k, 1] + 0.06


def test_a_positive_least_margin_is_a_proof_and_a_negative_one_a_loss():
    path = path_of(drifting(), 4.0, "j2")
    found = prove_span(path, 1, sphere_radius=SPHERE)
    t = found.lost_at
    before, after = least_margins(
        path, 1, [0.0, t - 600.0, t + 600.0], sphere_radius=SPHERE, tolerance=1e-4
    )
    assert before[0] > -1e-3
    assert after[1] < 0.0


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"fold": 0}, "fold = 0"),
        ({"mask": 2.0}, "mask_deg = 114"),
        ({"stop": 2.5 * DAY}, "more than the ephemerides cover"),
        ({"start": DAY, "stop": DAY}, "days = 0: must be more than 0"),
        ({"sphere_radius": 3e7}, "must be above the surface"),
    ],
)
def test_bad_claims_are_refused(more, message):
    given = {"fold": 1, "sphere_radius": SPHERE} | more
    with pytest.raises(ArgumentError, match=message):
        prove_span(path_of(few(), 1.0), given.pop("fold"), **given)


def test_on_an_ellipsoid_the_highest_mask_is_the_one_found_by_symmetry():
    """Two proofs that share no bound on how caps move."""
    c = walker_delta(6, 1, 0, inclination_deg=0, radius_km=20427)
    figure = {"sphere_radius": SPHERE, "stretch": 3396.19 / 3376.2}
    region = latitude_band(-0.3, 0.4)
    highest = highest_mask(c, 1, region=region, **figure)
    path = path_of(c, 0.005)

    def found(mask):
        return prove_span(path, 1, mask=mask, region=region, **figure)

    assert found(highest - VAGUE).outcome is Outcome.PROVEN
    lost = found(highest + VAGUE)
    assert lost.outcome is Outcome.REFUTED
    assert lost.stretch == figure["stretch"]
    sphere = prove_span(path, 1, mask=highest + VAGUE, region=region, sphere_radius=SPHERE)
    assert sphere.outcome is Outcome.PROVEN  # whose users' verticals lean towards the ring


def test_a_loss_on_an_ellipsoid_stands_after_what_all_bands_have_proven():
    path = path_of(drifting(), 5.0)
    figure = {"sphere_radius": SPHERE, "stretch": 3396.19 / 3376.2}
    found = prove_span(path, 1, mask=0.02, **figure)
    assert found.outcome is Outcome.REFUTED
    assert 0.0 < found.lost_at - found.proven_until <= RESOLUTION
    w = found.witness
    x = path.states([w.time])[0][:, 0]
    turn = prime_meridian_angle(path.epoch, w.time)
    place = mcmf_from_mci(direction(w.latitude, w.longitude), -turn)
    assert (clearances(x, SPHERE, 0.02, place, figure["stretch"]) >= 0).sum() == w.fold == 0


def refined(worth, rounds=4):
    """Least of a function of unit vectors (k, 3), by finer and finer looks about the lowest."""
    grid, reach = np.meshgrid(np.linspace(-1, 1, 181), np.linspace(-3.15, 3.15, 361)), 0.02
    z, east = (a.ravel() for a in grid)
    for _ in range(rounds):
        level = np.sqrt(np.maximum(0.0, 1.0 - z * z))
        values = worth(np.column_stack([level * np.cos(east), level * np.sin(east), z]))
        low = np.argsort(values)[:20]
        offsets = reach * np.linspace(-1.0, 1.0, 21)
        dz, de = np.meshgrid(offsets, offsets)
        z = np.clip((z[low, None] + dz.ravel()).ravel(), -1.0, 1.0)
        east, reach = (east[low, None] + de.ravel()).ravel(), 0.1 * reach
    return values.min()


@pytest.mark.slow
@pytest.mark.parametrize("mask", [0.0, 0.1])
def test_margins_of_an_ellipsoid_are_those_of_its_users_one_by_one(mask):
    """Each user's cap by the elevation's own formula, ``sin e = sin e' / kappa``."""
    stretch, when = 1.1, 3.3e4
    path = Motion().trajectory(few(), 0.0, DAY)
    x = path.states([when])[0][:, 0] * [1.0, 1.0, stretch]
    far = np.linalg.norm(x, axis=1)

    def worth(q):
        sight = x - SPHERE * q[:, None]
        d = sight[..., 2] / np.linalg.norm(sight, axis=-1)
        kappa2 = (1 + (stretch**2 - 1) * q[:, 2:] ** 2) * (1 - (1 - stretch**-2) * d**2)
        own = np.arcsin(np.sqrt(kappa2) * np.sin(mask))
        cap = np.arccos(SPHERE * np.cos(own) / far) - own
        return (cap - np.arccos(np.clip(q @ x.T / far, -1.0, 1.0))).max(axis=1)

    ground = {"sphere_radius": SPHERE, "mask": mask, "stretch": stretch}
    found = margins_at(path, 1, [when], **ground)[0]
    # away from a margin of none the sights at the rim lean otherwise than those looked along
    known = refined(worth)
    assert found == pytest.approx(known, abs=1e-4 if mask == 0.0 else 5e-3)
    assert found < known + 1e-5
    edges = [when - 600.0, when, when + 600.0]
    low, high = least_margins(path, 1, edges, **ground, tolerance=2e-3).T
    assert np.all(low <= found)
    assert np.all(high - low < 6e-3)
    assert np.all(high <= found + 6e-3)
    holds = prove_span(path, 1, **ground, start=edges[0], stop=edges[-1]).outcome
    assert (holds == "proven") == bool(low.min() > 0.0)


#: In the narrowest bands (sine of latitude 0.02) kappa at 45 degrees spans some 1e-4.
VAGUE = 3e-4


@settings(max_examples=30)
@given(st.floats(0.0, 0.5), st.floats(5.0, 1000.0), st.floats(-1.0, 0.98), st.integers(0, 1000))
def test_no_user_on_an_ellipsoid_sees_otherwise_than_the_caps_say(when, half, south, seed):
    """Against elevations over the ellipsoid's own normal, at moments and places of the bounds."""
    middle, mask, stretch = when * DAY, 0.6, 1.2
    piece = piece_of(OVAL.breaks, middle)
    half = min(half, middle - OVAL.breaks[piece], OVAL.breaks[piece + 1] - middle)
    n, rng = OVAL.size, np.random.default_rng(seed)
    u, radius, stray = np.empty((n, 3)), np.empty(n), np.empty((n, 2))
    pulls = np.array([pull_bound(OVAL.breaks, OVAL.paths, piece, s) for s in range(n)])
    caps = oval_caps(ABOUT_POLE, (SPHERE, stretch, mask, south, south + 0.02))
    if not caps_between(caps, pulls, piece, middle, half, u, radius, stray):
        return
    r, v = OVAL.states([middle])
    spin = (np.cross(r, v)[:, 0] / (r[:, 0] ** 2).sum(axis=-1, keepdims=True)).mean(axis=0)[2]
    q = rng.uniform(south, south + 0.02, 300)
    east = rng.uniform(0, 2 * np.pi, 300)
    users = np.column_stack([np.sqrt(1 - q**2) * np.cos(east), np.sqrt(1 - q**2) * np.sin(east), q])
    away = np.arccos(np.clip(users @ u.T, -1.0, 1.0))
    for place in rng.uniform(-1.0, 1.0, 5):
        x = OVAL.states([middle + place * half])[0][:, 0]
        here = about(np.array([0.0, 0.0, 1.0]), spin * place * half, users)
        seen = clearances(x, SPHERE, mask, here / [1.0, 1.0, stretch], stretch) >= 0.0
        assert np.all(seen[away < radius - stray[:, 0]])
        assert not np.any(seen[away > radius + stray[:, 0]])
