"""What the same constellation is worth to users on the surface."""

from typing import Any

import numpy as np

from compass.coverage.certificate import prove_fold
from compass.coverage.certified_geometry import certified_geometry
from compass.coverage.margin import highest_mask
from compass.coverage.symmetry import shortest_span
from compass.frames import Figure
from compass.orbits import Constellation
from compass.sites import Mask


def judge_surface(
    constellation: Constellation,
    *,
    fold: int,
    figure: Figure,
    mask: Mask,
) -> dict[str, Any]:
    """Exact fold, mask margin, availability and percentiles of GDOP, as plain values.

    Parameters
    ----------
    constellation
        The orbits, in two-body motion.
    fold
        Satellites to be in view at once.
    figure, mask
        Everything is proven on it; of a mask that depends on azimuth the highest elevation counts
        for fold and margin, which is on the safe side.

    Returns
    -------
    dict
        ``fold``: wanted, and whether it is proven for all time (`prove_fold`);
        ``mask_margin_deg``: the highest mask with that fold, None if no mask has it;
        ``availability`` and ``gdop`` with p50 and p95, each with its bracket, and ``evidence``
        (`compass.coverage.certified_geometry`).
    """
    sphere, high = figure.equatorial_radius, mask.highest
    span = shortest_span(constellation)
    claim: dict[str, Any] = {"sphere_radius": sphere, "stretch": figure.stretch, "span": span}
    certificate = prove_fold(constellation, fold, mask=high, **claim)
    margin = highest_mask(constellation, fold, **claim)
    geometry = certified_geometry(constellation, figure=figure, mask=mask, percents=(50, 95))
    return {
        "fold": {"wanted": fold, "outcome": certificate.outcome},
        "mask_margin_deg": None if margin is None else float(np.degrees(margin)),
        **geometry.numbers(),
        "evidence": f"between proven bounds, {geometry.scope}",
    }
