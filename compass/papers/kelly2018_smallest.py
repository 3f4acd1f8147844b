"""Kelly and Bevilacqua 2018: whether 15 satellites are the fewest, by proof and search."""

import numpy as np

from compass.coverage.certificate import fold_range, prove_fold
from compass.coverage.margin import covering_radius, highest_mask
from compass.frames import FIGURES
from compass.orbits import walker_delta
from compass.papers.verdict import Erratum, Row, claim, computed
from compass.study.search import search

TITLE = (
    "P. W. Kelly and R. Bevilacqua, Constellation Design for Mars Navigation using Small "
    "Satellites, University of Florida, 2018: continuous coverage and the smallest constellation"
)

#: Radius of the paper's orbits (Table 2), metres.
RADIUS = 20427e3


def rows() -> list[Row]:
    """Rows on continuous fourfold coverage and on the smallest population."""
    figure = FIGURES["kelly2018-sphere"]
    sphere = figure.equatorial_radius
    design = walker_delta(15, 5, 1, inclination_deg=45.0, radius_km=RADIUS / 1e3)
    certificate = prove_fold(design, 4, sphere_radius=sphere)
    least, greatest = fold_range(design, sphere_radius=sphere)
    cap = float(np.degrees(covering_radius(design, 4).radius))
    margin = highest_mask(design, 4, sphere_radius=sphere)
    assert margin is not None
    smaller = search(
        4, 0.0, radius=RADIUS, figure=figure, largest=14, beyond=14, finalists=1, workers=2
    )
    best = smaller[0]
    assert best.constellation.pattern is not None
    notation = best.constellation.pattern.notation
    return [
        claim(
            "continuous fourfold coverage of the whole sphere: proven, fold, smallest cap radius",
            "Section IV",
            "at least 4 in view everywhere",
            (certificate.outcome == "proven", least[0], greatest[1], cap),
            "deg",
            "proven, 4 or more",
            lambda proven, least, *_: proven == 1 and least >= 4,
            shown="{:.0f}; fold {:.0f} to {:.0f}; down to {:.3f}",
        ),
        computed(
            "highest elevation mask with continuous fourfold coverage",
            "-",
            float(np.degrees(margin)),
            "deg",
        ),
        claim(
            "fewest satellites for continuous fourfold coverage at this radius, proven, patterns "
            "of fewer than 15",
            "Section III, goal 2",
            "a minimum of 5 planes with 3 satellites",
            (best.constellation.size, best.proven, len(smaller)),
            "satellites",
            "15 or more",
            lambda fewest, *_: fewest >= 15,
            shown="{:.0f}; {:.0f}; {:.0f}",
            erratum=Erratum(
                f"{notation} has it, up to a mask of {np.degrees(best.mask_margin):.2f} deg",
                shown=lambda fewest, proven, _: fewest < 15 and proven == 1,
            ),
        ),
    ]
