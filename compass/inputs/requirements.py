"""Tables ``[[requirement]]``: what must be so, checked and turned into requirements."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from compass.coverage.region import read_regions
from compass.design import LIMITS, Requirement
from compass.errors import ArgumentError
from compass.inputs.faults import fault
from compass.inputs.models import RequirementTable
from compass.sites import Site


def requirements_of(
    tables: Sequence[RequirementTable], stations: Sequence[Site]
) -> tuple[Requirement, ...]:
    """Requirements of checked tables; those without a name are numbered."""
    known = {site.name: site for site in stations}
    return tuple(_requirement(table, k, known) for k, table in enumerate(tables, start=1))


def _requirement(table: RequirementTable, number: int, known: dict[str, Site]) -> Requirement:
    limits = ((name, getattr(table, f"{name}_at_most")) for name in LIMITS)
    return Requirement(
        name=table.name or f"requirement {number}",
        sites=tuple(known[name] for name in table.sites or ()),
        regions=_texts(table.region),
        fold=table.fold,
        mask=None if table.mask_deg is None else float(np.radians(table.mask_deg)),
        limits=tuple((name, limit) for name, limit in limits if limit is not None),
        share=table.share,
        share_of=table.share_of,
        altitude=table.altitude_km * 1e3,
        losses=table.losses,
    )


def _texts(region: str | list[str] | None) -> tuple[str, ...]:
    if region is None:
        return ()
    return (region,) if isinstance(region, str) else tuple(region)


def requirement_faults(raw: dict[str, Any]) -> list[str]:
    """Faults of ``[[requirement]]`` across fields, found on the raw tables, whatever is in them."""
    tables, stations = raw.get("requirement"), raw.get("station")
    places = [s for s in stations if isinstance(s, dict)] if isinstance(stations, list) else []
    names = [s["name"] for s in places if isinstance(s.get("name"), str)]
    faults: list[str] = []
    told: set[str] = set()
    for k, table in enumerate(tables if isinstance(tables, list) else [], start=1):
        if isinstance(table, dict):
            faults += _faults(table, f"requirement[{k}]", names)
            name = table.get("name")
            if isinstance(name, str):
                if name in told:
                    faults.append(fault(f"requirement[{k}].name", name, "used twice; rename one"))
                told.add(name)
    return faults


def _faults(table: dict[str, Any], field: str, names: list[str]) -> list[str]:
    faults = []
    sites = table.get("sites")
    for name in sites if isinstance(sites, list) else []:
        if isinstance(name, str) and name not in names:
            allowed = ", ".join(names) or "none; add a [[station]] of that name"
            faults.append(fault(f"{field}.sites", name, f"no such [[station]]; there are {allowed}"))
    region = table.get("region")
    for text in region if isinstance(region, list) else [region]:
        if isinstance(text, str):
            try:
                read_regions(text)
            except ArgumentError as error:
                faults.append(f"{field}.{error}")
    wants = [key for key in ("fold", *(f"{name}_at_most" for name in LIMITS)) if key in table]
    if not wants:
        limits = ", ".join(f"{name}_at_most" for name in LIMITS)
        faults.append(f"{field}: asks for nothing; add fold or one of {limits}")
    altitude, mask = table.get("altitude_km"), table.get("mask_deg")
    if sites is not None and altitude:
        faults.append(
            fault(f"{field}.altitude_km", altitude, "is of regions; sites have their own height_km")
        )
    if isinstance(mask, int | float) and mask < 0 and not altitude:
        faults.append(
            fault(f"{field}.mask_deg", mask, "allowed 0 up to below 90 for users on the ground")
        )
    return faults
