"""What a scenario file may say of guidance and of entries that differ from the planned one."""

from math import radians
from typing import Annotated, Any

from pydantic import Field

from compass.entry.guidance import Dispersion, Guidance
from compass.inputs.faults import fault
from compass.inputs.table import Table

Angle = Annotated[float, Field(ge=0, le=180)]
NotNegative = Annotated[float, Field(ge=0, le=1e6)]
Share = Annotated[float, Field(ge=0, le=1)]

#: Standard gravity, m/s^2.
G = 9.80665


class GuidanceTable(Table):
    """Guidance of the bank to a target, instead of vehicle.bank_deg."""

    target_latitude_deg: Annotated[float, Field(ge=-90, le=90)] = Field(
        description="planetocentric latitude over which deployment is to be, degrees"
    )
    target_longitude_deg: Annotated[float, Field(ge=-180, le=360)] = Field(
        description="its east longitude, degrees"
    )
    least_bank_deg: Angle = Field(20.0, description="least size of the bank, degrees")
    most_bank_deg: Angle = Field(110.0, description="largest size of the bank, degrees")
    bank_rate_deg_s: Annotated[float, Field(gt=0, le=360)] = Field(
        20.0, description="how fast the bank turns, degrees a second"
    )
    start_g: Annotated[float, Field(gt=0, le=10)] = Field(
        0.2, description="drag from which on distance is controlled, standard gravities"
    )
    first_bank_deg: Angle = Field(60.0, description="bank until then, degrees")
    reversal_deg: Annotated[float, Field(gt=0, le=90)] = Field(
        3.4, description="heading off the target at which the bank changes its side, degrees"
    )
    align_below_m_s: NotNegative = Field(
        1000.0, description="speed below which only the heading is turned to the target, m/s"
    )
    cycle_s: Annotated[float, Field(ge=0.5, le=30)] = Field(
        2.0, description="time between decisions, s"
    )


class DispersionTable(Table):
    """Entries that differ from the planned one, flown to see where they come down; one sigma."""

    entries: int = Field(200, ge=3, le=10_000, description="how many are flown, 3 to 10000")
    position_m: NotNegative = Field(0.0, description="of each axis of the first position, m")
    velocity_m_s: NotNegative = Field(0.0, description="of each axis of the first velocity, m/s")
    density: Share = Field(0.0, description="of the logarithm of the density")
    lift_to_drag: Share = Field(0.0, description="of L/D")


def guidance_of(table: GuidanceTable | None) -> Guidance | None:
    """Guidance, as given."""
    if table is None:
        return None
    return Guidance(
        radians(table.target_latitude_deg),
        radians(table.target_longitude_deg),
        radians(table.least_bank_deg),
        radians(table.most_bank_deg),
        radians(table.bank_rate_deg_s),
        table.start_g * G,
        radians(table.first_bank_deg),
        radians(table.reversal_deg),
        table.align_below_m_s,
        table.cycle_s,
    )


def dispersion_of(table: DispersionTable | None) -> Dispersion | None:
    """Dispersion, as given."""
    if table is None:
        return None
    return Dispersion(
        table.entries, table.position_m, table.velocity_m_s, table.density, table.lift_to_drag
    )


def guidance_faults(raw: dict[str, Any]) -> list[str]:
    """Guidance beside a bank that is given, or with limits that leave none."""
    table, vehicle, faults = raw.get("guidance"), raw.get("vehicle"), []
    if not isinstance(table, dict):
        return []
    if isinstance(vehicle, dict) and "bank_deg" in vehicle:
        problem = "not beside [guidance], which finds the bank; leave one of them out"
        faults.append(fault("vehicle.bank_deg", vehicle["bank_deg"], problem))
    least, most = table.get("least_bank_deg", 20.0), table.get("most_bank_deg", 110.0)
    if all(isinstance(x, int | float) for x in (least, most)) and least >= most:
        problem = f"must be above least_bank_deg = {least:g}"
        faults.append(fault("guidance.most_bank_deg", most, problem))
    return faults
