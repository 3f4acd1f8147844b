"""How long a pattern lasts untouched at other radii."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import degrees
from typing import Any

import numpy as np

from compass.api.progress import bar
from compass.cores import shared
from compass.coverage.lasting import margins_at, prove_span
from compass.coverage.promises import lead_of, promises_of
from compass.coverage.region import GLOBE, Region
from compass.design import Design
from compass.errors import ArgumentError, found_so_far
from compass.frames import SECONDS_PER_DAY
from compass.orbits.forces import ForceModel
from compass.orbits.motion import Motion
from compass.orbits.patterns import FARTHEST_KM
from compass.orbits.trajectory import COARSE
from compass.orbits.trimming import beat_of, can_trim, trim, with_axes

#: Moments of what is proven at which the margin is looked at.
MOMENTS = 100

#: Beat, days, above which orbits keep pace with Mars and no trim helps.
RESONANT = 100.0


@dataclass(frozen=True)
class RadiusLasts:
    """How long a pattern lasts at another radius, left alone after one trim.

    Attributes
    ----------
    radius_km
        Of the nominal orbits.
    days_proven
        For which its fold is proven.
    first_loss_days
        When it is lost; None if it is not in the span.
    margin_deg
        Least exact margin at the moments looked at, degrees.
    beat_days
        Period of the swing under the field's strongest term there: long near a resonance.
    trimmed
        Whether a trim was possible.
    resonance
        Revolutions to rotations of Mars where the beat is longer than `RESONANT`; else empty.
    """

    radius_km: float
    days_proven: float
    first_loss_days: float | None
    margin_deg: float
    beat_days: float
    trimmed: bool
    resonance: str = ""

    def as_dict(self) -> dict[str, Any]:
        """Plain values."""
        return vars(self).copy()


@dataclass(frozen=True)
class Asked:
    """What is asked of a pattern where that is not what its design requires.

    Attributes
    ----------
    fold, mask, region
        Satellites in view at once, above what, radians, and where.
    """

    fold: int
    mask: float
    region: Region = GLOBE


def real_motion(design: Design) -> Motion:
    """Return the design's motion, or that under the default forces where it says two-body."""
    return Motion("numerical") if design.motion.model == "two-body" else design.motion


def forces_of(motion: Motion, wanted: str) -> ForceModel:
    """Return a motion's forces.

    Parameters
    ----------
    motion
        The motion.
    wanted
        The argument that needs them, or what does.

    Raises
    ------
    ArgumentError
        It has none.
    """
    if motion.forces is None:
        where = "" if motion.table is None else "a design of elements, as export writes one, with "
        raise ArgumentError(
            f"{wanted}: needs forces, which {motion.title} has not; give {where}[motion] "
            'model = "numerical"'
        )
    return motion.forces


def at_radii(
    design: Design,
    radius_km: Sequence[float],
    *,
    days: float,
    asked: Asked | None = None,
    progress: bool = False,
) -> tuple[RadiusLasts, ...]:
    """How long a design's pattern lasts at other radii, km, from the epoch on.

    Parameters
    ----------
    design, radius_km, days
        Whose pattern, where and how far to look.
    asked
        What of; else what the design requires, or its fold everywhere.
    progress
        Show a bar on stderr.

    Raises
    ------
    ArgumentError
        Orbits of several axes, or a motion without forces.
    """
    if asked is None and not design.requirements:
        asked = Asked(design.fold, design.mask.highest)

    def look(radius: float) -> RadiusLasts:
        return _at_radius(design, radius, days * SECONDS_PER_DAY, asked)

    # kernels release the interpreter, so that two radii are followed at once on two cores
    found = list[RadiusLasts]()
    with found_so_far(lambda: _sentences(found, days)):
        shown = bar(progress and len(radius_km) > 0, "radii", radius_km)
        for _, each in zip(shown, shared(look, radius_km), strict=True):
            found.append(each)
    return tuple(found)


def _sentences(found: Sequence[RadiusLasts], days: float) -> str:
    """What is known of radii before the others are."""
    return "\n".join(
        f"at {each.radius_km:g} km proven for {each.days_proven:.6g} of {days:g} days"
        for each in found
    )


def _at_radius(design: Design, radius_km: float, stop: float, asked: Asked | None) -> RadiusLasts:
    """How long the same pattern lasts on another radius."""
    c, motion = design.constellation, real_motion(design)
    forces = forces_of(motion, "radius_km")
    axes = c.semi_major_axis
    if not c.size:
        raise ArgumentError("radius_km: a sweep needs satellites; the design has none")
    if np.ptp(axes) > 1e-9 * axes[0]:
        raise ArgumentError(
            f"radius_km: the orbits have several axes, {axes.min() / 1e3:g} to "
            f"{axes.max() / 1e3:g} km, for which one radius cannot stand; sweep the "
            "satellites of each in a design of their own"
        )
    moved = with_axes(c, np.full(c.size, radius_km * 1e3))
    told = beat_of(moved, forces.field)
    trimmed, beat = can_trim(told), told.period / SECONDS_PER_DAY
    resonance = told.ratio if beat > RESONANT else ""
    chosen = trim(moved, forces, stop).constellation if trimmed else moved
    path = motion.trajectory(chosen, 0.0, stop, tolerance=COARSE)
    if asked is None:
        flown = replace(design, constellation=chosen)
        found = promises_of(flown, path, 0.0, stop)
        lead = lead_of(flown, found, path, 0.0, stop)
        fold, region = lead.fold, lead.claim.region
        sphere, mask, stretch = lead.claim.radius, lead.claim.highest, lead.claim.stretch
        known = [each.decides for each in found] or [lead.lasting]
        until = min(one.proven_until for one in known)
        losses = [one.first_loss_days for one in known if one.first_loss_days is not None]
        lost = min(losses, default=None)
    else:
        fold, mask, region = asked.fold, asked.mask, asked.region
        sphere = design.figure.equatorial_radius
        stretch = design.figure.stretch
        asks: Any = {"sphere_radius": sphere, "stretch": stretch, "mask": mask, "region": region}
        lasts = prove_span(path, fold, **asks, stop=stop)
        until, lost = lasts.proven_until, lasts.first_loss_days
    times = np.linspace(0.0, max(until, 1.0), MOMENTS)
    margins = margins_at(
        path, fold, times, sphere_radius=sphere, stretch=stretch, mask=mask, region=region
    )
    days = until / SECONDS_PER_DAY
    least = degrees(float(margins.min()))
    return RadiusLasts(radius_km, days, lost, least, beat, trimmed, resonance)


def read_radii(text: str) -> list[float]:
    """Radii of ``FIRST..LAST:STEP`` or of a list with commas, km.

    Raises
    ------
    ArgumentError
        Neither, or more than 1000.
    """
    try:
        if ".." in text:
            ends, _, step = text.partition(":")
            first, last = (float(part) for part in ends.split(".."))
            count = int(np.floor((last - first) / float(step) + 1e-9)) + 1
            found = [first + k * float(step) for k in range(min(count, 1001))]
        else:
            found = [float(part) for part in text.split(",")]
    except (ValueError, ZeroDivisionError, OverflowError):
        found = []
    if not 0 < len(found) <= 1000 or not all(0 < radius <= FARTHEST_KM for radius in found):
        raise ArgumentError(
            f"radius_km = {text!r}: write FIRST..LAST:STEP or A,B,C in km, at most 1000 radii"
        )
    return found
