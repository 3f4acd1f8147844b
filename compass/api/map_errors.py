"""A map's errors in metres as blocks: how large, why there is no fix, of what, protection."""

from typing import TYPE_CHECKING, Any

import numpy as np

from compass.api.map_statistics import ROVER
from compass.coverage.errors import ERRORS
from compass.coverage.fix_budget import PARTS
from compass.coverage.protection import LEVELS
from compass.document import Bracket, Interval, Sentence, Table
from compass.document.blocks import facts
from compass.quantities import quantity
from compass.signal.budget import basis

if TYPE_CHECKING:
    from compass.api.map_result import MapResult

#: Shares of area and time that are no larger are rounding of the sums that they are made of.
ROUNDING = 5e-7


def rest_of(name: str, known: dict[str, Any]) -> dict[str, Any]:
    """One less a share, and its bounds."""
    rest = {name: 1.0 - known[name]}
    for key in (name + Bracket.SUFFIX, name + Interval.SUFFIX):
        if (ends := known.get(key)) is not None:
            rest[key] = [1.0 - ends[1], 1.0 - ends[0]]
    return rest


def error_blocks(result: "MapResult") -> tuple[Table | Sentence, ...]:
    """Errors of fixes over area and time, what they mean, and what they are made of."""
    if not result.errors:
        return ()
    return error_table(result), *error_words(result), *budget_blocks(result)


def error_table(result: "MapResult") -> Table:
    """Errors of fixes over area and time, between the bounds that draws leave."""
    percentiles = [f"p{q}" for q in result.made.dataset.global_percentile.values.tolist()]
    rows = [
        (
            quantity(name).title,
            *(result.value(quantity(name), result.errors[name], p) for p in percentiles),
            result.value(quantity("error_share"), result.errors[name], "share"),
        )
        for name in ERRORS
    ]
    header = ("", *percentiles, f"% within {result.errors['error_limit_m']:g} m")
    title = "Errors of a fix, m, one sigma: percentiles over area and time"
    return Table(title, header, tuple(rows))


def error_words(result: "MapResult") -> tuple[Sentence, ...]:
    """What a rover anywhere knows of its place, and why there is no fix where there is none."""
    errors, attrs = result.errors, result.made.dataset.attrs
    horizontal, vertical = (result.value(quantity(q), errors, q) for q in ROVER.values())
    known = "their variances" if attrs["error_weights"] == "variance" else "nothing: all alike"
    who = f"a user anywhere{result.users}" if result.users else "a rover anywhere"
    rover = (
        f"{who}: no error holds for 95 % of area and time, for in more than 5 % of "
        "it there is no fix"
    )
    if np.isfinite(errors["rover_horizontal_m"]):
        rover = (
            f"{who}: {horizontal} m horizontal, {vertical} m vertical, 95 % of its "
            "fixes for 95 % of area and time (1.96 times one sigma, at least 95 % whatever the "
            f"shape of the error ellipse), with {basis(result.design)}; it weighs ranges by "
            f"{known}; {horizontal.evidence}"
        )
    return tuple(Sentence(words) for words in (rover, *why_no_fix(result)))


def why_no_fix(result: "MapResult") -> tuple[str, ...]:
    """Where errors are infinite: in how much of area and time, and why; nothing where never."""
    errors = result.numbers()
    if 1.0 - errors["fix_share"] < ROUNDING:
        return ()
    few, masked, singular = (
        result.value(quantity("part_share"), errors, name)
        for name in ("fewer_than_four_share", "masked_share", "singular_share")
    )
    no_fix = result.value(quantity("part_share"), rest_of("fix_share", errors), "fix_share")
    lowest = float(np.min(result.made.dataset.attrs["elevation_mask_deg"]))
    mask = (
        f" ({masked} % would have four, were nothing hidden above the plain horizon: the mask "
        f"begins at {lowest:g} deg)"
        if errors["masked_share"] > 0.0
        else ""
    )
    lines = (
        f"; in {singular} % four or more, whose lines of sight tell no fix"
        if errors["singular_share"] > ROUNDING
        else ""
    )
    return (
        f"errors are infinite in {no_fix} % of area and time: in "
        f"{few} % fewer than four satellites are in view{mask}{lines}",
    )


def why_no_level(result: "MapResult") -> tuple[str, ...]:
    """As `why_no_fix`, of protection levels."""
    numbers = result.numbers()
    if 1.0 - numbers["level_share"] < ROUNDING:
        return ()
    share, reasons = quantity("part_share"), []
    for name, words in (
        ("fewer_than_five_share", "fewer than five satellites are in view"),
        ("unchecked_share", "a range is there that the others cannot check"),
        ("two_faults_share", "so many are in view that two faults use up the risk allowed"),
    ):
        if numbers[name] > ROUNDING:
            reasons.append(f"in {result.value(share, numbers, name)} % {words}")
    no_level = result.value(share, rest_of("level_share", numbers), "level_share")
    return (f"levels are infinite in {no_level} % of area and time: {'; '.join(reasons)}",)


def budget_blocks(result: "MapResult") -> tuple[Table | Sentence, ...]:
    """What ranges and fixes are made of: parts of their variance, and geometry's factor."""
    budget = result.errors.get("fix_budget")
    if budget is None:
        return ()
    made_of = (budget["range_parts"], *(budget[name]["parts"] for name in ERRORS))
    parts = [part for part in PARTS if any(one[part] for one in made_of)]
    share, factor = quantity("part_share"), quantity("geometry_factor")
    percentiles = [f"p{q}" for q in result.made.dataset.global_percentile.values.tolist()]
    header = ("", *(f"{part}, %" for part in parts), *(f"geometry, {p}" for p in percentiles))
    of_range = (result.value(share, budget["range_parts"], part) for part in parts)
    rows: list[tuple[Any, ...]] = [("a range", *of_range, *("" for _ in percentiles))]
    for name in ERRORS:
        one = budget[name]
        each = (result.value(share, one["parts"], part) for part in parts)
        times = (result.value(factor, one["geometry"], p) for p in percentiles)
        rows.append((quantity(name).title, *each, *times))
    sigma = result.value(quantity("range_error_m"), budget, "range_error_m")
    return (
        Table("What a fix is made of: parts of its variance, geometry", header, tuple(rows)),
        Sentence(
            f"half of the ranges of fixes have an error of {sigma} m or less (one sigma), and "
            "geometry makes the errors of fixes so many times that, at each percentile; parts are "
            "means over fixes, and of a range over those of each; where orbit and clock are "
            "correlated they share what they make together as their own variances stand; "
            f"{sigma.evidence}, or some of them"
        ),
    )


def protection_blocks(result: "MapResult") -> tuple[Table | Sentence, ...]:
    """Protection levels over area and time, and what they promise."""
    promise = result.design.integrity
    if "cells_protection" not in result.made.dataset or promise is None:
        return ()
    levels = result.levels
    percentiles = [f"p{q}" for q in result.made.dataset.global_percentile.values.tolist()]
    rows = tuple(
        (
            quantity(name).title,
            *(result.value(quantity(name), levels[name], p) for p in percentiles),
        )
        for name in LEVELS
    )
    header = ("", *percentiles)
    shares = [
        result.value(quantity(name), levels, name)
        for name in ("detection_share", "protection_share")
    ]
    return (
        Table("Protection levels, m: percentiles over area and time", header, rows),
        *(Sentence(words) for words in why_no_level(result)),
        facts("One faulty satellite", shares),
        *_loss_blocks(result, levels),
        Sentence(
            "solution separation: 2 Q((L - b0)/s0) + sum of P_sat Q((L - Tk - bk)/sk) = P_HMI "
            f"less what two faults use up; P_HMI {promise.hazard:g} ({promise.horizontal:g} "
            f"of it horizontal, half each east and north), P_sat {promise.fault:g} each, P_FA "
            f"{promise.alarm:g}, bias {promise.bias:g} m; two of five faulty: "
            f"{promise.unmonitored(5):.2g}; alert limits {promise.alert_horizontal:g} m "
            f"horizontal, {promise.alert_vertical:g} m vertical; sampled as the errors are"
        ),
    )


def _loss_blocks(result: "MapResult", statistics: dict[str, Any]) -> list[Table | Sentence]:
    """What is left of protection after the worst loss, if losses were looked at."""
    if (loss := statistics.get("after_loss")) is None:
        return []
    names = ("detection_share", "protection_share")
    left = [result.value(quantity(name), loss, name) for name in names]
    able, both = (result.value(quantity(name), loss, f"{name}_most") for name in names)
    few = result.design.constellation.size <= 5
    return [
        facts(f"One faulty satellite after the worst loss, of {loss['satellite']}", left),
        Sentence(
            "fewer than five satellites are left, and no fault is noticed"
            if few
            else "every satellite was left out in turn; the loss that harms least leaves "
            f"{able} % detectable and {both} % within the limits; these bounds hold for all "
            "losses at once"
        ),
    ]
