"""Pictures of a trade: fronts, sensitivity to each variable, maps side by side."""

from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.coverage.grid import equal_angle_grid
from compass.coverage.maps import coverage_map
from compass.coverage.view import view
from compass.document.blocks import Picture
from compass.inputs.study import Study
from compass.orbits import repeat_period
from compass.pictures.front import draw_front, label
from compass.pictures.maps import draw_map, ranged_bar
from compass.pictures.style import CYCLE, INK, MARS, look, new_figure, picture, whole_numbers
from compass.quantities.merits import MERITS
from compass.quantities.percentile import percentile
from compass.sites import Mask
from compass.study.bounds import bracketed_figures
from compass.study.choice import Finalist
from compass.study.sampling import sampling_of
from compass.study.yardstick import Yardstick
from compass.words import capital

if TYPE_CHECKING:
    import xarray as xr

#: Variables whose influence is shown, with their axis labels.
VARIABLES = {
    "satellites": "satellites",
    "planes": "planes",
    "phasing": "phasing F",
    "inclination_deg": "inclination, deg",
    "radius_km": "orbit radius, km",
    "mask_deg": "mask, deg",
    "pattern": "pattern",
}

#: Epochs and cells, degrees, of the finalists' maps.
EPOCHS, CELL_DEG = 127, 5.0

#: A free variable is shown in so many classes.
CLASSES = 12


def front_pictures(
    study: Study, results: "xr.Dataset", chosen: Sequence[Finalist], measure: Yardstick | None
) -> tuple[Picture, ...]:
    """One picture a pair of objectives: all with values, the first front, the finalists."""
    made = []
    for a, b in combinations([o.figure for o in study.objectives], 2):
        figure = new_figure(5.6, 5.2)
        with look():
            axes = figure.add_subplot()
            draw_front(axes, results, a, b)
            drawn: list[Finalist | Yardstick] = [*chosen, *([measure] if measure else [])]
            for one in drawn:
                across, up = (_bar(one, name) for name in (a, b))
                axes.errorbar(
                    one.figures[a], one.figures[b], up, across,
                    fmt="none", ecolor=INK, elinewidth=1, capsize=3,
                )  # fmt: skip
            for k, one in enumerate(chosen):
                axes.plot(
                    one.figures[a], one.figures[b], "D", ms=8, mfc=CYCLE[(k + 1) % len(CYCLE)],
                    mec=INK, label=one.notation + (", recommended" if k == 0 else ""),
                )  # fmt: skip
            first = chosen[0].figures if chosen else {a: np.nan, b: np.nan}
            axes.plot(first[a], first[b], "o", ms=17, mfc="none", mec=MARS, mew=2)
            if measure is not None:
                axes.plot(
                    measure.figures[a],
                    measure.figures[b],
                    "*",
                    ms=14,
                    mfc=MARS,
                    mec=INK,
                    label=measure.role,
                )
            figure.legend(frameon=False, fontsize=8, loc="outside lower center", ncols=2)
        title = f"{capital(MERITS[b].title)} against {MERITS[a].title}"
        made.append(
            picture(
                figure,
                f"front-{a}-{b}".replace(".", "-").replace("_", "-"),
                title,
                f"{title}; ringed: the recommended one.",
            )
        )
    return tuple(made)


def _bar(one: Finalist | Yardstick, name: str) -> float:
    """Half the length of a bar: of what bounds leave open, or another sampling may change."""
    error = one.errors.get(name, 0.0)
    return error if np.isfinite(error) else 0.0


def _classes(results: "xr.Dataset", name: str) -> tuple[np.ndarray, list[Any]]:
    """Class of each candidate by a variable, and what each class is called."""
    values = results[name].values
    distinct, index = np.unique(values, return_inverse=True)
    if distinct.size <= 40 or distinct.dtype == object:
        return index, list(distinct)
    edges = np.linspace(values.min(), values.max(), CLASSES + 1)
    return np.clip(np.searchsorted(edges, values, "right") - 1, 0, CLASSES - 1), list(
        (edges[1:] + edges[:-1]) / 2
    )


def _varied(results: "xr.Dataset") -> list[str]:
    return [name for name in VARIABLES if np.unique(results[name].values).size > 1]


def _panels(count: int, height: float) -> tuple[Any, list[Any]]:
    columns = min(3, count)
    rows = -(-count // columns)
    figure = new_figure(3.9 * columns, height * rows)
    return figure, list(np.atleast_1d(figure.subplots(rows, columns, squeeze=False)).ravel())


def _axis(axes: Any, name: str, names: list[Any]) -> np.ndarray:
    """Where on the axis each class goes."""
    axes.set_xlabel(VARIABLES[name])
    axes.grid(True)
    if isinstance(names[0], str):
        axes.set_xticks(range(len(names)), [str(n).removeprefix("walker-") for n in names])
        axes.set_xlim(-0.6, len(names) - 0.4)
        return np.arange(len(names), dtype=float)
    if name in ("satellites", "planes", "phasing"):
        whole_numbers(axes.xaxis)
    return np.array(names, dtype=float)


def share_picture(results: "xr.Dataset") -> Picture:
    """Share of the candidates that meet every constraint, by each variable."""
    names = _varied(results)
    feasible = results.feasible.values
    with look():
        figure, panels = _panels(max(len(names), 1), 2.7)
        for axes in panels[len(names) :]:
            axes.set_axis_off()
        for axes, name in zip(panels, names, strict=False):
            index, labels = _classes(results, name)
            total = np.bincount(index, minlength=len(labels))
            share = np.bincount(index, feasible, len(labels)) / np.maximum(total, 1)
            axes.plot(_axis(axes, name, labels), 100 * share, "o-", ms=4, color=CYCLE[0])
            axes.set_ylabel("meet all, %")
            axes.set_ylim(bottom=0)
        figure.suptitle("Share of the candidates that meet every constraint", weight="bold")
    return picture(
        figure,
        "sensitivity-share",
        "Share of candidates that meet every constraint, by variable",
        "Over all candidates looked at.",
        wide=len(names) > 1,
    )


def sensitivity_pictures(study: Study, results: "xr.Dataset") -> list[Picture]:
    """Best and median of each objective against each variable, over the feasible."""
    good = results.isel(candidate=np.flatnonzero(results.front.values >= 0))
    names = _varied(good)
    made = []
    for objective in study.objectives if names else ():
        shown = [name for name in names if name != objective.figure]
        if not shown:
            continue
        with look():
            figure, panels = _panels(len(shown), 2.7)
            for axes in panels[len(shown) :]:
                axes.set_axis_off()
            for axes, name in zip(panels, shown, strict=False):
                index, labels = _classes(good, name)
                values = good[objective.figure].values
                groups = [values[index == k] for k in range(len(labels))]
                at = _axis(axes, name, labels)
                full = np.array([g.size > 0 for g in groups])
                pick = np.min if objective.sign > 0 else np.max
                axes.plot(
                    at[full],
                    [pick(g) for g in groups if g.size],
                    "o-",
                    ms=4,
                    color=MARS,
                    label="best",
                )
                axes.plot(
                    at[full],
                    [percentile(g, 50) for g in groups if g.size],
                    "s--",
                    ms=3,
                    color=CYCLE[0],
                    label="median",
                )
                if MERITS[objective.figure].quantity.form == "count":
                    whole_numbers(axes.yaxis)
                axes.set_ylabel(label(objective.figure, 30), fontsize=8)
            panels[0].legend(frameon=False, fontsize=8)
            title = MERITS[objective.figure].title
            figure.suptitle(f"{capital(title)}, by variable", weight="bold")
        made.append(
            picture(
                figure,
                f"sensitivity-{objective.figure}".replace(".", "-").replace("_", "-"),
                f"{title}, by variable",
                "Best and median of the candidates that meet every constraint and were judged in "
                f"every objective.{_how_known(study, objective.figure)}",
                wide=len(shown) > 1,
            )
        )
    return made


def _how_known(study: Study, figure: str) -> str:
    """How well the values of a picture are known, a sentence more; nothing where they are exact."""
    if figure in bracketed_figures(study):
        return " Of each candidate the middle of its proven bounds, where there are any."
    how = sampling_of(study, figure)
    return f" Sampled over {how}." if how else ""


def map_comparison(study: Study, shown: Sequence[Finalist | Yardstick]) -> Picture:
    """GDOP maps of finalists side by side, on one scale of colours."""
    grid = equal_angle_grid(float(np.radians(CELL_DEG)))
    fields = []
    for one in shown:
        c = one.constellation
        duration = repeat_period(c).duration
        mask = Mask.constant(float(np.radians(one.mask_deg)))
        # a prime number of epochs, between the moments of symmetry, meets none too often
        times = (np.arange(EPOCHS) + 0.5) * duration / EPOCHS
        seen = view(c, times, study.figure.equatorial_radius, mask)
        data = coverage_map(seen, grid, fold=study.fold)
        fields.append(data.gdop.sel(percentile=95).values)
    columns = 2 if len(shown) > 1 else 1
    rows = -(-len(shown) // columns)
    with look():
        figure = new_figure(5.2 * columns, 2.9 * rows + 0.7)
        panels = figure.subplots(rows, columns, squeeze=False).ravel()
        for axes in panels[len(shown) :]:
            axes.set_axis_off()
        for axes, one, field in zip(panels, shown, fields, strict=False):
            chart = draw_map(
                axes,
                field,
                grid,
                f"{one.notation}\n{one.role}",
                label="GDOP",
                figure_name=study.figure.name,
                named=False,
                bar=False,
            )
            axes.set_title(axes.get_title(), fontsize=8)
        ranged_bar(
            list(panels), chart.mesh, "GDOP, 95th percentile over the ground tracks' repeat period"
        )
    return picture(
        figure,
        "finalist-maps",
        "GDOP maps of the finalists",
        f"Below this GDOP 95 % of the time, all on one scale; grey: not for so long. Sampled on "
        f"{CELL_DEG:g}-degree cells at {EPOCHS} epochs in the period after which the ground tracks "
        "repeat: what lies between is not seen.",
        wide=True,
    )
