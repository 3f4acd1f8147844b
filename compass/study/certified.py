"""What a map's figures over all area and time are for sure: brackets beside the samples."""

import os
from collections.abc import Sequence

from compass.coverage.certified_geometry import CertifiedGeometry, certified_geometry
from compass.design import Design
from compass.study.mapping import MapOptions, option_mask


def certified_figures(
    design: Design,
    options: MapOptions,
    workers: int | None = None,
    *,
    percents: Sequence[int] = (95,),
) -> CertifiedGeometry | None:
    """Bracket a map's figures over the whole surface; None for motions that have no bounds yet.

    For all time where the motion repeats up to a turn of the figure, else over the map's period
    from the epoch on.

    Parameters
    ----------
    design, options, workers
        As of `compass.study.mapping.make_map`.
    percents
        Which percentiles of GDOP.
    """
    motion = design.motion.or_of(options.motion)
    if not motion.is_closed_form or not design.constellation.size:
        return None
    if options.start_day or options.pdop_max < 1.0:
        return None
    hours = options.duration_h
    return certified_geometry(
        design.constellation,
        figure=design.figure,
        mask=design.mask if options.mask_deg is None else option_mask(options.mask_deg),
        pdop_max=options.pdop_max,
        percents=percents,
        duration=None if hours is None else hours * 3600.0,
        motion=motion,
        worst=True,
        workers=workers or os.cpu_count() or 1,
    )
