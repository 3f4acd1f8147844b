"""All that a store holds, as one dataset over the candidates; and the best of them."""

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import compass
from compass.document import Bracket, Interval
from compass.errors import ArgumentError
from compass.inputs.study import Study
from compass.quantities import quantity
from compass.quantities.merits import MERITS, STAGES, merits_of
from compass.study.area_figures import BETWEEN, area_columns
from compass.study.bounds import BOUNDED, bound_columns, bounded_figures, bracketed_figures, ends
from compass.study.candidates import PATTERNS, ROW, candidates, identities
from compass.study.clocks import clock_columns
from compass.study.draw_bounds import drawn_figures, side_columns
from compass.study.order import may_hold, order_of
from compass.study.record import Batch
from compass.study.requirement_figures import requirement_columns
from compass.study.sampling import sampling_of
from compass.study.stages import FINDERS
from compass.study.store import FILE, read_lines

if TYPE_CHECKING:
    import xarray as xr


#: Columns of bounds that stand in brackets beside their figure.
_ENDS = {end for figure in BETWEEN for end in ends(figure)}


def read_results(study: Study, folder: Path) -> "xr.Dataset":
    """Read what `results_of` says from a study's store.

    Raises
    ------
    ArgumentError
        There is no store, it is of another study or version, or nothing is finished in it.
    """
    path = folder / FILE
    if not path.is_file():
        raise ArgumentError(
            f"{path}: no such store; run `compass trade {study.label}` first, or say where it is"
        )
    batches: dict[str, list[Batch]] = {stage: [] for stage in FINDERS}
    for line in read_lines(path, study):
        if line.batch is not None:
            batches[line.batch.stage].append(line.batch)
    return results_of(study, batches, path)


def results_of(study: Study, batches: dict[str, list[Batch]], path: Path) -> "xr.Dataset":
    """Return every candidate that has been looked at, with every figure of merit known of it.

    Parameters
    ----------
    study
        Whose candidates they are.
    batches
        What is stored of each stage.
    path
        Where, for messages.

    Returns
    -------
    xarray.Dataset
        Over ``candidate`` (sorted): its identity, variables (``pattern`` ... ``mask_deg``),
        figures (nan where a stage was not reached), ``stage`` (the last reached), ``error``
        (its text, or empty), ``feasible`` (whether it is known to meet every constraint; of one
        on entries only those that were judged), ``front`` (of the feasible with a value for every
        objective; -1 elsewhere), ``decided`` (whether it is known for sure, not from samples, that
        it is of the first front, or that it is not). Of each requirement
        ``requirement_K_met`` (1, 0, or nan where it is open or was not asked for),
        ``_margin_deg``, ``_share`` and ``_share_most``, K its number in the file. Figures
        between proven bounds are the middle of these, which are beside them as ``FIGURE_low``
        and ``FIGURE_high``; so are the bounds of those that draws tell.

    Raises
    ------
    ArgumentError
        Nothing is finished.
    """
    import xarray as xr

    rows = np.unique(np.concatenate([np.empty(0, ROW), *(b.rows for b in batches["screen"])]))
    if not rows.size:
        raise ArgumentError(
            f"{path}: no candidate is finished yet; run `compass trade {study.label}` again"
        )
    keys = identities(rows)
    place = {key: k for k, key in enumerate(keys)}
    each = requirement_columns(study)
    clocks = clock_columns(study)
    bounds = (*bound_columns(study), *side_columns(study))
    names = (*MERITS, *bounds, *area_columns(study), *each, *clocks)
    figures = {name: np.full(rows.size, np.nan) for name in names}
    stage, error = np.zeros(rows.size, "i1"), np.full(rows.size, "", dtype=object)
    for name in FINDERS:
        for batch in batches[name]:
            # -1: the line with its screening is damaged, and not yet computed again
            where = np.array([place.get(key, -1) for key in identities(batch.rows)])
            there = where >= 0
            if name in STAGES:
                stage[where[there]] = STAGES.index(name)
            for figure, values in batch.found.figures.items():
                figures[figure][where[there]] = values[there]
            for k, text in batch.found.errors.items():
                if there[k]:
                    error[where[k]] = text
    order = order_of(study, figures, (error == "") & (stage >= STAGES.index("map")))
    waiting = still_waiting(study, figures, stage, error == "")
    if waiting:  # any of them may be ahead
        order.decided[order.front == 0] = False
    data: dict[str, Any] = {"identity": ("candidate", np.array(keys, dtype=object))}
    for column in ROW.names or ():
        values = rows[column]
        if column == "pattern":
            values = np.array([PATTERNS[code] for code in values], dtype=object)
        known = quantity(column)
        data[column] = ("candidate", values, {} if known.form == "text" else known.attributes())
    for figure, merit in MERITS.items():
        if figure not in data:
            attrs = merit.quantity.attributes()
            if how := sampling_of(study, figure):
                bounded = figure in bracketed_figures(study)
                attrs["sampled_over"] = how + ("; where there are bounds, their middle" * bounded)
            data[figure] = ("candidate", _value(study, figures, figure), attrs)
    proven = [name for name in bounded_figures(study) if name in BOUNDED]
    for figure in [*proven, *drawn_figures(study)]:
        for end, side in zip(ends(figure), ("lower", "upper"), strict=True):
            attrs = MERITS[figure].quantity.attributes()
            word, sure = ("proven ", "proven bound") if figure in proven else ("", Interval.WORDS)
            attrs |= {"long_name": f"{attrs['long_name']}, {word}{side} bound", "evidence": sure}
            data[end] = ("candidate", figures[end], attrs)
    for name, attrs in (area_columns(study) | each | clocks).items():
        data[name] = ("candidate", figures[name], attrs)
    for bracketed in {"areas", "requirements"} & set(study.stages):
        for name in merits_of(bracketed):
            data[name][2]["evidence"] = "proven, or between proven bounds"
    for name in each:
        data[name][2]["evidence"] = "proven, or of a share a proven bound"
    data |= {
        "stage": ("candidate", np.array(STAGES, dtype=object)[stage]),
        "error": ("candidate", error),
        "feasible": ("candidate", order.feasible),
        "straddling": ("candidate", order.straddling),
        "front": ("candidate", order.front),
        "decided": ("candidate", order.decided),
    }
    about: dict[str, Any] = {
        "title": study.name, "source": f"compass {compass.__version__}",
        "study_text": study.text, "study_sha256": study.digest, "waiting": waiting,
    }  # fmt: skip
    return xr.Dataset(data, attrs=about)


def still_waiting(
    study: Study,
    figures: dict[str, NDArray[np.float64]],
    stage: NDArray[np.int8],
    fine: NDArray[np.bool_],
) -> int:
    """How many candidates have not come to a stage that they would: the run was stopped.

    Parameters
    ----------
    study
        Its stages and constraints; what evolution would yet come upon is not known.
    figures, stage, fine
        What is known of candidates, the last stage of each, and whether it raised no error.
    """
    listed = study.sampling.method != "nsga2"
    waiting = len(candidates(study)) - stage.size if listed else 0
    for before, after in pairwise(study.stages):
        known = [name for name in STAGES if STAGES.index(name) <= STAGES.index(before)]
        limits = [c for name in known for c in study.constraints_of(name)]
        going = fine & (stage >= STAGES.index(before)) & may_hold(limits, figures)
        came = stage >= STAGES.index(after)
        if after == "entry" and study.entry is not None:
            most = min(int(going.sum()), study.entry.finalists)
            waiting += max(most - int(came.sum()), 0)
        else:
            waiting += int((going & ~came).sum())
    return waiting


def _value(
    study: Study, figures: dict[str, NDArray[np.float64]], figure: str
) -> NDArray[np.float64]:
    """Values of a figure, within its bounds where both are known: their middle if it is sorted by.

    What is only limited has bounds that say on which side it is, and no more.
    """
    value = figures[figure]
    if figure not in (*BOUNDED, *BETWEEN) or ends(figure)[0] not in figures:
        return value
    low, high = (figures[end] for end in ends(figure))
    within = np.where(np.isnan(low), value, np.clip(value, low, high))
    if figure in bracketed_figures(study):
        return np.where(np.isfinite(low + high), 0.5 * (low + high), within)
    return within


def known_figures(study: Study) -> list[str]:
    """Figures of the stages and tables that a study has: its objectives first."""
    wanted = [o.figure for o in study.objectives]
    others = [
        name
        for name, merit in MERITS.items()
        if name not in wanted
        and merit.stage in ("cost", *study.stages)
        and (not merit.needs or getattr(study, merit.needs) is not None)
    ]
    return wanted + others


def first_front(study: Study, results: "xr.Dataset") -> list[dict[str, Any]]:
    """Candidates of the first Pareto front as plain values, best in the first objective first.

    Each objective with its bracket, where it has one, and whether it is decided that the candidate
    is of the front.
    """
    front = results.isel(candidate=np.flatnonzero(results.front.values == 0))
    order = np.lexsort([o.sign * front[o.figure].values for o in study.objectives[::-1]])
    front = front.isel(candidate=order)
    stages = [stage for stage in ("areas", "requirements") if stage in study.stages]
    together = [name for stage in stages for name in merits_of(stage)]
    each = [name for name in area_columns(study) if name not in _ENDS]
    figures = (
        *(o.figure for o in study.objectives), *together, *each, *requirement_columns(study)
    )  # fmt: skip
    columns = {}
    for name in dict.fromkeys(["identity", *(ROW.names or ()), *figures]):
        columns[name] = front[name].values.tolist()
        beside = bounds_beside(study, front, name)
        if any(beside):
            kind = next(type(one) for one in beside if one)
            columns[name + kind.SUFFIX] = [one and [one.low, one.high] for one in beside]
    columns["decided"] = front.decided.values.tolist()
    return [{name: columns[name][k] for name in columns} for k in range(order.size)]


def bounds_beside(study: Study, some: "xr.Dataset", name: str) -> list[Bracket | Interval | None]:
    """Bounds of a figure of every candidate, proven or by draws; None where there are none."""
    if name not in (*bracketed_figures(study), *drawn_figures(study)):
        return [None] * some.sizes["candidate"]
    kind = Interval if name in drawn_figures(study) else Bracket
    low, high = (some[end].values.tolist() for end in ends(name))
    return [kind(a, b) if a <= b else None for a, b in zip(low, high, strict=True)]


def write_results(dataset: "xr.Dataset", path: Path) -> None:
    """Write the dataset as netCDF, and beside it as CSV, a candidate a line.

    A kill leaves the old files or the new ones. What is not known is an empty cell. Beside each
    figure that is sampled or bracketed the CSV, which has no attributes, says which: in netCDF
    they do.
    """
    from compass.saving import replacing, save_netcdf, write_csv

    yes_no = ("feasible", "straddling", "decided")
    made = dataset.assign({name: dataset[name].astype("i1") for name in yes_no})
    save_netcdf(path, made.assign_attrs(history=f"compass trade, version {compass.__version__}"))
    with replacing(path.with_suffix(".csv")) as temporary:
        write_csv(temporary, list(_columns(made.isel(candidate=slice(0, 0)))), _lines(made))


def _lines(made: "xr.Dataset", piece: int = 4096) -> Iterator[list[Any]]:
    """A candidate a line, none where a number is not known; few at once, for lists take memory."""
    for k in range(0, made.sizes["candidate"], piece):
        columns = _columns(made.isel(candidate=slice(k, k + piece))).values()
        yield from map(list, zip(*map(_known, columns), strict=True))


def _known(column: NDArray[Any]) -> list[Any]:
    """Values of a column, None where a number is not known."""
    unknown = np.isnan(column) if column.dtype.kind == "f" else False
    return list(np.where(unknown, np.array(None), column).tolist())


def _columns(made: "xr.Dataset") -> dict[str, NDArray[Any]]:
    """Every variable, and in words how well figures are known."""
    found = {}
    for name in map(str, made.data_vars):
        found[name] = made[name].values
        attrs = made[name].attrs
        if {"evidence", "sampled_over"} & set(attrs):
            told = np.full(found[name].size, "evidence" in attrs)
            if (end := ends(name)[0]) in made:
                told, attrs = np.isfinite(made[end].values), made[end].attrs
            sure = Interval.WORDS if attrs.get("evidence") == Interval.WORDS else "proven bounds"
            words = np.where(told, sure, "sampled")
            found[f"{name}_evidence"] = np.where(np.isnan(found[name]), "", words)
    return found
