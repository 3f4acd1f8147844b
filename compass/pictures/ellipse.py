"""Where a lander comes down and how well it knows where that is: ellipses to scale."""

import numpy as np

from compass.document.blocks import Picture
from compass.document.numbers import significant
from compass.entry.accuracy import Accuracy, Ellipse
from compass.pictures.style import CYCLE, FAINT, INK, MARS, look, new_figure, picture

KM = 1e3


def landing_ellipse(at: Accuracy, how: str = "Unguided") -> Picture:
    """Draw delivery, and `how`, and knowledge about the nominal place, east and north in km."""
    delivery, knowledge = at.delivery.ellipse, at.knowledge.ellipse
    turn = np.linspace(0.0, 2 * np.pi, 181)
    figure = new_figure(5.4, 4.6)
    with look():
        axes = figure.add_subplot()
        axes.fill(*_outline(delivery), color=MARS, alpha=0.18, lw=0)
        axes.plot(*_outline(delivery), color=MARS, lw=1.8, label="comes down, 95 %")
        half = at.delivery.cep / KM
        axes.plot(
            half * np.cos(turn), half * np.sin(turn), "--", color=INK, lw=1, label="half of them"
        )
        axes.plot(*_outline(knowledge), color=CYCLE[0], lw=1.8, label="knows its place, 95 %")
        axes.plot(0, 0, "+", color=INK, ms=9)
        axes.set_aspect("equal", adjustable="datalim")
        axes.set(xlabel="east of the nominal place, km", ylabel="north, km")
        axes.set_title(f"At {at.name}")
        axes.grid(True, color=FAINT, alpha=0.4)
        figure.legend(loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    sizes = f"{delivery.semi_major / KM:.3g} by {delivery.semi_minor / KM:.3g} km"
    ratio = delivery.semi_major / max(knowledge.semi_major, 1e-9)
    smaller = significant(float(f"{ratio:.2g}"), 2)
    return picture(
        figure,
        "landing-ellipse",
        "Landing ellipse",
        f"{how}: half axes {sizes} for 95 %. What the lander knows of its place, by linear "
        f"covariance, is an ellipse {smaller} times smaller, drawn to the same scale.",
        alt=f"Ellipse of {sizes} about the nominal place; that of knowledge is {smaller} times "
        "smaller.",
    )


def _outline(ellipse: Ellipse) -> tuple[np.ndarray, np.ndarray]:
    """East and north of its rim about the nominal place, km."""
    turn = np.linspace(0.0, 2 * np.pi, 361)
    long, short = ellipse.semi_major * np.cos(turn), ellipse.semi_minor * np.sin(turn)
    sine, cosine = np.sin(ellipse.azimuth), np.cos(ellipse.azimuth)
    return (long * sine + short * cosine) / KM, (long * cosine - short * sine) / KM
