"""The candidates of a study as a picture that answers the pointer, on any two axes."""

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from compass.document import Value
from compass.document.blocks import Interactive, Picture
from compass.inputs.study import Study
from compass.pages.page import script, templates
from compass.pages.trade_finalists import doubt, known, with_unit
from compass.pictures.style import CYCLE, FAINT, MARS
from compass.quantities.merits import MERITS
from compass.study.candidates import make_constellation
from compass.study.choice import Finalist, notation, rows_in
from compass.study.results import bounds_beside, known_figures
from compass.study.sampling import front_known, sampling_of
from compass.study.yardstick import Yardstick
from compass.words import capital

if TYPE_CHECKING:
    import xarray as xr

#: At most so many candidates that are not of the first front are shown, evenly taken.
OTHERS = 2000

#: Variables that may stand on an axis, beside the figures of merit.
_VARIABLES = {
    "phasing": "phasing F",
    "inclination_deg": "inclination, deg",
    "radius_km": "orbit radius, km",
    "mask_deg": "mask, deg",
}


def interactive_front(
    study: Study,
    results: "xr.Dataset",
    chosen: Sequence[Finalist],
    measure: Yardstick | None,
    still: Picture | None,
) -> Interactive:
    """Feasible candidates, the first front and the finalists on any two axes.

    The axes are chosen from menus; a candidate under the pointer says what it is and how good.
    `still` stands for it on paper and where scripts do not run.
    """
    front = np.flatnonzero(results.front.values == 0)
    others = np.flatnonzero(results.front.values > 0)
    total = others.size
    if total > OTHERS:
        others = others[np.linspace(0, total - 1, OTHERS).astype(int)]
    axes = _axes(study, results)
    groups = [
        _group(study, results.isel(candidate=where), axes) | {"label": label, **marker}
        for label, where, marker in (
            ("feasible", others, {"colour": FAINT, "size": 3, "faint": True}),
            ("first Pareto front", front, {"colour": CYCLE[0], "size": 4}),
        )
    ]
    for k, one in enumerate(chosen):
        label = one.notation + (", recommended" if k == 0 else "")
        colour = CYCLE[(k + 1) % len(CYCLE)]
        mark = {"colour": colour, "size": 7, "shape": "diamond", "ringed": k == 0}
        groups.append(_single(study, one, one.role, axes) | {"label": label, "few": True, **mark})
    if measure is not None:
        mark = {"colour": MARS, "size": 9, "shape": "star"}
        own = _single(study, measure, measure.notation, axes)
        groups.append(own | {"label": measure.role, "few": True, **mark})
    second = min(1, len(axes) - 1)
    titles = [
        {"title": title, "label": label, "whole": _whole(name), "sampled": _sampled(study, name)}
        for name, (title, label) in axes.items()
    ]
    shown = {"axes": titles, "second": second, "groups": groups}
    # no "<" of a name can end the script that carries it
    values = json.dumps(shown, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    html = templates().get_template("front.html")
    return Interactive(
        "front-interactive",
        "Candidates on any two axes",
        f"{beside(study, results, chosen)} The menus choose the axes; point at a candidate to see "
        "what it is, drag over a part to see it larger, double-click to see all again. The "
        "buttons, and plus, minus and 0, do so about the candidate last pointed at."
        + f" Of {total} candidates behind the front {OTHERS} are shown."
        * (total > OTHERS),
        html.render(axes=titles, second=second, name=study.name, values=values),
        script("front.js"),
        still,
    )


def beside(study: Study, results: "xr.Dataset", chosen: Sequence[Finalist]) -> str:
    """What to know beside a front: which is recommended, how sure it is, what the bars are."""
    bars = any(doubt(one, name) for one in chosen for name in one.errors)
    return (
        "Ringed: the recommended one."
        + " Bars: how far another sampling may move it." * bars
        + f" {capital(front_known(study, results))}."
    )


def _axes(study: Study, results: "xr.Dataset") -> dict[str, tuple[str, str]]:
    """What may stand on an axis, its name and its label: objectives first, then all that varies."""
    good = results.front.values >= 0

    def varies(name: str) -> bool:
        values = results[name].values[good]
        return np.unique(values[np.isfinite(values)]).size > 1

    objectives = [o.figure for o in study.objectives]
    others = [name for name in known_figures(study) if name not in objectives and varies(name)]
    merits = {n: (MERITS[n].title, MERITS[n].heading) for n in [*objectives, *others]}
    known = {name: (label.split(",")[0], label) for name, label in _VARIABLES.items()}
    return merits | {name: label for name, label in known.items() if varies(name)}


def _whole(name: str) -> bool:
    """Whether an axis counts things, so that its ticks stand at whole numbers."""
    return MERITS[name].quantity.form == "count" if name in MERITS else name == "phasing"


def _sampled(study: Study, name: str) -> bool:
    """Whether a number on an axis is sampled where no bounds stand beside it."""
    return name in MERITS and bool(sampling_of(study, name))


def _group(study: Study, some: "xr.Dataset", axes: dict[str, tuple[str, str]]) -> dict[str, Any]:
    """Candidates by their notation, each one's number on every axis, and its bounds in words."""
    return {
        "names": [notation(make_constellation(row)) for row in rows_in(some)],
        "columns": [_column(some[name].values) for name in axes],
        "told": [_told(study, some, name) for name in axes],
    }


def _told(study: Study, some: "xr.Dataset", name: str) -> list[str | None] | None:
    """How a figure of candidates is written where it has bounds; None where none has."""
    bounds = bounds_beside(study, some, name)
    if not any(bounds):
        return None
    values = zip(some[name].values.tolist(), bounds, strict=True)
    known = MERITS[name].quantity
    return [with_unit(Value(known, value, own)) if own else None for value, own in values]


def _single(
    study: Study, one: Finalist | Yardstick, name: str, axes: dict[str, tuple[str, str]]
) -> dict[str, Any]:
    """One design by name: its number on every axis, how it is written, and what is in doubt."""
    values = {**one.figures, **one.variables}
    return {
        "names": [name],
        "columns": [_column(np.array([values[axis]], float)) for axis in axes],
        "doubt": [float(f"{doubt(one, axis):.3g}") for axis in axes],
        "told": [
            [with_unit(known(study, axis, one))] if axis in one.figures else None for axis in axes
        ],
    }


def _column(values: NDArray[Any]) -> list[float | None]:
    """Values of an axis with six digits, which halves the page; None for what is not finite."""
    return [float(f"{value:.6g}") if np.isfinite(value) else None for value in values]
