"""Report section on continuous coverage: worst moment, fold over time, margin by inclination."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from compass.api.fold import FoldResult
from compass.coverage.fold import caps_of, fold_extremes
from compass.coverage.margin import CoveringRadius, covering_radius
from compass.coverage.symmetry import Span
from compass.coverage.witness import Witness
from compass.document.blocks import Picture, Section, arranged
from compass.frames import direction, latitude_longitude, mcmf_from_mci, prime_meridian_angle
from compass.orbits import Constellation, Pattern, orbital_period, positions_mcmf
from compass.orbits.constellation import from_pattern
from compass.orbits.symmetry import one_circle
from compass.pictures.style import CYCLE, FAINT, INK, MARS, look, new_figure, picture, steps_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def fold_section(result: FoldResult, *, inclinations: int = 46, moments: int = 400) -> Section:
    """Certificate, margins and pictures of continuous coverage, from its result.

    Parameters
    ----------
    result
        Of the whole sphere; of a mask that depends on azimuth it takes the highest elevation.
    inclinations, moments
        Points of the curves over inclination and time.
    """
    design, found = result.design, result.coverage
    c, sphere, mask = design.constellation, design.figure.equatorial_radius, found.mask
    certificate, span, worst = found.certificate, found.span, found.worst
    assert worst is not None  # of the whole sphere there is one
    when = "for all time" if span.for_all_time else f"over {span.stop / 3600:.4g} h"
    witness = certificate.witness
    text = (
        f"Continuous {result.fold}-fold coverage of the whole of Mars above "
        f"{np.degrees(mask):g} deg, {when}, in two-body motion, {design.figure.title}: "
        f"{result.outcome}. "
        f"No grid and no time step is involved: {certificate.intervals} interval(s) were settled "
        f"by caps shrunk by as much as they can move ({span.reason})."
    )
    if witness:
        text += (
            f" Counter-example: at t = {witness.time:.3f} s, latitude "
            f"{np.degrees(witness.latitude):.4f} deg, longitude "
            f"{np.degrees(witness.longitude):.4f} deg, {witness.fold} in view."
        )
    if not design.figure.is_sphere:
        text += (
            " Pictures, the common cap radius and shares are of the sphere of the equatorial "
            "radius, on which all caps of one orbit are alike."
        )
    tables = (result.margins(), *result.shares_tables())
    pictures = [
        _refuted(c, sphere, mask, witness)
        if witness
        else _pinched(c, sphere, mask, result.fold, worst),
        _fold_over_time(c, sphere, mask, result.fold, moments),
    ]
    if c.pattern is not None and one_circle(c):
        pictures.append(_margin_by_inclination(c, c.pattern, result.fold, sphere, inclinations))
    return arranged("Exact fold and margins", (text,), tuple(pictures), tables)


def _refuted(c: Constellation, sphere: float, mask: float, witness: Witness) -> Picture:
    """Map at the moment of a counter-example."""
    radius = caps_of(c, sphere, mask, witness.time)[1]
    place = direction(witness.latitude, witness.longitude)
    title = f"Caps above {np.degrees(mask):g} deg at t = {witness.time:.1f} s, and a witness"
    caption = f"The star has {witness.fold} satellites in view, too few."
    return _arrangement(c, witness.time, radius, place, title, caption)


def _pinched(
    c: Constellation, sphere: float, mask: float, fold: int, worst: CoveringRadius
) -> Picture:
    """Map at the worst moment: with the smallest caps that will do, for equal circular orbits."""
    place = mcmf_from_mci(worst.place, prime_meridian_angle(c.epoch, worst.time))
    if one_circle(c):
        radius = np.full(c.size, worst.at_least)
        title = (
            f"Caps of the smallest radius, {np.degrees(worst.radius):.3f} deg, "
            f"at the worst moment, t = {worst.time:.1f} s"
        )
    else:
        radius = caps_of(c, sphere, mask, worst.time)[1]
        title = f"Caps above {np.degrees(mask):g} deg at t = {worst.time:.1f} s"
    caption = (
        f"At the star the {fold}-th nearest satellite is as far as it ever gets anywhere: with "
        f"caps any smaller a hole of fold {fold - 1} opens there."
    )
    return _arrangement(c, worst.time, radius, place, title, caption)


def _arrangement(
    c: Constellation, time: float, radius: NDArray, place: NDArray, title: str, caption: str
) -> Picture:
    """Map of fold with the cap circles, the satellites and one place, all Mars-fixed."""
    r = positions_mcmf(c, [time])[:, 0]
    fixed = r / np.linalg.norm(r, axis=1, keepdims=True)
    latitude, longitude = np.radians(np.arange(-90, 91)), np.radians(np.arange(-180, 181))
    grid = direction(latitude[:, np.newaxis], longitude)
    count = (grid @ fixed.T >= np.cos(radius)).sum(axis=-1)
    figure = new_figure(9.0, 4.9)
    with look():
        axes = figure.add_subplot()
        low, high = int(count.min()), int(count.max())
        image = axes.imshow(
            count,
            origin="lower",
            extent=(-180.5, 180.5, -90.5, 90.5),
            cmap=steps_of("viridis", high - low + 1),
            vmin=low - 0.5,
            vmax=high + 0.5,
            aspect="auto",
        )
        for centre, cap in zip(fixed, radius, strict=True):
            _circle(axes, centre, float(cap))
        lat, lon = np.degrees(latitude_longitude(fixed))
        axes.plot(lon, lat, "o", color="white", markeredgecolor=INK, markersize=5, zorder=3)
        for name, x, y in zip(c.satellite_names, lon, lat, strict=True):
            if c.size <= 24:
                axes.annotate(
                    name, (x, y), xytext=(5, 4), textcoords="offset points", color="white", size=7
                )
        at_lat, at_lon = np.degrees(latitude_longitude(place))
        axes.plot(at_lon, at_lat, "*", color=MARS, markeredgecolor="white", markersize=16, zorder=4)
        axes.set(
            xlim=(-180, 180),
            ylim=(-90, 90),
            xlabel="east longitude, deg",
            ylabel="latitude, deg",
            xticks=range(-180, 181, 60),
            yticks=range(-90, 91, 30),
            title=title,
        )
        bar = figure.colorbar(image, ax=axes, ticks=range(low, high + 1))
        bar.set_label("satellites whose caps cover the place")
    return picture(
        figure,
        "fold-worst-moment",
        "Arrangement of caps at the worst moment",
        caption + " Circles are the rims of the caps, dots the points below the satellites; "
        "colours show the fold on a 1-degree grid, for the eye only.",
    )


def _circle(axes: "Axes", centre: NDArray, radius: float) -> None:
    """Draw the rim of a cap in latitude and longitude, cut where it leaves the map."""
    side = np.cross(centre, [0.0, 0.0, 1.0] if abs(centre[2]) < 0.9 else [1.0, 0.0, 0.0])
    side /= np.linalg.norm(side)
    other = np.cross(centre, side)
    turn = np.linspace(0, 2 * np.pi, 721)[:, np.newaxis]
    rim = np.cos(radius) * centre + np.sin(radius) * (np.cos(turn) * side + np.sin(turn) * other)
    lat, lon = np.degrees(latitude_longitude(rim))
    cut = np.flatnonzero(np.abs(np.diff(lon)) > 180) + 1
    axes.plot(
        np.insert(lon, cut, np.nan), np.insert(lat, cut, np.nan), color="white", lw=0.8, alpha=0.8
    )


def _fold_over_time(
    c: Constellation, sphere: float, mask: float, fold: int, moments: int
) -> Picture:
    """Least and greatest fold, and the cap radius needed, at moments of one period."""
    stop = float(orbital_period(c.semi_major_axis.max(initial=sphere), c.gm))
    times = np.linspace(0.0, stop, moments, endpoint=False)
    extremes = [fold_extremes(*caps_of(c, sphere, mask, float(t))) for t in times]
    needed = [
        covering_radius(c, fold, span=Span(float(t), float(t), False, "")).at_least for t in times
    ]
    figure = new_figure(8.0, 5.2)
    with look():
        above, below = figure.subplots(2, 1, sharex=True)
        hours = times / 3600
        above.step(hours, [e.least for e in extremes], color=MARS, where="mid", label="least")
        above.step(
            hours, [e.greatest for e in extremes], color=CYCLE[0], where="mid", label="greatest"
        )
        above.axhline(fold, color=FAINT, ls="--", lw=1, label="wanted")
        above.set(ylabel="exact fold", title="Fold over one orbit, exact at each moment")
        above.set_ylim(bottom=0)
        above.legend(ncols=3, frameon=False, loc="lower right")
        above.yaxis.get_major_locator().set_params(integer=True)
        below.plot(hours, np.degrees(needed), color=INK, lw=1.2)
        if one_circle(c) and c.size:
            cap = np.degrees(caps_of(c, sphere, mask, 0.0)[1][0])
            below.axhline(
                cap, color=CYCLE[2], ls="--", lw=1, label=f"caps above the mask: {cap:.2f}"
            )
            below.legend(frameon=False, loc="best")
        below.set(xlabel="time after the epoch, h", ylabel=f"cap radius for {fold}-fold, deg")
        below.grid(True)
        above.grid(True)
    return picture(
        figure,
        "fold-over-time",
        "Exact fold and cap radius needed over one orbit",
        "Above: least and greatest number of satellites in view over the whole sphere. Below: the "
        "smallest caps that would do at each moment; the greatest of them is the margin.",
    )


def _neighbours(pattern: Pattern) -> list[Pattern]:
    """Patterns that differ in phasing alone, the design's first; at most eight."""
    others = [f for f in range(pattern.planes) if f != pattern.phasing % pattern.planes]
    near = sorted(others, key=lambda f: (abs(f - pattern.phasing), f))[:7]
    return [
        Pattern(pattern.kind, pattern.satellites, pattern.planes, f, pattern.inclination)
        for f in [pattern.phasing, *near]
    ]


def _margin_by_inclination(
    c: Constellation, pattern: Pattern, fold: int, sphere: float, inclinations: int
) -> Picture:
    """Highest mask against inclination for the design's pattern and those beside it."""
    angles = np.radians(np.linspace(20.0, 90.0, inclinations))
    radius = float(c.semi_major_axis[0])
    figure = new_figure(8.0, 4.6)
    with look():
        axes = figure.add_subplot()
        for k, other in enumerate(_neighbours(pattern)):
            masks = []
            for angle in angles:
                tried = from_pattern(replace(other, inclination=angle), radius)
                found = covering_radius(tried, fold, tolerance=2e-3)
                cap = 0.5 * (found.radius + found.at_least)
                masks.append(np.arctan2(np.cos(cap) - sphere / radius, np.sin(cap)))
            axes.plot(
                np.degrees(angles),
                np.degrees(masks),
                color=CYCLE[k % len(CYCLE)],
                lw=2.2 if k == 0 else 1.1,
                label=f"{other.satellites}/{other.planes}/{other.phasing}",
            )
        axes.axhline(0.0, color=FAINT, lw=1)
        axes.axvline(np.degrees(pattern.inclination), color=FAINT, ls="--", lw=1)
        axes.set(
            xlabel="inclination, deg",
            ylabel=f"highest mask with {fold}-fold, deg",
            title=f"Margin against inclination, {pattern.satellites} satellites",
        )
        axes.set_ylim(bottom=max(-20.0, axes.get_ylim()[0]))
        axes.grid(True)
        axes.legend(ncols=4, frameon=False, fontsize=8)
    return picture(
        figure,
        "fold-margin-inclination",
        "Margin of neighbouring patterns against inclination",
        "Highest elevation mask with continuous coverage, to 0.1 deg, for the design's pattern "
        "(thick) and those with other phasings; dashed: the design's inclination. Below zero there "
        "is no continuous coverage.",
    )
