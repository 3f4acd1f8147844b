"""A constellation judged as radio beacons of a lander, anywhere and at any time."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.core.judging import PACKED, bounds, information
from compass.entry.campaign import Campaign, draw_arrivals, fly_campaign
from compass.entry.fisher import noise_variances
from compass.entry.model import EntryModel
from compass.entry.radio import WAKE, ElectronModel, ElectronTable
from compass.entry.trajectory import Trigger
from compass.errors import ArgumentError
from compass.frames import Figure, prime_meridian_angle
from compass.inputs.scenario import Scenario
from compass.orbits import Constellation, repeat_period, states_mci
from compass.sites import Mask

Array = NDArray[np.float64]

#: Seconds between the nodes from which satellites are interpolated.
NODE_STEP = 30.0

#: Entries handed to a thread at once.
BLOCK = 64


@dataclass(frozen=True)
class _Request:
    """What a campaign depends on, so that one is flown for all constellations."""

    scenario: Scenario = field(compare=False)
    digest: str
    model: EntryModel
    electrons: ElectronModel | ElectronTable | None
    samples: int
    seed: int


@lru_cache(maxsize=4)
def _flown(request: _Request) -> Campaign:
    scenario = request.scenario
    return fly_campaign(
        scenario.model,
        scenario.state,
        scenario.settings.covariance0,
        scenario.times,
        draw_arrivals(request.samples, request.seed),
        trigger=deployment_trigger(scenario),
        electrons=request.electrons,
    )


def campaign_of(
    scenario: Scenario,
    samples: int,
    seed: int = 0,
    electrons: ElectronModel | ElectronTable | None = WAKE,
) -> Campaign:
    """Entries of the scenario's lander spread over sites, azimuths and time; kept for reuse.

    Parameters as in `judge`; the scenario's own site, beacons and bias of the truth play no role.
    """
    request = _Request(scenario, scenario.digest, scenario.model, electrons, samples, seed)
    return _flown(request)


def deployment_trigger(scenario: Scenario) -> Trigger | None:
    """Return the scenario's trigger whose name speaks of a parachute, if there is one."""
    for trigger in scenario.triggers:
        if "parachute" in trigger.name.lower():
            return trigger
    return None


@dataclass(frozen=True)
class Judgement:
    """How well landers navigate on a constellation, entry by entry.

    Attributes
    ----------
    constellation, campaign
        Who was judged, on what.
    epochs
        Seconds after the constellation's epoch at which each entry begins, (m,).
    seen
        Which satellites are in view, (m, t, n).
    information
        Without prior, in prior-whitened coordinates, (m, 6, 6).
    shares
        The same by satellite, packed, (m, n, 21).
    sigma
        Posterior Cramer-Rao sigma of position (m) and velocity (m/s) at deployment, (m, 1 + n,
        2): with all satellites, then without each of them.
    """

    constellation: Constellation
    campaign: Campaign
    epochs: Array
    seen: NDArray[np.bool_]
    information: Array
    shares: Array
    sigma: Array

    @property
    def position_sigma(self) -> Array:
        """Of each entry with all satellites, m, shape (m,)."""
        return self.sigma[:, 0, 0]

    @property
    def worst_loss(self) -> int | None:
        """Satellite without which the 95th percentile of the position bound is largest."""
        if not self.constellation.size:
            return None
        return int(np.argmax(np.percentile(self.sigma[:, 1:, 0], 95.0, axis=0)))

    def figures(self, goal: float = 10.0) -> dict[str, Any]:
        """Figures of merit as plain values, with those after the worst loss of one satellite.

        Parameters
        ----------
        goal
            Position sigma wanted at deployment, metres.
        """
        result = self._figures(None, goal)
        lost = self.worst_loss
        if lost is not None:
            name = self.constellation.satellite_names[lost]
            result["after_loss"] = {"satellite": name, **self._figures(lost, goal)}
        return result

    def _figures(self, lost: int | None, goal: float) -> dict[str, Any]:
        column = 0 if lost is None else 1 + lost
        position, velocity = self.sigma[:, column].T
        counts, f = self._counts(lost), self.information
        if lost is not None:
            kept = np.delete(self.shares, lost, axis=1).sum(axis=1)
            f = _unpacked(kept)
        spectrum, floor = _spectrum(f, int(self.campaign.stops.max(initial=0)) + 1)
        blind = spectrum[:, 0] <= floor
        with np.errstate(divide="ignore"):
            log_det = np.log(np.where(blind[:, None], 0.0, spectrum)).sum(axis=1)
        worst = int(position.argmax())
        latitude, longitude = self.campaign.deployment_place
        return {
            "in_view": {"min": int(counts.min()), "median": float(np.median(counts))},
            "crlb_position_m": {
                **_percentiles(position),
                "worst": float(position[worst]),
                "worst_latitude_deg": float(np.degrees(latitude[worst])),
                "worst_longitude_deg": float(np.degrees(longitude[worst])),
                "worst_azimuth_deg": float(np.degrees(self.campaign.arrivals.azimuth[worst])),
                "worst_epoch_s": float(self.epochs[worst]),
            },
            "crlb_velocity_m_s": {**_percentiles(velocity), "worst": float(velocity.max())},
            "share_within_goal": float((position <= goal).mean()),
            "unobservable_share": float(blind.mean()),
            "fisher_log_det": {
                "p50": float(np.percentile(log_det, 50, method="inverted_cdf")),
                "p5": float(np.percentile(log_det, 5, method="inverted_cdf")),
            },
            "fisher_trace": {"p50": float(np.median(spectrum.sum(axis=1)))},
        }

    def _counts(self, lost: int | None) -> NDArray[np.int64]:
        """Satellites in view at every epoch up to deployment, over all entries."""
        counts = self.seen.sum(axis=2)
        if lost is not None:
            counts = counts - self.seen[:, :, lost]
        flying = np.arange(self.campaign.times.size) <= self.campaign.stops[:, None]
        return np.asarray(counts[flying])


def judge(
    constellation: Constellation,
    scenario: Scenario,
    *,
    samples: int,
    seed: int = 0,
    figure: Figure,
    mask: Mask,
    goal: float = 10.0,
) -> dict[str, Any]:
    """Figures of merit of a constellation for the landers of a scenario, as plain values.

    `judge_entries` says what they rest on and what is raised.
    """
    found = judge_entries(
        constellation, campaign_of(scenario, samples, seed), scenario, figure=figure, mask=mask
    )
    return found.figures(goal)


def judge_entries(
    constellation: Constellation,
    campaign: Campaign,
    scenario: Scenario,
    *,
    figure: Figure,
    mask: Mask,
    threads: int = 1,
) -> Judgement:
    """Information and posterior Cramer-Rao bound in each entry of a campaign.

    A range that arrives with probability lambda is worth ``lambda h^T h / sigma^2`` in
    expectation. The entries begin at their phases of the ground tracks' repeat period.

    Parameters
    ----------
    constellation
        The beacons, in two-body motion.
    campaign
        The entries, of `campaign_of`.
    scenario
        What is measured, and how well.
    figure
        Its equatorial radius is that of the sphere that blocks the view.
    mask
        Elevation over the limb below which a satellite is not heard; of one that depends on
        azimuth the highest, for a lander knows no horizon of hills.
    threads
        Threads; the result does not depend on them.

    Raises
    ------
    ArgumentError
        Measurements in turn, process noise, or a satellite that comes down to the surface.
    """
    _check(constellation, scenario, figure)
    size, n = campaign.size, constellation.size
    epochs = campaign.arrivals.phase * repeat_period(constellation).duration
    angles = prime_meridian_angle(constellation.epoch, epochs)
    flown = int(campaign.stops.max())
    nodes = int(np.ceil(campaign.times[flown] / NODE_STEP)) + 1
    weights = campaign.arrival_probability * due(scenario, campaign.times)
    variances = noise_variances(scenario.measurements)
    seen = np.zeros((size, campaign.times.size, n), dtype=bool)
    shares, sigma = np.zeros((size, n, PACKED)), np.empty((size, 1 + n, 2))

    def work(first: int) -> None:
        part = slice(first, min(first + BLOCK, size))
        when = epochs[part, None] + NODE_STEP * np.arange(nodes)
        r, v = states_mci(constellation, when.ravel())
        information(
            campaign.paths[part],
            campaign.gains[part],
            campaign.stops[part],
            weights[part],
            variances,
            r,
            v,
            angles[part],
            campaign.model.omega,
            NODE_STEP,
            float(campaign.times[1]),
            figure.equatorial_radius,
            np.sin(mask.highest),
            np.cos(mask.highest),
            seen[part],
            shares[part],
        )
        bounds(shares[part], campaign.gains[part], campaign.stops[part], sigma[part])

    blocks: Sequence[int] = range(0, size, BLOCK)
    if threads == 1:
        for first in blocks:
            work(first)
    else:
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(work, blocks))
    return Judgement(
        constellation, campaign, epochs, seen, _unpacked(shares.sum(axis=1)), shares, sigma
    )


def due(scenario: Scenario, times: Array) -> NDArray[np.bool_]:
    """Whether measurements are taken at `times` (s), if anything is in view."""
    return scenario.measurements.taken(np.ones((times.size, 1), dtype=bool), times)[:, 0]


def _check(constellation: Constellation, scenario: Scenario, figure: Figure) -> None:
    if scenario.measurements.in_turn:
        raise ArgumentError(
            f"{scenario.label}: measurements.in_turn = true: judged is what all satellites in "
            "view tell at once; set it to false"
        )
    if np.any(scenario.settings.noise):
        raise ArgumentError(
            f"{scenario.label}: filter.process_noise_si: judged is the bound without process "
            "noise; leave it out"
        )
    lowest = constellation.periapsis_radius.min(initial=np.inf)
    if lowest <= figure.equatorial_radius:
        raise ArgumentError(
            f"{constellation.name}: comes down to radius {lowest / 1e3:g} km; must stay above the "
            f"surface, {figure.equatorial_radius / 1e3:g} km"
        )


def _unpacked(packed: Array) -> Array:
    """Symmetric matrices (..., 6, 6) from their packed lower triangles (..., 21)."""
    full = np.empty((*packed.shape[:-1], 6, 6))
    a, b = np.tril_indices(6)
    full[..., a, b] = full[..., b, a] = packed
    return full


def _spectrum(f: Array, terms: int) -> tuple[Array, Array]:
    """Eigenvalues, ascending, (m, 6), and what rounding leaves of a zero one, (m,).

    A sum of m terms is off by at most ``m eps`` times its trace (all terms are positive
    semi-definite), the eigenvalues of a symmetric matrix by at most ``6 eps`` times the largest
    more: below ``(m + 6) eps trace`` an eigenvalue cannot be told from zero.
    """
    values = np.linalg.eigvalsh(f)
    return values, (terms + 6) * np.finfo(float).eps * values.sum(axis=1)


def _percentiles(values: Array) -> dict[str, float]:
    return {f"p{q}": float(np.percentile(values, q)) for q in (50, 95)}
