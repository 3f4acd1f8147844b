"""Satellite counts and dilution of precision over the sphere and a period."""

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from compass.api.cluster import check_cluster
from compass.api.given import given_places, in_metres, joined_designs, with_beacons
from compass.api.map_result import MapResult, with_intervals
from compass.api.map_statistics import extremes_met, folds_met
from compass.api.progress import bar, foretell, parts_bar
from compass.arguments import checked
from compass.cores import cores
from compass.coverage.certified_effort import Effort
from compass.coverage.certified_geometry import CertifiedGeometry
from compass.coverage.rows import Rows
from compass.design import PDOP_MAX, Design
from compass.errors import ArgumentError
from compass.orbits.motion import MotionModel
from compass.signal.ranges import Weighting
from compass.sites import Site
from compass.study.certified import certified_areas, certified_figures
from compass.study.mapping import DesignMap, MapOptions, MapRows, make_map


@checked
def map(
    design: Design | str | Path,
    *others: Design | str | Path,
    sites: Site | str | Sequence[Site | str] = (),
    regions: str | Sequence[str] = (),
    beacons: Site | str | Sequence[Site | str] = (),
    step_deg: float = 1.0,
    grid: str = "equal-angle",
    epochs: int = 109,
    altitude_km: float = 0.0,
    mask_deg: float | None = None,
    beam_deg: float | None = None,
    fold: int | None = None,
    pdop_max: float = PDOP_MAX,
    motion: MotionModel | None = None,
    start_day: float = 0.0,
    duration_h: float | None = None,
    error_max_m: float = 30.0,
    weights: Weighting = "variance",
    each_loss: bool = False,
    width: float | None = None,
    budget_s: float | None = None,
    leaves: str | Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    tls_ca: str | Path | None = None,
    tls_cert: str | Path | None = None,
    tls_key: str | Path | None = None,
    command: str = "",
    progress: bool = False,
) -> MapResult:
    """Count and DOP maps of a design, or of several as one, over the sphere and a repeat period.

    A dilution of precision is infinite with fewer than four satellites in view; infinities count
    in every percentile and against availability. Availability and percentiles of GDOP
    over all area and time are bracketed besides, with proven bounds. A design with a signal is
    mapped in metres too.

    Parameters
    ----------
    design, *others
        A design, or the path of its file; with several their satellites together are mapped, in
        metres too where all have the same errors of ranges.
    sites, regions
        Where figures are wanted besides those of the whole surface: sites, names of the design's
        stations, or ``NAME=LAT,LON[,MASK]``; ``lat:MIN:MAX`` or ``polygon:LAT,LON;...``, degrees.
        Fold, availability, GDOP and, with a signal, errors there are proven or bracketed, not
        read off cells.
    beacons
        On the ground: sites, names of stations, or ``NAME=LAT,LON[,MASK]``. Sites over whose
        horizon they stand count them with satellites, but not in metres; over regions and the whole
        surface satellites count alone.
    step_deg, grid
        Size of the cells, degrees, and their kind: ``equal-angle`` or ``equal-area``.
    epochs
        In the period; a prime number meets moments of symmetry least.
    altitude_km
        Height of the users above the ground: of a shell of orbits. Regions are at it too.
    mask_deg, fold
        Elevation mask, degrees, and satellites wanted; else the design's. A mask below 0, not below
        Mars's limb, is of users in orbit, who look down: their receivers have the noise of the
        zenith, and no ionosphere.
    beam_deg
        Half angle of the satellites' antennas about the way down, degrees, outside of which users
        see nothing; all around if left out.
    pdop_max
        Largest PDOP that counts as available.
    motion
        ``two-body``, ``j2`` or ``numerical``; else the design's.
    start_day
        Days after the epoch at which the period begins.
    duration_h
        Period to map, hours; else until the ground tracks repeat.
    error_max_m
        Largest error of a fix that counts as within, metres, one sigma; of designs with a signal.
    weights
        How a fix weighs ranges: by their ``variance``, or all ``equal``.
    each_loss
        Whether to draw protection levels without each satellite in turn, too. The design needs
        tables [signal] and [integrity].
    width, budget_s
        How near proven bounds of a share are to come (by fold 10, of a percentile 100 times
        that, relative), and seconds that each figure may take; by default 2e-4, and a number of
        boxes.
    leaves
        File of open boxes: what it holds of the same question is gone on from, and what is left
        open is kept there.
    workers
        Threads; by default one a core. The numbers do not depend on it.
    scheduler
        Address of a Dask scheduler, such as ``tcp://host:8786``, whose workers do the rows of the
        map instead, to the same numbers; proven bounds are worked out here.
    tls_ca, tls_cert, tls_key
        Certificates of a cluster that wants them, all three.
    command
        What to write into the files' history.
    progress
        Show bars on stderr.

    Raises
    ------
    ArgumentError, DesignError
        An option or the design is not allowed.

    Examples
    --------
    >>> import compass
    >>> found = compass.map("designs/compass-15-5-1.toml", step_deg=15, epochs=6)
    >>> int(found.dataset.count_min.min())
    4
    """
    options = MapOptions(
        step_deg=step_deg,
        grid=grid,
        epochs=epochs,
        altitude_km=altitude_km,
        mask_deg=mask_deg,
        beam_deg=beam_deg,
        fold=fold,
        pdop_max=pdop_max,
        motion=motion,
        start_day=start_day,
        duration_h=duration_h,
        error_max_m=error_max_m,
        weights=weights,
    )
    given = joined_designs((design, *others))
    if each_loss and (given.signal is None or given.integrity is None):
        raise ArgumentError(
            "each_loss: protection after a loss needs what is promised, and the errors of ranges; "
            "add tables [signal] and [integrity]"
        )
    if beacons and not sites:
        raise ArgumentError(
            "beacons: count at sites, and satellites alone elsewhere; give sites, or leave them out"
        )
    tls = check_cluster(workers, scheduler, tls_ca, tls_cert, tls_key)
    read = with_beacons(in_metres(given), beacons)
    places = given_places(sites, regions, read)
    if sites and altitude_km:
        raise ArgumentError(
            f"altitude_km = {altitude_km:g}: is of regions; sites have their own height_km"
        )
    file, threads = None if leaves is None else Path(leaves), cores(workers)
    effort = Effort(width, budget_s, file, threads)
    with bar(progress, "map", unit="row", leave=False) as rows, ExitStack() as stack:

        def by(wanted: MapRows) -> Rows:
            from compass.study.cluster import Cluster
            from compass.study.map_cluster import by_cluster

            assert scheduler is not None
            kept = "nothing of a map is kept"
            cluster = Cluster(wanted, scheduler, tls, kept=kept)
            stack.callback(cluster.close)
            return by_cluster(cluster, rows.update)

        made = make_map(
            read,
            options,
            command,
            workers=workers,
            foretell=lambda cost: foretell(progress, "map", cost.seconds, cost.bytes),
            progress=rows.update,
            by=by if scheduler else None,
        )
    with parts_bar(progress, "bounds") as effort.progress:
        result = result_of(read, made, options, places, effort=effort, losses=each_loss)
    made.dataset.attrs |= _attributes(result.certified, result) | {"sampled": result.sampled}
    return result


def result_of(
    design: Design,
    made: DesignMap,
    options: MapOptions,
    places: tuple[Sequence[Site], Sequence[str]] = ((), ()),
    *,
    effort: Effort | None = None,
    losses: bool = False,
) -> MapResult:
    """Say of a map that was made, and of places, what is certified and what draws tell."""
    met = folds_met(made.dataset), extremes_met(made.dataset)
    certified = certified_figures(design, options, effort, *met)
    areas = certified_areas(design, options, *places, effort)
    drawn = MapRows(design, options).drawn(losses=losses)
    return MapResult(design, made, certified, areas, drawn)


def _attributes(certified: CertifiedGeometry | None, result: MapResult) -> dict[str, Any]:
    """Return brackets, and intervals where there are none, as attributes of a dataset."""
    attributes: dict[str, Any] = {}
    if certified is not None:
        brackets = certified.brackets.items()
        attributes = {f"{name.replace('.', '_')}_bracket": ends for name, ends in brackets}
        attributes["certified_scope"] = certified.scope
    if result.drawn is not None:
        intervals = with_intervals(result.numbers())
        attributes |= {f"{name.replace('.', '_')}_interval": ends for name, ends in intervals}
        attributes["drawn"] = result.interval
    return attributes
