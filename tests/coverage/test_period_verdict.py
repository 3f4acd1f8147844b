"""What parts of a constellation keep for ever by themselves, and closed tracks together."""

from dataclasses import replace

import numpy as np
import pytest

from compass import Requirement, Site, check, from_elements, walker_delta
from compass.coverage.fold_verdict import course_of
from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import prime_meridian_angle
from compass.orbits import positions_mcmf
from compass.orbits.motion import Motion

SITE = Site("east", 0.1, 1.0)
DAY = 88642.66


def hovering(satellites=5, degrees=0.0):
    """A ring that stands over the equator: each satellite over its own longitude."""
    return walker_delta(
        satellites, 1, 0, inclination_deg=0, orbit="areosynchronous", phase_deg=degrees
    )


def low(satellites=2):
    return from_elements(
        semi_major_axis_km=np.linspace(3700, 3800, satellites),
        inclination_deg=80,
        satellite_names=[f"low {k}" for k in range(satellites)],
    )


def verdict(c, asked, **options):
    (found,) = check(Design(c, name="net", requirements=(asked,)), **options).verdicts
    return found


def test_each_satellite_keeps_after_what_its_track_closes():
    joint = hovering() + low()
    assert (joint.repeat, joint.rotations) == (None, None)
    assert joint.each_repeat == ((1, 1),) * 5 + (None,) * 2
    assert joint.without([5, 6]).repeat == (1, 1) and joint.without(range(5)).repeat is None
    both = hovering() + walker_delta(3, 3, 1, inclination_deg=20, repeat=(3, 2))
    assert (both.repeat, both.rotations) == (None, 2)
    assert hovering().rotations == 1 and (hovering() + hovering(3, 7)).repeat == (1, 1)
    with pytest.raises(ArgumentError, match="repeats: 1 for 5 satellites"):
        replace(hovering(), repeats=((1, 1),))


def test_a_ring_that_stands_still_serves_its_own_place_beside_low_orbiters():
    """With one of five overhead its neighbours stand above 5 degrees too; between two, two do."""
    asked = Requirement("still", sites=(SITE,), fold=3, mask=np.radians(5))
    overhead = np.degrees(SITE.longitude + prime_meridian_angle(0.0, 0.0))
    alone = hovering(5, overhead % 360)
    kept = verdict(alone, asked)
    assert kept.met is True and verdict(hovering(5, (overhead + 36) % 360), asked).met is False
    joint = verdict(alone + low(), asked)
    assert (joint.met, joint.evidence, joint.margin) == (True, "proven", kept.margin)
    assert joint.scope.startswith("by 5 satellites at 20427.7 km alone; for ever")
    assert "at the place" in joint.scope
    # were nothing said of their tracks, its whole circle would count
    unsaid = replace(alone, repeat=None)
    assert verdict(unsaid, asked).met is False and verdict(unsaid + low(), asked).met is not True


@pytest.mark.parametrize("limit", ["pdop", "gdop", "tdop"])
def test_geometry_of_a_part_bounds_that_of_all(limit):
    c = walker_delta(9, 9, 3, inclination_deg=35, orbit="areosynchronous", raan_deg=20)
    asked = Requirement("fix", sites=(SITE,), limits=((limit, 9.0),), share=0.2)
    part, joint = verdict(c, asked), verdict(c + low(), asked)
    assert part.met is joint.met is True
    assert joint.share == (part.share[0], 1.0)
    # of a share that it has not, its lower bound still is one of all
    more = verdict(c + low(), replace(asked, share=0.999999))
    assert more.met is None and part.share[0] - 1e-3 <= more.share[0] <= part.share[1]
    assert "9 satellites at 20427.7 km miss it, kept for" in more.reason
    assert "have too few" in more.reason and "give days" in more.reason


def test_a_miss_of_geometry_soon_is_one_for_ever():
    asked = Requirement("fix", sites=(SITE,), limits=(("pdop", 1.2),))
    found = verdict(hovering() + low(), asked)
    assert (found.met, found.evidence) == (False, "proven") and "over 2 days" in found.scope


def test_closed_tracks_of_two_periods_count_together_at_the_place():
    """Against every moment of the rotations after which both are where they began."""
    c = walker_delta(5, 5, 1, inclination_deg=25, orbit="areosynchronous") + walker_delta(
        4, 4, 1, inclination_deg=25, repeat=(2, 1), raan_deg=30
    )
    course = course_of(Design(c), None, 0.0)
    assert course.for_ever and course.span[1] == pytest.approx(DAY, abs=1)
    assert "close after 1 rotation of Mars" in course.words
    asked = Requirement("net", sites=(SITE,), fold=2, mask=0.0)
    times = np.linspace(0, 3 * DAY, 20_000)
    toward = positions_mcmf(c, times) - SITE.r_mcmf
    sines = toward @ SITE.enu_mcmf[2] / np.linalg.norm(toward, axis=-1)
    for fold in (1, 2, 3, 4, 5):
        least = np.degrees(np.arcsin(np.sort(sines, axis=0)[-fold]).min())
        found = verdict(c, replace(asked, fold=fold))
        assert found.met is bool(least > 0)
        if found.met:
            assert np.degrees(found.margin) <= least + 1e-6


@pytest.mark.slow
def test_belts_of_two_periods_are_asked_over_all_of_their_rotations():
    """The joint share at the latitudes of a band, against random places and moments."""
    c = walker_delta(5, 5, 1, inclination_deg=25, orbit="areosynchronous") + walker_delta(
        4, 4, 1, inclination_deg=25, repeat=(4, 3), raan_deg=30
    )
    limits = (("pdop", 5.0),)
    asked = Requirement(
        "band", regions=("lat:-20:20",), limits=limits, share=0.5, share_of="area-time"
    )
    found = verdict(c, asked, budget_s=2.0)
    rng = np.random.default_rng(1)
    n, times = 400, rng.uniform(0, 1e8, 400)
    north, east = np.arcsin(rng.uniform(-1, 1, n) * np.sin(np.radians(20))), rng.uniform(0, 7, n)
    r, good = positions_mcmf(c, times), 0
    for k in range(n):
        site = Site("", float(north[k]), float(east[k]))
        toward = r[:, k] - site.r_mcmf
        toward /= np.linalg.norm(toward, axis=1)[:, np.newaxis]
        rows = toward[toward @ site.enu_mcmf[2] > 0]
        rows = np.column_stack([rows, np.ones(len(rows))])
        if len(rows) >= 4 and np.linalg.matrix_rank(rows) == 4:
            good += np.sqrt(np.trace(np.linalg.inv(rows.T @ rows)[:3, :3])) <= 5.0
    spread = 4 * 0.5 / np.sqrt(n)  # four sigmas of a share
    assert found.share[0] - spread <= good / n <= found.share[1] + spread
    assert found.share[1] - found.share[0] < 0.05


def test_nodes_that_drift_apart_are_parts_under_j2():
    """Of two inclinations at one radius each keeps its shape, not both together."""
    rings = [
        walker_delta(9, 9, 2, inclination_deg=i, radius_km=20000, phase_deg=i) for i in (30, 50)
    ]
    rings[1] = replace(rings[1], satellite_names=tuple(f"b{k}" for k in range(9)))
    asked = Requirement("some", sites=(SITE,), fold=2)
    design = Design(rings[0] + rings[1], motion=Motion("j2"), requirements=(asked,))
    assert course_of(design, None, 0.0) is None
    (found,) = check(design).verdicts
    assert found.met is True and "by 9 satellites at 20000 km alone" in found.scope
