"""Landing navigation on many patterns at once: what a study wants to know of each."""

import numpy as np
from numpy.typing import NDArray

from compass.bodies import MARS_GM, sidereal_day
from compass.core.entry.patterns import judge_patterns
from compass.entry.doubts import NO_DOUBTS
from compass.errors import ArgumentError
from compass.frames import prime_meridian_angle
from compass.inputs.merit import MERITS
from compass.inputs.study import Study
from compass.orbits import Constellation
from compass.orbits.period import closing_days
from compass.sites import Mask
from compass.study.candidates import make_constellation, pattern_columns
from compass.study.judge import campaign_of, check_measurements, due, judge
from compass.study.judgement import median_number

#: Figures of merit that landers give.
MERITS_OF_ENTRY = tuple(name for name, merit in MERITS.items() if merit.stage == "entry")


def judged(study: Study, c: Constellation, mask_deg: float) -> dict[str, float]:
    """Landing navigation on any orbits, with all that is not known; one number a figure."""
    entry = study.entry
    assert entry is not None
    found = judge(
        c, entry.scenario, samples=entry.samples, seed=study.seed, figure=study.figure,
        mask=Mask.constant(float(np.radians(mask_deg))), goal=entry.goal,
        unknowns=entry.doubts.of(None), density_sigma=entry.density_sigma,
        lift_sigma=entry.lift_sigma,
    )  # fmt: skip
    split = {name: name.partition(".") for name in MERITS_OF_ENTRY}
    return {
        name: float(found[group][key] if key else found[group])
        for name, (group, _, key) in split.items()
    }


def entry_figures(study: Study, rows: NDArray) -> dict[str, NDArray[np.float64]]:
    """Landing navigation over entries everywhere and at any time, (n,) each.

    The figures are those of `compass.study.judge.judge` without the losses of satellites, to
    within its interpolation of orbits (2e-6 m at areosynchronous height) and rounding.

    Raises
    ------
    ArgumentError
        As `compass.study.judge.judge_entries`.
    """
    assert study.entry is not None
    plain = study.entry.scenario.measurements.plain
    if study.entry.doubts != NO_DOUBTS or not plain:  # the kernel of many patterns carries none
        each = [judged(study, make_constellation(row), float(row["mask_deg"])) for row in rows]
        return {name: np.array([one[name] for one in each]) for name in MERITS_OF_ENTRY}
    scenario, sphere = study.entry.scenario, study.figure.equatorial_radius
    check_measurements(scenario)
    radius, mask = rows["radius_km"] * 1e3, np.radians(rows["mask_deg"])
    if np.any(radius <= sphere):
        raise ArgumentError(
            f"radius_km = {radius.min() / 1e3:g}: must be above the surface, {sphere / 1e3:g} km"
        )
    campaign = campaign_of(
        scenario,
        study.entry.samples,
        study.seed,
        density_sigma=study.entry.density_sigma,
        lift_sigma=study.entry.lift_sigma,
    )
    motion = np.sqrt(MARS_GM.value / radius**3)
    days, _ = closing_days(motion[:, np.newaxis])
    begins = days[:, np.newaxis] * sidereal_day() * campaign.arrivals.phase
    sigma = np.empty((*begins.shape, 2))
    blind = np.empty(begins.shape, dtype=bool)
    counts = np.empty((rows.size, rows["satellites"].max(initial=0) + 1), dtype=np.int64)
    judge_patterns(
        *pattern_columns(rows),
        radius,
        motion,
        begins,
        prime_meridian_angle(0.0, begins),
        campaign.paths,
        campaign.gains,
        campaign.stops,
        campaign.arrival_probability * due(scenario, campaign.times),
        scenario.measurements.radio_variances()[:2],
        campaign.model.omega,
        float(campaign.times[1]),
        sphere,
        np.sin(mask),
        np.cos(mask),
        sigma,
        blind,
        counts,
    )
    (p50, v50), (p95, v95) = np.percentile(sigma, (50, 95), axis=1).transpose(0, 2, 1)
    return {
        "in_view.min": (counts > 0).argmax(axis=1).astype(float),
        "in_view.median": median_number(counts),
        "crlb_position_m.p50": p50,
        "crlb_position_m.p95": p95,
        "crlb_velocity_m_s.p50": v50,
        "crlb_velocity_m_s.p95": v95,
        "share_within_goal": (sigma[..., 0] <= study.entry.goal).mean(axis=1),
        "unobservable_share": blind.mean(axis=1),
    }
