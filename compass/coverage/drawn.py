"""Figures over all area and time from random places and moments, which bound them by themselves.

Users stand at places of equal chance by area and look at moments of equal chance in time, all
independent: how many of them keep a limit is binomial, whatever is between them, and bounds of
shares and percentiles follow (`compass.quantities.draws`). Cells and epochs that follow a pattern's
symmetry, as those of a grid do, have no such bounds.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.cores import shared
from compass.coverage.errors import ERRORS
from compass.coverage.fix_budget import FixBudget, fix_budget
from compass.coverage.grid import latitude_of_area
from compass.coverage.moving import (
    Mover,
    Sights,
    dilutions_along,
    fix_errors,
    heard_by,
    metre_ranges,
    ranges_at,
    seen_along,
)
from compass.coverage.protection import SHARES, levels_along
from compass.coverage.region import GLOBE
from compass.coverage.samples import stand
from compass.coverage.users import Users, region_users
from compass.design import Design
from compass.frames import east_north_up, planetographic_latitude
from compass.signal.ranges import Weighting
from compass.sites import Mask

Array = NDArray[np.float64]

#: Places and moments; sights of satellites in all at most, and in one piece of work.
DRAWS, MOST_SIGHTS, PIECE = 65_536, 4_000_000, 100_000

#: Sights of satellites, by about so many, that the budget of fixes is made of.
BUDGET_SIGHTS = 300_000

#: Satellites from which there are protection levels.
FEWEST = 5


@dataclass(frozen=True)
class Drawn:
    """Figures of users at random places and moments.

    Attributes
    ----------
    satellites
        Their names.
    count, risen
        Of these in view, and above the plain horizon whatever the mask, shape (t,) each.
    values
        Dilutions, and errors and protection levels in metres where a design has a signal and
        promises something, by name; infinite where there is none, shape (t,) each.
    protected
        Of `SHARES`: whether a fault can be detected, and the ``horizontal`` level, the
        ``vertical`` or ``both`` are within the alert limits, shape (t,) each.
    left
        The same without each satellite in turn, shape (t, n) each; empty if that was not asked.
    budget
        What fixes are made of, of some of them; None if that was not asked, or without a signal.
    """

    satellites: tuple[str, ...]
    count: NDArray[np.int64]
    risen: NDArray[np.int64]
    values: dict[str, Array]
    protected: dict[str, NDArray[np.bool_]] = field(default_factory=dict)
    left: dict[str, NDArray[np.bool_]] = field(default_factory=dict)
    budget: FixBudget | None = None

    @classmethod
    def joined(cls, parts: Sequence["Drawn"]) -> "Drawn":
        """Draws of all parts together."""

        def named(each: Sequence[dict[str, Any]]) -> dict[str, Any]:
            return {name: np.concatenate([one[name] for one in each]) for name in each[0]}

        budgets = [part.budget for part in parts if part.budget is not None]
        return cls(
            parts[0].satellites,
            np.concatenate([part.count for part in parts]),
            np.concatenate([part.risen for part in parts]),
            named([part.values for part in parts]),
            named([part.protected for part in parts]),
            named([part.left for part in parts]),
            FixBudget.joined(budgets) if budgets else None,
        )

    @property
    def how(self) -> str:
        """What was drawn, in words."""
        return f"{self.count.size:,} random places and moments"


def drawn(
    design: Design,
    span: tuple[float, float],
    *,
    users: Users | None = None,
    weights: Weighting = "variance",
    losses: bool = False,
    budget: bool = False,
    draws: int | None = None,
    seed: int = 0,
) -> Drawn:
    """Draw users anywhere on a design's figure, over its mask, at moments of a span.

    Parameters
    ----------
    design
        Its motion counts.
    span
        Seconds after the epoch.
    users
        How high they stand, and in which beams; on the ground if left out.
    weights
        How fixes weigh ranges.
    losses
        Whether to look at protection without each satellite in turn, too.
    budget
        Whether to look at what fixes are made of, too.
    draws, seed
        How many, `DRAWS` if left out; fewer of many satellites. The same seed draws the same.
    """
    g, figure, size = np.random.default_rng(seed), design.figure, design.constellation.size
    draws = min(draws or DRAWS, MOST_SIGHTS // max(size, 1))
    times = np.sort(g.uniform(*span, draws))  # any order will do: places do not depend on moments
    polar = figure.polar_radius / figure.equatorial_radius
    latitude = planetographic_latitude(latitude_of_area(g.uniform(-1, 1, draws), polar), figure)
    axes = east_north_up(latitude, g.uniform(-np.pi, np.pi, draws))
    everyone = users or region_users(GLOBE, figure, design.mask)
    places = stand(everyone, latitude, axes[:, 2])
    step = max(1, PIECE // max(size, 1)) if design.motion.is_closed_form else draws
    # below 1: of whom the budget is looked at, and of which of his ranges
    chance = g.random(draws) * max(1.0, draws * size / BUDGET_SIGHTS) + (not budget)
    parts = []
    for k in range(0, draws, step):
        piece = slice(k, k + step)
        some = Mover("", places[piece], axes[piece], everyone.mask)
        given = design, some, times[piece], everyone.beam, weights
        parts.append(_numbers(*given, losses=losses, chance=chance[piece]))
    return Drawn.joined(parts)


def _numbers(
    design: Design,
    users: Mover,
    times: Array,
    beam: float | None,
    weights: Weighting,
    *,
    losses: bool,
    chance: Array,
) -> Drawn:
    """All numbers of one user a moment; the budget of those whose chance is below 1."""
    names, motion = design.constellation.satellite_names, design.motion
    r, seen, around = seen_along(design, users, times, motion, beam)
    count, risen = seen.sum(axis=1), _risen(design, users, times, beam)
    sights = Sights(r, seen, around, metre_ranges(*seen.shape))
    values = dilutions_along(design, users, sights)
    if design.signal is None:
        return Drawn(names, count, risen, values)
    sights = replace(sights, ranges=ranges_at(design, times, motion, weights))
    values |= dict(zip(ERRORS, fix_errors(design, users, sights).T, strict=True))
    budget = _budget(design, users, sights, chance)
    if design.integrity is None or len(names) < FEWEST:
        return Drawn(names, count, risen, values, budget=budget)
    levels, able = levels_along(design, users, sights)
    protected, left = _protected(design, levels, able), dict[str, NDArray[np.bool_]]()
    if losses:
        without = partial(_without, design, users, sights)
        each = list(shared(without, range(len(names))))
        left = {name: np.stack([one[name] for one in each], axis=1) for name in SHARES}
    return Drawn(names, count, risen, values | levels, protected, left, budget)


def _budget(design: Design, users: Mover, sights: Sights, chance: Array) -> FixBudget | None:
    """What fixes are made of, of those users whose chance is below 1; None of no user."""
    some = chance < 1.0
    if not some.any():
        return None
    ranges = heard_by(users, sights)
    return fix_budget(
        sights.r[some],
        sights.seen[some],
        ranges._replace(q=ranges.q[some], sun=ranges.sun[some]),
        users.r[some] / design.figure.equatorial_radius,
        users.axes[some, 2],
        chance[some],
    )


def _risen(design: Design, users: Mover, times: Array, beam: float | None) -> NDArray[np.int64]:
    """How many stand above the plain horizon, or a mask below it, in their beams."""
    assert users.mask is not None
    plain = replace(users, mask=Mask.constant(min(0.0, users.mask.lowest)))
    return seen_along(design, plain, times, design.motion, beam)[1].sum(axis=1)


def _protected(
    design: Design, levels: dict[str, Array], able: NDArray[np.bool_]
) -> dict[str, NDArray[np.bool_]]:
    """Who is protected how far, of `SHARES`."""
    promise = design.integrity
    assert promise is not None
    across, up = levels.values()
    flat, tall = across <= promise.alert_horizontal, up <= promise.alert_vertical
    return dict(zip(SHARES, (able, flat, tall, flat & tall), strict=True))


def _without(
    design: Design, users: Mover, sights: Sights, lost: int
) -> dict[str, NDArray[np.bool_]]:
    """Who is protected how far once a satellite is lost."""
    kept = np.arange(sights.seen.shape[1]) != lost
    fewer = Sights(
        np.ascontiguousarray(sights.r[:, kept]),
        np.ascontiguousarray(sights.seen[:, kept]),
        sights.around,
        sights.ranges._replace(q=np.ascontiguousarray(sights.ranges.q[:, kept])),
    )
    return _protected(design, *levels_along(design, users, fewer))
