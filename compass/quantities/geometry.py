"""Caps and gaps from formulas alone."""

from compass.quantities.record import Quantity

GEOMETRY = (
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
        "argument_of_periapsis_deg", "deg", "argument of periapsis", 6,
        meaning="From the ascending node to the lowest point.",
    ),
    Quantity(
        "mean_anomaly_deg", "deg", "mean anomaly", 6,
        meaning="From the lowest point, at the epoch.",
    ),
    Quantity(
        "cap_at_periapsis_deg", "deg", "cap radius at periapsis", 5,
        meaning="Horizon cap at the lowest point.",
    ),
    Quantity(
        "cap_at_apoapsis_deg", "deg", "cap radius at apoapsis", 5,
        meaning="Horizon cap at the highest point.",
    ),
)  # fmt: skip
