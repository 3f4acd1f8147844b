"""Proven bounds of the geometry of candidates: only as near as it takes to decide their order."""

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.coverage.areas import Near
from compass.coverage.certified_percentile import BESIDE, certified_percentile
from compass.coverage.certified_question import Asked
from compass.coverage.certified_share import certified_share
from compass.coverage.certified_zone import certified_worst_zone
from compass.coverage.grid import make_grid
from compass.coverage.region import Region, latitude_band
from compass.inputs.study import Study
from compass.orbits import Constellation
from compass.orbits.symmetry import one_circle
from compass.study.area_figures import BETWEEN, area_bounds
from compass.study.candidates import make_constellation
from compass.study.pattern_map import map_figures

#: The one that is of the zone of latitude where it is most.
ZONE = "gdop_p95_zone"

#: Figures of merit that have proven bounds: the dilution, and per cent of area and time below it;
#: None for the share below the study's limit.
BOUNDED: dict[str, tuple[str, float | None]] = {
    "gdop_p50": ("gdop", 50.0),
    "gdop_p95": ("gdop", 95.0),
    ZONE: ("gdop", 95.0),
    "pdop_p95": ("pdop", 95.0),
    "availability": ("pdop", None),
}


#: How near shares come that are only compared.
ANY = 0.2

#: One after the other, each for those that the one before leaves undecided. Boxes and not seconds
#: end them, so that any machine and any number of workers come to the same order.
LEVELS = {
    "bounds-1": Near(2e-2, 0.4, 240_000),
    "bounds-2": Near(2e-3, 0.04, 1_000_000),
    "bounds-3": Near(2e-4, 0.004, 4_000_000),
}

#: Nearer still, for who gives it time: half a minute for a candidate and figure, then minutes.
FINER = {
    "bounds-4": Near(7e-5, 1.4e-3, 8_000_000),
    "bounds-5": Near(2e-5, 4e-4, 24_000_000),
    "bounds-6": Near(7e-6, 1.4e-4, 64_000_000),
}

#: How near the stage of areas comes.
AREAS_NEAR = LEVELS["bounds-1"]


def ends(figure: str) -> tuple[str, str]:
    """Names of the columns of a figure's bounds; a requirement's share is its lower one itself."""
    if figure.startswith("requirement_") and figure.endswith("_share"):
        return figure, f"{figure}_most"
    return f"{figure}_low", f"{figure}_high"


def bound_columns(study: Study, near: Near | None = None) -> tuple[str, ...]:
    """Columns that all levels store, or one does: of areas those that it brings nearer."""
    return tuple(name for figure in (*BOUNDED, *_nearer(study, near)) for name in ends(figure))


def _nearer(study: Study, near: Near | None) -> list[str]:
    """Figures of areas that the study names; none where their stage has been so near already."""
    return [figure for figure in BETWEEN if figure in study.named and near != AREAS_NEAR]


def bounded_figures(study: Study) -> list[str]:
    """Figures that the study sorts by or limits, and that levels bring nearer."""
    return [figure for figure in (*BOUNDED, *BETWEEN) if figure in study.named]


def bracketed_figures(study: Study) -> list[str]:
    """Figures whose bounds say where they are: those sorted by, of areas all, and shares.

    Of those only limited it is told on which side they are, and their value is sampled.
    """
    shares = [name for name in study.named if ends(name)[0] == name]
    areas = BETWEEN if "areas" in study.stages else ()
    nearer = [name for name in bounded_figures(study) if name in BETWEEN or _sorts(study, name)]
    return [*dict.fromkeys([*nearer, *areas]), *sorted(shares)]


def _sorts(study: Study, figure: str) -> bool:
    """Whether the study sorts by a figure."""
    return figure in {objective.figure for objective in study.objectives}


def limited_figures(study: Study) -> list[str]:
    """Figures of the globe that the study limits, and that have proven bounds."""
    return [figure for figure in BOUNDED if _limits(study, figure)]


def bounds(level: Near, study: Study, rows: NDArray) -> dict[str, NDArray[np.float64]]:
    """Bounds of what a study asks of geometry, shape (n,) each; nan where it does not.

    For all area and all time, on the study's figure; a share holds whatever the turn of Mars.
    The search for them begins at what is sampled, and a limit of the study's between them is
    looked at itself. What is only limited comes first: of one that breaks a limit for sure, what
    the study sorts by is not looked for.
    """
    found = {name: np.full(rows.size, np.nan) for name in bound_columns(study, level)}
    everywhere = [figure for figure in bounded_figures(study) if figure in BOUNDED]
    everywhere.sort(key=lambda figure: _sorts(study, figure))
    areas = _nearer(study, level)
    sampled = map_figures(study, rows) if everywhere else {}
    for k, row in enumerate(rows):
        c, mask = make_constellation(row), float(np.radians(row["mask_deg"]))
        for figure in everywhere:
            pair = globe_bounds(level, study, figure, float(sampled[figure][k]), c, mask)
            for end, bound in zip(ends(figure), pair, strict=True):
                found[end][k] = bound
            limits = [limit for limit in study.constraints if limit.figure == figure]
            if not all(any(map(limit.holds, pair)) for limit in limits):
                break
        for figure, pair in area_bounds(study, row, areas, level).items() if areas else ():
            for end, bound in zip(ends(figure), pair, strict=True):
                found[end][k] = bound
    return found


def globe_bounds(
    level: Near, study: Study, figure: str, sampled: float, c: Constellation, mask: float
) -> tuple[float, float]:
    """Bounds of one figure of a constellation above a mask, radians, near what is sampled."""
    dop, percent = BOUNDED[figure]
    limits = _limits(study, figure)
    asked: Asked = {"dop": dop, "figure": study.figure, "mask": mask}
    if percent is None:
        width = level.width if _sorts(study, figure) else ANY
        share = certified_share(
            c,
            study.map.pdop_max,
            width=width,
            budget_boxes=level.boxes,
            against=limits,
            **asked,
        )
        return share.low, share.high
    if figure != ZONE and not _sorts(study, figure):
        return _beside(level, limits, percent, sampled, c, asked)
    options: dict[str, Any] = {
        "guess": sampled, "precision": level.precision, "budget_boxes": level.boxes,
        "limits": limits,
    }  # fmt: skip
    if figure == ZONE:
        found = certified_worst_zone(c, percent, _zones(study, c), **options, **asked)
    else:
        found = certified_percentile(c, percent, **options, **asked)
    return found.low, found.high


def _beside(
    level: Near,
    limits: list[float],
    percent: float,
    sampled: float,
    c: Constellation,
    asked: Asked,
) -> tuple[float, float]:
    """Bounds of a percentile that say on which side of some limits it is, and no more."""
    low, high, part = 0.0, np.inf, percent / 100.0
    for limit in limits:
        # a bound that is the limit itself does not tell whether it is below or at most that
        sides = [limit * (1.0 - BESIDE), limit * (1.0 + BESIDE)]
        for at in sides if sampled < limit else sides[::-1]:
            if low < at < high:
                share = certified_share(
                    c, at, width=ANY, budget_boxes=level.boxes, against=[part], **asked
                )
                low = at if share.high < part else low
                high = at if share.low >= part else high
    return low, high


def _zones(study: Study, c: Constellation) -> list[Region]:
    """Zones of latitude, as wide as the rows that are sampled.

    One of each pair north and south where both see alike, as of circles of one size.
    """
    grid = make_grid("equal-angle", study.map.step_deg)
    rows = (grid.rows + 1) // 2 if one_circle(c) else grid.rows
    edges = grid.latitude_edges[: rows + 1]
    return [latitude_band(south, north) for south, north in pairwise(edges.tolist())]


def _limits(study: Study, figure: str) -> list[float]:
    """Ends of what a study allows of a figure."""
    ends = [end for c in study.constraints if c.figure == figure for end in (c.low, c.high)]
    return [end for end in ends if np.isfinite(end)]
