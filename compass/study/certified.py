"""What a map's figures are for sure, over all area and time, at sites and in regions."""

import math
from collections.abc import Sequence
from dataclasses import replace

from compass.cores import cores
from compass.coverage.areas import AreaFigures, area_figures, areas_of
from compass.coverage.certified_effort import Effort
from compass.coverage.certified_geometry import CertifiedGeometry, certified_geometry
from compass.coverage.region import GLOBE
from compass.coverage.users import by_horizon, region_users
from compass.design import Design
from compass.frames import SECONDS_PER_DAY
from compass.orbits import repeat_period
from compass.sites import Site
from compass.study.mapping import MapOptions, option_mask

#: Percentiles that are bracketed, as many as are sampled, and of which dilutions: bounds of those
#: in a turning vertical take several times the boxes.
PERCENTS, DILUTIONS = (50, 90, 95, 99), ("gdop", "pdop", "tdop")


def certified_figures(
    design: Design,
    options: MapOptions,
    effort: Effort | None = None,
    folds: Sequence[int] = (),
    found: tuple[int, int] | None = None,
) -> CertifiedGeometry | None:
    """Bracket a map's figures over the whole surface; None where there is nothing to bracket.

    For all time where the motion repeats up to a turn of the figure, else over the map's period.

    Parameters
    ----------
    design, options
        As of `compass.study.mapping.make_map`.
    effort
        How far to go; by default some seconds on all cores.
    folds, found
        As of `certified_geometry`.
    """
    motion, high, beam = design.motion.or_of(options.motion), options.altitude_km, _beam(options)
    if not design.constellation.size:
        return None
    since = options.start_day * SECONDS_PER_DAY
    mask = design.mask if options.mask_deg is None else option_mask(options.mask_deg, high)
    everyone = replace(region_users(GLOBE, design.figure, mask, height=high * 1e3), beam=beam)
    users = by_horizon(everyone, design.constellation, motion)
    hours = options.duration_h
    if hours is None and (since or not motion.is_closed_form):
        hours = repeat_period(design.constellation).duration / 3600.0
    if motion.table is not None and hours is not None:  # no table is asked beyond its end
        hours = min(hours, (motion.table.stop - since) / 3600.0)
    return certified_geometry(
        design.constellation,
        figure=design.figure,
        mask=users.mask,
        beam=users.beam,
        height=users.height,
        pdop_max=options.pdop_max,
        percents=PERCENTS,
        dops=DILUTIONS,
        since=since,
        duration=None if hours is None else hours * 3600.0,
        motion=motion,
        worst=True,
        folds=folds,
        found=found,
        effort=effort or Effort(workers=cores()),
    )


def certified_areas(
    design: Design,
    options: MapOptions,
    sites: Sequence[Site],
    regions: Sequence[str],
    effort: Effort | None = None,
) -> tuple[AreaFigures, ...]:
    """Figures at sites and in regions, as `compass.coverage.areas.area_figures` gives them.

    For ever where that can be said, else over the map's period.

    Parameters
    ----------
    design, options, effort
        As of `certified_figures`.
    sites, regions
        As of a requirement.

    Raises
    ------
    ArgumentError
        Beams of orbits that are no circles.
    """
    if not (sites or regions) or not design.constellation.size:
        return ()
    high = options.altitude_km
    asked = replace(design, motion=design.motion.or_of(options.motion))
    since, hours = options.start_day * SECONDS_PER_DAY, options.duration_h
    period = repeat_period(design.constellation).duration if hours is None else hours * 3600.0
    if asked.motion.table is not None:  # no table is asked beyond its end
        period = min(period, asked.motion.table.stop - since)
    areas = areas_of(
        asked,
        sites=sites,
        regions=regions,
        fold=design.fold if options.fold is None else options.fold,
        span=(since, since + period),
        limited=bool(since) or hours is not None,
        mask=None if options.mask_deg is None else option_mask(options.mask_deg, high).highest,
        altitude=high * 1e3,
        beam=_beam(options),
        effort=effort or Effort(workers=cores()),
    )
    return area_figures(areas, options.pdop_max, options.error_max_m)


def _beam(options: MapOptions) -> float | None:
    """Half angle of the antennas, radians."""
    return None if options.beam_deg is None else math.radians(options.beam_deg)
