"""The numbers of a design, named with their units, for tables and JSON alike."""

from typing import Any

import numpy as np

from compass.coverage.cap import cap, published_cap_area
from compass.coverage.geometry import Geometry
from compass.document.blocks import Table
from compass.frames import J2000
from compass.inputs import Design
from compass.orbits import Constellation, orbital_period, repeat_period

KM, KM2 = 1e3, 1e6


def constellation_facts(design: Design) -> dict[str, Any]:
    """What the design is, keyed by name with unit."""
    from datetime import timedelta

    c, pattern = design.constellation, design.constellation.pattern
    repeat = repeat_period(c)
    facts: dict[str, Any] = {
        "name": design.name,
        "pattern": pattern.kind if pattern else "elements",
        "satellites": c.size,
    }
    if pattern:
        facts |= {
            "notation": pattern.notation,
            "planes": pattern.planes,
            "satellites_per_plane": pattern.per_plane,
            "phasing": pattern.phasing,
            "raan_spacing_deg": float(np.degrees(pattern.node_spread / pattern.planes)),
            "phase_step_deg": 360.0 * pattern.phasing / pattern.satellites,
            "inclination_deg": float(np.degrees(pattern.inclination)),
            "radius_km": float(c.semi_major_axis[0]) / KM,
            "altitude_km": (float(c.semi_major_axis[0]) - design.figure.equatorial_radius) / KM,
            "period_h": float(orbital_period(c.semi_major_axis[0], c.gm)) / 3600,
        }
        if pattern.multiplier is not None:
            facts["multiplier"] = str(pattern.multiplier)
    return facts | {
        "repeat_sidereal_days": repeat.sidereal_days,
        "repeat_revolutions": repeat.revolutions,
        "repeat_miss_deg": float(np.degrees(repeat.closure)),
        "epoch_tdb": (J2000 + timedelta(seconds=c.epoch)).isoformat(),
        "figure": design.figure.title,
        "mask_deg": float(np.degrees(design.mask.lowest)),
        "wanted_fold": design.fold,
    }


def geometry_facts(geometry: Geometry) -> dict[str, Any]:
    """Cap, gap, plane and totals; ``gap`` and ``plane`` are None where there are no polygons."""
    c, g = geometry.cap, geometry.gap
    published = published_cap_area(c)
    facts: dict[str, Any] = {
        "cap": {
            "half_cone_deg": float(np.degrees(c.half_cone)),
            "half_arc_deg": float(np.degrees(c.half_arc)),
            "tangent_km": c.tangent / KM,
            "radius_km": c.radius / KM,
            "depth_km": c.depth / KM,
            "arc_km": c.arc / KM,
            "area_km2": {"exact": c.area / KM2, "published": published / KM2},
            "fraction": {"exact": c.fraction, "published": published / geometry.sphere_area},
        },
        "gap": None,
        "plane": None,
        "totals": {
            "sphere_area_km2": geometry.sphere_area / KM2,
            "served_area_km2": {
                "exact": geometry.total_area / KM2,
                "published": geometry.published_total_area / KM2,
            },
            "served_fraction": {
                "exact": geometry.total_area / geometry.sphere_area,
                "published": geometry.published_total_area / geometry.sphere_area,
            },
        },
    }
    if g is None:
        return facts
    facts["gap"] = {
        "sides": g.sides,
        "depth_km": g.depth / KM,
        "base_km": g.base / KM,
        "area_km2": {"flat": g.flat_area / KM2, "exact": g.area / KM2},
        "fraction": g.fraction,
        "vertex_deg": float(np.degrees(g.vertex)),
        "limit_circumference_km": geometry.planes * g.base / KM,
        "circumference_km": {
            "exact": (geometry.circumference or 0.0) / KM,
            "published": (geometry.published_circumference or 0.0) / KM,
        },
    }
    facts["plane"] = {
        "served_area_km2": (geometry.plane_area or 0.0) / KM2,
        "served_fraction": (geometry.plane_area or 0.0) / geometry.sphere_area,
        "gap_area_km2": 2 * g.area / KM2,
    }
    if geometry.neighbour_overlap is not None:
        facts["plane"]["neighbour_overlap_km2"] = geometry.neighbour_overlap / KM2
    facts["totals"] |= {
        "gaps": 2 * geometry.planes,
        "gap_area_km2": 2 * geometry.planes * g.area / KM2,
        "gap_fraction": 2 * geometry.planes * g.fraction,
    }
    return facts


def satellite_table(constellation: Constellation, sphere_radius: float) -> Table:
    """Elements of every satellite, with the caps at its lowest and highest."""
    c = constellation
    rows = []
    for k in range(c.size):
        low = cap(float(c.periapsis_radius[k]), sphere_radius)
        high = cap(float(c.apoapsis_radius[k]), sphere_radius)
        rows.append(
            (
                c.satellite_names[k],
                float(c.periapsis_radius[k] - sphere_radius) / KM,
                float(c.apoapsis_radius[k] - sphere_radius) / KM,
                float(c.eccentricity[k]),
                float(np.degrees(c.inclination[k])),
                float(np.degrees(c.raan[k])),
                float(orbital_period(c.semi_major_axis[k], c.gm)) / 3600,
                float(np.degrees(low.half_arc)),
                float(np.degrees(high.half_arc)),
            )
        )
    header = (
        "satellite",
        "periapsis altitude km",
        "apoapsis altitude km",
        "eccentricity",
        "inclination deg",
        "RAAN deg",
        "period h",
        "cap at periapsis deg",
        "cap at apoapsis deg",
    )
    return Table("Orbits and horizon caps", header, tuple(rows))
