"""Whether a fold is always, or often enough, in view of a requirement's users."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from compass.bodies import MARS_ROTATION_RATE
from compass.cores import shared
from compass.coverage.certified_effort import Effort
from compass.coverage.clearance import (
    MARGIN_BOXES,
    Clearance,
    Share,
    always_clear,
    clear_share,
    least_clearance,
    polygon_share,
    worst_share,
)
from compass.coverage.clearance_layout import Moving
from compass.coverage.region import Region, read_regions
from compass.coverage.standing import nth_elevation
from compass.coverage.symmetry import unlike_subsets
from compass.coverage.users import (
    Users,
    by_horizon,
    centric,
    check_limb,
    geodetic,
    region_users,
    site_users,
)
from compass.coverage.verdict import Verdict, Worst, undecided
from compass.design import Design
from compass.errors import ArgumentError, said_of
from compass.frames import SECONDS_PER_DAY, prime_meridian_angle
from compass.orbits import Constellation
from compass.orbits.symmetry import one_circle, one_period
from compass.requirement import Requirement
from compass.sites import Mask
from compass.words import counted

#: Boxes for each share, and for that of a miss, which is told for what it is worth.
SHARE_BOXES, MISSED_BOXES = 4_000_000, 300_000

#: Boxes for one of many candidates.
GLANCE_BOXES = 200_000

#: Satellites times sets of lost ones, each a proof of its own: past it a day would not do.
MOST_LEFT = 1_000_000

#: Rotations of Mars after which closed tracks of several periods are together where they began,
#: at most: past them each counts by itself.
CLOSING = 30

#: Why of orbits that keep no pace little is proven for ever, and what helps.
MEETING = "orbits that keep no pace meet in every combination of their phases; give days"

#: Days that are looked at for a miss where nothing can be proven for ever.
LOOKED_AT = 2.0


@dataclass(frozen=True)
class Course:
    """How long a claim runs, and whether users stand at a place or anywhere on its circle.

    Attributes
    ----------
    span
        Seconds after the epoch for which users stand on Mars; None: for ever, on circles.
    for_ever
        Whether what holds in the span holds always.
    words
        The same in words.
    """

    span: tuple[float, float] | None
    for_ever: bool
    words: str


def course_of(design: Design, days: float | None, start_day: float) -> Course | None:
    """Course of claims about a design; None where nothing can be said without days.

    Ground tracks count as closed only if that is declared; else, with one period, longitude and
    phase take every pair of values, and a place is as good as its circle.
    """
    c, j2 = design.constellation, design.motion.model == "j2"
    motion = design.motion.title
    if days is not None:
        start = start_day * SECONDS_PER_DAY
        words = f"over {counted(days, 'day')} from day {start_day:g}, {motion}, at the place"
        return Course((start, start + days * SECONDS_PER_DAY), False, words)
    if (rotations := c.rotations) is not None and not j2 and (c.repeat or rotations <= CLOSING):
        after = f"{counted(rotations, 'rotation')} of Mars"
        if c.repeat is not None:
            after = f"{counted(c.repeat[0], 'revolution')} in {after}"
        words = (
            f"for ever, {motion}, at the place, for its ground tracks are said to close after "
            f"{after}"
        )
        return Course((0.0, rotations * 2 * np.pi / MARS_ROTATION_RATE.value), True, words)
    alike = one_circle(c) and np.unique(c.inclination).size <= 1
    if not (alike if j2 else one_period(c)):
        return None
    words = f"for ever, {motion}, at every longitude, for no ground track is said to close"
    return Course(None, True, words)


def users_of(design: Design, requirement: Requirement) -> tuple[Users, ...]:
    """Users of a requirement, over the higher of its mask and their own horizons.

    Raises
    ------
    ArgumentError
        A mask below the limb of Mars.
    """
    mask = design.mask if requirement.mask is None else Mask.constant(requirement.mask)
    places = [site_users(site, site.mask.or_higher(mask)) for site in requirement.sites]
    for text in requirement.areas:
        for region in read_regions(text):
            users = region_users(region, design.figure, mask, height=requirement.altitude)
            places.append(replace(users, name=text))
    with said_of(requirement.name):
        for users in places:
            check_limb(users)
    return tuple(replace(users, beam=requirement.beam) for users in places)


def fold_verdict(
    design: Design,
    requirement: Requirement,
    *,
    days: float | None = None,
    start_day: float = 0.0,
    effort: Effort | None = None,
    missed_share: bool = True,
) -> Verdict:
    """Verdict on "so many satellites in view" of a requirement, on ellipses that keep their shape.

    Parameters
    ----------
    design
        Of two-body motion, or of mean motion under J2 where `course_of` has an answer.
    requirement
        Wants a fold.
    days, start_day
        Prove it for so many days from a day on, at the place, and not for ever.
    effort
        Its seconds for each share, if it has any.
    missed_share
        Whether to tell the share of time with it where it is most missed.

    Raises
    ------
    ArgumentError
        As `least_clearance` and `compass.coverage.symmetry.unlike_subsets`.
    """
    course = course_of(design, days, start_day)
    if course is None:
        if requirement.share == 1.0:  # what is missed once is not always so
            some = fold_verdict(
                design, requirement, days=LOOKED_AT, effort=effort, missed_share=missed_share
            )
            if some.met is False:
                return some
        return undecided(requirement, f"for ever, {design.motion.title}", MEETING)
    users = tuple(_out_of_beams(each, design) for each in users_of(design, requirement))
    if requirement.share < 1.0:
        cases = losses_of(design.constellation, requirement, users, course)
        return often(cases, users, requirement, course, effort)
    return _always(design.constellation, users, requirement, course, missed_share)


def _out_of_beams(users: Users, design: Design) -> Users:
    """Users without beams that reach whoever stands above their mask: no margin counts to them."""
    seen = by_horizon(users, design.constellation, design.motion)
    return seen if seen.mask == users.mask else users


def losses_of(
    c: Constellation,
    requirement: Requirement,
    users: Sequence[Users],
    course: Course,
    *,
    alike: bool = True,
) -> Iterator[tuple[tuple[str, ...], int, Constellation]]:
    """Names of lost satellites, how many sets they stand for, and what is left without them.

    Unless satellites are `alike` in all but their places, every set stands for itself. Belts see at
    one moment or another what turns and delays carry into one another, wherever Mars stands, but
    for the share of time at the worst of their places.
    """
    if not requirement.losses:
        yield (), 1, c
        return
    by_place = requirement.share < 1.0 and requirement.share_of == "time"
    belts = course.for_ever and all(each.is_belt for each in users) and not by_place
    turns = not alike or not (course.span is None or belts)
    still = Region("places that turn with Mars", mars_fixed=turns)
    turning = all(each.alike_all_around for each in users)
    with said_of(requirement.name):
        subsets = unlike_subsets(c, requirement.losses, still, backwards=turning)
    if (proofs := len(subsets.sets)) > 1 and proofs * c.size > MOST_LEFT:
        raise ArgumentError(
            f"{requirement.name}: losses = {requirement.losses}: {proofs} sets of lost satellites "
            f"are unlike, each a proof of {c.size} satellites; allowed up to {MOST_LEFT // c.size} "
            "sets; ask for fewer losses or satellites"
        )
    for subset, number in subsets.sets.items():
        yield tuple(c.satellite_names[s] for s in subset), number, c.without(subset)


def ask(c: Moving, users: Users, fold: int, course: Course) -> Clearance:
    """Least clearance of users on a course.

    Who stands at every longitude sees in one revolution what he ever sees. What all on the
    latitudes of a polygon have, its own users have too.
    """
    if course.span is None:
        return least_clearance(c, users.belt(), fold)
    if users.longitude is None and isinstance(c, Constellation) and one_period(c):
        revolution = 2 * np.pi / float(c.mean_motion[0]) if c.size else 0.0
        if users.is_belt and course.span[1] - course.span[0] >= revolution:
            return _from(course.span[0], c, least_clearance(c, users, fold))
        belt = least_clearance(c, users.belt(), fold)
        if belt.low >= 0.0:
            own = least_clearance(c, users, fold, span=course.span, most=MARGIN_BOXES)
            return replace(own, low=max(belt.low, own.low))
    return least_clearance(c, users, fold, span=course.span)


def _from(start: float, c: Constellation, clearance: Clearance) -> Clearance:
    """The same clearance of a belt, some whole revolutions on: at its first time in a span."""
    if not np.isfinite(clearance.high):
        return clearance
    revolution = 2 * np.pi / float(c.mean_motion[0])
    later = max(0.0, np.ceil((start - clearance.time) / revolution)) * revolution
    before, after = prime_meridian_angle(c.epoch, [clearance.time, clearance.time + later])
    longitude = np.mod(clearance.longitude + before - after + np.pi, 2 * np.pi) - np.pi
    return replace(clearance, time=clearance.time + float(later), longitude=float(longitude))


def fold_always_met(
    c: Constellation, users: Sequence[Users], requirement: Requirement, course: Course
) -> bool:
    """Whether a fold wanted always is proven for all users and losses; quickly where it is not."""
    assert requirement.fold is not None
    for _, _, left in losses_of(c, requirement, users, course):
        for each in users:
            belt = course.span is None or (each.is_belt and one_period(c))
            asked = each.belt() if belt else each
            span = None if belt else course.span
            if not always_clear(left, asked, requirement.fold, span=span, most=GLANCE_BOXES):
                return False
    return True


def _always(
    c: Constellation,
    users: tuple[Users, ...],
    requirement: Requirement,
    course: Course,
    missed_share: bool,
) -> Verdict:
    """Verdict on a fold wanted always: the tightest of all users, after all losses."""
    assert requirement.fold is not None
    fold = requirement.fold
    cases = [
        (each, lost, alike, left)
        for lost, alike, left in losses_of(c, requirement, users, course)
        for each in users
    ]
    asked = shared(lambda case: ask(case[3], case[0], fold, course), cases)
    cleared = [(clearance, *case) for clearance, case in zip(asked, cases, strict=True)]
    low = min(clearance.low for clearance, *_ in cleared)
    tightest, whose, lost, alike, left = min(cleared, key=lambda one: one[0].high)
    met = True if low >= 0.0 else False if tightest.high < 0.0 else None
    worst = _worst_of(tightest, left, whose, fold)
    margin = low if met or met is None else tightest.high
    verdict = Verdict(
        requirement,
        met,
        "none" if met is None else "proven",
        course.words,
        (1.0, 1.0) if met else None,
        margin if np.isfinite(margin) else None,
        worst,
        lost,
        alike,
    )
    if met is None:
        reason = (
            f"the least clearance lies between {np.degrees(low):.2g} and "
            f"{np.degrees(tightest.high):.2g} deg, nearer to none than is resolved"
        )
        return replace(verdict, reason=reason)
    if met:
        return verdict
    if left.size < fold:
        few = counted(left.size, "satellite")
        return replace(verdict, share=(0.0, 0.0), reason=f"{few} in all, {fold} wanted")
    if not missed_share:
        return verdict
    share = _missed_share(left, whose, tightest, fold, course)
    alone = len(cleared) == 1 and whose.longitude is not None
    return replace(verdict, share=share if share is None or alone else (0.0, share[1]))


def _worst_of(tightest: Clearance, c: Moving, users: Users, fold: int) -> Worst | None:
    """Where and when users have their least clearance; None where that is not known."""
    if not np.isfinite(tightest.high):
        return None
    where = tightest.time, tightest.latitude, tightest.longitude
    return Worst(*where, tightest.seen, rank=fold, elevation=nth_elevation(c, users, fold, *where))


def _missed_share(
    c: Constellation, users: Users, tightest: Clearance, fold: int, course: Course
) -> tuple[float, float] | None:
    """Share of time at the place, or on the circle, at which a fold is missed by most."""
    span = course.span if users.longitude is not None else None
    if span is None:
        if not one_period(c):
            return None
        latitude = geodetic(tightest.latitude, users.figure)
        users = replace(users.belt(), south=latitude, north=latitude)
    share = clear_share(c, users, fold, span=span, width=1e-4, most=MISSED_BOXES)
    return share.low, share.high


def often(
    cases: Iterable[tuple[tuple[str, ...], int, Moving]],
    users: Sequence[Users],
    requirement: Requirement,
    course: Course,
    effort: Effort | None = None,
) -> Verdict:
    """Verdict on a fold wanted for a share, of what is left in some cases (as of `losses_of`)."""
    shares: list[tuple[Share, float, tuple[str, ...], int]] = []
    for lost, alike, left in cases:
        parts = [_share_of(left, each, requirement, course, effort or Effort()) for each in users]
        least = min(parts, key=lambda part: part[0].low)
        high = min(part[0].high for part in parts)
        if requirement.share_of == "area-time":  # a mean lies between its parts
            high = max(part[0].high for part in parts)
        shares.append((replace(least[0], high=high), least[1], lost, alike))
    share, latitude, lost, alike = min(shares, key=lambda one: one[0].low)
    high = min(one[0].high for one in shares)
    wanted = requirement.share
    met = True if share.low >= wanted else False if high < wanted else None
    reason = ""
    if met is None:
        reason = f"the bounds lie on both sides of {wanted:g}; "
        reason += "`compass check --budget-s` looks longer"
    by_time = requirement.share_of == "time"
    worst = Worst(None, latitude, None, high, "share") if by_time else None
    bounds = (min(share.low, high), high)
    return Verdict(
        requirement, met, "bracket", course.words, bounds, None, worst, lost, alike, reason
    )


def _share_of(
    c: Moving, users: Users, requirement: Requirement, course: Course, effort: Effort
) -> tuple[Share, float]:
    """Share of users, and the latitude it is worst at."""
    assert requirement.fold is not None
    fold, seconds = requirement.fold, effort.budget_s
    far: dict[str, Any] = {"level": requirement.share, "most": SHARE_BOXES, "seconds": seconds}
    latitude = centric(0.5 * (users.south + users.north), users.figure)
    if users.longitude is not None:
        place = users.belt() if course.span is None else users
        return clear_share(c, place, fold, span=course.span, **far), latitude
    if requirement.share_of == "area-time":
        if course.span is None and isinstance(c, Constellation) and not users.is_belt:
            return polygon_share(c, users, fold, **far), latitude
        repeats = isinstance(c, Constellation) and one_period(c) and course.for_ever
        span = None if users.is_belt and repeats else course.span
        return clear_share(c, users, fold, span=span, width=1e-3, **far), latitude
    asked_of = users.belt() if course.span is None else users
    share, worst = worst_share(c, asked_of, fold, span=course.span, **far)
    return share, centric(worst, users.figure)
