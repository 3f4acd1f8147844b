"""Figures at sites and in regions: blocks of a document, and variables of a dataset."""

from collections.abc import Sequence
from math import degrees, inf
from typing import TYPE_CHECKING

from compass.coverage.areas import PERCENTS, AreaFigures
from compass.coverage.certified_percentile import GREATEST
from compass.document import Bracket, Sentence, Table, Value
from compass.document.blocks import Block
from compass.quantities import quantity

if TYPE_CHECKING:
    import xarray as xr


#: How well figures at sites and in regions are known.
AREAS_KNOWN = (
    "proven, or between proven bounds, of the time at a site and of area and time in a region"
)


def area_blocks(
    areas: Sequence[AreaFigures], title: str = "At sites and in regions"
) -> tuple[Block, ...]:
    """A table of the areas and what is known of them, and for when it is; nothing without any."""
    if not areas:
        return ()
    margin = quantity("requirement_margin_deg")
    errors = tuple(areas[0].errors)
    wanted, pdop_max = areas[0].fold.requirement.fold, areas[0].pdop_max
    header = (
        "",
        f"{wanted} in view always",
        margin.heading,
        f"PDOP at most {pdop_max:g}, %",
        *(f"GDOP of {percent} %" for percent in PERCENTS),
        *(f"{quantity(name).title} at most {areas[0].error_max:g} m, %" for name in errors),
    )
    rows = tuple(
        (
            area.name,
            area.fold.word,
            Value(margin, None if area.fold.margin is None else degrees(area.fold.margin)),
            _between("availability", area.availability),
            *(_between("gdop", bounds, inf) for bounds in area.gdop.values()),
            *(_between("error_share", area.errors[name]) for name in errors),
        )
        for area in areas
    )
    scopes: dict[str, list[str]] = {}
    for area in areas:
        scopes.setdefault(area.scope, []).append(area.name)
    metres = "; errors one sigma, wherever the Sun stands" if errors else ""
    return (
        Table(title, header, rows),
        Sentence(f"{AREAS_KNOWN}{metres}"),
        *(Sentence(f"{', '.join(names)}: {scope}") for scope, names in scopes.items()),
    )


def with_areas(dataset: "xr.Dataset", areas: Sequence[AreaFigures]) -> "xr.Dataset":
    """Return the dataset with the bounds of figures over (area, bound) and (area, ..., bound)."""
    if not areas:
        return dataset
    about = {"units": "1", "long_name": "proven bounds of the share with a good PDOP"}
    numbers = {
        "area_availability": (("area", "bound"), [list(a.availability) for a in areas], about),
        "area_gdop": (
            ("area", "area_percent", "bound"),
            [[list(a.gdop[q]) for q in PERCENTS] for a in areas],
            {"units": "1", "long_name": "proven bounds of GDOP not exceeded for a share"},
        ),
        "area_fold_met": (
            ("area",),
            [{True: 1, False: 0, None: -1}[a.fold.met] for a in areas],
            {"units": "1", "long_name": "fold wanted always in view: 1 proven, 0 refuted, -1 open"},
        ),
    }
    for name in areas[0].errors:
        numbers[f"area_{name}_share"] = (
            ("area", "bound"),
            [list(a.errors[name]) for a in areas],
            {"units": "1", "long_name": f"proven bounds of the share within the {name} allowed"},
        )
    coords = {
        "area": [a.name for a in areas],
        "bound": ["low", "high"],
        "area_percent": ("area_percent", list(PERCENTS), {"units": "percent"}),
    }
    return dataset.assign(numbers).assign_coords(coords)


def _between(name: str, bounds: tuple[float, float], most: float = 1.0) -> Value:
    """A figure between its bounds; not known where those are 0 and the `most` there is.

    Infinite where none is looked for beyond the lower.
    """
    if bounds[0] >= GREATEST:
        return Value(quantity(name), inf)
    known = bounds != (0.0, most)
    return Value(quantity(name), *((bounds[1], Bracket(*bounds)) if known else ("not known",)))
