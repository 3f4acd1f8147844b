"""Continuous k-fold coverage: proven, or refuted with a witness, and how far from failing."""

from math import degrees
from pathlib import Path

from compass.allowed import check_allowed
from compass.api.fold_claim import FoldClaim
from compass.api.fold_result import FoldResult
from compass.api.given import given_design, given_fold, given_mask
from compass.api.lasting import LastingResult
from compass.api.progress import bar
from compass.arguments import checked
from compass.coverage.clearance import Clearance, least_clearance
from compass.coverage.continuous import STEPS, continuous_coverage
from compass.coverage.lasting import prove_span
from compass.coverage.region import GLOBE, read_region
from compass.coverage.users import site_users
from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY
from compass.orbits.motion import Motion, MotionModel
from compass.orbits.symmetry import one_period
from compass.sites import Mask, Site


@checked
def fold(
    design: Design | str | Path,
    *,
    fold: int | None = None,
    mask_deg: float | None = None,
    losses: int = 0,
    region: str | None = None,
    duration_h: float | None = None,
    days: float | None = None,
    start_day: float = 0.0,
    motion: MotionModel | None = None,
    progress: bool = False,
) -> FoldClaim:
    """Prove continuous k-fold coverage, or refute it with a witness; no grid, no time steps.

    Parameters
    ----------
    design
        A design, or the path of its file.
    fold, mask_deg
        Satellites in view at once and elevation mask, degrees; else the design's.
    losses
        Also what is left after so many failures.
    region
        ``lat:MIN:MAX`` or ``polygon:LAT,LON;LAT,LON;...``, degrees; else everywhere.
    duration_h
        Hours from the epoch to look at; else all time where symmetry allows it.
    days, start_day
        Prove it for so many days from a day after the epoch on, along the satellites' paths and
        without symmetry; needed where the motion is not two-body.
    motion
        ``two-body``, ``j2`` or ``numerical``; else the design's.
    progress
        Show bars on stderr.

    Returns
    -------
    claim
        A `FoldResult`, with margins and shares; along paths a `LastingResult`, with the days.

    Raises
    ------
    ArgumentError, DesignError
        An option or the design is not allowed.

    Examples
    --------
    >>> import compass
    >>> found = compass.fold("designs/compass-15-5-1.toml")
    >>> print(found.outcome)
    proven
    >>> f"{found.mask_margin_deg:.2f}"
    '6.24'
    """
    read = given_design(design)
    wanted = given_fold(fold, read)
    mask = given_mask(mask_deg, read)
    chosen = read.motion.or_of(motion)
    if days is not None or chosen.model != "two-body" or start_day:
        return _over_days(
            read, wanted, mask, region, days, duration_h, start_day, losses, chosen, progress
        )
    with bar(progress, "fold", total=len(STEPS), leave=False) as steps:

        def begin(step: str, revolutions: float) -> None:
            steps.set_description(f"fold: {step}, over {revolutions:.3g} revolutions")
            steps.update(STEPS.index(step) - steps.n)

        coverage = continuous_coverage(
            read.constellation,
            wanted,
            sphere_radius=read.figure.equatorial_radius,
            stretch=read.figure.stretch,
            mask=mask,
            region=GLOBE if region is None else read_region(region),
            duration=None if duration_h is None else duration_h * 3600.0,
            losses=losses,
            progress=lambda sets: bar(progress, "losses", sets),
            begin=begin,
            watch=lambda parts: bar(progress, "revolutions", parts, leave=False, delay=1.0),
        )
    region_name = coverage.certificate.region.name
    sites: tuple[tuple[Site, Clearance], ...] = ()
    if region is None and duration_h is None and one_period(read.constellation):
        sites = tuple(
            (site, least_clearance(read.constellation, site_users(site).belt(), wanted))
            for site in read.stations
        )
    return FoldResult(read, wanted, degrees(coverage.mask), region_name, coverage, sites)


def _over_days(
    design: Design,
    wanted: int,
    mask: Mask,
    region: str | None,
    days: float | None,
    duration_h: float | None,
    start_day: float,
    losses: int,
    motion: Motion,
    progress: bool,
) -> LastingResult:
    """Settle the claim along the paths of a motion."""
    if losses:
        raise ArgumentError(
            f"losses = {losses}: looked at for all time of two-body orbits only; leave it out with "
            "days"
        )
    if days is not None and duration_h is not None:
        raise ArgumentError("days: has both days and duration_h; keep one")
    if duration_h is not None:
        days = duration_h / 24.0
    if days is None:
        why = "from a start_day on" if start_day else f"under {motion.title}"
        raise ArgumentError(f"days: missing; {why} nothing is for ever: give the days to prove")
    check_allowed("days", days)
    start, stop = start_day * SECONDS_PER_DAY, (start_day + days) * SECONDS_PER_DAY
    path = motion.trajectory(
        design.constellation,
        start,
        stop,
        progress=lambda parts: bar(progress, "orbits", parts),
    )
    lasting = prove_span(
        path,
        wanted,
        sphere_radius=design.figure.equatorial_radius,
        stretch=design.figure.stretch,
        mask=mask.highest,
        region=GLOBE if region is None else read_region(region),
        start=start,
        stop=stop,
        progress=lambda days: bar(progress, "fold: days", days, leave=False),
    )
    return LastingResult(design, wanted, degrees(mask.highest), motion.title, lasting)
