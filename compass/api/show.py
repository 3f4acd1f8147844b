"""The analytic geometry of a design: caps, gaps, totals; published against exact."""

from dataclasses import dataclass, field
from datetime import timedelta
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.api.given import given_in_metres
from compass.api.reproduce import comparison_table
from compass.api.results import Result
from compass.api.show_signal import signal_blocks, signal_facts
from compass.arguments import checked
from compass.coverage.cap import cap, published_cap_area
from compass.coverage.geometry import Geometry, pattern_geometry
from compass.design import Design
from compass.document import Page, Proven, Sentence, Table, Value, Verdict
from compass.document.blocks import Block, columns, facts, values
from compass.document.plain import plain
from compass.frames import J2000
from compass.orbits import Constellation, orbital_period, repeat_period
from compass.orbits.kinds import kind_of
from compass.papers.verdict import Row
from compass.quantities import quantity
from compass.units import KM, KM2
from compass.words import counted

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, repr=False)
class ShowResult(Result):
    """What a design is, and its geometry from formulas alone.

    Attributes
    ----------
    design
        What was asked about.
    geometry
        Cap and gaps of a symmetric pattern, or None for explicit elements.
    comparison
        Numbers of the design's source paper beside the exact ones.
    """

    design: Design = field(repr=False)
    geometry: Geometry | None
    comparison: tuple[Row, ...]

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        facts: dict[str, Any] = {"constellation": constellation_facts(self.design)}
        facts |= geometry_facts(self.geometry) if self.geometry else {"cap": None, "gap": None}
        if self.design.signal is not None:
            facts["signal"] = signal_facts(self.design)
        known = "of circular orbits over a sphere, in closed form"
        return plain(
            facts
            | {"evidence": str(Proven(known))}
            | {"comparison": [row.as_dict() for row in self.comparison]}
        )

    def document(self) -> Page:
        """What it is in a sentence, its facts, caps and gaps, published against exact."""
        blocks: list[Block] = [
            Verdict("", self._in_a_sentence()),
            self.constellation_table(),
            *self.geometry_tables(),
            *(Sentence(note) for note in self.notes()),
            *signal_blocks(self.design),
        ]
        if self.comparison:
            title = f"Published ({self.design.paper}) against exact"
            blocks.append(comparison_table(title, self.comparison))
        return Page(self.design.name, tuple(blocks))

    def _in_a_sentence(self) -> str:
        words = self.design.constellation.words
        if self.geometry is None:
            return words
        share = Value(quantity("cap.fraction"), self.geometry.cap.fraction)
        return f"{words}; each sees {share} % of Mars"

    def plot(self, *, axes: "Axes | None" = None) -> "Axes":
        """Draw where the satellites stand: node against mean argument of latitude.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.style import CYCLE, axes_or_new, look

        c, drawn = self.design.constellation, axes_or_new(axes, 6.0, 5.0)
        along = np.mod(np.degrees(c.argument_of_periapsis + c.mean_anomaly), 360.0)
        with look():
            drawn.plot(np.mod(np.degrees(c.raan), 360.0), along, "o", color=CYCLE[0])
            drawn.set(
                xlabel="node, deg", ylabel="mean argument of latitude, deg",
                title=self.design.name, xlim=(-10.0, 370.0), ylim=(-10.0, 370.0),
                xticks=range(0, 361, 60), yticks=range(0, 361, 60),
            )  # fmt: skip
            drawn.grid(alpha=0.3)
        return drawn

    def constellation_table(self) -> Table:
        """What the design is."""
        known = constellation_facts(self.design) | {"pattern": _kind(self.design)}
        del known["name"]
        return facts("The constellation", values("constellation", known))

    def geometry_tables(self) -> tuple[Table, ...]:
        """Cap, gap, plane and totals of a pattern; of explicit elements each satellite's caps."""
        if self.geometry is None:
            radius = self.design.figure.equatorial_radius
            return (satellite_table(self.design.constellation, radius),)
        groups = geometry_facts(self.geometry).items()
        return tuple(
            facts(_TITLES[group], values(group, known)) for group, known in groups if known
        )

    def notes(self) -> tuple[str, ...]:
        """What is not there, and why."""
        if self.geometry is None:
            return ("explicit elements: each satellite has its own cap, and planes have no gaps",)
        notes = []
        if self.geometry.gap is None:
            notes.append(no_gap_reason(self.geometry.per_plane, self.geometry.closes))
        if not self.design.mask.is_constant:
            notes.append("the mask changes with azimuth: caps are those of its lowest elevation")
        return tuple(notes)


@checked
def show(design: Design | str | Path) -> ShowResult:
    """Analytic geometry of a design: caps, gaps, totals; published against exact.

    Parameters
    ----------
    design
        A design, or the path of its file.

    Raises
    ------
    DesignError
        The design is not allowed.

    Examples
    --------
    >>> import compass
    >>> found = compass.show("designs/compass-15-5-1.toml")
    >>> round(found.geometry.cap.fraction, 5)
    0.41687
    """
    read = given_in_metres(design)
    geometry = pattern_geometry(read.constellation, read.figure.equatorial_radius, read.mask.lowest)
    rows: tuple[Row, ...] = ()
    if read.paper and geometry:
        paper = import_module(f"compass.papers.{read.paper}_geometry")
        rows = tuple(paper.geometry_rows(geometry))
    return ShowResult(read, geometry, rows)


_TITLES = {
    "cap": "Cap of one satellite",
    "gap": "Gap of one plane",
    "plane": "One plane",
    "totals": "All planes",
}


def no_gap_reason(per_plane: int, closes: bool) -> str:
    """Say why a plane has no gap polygons."""
    if not closes:
        return (
            f"no gap polygons: the caps of {counted(per_plane, 'satellite')} a plane do not meet, "
            "so each plane leaves one region uncovered that runs from pole to pole between them"
        )
    return f"no gap polygons: a polygon needs three satellites a plane, this has {per_plane}"


def _kind(design: Design) -> str:
    """What gives the orbits: a kind of pattern, elements, or a table of states."""
    if design.constellation.pattern is not None:
        return kind_of(design.constellation.pattern.kind).title
    table = design.motion.model == "ephemeris"
    return "none: states over time" if table else "none: elements of each satellite"


def constellation_facts(design: Design) -> dict[str, Any]:
    """What the design is, keyed by name with unit."""
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


def _turned(angle: float) -> float:
    """An angle in degrees within a turn, to what a state in metres can tell."""
    return round(float(np.degrees(angle)), 7) % 360.0


def satellite_table(constellation: Constellation, sphere_radius: float) -> Table:
    """Elements of every satellite, with the caps at its lowest and highest."""
    c = constellation
    rows = []
    for k in range(c.size):
        low = cap(float(c.periapsis_radius[k]), sphere_radius)
        high = cap(float(c.apoapsis_radius[k]), sphere_radius)
        known = {
            "periapsis_altitude_km": float(c.periapsis_radius[k] - sphere_radius) / KM,
            "apoapsis_altitude_km": float(c.apoapsis_radius[k] - sphere_radius) / KM,
            # to what a state in metres can tell: beyond it is rounding
            "eccentricity": round(float(c.eccentricity[k]), 9),
            "inclination_deg": _turned(c.inclination[k]),
            "raan_deg": _turned(c.raan[k]),
            "argument_of_periapsis_deg": _turned(c.argument_of_periapsis[k]),
            "mean_anomaly_deg": _turned(c.mean_anomaly[k]),
            "period_h": float(orbital_period(c.semi_major_axis[k], c.gm)) / 3600,
            "cap_at_periapsis_deg": float(np.degrees(low.half_arc)),
            "cap_at_apoapsis_deg": float(np.degrees(high.half_arc)),
        }
        rows.append(values("satellite", known))
    table = columns("Orbits and horizon caps", rows)
    named = tuple((name, *row) for name, row in zip(c.satellite_names, table.rows, strict=True))
    return Table(table.title, ("satellite", *table.header), named)
