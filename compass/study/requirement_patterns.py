"""Every pattern of a size at every inclination and turn, and those that random moments leave."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from compass.cores import shared
from compass.coverage.certified_ranges import ranges_wanted
from compass.coverage.fold_verdict import users_of
from compass.orbits import Pattern
from compass.orbits.constellation import from_pattern
from compass.orbits.kinds import kind_of
from compass.orbits.symmetry import alike_longitudes
from compass.study.requirement_question import Question, Trial
from compass.study.requirement_samples import Moments, is_hopeless, moments_of
from compass.study.search import closest_approach, layouts

#: Step of inclinations and of turns over the ground, degrees.
STEP, TURN_STEP = 1.0, 3.0


@dataclass(frozen=True, eq=False)
class Grid:
    """A pattern and the inclinations and nodes at which it is looked at, shape (k,), radians."""

    pattern: Pattern
    inclinations: NDArray[np.float64]
    nodes: NDArray[np.float64]


def grids(question: Question, size: int) -> Iterable[Grid]:
    """Every pattern of a size at every inclination, and at every turn where that counts."""
    seen = set()
    degrees = np.arange(0.0, 90.0 + 0.5 * STEP, STEP)
    for kind in question.kinds:
        layout = kind_of(kind).layout
        for planes, phasing in layouts(kind, size):
            if (layout, planes, phasing) in seen:
                continue
            seen.add((layout, planes, phasing))
            pattern = Pattern(layout, size, planes, phasing, 0.0)
            nodes = turns(question, pattern)
            yield Grid(
                pattern,
                np.tile(np.radians(degrees), len(nodes)),
                np.repeat(nodes, len(degrees)),
            )


def sampled(
    question: Question, tried: Sequence[Grid], workers: int, bare: bool = False
) -> tuple[list[Trial], list[Trial]]:
    """Candidates that no random moment refutes; if `bare`, of each pattern one with folds alone."""
    if not tried:
        return [], []
    first = from_pattern(tried[0].pattern, question.radius, repeat=question.repeat)
    design = question.design(first)
    moments = [
        moments_of(first, users, wanted, ranges_wanted(design, wanted, "set"))
        for wanted in question.requirements
        for users in users_of(design, wanted)
    ]
    kept = list(shared(lambda grid: _kept(question, grid, moments, bare), tried, workers))
    return [one for some, _ in kept for one in some], [one for _, some in kept for one in some]


def _kept(
    question: Question, grid: Grid, moments: Sequence[Moments], bare: bool
) -> tuple[list[Trial], list[Trial]]:
    """Candidates of one pattern that no random moment refutes; one whose folds none refutes."""
    laid = from_pattern(grid.pattern, question.radius)

    def found(k: int) -> Trial:
        tilt, node = float(grid.inclinations[k]), float(grid.nodes[k])
        pattern = replace(grid.pattern, inclination=tilt, raan=node)
        c = from_pattern(pattern, question.radius, repeat=question.repeat)
        return Trial(c, closest_approach(c), (), float(share[k]), float(worst[k]))

    def look(asked: Iterable[Moments]) -> None:
        for each in asked:
            each.look(laid, grid.inclinations, grid.nodes, share, worst)
            share[is_hopeless(share, each.wanted.share)] = 0.0

    share, worst = np.ones(len(grid.nodes)), np.zeros(len(grid.nodes))
    folded = np.zeros(len(share), dtype=bool)
    if bare:
        look(each.folds_alone for each in moments if each.wanted.share == 1.0)
        folded = share > 0.0
    look(moments)
    alone = (found(k) for k in np.flatnonzero(folded & (share == 0.0)).tolist())
    apart = (one for one in alone if one.closest_approach >= question.least_approach)
    return [found(k) for k in np.flatnonzero(share).tolist()], list(islice(apart, 1))


def turns(question: Question, pattern: Pattern) -> list[float]:
    """Nodes of the first plane that are not alike over the ground; one where tracks do not close.

    As `compass.orbits.symmetry.alike_longitudes`.
    """
    if question.repeat is None:
        return [0.0]
    c = from_pattern(replace(pattern, inclination=0.5), question.radius)
    width = alike_longitudes(c, *question.repeat)
    count = max(1, int(np.ceil(width / np.radians(TURN_STEP))))
    return [width * k / count for k in range(count)]
