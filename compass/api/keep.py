"""Station-keeping of a design: what it costs to hold every satellite in its slot."""

from collections.abc import Sequence
from dataclasses import replace
from math import degrees, isfinite, radians
from pathlib import Path

from compass.api.given import given_fold, given_mask, joined_designs
from compass.api.keep_result import YEAR, KeepResult
from compass.api.progress import bar
from compass.api.radii import Asked, at_radii, forces_of, real_motion
from compass.arguments import checked
from compass.coverage.margin import covering_radius
from compass.coverage.promises import box_of
from compass.coverage.room import SlotBox, has_slots, slot_box
from compass.design import Design, Upkeep
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY
from compass.orbits.keeping import keep_kinds, keep_slots


@checked
def keep(
    design: Design | str | Path,
    *others: Design | str | Path,
    years: float | None = None,
    box_deg: float | None = None,
    fold: int | None = None,
    mask_deg: float | None = None,
    radius_km: Sequence[float] = (),
    specific_impulse_s: float | None = None,
    dry_mass_kg: float | None = None,
    smallest_burn_m_s: float | None = None,
    execution_error: float | None = None,
    navigation_error_m: float | None = None,
    seed: int = 0,
    progress: bool = False,
) -> KeepResult:
    """Simulate impulsive station-keeping of every satellite in its slot along the track.

    Parameters
    ----------
    design, *others
        A design, or the path of its file; several are one network, their satellites together. One
        of two-body motion is kept under the default forces. Orbits that are oval, or of several
        radii or inclinations, are kept kind by kind and need `box_deg`.
    years
        Time to simulate, Earth years of 365.25 days; else the design's, as all that follows.
    box_deg
        Half width of the box along the track, degrees; else half of what the margin allows, where
        all orbits are circles of one radius and inclination.
    fold, mask_deg
        Satellites in view at once everywhere and elevation mask, degrees; else what the design
        requires, or its fold everywhere.
    radius_km
        Radii at which to look how long the pattern lasts untouched, for as long.
    specific_impulse_s, dry_mass_kg
        For the propellant.
    smallest_burn_m_s, execution_error, navigation_error_m
        Of the burns: the least, the relative error, the error of the place along the track.
    seed
        Of the errors.
    progress
        Show bars on stderr.

    Raises
    ------
    ArgumentError, DesignError
        An option or the design is not allowed.

    Examples
    --------
    >>> import compass
    >>> found = compass.keep("designs/compass-15-5-1.toml", years=0.1)
    >>> found.holds, len(found.delta_v_m_s_year)
    (True, 15)
    """
    read = joined_designs((design, *others))
    upkeep = _upkeep(
        read.upkeep,
        years=years,
        specific_impulse_s=specific_impulse_s,
        dry_mass_kg=dry_mass_kg,
        smallest_burn_m_s=smallest_burn_m_s,
        execution_error=execution_error,
        navigation_error_m=navigation_error_m,
    )
    c, motion = read.constellation, real_motion(read)
    forces = forces_of(motion, "keep")
    wanted, mask = given_fold(fold, read), given_mask(mask_deg, read).highest
    own = fold is None and mask_deg is None
    slots = has_slots(c)
    if slots:
        margin = _margin(read, wanted, mask, own, box_deg is not None)
    elif box_deg is None:
        raise ArgumentError(
            "box_deg: missing; orbits that are oval, or of several radii or inclinations, form no "
            "slots that turn as one, so that none follows from a margin; give how far each may "
            "leave its place among its kind along the track, degrees"
        )
    else:
        margin = 2.0 * radians(box_deg)
    width = 0.5 * margin if box_deg is None else radians(box_deg)
    kept = (keep_slots if slots else keep_kinds)(
        c,
        forces,
        upkeep.duration,
        width,
        across=0.5 * width,
        smallest_burn=upkeep.smallest_burn,
        execution_error=upkeep.execution_error,
        navigation_error=upkeep.navigation_error,
        seed=seed,
        progress=lambda parts: bar(progress, "keeping", parts),
    )
    days = upkeep.duration / SECONDS_PER_DAY
    asked = None if own else Asked(wanted, mask)
    radii = at_radii(read, radius_km, days=days, asked=asked, progress=progress)
    return KeepResult(read, motion.title, kept, degrees(margin), upkeep, radii)


def _margin(design: Design, fold: int, mask: float, own: bool, boxed: bool) -> float:
    """How far a satellite may leave its slot, radians.

    Parameters
    ----------
    design, fold, mask
        Whose slots; what is asked for everywhere.
    own
        Whether what the design requires counts instead, if anything.
    boxed
        Whether a box is given, so that there need be no room.

    Raises
    ------
    ArgumentError
        There is none, and no box is given.
    """
    box, where = box_of(design) if own and design.requirements else None, "what is required"
    if box is None:
        box, where = _everywhere(design, fold, mask), "the whole sphere"
    if not boxed and box.sideways <= 0.0:
        raise ArgumentError(
            f"fold = {fold}: {where} does not have it above {degrees(mask):g} deg, so "
            f"no slot has any room ({degrees(box.sideways):.3g} deg); give less, a lower mask or "
            "box_deg"
        )
    return box.sideways


def _everywhere(design: Design, fold: int, mask: float) -> SlotBox:
    """Box with which a fold is kept on the whole sphere.

    Raises
    ------
    ArgumentError
        No mask has it.
    """
    covering = covering_radius(design.constellation, fold, tolerance=1e-5).radius
    if not isfinite(covering):
        raise ArgumentError(
            f"fold = {fold}: the pattern has it at no mask, so no slot has any room; give less"
        )
    figure = design.figure
    return slot_box(design.constellation, covering, figure.equatorial_radius, mask, figure.stretch)


#: Options: field of `Upkeep`, factor to SI.
_FIELDS = {
    "years": ("duration", YEAR),
    "specific_impulse_s": ("specific_impulse", 1.0),
    "dry_mass_kg": ("dry_mass", 1.0),
    "smallest_burn_m_s": ("smallest_burn", 1.0),
    "execution_error": ("execution_error", 1.0),
    "navigation_error_m": ("navigation_error", 1.0),
}


def _upkeep(given: Upkeep, **options: float | None) -> Upkeep:
    """Return what a design says, but for the options that are given."""
    changed = {}
    for name, value in options.items():
        field_name, factor = _FIELDS[name]
        if value is not None:
            changed[field_name] = value * factor
    return replace(given, **changed)
