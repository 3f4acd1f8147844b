"""What a number is: one record a quantity, read by text, JSON, HTML, netCDF, axes and studies.

The record is a number's birth certificate: its name with the unit in it, as in JSON and files, its
unit, the words for it, how many digits say something, which way is better. Nobody else spells a
label or a digit.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Literal

from compass.errors import ArgumentError

Form = Literal["real", "count", "share", "yes-no", "text"]


@dataclass(frozen=True)
class Quantity:
    """What a number is.

    Attributes
    ----------
    name
        As in JSON, files and columns, with the unit in it: ``mask_margin_deg``.
    unit
        As CF writes it (``deg``, ``km``, ``m s-1``); ``1`` for a pure number.
    title
        The words for it, without the unit.
    digits
        Significant digits that say something.
    better
        ``more``, ``less``, or ``""`` where neither is.
    form
        ``real``, ``count``, ``share`` (0 to 1, shown in per cent), ``yes-no`` or ``text``.
    limits
        Ends of axes and colours that all pictures of it share, or None.
    ticks
        Marks between them.
    meaning
        A sentence for who has not met it.
    standard_name
        The CF convention's name, if it has one.
    """

    name: str
    unit: str
    title: str
    digits: int = 4
    better: Literal["more", "less", ""] = ""
    form: Form = "real"
    limits: tuple[float, float] | None = None
    ticks: tuple[float, ...] = ()
    meaning: str = ""
    standard_name: str | None = None

    @property
    def shown_unit(self) -> str:
        """The unit as a reader sees it: per cent of a share, nothing of a pure number."""
        return "%" if self.form == "share" else "" if self.unit == "1" else self.unit

    @property
    def heading(self) -> str:
        """Title and unit, for a column or an axis."""
        return self.title + (f", {self.shown_unit}" if self.shown_unit else "")

    def attributes(self) -> dict[str, str]:
        """Attributes of a gridded variable after the CF convention."""
        unit = "1" if self.form != "real" else self.unit
        named = {"standard_name": self.standard_name} if self.standard_name else {}
        return {"units": unit, "long_name": self.title, **named}


_COVERAGE = (
    Quantity(
        "fold", "1", "fold wanted", form="count",
        meaning="How many satellites must be in view at once.",
    ),
    Quantity(
        "min_fold", "1", "least fold", better="more", form="count",
        meaning="Fewest satellites above the mask at any place and time looked at.",
    ),
    Quantity(
        "max_fold", "1", "greatest fold", better="more", form="count",
        meaning="Most satellites above the mask at any place and time looked at.",
    ),
    Quantity(
        "cap_radius_min_deg", "deg", "smallest cap radius for the fold", 4, "less",
        meaning="Caps about the points below the satellites need this radius for the fold "
        "wanted everywhere and always.",
    ),
    Quantity(
        "mask_margin_deg", "deg", "highest mask with the fold", 3, "more",
        meaning="The elevation mask may be raised to this before the fold wanted is lost.",
    ),
    Quantity(
        "mask_deg", "deg", "elevation mask", 4,
        meaning="A satellite counts as in view above this elevation.",
    ),
    Quantity(
        "lowest_altitude_km", "km", "lowest altitude at this mask", 5, "less",
        meaning="The same pattern, lower, keeps the fold wanted down to this altitude.",
    ),
    Quantity(
        "fold_share", "1", "share of area and time", 5, form="share",
        meaning="Part of the sphere and of the time with so many satellites in view.",
    ),
    Quantity(
        "alike", "1", "sets alike", form="count",
        meaning="Sets of satellites that the pattern's symmetry makes equal to this one.",
    ),
    Quantity(
        "closest_approach_deg", "deg", "closest two satellites", 3, "more",
        meaning="Least angle between two satellites, seen from Mars's centre, at any time.",
    ),
    Quantity(
        "fold_proven", "1", "continuous fold at the mask", better="more", form="yes-no",
        meaning="Whether the fold wanted is proven everywhere and always.",
    ),
)  # fmt: skip

_DESIGN = (
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

_GEOMETRY = (
    Quantity(
        "cap.half_cone_deg", "deg", "half cone, seen from the satellite", 6,
        meaning="Angle at the satellite between Mars's centre and the rim of its cap.",
    ),
    Quantity(
        "cap.half_arc_deg", "deg", "cap radius, seen from the centre", 6, "more",
        meaning="Angle at Mars's centre between the satellite and the rim of its cap.",
    ),
    Quantity(
        "cap.tangent_km", "km", "distance from the satellite to the rim", 7,
        meaning="Along the line of sight that grazes the mask.",
    ),
    Quantity("cap.radius_km", "km", "radius of the rim", 7, meaning="Of the rim as a circle."),
    Quantity(
        "cap.depth_km", "km", "depth of the cap", 7,
        meaning="Height of the cap over the plane of its rim.",
    ),
    Quantity("cap.arc_km", "km", "cap radius on the ground", 7, meaning="Along the surface."),
    Quantity(
        "cap.area_km2", "km2", "area of the cap", 7, "more", meaning="Area that one satellite sees."
    ),
    Quantity(
        "cap.fraction", "1", "share of the sphere in the cap", 6, "more", "share",
        meaning="Area of the cap over that of the sphere.",
    ),
    Quantity(
        "gap.sides", "1", "sides of the gap", form="count",
        meaning="Arcs that bound the polygon which one plane leaves uncovered about a pole of it.",
    ),
    Quantity("gap.depth_km", "km", "depth of the gap", 7, meaning="Height of the gap polygon."),
    Quantity("gap.base_km", "km", "base of the gap", 7, meaning="Length of a side."),
    Quantity(
        "gap.area_km2", "km2", "area of the gap", 7, "less",
        meaning="Of one gap polygon, flat and on the sphere.",
    ),
    Quantity(
        "gap.fraction", "1", "share of the sphere in the gap", 6, "less", "share",
        meaning="Area of one gap over that of the sphere.",
    ),
    Quantity(
        "gap.vertex_deg", "deg", "angle at the gap's corners", 6, meaning="On the sphere."
    ),
    Quantity(
        "gap.limit_circumference_km", "km", "sum of the gap bases", 7,
        meaning="One base a plane, all around.",
    ),
    Quantity(
        "gap.circumference_km", "km", "parallel that the gap bases are compared with", 7,
        meaning="If the bases add up to less, gaps of different planes need not meet.",
    ),
    Quantity(
        "plane.served_area_km2", "km2", "area that one plane serves", 7, "more",
        meaning="The sphere without the plane's two gaps.",
    ),
    Quantity(
        "plane.served_fraction", "1", "share of the sphere that one plane serves", 6, "more",
        "share", meaning="The same over the area of the sphere.",
    ),
    Quantity(
        "plane.gap_area_km2", "km2", "area of one plane's gaps", 7, "less", meaning="Of both."
    ),
    Quantity(
        "plane.neighbour_overlap_km2", "km2", "area that two neighbours both serve", 7,
        meaning="Lens between the caps of two satellites that follow each other.",
    ),
    Quantity("totals.sphere_area_km2", "km2", "area of the sphere", 7, meaning="4 pi R^2."),
    Quantity(
        "totals.served_area_km2", "km2", "sum of all caps", 7, "more",
        meaning="Overlaps counted as often as they are served.",
    ),
    Quantity(
        "totals.served_fraction", "1", "mean number of satellites in view", 6, "more",
        meaning="Sum of all caps over the area of the sphere.",
    ),
    Quantity("totals.gaps", "1", "number of gaps", form="count", meaning="Two a plane."),
    Quantity("totals.gap_area_km2", "km2", "area of all gaps", 7, "less", meaning="Summed."),
    Quantity(
        "totals.gap_fraction", "1", "sum of all gaps over the sphere", 6, "less", "share",
        meaning="Their area over that of the sphere.",
    ),
    Quantity(
        "periapsis_altitude_km", "km", "periapsis altitude", 7,
        meaning="Lowest height over the sphere.",
    ),
    Quantity(
        "apoapsis_altitude_km", "km", "apoapsis altitude", 7,
        meaning="Greatest height over the sphere.",
    ),
    Quantity("eccentricity", "1", "eccentricity", 6, meaning="Of the orbit."),
    Quantity("raan_deg", "deg", "RAAN", 6, meaning="Right ascension of the ascending node."),
    Quantity(
        "cap_at_periapsis_deg", "deg", "cap radius at periapsis", 5,
        meaning="Horizon cap at the lowest point.",
    ),
    Quantity(
        "cap_at_apoapsis_deg", "deg", "cap radius at apoapsis", 5,
        meaning="Horizon cap at the highest point.",
    ),
)  # fmt: skip


def _dilution(name: str, of: str) -> Quantity:
    return Quantity(
        name, "1", name.upper(), 3, "less", limits=(1.0, 10.0), ticks=(1, 2, 3, 4, 6, 10),
        meaning=f"{of} dilution of precision: error of the fix for one unit of range error; "
        "infinite with fewer than four satellites in view.",
    )  # fmt: skip


_MAPS = (
    Quantity(
        "count.min", "1", "fewest satellites in view", better="more", form="count",
        meaning="At any cell and epoch.",
    ),
    Quantity(
        "count.mean", "1", "satellites in view, mean", 4, "more", meaning="Over area and time."
    ),
    Quantity(
        "count.max", "1", "most satellites in view", better="more", form="count",
        meaning="At any cell and epoch.",
    ),
    _dilution("gdop", "Geometric"),
    _dilution("pdop", "Position"),
    _dilution("hdop", "Horizontal"),
    _dilution("vdop", "Vertical"),
    _dilution("tdop", "Time"),
    Quantity(
        "gdop_p95", "1", "GDOP, 95th percentile", 3, "less",
        meaning="Not exceeded over 95 % of area and time.",
    ),
    Quantity(
        "availability", "1", "share of area and time with a good PDOP", 5, "more", "share",
        (0.0, 1.0), meaning="PDOP at most the largest that is wanted.",
    ),
    Quantity(
        "longest_gap_s", "s", "longest time below the fold wanted", 4, "less",
        meaning="At any cell.",
    ),
    Quantity(
        "mean_response_time_s", "s", "mean wait for the fold wanted", 4, "less",
        meaning="From a random moment and place until so many satellites are in view.",
    ),
)  # fmt: skip

#: All quantities, by name.
QUANTITIES: Mapping[str, Quantity] = {q.name: q for q in (*_DESIGN, *_GEOMETRY, *_COVERAGE, *_MAPS)}


def quantity(name: str) -> Quantity:
    """Return the record of a name.

    Raises
    ------
    ArgumentError
        There is none; the message has the names that are near.
    """
    if name in QUANTITIES:
        return QUANTITIES[name]
    near = get_close_matches(name, QUANTITIES, n=3)
    raise ArgumentError(
        f"quantity {name!r}: not known; "
        + (f"did you mean {', '.join(near)}?" if near else f"known: {', '.join(QUANTITIES)}")
    )
