"""Design files: a constellation written down so that reading it gives the same one back."""

from collections.abc import Iterable
from dataclasses import replace
from datetime import timedelta

import numpy as np

from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import J2000, Figure
from compass.handover.decimals import decimal, number
from compass.handover.design_tables import table_lines
from compass.handover.signal_toml import signal_lines
from compass.handover.tracking_toml import tracking_lines
from compass.inputs.integrity import integrity_lines
from compass.inputs.toml_values import toml_text
from compass.orbits import Constellation
from compass.orbits.constellation import from_pattern
from compass.orbits.period import repeat_radius
from compass.sites import Mask, Site
from compass.units import KM

_NO_MASK = Mask()


def design_toml(design: Design) -> str:
    """Design file of a design, of which `compass.handover.design_tables.not_kept` says what lacks.

    Stations get planetocentric latitudes; comments of the file it was read from are lost.
    """
    written = constellation_toml(
        replace(design.constellation, name=design.name),
        design.figure,
        mask=design.mask,
        fold=design.fold,
        source=design.source,
        paper=design.paper,
        stations=design.stations,
    )
    written = "\n".join([written.rstrip("\n"), *table_lines(design), ""])
    if design.signal is not None:
        written = "\n".join([written, *signal_lines(design.signal), ""])
    if design.tracking is not None:
        written = "\n".join([written, *tracking_lines(design.tracking), ""])
    if design.integrity is not None:
        written = "\n".join([written, *integrity_lines(design.integrity), ""])
    return written


def constellation_toml(
    constellation: Constellation,
    figure: Figure,
    *,
    mask: Mask = _NO_MASK,
    fold: int = 4,
    source: str = "",
    paper: str | None = None,
    stations: Iterable[Site] = (),
) -> str:
    """Design file of a constellation.

    Angles and lengths are the shortest decimals of degrees and kilometres that read back as the
    same radians and metres. Some numbers have none; those change by one part in 10^16, once:
    what was read from a file is always written so that it reads the same. A pattern's
    phasing is reduced to 0 ... planes - 1: the same satellites, numbered anew.

    Parameters
    ----------
    constellation
        The orbits.
    figure
        Reference figure of Mars.
    mask, fold, source, paper, stations
        As in `compass.design.Design`.

    Raises
    ------
    ArgumentError
        A gravitational parameter other than Mars's, which a design file cannot say.
    """
    c = constellation
    standard = Constellation.__dataclass_fields__["gm"].default
    if c.gm != standard:
        raise ArgumentError(
            f"gm = {c.gm!r} m^3/s^2: a design file is about Mars, {standard!r}; "
            "make the constellation with that"
        )
    lines = [f"name = {toml_text(c.name)}"]
    if source:
        lines.append(f"source = {toml_text(source)}")
    if paper is not None:
        lines.append(f"paper = {toml_text(paper)}")
    lines.append(f"figure = {toml_text(figure.name)}")
    if c.epoch:
        epoch = J2000 + timedelta(seconds=c.epoch)
        lines.append(f"epoch = {epoch.isoformat()} # TDB")
    lines += ["", "[constellation]"]
    lines += _pattern(c, figure) if _is_laid_out(c) else _elements(c)
    lines += ["", "[coverage]", *_mask(mask), f"fold = {fold}"]
    for site in stations:
        lines += [
            "",
            "[[station]]",
            f"name = {toml_text(site.name)}",
            f"latitude_deg = {_degrees(site.latitude)}",
            f"longitude_deg = {_degrees(site.longitude)}",
            f"height_km = {_kilometres(site.height)}",
            *_mask(site.mask),
        ]
    return "\n".join([*lines, ""])


def _is_laid_out(c: Constellation) -> bool:
    """Whether the numbers of a pattern give every element and name back to the last bit."""
    if c.pattern is None or abs(c.pattern.raan) > 2 * np.pi:
        return False
    radius = float(c.semi_major_axis[0])
    told = from_pattern(c.pattern, radius, name=c.name, epoch=c.epoch, gm=c.gm, repeat=c.repeat)
    return told == c


def _pattern(c: Constellation, figure: Figure) -> list[str]:
    pattern = c.pattern
    assert pattern is not None
    return [
        f"pattern = {toml_text(pattern.kind)}",
        f"satellites = {pattern.satellites}",
        f"planes = {pattern.planes}",
        f"phasing = {pattern.phasing}",
        f"inclination_deg = {_degrees(pattern.inclination)}",
        *(f"raan_deg = {_degrees(pattern.raan)}" for _ in range(pattern.raan != 0.0)),
        *(f"phase_deg = {_degrees(pattern.phase)}" for _ in range(pattern.phase != 0.0)),
        _orbit(float(c.semi_major_axis[0]), c.repeat, figure),
    ]


def _orbit(radius: float, repeat: tuple[int, int] | None, figure: Figure) -> str:
    """How a pattern's tracks close, if that is declared; else its radius.

    Where only the altitude gives the same number back it is written instead.
    """
    if repeat == (1, 1):
        return 'orbit = "areosynchronous"'
    if repeat is not None:
        return f"repeat = {list(repeat)}"
    surface = figure.equatorial_radius
    altitude = decimal((radius - surface) / KM, lambda km: km * KM + surface, radius)
    if float(_kilometres(radius)) * KM != radius == float(altitude) * KM + surface:
        return f"altitude_km = {altitude}"
    return f"radius_km = {_kilometres(radius)}"


def _elements(c: Constellation) -> list[str]:
    lines = ['pattern = "elements"']
    for k, name in enumerate(c.satellite_names):
        lines += [
            "",
            "[[constellation.satellite]]",
            f"name = {toml_text(name)}",
            _size(float(c.semi_major_axis[k]), c.each_repeat[k]),
            f"eccentricity = {number(c.eccentricity[k])}",
            f"inclination_deg = {_degrees(c.inclination[k])}",
            f"raan_deg = {_degrees(c.raan[k])}",
            f"argument_of_periapsis_deg = {_degrees(c.argument_of_periapsis[k])}",
            f"mean_anomaly_deg = {_degrees(c.mean_anomaly[k])}",
        ]
    return lines


def _size(axis: float, repeat: tuple[int, int] | None) -> str:
    """How a track closes, if that is declared and says the axis; else the axis."""
    if repeat is not None and repeat_radius(*repeat) == axis:
        return f"repeat = {list(repeat)}"
    return f"semi_major_axis_km = {_kilometres(axis)}"


def _mask(mask: Mask) -> list[str]:
    if mask.azimuth == (0.0,):
        return [f"mask_deg = {_degrees(mask.lowest)}"]
    pairs = zip(mask.azimuth, mask.elevation, strict=True)
    return [f"horizon_deg = [{', '.join(f'[{_degrees(a)}, {_degrees(e)}]' for a, e in pairs)}]"]


def _degrees(radians: float) -> str:
    return decimal(np.degrees(radians), np.radians, radians)


def _kilometres(metres: float) -> str:
    return decimal(metres / KM, lambda km: km * KM, metres)
