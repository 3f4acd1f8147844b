"""The worst entry, searched for rather than met by chance."""

from typing import Any

import numpy as np

from compass.entry.arrivals import Arrivals
from compass.entry.campaign import Campaign
from compass.entry.ground import Ground
from compass.entry.unknowns import NOTHING, Unknowns
from compass.errors import ArgumentError
from compass.frames import Figure
from compass.inputs.scenario import Scenario
from compass.orbits import Constellation
from compass.sites import Mask
from compass.study.judge import judge_entries
from compass.study.judgement import Judgement

#: How many of the worst entries so far are looked around, with how many new ones a round.
SURVIVORS, BATCH = 16, 128

#: How often the campaign is judged again at other moments first: its flights stay as they are.
MOMENTS = 12

#: First reach of the search in latitude, longitude, azimuth (radians) and phase of arrival, and
#: what is left of it after each round.
REACH, SHRINK = np.array([0.3, 0.3, 0.8, 0.03]), 0.7


def worst_entry(
    constellation: Constellation,
    scenario: Scenario,
    campaign: Campaign,
    *,
    figure: Figure,
    mask: Mask,
    rounds: int = 12,
    seed: int = 0,
    start: Judgement | None = None,
    lost: int | None = None,
    unknowns: Unknowns = NOTHING,
) -> dict[str, Any]:
    """Worst bound of position at deployment that a search finds, and where and when.

    The place is that of deployment, the azimuth and the epoch those of entry.

    The campaign's flights are judged again at other moments; then new entries are drawn around
    the worst so far, ever closer, the worst kept. The bound jumps where a satellite rises, so no
    gradient is used; what is found is a lower limit of the true worst, never below that of the
    campaign.

    Parameters
    ----------
    constellation, scenario, campaign, figure, mask, unknowns
        As in `compass.study.judge.judge_entries`.
    rounds, seed
        How often to draw anew, and from which seed.
    start
        Judgement of the campaign, if it is there already.
    lost
        A satellite whose loss is looked at too: what is worst without it comes as
        ``after_loss``, of all entries that either search has tried.
    """
    place: dict[str, Any] = {"figure": figure, "mask": mask, "unknowns": unknowns}
    found = start or judge_entries(constellation, campaign, scenario, **place)
    generator = np.random.default_rng(seed)
    cases = (None,) if lost is None else (None, lost)
    best = {case: _worst(found, np.empty((0, 10)), case) for case in cases}
    for _ in range(MOMENTS):
        moved = campaign.at(generator.random(campaign.size))
        later = judge_entries(constellation, moved, scenario, **place)
        best = {case: _worst(later, rows, case) for case, rows in best.items()}
    for case in cases:
        for k in range(rounds):
            tried = _around(best[case], SHRINK**k * REACH, generator, campaign.ground)
            try:
                flown = campaign.again(tried)
            except ArgumentError:  # one of them comes to no deployment
                break
            found = judge_entries(constellation, flown, scenario, **place)
            best = {one: _worst(found, rows, one) for one, rows in best.items()}
    result = _as_plain(best[None][0])
    if lost is not None:
        result["after_loss"] = _as_plain(best[lost][0])
    return result


def _around(
    best: np.ndarray, reach: np.ndarray, generator: np.random.Generator, ground: Ground | None
) -> Arrivals:
    """`BATCH` arrivals around the worst so far, none of them outside of the ground."""
    centres = np.repeat(best[:, :4], -(-BATCH // len(best)), axis=0)[:BATCH]
    tried = centres + reach * generator.uniform(-1, 1, centres.shape)
    latitude = np.clip(tried[:, 0], -np.pi / 2, np.pi / 2)
    arrivals = Arrivals(latitude, tried[:, 1], tried[:, 2], tried[:, 3] % 1)
    return arrivals if ground is None else ground.kept(arrivals, Arrivals(*centres.T))


def _as_plain(row: np.ndarray) -> dict[str, Any]:
    """What a row of `_worst` says."""
    return {
        "value": float(row[4]),
        "latitude_deg": float(np.degrees(row[5])),
        "longitude_deg": float(np.degrees(row[6])),
        "azimuth_deg": float(np.degrees(row[9]) % 360),
        "epoch_s": float(row[7]),
        "in_view": int(row[8]),
    }


def _worst(judgement: Judgement, others: np.ndarray, lost: int | None) -> np.ndarray:
    """Worst first, of a judgement and other rows.

    What was asked (4), sigma, place (2), epoch, fold, azimuth at entry.
    """
    a = judgement.campaign.asked
    latitude, longitude = judgement.campaign.deployment_place
    flying = np.arange(judgement.campaign.times.size) <= judgement.campaign.stops[:, None]
    kept = np.arange(judgement.constellation.size) != lost
    count = judgement.seen[:, :, kept].sum(axis=2)
    fold = np.where(flying, count, judgement.constellation.size).min(axis=1)
    sigma = judgement.sigma[:, 0 if lost is None else 1 + lost, 0]
    rows = np.stack(
        [
            a.latitude, a.longitude, a.azimuth, a.phase, sigma, latitude, longitude,
            judgement.epochs, fold, judgement.campaign.arrivals.azimuth,
        ],
        axis=1,
    )  # fmt: skip
    both = np.concatenate([others, rows])
    return both[np.argsort(-both[:, 4], kind="stable")[:SURVIVORS]]
