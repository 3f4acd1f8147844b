"""The best pattern for landers among all of one size."""

import json
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from compass.design import Design
from compass.entry.campaign import Campaign
from compass.entry.unknowns import NOTHING, Unknowns
from compass.errors import ArgumentError
from compass.inputs.scenario import Scenario
from compass.orbits import Constellation
from compass.quantities.percentile import percentile
from compass.study.judge import judge_entries
from compass.study.search import closest_approach, patterns

#: Patterns whose satellites come closer than this (radians, about 350 km at areosynchronous
#: height) are left out: they collide, or would.
LEAST_APPROACH = np.radians(1.0)

#: Inclinations tried first and then around the best, radians.
COARSE, FINE = np.radians(5.0), np.radians(1.0)


def best_rival(
    design: Design,
    scenario: Scenario,
    campaign: Campaign,
    *,
    radius: float | None = None,
    finalists: int = 6,
    unknowns: Unknowns = NOTHING,
    threads: int = 1,
    progress: Callable[..., Iterable[Any]] = lambda items, **_: items,
) -> Constellation:
    """Best Walker delta pattern of a design's size, by the bound's 95th percentile.

    Every pattern at inclinations 5 degrees apart from 20 to 90 on the first eighth of the
    entries; the best few again, 1 degree apart, on all of them.

    Parameters
    ----------
    design
        Size, radius, figure and mask.
    scenario, campaign, unknowns, threads
        As in `compass.study.judge.judge_entries`.
    radius
        Of the orbits, metres; the design's if left out.
    finalists
        How many patterns to look at closely.
    progress
        Wraps the patterns in work, called with ``total`` and ``desc``, as tqdm is.

    Raises
    ------
    ArgumentError
        No radius is given and the design's orbits are not circles of one, its mask depends on
        azimuth, which a rival's file cannot say, or no pattern keeps its satellites apart.
    """
    _check_mask(design)
    c = design.constellation
    if radius is None:
        if not (c.is_circular and np.unique(c.semi_major_axis).size == 1):
            raise ArgumentError(
                f"{design.name}: its orbits are not circles of one radius; say at which radius to "
                "look for a rival"
            )
        radius = float(c.semi_major_axis[0])
    makers = list(patterns("walker-delta", c.size, radius, smallest=c.size))
    few = campaign.first(max(1, campaign.size // 8))

    def score(rival: Constellation, on: Campaign) -> float:
        if closest_approach(rival) < LEAST_APPROACH:
            return np.inf
        found = judge_entries(
            rival,
            on,
            scenario,
            figure=design.figure,
            mask=design.mask,
            unknowns=unknowns,
            threads=threads,
        )
        return float(percentile(found.position_sigma, 95))

    coarse = np.arange(np.radians(20), np.radians(90) + 1e-9, COARSE)
    best = []
    for k, make in enumerate(progress(makers, total=len(makers), desc="patterns")):
        scores = [score(make(float(i)), few) for i in coarse]
        at = int(np.argmin(scores))
        best.append((scores[at], k, coarse[at]))
    close = []
    for value, k, inclination in sorted(best)[:finalists]:
        if np.isfinite(value):
            for i in inclination + np.arange(-COARSE + FINE, COARSE - FINE / 2, FINE):
                rival = makers[k](float(np.clip(i, 0, np.pi / 2)))
                close.append((score(rival, campaign), k, float(i), rival))
    if not close:
        raise ArgumentError(f"{design.name}: no Walker delta of its size keeps satellites apart")
    return min(close, key=lambda found: found[:3])[3]


def _check_mask(design: Design) -> None:
    if not design.mask.is_constant:
        raise ArgumentError(f"{design.name}: a mask by azimuth cannot be carried over")


def rival_toml(rival: Constellation, design: Design, origin: str) -> str:
    """Design file of a rival, with the figure, mask and fold of the design it is to beat.

    Parameters
    ----------
    rival, design
        Of `best_rival`.
    origin
        The command line that found it.
    """
    pattern = rival.pattern
    assert pattern is not None
    _check_mask(design)
    radius_km = float(rival.semi_major_axis[0]) / 1e3
    name = f"Best for landers at {radius_km:.6g} km, {pattern.notation}"
    source = (
        f"Best Walker delta pattern of {pattern.satellites} satellites at its radius for landing "
        "navigation, by the 95th percentile of the position bound at deployment, found by: "
        f"{origin}"
    )
    return "\n".join(
        [
            f"name = {json.dumps(name, ensure_ascii=False)}",
            f"source = {json.dumps(source, ensure_ascii=False)}",
            f'figure = "{design.figure.name}"',
            "",
            "[constellation]",
            f'pattern = "{pattern.kind}"',
            f"satellites = {pattern.satellites}",
            f"planes = {pattern.planes}",
            f"phasing = {pattern.phasing}",
            f"inclination_deg = {np.degrees(pattern.inclination):.10g}",
            f"radius_km = {radius_km!r}",
            "",
            "[coverage]",
            f"mask_deg = {float(np.degrees(design.mask.lowest)):.10g}",
            f"fold = {design.fold}",
            "",
        ]
    )
