"""Entries from the physics alone: Cartesian flight, its derivatives, sight, plasma, the bound.

Nothing of the first is the package's but Mars's rotation angle, the drawn entries, the constants.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compass.bodies import MARS_GM, MARS_ROTATION_RATE
from compass.frames import FIGURES, prime_meridian_angle
from compass.orbits import keplerian
from compass.sites import Mask
from compass.study.judge import campaign_of, judge_entries
from compass.study.judge_filter import entry_beacons
from tests.entry.one_run import run_filter

GM, OMEGA = MARS_GM.value, np.array([0.0, 0.0, MARS_ROTATION_RATE.value])
# designs/landing.toml
B, LIFT, LN_RHO0, R0, H = 0.016, 0.156, np.log(2e-4), 3437.2e3, 7500.0
RANGE, RATE, STEP = 50.0, 0.1, 2.0
DENSITY_SIGMA, LIFT_SIGMA = 0.2, 0.1
MASK = np.radians(4)
# a, e, i, RAAN, argument of periapsis, mean anomaly
ORBITS = np.array(
    [[2.0e7, 0.3, 1.0, k * 1.1, 0.5 + k, k * 2.0] for k in range(5)]
    + [[9.0e6, 0.0, 0.8, k * 2.1, 0.0, k * 1.3] for k in range(3)]
)


def density(y, ln_rho0):
    return np.exp(ln_rho0 + (R0 - np.linalg.norm(y[:3], axis=0)) / H)


def fly(y, times, ln_rho0=LN_RHO0, lift=LIFT):
    """Position and velocity in turning axes, shape (t, 6)."""

    def rates(_, y):
        r, v = y[:3], y[3:]
        along = v / np.linalg.norm(v)
        above = r - (r @ along) * along
        drag = 0.5 * density(y, ln_rho0) * B * (v @ v)
        force = drag * (lift * above / np.linalg.norm(above) - along)
        turning = -2 * np.cross(OMEGA, v) - np.cross(OMEGA, np.cross(OMEGA, r))
        return np.concatenate([v, force + turning - GM * r / np.linalg.norm(r) ** 3])

    span = times[[0, -1]]
    return solve_ivp(rates, span, y, "DOP853", times, rtol=1e-12, atol=1e-9).y.T


def derivatives(y, times):
    """Of the flight in position, velocity, ln rho0 and L/D: central differences of fourth order."""

    def along(direction, step):
        def at(k):
            d = k * step * direction
            return fly(y + d[:6], times, LN_RHO0 + d[6], LIFT + d[7])

        return (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * step)

    steps = [30.0] * 3 + [0.02] * 3 + [1e-3] * 2
    return np.stack([along(*pair) for pair in zip(np.eye(8), steps, strict=True)], axis=-1)


def kepler(orbit, times):
    """Position and velocity by the eccentric anomaly, shape (t, 6)."""
    a, e, i, raan, periapsis, anomaly = orbit
    n = np.sqrt(GM / a**3)
    big = mean = anomaly + n * times
    for _ in range(60):
        big = mean + e * np.sin(big)
    flat = a * np.stack([np.cos(big) - e, np.sqrt(1 - e * e) * np.sin(big)])
    change = (
        a * n / (1 - e * np.cos(big)) * np.stack([-np.sin(big), np.sqrt(1 - e * e) * np.cos(big)])
    )
    (co, so), (ci, si) = (np.cos(raan), np.sin(raan)), (np.cos(i), np.sin(i))
    node, ahead = np.array([co, so, 0.0]), np.array([-so * ci, co * ci, si])
    cw, sw = np.cos(periapsis), np.sin(periapsis)
    plane = np.stack([cw * node + sw * ahead, cw * ahead - sw * node])
    return np.concatenate([flat.T @ plane, change.T @ plane], axis=1)


def arrival(y):
    """Of a UHF signal through the wake: Lou et al. 2017 as fitted in specification and docs."""
    speed = np.linalg.norm(y[:, 3:], axis=1)
    n = 1e6 * np.exp(22.5284523533) * (density(y.T, LN_RHO0) / 1e-4) ** 0.9698219421
    n *= (speed / 5000) ** 7.6641503307
    blackout = (2 * np.pi * 401e6) ** 2 * 8.8541878128e-12 * 9.1093837015e-31 / 1.602176634e-19**2
    return 1e-8 ** (np.clip((n - 3.08e14) / (blackout - 3.08e14), 0, 1) ** 2)


def bound(start, epoch, times, sphere):
    """Posterior sigma of position and velocity at the end, who is in view, and the flight."""
    y = fly(start, times)
    phi, weight = derivatives(start, times), arrival(y)
    prior = np.diag([1000.0**2] * 3 + [0.5**2] * 3 + [DENSITY_SIGMA**2, (LIFT_SIGMA * LIFT) ** 2])
    information, seen = np.linalg.inv(prior), np.zeros((times.size, len(ORBITS)), bool)
    turn = prime_meridian_angle(0.0, epoch) + OMEGA[2] * times
    for s, orbit in enumerate(ORBITS):
        for t, satellite in enumerate(kepler(orbit, epoch + times)):
            c, sn = np.cos(turn[t]), np.sin(turn[t])
            to_fixed = np.array([[c, sn, 0.0], [-sn, c, 0.0], [0.0, 0.0, 1.0]])
            r = to_fixed @ satellite[:3]
            v = to_fixed @ satellite[3:] - np.cross(OMEGA, r)
            line, relative = y[t, :3] - r, y[t, 3:] - v
            distance, high = np.linalg.norm(line), np.linalg.norm(y[t, :3])
            n = line / distance
            # how far over the limb, from the angle at the lander between satellite and centre
            limb = np.arcsin(sphere / high)
            if np.arccos(n @ y[t, :3] / high) - limb < MASK:
                continue
            seen[t, s] = True
            across = (relative - (relative @ n) * n) / distance
            for row, sigma in ((np.append(n, np.zeros(3)), RANGE), (np.append(across, n), RATE)):
                h = row @ phi[t]
                information += weight[t] * np.outer(h, h) / sigma**2
    scale = np.sqrt(np.diag(information))
    covariance = np.linalg.inv(information / np.outer(scale, scale)) / np.outer(scale, scale)
    end = phi[-1] @ covariance @ phi[-1].T
    return np.sqrt([np.trace(end[:3, :3]), np.trace(end[3:, 3:])]), seen, y


def test_an_entry_from_the_physics(short):
    scenario = short(
        ("range_sigma_m = 50", f"range_sigma_m = {RANGE}\nrange_rate_sigma_m_s = {RATE}")
    )
    campaign = campaign_of(scenario, 2, density_sigma=DENSITY_SIGMA, lift_sigma=LIFT_SIGMA)
    figure = FIGURES["iau-sphere"]
    found = judge_entries(
        keplerian(*ORBITS.T), campaign, scenario, figure=figure, mask=Mask.constant(MASK)
    )
    for m in range(2):
        times = STEP * np.arange(campaign.stops[m] + 1)
        start = campaign.paths[m, 0]
        sigma, seen, flight = bound(start, found.epochs[m], times, figure.equatorial_radius)
        assert 0 < seen.sum() < seen.size and seen.any(axis=1).all()
        assert np.array_equal(found.seen[m, : times.size], seen)
        miss = np.abs(campaign.paths[m, : times.size] - flight)[:, :3].max()
        assert miss < 0.1  # Runge-Kutta steps of two seconds
        # air, whose density goes with exp(-r/H), is then another by 0.1/H at most
        assert found.sigma[m, 0] == pytest.approx(sigma, rel=0.1 / H)


def test_the_filter_ends_where_least_squares_do(short):
    """All ranges of an entry at once, with the prior, by Gauss and Newton: the same estimate."""
    scenario = short()
    campaign, figure = campaign_of(scenario, 1, electrons=None), FIGURES["iau-sphere"]
    found = judge_entries(
        keplerian(*ORBITS.T), campaign, scenario, figure=figure, mask=Mask.constant(MASK)
    )
    beacons, seen = entry_beacons(found, 0), found.seen[0]
    times, rng = beacons.times, np.random.default_rng(0)
    flight = fly(campaign.paths[0, 0], times)
    ranges = np.linalg.norm(flight[:, None, :3] - beacons.r, axis=2)
    ranges += RANGE * rng.standard_normal(ranges.shape)
    sigma = np.array([1000.0] * 3 + [0.5] * 3)
    first = flight[0] + sigma * rng.standard_normal(6)
    x = first
    for _ in range(3):
        phi = derivatives(x, times)[..., :6]
        line = fly(x, times)[:, None, :3] - beacons.r
        distance = np.linalg.norm(line, axis=2)
        h = np.einsum("tni,tij->tnj", line / distance[..., None], phi[:, :3])[seen]
        information = np.diag(sigma**-2.0) + h.T @ h / RANGE**2
        gradient = (first - x) / sigma**2 + h.T @ (ranges - distance)[seen] / RANGE**2
        x = x + np.linalg.solve(information, gradient)
    states, _ = run_filter(
        scenario.model, first, beacons, seen, scenario.measurements,
        replace(scenario.settings, covariance0=np.diag(sigma**2)),
        np.stack([ranges, 0 * ranges], axis=2),
    )  # fmt: skip
    error = states[-1] - fly(x, times)[-1]
    covariance = phi[-1] @ np.linalg.inv(information) @ phi[-1].T
    # one pass leaves out curvature: of a first error of sqrt(3) km its square over twice 1e4 km,
    # 0.15 m, in every range alike
    limit = seen.sum() * (0.15 / RANGE) ** 2
    assert error @ np.linalg.solve(covariance, error) < limit
