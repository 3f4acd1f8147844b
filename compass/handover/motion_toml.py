"""The table ``[motion]`` of a design file."""

from compass.errors import ArgumentError
from compass.orbits.gravity import built_in_field
from compass.orbits.motion import Motion


def motion_lines(motion: Motion) -> list[str]:
    """Lines of the table; none for motion on ellipses, which needs no word.

    Raises
    ------
    ArgumentError
        A field of gravity that is not the built-in one, or a table of states: both are files.
    """
    if motion.model == "two-body":
        return []
    if motion.table is not None:
        raise ArgumentError(
            "motion: an ephemeris is in its own files; export oem, or make ellipses of it first"
        )
    lines = ["", "[motion]", f'model = "{motion.model}"']
    forces = motion.forces
    if forces is None:
        return [*lines, ""]
    degree = forces.field.degree
    if degree > built_in_field().degree or forces.field != built_in_field().truncated(degree):
        raise ArgumentError(
            f"motion: the gravity field {forces.field.name} is in a file of its own; "
            "a design file can name it, not hold it"
        )
    return [
        *lines,
        f"gravity_degree = {degree}",
        f"sun = {str(forces.sun).lower()}",
        f"moons = {str(forces.moons).lower()}",
        f"radiation_m2_kg = {forces.radiation!r}",
        f'shadow = "{forces.shadow}"',
        "",
    ]
