"""Quantities by which a study sorts candidates, where no other room knows them."""

from compass.quantities.record import Quantity

MERIT_QUANTITIES = (
    Quantity(
        "delta_v_transfer_m_s", "m s-1", "delta-v of the transfer from the parking orbit", 4,
        "less", meaning="Of one satellite: two burns between circles in its plane.",
    ),
    Quantity(
        "delta_v_planes_m_s", "m s-1", "delta-v from the launch plane to the farthest plane", 4,
        "less", meaning="Turning the node at the constellation's height, the shorter way.",
    ),
    Quantity(
        "delta_v_total_m_s", "m s-1", "transfer and plane change, summed over the satellites", 4,
        "less", meaning="What all satellites together need to come to their places.",
    ),
    Quantity(
        "node_drift_deg_year", "deg year-1", "drift of the nodes under J2, common to all planes",
        4, "less", meaning="Turns the whole pattern about the pole in an Earth year.",
    ),
    Quantity(
        "gdop_p50", "1", "GDOP, median over area and time", 3, "less",
        meaning="Not exceeded at half of all places and moments.",
    ),
    Quantity(
        "gdop_p95_zone", "1", "GDOP, 95th percentile in the zone of latitude where it is worst", 3,
        "less", meaning="North and south of the equator together.",
    ),
    Quantity(
        "pdop_p95", "1", "PDOP, 95th percentile over area and time", 3, "less",
        meaning="Not exceeded at 95 of 100 places and moments.",
    ),
    Quantity(
        "count_mean", "1", "satellites in view, mean over area and time", 4, "more",
        meaning="With alike caps: the share of the sphere in a cap times their number.",
    ),
    Quantity(
        "in_view.min", "1", "fewest satellites in view in an entry", better="more", form="count",
        meaning="At any moment of any entry judged.",
    ),
    Quantity(
        "in_view.median", "1", "satellites in view in an entry, median", 3, "more",
        meaning="Over the moments of all entries judged.",
    ),
    Quantity(
        "crlb_position_m.p50", "m", "position bound at the end, median", 4, "less",
        meaning="Cramer-Rao bound of the position in space, one sigma, over the entries judged.",
    ),
    Quantity(
        "crlb_position_m.p95", "m", "position bound at the end, 95th percentile of entries", 4,
        "less", meaning="Cramer-Rao bound of the position in space, one sigma.",
    ),
    Quantity(
        "crlb_velocity_m_s.p50", "m s-1", "velocity bound at the end, median", 4, "less",
        meaning="Cramer-Rao bound of the velocity, one sigma, over the entries judged.",
    ),
    Quantity(
        "crlb_velocity_m_s.p95", "m s-1", "velocity bound at the end, 95th percentile of entries",
        4, "less", meaning="Cramer-Rao bound of the velocity, one sigma.",
    ),
    Quantity(
        "share_within_goal", "1", "share of entries whose position bound is within the goal", 4,
        "more", "share", meaning="The goal is the study's own.",
    ),
    Quantity(
        "unobservable_share", "1", "share of entries whose state cannot be observed", 4, "less",
        "share", meaning="Measurements alone leave a direction of the state open.",
    ),
)  # fmt: skip
