"""Timelines of sight, and link budgets along them."""

from typing import TYPE_CHECKING

import numpy as np

from compass.bodies import SOLAR_DAY
from compass.contacts.nodes import find_node
from compass.contacts.radio import carrier_to_noise
from compass.contacts.record import pair_track
from compass.contacts.spans import any_of
from compass.contacts.survey import Survey
from compass.contacts.windows import Windows
from compass.document.blocks import Picture
from compass.document.numbers import significant
from compass.links import Radio
from compass.pictures.rows import draw_rows
from compass.pictures.style import CYCLE, HALF, INK, look, new_figure, picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: A timeline shows this much of the span, so that single passes stay apart.
SHOWN_SOLS = 5.0

#: Rows of a timeline at most; above that it is a grey smear.
MAX_ROWS = 60


def timeline(survey: Survey, name: str) -> Picture:
    """Draw when a node sees each satellite, and any of them: a row a satellite, a bar a window."""
    pairs = survey.of(name)
    shown = pairs[:MAX_ROWS]
    figure = new_figure(5.6, height_of(survey, name))
    with look():
        draw_timeline(figure.add_subplot(), survey, name)
    left_out = len(pairs) - len(shown)
    more = f" The first {len(shown)} of {len(pairs)} satellites." if left_out else ""
    return picture(
        figure,
        f"access-{_stem(name)}",
        f"Satellites in sight of {name}",
        f"Each bar is a span of sight, found to 1 ms, one colour an orbital plane; "
        f"{_shown(survey.sols)}. The dark row is any satellite at all.{more}",
    )


def in_sight(survey: Survey, name: str) -> bool:
    """Whether a node sees any satellite in what its timeline shows."""
    end = SHOWN_SOLS * SOLAR_DAY.value
    return any(bool(np.any(w.spans[:, 0] < end)) for w in survey.of(name))


def _shown(sols: float) -> str:
    """How much of the span a timeline shows."""
    whole = f"{significant(sols, 4)} sols"
    return f"the first {SHOWN_SOLS:g} of {whole}" if sols > SHOWN_SOLS else f"all of {whole}"


def height_of(survey: Survey, name: str) -> float:
    """Height of a node's timeline, inches."""
    return 1.5 + 0.2 * len(survey.of(name)[:MAX_ROWS])


def draw_timeline(axes: "Axes", survey: Survey, name: str) -> None:
    """Draw into axes when a node sees each satellite, and any of them."""
    shown = survey.of(name)[:MAX_ROWS]
    sol = SOLAR_DAY.value
    # one colour an orbital plane, where the names tell the plane
    others = [_other(w, name) for w in shown]
    planes = list(dict.fromkeys(other.partition("S")[0] for other in others))
    colours = [CYCLE[planes.index(o.partition("S")[0]) % len(CYCLE)] for o in others]
    draw_rows(
        axes,
        ["any", *others],
        [any_of([w.spans for w in survey.of(name)]) / sol, *(w.spans / sol for w in shown)],
        [INK, *colours],
        (0.0, min(SHOWN_SOLS, survey.sols)),
    )
    axes.set_xlabel("time after the epoch (sols)")
    axes.set_title(f"Satellites in sight of {name}")


def link_budget(survey: Survey, radio: Radio) -> Picture:
    """Draw C/N0 along the windows that a radio serves, against what it needs."""
    pairs = served(survey, radio)
    shown = pairs[: len(CYCLE)]
    # the Earth's distance changes over weeks, a satellite's over hours
    sols = survey.sols if "earth" in radio.between else min(SHOWN_SOLS, survey.sols)
    figure = new_figure(*HALF)
    with look():
        axes = figure.add_subplot()
        for color, w in zip(CYCLE, shown, strict=False):
            path = pair_track(survey, w)
            # a nan at the end of each window breaks the line there
            breaks = np.searchsorted(path.time, w.end, side="right")
            time = np.insert(path.time, breaks, w.end) / SOLAR_DAY.value
            ratio = np.insert(carrier_to_noise(radio, path.distance), breaks, np.nan)
            axes.plot(time, ratio, color=color, label=f"{w.first} - {w.second}")
        axes.axhline(radio.required, color=INK, ls="--", lw=1, label="needed")
        axes.set_xlim(0.0, sols)
        axes.set_xlabel("time after the epoch (sols)")
        axes.set_ylabel("C/N₀ (dB Hz)")
        title = f"Link budget, {radio.between[0]} - {radio.between[1]}"
        axes.set_title(f"{title}, {radio.frequency / 1e6:g} MHz")
        axes.grid()
        figure.legend(loc="outside right upper", fontsize=8, frameon=False)
    more = f" The first {len(shown)} of {len(pairs)} links." if len(pairs) > len(shown) else ""
    return picture(
        figure,
        f"access-link-{_stem('-'.join(radio.between))}-{radio.frequency / 1e6:.0f}",
        title,
        f"Carrier to noise density in free space, for {radio.eirp:g} dBW and "
        f"{radio.figure_of_merit:g} dB/K; usable above the dashed line.{more}",
    )


def served(survey: Survey, radio: Radio) -> list[Windows]:
    """Windows of the pairs that a radio serves and that see each other."""
    return [
        w
        for w in survey.windows
        if w.count
        and radio.serves(
            find_node(survey.nodes, w.first).kind, find_node(survey.nodes, w.second).kind
        )
    ]


def _other(w: Windows, name: str) -> str:
    return w.second if w.first == name else w.first


def _stem(name: str) -> str:
    return "".join(c if c.isalnum() else "-" for c in name.lower())
