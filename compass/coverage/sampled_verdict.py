"""Whether a figure is small enough for often enough, where no bounds of it are known: by samples.

Users at random places look at random moments. Of n samples k keep the limit; the share lies between
the bounds of Clopper and Pearson 1934 (Biometrika 26:404), missed by chance as rarely as by a
normal number four of its sigmas. Samples refute an always, and never prove one.
"""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from compass.coverage.errors import ERRORS
from compass.coverage.fold_verdict import Course
from compass.coverage.moving import (
    Mover,
    Sights,
    dilutions_along,
    fix_errors,
    metre_ranges,
    seen_along,
    sights_along,
)
from compass.coverage.protection import LEVELS, levels_along
from compass.coverage.samples import points_in, stand
from compass.coverage.users import Users, centric
from compass.coverage.verdict import Verdict, Worst
from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import east_north_up, latitude_longitude, planetographic_latitude
from compass.quantities.draws import share_bounds
from compass.ranging import FACTOR_95
from compass.requirement import DILUTIONS, Requirement

#: Samples of each group of users at first, and at most: doubled until the share is decided.
FIRST, MOST = 4096, 131072

#: Probability that a bound of a share is wrong: the tail of four sigmas.
DOUBT = 3.167e-5

#: From when on moments are for a claim that holds for ever, on circles where it counts from none.
EVER = (0.0, 1e7)


def sampled_verdict(
    design: Design,
    requirement: Requirement,
    name: str,
    limit: float,
    everyone: tuple[Users, ...],
    losses: Iterable[tuple[tuple[str, ...], int]],
    course: Course,
) -> Verdict:
    """Verdict on a figure of a fix, or a protection level, of at most a limit, by random samples.

    Parameters
    ----------
    design, requirement, name, limit
        As of `compass.coverage.geometry_verdict.geometry_verdict`; also one of the levels.
    everyone, losses, course
        Its users, the sets of lost satellites with how many each stands for, and how long the
        claim runs.

    Raises
    ------
    ArgumentError
        Levels without an ``[integrity]`` or a ``[signal]``, errors without a ``[signal]``.
    """
    _check_tables(design, name)
    wanted, in_sum = requirement.share, requirement.share_of == "area-time"
    scale = FACTOR_95 if name in ERRORS and requirement.error_as == "95-percent" else 1.0
    sampled: list[tuple[list[_Samples], tuple[str, ...], int]] = []
    for lost, alike in losses:
        gone = [design.constellation.satellite_names.index(one) for one in lost]
        parts = [_Samples(design, name, limit / scale, each, gone, course) for each in everyone]
        for part in parts:
            part.go_on(wanted)
        sampled.append((parts, lost, alike))
    # a mean lies between its parts, the worst place is that of the least
    highs = [(max if in_sum else min)(part.high for part in parts) for parts, *_ in sampled]
    low = min(part.low for parts, *_ in sampled for part in parts)
    high = min(highs)
    parts, lost, alike = sampled[highs.index(high)]
    least = min(parts, key=lambda part: part.high)
    every_place = wanted < 1.0 and not in_sum and any(u.south != u.north for u in everyone)
    met, reason, worst = None, "", None
    if wanted == 1.0 and least.broken:
        met, worst = False, least.worst(scale)
    elif wanted < 1.0 and high < wanted:
        met = False
    elif wanted < 1.0 and low >= wanted and not every_place:
        met = True
    else:
        reason = f"{least.broken} of {least.count} samples break it: "
        reason += f"the share lies between {low:.6g} and {high:.6g}"
        if wanted == 1.0:
            reason += "; samples prove no always: ask for a share"
        elif every_place:
            reason += (
                ' of all places together; of each, ask at sites, or with share_of = "area-time"'
            )
    scope = f"{course.words}; {least.count} random places and moments, bounds to four sigmas"
    if any(users.mask.lowest < 0.0 for users in everyone):
        scope += "; as of orbiters: the receiver's noise of the zenith, no ionosphere"
    return Verdict(
        requirement, met, "sampled", scope, (low, high), None, worst, lost, alike, reason
    )


def _check_tables(design: Design, name: str) -> None:
    """Refuse a figure whose tables the design has not.

    Raises
    ------
    ArgumentError
        A table is missing.
    """
    if name in DILUTIONS:
        return
    if design.signal is None:
        raise ArgumentError(
            "signal: missing; errors in metres follow from the errors of ranges: add a [signal]"
        )
    if name in LEVELS and design.integrity is None:
        raise ArgumentError("integrity: missing; levels follow from what is promised: add it")


class _Samples:
    """Random places and moments of users, and how many of them break a limit."""

    def __init__(
        self,
        design: Design,
        name: str,
        limit: float,
        users: Users,
        gone: Sequence[int],
        course: Course,
    ) -> None:
        """Take none yet."""
        self.asked = design, name, limit, users, list(gone), course
        self.rng = np.random.default_rng(0)
        self.count = self.broken = 0
        self.place: tuple[float, ...] = ()

    @property
    def low(self) -> float:
        """Bound of the share that keeps the limit, from below."""
        return self._bounds[0]

    @property
    def high(self) -> float:
        """Bound from above."""
        return self._bounds[1]

    @property
    def _bounds(self) -> tuple[float, float]:
        return share_bounds(1.0 - self.broken / self.count, self.count, DOUBT)

    def go_on(self, wanted: float) -> None:
        """Take as many as it needs, each time as many as there are."""
        while self.count < MOST and self._is_open(wanted):
            self._take(max(self.count, FIRST))

    def _is_open(self, wanted: float) -> bool:
        if wanted == 1.0:
            return not self.broken
        return self.count == 0 or self.low < wanted <= self.high

    def worst(self, scale: float) -> Worst:
        """The place and moment of the largest value."""
        time, latitude, longitude, value = self.place
        return Worst(time, latitude, longitude, scale * value, self.asked[1])

    def _take(self, count: int) -> None:
        design, name, limit, users, gone, course = self.asked
        times = self.rng.uniform(*(course.span or EVER), count)
        latitude, longitude = _places(users, course.span is None, self.rng, count)
        axes = east_north_up(latitude, longitude)
        mover = Mover("", stand(users, latitude, axes[:, 2]), axes, users.mask)
        sights = _sights(design, name, mover, times, users.beam)
        sights.seen[:, gone] = False
        values = _values(design, name, mover, sights)
        self.count += count
        self.broken += int(np.sum(values > limit))
        k = int(np.argmax(values))
        if not self.place or values[k] > self.place[3]:
            where = centric(float(latitude[k]), users.figure), float(longitude[k] % (2 * np.pi))
            self.place = (float(times[k]), *where, float(values[k]))


def _places(
    users: Users, anywhere: bool, rng: np.random.Generator, count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Geodetic latitudes and Mars-fixed longitudes, of equal chance by solid angle from the centre.

    Anywhere on his circle of latitude counts where no longitude differs from others in time.
    """
    if users.region.mars_fixed and not anywhere:
        latitude, longitude = latitude_longitude(points_in(users.region, rng, count))
    else:
        low, high = (float(np.sin(centric(b, users.figure))) for b in (users.south, users.north))
        latitude = np.arcsin(rng.uniform(low, high, count))
        longitude = rng.uniform(0.0, 2 * np.pi, count)
    if users.longitude is not None and not anywhere:
        longitude = np.full(count, users.longitude)
    return planetographic_latitude(latitude, users.figure), longitude


def _sights(
    design: Design, name: str, mover: Mover, times: NDArray[np.float64], beam: float | None
) -> Sights:
    """Who is in view, with ranges that are alike for dilutions."""
    if name not in DILUTIONS:
        return sights_along(design, mover, times, beam=beam)
    seen = seen_along(design, mover, times, design.motion, beam, design.beacons)
    return Sights(*seen, metre_ranges(*seen[1].shape))


def _values(design: Design, name: str, mover: Mover, sights: Sights) -> NDArray[np.float64]:
    """Value of the figure at each sample, infinite where there is none."""
    if name in DILUTIONS:
        return dilutions_along(design, mover, sights)[name]
    if name in LEVELS:
        return levels_along(design, mover, sights)[0][name]
    return dict(zip(ERRORS, fix_errors(design, mover, sights).T, strict=True))[name]
