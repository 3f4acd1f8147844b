"""The smallest constellations with continuous k-fold coverage, every pattern of every size."""

from collections.abc import Sequence
from dataclasses import replace
from math import radians
from pathlib import Path
from typing import Literal

import numpy as np

from compass.api.progress import bar
from compass.api.requirement_search import RequirementSearchResult, needs_of
from compass.api.search_result import SearchResult
from compass.arguments import checked
from compass.cores import cores
from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.orbits.patterns import orbit_radius
from compass.requirement import Requirement
from compass.study import search as engine
from compass.study.requirement_question import Question
from compass.study.requirement_search import search_for

#: Radii tried of a range, evenly apart, its ends among them.
RADII = 9


@checked
def search(
    *,
    max_satellites: int,
    require: str | Path | Sequence[Requirement] | None = None,
    fold: int | None = None,
    mask_deg: float = 0.0,
    region: str | Sequence[str] = (),
    pdop_at_most: float | None = None,
    gdop_at_most: float | None = None,
    share: float = 1.0,
    share_of: Literal["time", "area-time"] = "time",
    radius_km: float | tuple[float, float] | None = None,
    altitude_km: float | None = None,
    orbit: str | None = None,
    repeat: Sequence[int] | None = None,
    least_approach_deg: float = 1.0,
    beyond: int = 0,
    pattern: str = "walker-delta",
    figure: str = "iau-sphere",
    finalists: int = 10,
    days: float | None = None,
    budget_s: float | None = None,
    workers: int | None = None,
    progress: bool = False,
) -> SearchResult | RequirementSearchResult:
    """Find the smallest patterns that meet requirements, or cover the whole sphere k-fold.

    With requirements, a region or a limit on geometry: every pattern of every size at every whole
    degree of inclination, and where tracks are closed every turn over the ground, until the
    smallest that meets all of it. Of a fold alone: every pattern, size after size up to the
    smallest that has it, at its best inclination to 0.01 degree; largest mask margin first.

    Parameters
    ----------
    max_satellites
        Largest size to try; the search ends sooner, with the smallest size that does it.
    require
        File with ``[[requirement]]`` (a design may be one), or requirements.
    fold, mask_deg
        Satellites to be in view at once, above a mask, degrees; instead of a file.
    region
        Where, one or several, as in a ``[[requirement]]``; else everywhere.
    pdop_at_most, gdop_at_most, share, share_of
        Geometry wanted there, and for which share.
    radius_km, altitude_km, orbit, repeat
        One of them: radius, altitude over the equator, ``areosynchronous``, or revolutions and
        rotations of Mars after which the ground track closes. Of requirements the radius may be
        the least and the greatest: `RADII` of that range are tried; the smallest size wins, then
        the lowest.
    least_approach_deg
        Least angle that must lie between two satellites at any time, seen from Mars's centre.
    beyond
        How many sizes to try beyond the smallest, of a fold alone.
    pattern
        ``walker-delta``, ``walker-star`` or ``rosette``.
    figure
        Sphere that is to be covered: ``iau-sphere`` or ``kelly2018-sphere``; a file says its own.
    finalists
        How many of the best get a certificate, and GDOP and availability between proven bounds.
    days
        From the epoch on, for which everything must hold on real orbits that nobody steers, too:
        under all forces, trimmed once where that helps.
    budget_s
        Seconds that each share of geometry wanted may take; by default so many boxes, which is the
        same on any machine.
    workers
        Threads; by default one a core. The result does not depend on it.
    progress
        Show bars on stderr.

    Raises
    ------
    ArgumentError, DesignError
        An option or the file is not allowed.

    Examples
    --------
    >>> import compass
    >>> found = compass.search(fold=1, max_satellites=5, radius_km=20428)
    >>> found.best.constellation.size
    5
    """
    if figure not in FIGURES or not FIGURES[figure].is_sphere:
        spheres = ", ".join(name for name, each in FIGURES.items() if each.is_sphere)
        raise ArgumentError(f"figure = {figure!r}: allowed {spheres}")
    least, threads = radians(least_approach_deg), cores(workers)
    regions = (region,) if isinstance(region, str) else tuple(region)
    named = (("pdop", pdop_at_most), ("gdop", gdop_at_most))
    limits = [(name, limit) for name, limit in named if limit is not None]
    if require is None and not regions and not limits and days is None:
        return _covering(
            fold,
            mask_deg,
            orbit_radius(_one(radius_km), altitude_km, orbit, repeat, FIGURES[figure])[0],
            figure,
            pattern,
            max_satellites,
            beyond,
            finalists,
            least_approach_deg,
            threads,
            progress,
        )
    needs = needs_of(
        require,
        regions,
        fold=fold,
        mask_deg=mask_deg,
        limits=limits,
        share=share,
        share_of=share_of,
        figure=figure,
    )
    patterns = []
    for one_km in _radii(radius_km):
        radius, closed = orbit_radius(one_km, altitude_km, orbit, repeat, needs.figure)
        question = Question(
            needs.requirements,
            needs.figure,
            needs.mask,
            radius,
            closed,
            least,
            (pattern,),
            max_satellites,
            budget_s,
            needs.signal,
            days,
        )
        outcome = search_for(
            question,
            finalists=min(finalists, 5),
            workers=threads,
            progress=lambda sizes, km=radius / 1e3: bar(progress, f"sizes at {km:.6g} km", sizes),
        )
        patterns.append(RequirementSearchResult(question, outcome))
    if len(patterns) == 1:
        return patterns[0]
    return replace(min(patterns, key=lambda one: one.size), heights=tuple(patterns))


def _covering(
    fold: int | None,
    mask_deg: float,
    radius: float,
    figure: str,
    pattern: str,
    max_satellites: int,
    beyond: int,
    finalists: int,
    least_approach_deg: float,
    workers: int,
    progress: bool,
) -> SearchResult:
    """Smallest patterns that cover the whole sphere."""
    if fold is None:
        raise ArgumentError("fold: missing; give it, a region and a limit, or a file (require)")
    least = radians(least_approach_deg)
    covering = engine.search(
        fold,
        radians(mask_deg),
        radius=radius,
        figure=FIGURES[figure],
        largest=max_satellites,
        beyond=beyond,
        kind=pattern,
        finalists=finalists,
        least_approach=least,
        workers=workers,
        progress=lambda work, total: bar(progress, "patterns", work, total=total),
    )
    return SearchResult(
        fold,
        mask_deg,
        radius / 1e3,
        figure,
        pattern,
        max_satellites,
        beyond,
        tuple(c for c in covering if c.closest_approach >= least),
        least_approach_deg,
        tuple(c for c in covering if c.closest_approach < least),
    )


def _one(radius_km: float | tuple[float, float] | None) -> float | None:
    """The one radius of a fold alone, which has no range.

    Raises
    ------
    ArgumentError
        It has.
    """
    if isinstance(radius_km, tuple):
        raise ArgumentError("radius_km: a range is for requirements; add a region, such as globe")
    return radius_km


def _radii(radius_km: float | tuple[float, float] | None) -> list[float | None]:
    """Radii to try: the one given, or some from the least to the greatest.

    Raises
    ------
    ArgumentError
        The least is not below the greatest.
    """
    if not isinstance(radius_km, tuple):
        return [radius_km]
    low, high = radius_km
    if not low < high:
        raise ArgumentError(f"radius_km = {low:g} to {high:g}: the least first, below the greatest")
    return [float(each) for each in np.linspace(low, high, RADII)]
