"""Continuous coverage, and maps of counts and dilution of precision."""

from compass.quantities.record import Quantity

CONTINUOUS = (
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
        "lowest_altitude_km", "km", "lowest altitude at this mask", 6, "less",
        meaning="The same pattern, lower, keeps the fold wanted down to this altitude.",
    ),
    Quantity(
        "fold_share", "1", "share of area and time", 5, form="share",
        meaning="Part of the sphere and of the time with so many satellites in view.",
    ),
    Quantity(
        "requirement_share", "1", "share for which it is so", 6, "more", "share",
        meaning="Part of the time, or of area and time, for which a requirement is met.",
    ),
    Quantity(
        "requirement_share_most", "1", "share for which it is so, at most", 6, "more", "share",
        meaning="Proven upper bound of that share.",
    ),
    Quantity(
        "requirement_met", "1", "met", better="more", form="yes-no",
        meaning="Whether a requirement is met; no value where that is undecided.",
    ),
    Quantity(
        "requirements_met", "1", "meets all requirements", better="more", form="yes-no",
        meaning="Whether every requirement is met; no value where one is undecided.",
    ),
    Quantity(
        "requirement_margin_deg", "deg", "horizon may rise by", 4, "more",
        meaning="The whole horizon of the users may be so much higher, proven; negative: it is "
        "too high by this.",
    ),
    Quantity(
        "area_fold_met", "1", "fold always in view", better="more", form="yes-no",
        meaning="Whether that is proven at a site or in a region that a study maps; no value "
        "where it is undecided.",
    ),
    Quantity(
        "area_margin_deg", "deg", "horizon may rise by", 4, "more",
        meaning="At the site, or in the region, that has least: the fold wanted stays; negative: "
        "it is missed by this.",
    ),
    Quantity(
        "area_availability", "1", "share with a good PDOP", 5, "more", "share",
        meaning="Of the time at a site, of area and time in a region; the least of all.",
    ),
    Quantity(
        "area_gdop_p50", "1", "GDOP, median", 3, "less",
        meaning="Half of the time at a site, of area and time in a region; the greatest of all.",
    ),
    Quantity(
        "area_gdop_p95", "1", "GDOP, 95th percentile", 3, "less",
        meaning="95 % of the time at a site, of area and time in a region; the greatest of all.",
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


def _dilution(name: str, of: str) -> Quantity:
    return Quantity(
        name, "1", name.upper(), 3, "less", limits=(1.0, 30.0), ticks=(1, 2, 3, 6, 10, 20, 30),
        meaning=f"{of} dilution of precision: error of the fix for one unit of range error; "
        "infinite with fewer than four satellites in view.",
    )  # fmt: skip


MAPS = (
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
