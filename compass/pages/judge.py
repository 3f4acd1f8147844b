"""Landing navigation in pictures: designs ranked, their bounds over the globe and as CDFs."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.colors import LogNorm
from numpy.typing import NDArray

from compass.design import Design
from compass.document.blocks import Picture, Section, Table, arranged
from compass.entry.arrivals import draw_arrivals
from compass.entry.campaign import Campaign
from compass.inputs.scenario import Scenario, provenance
from compass.pages.page import render
from compass.pictures.mars_map import MarsMap, colour_bar
from compass.pictures.style import CYCLE, FAINT, MARS, SEQUENTIAL, look, new_figure, picture
from compass.study.judge import campaign_of, judge_entries
from compass.study.judgement import Judgement

#: Rows, equal in sine of latitude, and columns of the map's cells: of equal area.
ROWS, COLUMNS = 18, 36

#: Into how many strips a row is cut for drawing.
STRIPS = 12


#: How many of the best are mapped, and on how many times the ranking's entries.
MAPPED, BATCHES = 4, 4


def judge_report(
    ranking: dict[str, Any],
    designs: Sequence[Design],
    scenario: Scenario,
    command: str = "",
    *,
    threads: int = 1,
    progress: Callable[[str], None] = lambda step: None,
) -> tuple[str, list[Section]]:
    """Make the page (HTML text) and the sections of a ranking's report.

    Parameters
    ----------
    ranking, designs, scenario, threads, progress
        As in `judge_section`.
    command
        The command line, for provenance.
    """
    sections = [
        judge_section(ranking, designs, scenario, threads=threads, progress=progress),
        surface_section(ranking),
    ]
    made = provenance(scenario, command)
    page = render(
        f"Constellations judged: {scenario.name}",
        made["references"] or "No source given.",
        sections,
        [
            ("command", command or "made from Python"),
            ("made", made["history"].split(" ")[0]),
            ("version", made["source"]),
            ("scenario file", made["scenario_file"]),
            ("SHA-256 of the scenario", made["scenario_sha256"]),
            *((f"SHA-256 of {design.label}", design.digest) for design in designs),
        ],
        scenario.text,
    )
    return page, sections


def judge_section(
    ranking: dict[str, Any],
    designs: Sequence[Design],
    scenario: Scenario,
    *,
    threads: int = 1,
    progress: Callable[[str], None] = lambda step: None,
) -> Section:
    """Show designs ranked for a lander: world maps of the best, distributions of all.

    Parameters
    ----------
    ranking
        Of `compass.study.ranking.rank_designs`, of these designs for this scenario.
    designs, scenario
        Who was ranked, for which lander.
    threads
        Threads; the pictures do not depend on them.
    progress
        Told the name of each part before it is made.
    """
    samples, seed, goal = ranking["drawn"], ranking["seed"], ranking["goal_m"]
    density_sigma, lift_sigma = ranking["density_sigma"], ranking["lift_sigma"]
    campaign = campaign_of(
        scenario, samples, seed, density_sigma=density_sigma, lift_sigma=lift_sigma
    )
    ranked = [designs[row["given"] - 1] for row in ranking["designs"]]

    def judged(design: Design, on: Campaign) -> Judgement:
        return judge_entries(
            design.constellation,
            on,
            scenario,
            figure=design.figure,
            mask=design.mask,
            threads=threads,
        )

    progress("bounds over the globe")
    found = [judged(design, campaign) for design in ranked]
    more: list[list[Judgement]] = [[one] for one in found[:MAPPED]]
    for k in range(1, BATCHES):
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
        f"posterior Cramer-Rao bound of position and velocity there from {_measured(scenario)} to "
        "every satellite in view, each weighted with the probability that it gets through the "
        f"plasma{'; ' + unknown if unknown else ''}.",
        *(f"{row['design']}: within {goal:g} m? {row['answer']}." for row in ranking["designs"]),
    )
    names = [design.name for design in ranked]
    pictures = (
        _map([(name, own) for name, own in zip(names, more, strict=False)], goal),
        _distributions(names, found, goal),
    )
    tables = [_table(ranking["designs"])]
    run = [row for row in ranking["designs"] if row["nees"] is not None]
    if run:
        tables.append(_filter_table(run))
    return arranged("Landing navigation", paragraphs, pictures, tuple(tables))


def _measured(scenario: Scenario) -> str:
    """Say what is measured, and how well."""
    m = scenario.measurements
    kinds = (("ranges", m.range_sigma, "m"), ("range rates", m.rate_sigma, "m/s"))
    return " and ".join(
        f"{name} of one sigma {sigma:g} {unit}" for name, sigma, unit in kinds if sigma is not None
    )


def surface_section(ranking: dict[str, Any]) -> Section:
    """Show what the ranked designs are worth to users on the surface."""
    rows = tuple(
        (
            row["design"],
            f"{row['surface']['fold']['wanted']}-fold {row['surface']['fold']['outcome']}",
            "no mask has it"
            if row["surface"]["mask_margin_deg"] is None
            else row["surface"]["mask_margin_deg"],
            *(
                estimate(row["surface"]["gdop"][key], row["surface"]["gdop_error"][key])
                for key in ("p50", "p95")
            ),
            estimate(100 * row["surface"]["gdop_share"], 100 * row["surface"]["gdop_share_error"]),
        )
        for row in ranking["designs"]
    )
    header = (
        "design", "continuous coverage", "highest mask, deg", "GDOP p50", "p95", "GDOP <= 6, %"
    )  # fmt: skip
    text = (
        "Coverage at the design's mask is proven or refuted for all time; the highest mask is the "
        "one up to which that fold holds. GDOP is sampled over area and time, and given with its "
        "standard error."
    )
    return arranged("Users on the surface", (text,), (), (Table("Side by side", header, rows),))


def _table(rows: Sequence[dict[str, Any]]) -> Table:
    return Table(
        "Designs ranked by the 95th percentile of the position bound",
        (
            "rank", "design", "satellites", "in view, fewest", "position p50, m", "p95, m",
            "worst found, m", "velocity p95, m/s", "p95 after worst loss, m", "worst found, m",
            "blind, %",
        ),
        tuple(
            (
                row["rank"],
                row["design"],
                row["satellites"],
                row["in_view"]["min"],
                _digits(row["crlb_position_m"]["p50"]),
                _digits(row["crlb_position_m"]["p95"]),
                _digits(row["worst_found"]["value"]),
                _digits(row["crlb_velocity_m_s"]["p95"]),
                *_loss_columns(row),
                _digits(100 * row["unobservable_share"]),
            )
            for row in rows
        ),
    )  # fmt: skip


def _loss_columns(row: dict[str, Any]) -> tuple[object, object]:
    """95th percentile and worst found after the worst loss; nothing where there is nobody."""
    if "after_loss" not in row:
        return "", ""
    lost = row["after_loss"]
    return _digits(lost["crlb_position_m"]["p95"]), _digits(lost["worst_found"]["value"])


def _filter_table(rows: Sequence[dict[str, Any]]) -> Table:
    return Table(
        "The filter itself: its errors at deployment, and whether they are as large as it says",
        (
            "design", "runs", "diverged", "error p50, m", "p95, m", "rms over the bound's", "NEES",
            "95 % of consistent filters between", "consistent",
        ),
        tuple(
            (
                row["design"],
                row["runs"],
                row["diverged"],
                _digits(row["ekf_position_m"]["p50"]),
                _digits(row["ekf_position_m"]["p95"]),
                _digits(row["rms_over_bound"]),
                _digits(row["nees"]),
                "{low:.2f} and {high:.2f}".format(**row["nees_interval"]),
                "yes" if row["consistent"] else "no",
            )
            for row in rows
        ),
    )  # fmt: skip


def estimate(value: float, error: float) -> str:
    """A sampled value and its standard error, to two digits of the error."""
    if not (np.isfinite(value) and 0 < error < np.inf):
        return f"{value:.4g}"
    digits = max(0, 1 - int(np.floor(np.log10(error))))
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def _digits(value: float) -> float:
    """Four digits: more would be noise of the entries drawn."""
    return float(f"{value:.4g}")


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
    """Largest bound by place of deployment, maps in two columns on one colour scale."""
    fields = [largest_by_cell(judgements) for _, judgements in named]
    low = min(np.nanmin(field) for field in fields)
    high = max(np.nanmax(field) for field in fields)
    columns = min(2, len(fields))
    rows = -(-len(fields) // columns)
    figure = new_figure(7.4 * columns, 0.7 + 3.7 * rows)
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
            world.points(
                beyond[1, far], beyond[0, far], marker="o", ms=3.5, mfc="none", mec=MARS, mew=1.1
            )
            each.set_title(
                f"{name}: {int(far.sum())} of {sigma.size} entries beyond {goal:g} m", fontsize=10
            )
        bar = colour_bar(list(axes), mesh, "largest position bound at deployment in the cell, m")
        bar.ax.xaxis.set_major_formatter("{x:g}")
        bar.ax.xaxis.set_minor_formatter("{x:g}" if high < 8 * low else "")
    return picture(
        figure,
        "judge-map",
        "Position bound at deployment over the globe",
        "Largest Cramer-Rao sigma of position among the entries that deploy in each cell (all of "
        f"one area); red rings: entries beyond {goal:g} m. White: no entry deployed there.",
        wide=True,
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
            f"{goal:g} m", (goal, 101), xytext=(3, -2), textcoords="offset points", color=FAINT,
            va="top",
        )  # fmt: skip
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
