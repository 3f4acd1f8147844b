"""The table ``[integrity]`` of a design: read, checked, and turned into an `Integrity`."""

from typing import Annotated, Any

from pydantic import Field

from compass.errors import ArgumentError
from compass.inputs.faults import satellites_given
from compass.inputs.table import Table
from compass.integrity import Integrity
from compass.words import counted

Probability = Annotated[float, Field(gt=0, lt=1)]


class IntegrityTable(Table):
    """What users are promised."""

    p_hmi: Probability = Field(1e-7, description="allowed: an error beyond its level, no alarm")
    p_sat: Probability = Field(1e-5, description="that a satellite is faulty, each")
    p_fa: Probability = Field(1e-5, description="allowed: a false alarm")
    horizontal_share: Probability = Field(0.5, description="horizontal part of p_hmi and p_fa")
    bias_m: float = Field(0.0, ge=0, lt=1e6, description="largest bias of a sound range, m")
    alert_horizontal_m: float = Field(50.0, gt=0, lt=1e9, description="largest useful level, m")
    alert_vertical_m: float = Field(50.0, gt=0, lt=1e9, description="largest useful level, m")


def integrity_of_table(table: IntegrityTable) -> Integrity:
    """Integrity of a design's table."""
    return Integrity(
        hazard=table.p_hmi,
        fault=table.p_sat,
        alarm=table.p_fa,
        horizontal=table.horizontal_share,
        bias=table.bias_m,
        alert_horizontal=table.alert_horizontal_m,
        alert_vertical=table.alert_vertical_m,
    )


def integrity_faults(raw: dict[str, Any]) -> list[str]:
    """Faults between fields of ``[integrity]`` and others, found on the raw tables."""
    table = raw.get("integrity")
    if not isinstance(table, dict):
        return []
    faults = []
    if "signal" not in raw:
        faults.append("integrity: needs the errors of ranges; add a table [signal]")
    count = satellites_given(raw)
    if count is not None and count < 5:
        faults.append(
            f"integrity: {counted(count, 'satellite')}; a fault is noticed with five in view "
            "or more"
        )
    try:
        integrity_of_table(IntegrityTable.model_validate(table))
    except ArgumentError as error:
        faults.append(f"integrity.{error}")
    except ValueError:
        pass  # the model says what is wrong with it
    return faults


def integrity_lines(integrity: Integrity) -> list[str]:
    """Lines of a table ``[integrity]`` that read as the same again."""
    i = integrity
    return [
        "[integrity]",
        f"p_hmi = {i.hazard!r}",
        f"p_sat = {i.fault!r}",
        f"p_fa = {i.alarm!r}",
        f"horizontal_share = {i.horizontal!r}",
        f"bias_m = {i.bias!r}",
        f"alert_horizontal_m = {i.alert_horizontal!r}",
        f"alert_vertical_m = {i.alert_vertical!r}",
    ]
