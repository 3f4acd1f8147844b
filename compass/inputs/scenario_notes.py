"""What is to be told of a scenario before it is flown: values beyond experience, values unused."""

from math import hypot, inf

from compass.inputs.scenario_faults import EXPONENTIAL
from compass.inputs.scenario_models import ScenarioFile

#: What entries at Mars have been, with a margin: Viking to Mars Science Laboratory entered at 4.4
#: to 7.3 km/s, with 62 to 140 kg/m^2 and L/D of 0 to 0.24 (Braun and Manning 2007, J. Spacecraft
#: and Rockets 44:310, Table 1); scale heights at Mars are 6 to 12 km up to 120 km.
FLOWN = {
    "entry.speed_m_s": (3500.0, 9000.0, "m/s"),
    "vehicle.ballistic_coefficient_kg_m2": (30.0, 300.0, "kg/m^2"),
    "vehicle.lift_to_drag": (-0.5, 0.5, ""),
    "atmosphere.scale_height_km": (5.0, 15.0, "km"),
}


def scenario_notes(file: ScenarioFile) -> tuple[str, ...]:
    """Return sentences on a scenario's values, one a field."""
    craft, air = file.vehicle, file.atmosphere
    coefficient = craft.ballistic_coefficient_kg_m2
    if coefficient is None:
        area = craft.drag_area_per_mass_m2_kg
        coefficient = 1.0 / area if area else inf
    velocity = file.entry.velocity_m_s
    values = {
        "entry.speed_m_s": hypot(*velocity) if velocity else file.entry.speed_m_s,
        "vehicle.ballistic_coefficient_kg_m2": coefficient,
        "vehicle.lift_to_drag": craft.lift_to_drag,
        "atmosphere.scale_height_km": None if air.table else air.scale_height_km,
    }
    notes = []
    for field, value in values.items():
        low, high, unit = FLOWN[field]
        if value is not None and not low <= value <= high:
            notes.append(
                f"{field} = {value:.4g}: beyond what entries at Mars have been "
                f"({low:g} to {high:g} {unit}".rstrip()
                + "); flown all the same"
            )
    if not air.table and all(getattr(air, name) is None for name in EXPONENTIAL):
        notes.append(
            "atmosphere: left out; flown in the mean profile of Mars-GRAM, from which the air of a "
            "day is off by some 5 % at 40 km and 20 % at 85 km"
        )
    if air.table:
        notes += [
            f"atmosphere.{name}: not used beside a table, which is flown as it is given"
            for name in EXPONENTIAL
            if getattr(air, name) is not None
        ]
    if file.guidance and file.dispersion and file.filter.kind == "relinearised-ekf":
        notes.append(
            "filter.kind: relinearised-ekf: dispersed entries are guided by an extended filter "
            "that does not look back"
        )
    if file.fusion:
        notes += [
            f"filter.{name}: of the filter of [filter] alone; those of [fusion] read "
            "accelerometers along the flight, and take all other axes as known exactly"
            for name in ("attitude", "gyros")
            if getattr(file.filter, name) is not None
        ]
    return tuple(notes)
