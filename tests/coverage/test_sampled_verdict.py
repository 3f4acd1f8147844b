"""Verdicts by samples: against bounds that are proven, maps of levels, and places one by one."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binomtest

import compass
from compass.coverage import sampled_verdict as module
from compass.coverage.certified_effort import Effort
from compass.coverage.fold_verdict import course_of, users_of
from compass.coverage.geometry_verdict import geometry_verdict
from compass.coverage.grid import make_grid
from compass.coverage.moving import sights_along, standing
from compass.coverage.protection import LEVELS, protection_map
from compass.coverage.sampled_verdict import sampled_verdict
from compass.coverage.verdict import both
from compass.coverage.view import view
from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import mcmf_from_mci, prime_meridian_angle
from compass.integrity import Integrity
from compass.orbits import states_mci, walker_delta
from compass.ranging import Receiver, Signal
from compass.requirement import Requirement
from compass.signal.ranges import radial_along_cross, range_errors
from compass.sites import Mask, Site
from compass.study.requirement_question import Question

PROMISE = Integrity(alert_horizontal=100.0, alert_vertical=200.0)


@pytest.fixture(scope="module")
def design():
    c = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
    signal = Signal(ephemeris=(2, 8, 5), clock_sigma=3, receiver=Receiver(0.5, 0.5), ionosphere=1.0)
    return Design(
        c, "d", figure="kelly2018-sphere", mask=Mask.constant(np.radians(5)), signal=signal,
        integrity=PROMISE,
    )  # fmt: skip


def sampled(design, requirement, name, limit, days=None):
    course = course_of(design, days, 0.0)
    everyone = users_of(design, requirement)
    return sampled_verdict(design, requirement, name, limit, everyone, [((), 1)], course)


@pytest.mark.parametrize(("kept", "count"), [(0, 50), (37, 50), (50, 50)])
def test_bounds_are_those_of_clopper_and_pearson(design, kept, count):
    asked = module._Samples(design, "pdop", 6.0, None, (), course_of(design, None, 0.0))
    asked.count, asked.broken = count, count - kept
    known = binomtest(kept, count).proportion_ci(1 - 2 * module.DOUBT, "exact")
    assert (asked.low, asked.high) == pytest.approx((known.low, known.high), rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "limit"), [("gdop", 3.0), ("error_position_m", 10.0)])
def test_shares_of_samples_are_those_between_proven_bounds(monkeypatch, design, name, limit):
    """The ground and its ionosphere too: the Sun is somewhere between overhead and set."""
    monkeypatch.setattr(module, "FIRST", 8192)
    wanted = Requirement("g", regions=("lat:-40:10",), limits=((name, limit),), share=0.2,
                         share_of="area-time")  # fmt: skip
    proven = geometry_verdict(design, wanted, name, limit, effort=Effort(width=2e-2))
    found = sampled(design, wanted, name, limit)
    assert found.evidence == "sampled" and found.met is proven.met is True
    assert found.share[0] < proven.share[1] and found.share[1] > proven.share[0]
    assert found.share[1] - found.share[0] < 0.05
    as_95 = replace(wanted, error_as="95-percent")
    limit_95 = limit * 1.959964 if name.startswith("error") else limit
    assert sampled(design, as_95, name, limit_95).share == pytest.approx(found.share, abs=1e-3)


def test_levels_at_places_are_those_of_the_map(design):
    """Every cell of one epoch: the map keeps levels in single precision."""
    times, grid = [1234.0], make_grid("equal-angle", 45)
    seen = view(design.constellation, times, design.figure.equatorial_radius, design.mask)
    made = protection_map(seen, grid, range_errors(design, times), PROMISE, workers=1)
    for i, latitude in enumerate(grid.latitude):
        for j, longitude in enumerate(grid.longitude):
            mover = standing(Site("s", latitude, longitude, 0.0, design.mask, design.figure), 1)
            sights = sights_along(design, mover, np.array(times))
            for name in LEVELS:
                there = float(made[name].sel(percentile=50).values[i, j])
                assert module._values(design, name, mover, sights) == pytest.approx(there, rel=2e-5)


@pytest.mark.slow
def test_orbiters_errors_are_the_inverse_of_their_normal_matrix(design):
    """A shell at 400 km that looks down to 20 degrees below its level; the worst, by hand."""
    wanted = Requirement("low", altitude=4e5, mask=np.radians(-20), limits=(("pdop", 1.5),))
    found = sampled(design, wanted, "error_position_m", 5.0)
    assert (found.met, found.evidence) == (False, "sampled")
    worst = found.worst
    place = Site("s", worst.latitude, worst.longitude, 4e5, figure=design.figure)
    c = design.constellation
    r, v = (x[:, 0] for x in states_mci(c, [worst.time]))
    angle = prime_meridian_angle(c.epoch, worst.time)
    axes = np.moveaxis(radial_along_cross(r, v), 1, 0)
    line = mcmf_from_mci(r, angle) - place.r_mcmf
    u = line / np.linalg.norm(line, axis=1, keepdims=True)
    seen = u @ place.enu_mcmf[2] >= np.sin(np.radians(-20))
    along = np.stack([(mcmf_from_mci(axis, angle) * u).sum(axis=1) for axis in axes])
    variance = (np.array([2.0, 8.0, 5.0])[:, None] * along) ** 2
    variance = variance.sum(axis=0) + 3.0**2 + 1.0**2  # the receiver's noise at the zenith
    rows = np.column_stack([u, np.ones(len(u))])[seen]
    covariance = np.linalg.inv(rows.T @ (rows / variance[seen][:, None]))
    assert worst.value == pytest.approx(np.sqrt(np.trace(covariance[:3, :3])), rel=1e-6)
    assert "as of orbiters" in found.scope


@pytest.mark.slow
def test_samples_refute_an_always_and_prove_none(monkeypatch, design):
    monkeypatch.setattr(module, "MOST", 2 * module.FIRST)
    wanted = Requirement("h", regions=("lat:-5:5",))
    level = "protection_horizontal_m"
    missed = sampled(design, wanted, level, 1.0)
    assert missed.met is False and missed.worst.value > 1.0 and missed.worst.of == level
    left = sampled(design, wanted, "hdop", 1e9)
    assert left.met is None and left.share[1] == 1.0
    assert "0 of 8192 samples break it" in left.reason and "no always" in left.reason


@pytest.mark.slow
def test_of_every_place_of_an_area_samples_tell_too_little(design):
    """The mean of all places refutes the worst; at a site the moments are of it alone."""
    wanted = Requirement("v", regions=("lat:-30:30",), share=0.5)
    level = "protection_vertical_m"
    assert sampled(design, wanted, level, 1.0).met is False
    assert "of all places together" in sampled(design, wanted, level, 1e9).reason
    site = compass.Site.of("S", latitude_deg=1, longitude_deg=10, figure=design.figure)
    there = replace(wanted, regions=(), sites=(site,))
    assert sampled(design, there, level, 1e9).met is True
    assert sampled(design, replace(wanted, share_of="area-time"), level, 1e9).met is True


@pytest.mark.slow
def test_parts_of_an_area_make_its_mean_and_halves_of_a_requirement_are_no_better(design):
    """Two bands: where one falls short the mean may not; what is sampled stays sampled."""
    level = "protection_vertical_m"
    two = Requirement("two", regions=("lat:20:26", "lat:60:66"), share=0.3, share_of="area-time")
    each = [sampled(design, replace(two, regions=(one,)), level, 120.0) for one in two.regions]
    assert [one.met for one in each] == [True, False]
    assert sampled(design, two, level, 120.0).met is None
    assert sampled(design, replace(two, share_of="time"), level, 120.0).met is False
    proven = replace(each[0], evidence="proven")
    assert both(proven, each[0]).evidence == "sampled"


@pytest.mark.slow
def test_a_lost_satellite_is_not_seen(design):
    """As without it from the start; covariances stay those of the satellites that are left."""
    wanted = Requirement("h", share=0.5, share_of="area-time", losses=1)
    level, course = "protection_horizontal_m", course_of(design, None, 0.0)
    everyone = users_of(design, wanted)
    name = design.constellation.satellite_names[4]
    lost = sampled_verdict(design, wanted, level, 80.0, everyone, [((name,), 15)], course)
    left = replace(design, constellation=design.constellation.without((4,)))
    alone = sampled_verdict(left, wanted, level, 80.0, everyone, [((), 1)], course)
    assert lost.share == pytest.approx(alone.share, abs=2e-3) and lost.lost == (name,)


def test_what_is_missing_is_told(design):
    wanted = Requirement.of("p", protection_horizontal_m_at_most=50, share=0.9)
    assert (
        wanted.claim
        == "horizontal protection level at most 50 m, for 90 % of the time, all of Mars"
    )
    for gone, message in (("integrity", "integrity: missing"), ("signal", "signal: missing")):
        bare = replace(design, **{gone: None}, requirements=(wanted,))
        with pytest.raises(ArgumentError, match=message):
            compass.check(bare)
    open_ = geometry_verdict(design, wanted, *wanted.limits[0])  # as drift and studies ask
    assert open_.met is None and "not certified, but sampled" in open_.reason
    with pytest.raises(ArgumentError, match="is sampled, by compass check alone; to search ask"):
        Question(
            (wanted,), design.figure, design.mask, 2e7, None, 0.0, ("walker-delta",), 20,
        )  # fmt: skip
