"""How well sampled figures are known: what was sampled, and by how much another would differ.

Costs, fold and margins are exact (but for rounding and a stated bracket), requirements and days on
real orbits proven. Figures of geometry are of cells and epochs, but for those that have proven
bounds and the mean in view; how far they move when both are made finer says how far off they may
be. Figures of landings are of the entries judged, the same for all candidates; of these, and of
places and moments for errors in metres, more are drawn where the order is open.
"""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from compass.document import Interval
from compass.inputs.study import Study
from compass.quantities.draws import share_bounds
from compass.quantities.merits import MERITS, merits_of
from compass.study.bounds import bounded_figures
from compass.study.draw_bounds import drawn_figures
from compass.study.pattern_map import map_figures
from compass.words import counted

if TYPE_CHECKING:
    import xarray as xr

#: Of what is mapped the figure that is known exactly, by areas of caps.
EXACT = "count_mean"

#: Of entries the figure that is the least of those judged: others may have less.
FEWEST = "in_view.min"


def sampling_of(study: Study, figure: str) -> str:
    """Return what a figure was sampled over, in words; nothing if it was not sampled."""
    stage = MERITS[figure].stage
    if figure == EXACT:
        return ""
    more = ", more where the order is open" * (figure in drawn_figures(study))
    if stage == "map":
        grid = study.map
        cells = f"{grid.step_deg:g} deg cells, {grid.epochs} epoch{'s' * (grid.epochs > 1)}"
        if more:
            cells += ", then random places and moments"
        return cells + more
    if stage == "entry" and study.entry is not None:
        entries = study.entry.samples
        how = f"{entries} entr{'ies' if entries > 1 else 'y'}{more}"
        if figure == FEWEST:
            most = 100.0 * share_bounds(0.0, entries)[1]
            how += f", fewer in at most {most:.2g} % of all ({Interval.WORDS})"
        return how
    return ""


def rests_on_samples(study: Study) -> list[str]:
    """Figures that a study sorts by or limits, and that samples tell without bounds."""
    told = [*bounded_figures(study), *drawn_figures(study)]
    return [f for f in MERITS if f in study.named and f not in told and sampling_of(study, f)]


def front_known(study: Study, results: "xr.Dataset") -> str:
    """Return how well it is known who is on the front, in words."""
    if waiting := int(results.attrs["waiting"]):
        return (
            f"who is on the front is open: {counted(waiting, 'candidate')} not looked at so far; "
            "the same command goes on"
        )
    if sampled := rests_on_samples(study):
        titles = ", ".join(MERITS[name].title for name in sampled)
        return f"who is on the front is not proven: it rests on samples of {titles}"
    undecided = int((~results.decided.values & (results.front.values == 0)).sum())
    told = (
        f"of {undecided} it is not decided within the budget (--budget-s goes on)"
        if undecided
        else "decided"
    )
    if drawn := drawn_figures(study):
        titles = ", ".join(MERITS[name].title for name in drawn)
        told += f", by {titles} between {Interval.WORDS}, each by itself"
    if study.sampling.method == "nsga2":
        told += ", among those that evolution by samples came upon"
    return f"who is on the front: {told}"


def sampled_over(study: Study, figures: list[str]) -> str:
    """Return what those of some figures that are sampled are sampled over; nothing if none is."""
    groups: dict[str, list[str]] = {}
    for name in figures:
        if words := sampling_of(study, name) if name in MERITS else "":
            groups.setdefault(words, []).append(MERITS[name].title)
    return "; ".join(f"{'; '.join(names)}: over {how}" for how, names in groups.items())


#: Parts into which the sides of cells, and times, are cut to see how far figures move.
FINER = (2, 3)


def finer(study: Study) -> list[Study]:
    """Return the study with more and smaller cells, and more epochs.

    One epoch more than so many times: none of the one sampling is in step with the other.
    """
    grid = study.map
    return [
        replace(
            study,
            map=grid.model_copy(
                update={"step_deg": grid.step_deg / parts, "epochs": parts * grid.epochs + 1}
            ),
        )
        for parts in FINER
    ]


def map_errors(study: Study, rows: NDArray) -> dict[str, NDArray[np.float64]]:
    """By how much figures of geometry may be off for their sampling, shape (n,) each."""
    if not rows.size:
        return {name: np.empty(0) for name in merits_of("map")}
    return doubtful(map_figures(study, rows), [map_figures(one, rows) for one in finer(study)])


def doubtful(
    figures: dict[str, NDArray[np.float64]], closer: list[dict[str, NDArray[np.float64]]]
) -> dict[str, NDArray[np.float64]]:
    """Twice the farthest that figures are from those of finer samplings.

    An error that falls at least in proportion to the cells' width is at most twice what halving
    them changes; the tails of a dilution are rougher, so a second look is taken, and the estimate
    stays one: of 24 patterns of 15 satellites on 15 degree cells and 4 epochs it covers 9 in 10, of
    the worst zones, whose tails are the roughest, half.
    Zero where both are infinite, infinite where one is.
    """
    found = {}
    for name, values in figures.items():
        with np.errstate(invalid="ignore"):
            moved = [
                np.where(values == other[name], 0.0, np.abs(values - other[name]))
                for other in closer
            ]
        found[name] = 2.0 * np.max(moved, axis=0)
    return found
