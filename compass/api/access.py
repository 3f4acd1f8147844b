"""When stations, moons, the Earth and satellites see each other."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from compass.api.access_result import AccessResult
from compass.api.given import given_design, given_site
from compass.arguments import checked
from compass.bodies import SOLAR_DAY
from compass.contacts.nodes import check_duration
from compass.contacts.record import survey_record
from compass.contacts.survey import survey
from compass.design import Design
from compass.frames import SECONDS_PER_DAY
from compass.links import Wanted
from compass.orbits.motion import MotionModel
from compass.sites import Site


@checked
def access(
    design: Design | str | Path,
    *,
    stations: Sequence[Site | str] = (),
    moons: Sequence[str] = (),
    earth: bool = False,
    crosslinks: bool = False,
    eclipse: bool = False,
    duration_sols: float | None = None,
    motion: MotionModel | None = None,
    start_day: float = 0.0,
    moon_model: str = "precessing",
    pairs: bool = False,
) -> AccessResult:
    """Find access windows: stations, Mars's moons, the Earth, and links between satellites.

    Rise, set and culmination are found by root isolation, not by sampling, to 1 ms of the motion
    modelled. Times are seconds after the design's epoch, or after its `start_day`.

    Parameters
    ----------
    design
        A design, or the path of its file.
    stations
        Beside the design's: sites, or texts ``NAME=LAT,LON[,MASK]`` in degrees.
    moons
        ``phobos``, ``deimos``, beside the design's.
    earth, crosslinks
        Link with the Earth, and satellites with each other, if the design does not say so.
    eclipse
        Find when satellites and moons are in shadow.
    duration_sols
        Span from the epoch, above 0 to 1000 sols; else the design's.
    motion, moon_model
        How satellites (``two-body``, ``j2``, ``numerical``; else as the design says) and moons
        (``precessing``, ``circular``) move.
    start_day
        Day after the epoch at which the span begins.
    pairs
        Print a line for every pair.

    Raises
    ------
    ArgumentError, DesignError
        An option or the design is not allowed, or there is nothing to link.

    Examples
    --------
    >>> import compass
    >>> design = "designs/compass-15-5-1.toml"
    >>> found = compass.access(design, stations=["Gale=-4.6,137.4"], duration_sols=1)
    >>> [node["seen"] for node in found.record["nodes"] if node["node"] == "Gale"]
    [7]
    """
    read = given_design(design)
    wanted = Wanted(
        tuple(dict.fromkeys((*read.access.moons, *moons))),
        read.access.earth or earth,
        read.access.crosslinks or crosslinks,
        read.access.atmosphere_height,
    )
    duration = read.access_duration if duration_sols is None else duration_sols * SOLAR_DAY.value
    sites = (*read.stations, *(given_site(station, read) for station in stations))
    asked = replace(read, stations=sites, access=wanted, access_duration=duration)
    check_duration(duration)
    start, moved = start_day * SECONDS_PER_DAY, read.motion.or_of(motion)
    options: Any = {"moon_model": moon_model, "start": start}
    if moved.is_closed_form and start == 0.0:
        options["model"] = moved.model
    else:
        options["path"] = moved.trajectory(read.constellation, start, start + duration)
    surveyed = survey(read.constellation, sites, duration, wanted, figure=read.figure, **options)
    record = {"motion": moved.title, "start_day": start_day} | survey_record(
        surveyed,
        surveyed.epoch,
        radios=read.radios,
        threshold=read.conjunction,
        figure=read.figure,
        eclipse=eclipse,
    )
    return AccessResult(asked, surveyed, record, pairs)
