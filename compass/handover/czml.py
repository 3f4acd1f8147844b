"""CZML: the constellation in motion for Cesium and other viewers of globes, on Mars's figure."""

import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.design import Design
from compass.frames import Figure
from compass.handover.instants import iso, utc
from compass.orbits import orbital_period, positions_mcmf
from compass.orbits.motion import AnyMotion

#: Highest degree of the interpolation that viewers are told to use.
DEGREE = 7

# Okabe and Ito's colours, one a plane, told apart by colour-blind readers too.
_COLOURS = ((230, 159, 0), (86, 180, 233), (0, 158, 115), (240, 228, 66), (204, 121, 167))
_SOIL = (168, 92, 60, 255)

_NOTE = (
    "Mars: positions are Mars-fixed metres (frame FIXED), because viewers take INERTIAL for the "
    "inertial axes of the Earth. The entity Mars has the radii of the reference figure: a viewer "
    "of the Earth takes Cesium.Ellipsoid.default = new Cesium.Ellipsoid(...radii) before it is "
    "made. Times are UTC, reckoned from TDB with the leap seconds known in 2017."
)


def czml(design: Design, times: NDArray[np.float64], motion: AnyMotion = "two-body") -> str:
    """Satellites with paths and labels, stations and the ellipsoid as a CZML document.

    Parameters
    ----------
    design
        What to export.
    times
        Seconds after the epoch, increasing, shape (t,).
    motion
        As in `orbits.states_mci`.

    References
    ----------
    AnalyticalGraphicsInc/czml-writer, CZML Guide (wiki pages CZML-Structure and Packet).
    """
    c = design.constellation
    start, stop = (f"{text}Z" for text in iso(utc(c.epoch, times[[0, -1]])))
    samples = np.round(positions_mcmf(c, times, motion), 3)
    since = np.round(times - times[0], 6)
    periods = orbital_period(c.semi_major_axis, c.gm)
    per_plane = 1 if c.pattern is None else c.pattern.per_plane
    position = {
        "referenceFrame": "FIXED",
        "epoch": start,
        "interpolationAlgorithm": "LAGRANGE",
        "interpolationDegree": min(DEGREE, times.size - 1),
    }
    packets = [
        {
            "id": "document",
            "name": design.name,
            "version": "1.0",
            "clock": {
                "interval": f"{start}/{stop}",
                "currentTime": start,
                "multiplier": max(1.0, float(np.round(since[-1] / 60))),  # all of it in a minute
                "range": "LOOP_STOP",
                "step": "SYSTEM_CLOCK_MULTIPLIER",
            },
        },
        _mars(design.figure),
    ]
    for k, name in enumerate(c.satellite_names):
        colour = {"color": {"rgba": [*_COLOURS[k // per_plane % len(_COLOURS)], 255]}}
        packets.append(
            {
                "id": f"satellite/{name}",
                "name": name,
                "availability": f"{start}/{stop}",
                "position": position
                | {"cartesian": np.column_stack([since, samples[k]]).ravel().tolist()},
                "point": {"pixelSize": 8} | colour,
                "label": _label(name),
                "path": {
                    "leadTime": float(periods[k] / 2),
                    "trailTime": float(periods[k] / 2),
                    "resolution": float(np.diff(since).max()),
                    "width": 1.5,
                    "material": {"solidColor": colour},
                },
            }
        )
    for site in design.stations:
        packets.append(
            {
                "id": f"station/{site.name}",
                "name": site.name,
                "position": {
                    "referenceFrame": "FIXED",
                    "cartesian": np.round(site.r_mcmf, 3).tolist(),
                },
                "point": {"pixelSize": 6, "color": {"rgba": [255, 255, 255, 255]}},
                "label": _label(site.name),
            }
        )
    lines = (json.dumps(packet, ensure_ascii=False, allow_nan=False) for packet in packets)
    return "[\n" + ",\n".join(lines) + "\n]\n"


def _mars(figure: Figure) -> dict[str, Any]:
    """Packet of the planet: its figure drawn, and said in numbers."""
    a, b = figure.equatorial_radius, figure.polar_radius
    return {
        "id": "Mars",
        "name": f"Mars: {figure.title}",
        "description": _NOTE,
        "position": {"referenceFrame": "FIXED", "cartesian": [0.0, 0.0, 0.0]},
        "ellipsoid": {
            "radii": {"cartesian": [a, a, b]},
            "material": {"solidColor": {"color": {"rgba": [*_SOIL]}}},
        },
        "properties": {
            "naif_id": {"number": 499},
            "figure": {"string": figure.name},
            "equatorial_radius_m": {"number": a},
            "polar_radius_m": {"number": b},
        },
    }


def _label(text: str) -> dict[str, Any]:
    return {
        "text": text,
        "font": "12px sans-serif",
        "horizontalOrigin": "LEFT",
        "pixelOffset": {"cartesian2": [10, 0]},
        "fillColor": {"rgba": [255, 255, 255, 255]},
    }
