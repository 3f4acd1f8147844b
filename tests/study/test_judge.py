from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import chi2

from compass.entry.arrivals import Arrivals
from compass.entry.campaign import fly_campaign, moved_starts, moved_targets
from compass.entry.covariance import linear_covariance
from compass.entry.doubts import NO_DOUBTS, Doubts
from compass.entry.ground import Ground
from compass.entry.guidance import with_bank
from compass.entry.schedule import in_view
from compass.entry.start import Trigger
from compass.entry.trajectory import fly
from compass.entry.unknowns import NOTHING, Unknowns
from compass.entry.views import cartesian_of, spherical_of
from compass.errors import ArgumentError
from compass.frames import FIGURES, direction, prime_meridian_angle
from compass.inputs.scenario import read_scenario_text
from compass.orbits import keplerian, states_mci, walker_delta
from compass.quantities.draws import quantile_bounds
from compass.ranging import Signal
from compass.sites import Mask
from compass.study.judge import _FLOWN, MOST_FLOWN, campaign_of, judge, judge_entries
from compass.study.judge_filter import entry_beacons, judge_filter
from compass.study.judgement import spectrum_and_floor
from compass.study.pattern_map import places
from compass.study.ranking import dispersed_words, guided_words, measured_words

FIGURE = FIGURES["iau-sphere"]
AREOSYNCHRONOUS = 20428e3


@pytest.fixture(scope="module")
def scenario(short):
    return short()


@pytest.fixture(scope="module")
def five():
    return walker_delta(5, 5, 1, inclination_deg=50, radius_km=AREOSYNCHRONOUS / 1e3)


def entries(constellation, scenario, samples=4, mask=0.0, **options):
    campaign = campaign_of(scenario, samples, **options)
    return judge_entries(constellation, campaign, scenario, figure=FIGURE, mask=Mask.constant(mask))


@pytest.mark.parametrize(
    "kind",
    ["range_sigma_m = 50", "range_rate_sigma_m_s = 0.1", "both"],
    ids=["range", "rate", "both"],
)
def test_bound_is_that_of_the_recursion_over_epochs(short, five, kind):
    """The recursive covariance of the filter's kernel, with exact orbits."""
    both = "range_sigma_m = 50\nrange_rate_sigma_m_s = 0.1"
    scenario = short(("range_sigma_m = 50", both if kind == "both" else kind))
    found = entries(five, scenario, electrons=None)
    for m in range(found.campaign.size):
        beacons = entry_beacons(found, m)
        path, spread = found.campaign.paths[m], found.campaign.spreads[m, :6]
        seen = in_view(beacons, spherical_of(path), FIGURE.equatorial_radius)
        assert np.array_equal(seen, found.seen[m])
        bound = linear_covariance(
            scenario.model, path, beacons, seen, scenario.measurements, spread @ spread.T
        )
        # interpolated orbits are off by 2e-6 m of 2e7 m, so directions by 1e-13
        assert found.sigma[m, 0] == pytest.approx(
            [bound.position_sigma[-1], bound.velocity_sigma[-1]], rel=1e-9
        )


EVERYTHING = """
range_rate_sigma_m_s = 0.2
two_way = { range_sigma_m = 30, range_rate_sigma_m_s = 0.05 }
altimeter = { sigma_m = 30, share = 0.01, interval_s = 4 }
velocimeter = { sigma_m_s = 0.5, below_km = 110 }
features = { sigma_deg = 0.05, interval_s = 10 }
accelerometers = { sigma_m_s2 = 0.05, interval_s = 4 }
[measurements.link]
frequency_mhz = 401
eirp_dbw = 10
g_over_t_db_k = -25
required_db_hz = 33
chip_m = 300
beamwidth_deg = 120
antenna = "zenith"
electrons = "stagnation"
[[feature]]
name = "rim"
latitude_deg = -27
longitude_deg = -88
[[feature]]
name = "peak"
latitude_deg = -28
longitude_deg = -80
height_km = 2
"""


OWN_ERRORS = """velocity_sigma_m_s = 0.5
density = { sigma = 0.1 }
lift_to_drag = { sigma = 0.02 }
attitude = { sigma_deg = 0.3 }
gyros = { drift_sigma_deg_h = 5 }
accelerometers = { sigma_m_s2 = 0.1 }
"""


@pytest.fixture(scope="module")
def equipped(short):
    return short(
        ("range_sigma_m = 50", "range_sigma_m = 50" + EVERYTHING),
        ("velocity_sigma_m_s = 0.5", OWN_ERRORS),
    )


def test_all_that_is_measured_is_judged_as_the_filters_hear_it(equipped, five):
    """Each entry's bound against the recursion with the link, both ways and features moved there.

    The rotation that moves them leaves their distances to the vehicle and each other as they are.
    """
    found = entries(five, equipped)
    campaign, radius = found.campaign, equipped.model.planet_radius
    first = cartesian_of(equipped.state[:6])[:3]
    assert np.all(campaign.arrival_probability == 1.0)  # the link counts the plasma
    heard = 0
    for m in range(campaign.size):
        beacons, path = entry_beacons(found, m), campaign.paths[m]
        features = equipped.measurements.features
        moved = features.moved(radius, campaign.turns(equipped.state)[m])
        np.testing.assert_allclose(
            np.linalg.norm(moved.places(radius) - path[0, :3], axis=1),
            np.linalg.norm(features.places(radius) - first, axis=1), rtol=1e-9,
        )  # fmt: skip
        own = replace(equipped.measurements, features=moved)
        seen = in_view(beacons, spherical_of(path), FIGURE.equatorial_radius)
        reaching = own.reaching(seen, beacons, path, equipped.model)
        assert np.array_equal(reaching, found.seen[m])
        heard += (seen & ~reaching).sum()
        spread = campaign.spreads[m, :6, :6]
        assert campaign.spreads[m, 6:, 6:] == pytest.approx(np.diag([0.1, 0.02]))
        bound = linear_covariance(
            equipped.model, path, beacons, seen, own, spread @ spread.T,
            layout=equipped.settings.layout(beacons.size),
        )  # fmt: skip
        assert found.sigma[m, 0] == pytest.approx(
            [bound.position_sigma[-1], bound.velocity_sigma[-1]], rel=1e-8
        )
    assert heard > 0
    budget = found.budget()
    parts = [value for name, value in budget.items() if name not in ("all", "ignored")]
    assert budget["noise of the instruments"] > 0
    assert np.hypot.reduce(parts) == pytest.approx(budget["all"], rel=1e-9)
    # without the satellite that counts most the instruments are left
    assert np.all(found.figures()["after_loss"]["unobservable_share"] <= 1)


SPREAD = "[dispersion]\nposition_m = {0}\nvelocity_m_s = {1}\ndensity = {1}\nlift_to_drag = {1}\n"


def test_dispersed_entries_are_judged(short, five):
    """Without dispersions the planned ones; with them each flies as its own start and air say."""
    flat, wide = (
        short(("[measurements]", SPREAD.format(*size) + "[measurements]"))
        for size in ((0, 0), (1000, 0.05))
    )
    plain, same = (campaign_of(lander, 4) for lander in (short(), flat))
    np.testing.assert_array_equal(plain.paths, same.paths)
    flown = campaign_of(wide, 4)
    off = np.linalg.norm((flown.paths - plain.paths)[:, 0, :3], axis=1)
    assert np.all((off > 100) & (off < 6000)) and np.ptp(flown.worlds[:, 0]) > 0
    for path, (thicker, lift) in zip(flown.paths, flown.worlds, strict=True):
        world = wide.model.truth(density_bias=np.expm1(thicker))
        craft = replace(world.vehicle, lift_to_drag=world.vehicle.lift_to_drag + lift)
        again = fly(replace(world, vehicle=craft), spherical_of(path[0]), flown.times).path
        np.testing.assert_allclose(path, again, rtol=0, atol=1e-3)
    still = short(("[measurements]", SPREAD.format(1000, 0) + "[measurements]"))
    place = {"samples": 2, "figure": FIGURE, "mask": Mask(), "threads": 1}
    assert judge_filter(five, still, runs=8, **place)["believed"]
    assert "by 1000 m and 0.05 m/s on each axis, 5 % of density" in dispersed_words(wide.dispersion)
    assert dispersed_words(None) == ""


@pytest.mark.slow
def test_guided_entries_are_judged(five, designs):
    """Each flies the bank that brings it to its own target, and its filter the same bank."""
    text = (designs / "landing-guided.toml").read_text()
    for old, new in (("position_m = 1000", "position_m = 1"), ("unscented", "relinearised-ekf")):
        text = text.replace(old, new)
    lander = read_scenario_text(text, folder=designs)
    flown = campaign_of(lander, 4, 3)
    ends = flown.paths[np.arange(4), flown.stops, :3]
    targets = moved_targets(lander.state, lander.guidance, flown.paths[:, 0])
    radius = np.linalg.norm(ends, axis=1)
    miss = radius * np.arccos((ends * targets).sum(axis=1) / radius)
    assert miss.max() < 10e3 and np.ptp(flown.banks[0, np.isfinite(flown.banks[0, :, 0]), 1]) > 1
    for path, bank, (thicker, lift) in zip(flown.paths, flown.banks, flown.worlds, strict=True):
        world = with_bank(lander.model.truth(density_bias=np.expm1(thicker)), bank)
        craft = replace(world.vehicle, lift_to_drag=world.vehicle.lift_to_drag + lift)
        stop = np.flatnonzero(path.any(axis=1))[-1]
        times = flown.times[[0, stop]]
        again = fly(replace(world, vehicle=craft), spherical_of(path[0]), times).path[-1]
        assert np.linalg.norm((again - path[stop])[:3]) < 1.0
    assert miss == pytest.approx(flown.misses, abs=450.0)  # flown to an epoch past the moment
    assert "half to within" in guided_words(flown) and "keep none" in guided_words(flown)
    place = {"samples": 2, "figure": FIGURE, "mask": Mask(), "threads": 1}
    judged = judge_filter(five, lander, runs=8, **place)
    assert judged["believed"] and judged["delivery_m"]["deployed"] == 2
    # what it knows of density and L/D guides it to its own target, hundreds of kilometres on
    assert 0 < judged["delivery_m"]["p50"] <= judged["delivery_m"]["p95"] < 5e3
    # aimed at a goal, the target itself lies there
    gale = Ground(("gale",), ((-0.08, 2.398),), ((),))
    aimed = campaign_of(lander, 2, ground=gale)
    at = moved_targets(lander.state, lander.guidance, moved_starts(lander.state, aimed.arrivals))
    np.testing.assert_allclose(at, np.tile(direction(-0.08, 2.398), (2, 1)), atol=1e-6)


def test_there_and_back_no_clock_enters(short, five):
    """With nothing one way neither the lander's clock nor the satellites' cost anything."""
    both = ("range_sigma_m = 50", "two_way = { range_sigma_m = 50 }")
    plain, back = short(), short(both)
    clocks = Unknowns((3e4, 0.3), np.diag([0.0, 0.0, 0.0, 9.0]))
    place = {"figure": FIGURE, "mask": Mask()}
    one, two, free = (
        judge_entries(
            five, campaign_of(lander, 4, electrons=None), lander, unknowns=doubts, **place
        )
        for lander, doubts in ((plain, clocks), (back, clocks), (plain, NOTHING))
    )
    np.testing.assert_allclose(two.sigma, free.sigma, rtol=1e-12)
    assert np.all(one.sigma[:, 0, 0] > two.sigma[:, 0, 0])


def test_the_filter_hears_what_the_judge_counts(equipped, five):
    found = judge_filter(five, equipped, samples=2, runs=8, figure=FIGURE, mask=Mask(), threads=1)
    assert found["believed"] and found["rms_over_bound"] < 2
    said = measured_words(equipped.measurements)
    assert "noise of the link" in said and "height over the sphere" in said
    assert said.endswith("Features lie about every entry as they do about the scenario's own.")


def test_loss_is_judging_without_the_satellite(scenario, five):
    found = entries(five, scenario)
    for lost in (0, 3):
        less = entries(five.without([lost]), scenario)
        assert found.sigma[:, 1 + lost] == pytest.approx(less.sigma[:, 0], rel=1e-12)
        after, alone = found._figures(lost, 10.0), less._figures(None, 10.0)
        assert after.keys() == alone.keys()
        for group in after:
            for figures in (after[group], alone[group]):
                if isinstance(figures, dict):  # intervals are pairs, which approx takes alone
                    for name in [name for name in figures if name.endswith("_interval")]:
                        figures[f"{name}_low"], figures[f"{name}_high"] = figures.pop(name)
        assert after == {key: pytest.approx(value) for key, value in alone.items()}
    worst = max(
        np.percentile(found.sigma[:, 1 + k, 0], 95, method="inverted_cdf") for k in range(5)
    )
    assert found.figures()["after_loss"]["crlb_position_m"]["p95"] == pytest.approx(worst)


@given(
    i=st.floats(0, 1.5), raan=st.floats(0, 6.28), anomaly=st.floats(0, 6.28),
    radius=st.floats(4e6, 4e7),
)  # fmt: skip
@settings(max_examples=10)
def test_one_more_satellite_never_hurts(short, five, i, raan, anomaly, radius):
    more = keplerian(
        np.append(five.semi_major_axis, radius),
        0.0,
        np.append(five.inclination, i),
        np.append(five.raan, raan),
        0.0,
        np.append(five.mean_anomaly, anomaly),
    )
    scenario = short()
    campaign = campaign_of(scenario, 2)
    place = {"figure": FIGURE, "mask": Mask()}
    six = judge_entries(more, campaign, scenario, **place)
    # the same entries at the same moments, so without the newcomer rather than from five alone
    assert np.all(six.sigma[:, 0] <= six.sigma[:, 6] * (1 + 1e-12))


def test_turning_nodes_and_sites_together_changes_nothing(scenario, five):
    turn = 1.234
    campaign = campaign_of(scenario, 4)
    a = campaign.arrivals
    moved = fly_campaign(
        scenario.model,
        scenario.state,
        scenario.settings.covariance0,
        scenario.times,
        Arrivals(a.latitude, a.longitude + turn, a.azimuth, a.phase),
    )
    turned = replace(five, raan=five.raan + turn)
    one = entries(five, scenario)
    other = judge_entries(turned, moved, scenario, figure=FIGURE, mask=Mask())
    assert np.array_equal(one.seen, other.seen)
    # rounding of directions (1e-16 of 2e7 m over 1 m of what is sought) and of the flight
    assert other.sigma == pytest.approx(one.sigma, rel=1e-8)


def test_threads_do_not_change_the_numbers(scenario, five, monkeypatch):
    monkeypatch.setattr("compass.study.judge.BLOCK", 1)
    campaign = campaign_of(scenario, 3)
    pair = [
        judge_entries(five, campaign, scenario, figure=FIGURE, mask=Mask(), threads=threads)
        for threads in (1, 3)
    ]
    assert np.array_equal(pair[0].sigma, pair[1].sigma)
    assert np.array_equal(pair[0].shares, pair[1].shares)


def test_a_measurement_is_worth_its_probability_to_arrive(scenario, five):
    """Plasma thicker than the critical density everywhere lets 1e-8 of the ranges through."""

    def thick(density, speed):
        return np.full(np.shape(density), 1e20)

    clear, dim = entries(five, scenario, electrons=None), entries(five, scenario, electrons=thick)
    assert dim.shares == pytest.approx(1e-8 * clear.shares, rel=1e-12)
    assert np.array_equal(dim.seen, clear.seen)
    assert np.all(dim.sigma > clear.sigma)


def test_without_satellites_the_prior_is_left(scenario):
    nobody = keplerian([], 0, 0, 0, 0, 0)
    found = entries(nobody, scenario)
    figures = found.figures()
    assert figures["unobservable_share"] == 1
    assert figures["in_view"] == {"min": 0, "median": 0, "median_interval": [0, 0]}
    assert "after_loss" not in figures
    gain = found.campaign.gains[:, -1]
    assert found.sigma[:, 0, 0] == pytest.approx(np.sqrt((gain[:, :3] ** 2).sum(axis=(1, 2))))
    # 1 km and 0.5 m/s an axis, a good half minute later: sqrt(3) km and a bit
    assert np.all((found.sigma[:, 0, 0] > 1700) & (found.sigma[:, 0, 0] < 1800))
    assert figures["share_within_goal"] == 0


def test_rank_is_told_from_rounding():
    rng = np.random.default_rng(0)
    terms = rng.standard_normal((2, 200, 6))
    terms[0] -= terms[0] @ np.full((6, 6), 1 / 6)  # no term sees the direction (1, ..., 1)
    spectrum, floor = spectrum_and_floor(np.einsum("mka,mkb->mab", terms, terms), 200)
    assert list(spectrum[:, 0] <= floor) == [True, False]


def test_uncertain_parameters_cost_accuracy(scenario, five):
    known = entries(five, scenario)
    unsure = entries(five, scenario, density_sigma=0.2, lift_sigma=0.1)
    assert unsure.information.shape[1:] == (8, 8)
    assert np.all(unsure.sigma[:, 0] >= known.sigma[:, 0] * (1 - 1e-12))
    # a parameter that is all but known is as good as known
    sure = entries(five, scenario, density_sigma=1e-9)
    assert sure.sigma == pytest.approx(known.sigma, rel=1e-9)


def test_bound_with_uncertain_parameters_is_that_of_least_squares(scenario, five):
    """All ranges of an entry stacked, solved at once by NumPy, with exact orbits."""
    found = entries(five, scenario, density_sigma=0.2, lift_sigma=0.1)
    campaign = found.campaign
    for m in range(campaign.size):
        beacons = entry_beacons(found, m)
        line = campaign.paths[m, :, None, :3] - beacons.r
        n = line / np.linalg.norm(line, axis=2, keepdims=True)
        rows = np.einsum("tni,tij->tnj", n, campaign.gains[m, :, :3])
        rows *= np.sqrt(campaign.arrival_probability[m])[:, None, None] / 50.0
        h = rows[found.seen[m]]
        covariance = np.linalg.inv(np.eye(8) + h.T @ h)
        gain = campaign.gains[m, -1]
        spread = np.diag(gain @ covariance @ gain.T)
        sigma = np.sqrt([spread[:3].sum(), spread[3:].sum()])
        assert found.sigma[m, 0] == pytest.approx(sigma, rel=1e-9)


DOUBTFUL = Unknowns((3e3, 0.3), np.diag([4.0, 64.0, 25.0, 9.0]), 1.5, 3e-6)
STILL = replace(DOUBTFUL, turn=0.0)


def stacked(found, m, scenario):
    """Rows of all measurements of an entry on u and on every satellite's whitened errors.

    By NumPy and exact orbits; what an error does to range and rate by moving the satellite, as a
    turn of all of them does.
    """
    campaign, sigmas = found.campaign, scenario.measurements
    beacons, t = entry_beacons(found, m), campaign.times
    c, epoch = found.constellation, found.epochs[m]
    angle = prime_meridian_angle(c.epoch, epoch) + campaign.model.omega * t
    r, v = states_mci(c, epoch + t)
    rows, own = [], []
    for i in range(c.size):
        up = r[i] / np.linalg.norm(r[i], axis=1, keepdims=True)
        cross = np.cross(r[i], v[i])
        cross /= np.linalg.norm(cross, axis=1, keepdims=True)
        axes = np.stack([up, np.cross(cross, up), cross], axis=1)
        ca, sa, none, one = np.cos(angle), np.sin(angle), 0 * angle, 1 + 0 * angle
        turn = np.stack([[ca, sa, none], [-sa, ca, none], [none, none, one]]).transpose(2, 0, 1)
        shift = turn @ axes.transpose(0, 2, 1)  # columns: moves in Mars-fixed axes, 1 m each
        speed = np.gradient(shift, t, axis=0, edge_order=2)
        line, w = (
            campaign.paths[m, :, :3] - beacons.r[:, i],
            campaign.paths[m, :, 3:] - beacons.v[:, i],
        )
        distance = np.linalg.norm(line, axis=1, keepdims=True)
        n = line / distance
        across = (w - (w * n).sum(axis=1, keepdims=True) * n) / distance
        gains = campaign.gains[m]
        whole = DOUBTFUL.turn * np.stack(
            [np.cross(np.eye(3), x[:, i, None]).swapaxes(1, 2) for x in (beacons.r, beacons.v)]
        )
        both = (
            (sigmas.range_sigma, np.einsum("ti,tij->tj", n, gains[:, :3]), one, t,
             -np.einsum("ti,tij->tj", n, shift), one, -np.einsum("ti,tij->tj", n, whole[0])),
            (sigmas.rate_sigma, np.einsum("ti,tij->tj", across, gains[:, :3])
             + np.einsum("ti,tij->tj", n, gains[:, 3:]), none, one,
             -np.einsum("ti,tij->tj", across, shift) - np.einsum("ti,tij->tj", n, speed), none,
             -np.einsum("ti,tij->tj", across, whole[0]) - np.einsum("ti,tij->tj", n, whole[1])),
        )  # fmt: skip
        for sigma, h, clock, drift, moved, constant, turned in both:
            if sigma is None:
                continue
            u = np.column_stack([h, turned, 3e3 * clock, 0.3 * drift])
            p = np.zeros((t.size, 5 * c.size))
            p[:, 5 * i : 5 * i + 3] = moved * [2.0, 8.0, 5.0]
            p[:, 5 * i + 3], p[:, 5 * i + 4] = 3.0 * constant, 1.5 * constant
            scale = np.sqrt(campaign.arrival_probability[m])[:, None] / sigma
            rows.append((u * scale)[found.seen[m, :, i]])
            own.append((p * scale)[found.seen[m, :, i]])
    return np.concatenate(rows), np.concatenate(own)


@pytest.mark.parametrize(
    "kind", ["range_sigma_m = 5", "range_sigma_m = 5\nrange_rate_sigma_m_s = 0.01"]
)
def test_what_is_not_known_of_clocks_and_satellites(short, five, kind):
    """All measurements and unknowns of an entry stacked, solved at once by NumPy."""
    scenario = short(("range_sigma_m = 50", kind))
    campaign = campaign_of(scenario, 4, density_sigma=0.2)
    place = {"figure": FIGURE, "mask": Mask(), "unknowns": DOUBTFUL}
    found = judge_entries(five, campaign, scenario, **place)
    squares = []
    for m in range(campaign.size):
        h, g = stacked(found, m, scenario)
        d = h.shape[1]
        whole = np.concatenate([h, g], axis=1)
        covariance = np.linalg.inv(np.eye(whole.shape[1]) + whole.T @ whole)[:d, :d]
        place_of = np.zeros((6, d))
        place_of[:, : d - 5] = campaign.gains[m, -1]
        spread = np.diag(place_of @ covariance @ place_of.T)
        # the errors' rates by differences of 2 s: 1e-8 of the satellites' motion
        assert found.sigma[m, 0] == pytest.approx(
            np.sqrt([spread[:3].sum(), spread[3:].sum()]), rel=1e-6
        )
        frame = np.arange(d - 5, d - 2)
        g, h = np.concatenate([g, h[:, frame]], axis=1), np.delete(h, frame, axis=1)
        seen_by = np.delete(place_of, frame, axis=1)
        blind = np.linalg.inv(np.eye(d - 3) + h.T @ h)
        spoilt = blind + blind @ (h.T @ g @ g.T @ h) @ blind
        squares.append(np.trace((seen_by @ spoilt @ seen_by.T)[:3, :3]))
    budget = found.budget()
    assert budget["ignored"] == pytest.approx(np.sqrt(np.mean(squares)), rel=1e-6)
    ignored, whole = budget.pop("ignored"), budget.pop("all")
    assert list(budget) == [
        "first state", "density", "satellites' frame", "receiver's clock", "noise of the ranges",
        "satellites' orbits and clocks", "biases of the ranges",
    ]  # fmt: skip
    assert sum(value**2 for value in budget.values()) == pytest.approx(whole**2, rel=1e-9)
    assert whole < ignored
    # one lost is one never there
    less = judge_entries(five.without([2]), campaign, scenario, **place)
    assert found.sigma[:, 3] == pytest.approx(less.sigma[:, 0], rel=1e-9)
    known = judge_entries(five, campaign, scenario, figure=FIGURE, mask=Mask())
    assert np.all(found.sigma[:, :, 0] > known.sigma[:, :, 0])
    assert known.budget()["satellites' orbits and clocks"] == 0
    # no satellite tells of the frame: what is open is asked as if it stood still
    still = judge_entries(five, campaign, scenario, **place | {"unknowns": STILL})
    assert found.known["blind"].tolist() == still.known["blind"].tolist()
    assert np.all(found.sigma[:, :, 0] > still.sigma[:, :, 0])


def test_the_filter_knows_what_it_does_not_know(short, five):
    """Its clock estimated and the satellites' errors considered, it is consistent."""
    scenario = short(("range_sigma_m = 50", "range_sigma_m = 5"))
    options = {"samples": 2, "runs": 8, "figure": FIGURE, "mask": Mask(), "threads": 1}
    doubts = {"density_sigma": 0.1, "lift_sigma": 0.1, "unknowns": DOUBTFUL}
    found = judge_filter(five, scenario, **options, **doubts)
    assert found["believed"] and 0.5 < found["rms_over_bound"] < 2
    known = judge_filter(five, scenario, **options)
    assert found["ekf_position_m"]["rms"] > known["ekf_position_m"]["rms"]


def test_doubts_are_said_and_taken_from_a_design(seed_design):
    doubts = Doubts()
    usual = doubts.of(None, seed_design.constellation.size)
    assert np.diag(usual.satellites).tolist() == [4, 64, 25, 9] and usual.clock == (3e4, 0.3)
    signal = Signal(ephemeris=(1.0, 2.0, 3.0), clock_sigma=0.5)
    own = doubts.of(signal, seed_design.constellation.size)
    assert own.satellites.shape == (15, 4, 4)
    assert np.diag(own.satellites[7]) == pytest.approx([1, 4, 9, 0.25])
    told = "orbits, clocks and what they have wrong alike of x by its own table [signal]."
    assert doubts.sentence(["x"]).endswith(told)
    assert "clock that agrees" in NO_DOUBTS.sentence([])
    # what all have wrong alike: a turn, and a time by which a clock of the lander's own is off
    alike = replace(signal, common_orientation=1e-6, common_time=4e4)
    assert (own.turn, own.clock) == (0.0, (3e4, 0.3))
    assert (doubts.of(alike, 15).turn, doubts.of(alike, 15).clock) == (1e-6, (5e4, 0.3))
    assert NO_DOUBTS.of(alike, 15).clock == (0.0, 0.0)
    for bad, message in (
        ({"clock_m": -1.0}, "clock_m = -1"),
        ({"clock_m": 0.0}, "give both"),
        ({"orbit_m": (1.0, np.nan, 1.0)}, "orbit_m = nan"),
        ({"satellite_clock_m": -3.0}, "satellite_clock_m = -3"),
        ({"range_bias_m": np.inf}, "range_bias_m = inf"),
    ):
        with pytest.raises(ArgumentError, match=message):
            Doubts(**bad)
    with pytest.raises(ArgumentError, match="a variance below 0"):
        Unknowns(satellites=-np.eye(4))


def test_campaigns_are_flown_once(scenario):
    assert campaign_of(scenario, 2) is campaign_of(replace(scenario, label="elsewhere"), 2)
    assert campaign_of(scenario, 2) is not campaign_of(scenario, 2, 1)
    for samples in range(3, 4 + MOST_FLOWN):
        campaign_of(scenario, samples)
    assert len(_FLOWN) == MOST_FLOWN


def test_a_campaign_of_another_deployment_is_another(scenario):
    ends = []
    for level in (90e3, 60e3):
        trigger = Trigger("parachute", "altitude", level)
        lower = replace(scenario, state=scenario.state * [1, 1, 1, 1, 2, 1], triggers=(trigger,))
        flown = campaign_of(lower, 2)
        last = flown.paths[0, flown.stops[0], :3]
        ends.append(np.linalg.norm(last) - flown.model.planet_radius)
    assert ends[1] <= 60e3 < ends[0] <= 90e3


def test_what_is_kept_cannot_be_changed(scenario):
    campaign = campaign_of(scenario, 2)
    for part in (*vars(campaign).values(), *vars(campaign.arrivals).values()):
        if isinstance(part, np.ndarray):
            with pytest.raises(ValueError, match="read-only"):
                part[...] = 0
    with pytest.raises(ValueError, match="read-only"):
        places("equal-area", 30.0)[...] = 0


def test_electrons_by_a_function_are_asked_each_time(scenario):
    thickness = 0.0

    def electrons(density, speed):
        return thickness * np.ones_like(density)

    clear = campaign_of(scenario, 2, electrons=electrons)
    thickness = 1e20
    thick = campaign_of(scenario, 2, electrons=electrons)
    assert clear.arrival_probability.min() == 1 and thick.arrival_probability.max() < 0.5


def test_figures_are_those_of_the_entries(scenario, five):
    found = entries(five, scenario, seed=1)
    sigma = found.position_sigma
    goal = float(np.sort(sigma)[2])  # that three of four entries keep
    figures = judge(five, scenario, samples=4, seed=1, figure=FIGURE, mask=Mask(), goal=goal)
    half = np.sort(sigma)[1]  # of four the second is the first that half of them do not exceed
    assert figures["crlb_position_m"]["p50"] == half
    low, high = figures["crlb_position_m"]["p50_interval"]
    assert low <= half <= high
    worst = figures["crlb_position_m"]
    k = int(sigma.argmax())
    assert k > 0 and worst["worst"] == sigma[k]
    assert worst["worst_epoch_s"] == found.epochs[k]
    lat, lon = found.campaign.deployment_place
    assert np.radians([worst["worst_latitude_deg"], worst["worst_longitude_deg"]]) == pytest.approx(
        [lat[k], lon[k]]
    )
    assert figures["share_within_goal"] == 0.75
    counts = found.seen.sum(axis=2)
    assert figures["in_view"] == {
        "min": counts.min(),
        "median": np.sort(counts, axis=None)[(counts.size - 1) // 2],
        "median_interval": [0, 5],  # four entries leave all that is possible
    }
    f = found.information
    log_det = np.linalg.slogdet(f)[1]
    median = np.sort(log_det)[1]  # an entry's own: without measurements it would be -inf
    assert figures["fisher_log_det"]["p50"] == pytest.approx(median, rel=1e-6)
    assert figures["fisher_trace"]["p50"] == pytest.approx(np.sort(np.trace(f.T))[1])


def test_mask_hides_satellites(scenario, five):
    assert entries(five, scenario, mask=0.5).seen.sum() < entries(five, scenario).seen.sum()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("range_sigma_m = 50", "range_sigma_m = 50\nin_turn = true"), "in_turn = true"),
        (
            ('kind = "relinearised-ekf"', 'kind = "ekf"\nprocess_noise_si = [1, 0, 0, 0, 0, 0]'),
            "process_noise_si",
        ),
        (
            ('kind = "relinearised-ekf"', "density = { sigma = 0.1, scale_km = 8 }"),
            "logarithm of true over known density: wanders",
        ),
        (
            ('kind = "relinearised-ekf"', "lift_to_drag = { sigma = 0.1, considered = true }"),
            "true less known lift-to-drag ratio: only considered",
        ),
    ],
)
def test_what_the_bound_does_not_cover_is_refused(short, five, change, message):
    with pytest.raises(ArgumentError, match=message):
        entries(five, short(change))


def test_satellites_under_the_surface_are_refused(scenario):
    low = keplerian(3.5e6, 0.1, 0, 0, 0, 0)
    with pytest.raises(ArgumentError, match="comes down to radius 3150 km"):
        entries(low, scenario)


def test_filter_runs_report_errors_and_consistency(scenario, five):
    found = judge_filter(five, scenario, samples=2, runs=4, figure=FIGURE, mask=Mask(), threads=1)
    assert found["runs"] == 4 and found["diverged"] == 0
    low, high = chi2.ppf([0.025, 0.975], 6 * 4) / 4
    assert found["nees_interval"] == {"low": pytest.approx(low), "high": pytest.approx(high)}
    assert found["consistent"] == (low <= found["nees"] <= high)
    assert 0 < found["ekf_position_m"]["p50"] <= found["ekf_position_m"]["p95"]
    again = judge_filter(five, scenario, samples=2, runs=4, figure=FIGURE, mask=Mask(), threads=2)
    assert found == again
    # two runs of each of two entries: two independent draws, which bound nothing
    assert found["ekf_position_m"]["p50_interval"] == [-np.inf, np.inf]
    with pytest.raises(ArgumentError, match="runs = 0"):
        judge_filter(five, scenario, samples=2, runs=0, figure=FIGURE, mask=Mask())


def test_percentiles_of_runs_have_the_bounds_of_one_run_an_entry():
    """Runs of one entry are alike: all of them would bound it as if each said something new."""
    from compass.study.judge_filter import _errors

    values = np.repeat(np.random.default_rng(1).exponential(size=40), 8)
    found = _errors(values, np.arange(320) % 8 == 0)
    assert found["p50_interval"] == list(quantile_bounds(values[::8], 50))
    low, high = quantile_bounds(values, 50)
    assert found["p50_interval"][0] < low <= found["p50"] <= high < found["p50_interval"][1]


def test_a_filter_that_believes_too_much_is_called_so(short, five):
    """It takes the planet to turn, which in truth it does not: 2 omega V t is 34 m/s in 40 s."""
    deaf = short(("range_sigma_m = 50", "range_sigma_m = 1e6"))
    options = {"samples": 2, "runs": 8, "figure": FIGURE, "mask": Mask()}
    honest = judge_filter(five, deaf, **options)
    assert honest["consistent"] and 0.5 < honest["rms_over_bound"] < 2
    spoilt = replace(deaf, truth=replace(deaf.truth, rotation_rate=0.0))
    vain = judge_filter(five, spoilt, **options)
    assert vain["nees"] > vain["nees_interval"]["high"] and not vain["consistent"]


def test_filter_that_diverges_is_counted(scenario, five, monkeypatch):
    from compass.study import judge_filter as module

    def lost(*arguments, **options):
        found = original(*arguments, **options)
        found.errors[:], found.diverged[:] = np.nan, True
        return found

    original = module.run_monte_carlo
    monkeypatch.setattr(module, "run_monte_carlo", lost)
    found = judge_filter(five, scenario, samples=1, runs=1, figure=FIGURE, mask=Mask())
    assert found["diverged"] == 1 and np.isnan(found["ekf_position_m"]["rms"])
    assert found["consistent"] is False


@pytest.mark.slow
def test_filter_reaches_the_bound(designs, seed_design):
    """Mean squares of N runs scatter by sqrt(2/N) at most, of one dominant direction.

    Four of these, halved for the root: 12.5 % for 512 runs.
    """
    from compass.inputs.scenario import read_scenario

    scenario = read_scenario(designs / "landing.toml")
    found = judge_filter(
        seed_design.constellation,
        scenario,
        samples=64,
        runs=512,
        figure=seed_design.figure,
        mask=seed_design.mask,
        electrons=None,
    )
    n = found["runs"]
    assert n >= 500 and found["diverged"] == 0
    assert found["rms_over_bound"] == pytest.approx(1, abs=4 * 0.5 * np.sqrt(2 / n))
    assert found["nees"] == pytest.approx(6, abs=4 * np.sqrt(12 / n))


def test_a_filter_that_is_wrong_about_the_air_makes_no_claim(short, seed_design):
    """Judged with a truth of 20 % more air: no word of the goal but of the bound alone."""
    from compass.study.ranking import believed_answer

    scenario = short(("[measurements]", "[truth]\ndensity_bias = 0.2\n\n[measurements]"))
    place = {"figure": seed_design.figure, "mask": seed_design.mask}
    where = ("value", "latitude_deg", "longitude_deg", "azimuth_deg", "epoch_s", "in_view")
    figures = {"share_within_goal": 1.0, "worst_found": dict.fromkeys(where, 7)}
    run = judge_filter(seed_design.constellation, scenario, samples=2, runs=8, threads=1, **place)
    assert not run["believed"]
    assert run["errors_over_claim"] == pytest.approx(np.sqrt(run["nees"] / 6))
    lost = run | {"diverged": 3}
    for found in (run, lost):
        said = believed_answer(figures | found, 1e4)
        assert said.startswith("no claim: the filter is inconsistent, its errors")
        assert "of the bound alone: yes" in said
    assert "3 of 8 runs diverged" in said
    assert believed_answer(figures | run | {"believed": True}, 1e4).startswith("yes")


def test_deployment_is_the_trigger_named_so(short, designs):
    from compass.inputs.scenario import read_scenario

    assert short().deployment is None
    trigger = read_scenario(designs / "landing.toml").deployment
    assert (trigger.quantity, trigger.level) == ("mach", 2.0)
    other = short(("[measurements]", '[[trigger]]\nname = "slow"\nmach = 3\n\n[measurements]'))
    assert other.deployment is None


@pytest.mark.slow
def test_steps_decide_nothing_about_the_flight(designs):
    """At the longest step allowed the entry is the same as at one of a second: 2 mm at 13 g."""
    from compass.inputs.scenario import read_scenario_text

    text = (designs / "landing.toml").read_text()
    text = text.replace('[beacons]\ndesign = "compass-15-5-1.toml"\n', "")
    fine = campaign_of(read_scenario_text(text), 2)
    coarse = campaign_of(
        read_scenario_text(text.replace("duration_s = 320", "duration_s = 330\nstep_s = 30")), 2
    )
    count = int(fine.stops.min()) // 30 + 1
    miss = coarse.paths[:, :count] - fine.paths[:, : 30 * count : 30]
    assert np.abs(miss[..., :3]).max() < 0.01


def test_a_lander_that_was_changed_is_flown_anew(short):
    scenario = short()
    faster = replace(scenario, state=scenario.state * [1, 1, 1, 1.1, 1, 1])
    first, second = (np.linalg.norm(campaign_of(s, 2).paths[0, 0, 3:]) for s in (scenario, faster))
    assert second == pytest.approx(1.1 * first, rel=1e-12)
