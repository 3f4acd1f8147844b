"""What a design is."""

from compass.quantities.record import Quantity

DESIGN = (
    Quantity("name", "1", "name", form="text", meaning="What the design is called."),
    Quantity(
        "pattern", "1", "pattern", form="text",
        meaning="Kind of symmetric pattern, or explicit elements.",
    ),
    Quantity(
        "satellites", "1", "number of satellites", better="less", form="count",
        meaning="Satellites of the constellation.",
    ),
    Quantity(
        "notation", "1", "notation", form="text",
        meaning="The pattern's short name, Walker's i: t/p/f or Ballard's (N, P, m).",
    ),
    Quantity(
        "planes", "1", "number of planes", better="less", form="count",
        meaning="Orbital planes of the pattern.",
    ),
    Quantity(
        "satellites_per_plane", "1", "satellites in a plane", form="count",
        meaning="Satellites that share an orbit.",
    ),
    Quantity(
        "phasing", "1", "phasing", form="count",
        meaning="Walker's f: a step to the next plane is f/t of a revolution.",
    ),
    Quantity(
        "raan_spacing_deg", "deg", "spacing of the nodes", 6,
        meaning="Angle between the ascending nodes of neighbouring planes.",
    ),
    Quantity(
        "phase_step_deg", "deg", "phase from plane to plane", 6,
        meaning="Difference of argument of latitude between neighbouring planes.",
    ),
    Quantity("inclination_deg", "deg", "inclination", 6, meaning="Of all planes to the equator."),
    Quantity("radius_km", "km", "orbit radius", 8, meaning="Of the circular orbits."),
    Quantity(
        "altitude_km", "km", "altitude over the equator", 7,
        meaning="Orbit radius less the equatorial radius of the reference figure.",
    ),
    Quantity("period_h", "h", "period", 6, meaning="Of one revolution, two-body."),
    Quantity("multiplier", "1", "multiplier m", form="text", meaning="Ballard's m of a rosette."),
    Quantity(
        "repeat_sidereal_days", "1", "ground tracks repeat after sidereal days", form="count",
        meaning="Rotations of Mars after which the ground tracks repeat.",
    ),
    Quantity(
        "repeat_revolutions", "1", "ground tracks repeat after revolutions", form="count",
        meaning="Revolutions of a satellite in that time.",
    ),
    Quantity(
        "repeat_miss_deg", "deg", "miss of the repeat", 3, "less",
        meaning="How far from closed the ground tracks are after it.",
    ),
    Quantity("epoch_tdb", "1", "epoch, TDB", form="text", meaning="When the elements hold."),
    Quantity("figure", "1", "reference figure", form="text", meaning="The shape taken for Mars."),
    Quantity(
        "wanted_fold", "1", "fold wanted", form="count",
        meaning="How many satellites must be in view at once.",
    ),
)  # fmt: skip
