"""Faults between fields of a study, found on the raw tables, whatever is in them."""

from math import inf
from typing import Any

from compass.errors import meant
from compass.frames import FIGURES
from compass.inputs.design import place_faults
from compass.inputs.faults import fault, table_in, tables_in
from compass.inputs.motion import motion_faults
from compass.inputs.requirements import requirement_faults
from compass.inputs.signal import signal_faults
from compass.orbits.patterns import FARTHEST_KM
from compass.quantities.merits import MERITS, OF_ONE

#: Values that one list of a study may come to.
MOST_VALUES = 100_000

_BOUNDS = ("at_least", "at_most", "above", "below")


def study_faults(raw: dict[str, Any]) -> list[str]:
    """Faults that concern several fields at once."""
    faults = motion_faults(raw)
    space = raw.get("study")
    method = table_in(raw, "sampling").get("method", "grid")
    if isinstance(space, dict):
        figure = FIGURES.get(str(raw.get("figure", "iau-sphere")), FIGURES["iau-sphere"])
        faults += _range_faults(space, "satellites", 1, 10_000, kind=int)
        faults += _range_faults(space, "planes", 1, 10_000, kind=int)
        faults += _range_faults(space, "phasing", 0, 10_000, kind=int)
        faults += _range_faults(space, "inclination_deg", 0, 180)
        faults += _range_faults(space, "mask_deg", 0, 89.999)
        surface = figure.equatorial_radius / 1e3
        allowed = f"allowed from 1 m above the surface ({surface:g} km) to {FARTHEST_KM:g} km"
        faults += _range_faults(space, "radius_km", surface + 1e-3, FARTHEST_KM, allowed=allowed)
        if ("orbits" in space) == ("radius_km" in space):
            said = "both" if "orbits" in space else "neither"
            faults.append(f"study: needs either orbits or radius_km; found {said}")
        if method == "grid":
            faults += [
                f"study.{key}: a range without step is free; give a step, or another "
                "sampling.method (latin-hypercube, sobol, nsga2)"
                for key in ("inclination_deg", "radius_km", "mask_deg")
                if isinstance(space.get(key), dict)
                and "values" not in space[key]
                and "step" not in space[key]
            ]
    faults += _sampling_faults(table_in(raw, "sampling"), method)
    for k, table in enumerate(tables_in(raw, "constraint"), start=1):
        faults += _figure_faults(table, f"constraint[{k}]", raw)
        given = [key for key in _BOUNDS if key in table]
        if len(given) != 1:
            said = " and ".join(given) or "none"
            faults.append(
                f"constraint[{k}]: needs exactly one of {', '.join(_BOUNDS)}; found {said}"
            )
    seen: set[str] = set()
    for k, table in enumerate(tables_in(raw, "objective"), start=1):
        faults += _figure_faults(table, f"objective[{k}]", raw)
        name = table.get("figure")
        if isinstance(name, str):
            if name in seen:
                faults.append(fault(f"objective[{k}].figure", name, "is an objective already"))
            seen.add(name)
    faults += place_faults(raw) + requirement_faults(raw, "map", "entry")
    return faults + signal_faults(raw)


def _number(value: object, kind: Any = int | float) -> bool:
    """Whether a value is a number that can be compared (the model reports the others)."""
    return isinstance(value, kind) and not isinstance(value, bool) and -inf < value < inf


def _range_faults(
    space: dict[str, Any],
    key: str,
    low: float,
    high: float,
    *,
    kind: Any = int | float,
    allowed: str = "",
) -> list[str]:
    """Faults of values, or of a range, of one kind of number between two limits."""
    given, path = space.get(key), f"study.{key}"
    allowed = allowed or f"allowed {low:g} to {high:g}"
    if _number(given):
        given = [given]
    if isinstance(given, list):
        given = {"values": given}
    if not isinstance(given, dict):
        return []
    if "values" in given:
        faults = [
            f"{path}: give either values or {word}, not both"
            for word in ("least", "most", "step")
            if word in given
        ]
        values = given["values"] if isinstance(given["values"], list) else []
        return faults + [
            fault(path, v, allowed) for v in values if _number(v, kind) and not low <= v <= high
        ]
    missing = [word for word in ("least", "most") if word not in given]
    if missing:
        return [f"{path}.{word}: missing; a range needs least and most" for word in missing]
    ends = {word: given[word] for word in ("least", "most") if _number(given[word], kind)}
    outside = [word for word, end in ends.items() if not low <= end <= high]
    if outside or len(ends) < 2:
        return [fault(f"{path}.{word}", ends[word], allowed) for word in outside]
    first, last = ends["least"], ends["most"]
    step: Any = given.get("step")
    if first > last:
        return [fault(path, [first, last], "least is above most; exchange them")]
    if _number(step) and step > 0 and (last - first) / step > MOST_VALUES:
        return [fault(f"{path}.step", step, f"more than {MOST_VALUES} values; take a larger step")]
    return []


def _sampling_faults(table: dict[str, Any], method: object) -> list[str]:
    wanted = {
        "grid": (),
        "latin-hypercube": ("samples",),
        "sobol": ("samples",),
        "nsga2": ("population", "generations"),
    }.get(str(method))
    if wanted is None:
        return []
    faults = [
        f'sampling.{key}: missing; needed for method = "{method}"'
        for key in wanted
        if key not in table
    ]
    faults += [
        fault(f"sampling.{key}", table[key], f'not for method = "{method}"; leave it out')
        for key in ("samples", "population", "generations")
        if key in table and key not in wanted
    ]
    samples = table.get("samples")
    if method == "sobol" and isinstance(samples, int) and samples > 0 and samples & (samples - 1):
        power = 1 << samples.bit_length()
        faults.append(
            fault(
                "sampling.samples",
                samples,
                f"Sobol points are balanced for powers of two; use {power // 2} or {power}",
            )
        )
    return faults


#: What a study must have for figures, or those of a stage, that not every study has.
_TABLES = {
    "signal": ("signal", "without errors of ranges; add a table [signal]"),
    "entry": ("entry", "without judging entries; add a table [entry]"),
    "requirements": ("requirement", "without requirements; add a [[requirement]]"),
}


def _figure_faults(table: dict[str, Any], path: str, raw: dict[str, Any]) -> list[str]:
    name = table.get("figure")
    if not isinstance(name, str):
        return []
    if (one := OF_ONE.fullmatch(name)) is not None:
        number = len(tables_in(raw, "requirement"))
        if int(one[1]) <= number:
            return []
        problem = f"there is no [[requirement]] of that number; there are {number}"
        return [fault(f"{path}.figure", name, problem)]
    if name not in MERITS:
        guess = meant(name, MERITS)
        problem = (
            f"no candidate has this figure; {guess}allowed: {', '.join(MERITS)}; and of one "
            "requirement, K in the file, requirement_K_margin_deg, requirement_K_share and "
            "requirement_K_share_most"
        )
        return [fault(f"{path}.figure", name, problem)]
    if MERITS[name].stage == "areas" and not {"sites", "region"} & set(table_in(raw, "map")):
        problem = "no candidate has this figure without places; add sites or region to [map]"
        return [fault(f"{path}.figure", name, problem)]
    key, remedy = _TABLES.get(MERITS[name].needs or MERITS[name].stage, ("", ""))
    if key and key not in raw:
        problem = f"no candidate has this figure {remedy}"
        return [fault(f"{path}.figure", name, problem)]
    return []
