"""What a range is worth, and a fix made of ranges."""

from compass.quantities.record import Quantity


def _error(name: str, title: str, meaning: str) -> Quantity:
    return Quantity(
        name, "m", title, 3, "less", limits=(1.0, 100.0), ticks=(1, 2, 5, 10, 20, 50, 100),
        meaning=f"{meaning}, one sigma, of a fix by weighted least squares on all satellites in "
        "view; infinite with fewer than four.",
    )  # fmt: skip


SIGNAL = (
    Quantity(
        "standing_error_m", "m", "position error, standing still", 3, "less",
        meaning="Of the place in space, one sigma, from all ranges and Doppler gathered so far.",
    ),
    Quantity(
        "until_goal_h", "h", "time until the goal", 3, "less",
        meaning="Of standing still until the place is known as well as wanted, and stays so.",
    ),
    Quantity("elevation_deg", "deg", "elevation", 4, meaning="Of the satellite over the horizon."),
    Quantity(
        "range_error_m", "m", "range error", 3, "less",
        meaning="Of one range to one satellite, one sigma, all terms together.",
    ),
    Quantity("clock_error_m", "m", "clock", 3, "less", meaning="Of the satellite, one sigma."),
    Quantity(
        "orbit_error_m", "m", "orbit", 3, "less",
        meaning="The satellite's position error along the line of sight, one sigma.",
    ),
    Quantity("receiver_error_m", "m", "receiver", 3, "less", meaning="The user's, one sigma."),
    Quantity(
        "ionosphere_error_m", "m", "ionosphere", 3, "less",
        meaning="The delay that is not taken out, the Sun overhead; counted as one sigma.",
    ),
    Quantity(
        "radial_weight", "1", "share of a radial error", 4,
        meaning="In the range of the average user.",
    ),
    Quantity(
        "across_weight_inverse", "1", "1 over the square share of an along or cross error", 4,
        meaning="In the range of the average user.",
    ),
    Quantity(
        "radial_sigma_m", "m", "radial", 3, "less",
        meaning="Of a satellite's position, up and down, as its tracking leaves it, one sigma.",
    ),
    Quantity(
        "along_sigma_m", "m", "along", 3, "less",
        meaning="Of a satellite's position along its track, one sigma.",
    ),
    Quantity(
        "cross_sigma_m", "m", "cross", 3, "less",
        meaning="Of a satellite's position across its orbit, one sigma.",
    ),
    Quantity(
        "clock_sigma_m", "m", "clock", 3, "less",
        meaning="Of a satellite's clock as length, one sigma; none where nothing measures it.",
    ),
    Quantity(
        "tracked_share", "1", "tracked", 3, "more", "share", (0.0, 1.0),
        meaning="Share of the arc's epochs at which a kind of tracker measures a satellite.",
    ),
    Quantity(
        "part_share", "1", "share of the variance", 3, "", "share", (0.0, 1.0),
        meaning="Of ranges or of fixes, from one source of error.",
    ),
    Quantity(
        "geometry_factor", "1", "geometry", 3, "less",
        meaning="By how much where the satellites stand makes an error of a fix larger than that "
        "of its ranges.",
    ),
    _error("error_horizontal_m", "horizontal error", "Root of the east and north variances"),
    _error("error_vertical_m", "vertical error", "Of the height"),
    _error("error_position_m", "position error", "Root of the three variances"),
    _error("error_time_m", "time error", "Of the user's clock, as length"),
    Quantity(
        "rover_horizontal_m", "m", "horizontal error of a rover anywhere, 95 %", 3, "less",
        meaning="For 95 % of area and time at least 95 % of the fixes are within it: 1.96 times "
        "the 95th percentile of one sigma.",
    ),
    Quantity(
        "rover_vertical_m", "m", "vertical error of a rover anywhere, 95 %", 3, "less",
        meaning="For 95 % of area and time 95 % of the heights are within it.",
    ),
    Quantity(
        "protection_horizontal_m", "m", "horizontal protection level", 3, "less",
        limits=(1.0, 1000.0), ticks=(1, 3, 10, 30, 100, 300, 1000),
        meaning="The horizontal error exceeds it unnoticed no more often than is allowed, should "
        "one satellite be faulty; infinite where no fault can be noticed.",
    ),
    Quantity(
        "protection_vertical_m", "m", "vertical protection level", 3, "less",
        limits=(1.0, 1000.0), ticks=(1, 3, 10, 30, 100, 300, 1000),
        meaning="The same of the height.",
    ),
    Quantity(
        "detection_share", "1", "share of area and time in which a fault can be detected", 5,
        "more", "share", (0.0, 1.0),
        meaning="Five satellites in view or more, and each range checked by the others.",
    ),
    Quantity(
        "protection_share", "1", "share of area and time within the alert limits", 5, "more",
        "share", (0.0, 1.0), meaning="Both protection levels at most what the user can use.",
    ),
    Quantity(
        "error_share", "1", "share of area and time within the limit", 5, "more", "share",
        (0.0, 1.0), meaning="One sigma at most the limit asked for.",
    ),
)  # fmt: skip
