"""Landing navigation on many patterns at once: what a study wants to know of each."""

import numpy as np
from numpy.typing import NDArray

from compass.bodies import MARS_GM, sidereal_day
from compass.core.entry.patterns import Entries, Limb, judge_patterns
from compass.design import Design
from compass.entry.campaign import Campaign
from compass.entry.doubts import NO_DOUBTS
from compass.errors import ArgumentError
from compass.frames import prime_meridian_angle
from compass.inputs.study import Study
from compass.orbits import Constellation
from compass.orbits.period import closing_days
from compass.quantities.merits import merits_of, worked_out
from compass.sites import Mask
from compass.study.candidates import make_constellation, patterns_of
from compass.study.judge import (
    campaign_of,
    check_measurements,
    doubts_of,
    due,
    ground_of,
    judge_entries,
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
    """Landing navigation on any orbits, with all that is not known; one number a figure."""
    entry = study.entry
    assert entry is not None
    mask = Mask.constant(float(np.radians(mask_deg)))
    design = Design(c, figure=study.figure, mask=mask, signal=study.signal)
    judgement = judge_entries(
        c, campaign, entry.scenario, figure=study.figure, mask=mask,
        unknowns=doubts_of(entry.scenario, entry.doubts).of(design),
    )  # fmt: skip
    figures = worked_out("entry", {**judgement.known, "goal_m": entry.goal})
    return {name: float(values[0]) for name, values in figures.items()}


def entry_figures(study: Study, rows: NDArray) -> dict[str, NDArray[np.float64]]:
    """Landing navigation over entries wherever the study lands and at any time, (n,) each.

    The figures are those of `compass.study.judge.judge` without the losses of satellites, to
    within its interpolation of orbits (2e-6 m at areosynchronous height) and rounding.

    Raises
    ------
    ArgumentError
        As `compass.study.judge.judge_entries`.
    """
    assert study.entry is not None
    plain = study.entry.scenario.measurements.plain
    doubts = doubts_of(study.entry.scenario, study.entry.doubts)
    known = doubts == NO_DOUBTS and study.signal is None
    if not (known and plain):  # the kernel of many patterns carries nothing unknown
        entries = entries_of(study)
        each = [
            judged(study, entries, make_constellation(row), float(row["mask_deg"])) for row in rows
        ]
        return {name: np.array([one[name] for one in each]) for name in merits_of("entry")}
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
    sigma = np.empty((*begins.shape, 2))
    blind = np.empty(begins.shape, dtype=bool)
    counts = np.empty((rows.size, rows["satellites"].max(initial=0) + 1), dtype=np.int64)
    judge_patterns(
        patterns_of(rows),
        radius,
        motion,
        begins,
        prime_meridian_angle(0.0, begins),
        Entries(
            campaign.paths,
            campaign.gains,
            campaign.stops,
            campaign.arrival_probability * due(scenario, campaign.times),
        ),
        scenario.measurements.radio_variances()[:2],
        campaign.model.omega,
        float(campaign.times[1]),
        Limb(sphere, np.sin(mask), np.cos(mask)),
        sigma,
        blind,
        counts,
    )
    found = {
        "position_m": sigma[..., 0],
        "velocity_m_s": sigma[..., 1],
        "counts": counts,
        "blind": blind,
        "goal_m": study.entry.goal,
    }
    return worked_out("entry", found)
