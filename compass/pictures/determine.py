"""Orbit determination drawn: how well positions are known over time."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from compass.pictures.rows import draw_rows, runs
from compass.pictures.style import CYCLE, INK, axes_or_new, look
from compass.signal.determination import Determination
from compass.tracking import titled

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE = 8.0, 4.6

#: Satellites in a picture of a schedule at most; with more it is a grey smear.
MOST = 40


def draw_sigmas(
    axes: "Axes | None",
    name: str,
    determination: Determination,
    others: Mapping[str, Determination],
) -> "Axes":
    """Draw the rms position sigma over time, all tracking in front; grey where not tracked.

    Parameters
    ----------
    axes
        Where to; new ones without.
    name
        Of the design.
    determination
        With all tracking.
    others
        With other tracking, by name.
    """
    drawn = axes_or_new(axes, *SIZE)
    with look():
        for label, each in others.items():
            drawn.semilogy(each.times / 3600.0, _position(each), lw=1.2, label=label)
        drawn.semilogy(
            determination.times / 3600.0,
            _position(determination),
            lw=2.4,
            c="k",
            label="all tracking",
        )
        _shade_prediction(drawn, determination)
        drawn.set_xlabel("time, h")
        drawn.set_ylabel("position, one sigma, m (rms over satellites)")
        drawn.set_title(f"{name}: how well the orbits are known; grey: not tracked")
        drawn.grid(alpha=0.3)
        # as many curves as there are trackers and twice as many: a legend among them hides some
        drawn.legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return drawn


def draw_components(
    axes: "Axes | None", name: str, determination: Determination, clock: bool
) -> "Axes":
    """Draw radial, along, cross and, if told, clock sigma over time: rms and span of satellites."""
    drawn = axes_or_new(axes, *SIZE)
    hours, sigma = determination.times / 3600.0, determination.sigma
    known = ("radial", "along", "cross", "clock")[: 4 if clock else 3]
    with look():
        for k, (colour, label) in enumerate(zip(CYCLE, known, strict=False)):
            low, high = sigma[..., k].min(axis=1), sigma[..., k].max(axis=1)
            drawn.fill_between(hours, low, high, color=colour, alpha=0.2, lw=0)
            drawn.semilogy(hours, determination.rms[:, k], color=colour, lw=1.6, label=label)
        _shade_prediction(drawn, determination)
        drawn.set_xlabel("time, h")
        drawn.set_ylabel("one sigma, m (rms; band: all satellites)")
        drawn.set_title(f"{name}: orbits and clocks; grey: not tracked")
        drawn.grid(alpha=0.3)
        drawn.legend(fontsize="small")
    return drawn


def draw_schedule(
    axes: "Axes | None", name: str, determination: Determination, satellites: Sequence[str]
) -> "Axes":
    """Draw whom each kind of tracker measures when: a lane a satellite and kind, in its colour."""
    shown, kinds = satellites[:MOST], determination.tracked
    drawn = axes_or_new(axes, SIZE[0], 1.6 + 0.24 * len(shown))
    step, count = determination.tracking.step / 3600.0, len(kinds)
    lanes = [
        (f"{satellite}: {titled(kind)}", step * (runs(tracked[k]) - 0.5), colour)
        for k, satellite in enumerate(shown)
        for colour, (kind, tracked) in zip(CYCLE, kinds.items(), strict=False)
    ]
    with look():
        names, spans, colours = zip(*lanes, strict=True)
        ends = (0.0, determination.times[-1] / 3600.0)
        draw_rows(drawn, names, spans, colours, ends, width=10.0 / count)
        for colour, kind in zip(CYCLE, kinds, strict=False):
            drawn.plot([], [], color=colour, lw=4.0, label=titled(kind))
        _shade_prediction(drawn, determination)
        above = count * np.arange(len(shown)) - 0.5
        for level in above[1:]:
            drawn.axhline(level, color=INK, lw=0.6)
        drawn.set_yticks(above + count / 2, list(shown), fontsize=8)
        drawn.set_xlabel("time, h")
        some = f" (the first {MOST} of {len(satellites)})" if len(satellites) > MOST else ""
        drawn.set_title(f"{name}: who tracks whom when{some}; grey: not tracked")
        drawn.legend(
            fontsize=8, frameon=False, ncols=count, loc="upper center",
            bbox_to_anchor=(0.5, -0.7 / (0.24 * len(shown) + 1.0)),
        )  # fmt: skip
    return drawn


def _shade_prediction(axes: "Axes", determination: Determination) -> None:
    if determination.times[-1] > determination.arc:
        axes.axvspan(
            determination.arc / 3600.0, determination.times[-1] / 3600.0, color="0.9", zorder=0
        )


def _position(determination: Determination) -> np.ndarray:
    return np.asarray(np.sqrt((determination.rms[:, :3] ** 2).sum(axis=1)))
