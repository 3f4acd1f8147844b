"""Bounds of landing navigation over the globe, and as distributions."""

from collections.abc import Sequence
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.ticker import LogLocator
from numpy.typing import NDArray

from compass.document import Picture
from compass.pictures.mars_map import MarsMap, colour_bar
from compass.pictures.style import CYCLE, FAINT, INK, MARS, SEQUENTIAL, look, new_figure, picture
from compass.study.judgement import Judgement

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Rows, equal in sine of latitude, and columns of the map's cells: of equal area.
ROWS, COLUMNS = 18, 36

#: Into how many strips a row is cut for drawing.
STRIPS = 12


def largest_by_cell(judgements: Sequence[Judgement]) -> NDArray[np.float64]:
    """Largest position bound by cell of deployment, m, (ROWS, COLUMNS); nan where none landed."""
    cells = np.full((ROWS, COLUMNS), -np.inf)
    for one in judgements:
        latitude, longitude = one.campaign.deployment_place
        row = np.clip(((np.sin(latitude) + 1) / 2 * ROWS).astype(int), 0, ROWS - 1)
        column = ((longitude + np.pi) / (2 * np.pi) * COLUMNS).astype(int) % COLUMNS
        np.maximum.at(cells, (row, column), one.position_sigma)
    return np.where(np.isfinite(cells), cells, np.nan)


#: A share of entries up to which each of them is ringed.
FEW = 0.05


def bound_map(named: Sequence[tuple[str, Sequence[Judgement]]], goal: float) -> Picture:
    """Largest bound by place of deployment, maps in two columns on one colour scale."""
    fields = [largest_by_cell(judgements) for _, judgements in named]
    low = min(np.nanmin(field) for field in fields)
    high = max(np.nanmax(field) for field in fields)
    columns = min(2, len(fields))
    rows = -(-len(fields) // columns)
    figure = new_figure(5.2 * columns, 0.7 + 3.0 * rows)
    edges = np.degrees(np.arcsin(np.linspace(-1, 1, ROWS + 1)))
    # each row drawn in strips, so that its cells follow the curved meridians
    latitudes = np.interp(np.arange(ROWS * STRIPS + 1) / STRIPS, np.arange(ROWS + 1), edges)
    longitudes = np.linspace(-180, 180, COLUMNS + 1)
    with look():
        axes = figure.subplots(rows, columns, squeeze=False).ravel()
        for each in axes[len(fields) :]:
            each.set_axis_off()
        for each, (name, judgements), field in zip(axes, named, fields, strict=False):
            world = MarsMap(each)
            # matplotlib's log scale needs room between its ends
            mesh = world.field(
                longitudes,
                latitudes,
                np.repeat(field, STRIPS, axis=0),
                cmap=SEQUENTIAL,
                norm=LogNorm(low, max(high, 1.01 * low)),
            )
            world.graticule()
            sigma = np.concatenate([one.position_sigma for one in judgements])
            beyond = np.concatenate(
                [np.degrees(one.campaign.deployment_place) for one in judgements], axis=1
            )
            far = sigma > goal
            if far.mean() < FEW:  # more would hide the map
                world.points(*beyond[::-1, far], marker="o", ms=3.5, mfc="none", mec=MARS, mew=1.1)
            # of those that were ranked, as everywhere else: further ones fill the map alone
            ranked = 100 * (judgements[0].position_sigma > goal).mean()
            share = f"{ranked:.3g} % of entries beyond {goal:g} m"
            each.set_title(f"{fill(name, 46)}\n{share}", fontsize=9)
        bar = colour_bar(list(axes), mesh, "largest position bound at deployment in the cell, m")
        per = (1, 1.5, 2, 3, 4, 5, 6, 8) if high < 8 * low else (1, 2, 5)
        round_ones = LogLocator(subs=per, numticks=100).tick_values(low, high)
        ticks = [float(tick) for tick in round_ones if low <= tick <= high]
        if len(ticks) > 1:
            bar.set_ticks(ticks, labels=[f"{t:g}" for t in ticks])
            bar.ax.minorticks_off()
    first = named[0][1]
    drawn, ranked = sum(one.campaign.size for one in first), first[0].campaign.size
    more = f" Drawn of {drawn:,} entries, the {ranked:,} that are ranked among them."
    further = more if drawn > ranked else ""
    return picture(
        figure,
        "judge-map",
        "Position bound at deployment over the globe",
        "Largest Cramer-Rao sigma of position among the entries that deploy in each cell (all of "
        f"one area); red rings, where they are few: entries beyond {goal:g} m. White: no entry "
        f"deployed there.{further}",
        wide=True,
    )


def bound_distributions(names: Sequence[str], found: Sequence[Judgement], goal: float) -> Picture:
    """Cumulative distributions of the bound over the entries, whole and after the worst loss."""
    figure = new_figure(5.8, 4.0)
    with look():
        draw_distributions(figure.add_subplot(), names, found, goal)
    return picture(
        figure,
        "judge-distributions",
        "Distribution of the position bound over entries",
        "Solid: all satellites; dashed: after the loss of the one whose loss hurts most.",
    )


def draw_distributions(
    axes: "Axes", names: Sequence[str], found: Sequence[Judgement], goal: float
) -> None:
    """Draw into axes which share of entries is within which bound."""
    for k, (name, one) in enumerate(zip(names, found, strict=True)):
        colour = CYCLE[k % len(CYCLE)]
        share = 100 * np.arange(1, one.campaign.size + 1) / one.campaign.size
        axes.step(np.sort(one.position_sigma), share, color=colour, lw=1.6, label=name)
        if one.worst_loss is not None:
            after = np.sort(one.sigma[:, 1 + one.worst_loss, 0])
            axes.step(after, share, color=colour, lw=1.0, ls="--")
    axes.axvline(goal, color=FAINT, lw=1)
    axes.annotate(
        f"{goal:g} m", (goal, 101), xytext=(0, 2), textcoords="offset points", color=INK,
        ha="center", va="bottom",
    )  # fmt: skip
    axes.set(
        xscale="log",
        xlabel="Cramer-Rao sigma of position at deployment, m",
        ylabel="share of entries within, %",
        ylim=(0, 101),
    )
    if axes.get_xlim()[1] >= 60:
        axes.xaxis.set_minor_locator(LogLocator(subs=(2, 5)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter("{x:g}")
    axes.tick_params(axis="x", which="both", length=4, pad=4)
    axes.grid(True)
    axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.16))
