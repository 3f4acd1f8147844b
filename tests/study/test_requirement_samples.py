"""Samples of geometry against one site at a time, and that they are where the users are."""

from dataclasses import replace

import numpy as np
import pytest

from compass import Requirement, walker_delta
from compass.coverage.certified_witness import dilution_at
from compass.coverage.region import read_region
from compass.coverage.samples import points_in, stand
from compass.coverage.users import Users, region_users, site_users
from compass.frames import FIGURES, direction, planetocentric_latitude, prime_meridian_angle
from compass.orbits import areosynchronous_radius, keplerian
from compass.orbits.motion import Motion
from compass.sites import Mask, Site
from compass.study import requirement_samples as module

PDOP = Requirement("a", limits=(("pdop", 3.0),), share=0.5)
SPHERE, ELLIPSOID = FIGURES["iau-sphere"], FIGURES["iau-ellipsoid"]


def sampled(c, users, wanted):
    """Share of moments and worst over its limit of one constellation."""
    share, worst = np.ones(1), np.zeros(1)
    moments = module.moments_of(c, users, wanted)
    moments.look(c, c.inclination[:1].copy(), np.zeros(1), share, worst)
    return share[0], worst[0]


def fifteen(**orbit):
    return walker_delta(15, 5, 1, inclination_deg=45, **(orbit or {"radius_km": 12000}))


@pytest.mark.parametrize("figure", [SPHERE, ELLIPSOID])
def test_a_place_over_the_figure_is_that_of_a_site(figure):
    latitude = np.linspace(-1.5, 1.5, 7)
    users = Users("", -1.5, 1.5, figure, Mask(), height=3e3)
    places = stand(users, latitude, direction(latitude, np.zeros(7)))
    for b, place in zip(latitude, places, strict=True):
        centric = float(planetocentric_latitude(b, figure))
        assert Site("", centric, 0.0, 3e3, figure=figure).r_mcmf == pytest.approx(place, abs=1e-6)


@pytest.mark.parametrize("figure", [SPHERE, ELLIPSOID])
def test_a_site_under_closed_tracks_is_sampled_where_it_stands(figure, monkeypatch):
    """By the inverse of the normal matrix in the Mars-fixed frame, one moment at a time."""
    monkeypatch.setattr(module, "SAMPLES", 20)
    c = fifteen(repeat=(3, 1))
    site = Site("s", 0.7, 0.3, 2e3, Mask.constant(0.1), figure)
    share, worst = sampled(c, site_users(site), PDOP)
    times, *_ = module._moments(c, site_users(site), np.random.default_rng(0))
    found = np.array([dilution_at(c, site, t, Motion(), "pdop")[0] for t in times])
    assert share == np.mean(found <= 3.0)
    assert worst == pytest.approx(found.max() / 3.0, rel=1e-5)


def test_users_of_a_polygon_are_sampled_inside_it_alone(monkeypatch):
    """Six that hang over it are in view of all of it, and of nobody on the other side."""
    text = "polygon:-20,-30;-20,30;20,30;20,-30"
    region = read_region(text)
    points = points_in(region, np.random.default_rng(1), module.SAMPLES)
    assert len(points) == module.SAMPLES
    assert region.contains(points).all()
    # of equal chance: halves by the middle meridian and the equator
    for axis in (1, 2):
        assert abs(np.mean(points[:, axis] > 0) - 0.5) < 4 * 0.5 / np.sqrt(module.SAMPLES)
    nodes, along = np.array([0, 1, 2, 3, 4, 5.0]), np.radians([-25, -15, -5, 5, 15, 25])
    still = keplerian(
        areosynchronous_radius(), 0.0, 0.35, nodes, 0.0,
        along + prime_meridian_angle(0.0, 0.0) - nodes, repeat=(1, 1),
    )  # fmt: skip
    users, rough = (
        region_users(region, SPHERE, Mask()),
        Requirement("r", limits=(("pdop", 1e4),), share=0.5),
    )
    assert sampled(still, users, rough)[0] == 1.0
    assert sampled(replace(still, repeat=None), users, rough)[0] < 0.6


def in_matrices(c, moments):
    """Largest dilution over its limit, a matrix a moment; infinite below the fold."""
    profile, found = moments.users.mask, []
    for row in moments.rows:
        eye, axes = row[:3], row[3:12].reshape(3, 3)
        phase = np.arctan2(row[13], row[12]) + c.mean_anomaly
        node, tilt = c.raan, c.inclination
        x = np.cos(node) * np.cos(phase) - np.sin(node) * np.cos(tilt) * np.sin(phase)
        y = np.sin(node) * np.cos(phase) + np.cos(node) * np.cos(tilt) * np.sin(phase)
        r = c.semi_major_axis[0] * np.stack([x, y, np.sin(tilt) * np.sin(phase)], axis=1)
        local = (r - eye) @ axes.T
        local /= np.linalg.norm(local, axis=1, keepdims=True)
        azimuth = np.mod(np.arctan2(local[:, 0], local[:, 1]), 2 * np.pi)
        seen = local[np.arcsin(local[:, 2]) >= profile.at(azimuth)]
        if len(seen) < moments.fold:
            found.append(np.inf)
            continue
        rows = np.column_stack([seen, np.ones(len(seen))])
        d = np.diagonal(np.linalg.inv(rows.T @ rows))
        known = {"pdop": d[:3].sum(), "gdop": d.sum(), "hdop": d[:2].sum(), "tdop": d[3]}
        found.append(max(np.sqrt(known[k]) / limit for k, limit in moments.wanted.limits))
    return np.array(found)


@pytest.mark.parametrize("horizon", [Mask.constant(0.1), Mask.of([(0, 3), (100, 25), (250, 0)])])
def test_samples_are_those_of_a_matrix_a_moment(horizon, monkeypatch):
    monkeypatch.setattr(module, "SAMPLES", 30)
    users = region_users(read_region("lat:-40:60"), ELLIPSOID, horizon)
    limits = (("pdop", 2.8), ("hdop", 1.8), ("gdop", 4.0), ("tdop", 2.5))
    wanted = Requirement("a", fold=5, limits=limits, share=0.5)
    c = fifteen()
    moments = module.moments_of(c, users, wanted)
    inclinations, nodes = np.radians([20.0, 45.0, 66.0]), np.array([0.0, 0.3, 1.1])
    share, worst = np.ones(3), np.zeros(3)
    moments.look(c, inclinations, nodes, share, worst)
    for k in range(3):
        turned = walker_delta(15, 5, 1, inclination_deg=float(np.degrees(inclinations[k])),
                              raan_deg=float(np.degrees(nodes[k])), radius_km=12000)  # fmt: skip
        found = in_matrices(turned, moments)
        assert share[k] == np.mean(found <= 1.0)
        assert worst[k] == pytest.approx(found.max(), rel=1e-6)
    # of what is wanted always the first miss is enough, and those refuted are not looked at again
    always = replace(moments, wanted=replace(wanted, share=1.0))
    again, most = share.copy(), worst.copy()
    again[0] = 0.0
    always.look(c, inclinations, nodes, again, most)
    assert np.array_equal(again, np.where(share == 1.0, 1.0, 0.0) * (np.arange(3) > 0))
    assert most[0] == worst[0]


@pytest.mark.parametrize(
    ("share", "wanted", "hopeless"),
    [
        (0.9975, 1.0, True),
        (1.0, 1.0, False),
        (0.9, 0.95, True),
        (0.93, 0.95, False),
        (1.0, 0.0, False),
    ],
)
def test_only_what_chance_cannot_excuse_is_hopeless(share, wanted, hopeless):
    assert module.is_hopeless(np.array([share]), wanted).tolist() == [hopeless]
