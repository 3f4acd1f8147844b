"""Tables ``[[requirement]]``: what must be so, checked and turned into requirements."""

from collections.abc import Sequence
from typing import Annotated, Any, Literal

from pydantic import Field

from compass.coverage.region import read_regions
from compass.errors import ArgumentError, meant
from compass.inputs.faults import fault, table_in, tables_in
from compass.inputs.table import Table
from compass.requirement import ERRORS, LIMITS, PROTECTIONS, ErrorAs, Requirement
from compass.sites import Site
from compass.words import listed

_NO_STATION = "none; add a [[station]] of that name"

Dilution = Annotated[float, Field(ge=1, le=1e5)]
Metres = Annotated[float, Field(gt=0, le=1e9)]
SiteNames = Annotated[list[str], Field(min_length=1, max_length=1000)]
RegionTexts = str | Annotated[list[str], Field(min_length=1, max_length=100)]


class RequirementTable(Table):
    """What must be so at sites or in regions."""

    name: str | None = Field(None, min_length=1, max_length=200, description="what to call it")
    sites: SiteNames | None = Field(
        None, description="names of [[station]] entries; a region besides is added to them"
    )
    region: RegionTexts | None = Field(
        None,
        description='"globe" (the default), "lat:MIN:MAX", "polygon:LAT,LON;LAT,LON;..." in '
        "degrees, or a list of them",
    )
    fold: int | None = Field(None, ge=1, le=1000, description="satellites to be in view at once")
    mask_deg: float | None = Field(
        None,
        gt=-90,
        lt=90,
        description="elevation mask, below 90 degrees; that of [coverage] if left out; below 0 "
        "for users above the ground",
    )
    pdop_at_most: Dilution | None = Field(None, description="largest PDOP, from 1")
    gdop_at_most: Dilution | None = Field(None, description="largest GDOP, from 1")
    hdop_at_most: Dilution | None = Field(None, description="largest HDOP, from 1")
    vdop_at_most: Dilution | None = Field(None, description="largest VDOP, from 1")
    tdop_at_most: Dilution | None = Field(None, description="largest TDOP, from 1")
    error_horizontal_m_at_most: Metres | None = Field(
        None, description="largest horizontal error of a fix, m, of designs with a [signal]"
    )
    error_vertical_m_at_most: Metres | None = Field(None, description="largest vertical error, m")
    error_position_m_at_most: Metres | None = Field(
        None, description="largest error of the place in three dimensions, m"
    )
    error_time_m_at_most: Metres | None = Field(None, description="largest error of the time, m")
    protection_horizontal_m_at_most: Metres | None = Field(
        None, description="largest horizontal protection level, m, of designs with [integrity]"
    )
    protection_vertical_m_at_most: Metres | None = Field(
        None, description="largest vertical protection level, m; sampled, by compass check alone"
    )
    error_as: ErrorAs = Field(
        "one-sigma",
        description="what errors are meant as: one-sigma, or 95-percent (1.96 sigma, below which "
        "at least 95 % of them stay)",
    )
    share: float = Field(
        1.0, gt=0, le=1, description="how much of the time, above 0 to 1; 1 means always"
    )
    share_of: Literal["time", "area-time"] = Field(
        "time", description="time (at the worst place) or area-time"
    )
    altitude_km: float = Field(
        0.0,
        ge=0,
        le=1e6,
        description="height of the users above the ground, km; who is above satellites sees those "
        "beyond the limb, from its mask_deg on",
    )
    beam_deg: float | None = Field(
        None,
        gt=0,
        lt=180,
        description="half angle of the satellites' antennas about the way down, outside of which "
        "users see nothing; all around if left out",
    )
    losses: int = Field(
        0, ge=0, le=100, description="still so after the loss of any so many satellites"
    )


def requirements_of(
    tables: Sequence[RequirementTable], stations: Sequence[Site]
) -> tuple[Requirement, ...]:
    """Requirements of checked tables; those without a name are numbered."""
    return tuple(_requirement(table, k, stations) for k, table in enumerate(tables, start=1))


def sites_named(names: Sequence[str] | None, stations: Sequence[Site]) -> tuple[Site, ...]:
    """Stations by their names, in the order in which these stand; none of no names."""
    known = {site.name: site for site in stations}
    return tuple(known[name] for name in names or ())


def _requirement(table: RequirementTable, number: int, stations: Sequence[Site]) -> Requirement:
    limits = {f"{name}_at_most": getattr(table, f"{name}_at_most") for name in LIMITS}
    return Requirement.of(
        table.name or f"requirement {number}",
        sites=sites_named(table.sites, stations),
        regions=region_texts(table.region),
        fold=table.fold,
        mask_deg=table.mask_deg,
        share=table.share,
        share_of=table.share_of,
        altitude_km=table.altitude_km,
        losses=table.losses,
        error_as=table.error_as,
        beam_deg=table.beam_deg,
        **{key: limit for key, limit in limits.items() if limit is not None},
    )


def region_texts(region: str | list[str] | None) -> tuple[str, ...]:
    """Texts of one region or several."""
    if region is None:
        return ()
    return (region,) if isinstance(region, str) else tuple(region)


def station_names(raw: dict[str, Any]) -> list[str]:
    """Names of the raw ``[[station]]`` tables that have one."""
    return [s["name"] for s in tables_in(raw, "station") if isinstance(s.get("name"), str)]


def requirement_faults(raw: dict[str, Any], *others: str) -> list[str]:
    """Faults of ``[[requirement]]`` across fields, found on the raw tables, whatever is in them.

    With those of the sites and regions of other tables, of these keys.
    """
    tables = raw.get("requirement")
    placed = {key: table_in(raw, key) for key in others}
    faults: list[str] = []
    told: set[str] = set()
    for k, table in enumerate(tables if isinstance(tables, list) else [], start=1):
        if isinstance(table, dict):
            placed[f"requirement[{k}]"] = table
            faults += _faults(table, f"requirement[{k}]")
            faults += _error_faults(table, f"requirement[{k}]", raw)
            name = table.get("name")
            if isinstance(name, str):
                if name in told:
                    faults.append(fault(f"requirement[{k}].name", name, "used twice; rename one"))
                told.add(name)
    return _site_faults(placed, station_names(raw)) + _region_faults(placed) + faults


def _error_faults(table: dict[str, Any], field: str, raw: dict[str, Any]) -> list[str]:
    wanted, levels = (
        [f"{name}_at_most" for name in names if f"{name}_at_most" in table]
        for names in (ERRORS, PROTECTIONS)
    )
    if (wanted or levels) and "signal" not in raw:
        problem = "follows from the errors of ranges; add a [signal], or ask for a dilution"
        return [fault(f"{field}.{key}", table[key], problem) for key in (*wanted, *levels)]
    if levels and "integrity" not in raw:
        problem = "follows from what users are promised; add an [integrity], in a design"
        return [fault(f"{field}.{key}", table[key], problem) for key in levels]
    if "error_as" in table and not wanted:
        return [fault(f"{field}.error_as", table["error_as"], "is of errors; add one, or leave it")]
    return []


def _site_faults(placed: dict[str, dict[str, Any]], names: list[str]) -> list[str]:
    """Sites of tables that are no stations of these names: one fault each, wherever it is named.

    And sites that a table names twice.
    """
    unknown: dict[str, list[str]] = {}
    twice: list[str] = []
    for field, table in placed.items():
        sites = table.get("sites")
        named = _texts(sites if isinstance(sites, list) else [])
        for name in dict.fromkeys(named):
            if name not in names:
                unknown.setdefault(name, []).append(field)
            elif named.count(name) > 1:
                twice.append(fault(f"{field}.sites", name, "named twice; leave one out"))
    there = f"there are {', '.join(names) or _NO_STATION}"
    return twice + [
        fault(
            f"{first}.sites",
            name,
            f"no such [[station]]; {meant(name, names)}{there}"
            + (f"; so in {listed(rest)}" if rest else ""),
        )
        for name, (first, *rest) in unknown.items()
    ]


def _region_faults(placed: dict[str, dict[str, Any]]) -> list[str]:
    faults = []
    for field, table in placed.items():
        region = table.get("region")
        named = _texts(region if isinstance(region, list) else [region])
        for text in dict.fromkeys(named):
            if named.count(text) > 1:
                faults.append(fault(f"{field}.region", text, "given twice; leave one out"))
            try:
                read_regions(text)
            except ArgumentError as error:
                faults.append(f"{field}.{error}")
    return faults


def _texts(values: list[Any]) -> list[str]:
    """Those values that are texts (the model reports the others)."""
    return [value for value in values if isinstance(value, str)]


def _faults(table: dict[str, Any], field: str) -> list[str]:
    faults, sites = [], table.get("sites")
    asked = ("fold", *(f"{name}_at_most" for name in LIMITS))
    if not any(key in table for key in asked):
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
