"""What the same constellation is worth to users on the surface."""

from typing import Any

import numpy as np

from compass.coverage.certificate import prove_fold
from compass.coverage.gdop import gdop_percentile, gdop_share
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
    gdop_max: float = 6.0,
    seed: int = 1,
) -> dict[str, Any]:
    """Exact fold, mask margin, GDOP percentiles and the share below a limit, as plain values.

    Parameters
    ----------
    constellation
        The orbits, in two-body motion.
    fold
        Satellites to be in view at once.
    figure, mask
        Fold and margin are proven on it, GDOP is sampled on the sphere of its equatorial radius;
        of a mask that depends on azimuth the highest elevation counts, which is on the safe side.
    gdop_max
        Limit of the share.
    seed
        Of the points at which GDOP is sampled.

    Returns
    -------
    dict
        ``fold``: wanted, and whether it is proven for all time (`prove_fold`);
        ``mask_margin_deg``: the highest mask with that fold, None if no mask has it; ``gdop``:
        p50 and p95 over area and time; ``gdop_share``: share of them with GDOP at most
        `gdop_max`; ``gdop_error``, ``gdop_share_error``: their standard errors, for they are
        sampled.
    """
    sphere, high = figure.equatorial_radius, mask.highest
    span = shortest_span(constellation)
    claim: dict[str, Any] = {"sphere_radius": sphere, "stretch": figure.stretch, "span": span}
    certificate = prove_fold(constellation, fold, mask=high, **claim)
    margin = highest_mask(constellation, fold, **claim)
    dop = {
        f"p{percent}": gdop_percentile(
            constellation, percent, sphere_radius=sphere, mask=high, span=span, seed=seed
        )
        for percent in (50, 95)
    }
    available = gdop_share(
        constellation, gdop_max, sphere_radius=sphere, mask=high, span=span, seed=seed
    )
    return {
        "fold": {"wanted": fold, "outcome": certificate.outcome},
        "mask_margin_deg": None if margin is None else float(np.degrees(margin)),
        "gdop": {name: estimate.value for name, estimate in dop.items()},
        "gdop_error": {name: estimate.error for name, estimate in dop.items()},
        "gdop_share": available.value,
        "gdop_share_error": available.error,
    }
