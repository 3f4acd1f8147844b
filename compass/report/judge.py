"""Report section on landing navigation: designs ranked, their bounds over the globe and as CDFs."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.colors import LogNorm
from numpy.typing import NDArray

from compass.entry.arrivals import draw_arrivals
from compass.entry.campaign import Campaign
from compass.inputs import Design
from compass.inputs.scenario import Scenario
from compass.report.mars_map import MarsMap, colour_bar
from compass.report.section import Picture, Section, Table, picture
from compass.report.style import CYCLE, FAINT, MARS, SEQUENTIAL, look, new_figure
from compass.study.judge import campaign_of, judge_entries
from compass.study.judgement import Judgement
from compass.study.ranking import rank_designs

#: Rows, equal in sine of latitude, and columns of the map's cells: of equal area.
ROWS, COLUMNS = 18, 36

#: Into how many strips a row is cut for drawing.
STRIPS = 12


def judge_section(
    designs: Sequence[Design],
    scenario: Scenario,
    *,
    samples: int = 1024,
    batches: int = 4,
    seed: int = 0,
    goal: float = 10.0,
    density_sigma: float = 0.0,
    lift_sigma: float = 0.0,
    finalists: int = 2,
    threads: int = 1,
) -> Section:
    """Rank designs for a lander, with a world map of the best two and distributions of all.

    Parameters
    ----------
    designs, scenario, samples, seed, goal, density_sigma, lift_sigma, finalists, threads
        As in `compass.study.ranking.rank_designs`.
    batches
        How many times `samples` entries the maps rest on.
    """
    options: dict[str, Any] = {"density_sigma": density_sigma, "lift_sigma": lift_sigma}
    result = rank_designs(
        designs,
        scenario,
        samples=samples,
        seed=seed,
        goal=goal,
        finalists=finalists,
        threads=threads,
        **options,
    )
    campaign = campaign_of(scenario, samples, seed, **options)
    by_file = {design.label: design for design in designs}
    ranked = [by_file[row["file"]] for row in result["designs"]]

    def judged(design: Design, on: Campaign) -> Judgement:
        return judge_entries(
            design.constellation,
            on,
            scenario,
            figure=design.figure,
            mask=design.mask,
            threads=threads,
        )

    found = [judged(design, campaign) for design in ranked]
    more: list[list[Judgement]] = [[one] for one in found[:2]]
    for k in range(1, batches):
        again = campaign.again(draw_arrivals(samples, seed + k))
        for own, design in zip(more, ranked, strict=False):
            own.append(judged(design, again))
    unknown = ", ".join(
        f"{name} unknown by {100 * sigma:g} %"
        for name, sigma in (("the air's density", density_sigma), ("L/D", lift_sigma))
        if sigma
    )
    paragraphs = (
        f'{campaign.size} entries of the lander of "{scenario.name}" to {campaign.deployment}, '
        "spread evenly over the globe, all azimuths and the repeat period. For each, the "
        "posterior Cramer-Rao bound of position and velocity there from ranges of one sigma "
        f"{scenario.measurements.range_sigma} m to every satellite in view, each weighted with the "
        f"probability that it gets through the plasma{'; ' + unknown if unknown else ''}.",
        *(f"{row['design']}: within {goal:g} m? {row['answer']}." for row in result["designs"]),
    )
    names = [design.name for design in ranked]
    pictures = [
        _map([(name, own) for name, own in zip(names, more, strict=False)], goal),
        _distributions(names, found, goal),
    ]
    return Section("Landing navigation", paragraphs, tuple(pictures), (_table(result["designs"]),))


def _table(rows: Sequence[dict]) -> Table:
    return Table(
        "Designs ranked by the 95th percentile of the position bound",
        (
            "rank", "design", "satellites", "in view, fewest", "position p50, m", "p95, m",
            "worst found, m", "velocity p95, m/s", "p95 after worst loss, m", "blind, %",
            "filter p95, m", "NEES",
        ),
        tuple(
            (
                row["rank"],
                row["design"],
                row["satellites"],
                row["in_view"]["min"],
                row["crlb_position_m"]["p50"],
                row["crlb_position_m"]["p95"],
                row["worst_found"]["value"],
                row["crlb_velocity_m_s"]["p95"],
                row["after_loss"]["crlb_position_m"]["p95"] if "after_loss" in row else "",
                100 * row["unobservable_share"],
                "" if row["ekf_position_m"] is None else row["ekf_position_m"]["p95"],
                "" if row["nees"] is None else row["nees"]["mean"],
            )
            for row in rows
        ),
    )  # fmt: skip


def largest_by_cell(judgements: Sequence[Judgement]) -> NDArray[np.float64]:
    """Largest position bound by cell of deployment, m, (ROWS, COLUMNS); nan where none landed."""
    cells = np.full((ROWS, COLUMNS), -np.inf)
    for one in judgements:
        latitude, longitude = one.campaign.deployment_place
        row = np.clip(((np.sin(latitude) + 1) / 2 * ROWS).astype(int), 0, ROWS - 1)
        column = ((longitude + np.pi) / (2 * np.pi) * COLUMNS).astype(int) % COLUMNS
        np.maximum.at(cells, (row, column), one.position_sigma)
    return np.where(np.isfinite(cells), cells, np.nan)


def _map(named: Sequence[tuple[str, Sequence[Judgement]]], goal: float) -> Picture:
    """Largest bound by place of deployment, one map a design, one colour scale."""
    fields = [largest_by_cell(judgements) for _, judgements in named]
    low = min(np.nanmin(field) for field in fields)
    high = max(np.nanmax(field) for field in fields)
    figure = new_figure(8.6, 0.6 + 4.1 * len(fields))
    edges = np.degrees(np.arcsin(np.linspace(-1, 1, ROWS + 1)))
    # each row drawn in strips, so that its cells follow the curved meridians
    latitudes = np.interp(np.arange(ROWS * STRIPS + 1) / STRIPS, np.arange(ROWS + 1), edges)
    longitudes = np.linspace(-180, 180, COLUMNS + 1)
    with look():
        axes = figure.subplots(len(fields), 1, squeeze=False)[:, 0]
        for each, (name, judgements), field in zip(axes, named, fields, strict=True):
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
            world.points(
                beyond[1, far], beyond[0, far], marker="o", ms=3.5, mfc="none", mec=MARS, mew=1.1
            )
            each.set_title(
                f"{name}: {int(far.sum())} of {sigma.size} entries beyond {goal:g} m", fontsize=10
            )
        bar = colour_bar(axes[-1], mesh, "largest position bound at deployment in the cell, m")
        bar.ax.xaxis.set_major_formatter("{x:g}")
        bar.ax.xaxis.set_minor_formatter("{x:g}")
    return picture(
        figure,
        "judge-map",
        "Position bound at deployment over the globe",
        "Largest Cramer-Rao sigma of position among the entries that deploy in each cell (all of "
        f"one area); red rings: entries beyond {goal:g} m. White: no entry deployed there.",
    )


def _distributions(names: Sequence[str], found: Sequence[Judgement], goal: float) -> Picture:
    """Cumulative distributions of the bound over the entries, whole and after the worst loss."""
    figure = new_figure(8.0, 4.6)
    with look():
        axes = figure.add_subplot()
        for k, (name, one) in enumerate(zip(names, found, strict=True)):
            colour = CYCLE[k % len(CYCLE)]
            share = 100 * np.arange(1, one.campaign.size + 1) / one.campaign.size
            axes.step(np.sort(one.position_sigma), share, color=colour, lw=1.6, label=name)
            if one.worst_loss is not None:
                after = np.sort(one.sigma[:, 1 + one.worst_loss, 0])
                axes.step(after, share, color=colour, lw=1.0, ls="--")
        axes.axvline(goal, color=FAINT, lw=1)
        axes.annotate(
            f"{goal:g} m", (goal, 2), xytext=(3, 0), textcoords="offset points", color=FAINT
        )
        axes.set(
            xscale="log",
            xlabel="Cramer-Rao sigma of position at deployment, m",
            ylabel="share of entries not beyond, %",
            ylim=(0, 101),
        )
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter("{x:g}" if axes.get_xlim()[1] < 60 else "")
        axes.tick_params(axis="x", which="both", length=4, pad=4)
        axes.grid(True)
        axes.legend(frameon=False, fontsize=8, loc="lower right")
    return picture(
        figure,
        "judge-distributions",
        "Distribution of the position bound over entries",
        "Solid: all satellites; dashed: after the loss of the one whose loss hurts most.",
    )
