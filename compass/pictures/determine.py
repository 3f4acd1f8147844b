"""Orbit determination drawn: how well positions are known over time."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from compass.pictures.style import CYCLE, FAINT, axes_or_new, look
from compass.signal.determination import Determination

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


def schedule_height(satellites: int) -> float:
    """Height of a picture of a schedule, inches."""
    return 1.6 + 0.24 * min(satellites, MOST)


def draw_schedule(
    axes: "Axes | None", name: str, determination: Determination, satellites: Sequence[str]
) -> "Axes":
    """Draw whom each kind of tracker measures when: a row a satellite, a lane a kind."""
    shown = satellites[:MOST]
    drawn = axes_or_new(axes, SIZE[0], schedule_height(len(satellites)))
    kinds = determination.tracked
    step = determination.tracking.step / 3600.0
    lane = 0.8 / len(kinds)
    with look():
        for k, (colour, (kind, tracked)) in enumerate(zip(CYCLE, kinds.items(), strict=False)):
            for row in range(len(shown)):
                spans = step * (_runs(tracked[row]) - 0.5)
                across = np.column_stack([spans, np.full(len(spans), np.nan)]).ravel()
                level = np.full(across.size, row - 0.4 + lane * (k + 0.5))
                drawn.plot(across, level, color=colour, lw=12.0 * lane, solid_capstyle="butt")
            drawn.plot([], [], color=colour, lw=4.0, label=kind)
        for row in range(len(shown) - 1):
            drawn.axhline(row + 0.5, color=FAINT, lw=0.4, alpha=0.5)
        _shade_prediction(drawn, determination)
        drawn.set_yticks(range(len(shown)), list(shown), fontsize=8)
        drawn.set_ylim(len(shown) - 0.4, -0.6)
        drawn.set_xlim(0.0, determination.times[-1] / 3600.0)
        drawn.tick_params(axis="y", length=0)
        drawn.set_xlabel("time, h")
        some = f" (the first {MOST} of {len(satellites)})" if len(satellites) > MOST else ""
        drawn.set_title(f"{name}: who tracks whom when{some}; grey: not tracked")
        drawn.legend(
            fontsize=8, frameon=False, ncols=len(kinds), loc="upper center",
            bbox_to_anchor=(0.5, -0.7 / (0.24 * len(shown) + 1.0)),
        )  # fmt: skip
    return drawn


def _runs(on: np.ndarray) -> np.ndarray:
    """First and past-the-last number of every run of truths, shape (runs, 2)."""
    edges = np.diff(np.concatenate([[0], on.astype(np.int8), [0]]))
    return np.column_stack([np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)])


def _shade_prediction(axes: "Axes", determination: Determination) -> None:
    if determination.times[-1] > determination.arc:
        axes.axvspan(
            determination.arc / 3600.0, determination.times[-1] / 3600.0, color="0.9", zorder=0
        )


def _position(determination: Determination) -> np.ndarray:
    return np.asarray(np.sqrt((determination.rms[:, :3] ** 2).sum(axis=1)))
