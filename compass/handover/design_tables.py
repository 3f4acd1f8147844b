"""Tables of a design file beside orbits, users and signal: motion, access, links, requirements."""

from collections.abc import Iterator

import numpy as np

from compass.bodies import SOLAR_DAY
from compass.design import Design, Launching, Upkeep
from compass.handover.decimals import decimal, number
from compass.inputs.toml_values import toml_text, toml_value
from compass.links import Radio
from compass.orbits.forces import ForceModel
from compass.orbits.gravity import MERIDIANS, GravityField, built_in_field
from compass.requirement import Requirement
from compass.units import KM

MHZ, SOL = 1e6, SOLAR_DAY.value
YEAR = 365.25 * 86400.0


def table_lines(design: Design) -> list[str]:
    """Tables ``[motion]``, ``[access]``, ``[[link]]`` and ``[[requirement]]`` of a design.

    One that says nothing but what a file means without it is left out.
    """
    return [
        *_motion(design),
        *_keeping(design),
        *_deployment(design),
        *_access(design),
        *(line for radio in design.radios for line in _link(radio)),
        *(line for wanted in design.requirements for line in _requirement(wanted)),
    ]


def not_kept(design: Design) -> tuple[str, ...]:
    """What of a design its file cannot say, a sentence each."""
    return tuple(_not_kept(design))


def _not_kept(design: Design) -> Iterator[str]:
    motion = design.motion
    if motion.table is not None:
        yield (
            "the trajectories of its ephemeris are not in the file, which has the ellipses that "
            "touch them at the epoch; export them as oem and name those files"
        )
    forces = motion.forces
    if forces is not None and not (forces.field.file or _is_built_in(forces)):
        yield (
            f"the gravity field {forces.field.name} is not in the file; write it as one and "
            "name that under motion.gravity_file"
        )
    if lit := [site.name for site in design.beacons]:
        yield (
            f"beacons on the ground ({', '.join(lit)}) are not in the file; give them to the "
            "commands that count them, as --beacon"
        )
    named = {site.name: site for site in design.stations}
    for wanted in design.requirements:
        for site in wanted.sites:
            if named.get(site.name) != site:
                yield (
                    f"the site {site.name!r} of {wanted.name!r} is not in the file; make it one "
                    "of the design's stations"
                )


def _motion(design: Design) -> list[str]:
    motion = design.motion
    if motion.model in ("two-body", "ephemeris"):
        return []
    lines = ["", "[motion]", f"model = {toml_text(motion.model)}"]
    if motion.forces is not None:
        f = motion.forces
        lines += [
            *_gravity(f.field),
            f"sun = {toml_value(f.sun)}",
            f"moons = {toml_value(f.moons)}",
            f"radiation_m2_kg = {number(f.radiation)}",
            f"shadow = {toml_text(f.shadow)}",
        ]
    return lines


def _gravity(field: GravityField) -> list[str]:
    """Lines of the file that a field was read from, or of the built-in one instead."""
    if not field.file:
        return [f"gravity_degree = {min(field.degree, built_in_field().degree)}"]
    (frame,) = (name for name, angle in MERIDIANS.items() if angle == field.meridian)
    return [
        f"gravity_file = {toml_text(field.file)}",
        f"gravity_frame = {toml_text(frame)}",
        f"gravity_degree = {field.degree}",
    ]


def _keeping(design: Design) -> list[str]:
    u, plain = design.upkeep, Upkeep()
    if u == plain:
        return []
    return [
        "",
        "[keeping]",
        f"specific_impulse_s = {number(u.specific_impulse)}",
        f"dry_mass_kg = {number(u.dry_mass)}",
        f"smallest_burn_m_s = {number(u.smallest_burn)}",
        f"execution_error = {number(u.execution_error)}",
        f"navigation_error_m = {number(u.navigation_error)}",
        f"years = {decimal(u.duration / YEAR, lambda x: x * YEAR, u.duration)}",
    ]


def _deployment(design: Design) -> list[str]:
    known = design.launching
    if known == Launching():
        return []
    low, high = (decimal(h / KM, lambda x: x * KM, h) for h in known.waiting)
    days = decimal(known.longest_wait / 86400.0, lambda x: x * 86400.0, known.longest_wait)
    each = known.satellites_a_launch
    return [
        "",
        "[deployment]",
        f"launch_altitude_km = {decimal(known.launched / KM, lambda x: x * KM, known.launched)}",
        f"waiting_altitude_km = [{low}, {high}]",
        f"longest_wait_days = {days}",
        *([] if each is None else [f"satellites_a_launch = {each}"]),
    ]


def _is_built_in(forces: ForceModel) -> bool:
    """Whether the field is the built-in one, to some degree of it."""
    field, known = forces.field, built_in_field()
    if field.degree > known.degree:
        return False
    same = known.truncated(field.degree)
    numbers = (field.gm, field.radius, field.meridian) == (same.gm, same.radius, same.meridian)
    return numbers and np.array_equal(field.c, same.c) and np.array_equal(field.s, same.s)


def _access(design: Design) -> list[str]:
    wanted, plain = design.access, Design(design.constellation)
    same = (
        wanted == plain.access
        and design.access_duration == plain.access_duration
        and design.conjunction == plain.conjunction
    )
    if same:
        return []
    sols = decimal(design.access_duration / SOL, lambda x: x * SOL, design.access_duration)
    return [
        "",
        "[access]",
        f"duration_sols = {sols}",
        f"moons = {toml_value(list(wanted.moons))}",
        f"earth = {toml_value(wanted.earth)}",
        f"crosslinks = {toml_value(wanted.crosslinks)}",
        f"atmosphere_height_km = {_kilometres(wanted.atmosphere_height)}",
        f"conjunction_deg = {_degrees(design.conjunction)}",
    ]


def _link(radio: Radio) -> list[str]:
    megahertz = decimal(radio.frequency / MHZ, lambda x: x * MHZ, radio.frequency)
    return [
        "",
        "[[link]]",
        f"between = {toml_value(list(radio.between))}",
        f"frequency_mhz = {megahertz}",
        f"eirp_dbw = {number(radio.eirp)}",
        f"g_over_t_db_per_k = {number(radio.figure_of_merit)}",
        f"required_cn0_dbhz = {number(radio.required)}",
    ]


def _requirement(wanted: Requirement) -> list[str]:
    lines = ["", "[[requirement]]", f"name = {toml_text(wanted.name)}"]
    if wanted.sites:
        lines.append(f"sites = {toml_value([site.name for site in wanted.sites])}")
    if wanted.regions:
        lines.append(f"region = {toml_value(list(wanted.regions))}")
    if wanted.fold is not None:
        lines.append(f"fold = {wanted.fold}")
    if wanted.mask is not None:
        lines.append(f"mask_deg = {_degrees(wanted.mask)}")
    lines += [f"{name}_at_most = {number(limit)}" for name, limit in wanted.limits]
    return [
        *lines,
        f"share = {number(wanted.share)}",
        f"share_of = {toml_text(wanted.share_of)}",
        f"altitude_km = {_kilometres(wanted.altitude)}",
        f"losses = {wanted.losses}",
        *([] if wanted.beam is None else [f"beam_deg = {_degrees(wanted.beam)}"]),
        *([f"error_as = {toml_text(wanted.error_as)}"] if wanted.error_as != "one-sigma" else []),
    ]


def _degrees(radians: float) -> str:
    return decimal(float(np.degrees(radians)), np.radians, radians)


def _kilometres(metres: float) -> str:
    return decimal(metres / KM, lambda km: km * KM, metres)
