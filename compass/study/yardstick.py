"""A design beside which a study's candidates are put, pattern or not."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from compass.core.gdop import dops_over
from compass.coverage.certificate import prove_fold
from compass.coverage.grid import make_grid
from compass.coverage.in_view import mean_in_view
from compass.coverage.margin import highest_mask
from compass.coverage.symmetry import Span, shortest_span
from compass.coverage.view import view
from compass.design import Design
from compass.inputs.study import Study
from compass.orbits import Constellation
from compass.quantities.merits import MERITS
from compass.quantities.percentile import percentile
from compass.study.area_figures import of_areas
from compass.study.bounds import BOUNDED, LEVELS, bracketed_figures, ends, globe_bounds
from compass.study.candidates import PATTERNS, ROW
from compass.study.choice import brackets_of, half_brackets, notation
from compass.study.draw_bounds import drawn_figures, half_widths
from compass.study.draws import MOST_DRAWS, drawn_fixes, judging_more
from compass.study.lasting import proven_days
from compass.study.pattern_errors import errors_over
from compass.study.pattern_judging import entries_of, judged
from compass.study.pattern_map import places
from compass.study.requirement_figures import settled
from compass.study.sampling import doubtful, finer, map_errors
from compass.study.stages import evaluate

#: Moments at which the geometry of orbits that are no pattern is sampled; a prime number meets
#: moments of symmetry least often.
EPOCHS = 127

#: How near bounds of its geometry come.
NEAR = "bounds-2"


@dataclass(frozen=True)
class Yardstick:
    """A design to compare with, and its figures of merit.

    Attributes
    ----------
    design
        As given in its file.
    mask_deg
        Mask under which it is compared, degrees.
    figures
        By name; nan where its orbits are no pattern of equal circles and the figure is of those.
    errors
        By how much those that are sampled over area and time may be off; half the width of those
        between bounds.
    brackets
        Proven bounds, of those that have them.
    """

    design: Design
    mask_deg: float
    figures: dict[str, float]
    errors: dict[str, float] = field(default_factory=dict)
    brackets: dict[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def role(self) -> str:
        """What to call it."""
        return self.design.name

    @property
    def constellation(self) -> Constellation:
        """Its orbits."""
        return self.design.constellation

    @property
    def kind(self) -> str:
        """Of pattern."""
        pattern = self.constellation.pattern
        return "elements" if pattern is None else pattern.kind

    @property
    def notation(self) -> str:
        """Pattern and orbit in short."""
        return notation(self.constellation)

    @property
    def variables(self) -> dict[str, float]:
        """What it is, where that can be said as of a candidate; else nan."""
        c, nan = self.constellation, float("nan")
        common = np.ptp(c.inclination) == 0, c.is_circular and np.ptp(c.semi_major_axis) == 0
        return {
            "satellites": float(c.size),
            "planes": self.figures["planes"],
            "phasing": nan if c.pattern is None else float(c.pattern.phasing),
            "inclination_deg": float(np.degrees(c.inclination[0])) if common[0] else nan,
            "radius_km": float(c.semi_major_axis[0]) / 1e3 if common[1] else nan,
            "mask_deg": self.mask_deg,
        }


def yardstick(study: Study) -> Yardstick | None:
    """Put the design to compare with through every stage; None if the study names none.

    Under the study's figure, fold and first mask. A pattern of equal circles goes the way of the
    candidates; the fold and the margin of other orbits are of the time that `shortest_span` gives.
    """
    if study.compare is None:
        return None
    mask = compared_mask_deg(study)
    find = _as_candidate if study.compare.constellation.pattern is not None else _by_itself
    known, errors = find(study, study.compare.constellation, mask)
    brackets = brackets_of(study, known)
    figures = dict.fromkeys(MERITS, float("nan")) | known
    figures |= {name: 0.5 * (low + high) for name, (low, high) in brackets.items()}
    return Yardstick(study.compare, mask, figures, errors | half_brackets(brackets), brackets)


def compared_mask_deg(study: Study) -> float:
    """Mask under which the design to compare with is judged: the study's first, degrees."""
    mask = study.space.mask_deg
    return mask[0] if isinstance(mask, tuple) else mask.least


def _as_candidate(
    study: Study, c: Constellation, mask_deg: float
) -> tuple[dict[str, float], dict[str, float]]:
    """Figures of a pattern and errors of sampling, by the functions that sort the candidates."""
    pattern = c.pattern
    assert pattern is not None
    rows = np.array(
        [
            (
                PATTERNS.index(pattern.kind),
                pattern.satellites,
                pattern.planes,
                pattern.phasing % pattern.planes,
                round(float(np.degrees(pattern.inclination)), 9),
                float(c.semi_major_axis[0]) / 1e3,
                mask_deg,
            )
        ],
        ROW,
    )
    figures: dict[str, float] = {}
    nearer = [NEAR] * bool(bracketed_figures(study)) + [MOST_DRAWS] * bool(drawn_figures(study))
    for stage in (*study.stages, *nearer):
        found = evaluate(stage, study, rows)
        figures |= {name: float(values[0]) for name, values in found.figures.items()}
    errors = {name: float(values[0]) for name, values in map_errors(study, rows).items()}
    return figures, errors | half_widths(study, figures)


def _by_itself(
    study: Study, c: Constellation, mask_deg: float
) -> tuple[dict[str, float], dict[str, float]]:
    """Figures of any orbits and errors of sampling, by the functions for one constellation."""
    sphere, mask = study.figure.equatorial_radius, float(np.radians(mask_deg))
    span = shortest_span(c)
    outcome = prove_fold(c, study.fold, sphere_radius=sphere, mask=mask, span=span).outcome
    margin = highest_mask(c, study.fold, sphere_radius=sphere, span=span)
    si, ci = np.sin(c.inclination), np.cos(c.inclination)
    poles = np.stack([si * np.sin(c.raan), -si * np.cos(c.raan), ci], axis=1)
    figures = {
        "satellites": float(c.size),
        # told apart by their poles: a node of the equator is any, and 0 is 360 degrees
        "planes": float(len(np.unique(np.round(poles, 9) + 0.0, axis=0))),
        "fold_proven": {"proven": 1.0, "refuted": 0.0}.get(outcome, float("nan")),
        "mask_margin_deg": float("nan") if margin is None else float(np.degrees(margin)),
    }
    geometry, *closer = [
        {name: np.array(value) for name, value in _geometry(one, c, mask, span).items()}
        for one in (study, *finer(study))
    ]
    figures |= {name: float(value) for name, value in geometry.items()}
    errors = {name: float(value) for name, value in doubtful(geometry, closer).items()}
    level = LEVELS[NEAR]
    for name in bracketed_figures(study):
        if name in BOUNDED:
            pair = globe_bounds(level, study, name, figures[name], c, mask)
            figures |= dict(zip(ends(name), pair, strict=True))
    if "areas" in study.stages:
        figures |= of_areas(study, c, mask, level)
    if study.requirements:
        figures |= settled(study, c, mask)
    if "orbits" in study.stages:
        days = study.orbits.days
        figures["days_proven"] = proven_days(c, study.fold, days, study.figure, mask, study.motion)
    if study.entry is not None:
        more = judging_more(MOST_DRAWS, study) if drawn_figures(study, "entry") else study
        figures |= judged(more, entries_of(more), c, mask_deg)
    if drawn_figures(study, "map"):
        figures |= drawn_fixes(MOST_DRAWS, study, c, mask_deg, (span.start, span.stop))
    return figures, errors | half_widths(study, figures)


def _geometry(study: Study, c: Constellation, mask: float, span: Span) -> dict[str, float]:
    """Geometry over area and time, with north and south each for itself as a zone."""
    times = span.start + (span.stop - span.start) * (np.arange(EPOCHS) + 0.5) / EPOCHS
    r = view(c, times, study.figure.equatorial_radius).r

    def over(kind: str) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
        where = places(kind, study.map.step_deg)
        fold = np.empty((EPOCHS, len(where)), np.int64)
        gdop, pdop = np.empty(fold.shape), np.empty(fold.shape)
        dops_over(r, where, 1.0, np.sin(mask), fold, gdop, pdop)
        return fold, gdop, pdop

    _, gdop, pdop = over("equal-area")
    columns = make_grid("equal-angle", study.map.step_deg).columns
    zones = over("equal-angle")[1].reshape(EPOCHS, -1, columns)
    return {
        "gdop_p50": float(percentile(gdop, 50)),
        "gdop_p95": float(percentile(gdop, 95)),
        "gdop_p95_zone": float(max(percentile(zones[:, k], 95) for k in range(zones.shape[1]))),
        "pdop_p95": float(percentile(pdop, 95)),
        "availability": float((pdop <= study.map.pdop_max).mean()),
        "count_mean": mean_in_view(c, study.figure.equatorial_radius, mask),
        **errors_over(study, c, float(np.degrees(mask)), times),
    }
