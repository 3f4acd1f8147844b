"""Who sees whom, for how long, and what a radio link is worth."""

from compass.quantities.record import Quantity

ACCESS = (
    Quantity("station.latitude_deg", "deg", "latitude", 5, meaning="Planetocentric, north."),
    Quantity("station.longitude_deg", "deg", "longitude", 6, meaning="East."),
    Quantity("station.height_km", "km", "height", 4, meaning="Over the reference figure."),
    Quantity("station.mask_deg", "deg", "mask", 3, meaning="Lowest elevation that counts."),
    Quantity(
        "station.fewest", "1", "fewest in view", better="more", form="count",
        meaning="At any moment looked at.",
    ),
    Quantity("station.mean", "1", "in view, mean", 3, "more", meaning="Over the map's epochs."),
    Quantity("station.gdop_p95", "1", "GDOP, 95 % below", 3, "less", meaning="In time."),
    Quantity("station.pdop_p95", "1", "PDOP, 95 % below", 3, "less", meaning="In time."),
    Quantity("station.hdop_p95", "1", "HDOP, 95 % below", 3, "less", meaning="In time."),
    Quantity(
        "station.availability", "1", "time with a good PDOP", 4, "more", "share",
        meaning="PDOP at most the largest that is wanted.",
    ),
    Quantity("access.node", "1", "node", form="text", meaning="A station, a moon or the Earth."),
    Quantity(
        "access.satellites", "1", "satellites", form="count", meaning="With which it is linked."
    ),
    Quantity("access.seen", "1", "seen", form="count", meaning="Of these, ever in sight."),
    Quantity(
        "access.mean_share", "1", "share of time, mean", 4, "more", "share",
        meaning="In sight, mean over the satellites.",
    ),
    Quantity(
        "access.least_share", "1", "share of time, least", 4, "more", "share",
        meaning="In sight, of the satellite that is least.",
    ),
    Quantity("access.passes_per_sol", "1", "passes a sol, each", 3, meaning="Of one satellite."),
    Quantity("access.mean_pass_h", "h", "mean pass", 3, "more", meaning="From rise to set."),
    Quantity(
        "access.longest_gap_h", "h", "longest gap", 3, "less",
        meaning="Longest time out of sight in the span.",
    ),
    Quantity(
        "access.any_share", "1", "any satellite", 4, "more", "share",
        meaning="Share of time with one satellite or more in sight.",
    ),
    Quantity("series.gaps", "1", "gaps", better="less", form="count", meaning="How many."),
    Quantity(
        "series.cut", "1", "cut", form="count",
        meaning="Of these, cut off by the ends of the span: longer than they look.",
    ),
    Quantity(
        "series.share", "1", "with the fold", 5, "more", "share",
        meaning="Share of the time with the satellites wanted in view, by rise and set to 1 ms.",
    ),
    Quantity(
        "series.longest_gap_h", "h", "longest gap", 4, "less",
        meaning="Longest time with fewer satellites in view than wanted.",
    ),
    Quantity("series.mean_gap_h", "h", "mean gap", 4, "less", meaning="Mean length of a gap."),
    Quantity(
        "series.p95_gap_h", "h", "gap, 95 % below", 4, "less",
        meaning="The least length that 95 of 100 gaps do not exceed.",
    ),
    Quantity(
        "series.time_average_gap_h", "h", "time-average gap", 4, "less",
        meaning="Length of the gap that a random moment lies in, 0 outside gaps, on average.",
    ),
    Quantity(
        "series.response_h", "h", "mean response", 4, "less",
        meaning="Mean wait for the satellites wanted from a random moment on.",
    ),
    Quantity(
        "access.any_longest_gap_h", "h", "longest gap of any", 3, "less",
        meaning="Longest time without any satellite in sight.",
    ),
    Quantity("access.station", "1", "station", form="text", meaning="Where from."),
    Quantity(
        "access.direct_share", "1", "direct", 4, "more", "share",
        meaning="Share of time with the Earth itself in sight.",
    ),
    Quantity(
        "access.share", "1", "share of time", 4, "more", "share",
        meaning="Part of the span that is met.",
    ),
    Quantity(
        "access.share_outside_conjunction", "1", "out of conjunction", 4, "more", "share",
        meaning="The same, without the time when the Sun stands near the line to the Earth.",
    ),
    Quantity("access.at_once", "1", "at once", 4, "more", "share", meaning="Without waiting."),
    Quantity("access.mean_h", "h", "mean wait", 3, "less", meaning="Until a message arrives."),
    Quantity("access.longest_h", "h", "longest", 3, "less", meaning="The longest one."),
    Quantity(
        "access.undelivered", "1", "not within the span", 4, "less", "share",
        meaning="Share of moments from which a message does not arrive before the span ends.",
    ),
    Quantity("access.count", "1", "windows", form="count", meaning="How many."),
    Quantity("access.umbra_count", "1", "umbrae", form="count", meaning="In full shadow."),
    Quantity(
        "access.umbra_longest_h", "h", "longest umbra", 3, "less", meaning="In full shadow."
    ),
    Quantity("access.mean_duration_h", "h", "mean length", 3, "more", meaning="Of a window."),
    Quantity("access.least_range_km", "km", "least range", 4, meaning="In any window."),
    Quantity("access.largest_range_km", "km", "largest range", 4, "less", meaning="In any window."),
    Quantity(
        "access.largest_range_rate_km_s", "km/s", "largest range rate", 4, "less",
        meaning="Either way, in any window.",
    ),
    Quantity(
        "access.largest_light_time_s", "s", "largest light time", 4, "less", meaning="One way."
    ),
    Quantity(
        "access.least_cn0_dbhz", "dB Hz", "least C/N0", 4, "more",
        meaning="Carrier to noise density at the largest range, in free space.",
    ),
    Quantity("access.required_cn0_dbhz", "dB Hz", "needed", 4, meaning="As the link says."),
    Quantity(
        "access.usable_share", "1", "usable", 4, "more", "share",
        meaning="Share of the time in sight with what is needed.",
    ),
)  # fmt: skip
