"""Quantities of coverage along real orbits."""

from compass.quantities.record import Quantity

LASTING = (
    Quantity(
        "days_proven", "d", "days proven", 6, "more",
        meaning="For so many days from the start the fold is proven along the satellites' paths.",
    ),
    Quantity(
        "first_loss_days", "d", "lost on day", 7, "more",
        meaning="Days after the epoch at which the fold is first lost.",
    ),
    Quantity(
        "cap_margin_deg", "deg", "margin of the caps", 3, "more",
        meaning="By how much all caps could shrink at a moment with the fold kept.",
    ),
    Quantity(
        "room_deg", "deg", "room in the slots", 3, "more",
        meaning="By how much every satellite could still stray from its slot, at the best turn and "
        "phase of the pattern; enough, not needed.",
    ),
    Quantity(
        "distance_km", "km", "distance", 5, "more", meaning="Between two bodies' centres."
    ),
    Quantity("in_track_deg", "deg", "ahead of its slot", 3, meaning="Along the track."),
    Quantity("cross_track_deg", "deg", "beside its slot", 3, meaning="Towards the orbit's pole."),
    Quantity(
        "radial_km", "km", "above its slot", 3, meaning="Above the radius of the pattern."
    ),
    Quantity(
        "slot_sideways_deg", "deg", "along or across the track", 3, "more",
        meaning="How far one satellite may leave its slot sideways, others in theirs.",
    ),
    Quantity(
        "slot_radial_km", "km", "below the pattern's radius", 3, "more",
        meaning="How far one satellite may sink, others in their slots.",
    ),
    Quantity(
        "semi_major_axis_km", "km", "semi-major axis", 9, meaning="Osculating at the epoch."
    ),
    Quantity(
        "axis_shift_km", "km", "change of the axis", 4, meaning="Trimmed less nominal axis."
    ),
    Quantity(
        "delta_v_keeping_m_s_year", "m s-1 year-1", "delta-v to keep the slot", 3, "less",
        meaning="Impulses along the track that hold a satellite in its slot, an Earth year; of a "
        "constellation that of the satellite that needs most.",
    ),
    Quantity(
        "waiting_altitude_km", "km", "altitude of the waiting orbit", 5, meaning="Over the equator."
    ),
    Quantity(
        "wait_days", "d", "wait", 4, "less",
        meaning="Until the node of the waiting orbit has come to that of the plane.",
    ),
    Quantity(
        "delta_v_deploy_m_s", "m s-1", "delta-v of one satellite", 4, "less",
        meaning="From the orbit launched into to its place in the constellation.",
    ),
    Quantity(
        "propellant_kg", "kg", "propellant", 3, "less",
        meaning="For the time simulated, by the rocket equation.",
    ),
)  # fmt: skip
