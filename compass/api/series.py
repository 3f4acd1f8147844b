"""What stations see over time: satellites in view, dilutions, and the gaps between."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import compass
from compass.api.given import given_fold, given_places, given_site, in_metres, joined_designs
from compass.api.series_result import NAMES, NO_SIGNAL, SeriesResult
from compass.arguments import checked
from compass.contacts.gaps import ages, gap_statistics
from compass.contacts.spans import at_least, fewest
from compass.contacts.survey import survey
from compass.conventions import dated, epoch_text
from compass.coverage.beacon_verdict import heard
from compass.coverage.errors import ERRORS
from compass.coverage.moving import Mover, errors_along, in_orbit, on_route, standing
from compass.coverage.site import site_coverage
from compass.design import Design
from compass.errors import ArgumentError, said_of
from compass.frames import SECONDS_PER_DAY
from compass.orbits.constellation import Constellation, keplerian
from compass.orbits.motion import Motion, MotionModel
from compass.sites import Mask, Site

if TYPE_CHECKING:
    import xarray as xr

#: Random moments that tell shares and percentiles of the time, and their seed.
MOMENTS, SEED = 10_000, 0


@checked
def series(
    design: Design | str | Path,
    *others: Design | str | Path,
    stations: Sequence[Site | str] = (),
    beacons: Sequence[Site | str] = (),
    routes: Sequence[str] = (),
    orbiters: Sequence[str] = (),
    beam_deg: float | None = None,
    fold: int | None = None,
    mask_deg: float | None = None,
    days: float = 10.0,
    start_day: float = 0.0,
    epochs: int = 1009,
    motion: MotionModel | None = None,
) -> SeriesResult:
    """Follow what stations see over time: counts, dilutions, and gaps by rise and set.

    Parameters
    ----------
    design, *others
        A design, or the path of its file; several are one network.
    stations
        Beside the designs': sites, or texts ``NAME=LAT,LON[,MASK]`` in degrees.
    beacons
        On the ground, likewise, or names of stations: ranged to as satellites are and counted with
        them by stations over whose horizon they stand, but for a station's own.
    routes
        Rovers, texts ``NAME=LAT,LON;LAT,LON;...`` in degrees: along great circles, evenly over the
        span, under the design's mask. They need a design with a table [signal].
    orbiters
        Texts ``NAME=KM,E,INC,RAAN,ARGP,M``: semi-major axis, eccentricity and degrees at the
        design's epoch, inertial, in two-body motion. They need it too.
    beam_deg
        Half angle of the satellites' antennas, about the way down; all around if left out.
    fold
        Satellites wanted in view; else the design's.
    mask_deg
        Elevation mask, degrees: the higher of it and each station's own horizon counts.
    days, start_day
        For so many days, from a day after the epoch on.
    epochs
        Moments that are kept, for pictures and files.
    motion
        ``two-body``, ``j2`` or ``numerical``; else the design's.

    Raises
    ------
    ArgumentError, DesignError
        An option or a design is not allowed, or there is neither a station nor a user who moves.

    Examples
    --------
    >>> import compass
    >>> found = compass.series("designs/compass-15-5-1.toml", stations=["Gale=-4.6,137.4"], days=1)
    >>> found.holds, found.rows()[-1]["gaps"]
    (True, 0)
    """
    read = joined_designs((design, *others))
    wanted = given_fold(fold, read)
    in_metres_too = read.signal is not None and not others
    of_errors = {"routes": routes, "orbiters": orbiters, "beam_deg": beam_deg is not None}
    if not in_metres_too and (asked := [name for name, given in of_errors.items() if given]):
        raise ArgumentError(f"{', '.join(asked)}: {NO_SIGNAL}")
    floor = Mask.of(mask_deg or 0.0)
    sites = tuple(
        replace(site, mask=site.mask.or_higher(floor))
        for site in (*read.stations, *(given_site(station, read) for station in stations))
    )
    if not (sites or routes or orbiters):
        raise ArgumentError("station: none; add a [[station]], or --station NAME=LAT,LON")
    lit, _ = given_places(beacons, (), replace(read, stations=sites))
    moving, c = read.motion.or_of(motion), read.constellation
    start, duration = start_day * SECONDS_PER_DAY, days * SECONDS_PER_DAY
    options: dict[str, Any] = {"start": start}
    if moving.is_closed_form and start == 0.0:
        options["model"] = moving.model
    else:
        options["path"] = moving.trajectory(c, start, start + duration)
    covered, least = {}, {}
    if sites:
        found = survey(c, sites, duration, figure=read.figure, **options)
        whole = np.array([[0.0, duration]])
        for site in sites:
            seen = [w.spans for w in found.of(site.name)]
            seen += [whole for _ in heard(site, site.mask, lit)]
            covered[site.name] = at_least(wanted, seen)
            least[site.name] = fewest(seen, duration)
    gaps = {name: gap_statistics(spans, duration) for name, spans in covered.items()}
    since = duration * np.arange(epochs) / epochs
    sited = replace(read, stations=sites)
    chance = np.sort(np.random.default_rng(SEED).uniform(0.0, duration, MOMENTS))
    made, drawn = (_dataset(sited, start + past, moving, lit) for past in (since, chance))
    errors = drawn_errors = None
    if in_metres_too:
        known = in_metres(sited)
        errors, drawn_errors = (
            _errors(
                known,
                start + past,
                moving,
                _movers(sited, start + past, past / duration, routes, orbiters, floor),
                beam_deg,
            )
            for past in (since, chance)
        )
    made["age_h"] = (
        ("station", "time"),
        np.array([ages(spans, since) / 3600.0 for spans in covered.values()]).reshape(-1, epochs),
        {"units": "h", "long_name": f"time since {wanted} satellites were last in view"},
    )
    return SeriesResult(
        design=sited,
        fold=wanted,
        days=days,
        start_day=start_day,
        motion=moving.title,
        gaps=gaps,
        fewest=least,
        dataset=made,
        errors=errors,
        beam_deg=beam_deg,
        drawn=drawn,
        drawn_errors=drawn_errors,
    )


def _movers(
    design: Design,
    times: np.ndarray,
    gone: np.ndarray,
    routes: Sequence[str],
    orbiters: Sequence[str],
    floor: Mask,
) -> list[Mover]:
    """Stations, rovers and orbiters as users at times, when parts of the span are gone.

    Raises
    ------
    ArgumentError
        A text that cannot be read, or a name that is used twice.
    """
    found, mask = [standing(s, times.size) for s in design.stations], design.mask.or_higher(floor)
    for text in routes:
        name, places = _read_route(text, design)
        found.append(on_route(name, places, design.figure, mask, gone))
    for text in orbiters:
        orbit = _read_orbit(text, design)
        found.append(in_orbit(orbit, design.constellation.epoch, times, design.figure))
    names = [mover.name for mover in found]
    for name in names:
        if names.count(name) > 1:
            raise ArgumentError(f"user {name!r}: given twice; rename one")
    return found


def _read_route(text: str, design: Design) -> tuple[str, list[tuple[float, float]]]:
    name, equals, rest = text.partition("=")
    parts = rest.split(";")
    if not (name.strip() and equals) or len(parts) < 2:
        raise ArgumentError(
            f"route {text!r}: not NAME=LAT,LON;LAT,LON;...; write for example "
            "'rover=-4.6,137.4;-4.9,137.3'"
        )
    sites = [given_site(f"{name}={part}", design, "route") for part in parts]
    return name.strip(), [(site.latitude, site.longitude) for site in sites]


def _read_orbit(text: str, design: Design) -> Constellation:
    name, equals, rest = text.partition("=")
    try:
        numbers = [float(part) for part in rest.split(",")]
    except ValueError:
        numbers = []
    if not (name.strip() and equals) or len(numbers) != 6 or not np.all(np.isfinite(numbers)):
        raise ArgumentError(
            f"orbiter {text!r}: not NAME=KM,E,INC,RAAN,ARGP,M (semi-major axis, eccentricity, "
            "degrees); write for example 'MRO=3660,0.01,93,0,0,0'"
        )
    axis, eccentricity, *angles = numbers
    with said_of(f"orbiter {text!r}"):
        return keplerian(
            axis * 1e3,
            eccentricity,
            *np.radians(angles),
            satellite_names=[name.strip()],
            gm=design.constellation.gm,
        )


def _errors(
    design: Design,
    times: np.ndarray,
    motion: Motion,
    movers: Sequence[Mover],
    beam_deg: float | None,
) -> "xr.Dataset":
    """Satellites in view and errors of fixes over user and time."""
    import xarray as xr

    beam = None if beam_deg is None else float(np.radians(beam_deg))
    each = [errors_along(design, mover, times, motion, beam=beam) for mover in movers]
    both = ("user", "time")
    data: dict[str, tuple] = {
        "in_view": (both, np.array([count for count, _, _ in each]), {
            "units": "1", "long_name": "satellites in view"}),
        "in_view_all_around": (both, np.array([around for _, _, around in each]), {
            "units": "1", "long_name": "satellites in view, did their antennas reach all around"}),
        **{
            name: (both, np.array([errors[:, k] for _, errors, _ in each]), {
                "units": "m", "long_name": f"{words}, one sigma"})
            for k, (name, words) in enumerate(ERRORS.items())
        },
    }  # fmt: skip
    data["user_position"] = (
        (*both, "axis"),
        np.array([mover.r for mover in movers]),
        {"units": "m", "long_name": "position of the user, Mars-fixed"},
    )
    coords = {
        "user": [mover.name for mover in movers],
        "axis": ["x", "y", "z"],
        "time": ("time", times, {"units": "s", "long_name": "time after the epoch"}),
    }
    found = xr.Dataset(data, coords, {"epoch_tdb": epoch_text(design.constellation.epoch)})
    return dated(found, "time")


def _dataset(
    design: Design, times: np.ndarray, motion: Any, beacons: Sequence[Site]
) -> "xr.Dataset":
    """Counts and dilutions over station and time."""
    import xarray as xr

    # without stations one place still gives the coordinates and attributes
    places = design.stations or (Site("", 0.0, 0.0, figure=design.figure),)
    seen = [
        site_coverage(design.constellation, site, times, motion, heard(site, site.mask, beacons))
        for site in places
    ]
    found = list(NAMES[:-1])
    together = xr.concat([one[found] for one in seen], "station", combine_attrs="drop")
    together = together.isel(station=slice(len(design.stations)))
    made = together.assign_coords(station=[site.name for site in design.stations]).assign_attrs(
        title=f"What stations see of {design.name}",
        source=f"compass {compass.__version__}",
        epoch_tdb=epoch_text(design.constellation.epoch),
        motion_model=motion.model,
    )
    for name in found:
        made[name].attrs = seen[0][name].attrs
    return dated(made, "time")
