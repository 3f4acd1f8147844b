"""Report section on continuous coverage: worst moment, fold over time, margin by inclination."""

from collections.abc import Sequence
from math import degrees

import numpy as np
from numpy.typing import NDArray

from compass.api.fold_result import FoldResult
from compass.coverage.fold import caps_of, fold_extremes
from compass.coverage.grid import equal_angle_grid
from compass.coverage.margin import CoveringRadius, covering_radius
from compass.coverage.symmetry import Span
from compass.coverage.witness import Witness
from compass.design import Design
from compass.document.blocks import Picture, Section, arranged
from compass.frames import direction, latitude_longitude, mcmf_from_mci, prime_meridian_angle
from compass.orbits import Constellation, orbital_period, positions_mcmf
from compass.orbits.symmetry import one_circle
from compass.pages.neighbours import Neighbour
from compass.pictures.maps import LARGE, draw_map
from compass.pictures.style import (
    CYCLE,
    FAINT,
    HALF,
    INK,
    MARS,
    look,
    new_figure,
    picture,
    whole_numbers,
)
from compass.words import counted, place_words

#: Masks below it are not drawn over inclination, degrees.
LOWEST = -20.0


def fold_section(
    result: FoldResult, beside: Sequence[Neighbour] = (), *, moments: int = 400
) -> Section:
    """Certificate, margins and pictures of continuous coverage, from its result.

    Parameters
    ----------
    result
        Of the whole sphere; of a mask that depends on azimuth it takes the highest elevation.
    beside
        Patterns beside the design's own, from `compass.pages.neighbours.neighbours`.
    moments
        Points of the curve over time.
    """
    design, coverage = result.design, result.coverage
    c, sphere, mask = design.constellation, design.figure.equatorial_radius, coverage.mask
    certificate, span, worst = coverage.certificate, coverage.span, coverage.worst
    when = "for all time" if span.for_all_time else f"over {span.stop / 3600:.4g} h"
    witness = certificate.witness
    text = (
        f"Continuous {result.fold}-fold coverage of the whole of Mars above "
        f"{np.degrees(mask):g} deg, {when}, in two-body motion, {design.figure.title}: "
        f"{result.outcome}. "
        "No grid and no time step is involved: "
        f"{counted(certificate.intervals, 'interval')} settled by caps shrunk by as much "
        f"as they can move ({span.reason})."
    )
    if witness:
        text += (
            f" Counter-example: at t = {witness.time:.3f} s, "
            f"{place_words(degrees(witness.latitude), degrees(witness.longitude), '.4f')}, "
            f"{witness.fold} in view."
        )
    if not design.figure.is_sphere:
        text += (
            " Pictures, the common cap radius and shares are of the sphere of the equatorial "
            "radius, on which all caps of one orbit are alike."
        )
    pictures = [_fold_over_time(c, sphere, mask, result.fold, moments)]
    if witness:
        pictures.insert(0, _refuted(result, sphere, mask, witness))
    elif worst is not None:  # on an ellipsoid caps have no common radius, and none is the tightest
        pictures.insert(0, _pinched(result, sphere, worst))
    if any(each.mask_deg > LOWEST for each in beside):
        pictures.append(margin_by_inclination(design, result.fold, beside))
    return arranged(
        "Exact fold and margins", (text,), pictures, (result.margins(), *result.shares_tables())
    )


def _refuted(result: FoldResult, sphere: float, mask: float, witness: Witness) -> Picture:
    """Map at the moment of a counter-example."""
    radius = caps_of(result.design.constellation, sphere, mask, witness.time)[1]
    place = direction(witness.latitude, witness.longitude)
    title = f"Caps above {np.degrees(mask):g} deg at t = {witness.time:.1f} s, and a witness"
    caption = f"The star has {witness.fold} satellites in view, too few."
    return _arrangement(result, witness.time, radius, place, title, caption)


def _pinched(result: FoldResult, sphere: float, worst: CoveringRadius) -> Picture:
    """Map at the worst moment: with the smallest caps that will do, for equal circular orbits."""
    c, mask = result.design.constellation, result.coverage.mask
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
    place_of = {1: "", 2: "second ", 3: "third "}.get(result.fold, f"{result.fold}th ")
    caption = (
        f"At the star the {place_of}nearest satellite is as far as it ever gets anywhere: "
        f"with caps any smaller a hole of fold {result.fold - 1} opens there."
    )
    return _arrangement(result, worst.time, radius, place, title, caption)


def _arrangement(
    result: FoldResult, time: float, radius: NDArray, place: NDArray, title: str, caption: str
) -> Picture:
    """Map of fold with the cap circles, the satellites and one place, all Mars-fixed."""
    c = result.design.constellation
    r = positions_mcmf(c, [time])[:, 0]
    fixed = r / np.linalg.norm(r, axis=1, keepdims=True)
    cells = equal_angle_grid(np.radians(1.0))
    latitude = 0.5 * (cells.latitude_edges[1:] + cells.latitude_edges[:-1])
    longitude = 0.5 * (cells.longitude_edges[1:] + cells.longitude_edges[:-1])
    grid = direction(latitude[:, np.newaxis], longitude)
    count = (grid @ fixed.T >= np.cos(radius)).sum(axis=-1)
    figure = new_figure(*LARGE)
    with look():
        axes = figure.add_subplot()
    lat, lon = np.degrees(latitude_longitude(fixed))
    chart = draw_map(
        axes, count, cells, title, "satellites whose caps cover the place",
        figure_name=result.design.figure.name, scale="counts", wanted=result.fold, named=False,
    )  # fmt: skip
    with look():
        for centre, cap in zip(fixed, radius, strict=True):
            chart.track(*_circle(centre, float(cap)), colors="white", linewidths=0.9, alpha=0.85)
        chart.points(lon, lat, marker="o", ms=5, mfc="white", mec=INK)
        if c.size <= 24:
            chart.names(c.satellite_names, lon, lat)
        at_lat, at_lon = np.degrees(latitude_longitude(place))
        chart.points(at_lon, at_lat, marker="*", ms=16, mfc=MARS, mec="white")
    return picture(
        figure,
        "fold-worst-moment",
        "Arrangement of caps at the worst moment",
        caption + " Circles are the rims of the caps, dots the points below the satellites; "
        "colours show the fold on a 1-degree grid, for the eye only.",
        wide=True,
        alt=f"Map of Mars: {count.min()} to {count.max()} caps over each place; the tightest is at "
        f"{place_words(float(at_lat), float(at_lon), '.1f')}.",
    )


def _circle(centre: NDArray, radius: float) -> tuple[NDArray, NDArray]:
    """Longitudes and latitudes of the rim of a cap, degrees."""
    side = np.cross(centre, [0.0, 0.0, 1.0] if abs(centre[2]) < 0.9 else [1.0, 0.0, 0.0])
    side /= np.linalg.norm(side)
    other = np.cross(centre, side)
    turn = np.linspace(0, 2 * np.pi, 721)[:, np.newaxis]
    rim = np.cos(radius) * centre + np.sin(radius) * (np.cos(turn) * side + np.sin(turn) * other)
    lat, lon = np.degrees(latitude_longitude(rim))
    return lon, lat


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
    figure = new_figure(5.6, 4.4)
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
        whole_numbers(above.yaxis)
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


def margin_by_inclination(design: Design, fold: int, margins: Sequence[Neighbour]) -> Picture:
    """Highest mask against inclination for the design's pattern and those beside it."""
    pattern = design.constellation.pattern
    assert pattern is not None
    figure = new_figure(*HALF)
    with look():
        axes = figure.add_subplot()
        for k, other in enumerate(margins):
            axes.plot(
                other.inclination_deg,
                other.margin_deg,
                color=CYCLE[k % len(CYCLE)],
                lw=2.2 if k == 0 else 1.1,
                label=other.name,
            )
        axes.axhline(0.0, color=FAINT, lw=1)
        axes.axvline(np.degrees(pattern.inclination), color=FAINT, ls="--", lw=1)
        axes.set(
            xlabel="inclination, deg",
            ylabel=f"highest mask with {fold}-fold, deg",
            title=f"Margin against inclination, {counted(pattern.satellites, 'satellite')}",
        )
        axes.set_ylim(bottom=max(LOWEST, axes.get_ylim()[0]))
        axes.grid(True)
        axes.legend(ncols=4, frameon=False, fontsize=8)
    best = max(margins, key=lambda n: n.mask_deg)
    return picture(
        figure,
        "fold-margin-inclination",
        "Margin of neighbouring patterns against inclination",
        "Highest elevation mask with continuous coverage, to 0.1 deg, for the design's pattern "
        "(thick) and those with other phasings; dashed: the design's inclination. Below zero there "
        "is no continuous coverage.",
        alt=f"Curves of the highest mask over inclination; the best is {best.notation} with "
        f"{best.mask_deg:.3g} deg.",
    )
