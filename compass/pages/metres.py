"""What a fix is worth in metres, what a range's error is made of, and who tracks the satellites."""

import numpy as np

from compass.api.determine import determine
from compass.api.map_result import MapResult
from compass.api.show_signal import signal_blocks, signal_facts
from compass.design import Design
from compass.document.blocks import Block, Picture, Section, Sentence, Verdict
from compass.pages.coverage import percentile_map
from compass.pictures.style import CYCLE, look, new_figure, picture
from compass.quantities import quantity
from compass.signal.budget import TERMS

#: The maps of a fix, and of its protection where one is promised; the first takes the width.
MAPS = ("error_horizontal_m", "error_vertical_m", "error_time_m")
LEVELS = ("protection_horizontal_m", "protection_vertical_m")


def metres_section(mapped: MapResult) -> Section | None:
    """Errors of fixes over Mars, and the budget of a range; None of a design without a signal."""
    design = mapped.design
    if design.signal is None:
        return None
    names = (*MAPS, *(LEVELS if design.integrity is not None else ()))
    told: list[Block] = [
        *reversed(mapped.error_blocks()),
        *(error_picture(mapped, name, wide=name == MAPS[0]) for name in names),
        *mapped.protection_blocks(),
        budget_picture(design),
        *signal_blocks(design),
    ]
    return Section("Errors in metres", tuple(told))


def error_picture(mapped: MapResult, name: str, *, wide: bool = False) -> Picture:
    """Map of an error or level that holds for 95 % of the time."""
    caption = f"At most this for 95 % of the time. {quantity(name).meaning}"
    return percentile_map(mapped, name, caption, wide=wide)


def budget_picture(design: Design) -> Picture:
    """Bars of the shares in a range's variance by elevation, its sigma above each."""
    found = signal_facts(design)
    # at the very horizon a receiver's noise may have no end
    kept = [k for k, e in enumerate(found["range_error_m"]) if np.isfinite(e) and e > 0]
    places, base = np.arange(len(kept)), np.zeros(len(kept))
    total = np.array([found["range_error_m"][k] for k in kept])
    with look():
        figure = new_figure(8.0, 3.6)
        axes = figure.add_subplot()
        for colour, term in zip(CYCLE, TERMS, strict=False):
            share = 100.0 * (np.array([found[f"{term}_error_m"][k] for k in kept]) / total) ** 2
            axes.bar(places, share, 0.7, base, color=colour, label=term)
            base += share
        for place, sigma in zip(places, total, strict=True):
            axes.annotate(f"{sigma:.3g} m", (place, 101.0), ha="center")
        axes.set_xticks(places, [f"{found['elevation_deg'][k]:g}°" for k in kept])
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
    found = determine(design)
    told: list[Block] = [
        Sentence(f"{block.claim}.") if isinstance(block, Verdict) else block
        for block in found.document().blocks
    ]
    figure = found.plot().figure
    shown = picture(
        figure,  # type: ignore[arg-type]
        "tracking-sigma",
        "How well the orbits are known over time",
        "Root mean square over satellites of the position's sigma, with all tracking and without "
        "each kind; grey: predicted, not tracked.",
        wide=True,
        alt="Curves of sigma against time, one a set of trackers.",
    )
    return Section("Who tracks them", (told[0], shown, *told[1:]))
