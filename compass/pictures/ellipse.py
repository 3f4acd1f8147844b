"""Where a lander comes down and how well it knows where that is: ellipses to scale."""

import numpy as np

from compass.document.blocks import Picture
from compass.document.numbers import significant
from compass.entry.accuracy import Accuracy, Ellipse
from compass.entry.dispersed import Dispersed
from compass.pictures.style import CYCLE, FAINT, INK, MARS, look, new_figure, picture
from compass.units import KM


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


def arrivals(found: Dispersed) -> Picture:
    """Draw where guided entries come to about their target, east and north.

    In metres where 95 % come within a kilometre, else in kilometres.
    """
    far = found.within(95.0)
    unit, size = ("m", 1.0) if far < KM else ("km", KM)
    turn = np.linspace(0.0, 2 * np.pi, 181)
    figure = new_figure(5.4, 4.6)
    with look():
        axes = figure.add_subplot()
        axes.plot(*found.offsets.T / size, ".", color=MARS, ms=5, alpha=0.6, label="an entry each")
        for percent, style in ((50.0, "--"), (95.0, "-")):
            if np.isfinite(radius := found.within(percent) / size):
                axes.plot(radius * np.cos(turn), radius * np.sin(turn), style, color=INK, lw=1,
                          label=f"{percent:g} % of them")  # fmt: skip
        axes.plot(0, 0, "+", color=INK, ms=9)
        axes.set_aspect("equal", adjustable="datalim")
        axes.set(xlabel=f"east of the target, {unit}", ylabel=f"north, {unit}")
        axes.set_title(f"At {found.event}")
        axes.grid(True, color=FAINT, alpha=0.4)
        figure.legend(loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    flown = f"{found.times.size:,} dispersed guided entries"
    within = f"95 % within {significant(far / size, 3)} {unit}" if np.isfinite(far) else "not 95 %"
    return picture(
        figure,
        "landing-arrivals",
        f"Where {flown} come to",
        "About the target; circles hold half and 95 % of all that were flown.",
        alt=f"Dots of {flown} about the target: {within}.",
    )


def _outline(ellipse: Ellipse) -> tuple[np.ndarray, np.ndarray]:
    """East and north of its rim about the nominal place, km."""
    turn = np.linspace(0.0, 2 * np.pi, 361)
    long, short = ellipse.semi_major * np.cos(turn), ellipse.semi_minor * np.sin(turn)
    sine, cosine = np.sin(ellipse.azimuth), np.cos(ellipse.azimuth)
    return (long * sine + short * cosine) / KM, (long * cosine - short * sine) / KM
