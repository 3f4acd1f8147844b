"""What a fix is worth in metres, what it is made of, and who tracks the satellites."""

import numpy as np

from compass.api.determine import DetermineResult, determine
from compass.api.map_errors import budget_blocks, error_table, error_words, protection_blocks
from compass.api.map_result import MapResult
from compass.api.series_result import SeriesResult
from compass.api.show_signal import signal_blocks, signal_facts
from compass.coverage.fix_budget import PARTS
from compass.design import Design
from compass.document.blocks import Block, Picture, Section, Sentence, Verdict
from compass.pages.coverage import percentile_map
from compass.pictures.series import draw_errors
from compass.pictures.style import CYCLE, look, new_figure, picture
from compass.quantities import quantity
from compass.signal.budget import TERMS
from compass.tracking import PICTURES

#: The maps of a fix, and of its protection where one is promised; the first takes the width.
MAPS = ("error_horizontal_m", "error_vertical_m", "error_time_m")
LEVELS = ("protection_horizontal_m", "protection_vertical_m")


#: Errors that are followed at the sites, and the bars of a fix's budget: which, at which share.
FOLLOWED = ("error_horizontal_m", "error_vertical_m")
BARS = (
    ("error_horizontal_m", 50),
    ("error_horizontal_m", 95),
    ("error_vertical_m", 50),
    ("error_vertical_m", 95),
    ("error_time_m", 95),
)


def metres_section(mapped: MapResult, followed: SeriesResult | None = None) -> Section | None:
    """Errors of fixes over Mars and at sites, and their budget; None of a design without a signal.

    `followed` has the errors at the sites over time, if there are any.
    """
    design = mapped.design
    if design.signal is None:
        return None
    names = (*MAPS, *(LEVELS if design.integrity is not None else ()))
    told: list[Block] = [
        *error_words(mapped),
        error_table(mapped),
        *(
            error_picture(mapped, name, wide=name == MAPS[0])
            for name in names
            if not mapped.nowhere(name)
        ),
        *protection_blocks(mapped),
        *over_time(followed),
        *fix_budget_picture(mapped),
        *budget_blocks(mapped),
        budget_picture(design),
        *signal_blocks(design),
    ]
    return Section("Errors in metres", tuple(told))


def error_picture(mapped: MapResult, name: str, *, wide: bool = False) -> Picture:
    """Map of an error or level that holds for 95 % of the time."""
    caption = f"At most this for 95 % of the time. {quantity(name).meaning}"
    return percentile_map(mapped, name, caption, wide=wide)


def over_time(followed: SeriesResult | None) -> list[Block]:
    """Curves and table of the errors at the sites over time; nothing without sites."""
    if followed is None or followed.errors is None:
        return []
    errors, told = followed.errors, []
    epochs, days = errors.sizes["time"], followed.days
    for name in FOLLOWED:
        with look():
            figure = new_figure(8.0, 3.4)
            draw_errors(figure.add_subplot(), errors, name)
        values = errors[name].values
        fixed = values[np.isfinite(values)]
        said = f"from {fixed.min():.3g} to {fixed.max():.3g} m" if fixed.size else "no fix"
        told.append(
            picture(
                figure,
                f"{name.removesuffix('_m').replace('_', '-')}-sites",
                f"{quantity(name).title.capitalize()} at the sites over time",
                f"One sigma, {epochs} moments in {days:.4g} days; no line where there is no fix.",
                wide=True,
                alt=f"Curves of the {quantity(name).title} against time, one a site: {said}.",
            )
        )
    return [*told, *followed.error_blocks()]


def fix_budget_picture(mapped: MapResult) -> list[Picture]:
    """Bars of errors of a range and of fixes, each by its parts; nothing where there is no fix."""
    budget = mapped.errors.get("fix_budget")
    if budget is None:
        return []
    sigma = budget["range_error_m"]
    bars = [("one range,\n50 % below", sigma, budget["range_parts"], 1.0)]
    for name, percent in BARS:
        size = mapped.errors[name][f"p{percent}"]
        label = f"{quantity(name).title.removesuffix(' error')},\n{percent} % below"
        if np.isfinite(size):
            bars.append((label, size, budget[name]["parts"], size / sigma))
    base = np.zeros(len(bars))
    with look():
        figure = new_figure(8.0, 3.8)
        axes = figure.add_subplot()
        for colour, part in zip(CYCLE, PARTS, strict=False):
            high = np.array([size * max(shares[part], 0.0) for _, size, shares, _ in bars])
            if high.any():
                axes.bar(range(len(bars)), high, 0.7, base, color=colour, label=part)
                base += high
        for k, (_, size, _, factor) in enumerate(bars):
            times = "" if k == 0 else f"\nrange × {factor:.3g}"
            axes.annotate(f"{size:.3g} m{times}", (k, base[k]), ha="center", va="bottom")
        axes.set_xticks(range(len(bars)), [label for label, *_ in bars])
        axes.set_ylabel("one sigma, m")
        axes.set_ylim(0.0, 1.25 * float(base.max()))
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    shown = picture(
        figure,
        "fix-budget",
        "What a fix is made of: clock, orbit, receiver, ionosphere, geometry",
        "An error of ranges and of fixes over area and time, cut by the parts' shares of the "
        "variance. Geometry makes of a range's error that of a fix: so many times it. Of "
        f"{mapped.drawn.how if mapped.drawn else ''}; the bounds are in the table.",
        wide=True,
        alt="Bars of the error of a range and of fixes, by part; geometry as a factor.",
    )
    return [shown]


def budget_picture(design: Design) -> Picture:
    """Bars of the shares in a range's variance by elevation, its sigma above each."""
    facts = signal_facts(design)
    # at the very horizon a receiver's noise may have no end
    kept = [k for k, e in enumerate(facts["range_error_m"]) if np.isfinite(e) and e > 0]
    places, base = np.arange(len(kept)), np.zeros(len(kept))
    total = np.array([facts["range_error_m"][k] for k in kept])
    with look():
        figure = new_figure(8.0, 3.6)
        axes = figure.add_subplot()
        for colour, term in zip(CYCLE, TERMS, strict=False):
            share = 100.0 * (np.array([facts[f"{term}_error_m"][k] for k in kept]) / total) ** 2
            axes.bar(places, share, 0.7, base, color=colour, label=term)
            base += share
        for place, sigma in zip(places, total, strict=True):
            axes.annotate(f"{sigma:.3g} m", (place, 101.0), ha="center")
        axes.set_xticks(places, [f"{facts['elevation_deg'][k]:g}°" for k in kept])
        axes.set_xlabel("elevation of the satellite")
        axes.set_ylabel("share of a range's variance, %")
        axes.set_ylim(0.0, 112.0)
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return picture(
        figure,
        "range-budget",
        "What a range's error is made of",
        "Shares of the variance, by the satellite's elevation; above each bar the error of one "
        "range, one sigma.",
        wide=True,
        alt=f"Bars of {', '.join(TERMS)} by elevation.",
    )


def tracking_section(design: Design) -> Section | None:
    """How well the satellites are known, and what each kind of tracking buys; None without any."""
    if design.tracking is None:
        return None
    result = determine(design)
    told: list[Block] = [
        Sentence(f"{block.claim}.") if isinstance(block, Verdict) else block
        for block in result.document().blocks
    ]
    shown = [drawn(result, name, *one) for name, one in zip(PICTURES, TRACKING, strict=True)]
    return Section("Who tracks them", (told[0], *shown, *told[1:]))


#: Pictures of a determination, as `PICTURES` has them: title, caption, what it shows.
TRACKING = (
    (
        "How well the orbits are known over time",
        "Root mean square over satellites of the position's sigma, with all tracking and without "
        "each kind; grey: predicted, not tracked.",
        "Curves of sigma against time, one a set of trackers.",
    ),
    (
        "How well orbits and clocks are known over time, with all tracking",
        "One sigma: lines are root mean squares over satellites, bands hold all of them; grey: "
        "predicted, not tracked.",
        "Curves of radial, along, cross and clock sigma against time.",
    ),
    (
        "Who tracks whom when",
        "A row a satellite, a colour a kind of tracking; grey: predicted, not tracked.",
        "Bars of time, a row a satellite: who measures it.",
    ),
)


def drawn(result: DetermineResult, name: str, title: str, caption: str, alt: str) -> Picture:
    """One of the pictures of a determination."""
    figure = result.plot(name=name).get_figure(root=True)
    assert figure is not None
    stem = "tracking-sigma" if name == "tracking" else f"tracking-{name}"
    return picture(figure, stem, title, caption, wide=True, alt=alt)
