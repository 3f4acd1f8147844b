"""Orbit determination drawn: how well positions are known over time."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from compass.pictures.style import axes_or_new, look
from compass.signal.determination import Determination

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE = 8.0, 4.6


def draw_sigmas(
    axes: "Axes | None", name: str, found: Determination, others: Mapping[str, Determination]
) -> "Axes":
    """Draw the rms position sigma over time, all tracking in front; grey where not tracked.

    Parameters
    ----------
    axes
        Where to; new ones without.
    name
        Of the design.
    found
        With all tracking.
    others
        With other tracking, by name.
    """
    drawn = axes_or_new(axes, *SIZE)
    with look():
        for label, each in others.items():
            drawn.semilogy(each.times / 3600.0, _position(each), lw=1.2, label=label)
        drawn.semilogy(found.times / 3600.0, _position(found), lw=2.4, c="k", label="all tracking")
        if found.times[-1] > found.arc:
            drawn.axvspan(found.arc / 3600.0, found.times[-1] / 3600.0, color="0.9", zorder=0)
        drawn.set_xlabel("time, h")
        drawn.set_ylabel("position, one sigma, m (rms over satellites)")
        drawn.set_title(f"{name}: how well the orbits are known; grey: not tracked")
        drawn.grid(alpha=0.3)
        drawn.legend(fontsize="small")
    return drawn


def _position(found: Determination) -> np.ndarray:
    return np.asarray(np.sqrt((found.rms[:, :3] ** 2).sum(axis=1)))
