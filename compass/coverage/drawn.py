"""Figures over all area and time from random places and moments, which bound them by themselves.

Users stand at places of equal chance by area and look at moments of equal chance in time, all
independent: how many of them keep a limit is binomial, whatever is between them, and bounds of
shares and percentiles follow (`compass.quantities.draws`). Cells and epochs that follow a pattern's
symmetry, as those of a grid do, have no such bounds.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from compass.coverage.errors import ERRORS
from compass.coverage.grid import latitude_of_area
from compass.coverage.moving import (
    Mover,
    Sights,
    dilutions_along,
    fix_errors,
    metre_ranges,
    ranges_at,
    seen_along,
)
from compass.coverage.protection import levels_along
from compass.coverage.region import GLOBE
from compass.coverage.samples import stand
from compass.coverage.users import region_users
from compass.design import Design
from compass.frames import east_north_up, planetographic_latitude

Array = NDArray[np.float64]

#: Places and moments; sights of satellites in all at most, and in one piece of work.
DRAWS, MOST_SIGHTS, PIECE = 65_536, 4_000_000, 100_000

#: Satellites from which there are protection levels.
FEWEST = 5


@dataclass(frozen=True)
class Drawn:
    """Figures of users at random places and moments.

    Attributes
    ----------
    satellites
        How many there are.
    count
        Of these in view, shape (t,).
    values
        Dilutions, and errors and protection levels in metres where a design has a signal and
        promises something, by name; infinite where there is none, shape (t,) each.
    protected
        Whether the ``horizontal`` level, the ``vertical`` or ``both`` are within the alert limits.
    """

    satellites: int
    count: NDArray[np.int64]
    values: dict[str, Array]
    protected: dict[str, NDArray[np.bool_]] = field(default_factory=dict)

    @classmethod
    def joined(cls, parts: Sequence["Drawn"]) -> "Drawn":
        """Draws of all parts together."""
        counts, values, protected = zip(
            *((part.count, part.values, part.protected) for part in parts), strict=True
        )
        together = (
            {name: np.concatenate([one[name] for one in each]) for name in each[0]}
            for each in (values, protected)
        )
        return cls(parts[0].satellites, np.concatenate(counts), *together)

    @property
    def how(self) -> str:
        """What was drawn, in words."""
        return f"{self.count.size:,} random places and moments"


def drawn(
    design: Design, span: tuple[float, float], *, draws: int | None = None, seed: int = 0
) -> Drawn:
    """Draw users anywhere on a design's figure, over its mask, at moments of a span.

    Parameters
    ----------
    design
        Its motion counts.
    span
        Seconds after the epoch.
    draws, seed
        How many, `DRAWS` if left out; fewer of many satellites. The same seed draws the same.
    """
    g, figure, size = np.random.default_rng(seed), design.figure, design.constellation.size
    draws = min(draws or DRAWS, MOST_SIGHTS // max(size, 1))
    times = np.sort(g.uniform(*span, draws))  # any order will do: places do not depend on moments
    polar = figure.polar_radius / figure.equatorial_radius
    latitude = planetographic_latitude(latitude_of_area(g.uniform(-1, 1, draws), polar), figure)
    axes = east_north_up(latitude, g.uniform(-np.pi, np.pi, draws))
    places = stand(region_users(GLOBE, figure, design.mask), latitude, axes[:, 2])
    step = max(1, PIECE // max(size, 1)) if design.motion.is_closed_form else draws
    parts = [
        _figures(design, Mover("", places[k : k + step], axes[k : k + step], design.mask), moments)
        for k in range(0, draws, step)
        if (moments := times[k : k + step]).size
    ]
    return Drawn.joined(parts)


def _figures(design: Design, users: Mover, times: Array) -> Drawn:
    """All figures of one user a moment."""
    r, seen, around = seen_along(design, users, times, design.motion)
    sights = Sights(r, seen, around, metre_ranges(*seen.shape))
    values = dilutions_along(design, users, sights)
    protected: dict[str, NDArray[np.bool_]] = {}
    if design.signal is not None:
        sights = replace(sights, ranges=ranges_at(design, times, design.motion))
        values |= dict(zip(ERRORS, fix_errors(design, users, sights).T, strict=True))
        if (promise := design.integrity) and design.constellation.size >= FEWEST:
            levels = levels_along(design, users, sights)
            values |= levels
            across, up = levels.values()
            within = across <= promise.alert_horizontal, up <= promise.alert_vertical
            protected = {
                "horizontal": within[0],
                "vertical": within[1],
                "both": within[0] & within[1],
            }
    return Drawn(design.constellation.size, around, values, protected)
