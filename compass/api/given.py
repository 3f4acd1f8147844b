"""What the functions are given: a thing, or the path of the file that describes it."""

from collections.abc import Sequence
from dataclasses import replace
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING

from compass.coverage.region import read_regions
from compass.design import Design
from compass.errors import ArgumentError, meant, said_of, whole_number
from compass.inputs import read_design
from compass.orbits.constellation import Constellation
from compass.ranging import Signal
from compass.requirement import Requirement
from compass.sites import Mask, Site

if TYPE_CHECKING:
    from compass.inputs.scenario import Scenario
    from compass.inputs.study import Study


def given_design(design: Design | str | Path) -> Design:
    """Return the design, read from its file if it is a path.

    Raises
    ------
    DesignError
        As `compass.read_design`.
    ArgumentError
        It is something else.
    """
    if isinstance(design, Design):
        return design if design.text else _written(design)
    if isinstance(design, str | Path):
        return read_design(design)
    hint = "; make it one, Design(...)" if isinstance(design, Constellation) else ""
    raise ArgumentError(
        f"design = {type(design).__name__}: must be a Design or the path of a design file{hint}"
    )


def given_in_metres(design: Design | str | Path) -> Design:
    """Return the design as `given_design`, its signal worked out where tracking is to imply it.

    Raises
    ------
    ArgumentError, DesignError
        As `given_design`; or nothing measures the satellites' clocks.
    """
    return in_metres(given_design(design))


def in_metres(design: Design) -> Design:
    """Return a design with its signal worked out where tracking is to imply it."""
    if design.signal is None or not design.signal.determined:
        return design
    from compass.signal.determination import with_determined_signal  # brings kernels with it

    return with_determined_signal(design)


def _written(design: Design) -> Design:
    """Return a design that is of no file with the text of one, by which results are told apart."""
    from compass.handover.toml import design_toml

    try:
        return replace(design, text=design_toml(design))
    except ArgumentError:  # about a Mars of another mass, which no file can say
        return design


def joined_designs(designs: Sequence[Design | str | Path]) -> Design:
    """Return one design of the satellites, stations and requirements of all; else as the first.

    Where two designs name satellites, or requirements, alike, every name gets that of its design
    before it. A requirement without a mask keeps that of its own design. Covariances are each
    satellite's own; all else of ranges, tracking and what is promised are those of all if all say
    the same, else of none.

    Raises
    ------
    ArgumentError
        None is given, their epochs, motions or figures differ, or stations of one name do.
    DesignError
        As `compass.read_design`.
    """
    if not designs:
        raise ArgumentError("design: missing; give one or more")
    read = [given_design(design) for design in designs]
    first = read[0]
    if len(read) == 1:
        return first
    for other in read[1:]:
        for field in ("motion", "figure"):
            if getattr(other, field) != getattr(first, field):
                raise ArgumentError(
                    f"{first.name} + {other.name}: different {field}; give both the same"
                )
    names = [name for each in read for name in each.constellation.satellite_names]
    parts = [each.constellation for each in read]
    if len(set(names)) < len(names):
        called = [each.name for each in read]
        if alike := next((name for name in called if called.count(name) > 1), None):
            raise ArgumentError(
                f"name = {alike!r}: two designs of this name have satellites of the same names; "
                "give each design its own name, and name none twice"
            )
        parts = [
            replace(c, satellite_names=tuple(f"{each.name} {s}" for s in c.satellite_names))
            for each, c in zip(read, parts, strict=True)
        ]
    constellation = parts[0]
    for part in parts[1:]:
        constellation = constellation + part
    stations = {site.name: site for each in read for site in each.stations}
    for each in read:
        for site in each.stations:
            if stations[site.name] != site:
                raise ArgumentError(f"station {site.name}: two of that name differ; rename one")
    tracked = all(one.tracking == first.tracking for one in read)
    signal = _joined_signal(read)
    if signal is not None and signal.determined and not (tracked or signal.covariance):
        signal = None
    promised = signal is not None and all(one.integrity == first.integrity for one in read)
    return _written(
        replace(
            first,
            constellation=constellation,
            name=" + ".join(each.name for each in read),
            stations=tuple(stations.values()),
            requirements=_joined_requirements(read),
            signal=signal,
            tracking=first.tracking if tracked else None,
            integrity=first.integrity if promised else None,
            text="",
            others=tuple(label for each in read for label in (each.label, *each.others))[1:],
        )
    )


def _joined_signal(read: Sequence[Design]) -> Signal | None:
    """Errors of ranges that all designs say, each satellite with its own covariance; else None."""
    signals = [each.signal for each in read if each.signal is not None]
    first = signals[0] if signals else None
    if first is None or len(signals) < len(read):
        return None
    if any(replace(one, covariance=()) != replace(first, covariance=()) for one in signals):
        return None
    if all(one.covariance == first.covariance for one in signals) and len(first.covariance) < 2:
        return first
    if not all(one.covariance for one in signals):
        return None
    matrices = [
        matrix
        for one, each in zip(signals, read, strict=True)
        for matrix in (
            one.covariance * each.constellation.size if len(one.covariance) == 1 else one.covariance
        )
    ]
    return replace(first, covariance=tuple(matrices))


def _joined_requirements(read: Sequence[Design]) -> tuple[Requirement, ...]:
    """Requirements of all designs, each over the mask of its own.

    Raises
    ------
    ArgumentError
        A horizon by azimuth in [coverage], and other designs have another.
    """
    alike = all(each.mask == read[0].mask for each in read)
    wanted = []
    for each in read:
        for one in each.requirements:
            masked = one
            if not alike and one.mask is None:
                if not each.mask.is_constant:
                    raise ArgumentError(
                        f"{each.name}: {one.name} is over its horizon_deg, and other designs have "
                        "another mask; give that requirement a mask_deg"
                    )
                masked = replace(one, mask=each.mask.lowest)
            wanted.append((each.name, masked))
    names = [one.name for _, one in wanted]
    return tuple(
        replace(one, name=f"{name}: {one.name}") if names.count(one.name) > 1 else one
        for name, one in wanted
    )


def with_beacons(design: Design, beacons: Site | str | Sequence[Site | str]) -> Design:
    """Return a design with beacons on the ground: sites, as `given_places` reads them."""
    lit, _ = given_places(beacons, (), design)
    return replace(design, beacons=lit) if lit else design


def given_scenario(scenario: "Scenario | str | Path", start_day: float | None = None) -> "Scenario":
    """Return the scenario, read from its file if it is a path, on a day if one is given.

    Raises
    ------
    DesignError
        As `compass.read_scenario`.
    ArgumentError
        It is something else, or has been read without that day.
    """
    from compass.inputs.scenario import Scenario, read_scenario

    if isinstance(scenario, Scenario) and start_day is None:
        return scenario
    if isinstance(scenario, Scenario):
        raise ArgumentError(
            f"start_day = {start_day:g}: this scenario has been read, and its beacons stand where "
            "they are; give its path, or read it with read_scenario(path, start_day)"
        )
    if isinstance(scenario, str | Path):
        return read_scenario(scenario, start_day)
    raise ArgumentError(
        f"scenario = {type(scenario).__name__}: must be a Scenario or the path of a scenario file"
    )


def given_study(study: "Study | str | Path") -> "Study":
    """Return the study, read from its file if it is a path; errors as `given_scenario`."""
    from compass.inputs.study import Study, read_study

    if isinstance(study, Study):
        return study
    if isinstance(study, str | Path):
        return read_study(study)
    raise ArgumentError(
        f"study = {type(study).__name__}: must be a Study or the path of a study file"
    )


def given_fold(fold: int | None, design: Design) -> int:
    """Return the satellites wanted in view at once, the design's where it is None.

    Raises
    ------
    ArgumentError
        It is no whole number from 1 on.
    """
    return design.fold if fold is None else whole_number("fold", fold, 1)


def given_mask(mask_deg: float | None, design: Design) -> Mask:
    """Return a constant mask of degrees, or the design's where they are None.

    Raises
    ------
    ArgumentError
        Outside 0 up to below 90 degrees.
    """
    if mask_deg is None:
        return design.mask
    return Mask.constant(radians(mask_deg))


def given_places(
    sites: Site | str | Sequence[Site | str], regions: str | Sequence[str], design: Design
) -> tuple[tuple[Site, ...], tuple[str, ...]]:
    """Sites and regions of the options that all commands share.

    A site is a `Site`, the name of one of the design's stations, or as `given_site` reads it; a
    region a text as of a requirement.

    Raises
    ------
    ArgumentError
        There is no such station, a name is used twice, or a region cannot be read.
    """
    known = {site.name: site for site in design.stations}
    places = []
    for site in (sites,) if isinstance(sites, Site | str) else sites:
        if isinstance(site, str) and "=" not in site:
            if site not in known:
                named = ", ".join(known) or "none"
                raise ArgumentError(
                    f"site {site!r}: no [[station]] of that name; {meant(site, known)}there are "
                    f"{named}; or write "
                    "NAME=LAT,LON[,MASK]"
                )
            places.append(known[site])
        else:
            places.append(given_site(site, design, "site"))
    names = [site.name for site in places]
    for name in names:
        if names.count(name) > 1:
            raise ArgumentError(f"site {name!r}: given twice; leave one out")
    texts = (regions,) if isinstance(regions, str) else tuple(regions)
    for text in texts:
        read_regions(text)
    return tuple(places), texts


def given_site(station: Site | str, design: Design, called: str = "station") -> Site:
    """Return a site, read from ``NAME=LAT,LON[,MASK]`` in degrees if it is a text.

    Refusals name the argument as it is `called`.

    Raises
    ------
    ArgumentError
        The text is none of that form, or no place on Mars.
    """
    if isinstance(station, Site):
        return station
    name, equals, rest = station.partition("=")
    try:
        numbers = [float(part) for part in rest.split(",")]
    except ValueError:
        numbers = []
    if not (name.strip() and equals) or len(numbers) not in (2, 3):
        raise ArgumentError(
            f"{called} {station!r}: not NAME=LAT,LON or NAME=LAT,LON,MASK; "
            "write for example 'Gale=-4.6,137.4,10'"
        )
    latitude, longitude, mask = (*numbers, 0.0)[:3]
    with said_of(f"{called} {station!r}"):
        return Site.of(
            name.strip(),
            latitude_deg=latitude,
            longitude_deg=longitude,
            mask_deg=mask,
            figure=design.figure,
        )
