"""A flight and the filter on it as plain values, names with their units."""

from typing import Any

import numpy as np

from compass.api.land_words import observability_sentence
from compass.document.evidence import Sampled
from compass.entry.accuracy import Spread
from compass.entry.assess import Assessment
from compass.entry.state import longitude_degrees
from compass.inputs.scenario import Scenario
from compass.units import KM

#: How well what is drawn is known.
EVIDENCE = (
    "beside percentiles and shares of entries or runs drawn as _interval: bounds that hold that of "
    "all in 95 of 100 cases"
)


def entry_facts(scenario: Scenario, assessment: Assessment) -> dict[str, Any]:
    """Return the numbers as one JSON object, names with their units."""
    flight, mc, bound = assessment.flight, assessment.monte_carlo, assessment.bound
    at, ground, consistency = assessment.accuracy, assessment.ground, assessment.consistency
    observability, blind = assessment.observability, assessment.blind
    return {
        "scenario": scenario.name,
        "rotation": flight.model.rotation,
        "ending": flight.ending,
        "events": [
            {
                "name": event.name,
                "time_s": event.time,
                "altitude_km": (event.state[0] - flight.model.planet_radius) / KM,
                "speed_m_s": event.state[3],
                "latitude_deg": np.degrees(event.state[2]),
                "longitude_deg": longitude_degrees(event.state[1]),
            }
            for event in flight.events
        ],
        "end": {
            "time_s": flight.times[-1],
            "altitude_km": flight.altitude[-1] / KM,
            "speed_m_s": flight.states[-1, 3],
            "latitude_deg": np.degrees(flight.states[-1, 2]),
            "longitude_deg": longitude_degrees(flight.states[-1, 1]),
            "flight_path_deg": np.degrees(flight.states[-1, 4]),
        },
        "beacons": list(assessment.beacons.names),
        "readings": dict(assessment.readings),
        "in_view_share": assessment.seen.mean(axis=0),
        "evidence": {
            "in_view_share": str(Sampled(how=f"at the {flight.times.size} epochs of the flight")),
            "navigation": (
                f"bounds of a covariance; rms and nees of {len(mc.errors)} runs, rms with its "
                "standard error beside it as _sampling"
            ),
            "others": EVIDENCE,
        },
        "in_view": {
            "min": assessment.seen.sum(axis=1).min(),
            "max": assessment.seen.sum(axis=1).max(),
        },
        "observability": {
            "rank_min": observability.rank.min(),
            "degree_si_min": observability.spherical_degree.min(),
            "degree_scaled_min": observability.degree.min(),
            "index_mean": observability.index.mean(),
            "worst_time_s": flight.times[assessment.blind_epoch],
            "hidden": list(blind.words),
            "weakest": blind.weakest,
            "sentence": observability_sentence(assessment),
        },
        "landing": {
            "at": at.name,
            "time_s": at.time,
            "projected": at.projected,
            "claim_m": assessment.claim_m,
            "knowledge": _spread_facts(at.knowledge),
            "budget": [
                {
                    "source": share.name,
                    **dict(
                        zip(("along_m", "cross_m", "down_m"), share.along_cross_down, strict=True)
                    ),
                    "position_m": share.sigma,
                }
                for share in assessment.budget
            ],
            "delivery": None if at.anywhere else _spread_facts(at.delivery),
            "ground": None
            if ground is None
            else {
                "time_s": ground.time,
                "knowledge": _spread_facts(ground.knowledge),
                "delivery": None if ground.anywhere else _spread_facts(ground.delivery),
            },
        },
        "consistency": {
            "consistent": consistency.holds,
            "sentence": consistency.sentence,
            "ratio": consistency.ratio,
            "nees_worst": consistency.nees[consistency.worst],
            "worst_time_s": flight.times[consistency.worst],
            "nees_interval": [consistency.low, consistency.high],
            "states_estimated": assessment.whole.states,
            "whole_state_consistent": assessment.whole.holds,
        },
        "missed_triggers": list(flight.missed),
        "notes": list(scenario.notes),
        "navigation": {
            "time_s": flight.times,
            "position_bound_m": bound.position_sigma,
            "velocity_bound_m_s": bound.velocity_sigma,
            "position_rms_m": mc.position_rms,
            "position_rms_sampling_m": mc.position_rms_error,
            "velocity_rms_m_s": mc.velocity_rms,
            "velocity_rms_sampling_m_s": mc.velocity_rms_error,
            "nees": mc.mean_nees,
            "runs": len(mc.errors),
            "diverged": int(mc.diverged.sum()),
            "broken": int(mc.broken.sum()),
        },
    }


def _spread_facts(spread: Spread) -> dict[str, Any]:
    """One spread as plain values."""
    ellipse = spread.ellipse
    return {
        "along_m": spread.along_cross_down[0],
        "cross_m": spread.along_cross_down[1],
        "down_m": spread.along_cross_down[2],
        "semi_major_m": ellipse.semi_major,
        "semi_minor_m": ellipse.semi_minor,
        "ellipse_level": ellipse.level,
        "azimuth_deg": np.degrees(ellipse.azimuth),
        "cep_m": spread.cep,
    }
