"""Errors in metres between proven bounds: against fixes written out, and an independent bracket."""

import math
from dataclasses import replace

import numpy as np
import pytest

from compass import Requirement, check
from compass.coverage.certificate import Outcome
from compass.coverage.certified_effort import Effort
from compass.coverage.certified_places import Spot
from compass.coverage.certified_ranges import ranges_of, skies_of
from compass.coverage.certified_share import CertifiedShare, certified_share
from compass.coverage.certified_witness import WorstWitness, dilution_at
from compass.coverage.certified_worst import (
    CertifiedAlways,
    certified_always,
    certified_worst,
)
from compass.coverage.errors import error_map
from compass.coverage.geometry_verdict import geometry_verdict
from compass.coverage.grid import make_grid
from compass.coverage.view import view
from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import mcmf_from_mci, prime_meridian_angle
from compass.links import Radio
from compass.orbits import walker_delta
from compass.orbits.constellation import keplerian
from compass.orbits.motion import Motion
from compass.ranging import FACTOR_95, Receiver, Signal
from compass.signal.ranges import range_errors
from compass.sites import Mask, Site

PLAIN = Signal(ephemeris=(2, 8, 5), clock_sigma=3, receiver=Receiver(0.5, 0.5))
#: Radial and clock tied together, along-track to nothing; a loop, an ionosphere, shared errors.
TIED = ((4.0, 0, 0, -3), (0, 64.0, 0, 0), (0, 0, 25.0, 0), (-3, 0, 0, 9.0))
RICH = Signal(
    frequency=4e8, covariance=(TIED,), common_time=2.0, common_orientation=1e-6,
    receiver=Receiver(0.3, 0.4, 300.0), ionosphere=2.0,
)  # fmt: skip
RADIO = Radio(("satellite", "station"), 4e8, 0.0, -25.0, 30.0)


def design(t=15, p=5, f=1, inclination=45.0, signal=PLAIN, mask=5.0, **more):
    c = walker_delta(t, p, f, inclination_deg=inclination, radius_km=20427)
    figure = more.pop("figure", "kelly2018-sphere")
    return Design(c, figure=figure, mask=Mask.of(mask), signal=signal, radios=(RADIO,), **more)


def asked(d, name="error_position_m", **more):
    return {
        "dop": name, "ranges": ranges_of(d), "figure": d.figure, "mask": d.mask,
        "motion": d.motion,
    } | more  # fmt: skip


def written_out(d, ranges, place, time, name, motion):
    """An error by the normal equations of a fix, its ranges' variances term by term."""
    c, figure = d.constellation, d.figure
    site = Site("", *place, 0.0, d.mask, figure)
    r, v = (x[:, 0] for x in motion.states(c, [time]))
    angle = prime_meridian_angle(c.epoch, time)
    rows = []
    for k in np.flatnonzero(site.sees(mcmf_from_mci(r, angle))):
        cross = np.cross(r[k], v[k])
        radial, cross = r[k] / np.linalg.norm(r[k]), cross / np.linalg.norm(cross)
        axes = np.stack([radial, np.cross(cross, radial), cross])
        sight = mcmf_from_mci(r[k], angle) - site.r_mcmf
        far = np.linalg.norm(sight)
        unit = sight / far
        x = np.append(axes @ mcmf_from_mci(unit, -angle), 1.0)
        noise, zenith, a, b, delay2, shell2 = ranges.numbers
        sine, d2 = unit @ site.enu_mcmf[2], (far / figure.equatorial_radius) ** 2
        square = x @ ranges.covariance[k] @ x + (noise + zenith / sine) ** 2
        square += a * d2 + b * d2**2 + delay2 / (1 - shell2 * (1 - sine**2))
        rows.append(np.append(unit, 1.0) / math.sqrt(square))
    if len(rows) < 4:
        return math.inf
    inverse = np.linalg.inv(np.array(rows).T @ np.array(rows))
    up = site.enu_mcmf[2]
    vertical, position = up @ inverse[:3, :3] @ up, np.trace(inverse[:3, :3])
    squares = {
        "error_horizontal_m": position - vertical + 2 * ranges.shared,
        "error_vertical_m": vertical,
        "error_position_m": position + 2 * ranges.shared,
        "error_time_m": inverse[3, 3] + ranges.shared_time,
    }
    return math.sqrt(squares[name])


@pytest.mark.slow
def test_a_bracket_found_elsewhere():
    """0.9464 to four digits, by a program of others, for this constellation and these errors."""
    d = design()
    found = certified_share(d.constellation, 30.0, width=1e-3, **asked(d))
    assert found.low <= 0.94645 and found.high >= 0.94635 and found.width <= 1e-3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("signal", "name"), [(PLAIN, "error_horizontal_m"), (RICH, "error_vertical_m")]
)
def test_shares_are_those_of_a_map_at_random_moments(signal, name):
    """Under a Sun that stands where it does, between that of one overhead and of none."""
    d = design(14, 7, 1, 55.0, signal, figure="iau-ellipsoid")
    times = np.random.default_rng(4).uniform(0, 1e7, 60)
    grid = make_grid("equal-angle", 5.0, d.figure.polar_radius / d.figure.equatorial_radius)
    limit = {"error_horizontal_m": 8.0, "error_vertical_m": 40.0}[name]
    shares = []
    for some in np.split(times, 6):  # moments are independent, so that their parts are
        seen = view(d.constellation, some, d.figure.equatorial_radius, d.mask)
        mapped = error_map(seen, grid, range_errors(d, some), limit=limit, workers=1)
        shares.append(float(mapped.cells_error_share.sel(error=name)))
    share, doubt = np.mean(shares), 4 * np.std(shares, ddof=1) / np.sqrt(6) + 3e-3
    options = asked(d, name)
    least = certified_share(d.constellation, limit, width=3e-3, **options)
    most = certified_share(
        d.constellation, limit, width=3e-3, **options | {"ranges": ranges_of(d, "set")}
    )
    assert "half turns" in least.scope and 0.3 < share < 0.99
    assert least.low - doubt <= share <= most.high + doubt
    if signal is PLAIN:
        assert abs(share - least.value) <= doubt and doubt < 0.03


@pytest.mark.parametrize("motion", ["two-body", "j2"])
def test_the_largest_error_at_a_place_is_that_of_dense_moments(motion):
    """At a place over some hours, of ellipses too, whose axes do not turn evenly."""
    n = 24
    c = keplerian(
        np.full(n, 2e7), np.full(n, 0.05), np.full(n, 0.9), np.repeat([0.0, 2.1, 4.2], 8),
        np.full(n, 1.0), np.tile(np.arange(8) * np.pi / 4, 3) + 0.1,
    )  # fmt: skip
    d = Design(c, mask=Mask(), signal=RICH, radios=(RADIO,), motion=Motion(motion))
    here, name = (0.5, 1.0), "error_vertical_m"
    options = asked(d, name, place=Spot(*here), since=7200.0, duration=5400.0)
    ranges = options["ranges"]
    values = [
        written_out(d, ranges, here, t, name, d.motion) for t in np.linspace(7200, 12600, 100)
    ]
    found = certified_worst(c, precision=0.02, budget_boxes=3e4, **options)
    assert found.low <= found.high and max(values) <= found.high * (1 + 1e-3)
    w = found.witness
    site = Site("", w.latitude, w.longitude, 0.0, d.mask, d.figure)
    assert w.value == pytest.approx(
        dilution_at(c, site, w.time, d.motion, "vdop", ranges)[0], rel=1e-12
    )
    assert w.value == pytest.approx(written_out(d, ranges, here, w.time, name, d.motion), rel=1e-9)
    for factor, outcome in ((1.1, "proven"), (0.9, "refuted")):
        limit = factor * (found.high if factor > 1 else found.low)
        claim = certified_always(c, limit, budget_boxes=3e4, **options)
        assert (claim.outcome.value, claim.limit) == (outcome, limit)


def test_what_is_tied_to_the_cross_track_error_breaks_the_mirror():
    ranges = ranges_of(design(signal=RICH))
    assert ranges.keeps_symmetry and not ranges.is_isotropic
    for i, j in ((0, 1), (0, 2), (1, 2), (1, 3), (2, 3)):
        tied = ranges.covariance.copy()
        tied[:, i, j] = tied[:, j, i] = 0.1
        assert not replace(ranges, covariance=tied).keeps_symmetry
    other = ranges.covariance.copy()
    other[3, 1, 1] += 1.0
    assert not replace(ranges, covariance=other).keeps_symmetry
    assert len(ranges.without([0, 3]).covariance) == 13


def test_no_range_is_better_than_the_least():
    """The least variance against that of random directions and distances."""
    generator = np.random.default_rng(5)
    for signal in (PLAIN, RICH, Signal(ephemeris=(0, 8, 5), clock_sigma=3)):
        ranges = ranges_of(design(signal=signal))
        x = generator.normal(size=(500, 3))
        x = np.append(x / np.linalg.norm(x, axis=1, keepdims=True), np.ones((500, 1)), axis=1)
        p = ranges.covariance[0]
        assert ranges.least(0.0) <= np.einsum("ni,ij,nj->n", x, p, x).min() + (
            sum(ranges.numbers[:2]) ** 2 + ranges.numbers[4]
        )
    with pytest.raises(ArgumentError, match="without any error, and weigh infinitely much"):
        ranges_of(design(signal=Signal(ephemeris=(0, 8, 5)))).least(1.0)


def wanted(**options):
    return Requirement.of("fix", sites=(Site("here", 0.4, 1.0),), **options)


@pytest.mark.slow
def test_a_requirement_in_metres_is_met_or_missed():
    d = design(24, 3, 1, 56.0)
    met = wanted(error_horizontal_m_at_most=40, share=0.5)
    tight = wanted(error_horizontal_m_at_most=4.0, error_as="95-percent")
    assert (met.wanted, tight.wanted) == (
        "horizontal error at most 40 m",
        "horizontal error, 95 % at most 4 m",
    )
    found = check(replace(d, requirements=(met, tight)), width=0.3)
    first, second = found.verdicts
    assert (first.met, second.met, second.evidence) == (True, False, "proven")
    assert second.worst.of == "error_horizontal_m" and second.worst.value > 4.0
    assert "missed at here" in str(found) and "horizontal error, 95 %" in str(found)
    # the witness is told as it was asked: 1.96 sigma
    plain = geometry_verdict(d, replace(tight, error_as="one-sigma"), "error_horizontal_m", 2.0)
    assert plain.worst.value > 2.0 and FACTOR_95 > 1.9


def test_a_requirement_in_metres_is_refused_or_left_open():
    d = design(24, 3, 1, 56.0)
    met = wanted(error_horizontal_m_at_most=40, share=0.5)
    with pytest.raises(ArgumentError, match=r"signal: missing; errors in metres follow"):
        check(replace(d, signal=None, requirements=(met,)))
    with pytest.raises(ArgumentError, match="allowed above 0"):
        wanted(error_time_m_at_most=0.0)
    with pytest.raises(ArgumentError, match="error_as = 'sigma'"):
        wanted(error_time_m_at_most=1.0, error_as="sigma")


@pytest.mark.slow
def test_the_sun_may_stand_anywhere():
    """What only the ionosphere's delay breaks is open; what breaks without it is broken."""
    lit = design(24, 3, 1, 56.0, replace(PLAIN, frequency=2e8, ionosphere=5.0))
    dark = replace(lit, signal=PLAIN)

    def asked_of(d, limit):
        return geometry_verdict(
            d, wanted(error_vertical_m_at_most=limit), "error_vertical_m", limit
        ).met

    assert (asked_of(dark, 30.0), asked_of(lit, 30.0)) == (True, None)
    assert (asked_of(dark, 4.0), asked_of(lit, 4.0)) == (False, False)
    assert asked_of(lit, 4000.0) is True


def test_both_skies_are_asked_where_the_ionosphere_delays(monkeypatch):
    """Refuted overhead and proven with the Sun set is open; then shares of both are the bounds."""
    d = design(24, 3, 1, 56.0, replace(PLAIN, frequency=2e8, ionosphere=5.0))
    witness = WorstWitness(1.0, 0.1, 0.2, 9.0, ())

    def always(self, c, limit, **options):
        lit = options["ranges"].numbers[4] > 0.0
        outcome = overhead if lit else dark
        return CertifiedAlways(outcome, limit, witness, 1, "")

    def share(self, c, limit, **options):
        lit = options["ranges"].numbers[4] > 0.0
        return CertifiedShare(0.5, 0.6, 1, "") if lit else CertifiedShare(0.8, 1.0, 1, "")

    monkeypatch.setattr(Effort, "always", always)
    monkeypatch.setattr(Effort, "share", share)
    found = {}
    for overhead, dark in ((1, 1), (-1, 1), (-1, -1)):
        overhead, dark = ({1: Outcome.PROVEN, -1: Outcome.REFUTED}[k] for k in (overhead, dark))
        asked_of = wanted(error_vertical_m_at_most=8.0, error_as="95-percent")
        verdict = geometry_verdict(d, asked_of, "error_vertical_m", 8.0)
        found[overhead, dark] = (verdict.met, verdict.share)
        if verdict.worst is not None and verdict.worst.of != "share":
            assert verdict.worst.value == pytest.approx(9.0 * FACTOR_95)
    assert list(found.values()) == [(True, (1.0, 1.0)), (None, (0.5, 1.0)), (False, None)]


def test_ranges_without_a_direction_stand_above_and_below():
    """Of users who are seen at up to an angle from the way down, in any direction around it."""
    generator = np.random.default_rng(7)
    lean = 0.3
    s = lean * np.sqrt(generator.uniform(size=4000))
    around = generator.uniform(0.0, 2 * np.pi, 4000)
    x = np.stack([np.sqrt(1 - s * s), s * np.cos(around), s * np.sin(around), np.ones(4000)], 1)
    tied = np.array(TIED) + 0.0
    tied[0, 1] = tied[1, 0] = 3.0
    tied[2, 3] = tied[3, 2] = -2.0
    for covariance in (np.diag([4.0, 64.0, 25.0, 9.0]), np.array(TIED), tied):
        ranges = replace(ranges_of(design()), covariance=np.repeat(covariance[None], 3, axis=0))
        most, least = ranges.alike_all_around(lean)
        assert most.is_isotropic and least.is_isotropic
        variance = np.einsum("ni,ij,nj->n", x, covariance, x)
        assert least.covariance[0, 3, 3] <= variance.min()
        assert variance.max() <= most.covariance[2, 3, 3]
        if covariance is not tied:  # as near as the angle allows
            assert variance.max() == pytest.approx(most.covariance[0, 3, 3], rel=0.01)


def test_along_paths_errors_with_a_direction_lie_between_two_without():
    d = replace(design(24, 3, 1, 56.0), motion=Motion("numerical"))
    worst, best = skies_of(d, (0.0, 3600.0), 0.0)
    sigmas = [np.sqrt(sky.covariance[0, 3, 3]) for sky in (worst, best)]
    # 2 m along the radius and 8 along the track, seen at up to 9.6 degrees, and 3 m of clocks
    assert sigmas[1] == pytest.approx(np.sqrt(4 + 9), rel=1e-3)
    assert sigmas[0] == pytest.approx(np.sqrt(4 + 60 * 0.166**2 + 9), rel=1e-2)
    limits = {"error_horizontal_m_at_most": 200, "error_vertical_m_at_most": 0.3}
    met, missed = (wanted(**{name: limit}) for name, limit in limits.items())
    found = check(replace(d, requirements=(met, replace(missed, name="no"))), days=0.01)
    assert [verdict.met for verdict in found.verdicts] == [True, False]


def test_questions_in_metres_need_ranges_and_limits_above_nothing():
    d = design()
    with pytest.raises(ArgumentError, match="needs the errors of ranges"):
        certified_share(d.constellation, 3.0, dop="error_time_m")
    with pytest.raises(ArgumentError, match="an error to ask for is above 0 m"):
        certified_share(d.constellation, 0.0, **asked(d))
    with pytest.raises(ArgumentError, match="certified only where orbits are as well"):
        certified_share(
            d.constellation, 9.0, **asked(d, motion=Motion("numerical"), duration=3600.0)
        )
