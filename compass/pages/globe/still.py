"""The globe's still picture: satellites in view at the epoch, on a map."""

import numpy as np

from compass.coverage.gap import gap_polygons
from compass.coverage.grid import make_grid
from compass.coverage.maps import coverage_map
from compass.coverage.view import view
from compass.design import Design
from compass.document.blocks import Picture
from compass.orbits import positions_mcmf
from compass.pictures.maps import map_figure
from compass.pictures.style import picture


def still_picture(design: Design, step_deg: float = 2.0) -> Picture:
    """Draw how many satellites every place sees at the epoch, and the gap polygons."""
    c, sphere = design.constellation, design.figure.equatorial_radius
    seen = view(c, [0.0], sphere, design.mask, design.motion)
    grid = make_grid("equal-angle", step_deg, design.figure.polar_radius / sphere)
    counts = coverage_map(seen, grid).count_min.values
    shapes = (
        []
        if c.pattern is None
        else gap_polygons(c, positions_mcmf(c, [0.0])[:, 0], sphere, design.mask.lowest)
    )
    at = seen.directions[0]
    figure = map_figure(
        counts,
        grid,
        "Satellites in view at the epoch",
        "satellites in view",
        figure_name=design.figure.name,
        scale="counts",
        wanted=design.fold,
        shapes=shapes,
        satellites=(
            np.degrees(np.arctan2(at[:, 1], at[:, 0])),
            np.degrees(np.arcsin(np.clip(at[:, 2], -1, 1))),
        ),
    )
    outlined = " White: where no satellite of one plane is in view." if shapes else ""
    return picture(
        figure,
        "count-epoch",
        "Satellites in view at the epoch",
        f"Stars: satellites at the zenith.{outlined}",
        alt=f"Map of Mars: from {counts.min()} to {counts.max()} satellites in view at the epoch.",
    )
