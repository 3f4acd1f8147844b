"""Landing navigation on many patterns at once: what a study wants to know of each."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.bodies import MARS_GM, sidereal_day
from compass.core.entry.information import Limb
from compass.core.entry.pattern_unknowns import NotKnown
from compass.core.entry.patterns import Entries, judge_patterns
from compass.entry.campaign import Campaign
from compass.entry.unknowns import covariance_roots
from compass.errors import ArgumentError
from compass.frames import prime_meridian_angle
from compass.inputs.study import Study
from compass.orbits import Constellation
from compass.orbits.period import closing_days
from compass.quantities.merits import merits_of, worked_out
from compass.sites import Mask
from compass.study.candidates import make_constellation, patterns_of
from compass.study.draw_bounds import entry_sides, side_columns
from compass.study.judge import (
    campaign_of,
    check_measurements,
    doubts_of,
    due,
    ground_of,
    judge_entries,
    turned_gains,
)


def entries_of(study: Study) -> Campaign:
    """The entries that a study judges its candidates by."""
    entry = study.entry
    assert entry is not None
    return campaign_of(
        entry.scenario,
        entry.samples,
        study.seed,
        density_sigma=entry.density_sigma,
        lift_sigma=entry.lift_sigma,
        ground=ground_of(entry.sites, entry.regions),
    )


def judged(study: Study, campaign: Campaign, c: Constellation, mask_deg: float) -> dict[str, float]:
    """Landing navigation on any orbits, with all that is not known; one number a figure.

    And the bounds that so few entries leave of those that the study sorts by or limits.
    """
    entry = study.entry
    assert entry is not None
    mask = Mask.constant(float(np.radians(mask_deg)))
    judgement = judge_entries(
        c, campaign, entry.scenario, figure=study.figure, mask=mask,
        unknowns=doubts_of(entry.scenario, entry.doubts).of(study.signal, c.size),
    )  # fmt: skip
    figures = _worked_out(study, judgement.known)
    return {name: float(values[0]) for name, values in figures.items()}


def _worked_out(study: Study, known: dict[str, Any]) -> dict[str, NDArray[np.float64]]:
    """Figures of entries, and bounds of those that the study names."""
    assert study.entry is not None
    whole = {**known, "goal_m": study.entry.goal}
    return worked_out("entry", whole) | entry_sides(study, whole)


def entry_figures(study: Study, rows: NDArray) -> dict[str, NDArray[np.float64]]:
    """Landing navigation over entries wherever the study lands and at any time, (n,) each.

    The figures are those of `compass.study.judge.judge` without the losses of satellites, to
    within its interpolation of orbits (2e-6 m at areosynchronous height) and rounding; and bounds
    as of `compass.study.draw_bounds.entry_sides`.

    Raises
    ------
    ArgumentError
        As `compass.study.judge.judge_entries`.
    """
    assert study.entry is not None
    if not study.entry.scenario.measurements.plain:
        entries = entries_of(study)
        each = [
            judged(study, entries, make_constellation(row), float(row["mask_deg"])) for row in rows
        ]
        names = (*merits_of("entry"), *side_columns(study, "entry"))
        return {name: np.array([one[name] for one in each]) for name in names}
    scenario, sphere = study.entry.scenario, study.figure.equatorial_radius
    check_measurements(scenario)
    radius, mask = rows["radius_km"] * 1e3, np.radians(rows["mask_deg"])
    if np.any(radius <= sphere):
        raise ArgumentError(
            f"radius_km = {radius.min() / 1e3:g}: must be above the surface, {sphere / 1e3:g} km"
        )
    campaign = entries_of(study)
    motion = np.sqrt(MARS_GM.value / radius**3)
    days, _ = closing_days(motion[:, np.newaxis])
    begins = days[:, np.newaxis] * sidereal_day() * campaign.arrivals.phase
    most = int(rows["satellites"].max(initial=0))
    unknown = doubts_of(scenario, study.entry.doubts).of(study.signal, most)
    sigma = np.empty((*begins.shape, 2))
    blind = np.empty(begins.shape, dtype=bool)
    counts = np.empty((rows.size, most + 1), dtype=np.int64)
    judge_patterns(
        patterns_of(rows),
        radius,
        motion,
        begins,
        prime_meridian_angle(0.0, begins),
        Entries(
            campaign.paths,
            turned_gains(campaign.paths, campaign.gains, unknown.turn),
            campaign.stops,
            campaign.arrival_probability * due(scenario, campaign.times),
        ),
        scenario.measurements.radio_variances()[:2],
        campaign.model.omega,
        float(campaign.times[1]),
        Limb(sphere, np.sin(mask), np.cos(mask)),
        NotKnown(unknown.clock_sigmas(), _roots(study, rows), 3 if unknown.turn else 0),
        sigma,
        blind,
        counts,
    )
    found = {
        "position_m": sigma[..., 0],
        "velocity_m_s": sigma[..., 1],
        "counts": counts,
        "longest": campaign.longest,
        "blind": blind,
    }
    return _worked_out(study, found)


def _roots(study: Study, rows: NDArray) -> NDArray:
    """Roots of what landers of a study do not know of each candidate's satellites.

    A clock and a bias do the same to a range one way, so their variances are one.
    """
    assert study.entry is not None
    doubts = doubts_of(study.entry.scenario, study.entry.doubts)
    sizes = rows["satellites"]
    covariances = np.zeros((rows.size, sizes.max(initial=0), 4, 4))
    for n in np.unique(sizes):
        covariances[sizes == n, :n] = doubts.of(study.signal, n).satellites
    covariances[..., 3, 3] += doubts.range_bias_m**2
    if not covariances.any():
        return np.zeros((*covariances.shape[:3], 0))
    return covariance_roots(covariances)
