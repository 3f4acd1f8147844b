"""Folds on circles of latitude against random sampling, proofs over bands, and invariances."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.core.circle import profile_range
from compass.coverage.certificate import prove_fold
from compass.coverage.circle import prove_circle, site_coverage_for_ever
from compass.coverage.region import latitude_band
from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.orbits import Constellation, states_mci
from compass.sites import Mask, Site

SPHERE, ELLIPSOID = FIGURES["iau-sphere"], FIGURES["iau-ellipsoid"]


def orbits(elements):
    """A constellation of rows a, e, i, raan, argument of periapsis, mean anomaly (SI)."""
    n = elements.shape[1]
    names = tuple(f"S{k}" for k in range(n))
    return Constellation("any", *elements, satellite_names=names)


def folds(c, site, longitude, phase):
    """Satellites over a site's horizon at inertial longitudes and phases (n,): by definition."""
    r, _ = states_mci(c, phase / c.mean_motion[0])
    seen = np.zeros(len(phase), dtype=int)
    for k, (angle, moment) in enumerate(zip(longitude, np.moveaxis(r, 1, 0), strict=True)):
        there = Site("u", site.latitude, float(angle), site.height, site.mask, site.figure)
        seen[k] = there.sees(moment).sum()
    return seen


@given(seed=st.integers(0, 10**6), figure=st.sampled_from([SPHERE, ELLIPSOID]))
@settings(max_examples=12, deadline=None)
def test_proofs_and_refutations_agree_with_random_samples(seed, figure):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(3, 13))
    c = orbits(
        np.stack(
            [
                np.full(n, rng.uniform(8e6, 3e7)),
                rng.uniform(0, 0.3, n) * (rng.random() < 0.5),
                *rng.uniform(0, np.pi, (1, n)),
                *rng.uniform(0, 2 * np.pi, (3, n)),
            ]
        )
    )
    azimuths = np.sort(rng.uniform(0, 2 * np.pi, 6))
    mask = Mask(tuple(azimuths), tuple(rng.uniform(0, 0.4, 6)))
    site = Site("a", rng.uniform(-1.5, 1.5), 0.3, rng.uniform(0, 3e5), mask, figure)
    sampled = folds(c, site, *rng.uniform(0, 2 * np.pi, (2, 400)))
    for fold in range(1, n + 1):
        proof = prove_circle(c, site, fold, smallest=1e-3, most=20_000)
        if proof.outcome == "proven":
            assert sampled.min() >= fold
        if proof.outcome == "refuted":
            at = folds(c, site, np.array([proof.longitude]), np.array([proof.phase]))
            assert at[0] < fold
            break
    # the least fold sampled is refuted one higher, or open where samples come close to it only
    higher = prove_circle(c, site, int(sampled.min()) + 1, smallest=1e-3, most=20_000)
    assert higher.outcome != "proven"


def walker(satellites, planes, phasing, inclination_deg, radius):
    k = np.arange(satellites)
    plane, slot = k // (satellites // planes), k % (satellites // planes)
    node = 2 * np.pi * plane / planes
    anomaly = 2 * np.pi * (slot * planes + phasing * plane) / satellites
    full = np.ones(satellites)
    return orbits(
        np.stack(
            [radius * full, 0 * full, np.radians(inclination_deg) * full, node, 0 * full, anomaly]
        )
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pattern", "latitude", "fold"),
    [((15, 5, 1, 45), 45, 4), ((12, 3, 1, 50), 30, 3), ((9, 3, 2, 20), 0, 2)],
)
def test_highest_mask_of_a_circle_is_that_of_a_thin_band(pattern, latitude, fold):
    """Two methods that share no kernel: cells between caps over a band, boxes on its middle."""
    c = walker(*pattern, 20427e3)
    b, wide = np.radians(latitude), 1e-4
    band = latitude_band(b - wide, b + wide)
    site = Site("a", float(b), 0.0, figure=SPHERE)
    low, high = 0.0, 1.0
    for _ in range(14):
        middle = 0.5 * (low + high)
        on_circle = prove_circle(c, site, fold, lift=middle, smallest=1e-4).outcome
        radius = SPHERE.equatorial_radius
        over_band = prove_fold(c, fold, sphere_radius=radius, mask=middle, region=band).outcome
        if high - low > 1e-3:  # the band is 1e-4 wide, and a mask moves less than a latitude
            assert on_circle == over_band
        low, high = (middle, high) if on_circle == "proven" else (low, middle)


def test_part_of_a_revolution_decides_where_the_pattern_repeats_in_it():
    c = walker(15, 5, 1, 45, 20427e3)
    for latitude, mask in ((0.8, 6.2), (0.8, 7.0), (0.3, 11.0)):
        site = Site("a", latitude, 0.0, mask=Mask.constant(np.radians(mask)), figure=SPHERE)
        whole = prove_circle(c, site, 4)
        part = prove_circle(c, site, 4, phases=2 * np.pi / 15)
        assert whole.outcome == part.outcome != "undecided"
        assert part.boxes <= whole.boxes


def test_a_horizon_open_to_one_side_counts_by_azimuth():
    """A wall to the south of 89 degrees: of a ring over the equator a northern site sees none."""
    c = walker(24, 1, 0, 0, 20427e3)
    wall = np.radians([0, 90.0, 90.1, 269.9, 270]), np.radians([0, 0, 89, 89, 0])
    site = Site("a", 0.5, 0.0, mask=Mask(*(tuple(x.tolist()) for x in wall)), figure=SPHERE)
    assert prove_circle(c, site, 1).outcome == "refuted"
    south = Site("a", -0.5, 0.0, mask=site.mask, figure=SPHERE)
    assert prove_circle(c, south, 5).outcome == "proven"


def test_what_hangs_on_a_hair_stays_undecided():
    """Two satellites always straight overhead of one another's places: seen at exactly the mask."""
    c = walker(1, 1, 0, 0, 2e7)
    site = Site("a", np.pi / 2, 0.0, figure=SPHERE)
    elevation = float(site.elevation_azimuth(np.array([2e7, 0.0, 0.0]))[0])
    assert elevation < 0
    proof = prove_circle(c, site, 1, lift=elevation, smallest=0.1)
    assert proof.outcome == "undecided" and np.isfinite(proof.longitude)
    assert prove_circle(c, site, 1, lift=elevation, most=10).boxes == 10
    assert prove_circle(c, site, 1, lift=elevation - 0.2, smallest=0.1).outcome == "proven"


@given(
    seed=st.integers(0, 10**6),
    azimuth=st.floats(-3.2, 3.2),
    turn=st.floats(0, 3.3),
    points=st.integers(1, 7),
)
@settings(max_examples=60, deadline=None)
def test_range_of_a_profile_is_what_dense_sampling_finds(seed, azimuth, turn, points):
    rng = np.random.default_rng(seed)
    azimuths = np.sort(rng.uniform(0, 2 * np.pi, points))
    elevations = rng.uniform(0, 1, points)
    mask = Mask(tuple(azimuths.tolist()), tuple(elevations.tolist()))
    bottom, top = profile_range(azimuths, elevations, azimuth, turn)
    around = azimuth + np.linspace(-turn, turn, 2001)
    nodes = azimuths[np.abs(np.mod(azimuths - azimuth + np.pi, 2 * np.pi) - np.pi) <= turn]
    sampled = mask.at(np.concatenate([around, nodes]))
    assert bottom <= sampled.min() + 1e-12 and top >= sampled.max() - 1e-12
    if turn < np.pi:
        assert bottom == pytest.approx(sampled.min(), abs=1e-9)
        assert top == pytest.approx(sampled.max(), abs=1e-9)


def test_bad_claims_are_told():
    c = walker(3, 1, 0, 0, 2e7)
    site = Site("a", 0.0, 0.0, figure=SPHERE)
    with pytest.raises(ArgumentError, match="fold = 0: must be a whole number from 1 on"):
        prove_circle(c, site, 0)
    mixed = orbits(np.array([[1e7, 2e7], *np.zeros((5, 2))]))
    with pytest.raises(ArgumentError, match="orbits of different periods: a claim for ever"):
        prove_circle(mixed, site, 1)


@pytest.mark.slow
def test_room_over_a_horizon_is_where_the_claim_fails():
    c = walker(15, 5, 1, 45, 20427e3)
    site = Site("a", 0.8, 0.0, mask=Mask.constant(np.radians(2.0)), figure=SPHERE)
    found = site_coverage_for_ever(c, site, 4)
    assert found.proof.outcome == "proven"
    assert prove_circle(c, site, 4, lift=found.room).outcome == "proven"
    # found to 1e-3, and less where 20,000 boxes do not decide
    assert prove_circle(c, site, 4, lift=found.room + 4e-3).outcome == "refuted"
    higher = Site("a", 0.8, 0.0, mask=Mask.constant(np.radians(30.0)), figure=SPHERE)
    assert site_coverage_for_ever(c, higher, 4).room is None


@pytest.mark.slow
def test_stations_of_a_design_are_told(designs):
    import compass

    found = compass.fold(designs / "compass-15-5-1.toml")
    told = found.to_dict()["stations"]
    assert [one["name"] for one in told] == [site.name for site in found.design.stations]
    # the globe's margin is 6.24 deg: no site can have less over a mask of 0
    assert all(one["outcome"] == "proven" and one["margin_deg"] > 6.23 for one in told)
    assert "above their own horizons, at any longitude" in str(found)
    assert compass.fold(designs / "compass-15-5-1.toml", region="lat:-10:10").sites == ()
