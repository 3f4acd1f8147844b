"""How candidates do at the sites and in the regions of a study, as `map` tells it of a design.

Of all together figures of merit, the worst of each; of each by itself columns ``area_K_...``, K
its place among the sites and then the regions of ``[map]``. Shares and percentiles lie between
proven bounds; a figure is the middle of its own.
"""

from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.coverage.areas import Area, Bounds, Near, areas_of
from compass.coverage.verdict import Verdict
from compass.design import Design
from compass.frames import SECONDS_PER_DAY
from compass.inputs.study import Study
from compass.orbits import Constellation
from compass.quantities import Quantity, quantity
from compass.quantities.merits import WORST, merits_of
from compass.requirement import Requirement
from compass.sites import Mask
from compass.study.columns import Shown, each_placed, placed

#: Figures between bounds, and per cent of area and time of those that are percentiles of GDOP.
BETWEEN: dict[str, int | None] = {
    "area_availability": None,
    "area_gdop_p50": 50,
    "area_gdop_p95": 95,
}

#: Parts of an area's figures that are kept, and the quantities that they are of.
PARTS = {"met": "area_fold_met", "margin_deg": "area_margin_deg"} | {
    f"{name.removeprefix('area_')}_{end}": name for name in BETWEEN for end in ("low", "high")
}


_ENDS = {"low": ", proven lower bound", "high": ", proven upper bound"}


def area_names(study: Study) -> tuple[str, ...]:
    """Names of the areas of a study, in the order of their columns."""
    return (*(site.name for site in study.sites), *study.regions)


def area_columns(study: Study) -> dict[str, dict[str, Any]]:
    """Columns of the bounds of all areas together and of each by itself, with their attributes."""
    names = area_names(study)
    columns: dict[str, dict[str, Any]] = {}
    for name in BETWEEN if names else ():
        for end, said in _ENDS.items():
            columns[f"{name}_{end}"] = _attributes(quantity(name), said)
    for number, name in enumerate(names, start=1):
        for part, of in PARTS.items():
            told = _attributes(_of_one(of), _ENDS.get(part.rpartition("_")[2], ""))
            column = f"area_{number}_{part}"
            columns[column] = told | {"long_name": f"{name}: {told['long_name']}"}
    return columns


def _of_one(name: str) -> Quantity:
    """The quantity of one area that a figure of all is the worst of."""
    known = quantity(name)
    return replace(known, title=known.title.removesuffix(WORST))


def _attributes(known: Quantity, end: str) -> dict[str, Any]:
    found = known.attributes()
    return found | {"long_name": found["long_name"] + end, "evidence": "proven bound"}


def area_figures(study: Study, rows: NDArray, near: Near) -> dict[str, NDArray[np.float64]]:
    """Figures of candidates at a study's sites and in its regions, shape (n,) each."""
    find = partial(of_areas, study, near=near)
    return each_placed(study, "areas", area_columns(study), rows, find)


def area_bounds(study: Study, row: np.void, names: list[str], near: Near) -> dict[str, Bounds]:
    """Bounds of some of the figures between bounds, of one candidate."""
    each = [_bounds(study, area, names) for area in _areas(study, *placed(study, row), near)]
    return {name: _worst(name, [of[name] for of in each]) for name in names}


def of_areas(study: Study, c: Constellation, mask: float, near: Near) -> dict[str, float]:
    """Figures of a constellation above a mask, radians, with what is kept of each area.

    Where the study demands the fold and it is refuted, geometry is not looked at.
    """
    areas = _areas(study, c, mask, near)
    verdicts = [area.fold() for area in areas]
    found = dict.fromkeys((*merits_of("areas"), *area_columns(study)), np.nan)
    outcomes = {verdict.met for verdict in verdicts}
    found["area_fold_met"] = _met(next(m for m in (False, None, True) if m in outcomes))
    margins = [v.margin for v in verdicts if v.margin is not None]
    if len(margins) == len(verdicts):
        found["area_margin_deg"] = float(np.degrees(min(margins)))
    for number, verdict in enumerate(verdicts, start=1):
        found |= {f"area_{number}_{part}": value for part, value in _fold_parts(verdict).items()}
    if demands_fold(study) and False in outcomes:
        return found
    each = [_bounds(study, area, BETWEEN) for area in areas]
    for name in BETWEEN:
        low, high = _worst(name, [of[name] for of in each])
        found |= {name: 0.5 * (low + high), f"{name}_low": low, f"{name}_high": high}
        part = name.removeprefix("area_")
        for number, of in enumerate(each, start=1):
            low, high = of[name]
            found |= {f"area_{number}_{part}_low": low, f"area_{number}_{part}_high": high}
    return found


def demands_fold(study: Study) -> bool:
    """Whether the study takes no candidate without its fold at all sites and in all regions."""
    return any(c.figure == "area_fold_met" and c.low > 0 for c in study.constraints)


def demanded_folds(study: Study) -> tuple[Requirement, ...]:
    """What a study demands of its areas, as requirements that a design file can carry."""
    if not demands_fold(study):
        return ()
    sites = [Requirement(f"fold at {s.name}", sites=(s,), fold=study.fold) for s in study.sites]
    return (
        *sites,
        *(Requirement(f"fold in {r}", regions=(r,), fold=study.fold) for r in study.regions),
    )


def shown_areas(study: Study) -> list[Shown]:
    """What is shown of each site and region: the margin of its fold, and what lies in bounds."""
    asked: list[Shown] = []
    for number, area in enumerate(area_names(study), start=1):
        for name in ("area_margin_deg", *BETWEEN):
            column = f"area_{number}_{name.removeprefix('area_')}"
            columns = (f"{column}_low", f"{column}_high") if name in BETWEEN else (column,)
            asked.append((f"{area}: {_of_one(name).heading}", quantity(name), columns))
    return asked


def _areas(study: Study, c: Constellation, mask: float, near: Near) -> tuple[Area, ...]:
    return areas_of(
        Design(c, figure=study.figure, mask=Mask.constant(mask)),
        sites=study.sites,
        regions=study.regions,
        fold=study.fold,
        span=(0.0, SECONDS_PER_DAY),  # of orbits of several periods, which patterns have not
        near=near,
    )


def _bounds(study: Study, area: Area, names: Iterable[str]) -> dict[str, Bounds]:
    """Bounds of some figures of one area, percentiles from one search."""
    percents = {name: percent for name in names if (percent := BETWEEN[name]) is not None}
    gdop = area.gdop(list(percents.values())) if percents else {}
    return {
        name: gdop[percents[name]] if name in percents else area.share("pdop", study.map.pdop_max)
        for name in names
    }


def _worst(name: str, each: list[Bounds]) -> Bounds:
    """Bounds of the least share, or of the greatest dilution, of all areas."""
    pick = min if quantity(name).better == "more" else max
    return pick(low for low, _ in each), pick(high for _, high in each)


def _fold_parts(verdict: Verdict) -> dict[str, float]:
    margin = np.nan if verdict.margin is None else float(np.degrees(verdict.margin))
    return {"met": _met(verdict.met), "margin_deg": margin}


def _met(outcome: bool | None) -> float:
    return np.nan if outcome is None else float(outcome)
