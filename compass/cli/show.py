"""``compass show``: the analytic geometry of a design."""

from pathlib import Path
from typing import Any

import click

from compass.cli.shared import design_argument, emit_json, json_option, print_table, say


@click.command("show")
@design_argument
@json_option
def command(design: Path, as_json: bool) -> None:
    """Analytic geometry of a DESIGN: caps, gaps, totals; published against exact."""
    from importlib import import_module

    from compass.coverage.geometry import pattern_geometry
    from compass.inputs import read_design
    from compass.pages.tables import constellation_facts, geometry_facts, satellite_table

    chosen = read_design(design)
    radius = chosen.figure.equatorial_radius
    geometry = pattern_geometry(chosen.constellation, radius, chosen.mask.lowest)
    facts = constellation_facts(chosen)
    rows = []
    if chosen.paper and geometry:
        rows = import_module(f"compass.papers.{chosen.paper}").geometry_rows(geometry)
    if as_json:
        result: dict[str, Any] = {"constellation": facts}
        result |= geometry_facts(geometry) if geometry else {"cap": None, "gap": None}
        result["comparison"] = [row.as_dict() for row in rows]
        emit_json(result)
        return
    print_table(chosen.name, list(facts.items()))
    if geometry is None:
        table = satellite_table(chosen.constellation, radius)
        print_table(table.title, table.rows, table.header)
        say("\nexplicit elements: each satellite has its own cap, and planes have no gap polygons")
        return
    for group, values in geometry_facts(geometry).items():
        if values:
            print_table(group, list(_flat(values)))
    if geometry.gap is None:
        say("\n" + no_gap_reason(geometry.per_plane, geometry.closes))
    if not chosen.mask.is_constant:
        say("\nthe mask changes with azimuth: caps are those of its lowest elevation")
    if rows:
        print_table(
            f"Published ({chosen.paper}) against exact",
            [(r.where, r.item, r.published, r.computed, r.unit, r.verdict) for r in rows],
            ("where", "item", "published", "computed", "unit", "verdict"),
        )


def no_gap_reason(per_plane: int, closes: bool) -> str:
    """Say why a plane has no gap polygons."""
    if not closes:
        return (
            f"no gap polygons: the caps of {per_plane} satellites a plane do not meet, so each "
            "plane leaves one region uncovered that runs from pole to pole between them"
        )
    return f"no gap polygons: a polygon needs three satellites a plane, this has {per_plane}"


def _flat(values: dict[str, Any]) -> list[tuple[str, object]]:
    """``{"area_km2": {"exact": 1}}`` as ``[("area_km2.exact", 1)]``."""
    flat: list[tuple[str, object]] = []
    for key, value in values.items():
        if isinstance(value, dict):
            flat += [(f"{key}.{name}", inner) for name, inner in value.items()]
        else:
            flat.append((key, value))
    return flat
