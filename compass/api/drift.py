"""A design left alone on real orbits: how long it lasts, and which radius keeps itself."""

from collections.abc import Sequence
from dataclasses import replace
from math import degrees
from pathlib import Path
from typing import Any

from compass.api.drift_result import DriftResult
from compass.api.given import given_fold, given_mask, in_metres, joined_designs
from compass.api.progress import bar, foretell, parts_bar
from compass.api.radii import Asked, at_radii, forces_of, real_motion
from compass.arguments import checked
from compass.coverage.drift import drift_of
from compass.coverage.lasting import prove_span
from compass.coverage.promises import lead_of, promises_of, with_rooms
from compass.coverage.region import GLOBE, read_region
from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY
from compass.orbits.approach import closest_approaches
from compass.orbits.trimming import trim


@checked
def drift(
    design: Design | str | Path,
    *others: Design | str | Path,
    days: float = 687.0,
    start_day: float = 0.0,
    step_days: float | None = None,
    fold: int | None = None,
    mask_deg: float | None = None,
    region: str | None = None,
    trimmed: bool = False,
    radius_km: Sequence[float] = (),
    avoid_km: float | None = None,
    progress: bool = False,
) -> DriftResult:
    """Follow designs that are left alone: margin and room over time, and the first loss, proven.

    Of a design with requirements the place is followed that is lost first, unless another fold,
    mask or region is asked for. Where none of them wants satellites always, margin and room are of
    the design's fold, of which nothing else is said.

    A design of two-body motion is followed under the default forces: GMM-3 to degree 8, Sun,
    Phobos, Deimos and radiation on 0.026 m^2/kg with shadow.

    Parameters
    ----------
    design, *others
        A design, or the path of its file; several are one network, their satellites together.
    days, start_day
        Span, days, and its begin after the epoch.
    step_days
        Between the moments at which margin and room are given.
    fold, mask_deg
        Satellites in view at once and elevation mask, degrees; else the design's.
    region
        Where: ``globe``, ``lat:MIN:MAX`` or ``polygon:LAT,LON;LAT,LON;...``, degrees; else where
        the design's requirements say, or everywhere. Requirements are followed in any case.
    trimmed
        Whether to trim the initial axes first.
    radius_km
        Radii at which to look how long the pattern lasts, trimmed where it can be.
    avoid_km
        Distance to keep from the centres of Phobos and Deimos.
    progress
        Show bars on stderr.

    Raises
    ------
    ArgumentError, DesignError
        An option or the design is not allowed.

    Examples
    --------
    >>> import compass
    >>> found = compass.drift("designs/compass-15-5-1.toml", days=2)
    >>> found.days_proven
    2.0
    """
    if step_days is not None and not step_days <= days:
        raise ArgumentError(f"step_days = {step_days:g}: allowed above 0 to days, {days:g}")
    read = joined_designs((design, *others))
    if read.requirements:  # which may want errors
        read = in_metres(read)
    wanted = given_fold(fold, read)
    mask = given_mask(mask_deg, read).highest
    where = GLOBE if region is None else read_region(region)
    motion = real_motion(read)
    start, stop = start_day * SECONDS_PER_DAY, (start_day + days) * SECONDS_PER_DAY
    c, done = read.constellation, None
    if trimmed:
        done = trim(
            c, forces_of(motion, "trimmed"), stop, progress=lambda x: bar(progress, "trim", x)
        )
        c = done.constellation
    path = motion.trajectory(c, start, stop, progress=lambda x: bar(progress, "orbits", x))
    with parts_bar(progress, "requirements") as told:
        kept = promises_of(read, path, start, stop, told)
    sphere, highest, ground, lasting = read.figure.equatorial_radius, mask, "", None
    stretch = read.figure.stretch
    own = bool(kept) and fold is None and mask_deg is None and region is None
    asked = True
    if own:
        lead = lead_of(read, kept, path, start, stop)
        where = replace(lead.claim.region, name=lead.claim.name)
        wanted, lasting = lead.fold, replace(lead.lasting, region=where)
        sphere, highest, stretch = lead.claim.radius, lead.claim.highest, lead.claim.stretch
        mask, ground, asked = lead.claim.mask, lead.claim.ground, lead.asked
    place: dict[str, Any] = {
        "sphere_radius": sphere,
        "mask": highest,
        "region": where,
        "stretch": stretch,
    }
    if lasting is None:
        shown: Any = {"progress": lambda x: bar(progress, "proof", x)}
        lasting = prove_span(path, wanted, **place, start=start, stop=stop, **shown)
    found = drift_of(
        read.constellation,
        path,
        wanted,
        days=days,
        start_day=start_day,
        **place,
        step_days=step_days,
        lasting=lasting,
        progress=lambda x: bar(progress, "margins", x),
        foretell=lambda seconds: foretell(progress, "margins", seconds),
    )
    radii = at_radii(
        read,
        radius_km,
        days=start_day + days,
        asked=None if own else Asked(wanted, mask, where),
        progress=progress,
    )
    kept = with_rooms(kept, read, path, found.times)
    near = closest_approaches(path, start, stop)
    return DriftResult(
        read, degrees(mask), motion.title, found, done, radii, kept, near, avoid_km, ground, asked
    )
