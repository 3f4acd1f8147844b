"""Beams of antennas in certified boxes: against their own condition at random points."""

from dataclasses import replace

import numpy as np
import pytest

from compass.core.certified.groups import make_room
from compass.core.certified.sights import (
    FALL,
    HIGH,
    LOW,
    RISE,
    USER,
    place,
    sights,
    states,
)
from compass.coverage.certified_question import Question
from compass.coverage.certified_share import certified_folds, certified_share
from compass.coverage.certified_worst import certified_worst
from compass.coverage.region import GLOBE
from compass.coverage.users import by_horizon, region_users
from compass.frames import FIGURES, direction
from compass.orbits import positions_mci, walker_delta
from compass.orbits.motion import Motion
from compass.sites import Mask

SPHERE, ELLIPSOID = FIGURES["iau-sphere"], FIGURES["iau-ellipsoid"]
PATTERN = walker_delta(12, 3, 1, inclination_deg=50, radius_km=9000)
#: Beams whose edges are where Mars's limb is, inside of it, and for orbiters beyond it.
BEAMS = np.radians([22.0, 15.0, 40.0])


def boxes(question, seed, count):
    g = np.random.default_rng(seed)
    size = 10 ** g.uniform(-2.5, -0.7, count)
    centre = g.uniform([-1.4, 0, 0], [1.4, 6, 6], (count, 3))
    return np.hstack([centre, size[:, np.newaxis] * g.uniform(0.1, 1, (count, 3))])


@pytest.mark.parametrize("height", [0.0, 4e5])
@pytest.mark.parametrize("beam", BEAMS)
@pytest.mark.parametrize("motion", ["circles", "ovals", "paths"])
def test_a_box_sees_whom_each_of_its_points_sees(motion, beam, height):
    mask, pattern = (0.05 if height == 0.0 else -0.2), PATTERN
    if motion == "ovals":
        pattern = replace(pattern, eccentricity=np.full(PATTERN.size, 0.3))
    moved = Motion("two-body")
    if motion == "paths":
        path = Motion("numerical").trajectory(pattern, 0.0, 3e4)
        moved = Motion("ephemeris", table=path)
    question = Question(
        pattern,
        beam=beam,
        mask=mask,
        figure=ELLIPSOID,
        height=height,
        dop="fold",
        duration=3e4,
        motion=moved,
    )
    problem = question.problem()
    orbits, circles, breaks, paths, _, numbers, _ = problem
    n, g = PATTERN.size, np.random.default_rng(7)
    room = make_room(n)
    user, _, q, dq, rows, kinds = room
    cut = 0
    for box in boxes(question, 3, 40):
        place(box, numbers[0], numbers[2], user)
        states(orbits, circles, breaks, paths, box[2], q, dq)
        count = sights(box, user, orbits, q, dq, numbers, False, problem.mask, rows, kinds)
        if count < 0:
            continue
        # a row is known by its line of sight in the middle
        lines = q - user[3:6]
        lines /= np.linalg.norm(lines, axis=1, keepdims=True)
        whose = [int(np.argmax(lines @ row[:3])) for row in rows[:count]]
        for u in g.uniform(-1, 1, (30, 3)):
            at = box[:3] + box[3:6] * u
            ground, moved = np.empty(USER), (np.empty((n, 3)), np.empty((n, 3)))
            place(np.array([*at, 0, 0, 0]), numbers[0], numbers[2], ground)
            states(orbits, circles, breaks, paths, at[2], *moved)
            sight = moved[0] - ground[3:6]
            far = np.linalg.norm(sight, axis=1)
            away = np.linalg.norm(moved[0], axis=1)
            seen = (sight @ ground[:3] >= np.sin(mask) * far) & (
                (sight * moved[0]).sum(axis=1) >= np.cos(beam) * far * away
            )
            assert not seen[np.setdiff1d(np.arange(n), whose)].any()
            for k, satellite in enumerate(whose):
                if kinds[k] == 1:
                    assert seen[satellite]
                    continue
                row = rows[k]
                if row[HIGH] + row[HIGH + 1 : HIGH + 4] @ u >= row[FALL]:
                    assert seen[satellite]
                    cut += 1
                if row[LOW] + row[LOW + 1 : LOW + 4] @ u <= -row[RISE]:
                    assert not seen[satellite]
                    cut += 1
    assert cut > 100


@pytest.mark.slow
@pytest.mark.parametrize("beam", BEAMS[:2])
def test_over_a_sphere_a_beam_is_a_horizon(beam):
    everyone = replace(region_users(GLOBE, SPHERE, Mask.constant(0.05)), beam=beam)
    users = by_horizon(everyone, PATTERN, Motion("two-body"))
    assert users.beam is None
    for limit, asked in ((2, {"dop": "fold"}), (10.0, {"dop": "pdop"})):
        one = certified_share(PATTERN, limit, beam=beam, mask=0.05, figure=SPHERE, width=2e-3,
                              budget_boxes=1e6, **asked)  # fmt: skip
        other = certified_share(PATTERN, limit, mask=users.mask, figure=SPHERE, width=2e-3,
                                budget_boxes=1e6, **asked)  # fmt: skip
        assert one.low <= other.high and other.low <= one.high
        assert one.width <= 2e-3 or one.stopped


@pytest.mark.slow
@pytest.mark.parametrize(("beam", "height"), [(BEAMS[0], 0.0), (BEAMS[1], 4e5), (BEAMS[2], 4e5)])
def test_shares_over_an_ellipsoid_hold_those_of_random_points(beam, height):
    mask, g, count = (0.05 if height == 0.0 else -0.2), np.random.default_rng(11), 20_000
    asked = {"beam": beam, "mask": mask, "figure": ELLIPSOID, "height": height}
    folds = certified_folds(PATTERN, [1, 2, 3, 4], width=1e-2, budget_boxes=1e6, **asked)
    good = certified_share(PATTERN, 8.0, width=2e-2, budget_boxes=2e5, **asked)
    # equal areas of the ellipsoid: by rejection
    b, e2 = (
        g.uniform(-np.pi / 2, np.pi / 2, 6 * count),
        1 - ELLIPSOID.polar_radius**2 / (ELLIPSOID.equatorial_radius**2),
    )
    dense = np.cos(b) / (1 - e2 * np.sin(b) ** 2) ** 2
    b = b[g.uniform(0, dense.max(), b.size) < dense][:count]
    up = direction(b, g.uniform(0, 2 * np.pi, b.size))
    normal = 1 / np.sqrt(1 - e2 * np.sin(b) ** 2)
    raised = height / ELLIPSOID.equatorial_radius
    places = up * np.stack([normal + raised, normal + raised, normal * (1 - e2) + raised], axis=1)
    r = positions_mci(PATTERN, g.uniform(0, 1e6, b.size)) / ELLIPSOID.equatorial_radius
    r = np.moveaxis(r, 0, 1)
    sight = r - places[:, np.newaxis]
    far = np.linalg.norm(sight, axis=-1)
    seen = np.einsum("psx,px->ps", sight, up) >= np.sin(mask) * far
    seen &= (sight * r).sum(axis=-1) >= np.cos(beam) * far * np.linalg.norm(r, axis=-1)
    h = np.concatenate([sight / far[..., np.newaxis], np.ones((*far.shape, 1))], axis=-1)
    matrix = np.einsum("psx,psy,ps->pxy", h, h, seen)
    pdop = np.sqrt(np.abs(np.trace(np.linalg.pinv(matrix)[:, :3, :3], axis1=1, axis2=2)))
    pdop[seen.sum(axis=1) < 4] = np.inf
    for fold, share in zip((1, 2, 3, 4), folds, strict=True):
        drawn = (seen.sum(axis=1) >= fold).mean()
        spread = 4 * np.sqrt(0.25 / b.size)
        assert share.low - spread <= drawn <= share.high + spread
    assert good.low - spread <= (pdop <= 8.0).mean() <= good.high + spread
    assert folds[0].high - folds[0].low <= 1e-2


@pytest.mark.slow
def test_the_worst_of_beams_is_seen_by_their_satellites_alone():
    wide = walker_delta(24, 4, 1, inclination_deg=60, radius_km=20000)
    found = certified_worst(
        wide, beam=np.radians(9.9), mask=0.0, figure=ELLIPSOID, budget_boxes=2e5
    )
    alone = certified_worst(wide, mask=0.0, figure=ELLIPSOID, budget_boxes=2e5)
    assert found.high >= alone.low
    assert found.witness.value == pytest.approx(found.low, rel=1e-6)
