"""The candidates as a picture that answers the pointer, where plotly is installed."""

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from compass.document.blocks import Interactive
from compass.inputs.merit import MERITS
from compass.inputs.study import Study
from compass.pictures.style import CYCLE, FAINT, INK, MARS
from compass.study.choice import Finalist
from compass.study.results import known_figures
from compass.study.yardstick import Yardstick

if TYPE_CHECKING:
    import xarray as xr

#: At most so many candidates that are not of the first front are shown, evenly taken.
OTHERS = 2000

#: What the library measures letters with stands beside the page's landmarks: not to be read aloud.
UNREAD = 'document.getElementById("js-plotly-tester")?.setAttribute("aria-hidden", "true");'

#: At most so many whole numbers get a tick each.
MOST_TICKS = 20

#: Variables that may stand on an axis, beside the figures of merit.
_VARIABLES = {
    "phasing": "phasing F",
    "inclination_deg": "inclination, deg",
    "radius_km": "orbit radius, km",
    "mask_deg": "mask, deg",
}


def interactive_front(
    study: Study, results: "xr.Dataset", chosen: Sequence[Finalist], measure: Yardstick | None
) -> Interactive | None:
    """Feasible candidates, the first front and the finalists on any two axes; None: no plotly.

    The axes are chosen from menus; a candidate under the pointer says what it is and how good.
    """
    try:
        import plotly.graph_objects as go
        from plotly.offline import get_plotlyjs
    except ImportError:
        return None
    front = np.flatnonzero(results.front.values == 0)
    others = np.flatnonzero(results.front.values > 0)
    total = others.size
    if total > OTHERS:
        others = others[np.linspace(0, total - 1, OTHERS).astype(int)]
    axes = _axes(study, results)
    names = [*dict.fromkeys([*axes, "planes", "satellites"]), "pattern"]
    groups: list[tuple[str, dict[str, Any], dict[str, list[Any]]]] = [
        (label, marker, {name: _column(results[name].values[where]) for name in names})
        for label, where, marker in (
            ("feasible", others, {"color": FAINT, "size": 5, "opacity": 0.6}),
            ("first Pareto front", front, {"color": CYCLE[0], "size": 7}),
        )
        if where.size
    ]
    for k, one in enumerate(chosen):
        colour = CYCLE[(k + 1) % len(CYCLE)]
        groups.append((one.notation, _large("diamond", 12, colour), _columns_of(one, names)))
    if measure is not None:
        groups.append((measure.role, _large("star", 15, MARS), _columns_of(measure, names)))
    first, second = list(axes)[:2] if len(axes) > 1 else [*axes, *axes]
    figure = go.Figure(
        [
            go.Scatter(
                x=columns[first],
                y=columns[second],
                mode="markers",
                name=escape(label),  # of the design to compare with, which may say anything
                marker=marker,
                text=_hover(study, columns, list(axes)),
                hovertemplate="%{text}<extra></extra>",
            )
            for label, marker, columns in groups
        ]
    )
    figure.update_layout(
        template="simple_white",
        height=620,
        margin={"l": 70, "r": 20, "t": 90, "b": 60},
        font={"color": INK, "size": 13},
        legend={"font": {"size": 11}},
        updatemenus=[
            _menu("x", first, axes, groups, 0.0),
            _menu("y", second, axes, groups, 0.5),
        ],
    )
    for update, name in ((figure.update_xaxes, first), (figure.update_yaxes, second)):
        ticks = _tick([columns[name] for _, _, columns in groups])
        update(title_text=axes[name], showgrid=True, dtick=ticks)
    return Interactive(
        "front-interactive",
        "Candidates on any two axes",
        "The menus choose the horizontal and the vertical axis; point at a candidate to see what "
        "it is, drag to zoom, double-click to see all again, click in the legend to hide."
        + f" Of {total} candidates behind the front {OTHERS} are shown."
        * (total > OTHERS),
        figure.to_html(
            full_html=False,
            include_plotlyjs=False,
            div_id="front-interactive",
            post_script=UNREAD,
            config={
                "displaylogo": False,
                "responsive": True,
                # these and no others: there is one that would send the data away
                "modeBarButtons": [["toImage", "zoom2d", "pan2d", "resetScale2d"]],
            },
        ),
        get_plotlyjs(),
    )


def _axes(study: Study, results: "xr.Dataset") -> dict[str, str]:
    """What may stand on an axis and how it is labelled: objectives first, then all that varies."""
    good = results.front.values >= 0

    def varies(name: str) -> bool:
        values = results[name].values[good]
        return np.unique(values[np.isfinite(values)]).size > 1

    objectives = [o.figure for o in study.objectives]
    others = [name for name in known_figures(study) if name not in objectives and varies(name)]
    labels = {name: MERITS[name].heading for name in [*objectives, *others]}
    return labels | {name: label for name, label in _VARIABLES.items() if varies(name)}


def _column(values: NDArray[Any]) -> list[Any]:
    """Values of an axis with six digits, which halves the page."""
    if values.dtype == object:
        return [str(value) for value in values]
    return [float(f"{value:.6g}") if np.isfinite(value) else None for value in values]


def _columns_of(one: Finalist | Yardstick, names: Sequence[str]) -> dict[str, list[Any]]:
    values = {**one.figures, **one.variables}
    numbers = {name: _column(np.array([values[name]], float)) for name in names[:-1]}
    return numbers | {"pattern": [one.kind]}


def _large(symbol: str, size: int, colour: str) -> dict[str, Any]:
    return {"symbol": symbol, "size": size, "color": colour, "line": {"color": INK, "width": 1}}


def _hover(study: Study, columns: dict[str, list[Any]], axes: Sequence[str]) -> list[str]:
    """What each candidate says of itself: objectives first, then the rest."""
    lines = []
    for k, pattern in enumerate(columns["pattern"]):
        size, planes = columns["satellites"][k], columns["planes"][k]
        known = [
            f"{'<b>' if place < len(study.objectives) else ''}{name} {columns[name][k]:g}"
            f"{'</b>' if place < len(study.objectives) else ''}"
            for place, name in enumerate(axes)
            if columns[name][k] is not None
        ]
        lines.append("<br>".join([f"{pattern}, {size:g} satellites in {planes:g} planes", *known]))
    return lines


def _tick(columns: Sequence[list[float | None]]) -> int | None:
    """1 for a few whole numbers, which need no ticks between; None leaves the ticks alone."""
    values = [value for column in columns for value in column if value is not None]
    few = max(values, default=0.0) - min(values, default=0.0) <= MOST_TICKS
    return 1 if values and few and all(float(value).is_integer() for value in values) else None


def _menu(
    axis: str, chosen: str, axes: dict[str, str], groups: Sequence[Any], place: float
) -> dict[str, Any]:
    """Menu of what stands on an axis; the word before each entry says on which."""
    word = {"x": "→", "y": "↑"}[axis]
    return {
        "x": place,
        "xanchor": "left",
        "y": 1.14,
        "yanchor": "top",
        "active": list(axes).index(chosen),
        "font": {"size": 11},
        "buttons": [
            {
                "label": f"{word} {name}",
                "method": "update",
                "args": [
                    {axis: [columns[name] for _, _, columns in groups]},
                    {
                        f"{axis}axis.title.text": label,
                        f"{axis}axis.dtick": _tick([columns[name] for _, _, columns in groups]),
                    },
                ],
            }
            for name, label in axes.items()
        ],
    }
