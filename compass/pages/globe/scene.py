"""What the globe draws, as plain values: paths, stations, gaps, relief, colours."""

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_rgb

from compass.bodies import MARS_ROTATION_RATE
from compass.coverage.errors import ERRORS
from compass.coverage.gap import gap, gap_outline
from compass.design import Design
from compass.frames import prime_meridian_angle
from compass.orbits import orbital_period, positions_mci, positions_mcmf, repeat_period
from compass.pages.globe.worth import packed, worth
from compass.pictures.colours import count_colours
from compass.pictures.places import PLACES
from compass.pictures.relief import shade
from compass.pictures.style import CYCLE
from compass.quantities import quantity
from compass.units import KM

#: Samples of a path in a revolution: between them the page draws a cubic, good to metres.
A_REVOLUTION = 120
#: A globe goes over no more revolutions than this, and its paths have no more numbers: those of
#: many satellites are shorter, never coarser.
MOST_REVOLUTIONS, MOST_NUMBERS = 10, 300_000
#: Most satellites in view that have a colour of their own.
MOST_COUNTED = 12


def scene(design: Design) -> dict[str, Any]:
    """Everything the globe of a design shows, for JSON.

    Paths are Mars-fixed positions in kilometres at even times, as the design's motion has them;
    a mask that depends on azimuth is taken at its highest all around, which promises less.
    """
    c, figure = design.constellation, design.figure
    periods = orbital_period(c.semi_major_axis, c.gm)
    duration = min(repeat_period(c).duration, MOST_REVOLUTIONS * float(periods.max()))
    step = float(periods.min()) / A_REVOLUTION
    most = max(MOST_NUMBERS // (3 * c.size), 4)
    samples = min(int(np.ceil(duration / step)) + 1, most)
    duration = min(duration, step * (samples - 1))
    times = np.linspace(0.0, duration, samples)
    path = np.moveaxis(positions_mcmf(c, times, design.motion), 0, 1) / KM
    return {
        "names": list(c.satellite_names),
        "groups": [n % len(CYCLE) for n in _planes(design)],
        "sky": [_css(colour) for colour in _LIGHT],
        "path": packed(path.astype("<f4")),
        "samples": samples,
        "step_s": float(times[1]),
        "duration_s": duration,
        "periods_s": periods.tolist(),
        "spin_rad_s": MARS_ROTATION_RATE.value,
        "meridian_rad": float(prime_meridian_angle(c.epoch)),
        "equatorial_km": figure.equatorial_radius / KM,
        "polar_km": figure.polar_radius / KM,
        "mask_deg": float(np.degrees(design.mask.highest)),
        "fold": design.fold,
        "stations": [
            {
                "name": site.name,
                "latitude_deg": float(np.degrees(site.latitude)),
                "longitude_deg": float(np.degrees(site.longitude)),
                "height_km": site.height / KM,
                "mask_deg": float(np.degrees(site.mask.highest)),
            }
            for site in design.stations
        ],
        "gaps": _gaps(design),
        "places": [(p.name, p.latitude_deg, p.longitude_deg) for p in PLACES if not p.landing],
        "relief": packed(np.rint(255 * shade()).astype(np.uint8)),
        "count_colours": [_rgb(x) for x in count_colours(design.fold, MOST_COUNTED)[: c.size + 1]],
        "shades": [_rgb(x) for x in colormaps["magma_r"](np.linspace(0, 1, 40))],
        "none": _GREY,
        "fields": [_field(name) for name in ("gdop", *(ERRORS if design.signal else ()))],
        "worth": worth(design, duration),
    }


#: Colours of the planes on a dark sky, in the order of `CYCLE`, lighter.
_LIGHT = tuple(tuple(0.45 + 0.55 * x for x in to_rgb(colour)) for colour in CYCLE)
_GREY = [138, 143, 152]


def _field(name: str) -> dict[str, Any]:
    """What a dilution or an error is called, and the colours that all pictures of it share."""
    told = quantity(name)
    return {
        "name": name,
        "title": told.title,
        "unit": told.shown_unit,
        "range": told.limits,
        "ticks": told.ticks,
    }


def _planes(design: Design) -> list[int]:
    """Plane of every satellite; each its own where there are none."""
    pattern = design.constellation.pattern
    each = 1 if pattern is None else pattern.per_plane
    return [k // each for k in range(design.constellation.size)]


def _gaps(design: Design) -> list[dict[str, Any]]:
    """Gap polygons of every plane at the epoch, inertial, and how fast they turn about its axis."""
    c, pattern = design.constellation, design.constellation.pattern
    if pattern is None or design.motion.model != "two-body":
        return []
    geometry = gap(
        float(c.semi_major_axis[0]),
        design.figure.equatorial_radius,
        pattern.per_plane,
        design.mask.highest,
    )
    if geometry is None:
        return []
    u = positions_mci(c, [0.0])[:, 0] / c.semi_major_axis[:, np.newaxis]
    gaps = []
    for first in range(0, c.size, pattern.per_plane):
        axis = np.cross(u[first], u[first + 1])
        axis /= np.linalg.norm(axis)
        for pole in (axis, -axis):
            outline = gap_outline(u[first], pole, geometry, 16)
            closed = np.round(np.vstack([outline, outline[:1]]), 5)
            gaps.append(
                {
                    "pole": axis.tolist(),
                    "outline": closed.tolist(),
                    "rate_rad_s": float(c.mean_motion[first]),
                }
            )
    return gaps


def _rgb(colour: Any) -> list[int]:
    return [round(255 * x) for x in to_rgb(colour[:3] if not isinstance(colour, str) else colour)]


def _css(colour: tuple[float, ...]) -> str:
    return f"rgb({','.join(str(round(255 * x)) for x in colour)})"
