"""Kelly and Bevilacqua 2018: whether 15 satellites are the fewest, by proof and search."""

import numpy as np

from compass.coverage.certificate import fold_range, prove_fold
from compass.coverage.margin import covering_radius, highest_mask
from compass.frames import FIGURES
from compass.orbits import walker_delta
from compass.papers.verdict import Row, judge_claim
from compass.study.search import search

TITLE = (
    "P. W. Kelly and R. Bevilacqua, Constellation Design for Mars Navigation using Small "
    "Satellites, University of Florida, 2018: continuous coverage and the smallest constellation"
)

#: Radius of the paper's orbits (Table 2), metres.
RADIUS = 20427e3


def rows() -> list[Row]:
    """Rows on continuous fourfold coverage and on the smallest population."""
    sphere = FIGURES["kelly2018-sphere"].equatorial_radius
    design = walker_delta(15, 5, 1, inclination_deg=45.0, radius_km=RADIUS / 1e3)
    certificate = prove_fold(design, 4, sphere_radius=sphere)
    least, greatest = fold_range(design, sphere_radius=sphere)
    cap = float(np.degrees(covering_radius(design, 4).radius))
    margin = highest_mask(design, 4, sphere_radius=sphere)
    assert margin is not None
    smaller = search(
        4, 0.0, radius=RADIUS, sphere_radius=sphere, largest=14, finalists=1, workers=2
    )
    best = smaller[0]
    assert best.constellation.pattern is not None
    notation = best.constellation.pattern.notation
    return [
        judge_claim(
            "continuous fourfold coverage of the whole sphere at 0 deg elevation",
            "Section IV",
            "at least 4 in view everywhere",
            f"{certificate.outcome}, fold {least[0]} to {greatest[1]}, down to a cap radius of "
            f"{cap:.3f} deg",
            "",
            certificate.outcome == "proven",
            "a counter-example was found",
        ),
        judge_claim(
            "highest elevation mask with continuous fourfold coverage",
            "not in the paper",
            "none printed",
            float(np.degrees(margin)),
            "deg",
            True,
            "",
        ),
        judge_claim(
            "fewest satellites for continuous fourfold coverage at this radius",
            "Section III",
            "a minimum of 5 planes with 3 satellites",
            f"{best.constellation.size}: {notation}",
            "",
            best.constellation.size >= 15,
            f"{notation} has continuous fourfold coverage with {best.constellation.size} "
            f"satellites ({'proven' if best.proven else 'not proven'}), up to a mask of "
            f"{np.degrees(best.mask_margin):.2f} deg; {len(smaller)} patterns of fewer than 15 do",
        ),
    ]
