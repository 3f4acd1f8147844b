"""What is found out about candidates, stage by stage: the cheap and exact first.

1. ``screen``: cost proxies, the exact continuous fold and its margin, closest approach, what
   keeping costs by a quick law; a kernel call for a thousand candidates.
2. ``map``: geometry (DOP, counts) over area and time, for candidates that pass the screen.
3. ``requirements``: what the study requires at its sites and in its regions, proven or bracketed.
4. ``areas``: fold and geometry at the study's sites and in its regions, where it names any.
5. ``orbits``: how long the fold is proven on real orbits, where the study asks for it.
6. ``entry``: landing navigation, for the best of those that pass all before.
7. ``bounds-1``, ...: proven bounds of geometry, as near as it takes to decide the order;
   ``draws-1``, ...: more draws where draws alone tell, likewise.
8. ``clocks``: errors in metres with each named clock, for the best of the front.

Every function takes candidates and the study, and nothing else decides its numbers: neither the
batch a candidate is in nor the worker.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from compass.core.screen import screen_patterns
from compass.coverage.cap import cap_radius, mask_for_cap
from compass.inputs.study import Study
from compass.quantities.merits import merits_of, worked_out
from compass.study.area_figures import area_columns, area_figures
from compass.study.bounds import AREAS_NEAR, FINER, LEVELS, bound_columns, bounds
from compass.study.candidates import patterns_of
from compass.study.clocks import clock_columns, clock_figures
from compass.study.cost import cost_figures
from compass.study.draw_bounds import side_columns
from compass.study.draws import ALL_DRAWS, drawn_columns, more_draws
from compass.study.lasting import keeping_law, orbits_figures
from compass.study.order import may_hold
from compass.study.pattern_judging import entry_figures
from compass.study.pattern_map import map_figures
from compass.study.requirement_figures import requirement_columns, requirement_figures

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
    left
        Places in the batch of candidates for which memory ran out: nothing is known of them.
    """

    figures: dict[str, NDArray[np.float64]]
    errors: dict[int, str]
    seconds: float
    left: tuple[int, ...] = ()

    def without_left(self, rows: NDArray) -> tuple[NDArray, "Found"]:
        """Return the candidates of a batch of which something is known, and what."""
        kept = np.setdiff1d(np.arange(rows.size), self.left)
        figures = {name: values[kept] for name, values in self.figures.items()}
        errors = {k: self.errors[place] for k, place in enumerate(kept) if place in self.errors}
        return rows[kept], Found(figures, errors, self.seconds)


def evaluate(stage: str, study: Study, rows: NDArray) -> Found:
    """Put a batch of candidates through a stage; one that raises does not harm the others."""
    began = time.perf_counter()
    find = FINDERS[stage]
    errors: dict[int, str] = {}
    left: list[int] = []
    try:
        figures = find(study, rows)
    except Exception:
        figures = {name: np.full(rows.size, np.nan) for name in figures_of(stage, study)}
        for k in range(rows.size):
            try:
                single = find(study, rows[k : k + 1])
            except MemoryError:  # says nothing of the candidate: another time there may be enough
                left.append(k)
            except Exception as error:
                errors[k] = f"{type(error).__name__}: {error}"
            else:
                for name, value in single.items():
                    figures[name][k] = value[0]
    return Found(figures, errors, time.perf_counter() - began, tuple(left))


@dataclass(frozen=True)
class StudyJob:
    """What another machine is sent of a study: called there, it evaluates candidates."""

    study: Study

    def __call__(self, stage: str, rows: NDArray) -> Found:
        """As `evaluate`."""
        return evaluate(stage, self.study, rows)


def figures_of(stage: str, study: Study) -> tuple[str, ...]:
    """Names of the figures that a stage of a study stores."""
    if level := (LEVELS | FINER).get(stage):
        return bound_columns(study, level)
    if stage in ALL_DRAWS:
        return drawn_columns(study)
    if stage == "entry":
        return (*merits_of(stage), *side_columns(study, stage))
    if stage == "areas":
        return (*merits_of(stage), *area_columns(study))
    if stage == "clocks":
        return tuple(clock_columns(study))
    if stage == "screen":
        return (*merits_of("cost"), *merits_of("screen"))
    if stage == "requirements":
        return (*merits_of(stage), *requirement_columns(study))
    return merits_of(stage)


def passing(study: Study, stage: str, figures: dict[str, NDArray[np.float64]]) -> NDArray[np.bool_]:
    """Which candidates break no constraint on a stage's figures for sure, shape (n,).

    The screen's figures are costs too.
    """
    stages = ("cost", stage) if stage == "screen" else (stage,)
    return may_hold([c for name in stages for c in study.constraints_of(name)], figures)


def screen(study: Study, rows: NDArray) -> dict[str, NDArray[np.float64]]:
    """Costs of all; fold, margin and closest approach of those whose costs are allowed."""
    sphere = study.figure.equatorial_radius
    costs = cost_figures(rows, study.cost, sphere, study.launching)
    figures = costs | {name: np.full(rows.size, np.nan) for name in merits_of("screen")}
    kept = np.flatnonzero(passing(study, "cost", costs))
    some = rows[kept]
    radius, mask = some["radius_km"] * 1e3, np.radians(some["mask_deg"])
    caps = cap_radius(radius, sphere, mask)
    least, most, closest = np.empty((3, kept.size))
    screen_patterns(
        patterns_of(some),
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
    figures["delta_v_keeping_m_s_year"][kept] = keeping_law(some, caps - bounded, study.motion)
    return costs | worked_out("screen", figures)


#: What finds the figures of each stage; it may raise for a batch, and is then asked one by one.
FINDERS: dict[str, Callable[[Study, NDArray], dict[str, NDArray[np.float64]]]] = {
    "screen": screen,
    "map": map_figures,
    "requirements": requirement_figures,
    "areas": partial(area_figures, near=AREAS_NEAR),
    "orbits": orbits_figures,
    "entry": entry_figures,
    **{name: partial(bounds, level) for name, level in (LEVELS | FINER).items()},
    **{name: partial(more_draws, name) for name in ALL_DRAWS},
    "clocks": clock_figures,
}
