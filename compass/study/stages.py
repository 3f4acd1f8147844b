"""What is found out about candidates, stage by stage: the cheap and exact first.

1. ``screen``: cost proxies, the exact continuous fold and its margin, closest approach; one
   kernel call for a thousand candidates.
2. ``map``: geometry (DOP, counts) over area and time, for candidates that pass the screen.
3. ``entry``: landing navigation, for the best of those that pass the map.

Every function takes candidates and the study, and nothing else decides its numbers: neither the
batch a candidate is in nor the worker.
"""

import time
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.core.gdop import dops_over
from compass.core.screen import screen_patterns
from compass.coverage.cap import cap_radius, mask_for_cap
from compass.coverage.grid import make_grid
from compass.coverage.symmetry import shortest_span
from compass.frames import direction
from compass.inputs.merit import merits_of
from compass.inputs.study import Study
from compass.orbits import Constellation, positions_mci
from compass.sites import Mask
from compass.study.candidates import PATTERNS, make_constellation
from compass.study.cost import cost_figures

#: Bracket of the cap radius that decides margins, and the one that decides close calls, radians.
TOLERANCE, FINE = 5e-4, 1e-7


@dataclass(frozen=True)
class Found:
    """What a stage found out about a batch of candidates.

    Attributes
    ----------
    figures
        By name, shape (n,); nan where there is no value.
    errors
        Text of the error of each candidate that raised one, by its place in the batch.
    seconds
        Time spent.
    """

    figures: dict[str, NDArray[np.float64]]
    errors: dict[int, str]
    seconds: float


def evaluate(stage: str, study: Study, rows: NDArray) -> Found:
    """Put a batch of candidates through a stage; one that raises does not harm the others."""
    began = time.perf_counter()
    find = screen if stage == "screen" else _one_by_one
    errors: dict[int, str] = {}
    try:
        figures = find(stage, study, rows)
    except Exception:
        figures = {name: np.full(rows.size, np.nan) for name in figures_of(stage)}
        for k in range(rows.size):
            try:
                single = find(stage, study, rows[k : k + 1])
            except Exception as error:
                errors[k] = f"{type(error).__name__}: {error}"
            else:
                for name, value in single.items():
                    figures[name][k] = value[0]
    return Found(figures, errors, time.perf_counter() - began)


def figures_of(stage: str) -> list[str]:
    """Names of the figures that a stage stores."""
    return merits_of("cost") + merits_of("screen") if stage == "screen" else merits_of(stage)


def passing(study: Study, stage: str, figures: dict[str, NDArray[np.float64]]) -> NDArray[np.bool_]:
    """Which candidates meet every constraint on a stage's figures, shape (n,)."""
    size = next(iter(figures.values())).size
    keep = np.ones(size, dtype=bool)
    for constraint in study.constraints_of(stage):
        keep &= [constraint.holds(float(value)) for value in figures[constraint.figure]]
    return keep


def screen(stage: str, study: Study, rows: NDArray) -> dict[str, NDArray[np.float64]]:
    """Costs of all; fold, margin and closest approach of those whose costs are allowed."""
    sphere = study.figure.equatorial_radius
    costs = cost_figures(rows, study.cost, sphere)
    figures = costs | {name: np.full(rows.size, np.nan) for name in merits_of("screen")}
    kept = np.flatnonzero(passing(study, "cost", costs))
    some = rows[kept]
    radius, mask = some["radius_km"] * 1e3, np.radians(some["mask_deg"])
    caps = cap_radius(radius, sphere, mask)
    least, most, closest = np.empty((3, kept.size))
    screen_patterns(
        some["pattern"] == PATTERNS.index("walker-star"),
        *(some[name].astype(np.int64) for name in ("satellites", "planes", "phasing")),
        np.radians(some["inclination_deg"]),
        caps,
        study.fold,
        any(c.figure == "fold_proven" and c.low > 0 for c in study.constraints),
        TOLERANCE,
        FINE,
        least,
        most,
        closest,
    )
    # between `least` and `most` nothing is claimed
    figures["fold_proven"][kept] = np.select([most <= caps, least > caps], [1.0, 0.0], np.nan)
    known = np.isfinite(most)
    bounded = np.where(known, most, np.nan)
    figures["cap_radius_min_deg"][kept] = np.degrees(bounded)
    figures["mask_margin_deg"][kept] = np.degrees(mask_for_cap(bounded, radius, sphere))
    figures["closest_approach_deg"][kept] = np.degrees(closest)
    return figures


def _one_by_one(stage: str, study: Study, rows: NDArray) -> dict[str, NDArray[np.float64]]:
    find = map_figures if stage == "map" else entry_figures
    found = [
        find(make_constellation(row), study, float(np.radians(row["mask_deg"]))) for row in rows
    ]
    return {name: np.array([one[name] for one in found], dtype=float) for name in merits_of(stage)}


def map_figures(constellation: Constellation, study: Study, mask: float) -> dict[str, float]:
    """Dilution of precision and counts over the whole sphere and the time that decides.

    A pattern shows all it ever shows within a fraction of a revolution, but for turns of the
    sphere; the epochs are spread over that fraction, so few are enough.
    """
    span = shortest_span(constellation)
    epochs, sphere = study.map.epochs, study.figure.equatorial_radius
    times = span.start + (span.stop - span.start) * (np.arange(epochs) + 0.5) / epochs
    r = np.ascontiguousarray(positions_mci(constellation, times).transpose(1, 0, 2))
    count, gdop, pdop = _sampled(r, _places("equal-area", study.map.step_deg), sphere, mask)
    # zones of equal width reach nearer to the poles, where little area is
    _, zones, _ = _sampled(r, _places("equal-angle", study.map.step_deg), sphere, mask)
    return {
        "gdop_p50": _nearest_rank(gdop, 50),
        "gdop_p95": _nearest_rank(gdop, 95),
        "gdop_p95_zone": _worst_zone(zones, study.map.step_deg),
        "pdop_p95": _nearest_rank(pdop, 95),
        "availability": float((pdop <= study.map.pdop_max).mean()),
        "count_mean": float(count.mean()),
    }


def _sampled(
    r: NDArray[np.float64], places: NDArray[np.float64], sphere_radius: float, mask: float
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Count, GDOP and PDOP at every moment and place, shape (t, q)."""
    count = np.empty((len(r), len(places)), dtype=np.int64)
    gdop, pdop = np.empty((2, len(r), len(places)))
    dops_over(r, places, sphere_radius, np.sin(mask), count, gdop, pdop)
    return count, gdop, pdop


@lru_cache(maxsize=8)
def _places(kind: str, step_deg: float) -> NDArray[np.float64]:
    """Unit vectors to the middles of a grid's cells, row by row from the south, shape (q, 3)."""
    grid = make_grid(kind, step_deg)
    return direction(grid.latitude[:, np.newaxis], grid.longitude).reshape(-1, 3)


def _worst_zone(gdop: NDArray[np.float64], step_deg: float) -> float:
    """Largest 95th percentile of a zone of latitude, north and south together.

    Where it is seen in the centre or run backwards, a pattern has north and south exchanged: in
    the time that decides only both together show all there is.
    """
    rows = make_grid("equal-angle", step_deg).rows
    by_row = gdop.reshape(len(gdop), rows, -1)
    pairs = [by_row[:, [k, rows - 1 - k]] for k in range((rows + 1) // 2)]
    return max(_nearest_rank(pair, 95) for pair in pairs)


def _nearest_rank(values: NDArray[np.float64], q: int) -> float:
    """Smallest value that at least q percent of the values do not exceed; inf counts."""
    rank = max(-(-q * values.size // 100), 1) - 1
    return float(np.partition(values.ravel(), rank)[rank])


def entry_figures(constellation: Constellation, study: Study, mask: float) -> dict[str, float]:
    """Landing navigation over entries everywhere and at any time; see `compass.study.judge`."""
    from compass.study.judge import judge

    assert study.entry is not None
    verdict = judge(
        constellation,
        study.entry.scenario,
        samples=study.entry.samples,
        seed=study.seed,
        figure=study.figure,
        mask=Mask.constant(mask),
    )
    return {name: _value(verdict, name) for name in merits_of("entry")}


def _value(verdict: dict[str, Any], name: str) -> float:
    """Return the number at a dotted name; nan where there is none."""
    found: Any = verdict
    for part in name.split("."):
        found = found[part]
    return float("nan") if found is None else float(found)
