"""Which candidates are on the front: an order of bounds, refined where it is open.

Proven bounds come nearer, and where draws alone tell more is drawn.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import chain, zip_longest

import numpy as np
from numpy.typing import NDArray

from compass.inputs.study import Constraint, Study
from compass.study.bounds import LEVELS, bounded_figures, ends
from compass.study.draw_bounds import drawn_figures
from compass.study.draws import DRAWS, FURTHER
from compass.study.pareto import fronts
from compass.study.sampling import rests_on_samples

Figures = dict[str, NDArray[np.float64]]


@dataclass(frozen=True)
class Order:
    """What is known of the order of candidates, shape (n,) each.

    Attributes
    ----------
    feasible
        Meet every constraint for sure.
    straddling
        Whose bounds lie on either side of a constraint: not decided.
    front
        Of the feasible with a value for every objective, by sure dominance: one that may be
        beaten but is not for sure is of the front; -1 elsewhere.
    decided
        Whether bounds and exact figures tell that it is of the front, or that it is not: for sure
        where they are proven, each in 95 of 100 cases where they are of draws. Where the study
        names a figure that is sampled without bounds, only what breaks another limit is. One
        whose bounds are not found yet may be anywhere.
    open
        Whose bounds have to come nearer to decide what is not.
    """

    feasible: NDArray[np.bool_]
    straddling: NDArray[np.bool_]
    front: NDArray[np.int64]
    decided: NDArray[np.bool_]
    open: NDArray[np.bool_]


def order_of(study: Study, figures: Figures, known: NDArray[np.bool_]) -> Order:
    """Sort candidates by brackets where there are any, else by the figures themselves.

    Parameters
    ----------
    study
        Its constraints and objectives.
    figures
        By name, shape (n,) each, and the columns of bounds (`compass.study.bounds.ends`), nan
        where there are none.
    known
        Which have come far enough to be sorted at all.
    """
    feasible, straddling = known.copy(), np.zeros(known.size, dtype=bool)
    for constraint in study.constraints:
        one, other = (constraint.holds(end) for end in interval(figures, constraint.figure))
        straddling |= known & (one != other)
        feasible &= one & other
    straddling &= may_hold(study.constraints, figures)
    vague = not_bounded(study, figures, [c.figure for c in study.constraints])
    keeps = np.column_stack([known, *(may_hold([c], figures) for c in study.constraints)])
    keeps[:, 1:] |= vague
    sampled = keeps.all(axis=1) & vague.any(axis=1)
    low, high = _sides(study, figures)
    chosen = np.flatnonzero(feasible & ~np.isnan(low).any(axis=1))
    front = np.full(known.size, -1)
    front[chosen] = fronts(low[chosen], high[chosen])
    decided, open_ = ~(straddling | sampled), straddling | sampled
    first = np.flatnonzero(front == 0)
    anywhere = not_bounded(study, figures, [o.figure for o in study.objectives])
    low, high = np.where(anywhere, -np.inf, low), np.where(anywhere, np.inf, high)
    # who straddles a limit, or is behind by samples, may keep it or be ahead after all
    behind = (feasible & anywhere.any(axis=1) & (front > 0)) | straddling | (sampled & ~feasible)
    rivals = np.concatenate([first, np.flatnonzero(behind)])
    beats = may_beat(low[rivals], high[first])
    unsure, may = beats.any(axis=0), beats[: first.size].any(axis=1)
    decided[first] &= ~unsure
    if by_samples := rests_on_samples(study):
        others = [c for c in study.constraints if c.figure not in by_samples]
        decided &= ~may_hold(others, figures)
    wide = np.array((low < high).any(axis=1))
    open_[first] |= (unsure | may) & wide[first]
    return Order(feasible, straddling, front, decided, open_)


def _sides(study: Study, figures: Figures) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Bounds of the objectives, the smaller the better, shape (n, objectives) each."""
    pairs = [o.sign * np.stack(interval(figures, o.figure))[:: o.sign] for o in study.objectives]
    low, high = np.stack(pairs, axis=-1)
    return low, high


def interval(figures: Figures, figure: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Bounds of a figure where they are known, else twice its value."""
    low, high = ends(figure)
    value = figures[figure]
    if low not in figures:
        return value, value
    known = ~np.isnan(figures[low])
    return np.where(known, figures[low], value), np.where(known, figures[high], value)


def not_bounded(study: Study, figures: Figures, names: Sequence[str]) -> NDArray[np.bool_]:
    """Which of some figures of candidates have bounds that are not found yet, shape (n, names)."""
    size = next(iter(figures.values())).size
    asked = [*bounded_figures(study), *drawn_figures(study)]
    absent = np.full(size, np.nan)
    columns = [np.isnan(figures.get(ends(name)[0], absent)) & (name in asked) for name in names]
    return np.array(columns, dtype=bool).reshape(-1, size).T


def may_hold(constraints: Iterable[Constraint], figures: Figures) -> NDArray[np.bool_]:
    """Whether none of some constraints is broken for sure, shape (n,)."""
    held = np.ones(next(iter(figures.values())).size, dtype=bool)
    for constraint in constraints:
        pair = interval(figures, constraint.figure)
        held &= np.any([constraint.holds(end) for end in pair], axis=0)
    return held


def may_beat(low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether a may be nowhere larger than b and somewhere smaller, shape (a, b), of brackets.

    The first of those of `low` are those of `high`: one beats itself nowhere.
    """
    no_larger = np.all(low[:, np.newaxis] <= high, axis=-1)
    smaller = np.any(low[:, np.newaxis] < high, axis=-1)
    beats = no_larger & smaller
    np.fill_diagonal(beats, False)
    return np.asarray(beats)


def bound_limits(rows: NDArray, refine: Callable[[str, NDArray], None]) -> None:
    """Bound candidates as far as the first level goes, where limits decide who goes on."""
    for level in list(LEVELS)[:1]:
        refine(level, rows)


def settle(
    study: Study,
    rows: NDArray,
    figures: Callable[[NDArray, Sequence[str]], Figures],
    refine: Callable[[str, NDArray], None],
    finer: Iterable[str] = (),
) -> None:
    """Bring bounds as near as it takes to decide who is on the front: of all, then of the open.

    Parameters
    ----------
    study
        What is asked.
    rows
        Candidates that may be of the front.
    figures
        All that is known of candidates before any level, and by some levels.
    refine
        Finds the bounds of candidates at a level, unless they are known.
    finer
        Levels to go on with, as long as there are any.
    """
    if not rows.size:
        return
    everyone, gone = np.ones(rows.size, dtype=bool), list[str]()
    asked = bounded_figures(study), drawn_figures(study)
    for pair in chain(zip_longest(LEVELS, DRAWS), zip(finer, FURTHER, strict=False)):
        for level, own in zip(pair, asked, strict=True):
            if level is None or not own:
                continue
            # what a run that was stopped has found of later levels plays no role: it ends alike
            known = figures(rows, gone)
            going = asked_nearer(study, known, order_of(study, known, everyone), own)
            if level in (*list(LEVELS)[:1], *list(DRAWS)[:1]):
                going |= np.any([np.isnan(known[ends(figure)[0]]) for figure in own], axis=0)
            if going.any():
                refine(level, rows[going])
            gone.append(level)


def asked_nearer(
    study: Study, figures: Figures, order: Order, names: Sequence[str]
) -> NDArray[np.bool_]:
    """Whose bounds of some figures may decide what is open if they come nearer, shape (n,).

    Of a limit, where they are on either side; of an objective, where of two of which one may beat
    the other it is open by that objective which is ahead.
    """
    found = np.zeros(order.open.size, dtype=bool)
    for constraint in study.constraints:
        if constraint.figure in names:
            one, other = (constraint.holds(end) for end in interval(figures, constraint.figure))
            found |= order.straddling & (one != other)
    some = np.flatnonzero(order.open)
    low, high = (side[some] for side in _sides(study, figures))
    beats = may_beat(low, high)
    for column, objective in enumerate(study.objectives):
        if objective.figure in names:
            a, b = low[:, column], high[:, column]
            unsure = beats & (b[:, np.newaxis] > a) & (a[:, np.newaxis] < b)
            wide = a < b
            found[some] |= wide & (unsure.any(axis=0) | unsure.any(axis=1))
    return found
