"""Proofs on the ellipsoid against plain geometry: the elevation over a site's own horizon."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import compass
from compass.core.certificate import Ground, caps_at
from compass.core.figure import stretched_caps
from compass.coverage.certificate import fold_range, prove_fold
from compass.coverage.fold import clearances
from compass.coverage.margin import highest_mask
from compass.coverage.motion import motion_of
from compass.coverage.region import GLOBE, latitude_band, read_region
from compass.coverage.symmetry import Span, shortest_span
from compass.frames import FIGURES, direction
from compass.orbits import keplerian, positions_mci, positions_mcmf
from compass.sites import Site

ELLIPSOID = FIGURES["iau-ellipsoid"]
#: The same, flattened ten times as much, so that what is wrong shows.
FLAT = replace(ELLIPSOID, polar_radius=0.94 * ELLIPSOID.equatorial_radius)
R = ELLIPSOID.equatorial_radius


def ring(**more):
    return compass.walker_delta(
        24, 1, 0, inclination_deg=0, orbit="areosynchronous", name="ring", **more
    )


def site_fold(c, figure, mask, time, latitude, longitude):
    """Satellites above the mask of a site, planetocentric, by the site's own frame."""
    site = Site("q", latitude, longitude, figure=figure)
    elevation, _ = site.elevation_azimuth(positions_mcmf(c, [time])[:, 0])
    return int((elevation >= mask).sum())


@settings(max_examples=40)
@given(st.floats(-1.5, 1.5), st.floats(0, 6.28), st.sampled_from([ELLIPSOID, FLAT]))
def test_clearance_is_the_elevation_of_a_site(latitude, longitude, figure):
    site = Site("q", latitude, longitude, figure=figure)
    r = np.array([[2e7, 3e6, -1e7], [-4e6, 5e6, 9e6], [1e6, -2e6, 6e7]])
    expected, _ = site.elevation_azimuth(r)
    point = direction(latitude, longitude)
    found = clearances(r, R, 0.1, point, figure.stretch) + 0.1
    assert found == pytest.approx(expected, abs=1e-12)


@settings(max_examples=60)
@given(
    st.floats(3.6e6, 4e7), st.floats(0, 0.3), st.floats(0, np.pi), st.floats(0, 6.28),
    st.floats(-1.4, 1.4), st.floats(0, 900.0), st.floats(-0.95, 0.9), st.floats(0.02, 1.9),
    st.sampled_from([ELLIPSOID, FLAT]), st.integers(0, 2**32 - 1),
)  # fmt: skip
def test_caps_bound_what_is_seen_in_a_band_for_a_while(
    periapsis, e, inclination, anomaly, mask, half, south, width, figure, seed
):
    """Inside the inner cap, less the stray, all see it; outside the outer one, none does."""
    c = keplerian(periapsis / (1 - e), e, inclination, 0.7, 0.3, anomaly)
    orbits, frame = motion_of(c, Span(0.0, 1.0, False, ""), GLOBE, about_pole=True)
    still = frame._replace(spin=0 * frame.spin)
    u, radius, stray = caps_at(orbits, still, R, 0.0, 0.0, half)
    outer = radius.copy()
    north = min(1.0, south + width)
    ground = Ground(R, figure.stretch, mask)
    stretched_caps(orbits, ground, half, south, north, u, radius, stray, outer)
    assert radius[0] <= outer[0]
    rng = np.random.default_rng(seed)
    side = np.linalg.svd(u)[2][1:]  # two directions across u[0]
    for time in (0.0, -half, 0.3 * half, half):
        wander = (stray[0] if time else 0.0) + 1e-9
        # points just inside the inner rim, and just outside the outer one: the closest calls
        for rim, sign in ((radius[0] - wander, 1.0), (outer[0] + wander, -1.0)):
            turn = rng.uniform(0, 2 * np.pi, 300)[:, np.newaxis]
            ring = np.cos(turn) * side[0] + np.sin(turn) * side[1]
            q = np.cos(rim) * u[0] + np.sin(rim) * ring
            q = q[(q[:, 2] >= south) & (q[:, 2] <= north)]
            if not 0.0 < rim < np.pi or not len(q):
                continue
            places = q / [1.0, 1.0, figure.stretch]
            places /= np.linalg.norm(places, axis=1, keepdims=True)
            seen = clearances(positions_mci(c, [time])[:, 0], R, mask, places, figure.stretch)[:, 0]
            assert np.all(sign * seen >= -1e-12)


def test_bounds_are_one_for_a_horizontal_mask_and_narrow_with_the_band():
    c = keplerian(2e7, 0.0, 0.8, 0.7, 0.0, 1.0)
    orbits, frame = motion_of(c, Span(0.0, 1.0, False, ""), GLOBE, about_pole=True)

    def width(mask, south, north):
        u, radius, stray = caps_at(orbits, frame, R, 0.0, 0.0, 0.0)
        outer = radius.copy()
        ground = Ground(R, ELLIPSOID.stretch, mask)
        stretched_caps(orbits, ground, 0.0, south, north, u, radius, stray, outer)
        return outer[0] - radius[0]

    assert width(0.0, -1.0, 1.0) < 1e-13
    assert width(0.3, 0.5, 0.5001) < 1e-3 * width(0.3, -1.0, 1.0) < 0.01


def test_the_ring_whose_users_miss_the_second_satellite():
    """On the sphere two-fold; on the ellipsoid the second stands at 35.076 deg, below 35.129."""
    c, mask = ring(), np.radians(35.129)
    claim = {"sphere_radius": R, "mask": mask, "region": read_region("lat:-45:45")}
    assert prove_fold(c, 2, **claim).outcome == "proven"
    found = prove_fold(c, 2, **claim, stretch=ELLIPSOID.stretch)
    assert found.outcome == "refuted"
    w = found.witness
    assert abs(np.degrees(w.latitude)) <= 45 + 1e-9
    assert w.fold == site_fold(c, ELLIPSOID, mask, w.time, w.latitude, w.longitude) == 1
    # turned so that the same user is found below the same satellites
    assert any(
        site_fold(c, ELLIPSOID, mask, t, np.radians(44.95), np.radians(3.5)) < 2
        for t in np.linspace(0, 88000, 400)
    )


@settings(max_examples=8)
@example((9, 3, 2), 35.0, 0.21875, FLAT, 0)  # a moment all but broken comes before one that is
@given(
    st.sampled_from([(6, 3, 1), (9, 3, 2), (10, 5, 3)]), st.floats(35, 80), st.floats(0.0, 0.25),
    st.sampled_from([ELLIPSOID, FLAT]), st.integers(0, 2**32 - 1),
)  # fmt: skip
@pytest.mark.slow
def test_the_range_is_that_of_sites(counts, inclination_deg, mask, figure, seed):
    """No site, anywhere or at any time, sees fewer than the least or more than the greatest."""
    c = compass.walker_delta(*counts, inclination_deg=inclination_deg, orbit="areosynchronous")
    (low, reached), (high_reached, high) = fold_range(
        c, sphere_radius=R, mask=mask, stretch=figure.stretch
    )
    assert low <= reached and high_reached <= high
    rng = np.random.default_rng(seed)
    places = direction(np.arcsin(rng.uniform(-1, 1, 4000)), rng.uniform(0, 2 * np.pi, 4000))
    for time in rng.uniform(0, 88000, 10):
        fold = (
            clearances(positions_mci(c, [time])[:, 0], R, mask, places, figure.stretch) >= 0
        ).sum(axis=1)
        assert low <= fold.min() and fold.max() <= high
    claim = {"sphere_radius": R, "mask": mask, "stretch": figure.stretch}
    above = prove_fold(c, reached + 1, **claim)
    assert above.outcome == "refuted"
    w = above.witness
    assert site_fold(c, figure, mask, w.time, w.latitude, w.longitude) == w.fold <= reached


@pytest.mark.slow
@pytest.mark.parametrize("region", [GLOBE, latitude_band(0.2, 1.1)], ids=["globe", "band"])
def test_the_highest_mask_is_proven_and_the_next_is_not(region):
    c = compass.walker_delta(8, 4, 1, inclination_deg=52, orbit="areosynchronous")
    span, claim = shortest_span(c, region), {"sphere_radius": R, "region": region}
    flat = highest_mask(c, 1, **claim, span=span, stretch=ELLIPSOID.stretch, tolerance=1e-5)
    assert prove_fold(c, 1, **claim, mask=flat, stretch=ELLIPSOID.stretch).outcome == "proven"
    above = prove_fold(c, 1, **claim, mask=flat + 2e-5, stretch=ELLIPSOID.stretch)
    assert above.outcome == "refuted"
    w = above.witness
    assert site_fold(c, ELLIPSOID, flat + 2e-5, w.time, w.latitude, w.longitude) == 0
    assert abs(flat - highest_mask(c, 1, **claim, span=span)) > 1e-5


def test_a_region_keeps_its_points_when_it_is_stretched():
    rng = np.random.default_rng(1)
    places = direction(np.arcsin(rng.uniform(-1, 1, 3000)), rng.uniform(0, 2 * np.pi, 3000))
    q = places * [1.0, 1.0, FLAT.stretch]
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    for text in ("lat:-20:45", "lat:30:90", "polygon:0,0;0,60;50,30"):
        region = read_region(text)
        inside = region.contains(places)
        assert 0 < inside.sum() < 3000
        np.testing.assert_array_equal(region.stretched(FLAT.stretch).contains(q), inside)
