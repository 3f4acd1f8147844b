"""A design for other programs, as OEM, CZML, GeoJSON or a design file."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from compass.api.given import given_design
from compass.api.results import Result
from compass.arguments import checked
from compass.design import Design
from compass.document import Page, Sentence, Verdict
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY
from compass.handover.czml import czml
from compass.handover.design_tables import not_kept
from compass.handover.geojson import geojson
from compass.handover.instants import iso, sample_times, tdb
from compass.handover.oem import oem
from compass.handover.toml import design_toml
from compass.orbits.motion import MotionModel
from compass.saving import making_folder, replacing

FORMATS = ("oem", "czml", "geojson", "toml")


@dataclass(frozen=True, repr=False)
class ExportResult(Result):
    """A design written down for other programs.

    Attributes
    ----------
    design
        What was exported.
    format
        One of `FORMATS`.
    files
        Texts by their names, of an OEM one a satellite; else one text.
    span
        Motion, first and last time, step and number of states; empty for a design file.
    output
        Where it was written, or None.
    not_kept
        What of the design a design file cannot say, a sentence each.
    """

    design: Design = field(repr=False)
    format: str
    files: Mapping[str, str] = field(repr=False)
    span: Mapping[str, Any]
    output: Path | None = None
    not_kept: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return plain(
            {
                "design": self.design.name,
                "format": self.format,
                "output": None if self.output is None else str(self.output),
                "satellites": self.design.constellation.size,
                **self.span,
                "files": len(self.files),
                "not_kept": self.not_kept,
            }
        )

    def document(self) -> Page:
        """What was written."""
        count = len(self.files)
        what = f"{count} {self.format} file{'s' if count > 1 else ''}"
        where = "" if self.output is None else f", wrote {self.output}"
        lacks = (Sentence(f"NOT KEPT: {said}") for said in self.not_kept)
        return Page(self.design.name, (Verdict("", what + where), *lacks))

    def write(self, path: str | Path) -> None:
        """Write the file; of an OEM a new folder with a file a satellite.

        Raises
        ------
        OutputError
            It cannot be written, or the folder is in use.
        """
        if self.format == "oem":
            with making_folder(Path(path)) as folder:
                for name, message in self.files.items():
                    (folder / name).write_text(message, encoding="ascii")
            return
        (text,) = self.files.values()
        with replacing(Path(path)) as temporary:
            temporary.write_text(text, encoding="utf-8")


@checked
def export(
    design: Design | str | Path,
    *,
    format: str,
    output: str | Path | None = None,
    duration_h: float | None = None,
    step_s: float | None = None,
    motion: MotionModel | None = None,
    start_day: float = 0.0,
) -> ExportResult:
    """Write a design down for other programs.

    OEM: states in ICRF about Mars, TDB, one message a satellite. CZML: satellites, paths and
    stations on the Mars ellipsoid. GeoJSON: ground tracks, and sub-satellite points, footprints
    and gaps at the first moment. TOML: the design file itself, every pattern and unit made plain.

    Parameters
    ----------
    design
        A design, or the path of its file.
    format
        ``oem``, ``czml``, ``geojson`` or ``toml``.
    output
        File to write, for an OEM a new folder; nothing is written without.
    duration_h
        Time span, hours; else until the ground tracks repeat.
    step_s
        Seconds between states; else close enough for interpolation to a millimetre.
    motion
        ``two-body``, ``j2`` or ``numerical``; else as the design says.
    start_day
        Day after the epoch of the first states.

    Raises
    ------
    ArgumentError, DesignError, OutputError
        An option, the design or the place is not allowed.

    Examples
    --------
    >>> import compass
    >>> made = compass.export("designs/areostationary-trio.toml", format="oem")
    >>> len(made.files)
    3
    """
    if format not in FORMATS:
        raise ArgumentError(f"format = {format!r}: allowed {', '.join(FORMATS)}")
    read = given_design(design)
    files, span = _written(read, format, duration_h, step_s, motion, start_day)
    place = None if output is None else Path(output)
    lacks = not_kept(read) if format == "toml" else ()
    made = ExportResult(
        design=read, format=format, files=files, span=span, output=place, not_kept=lacks
    )
    if output is not None:
        made.write(output)
    return made


def _written(
    design: Design,
    format: str,
    duration_h: float | None,
    step_s: float | None,
    motion: MotionModel | None,
    start_day: float,
) -> tuple[Mapping[str, str], Mapping[str, Any]]:
    """Texts by their names, and the span that they are for."""
    if format == "toml":
        given = {"duration_h": duration_h, "step_s": step_s, "motion": motion}
        for option, value in (given | {"start_day": start_day or None}).items():
            if value is not None:
                raise ArgumentError(
                    f"{option} = {value}: a design file holds orbits, not states; leave it out, "
                    "or choose the format oem, czml or geojson"
                )
        return {"design.toml": design_toml(design)}, {}
    start = start_day * SECONDS_PER_DAY
    times = sample_times(design.constellation, duration_h, step_s, start)
    first, last = iso(tdb(design.constellation.epoch, times[[0, -1]]))
    model = design.motion.or_of(motion)
    span = {
        "motion": model.model,
        "start_tdb": first,
        "stop_tdb": last,
        "step_s": float(times[1] - times[0]),
        "epochs": times.size,
    }
    if format == "oem":
        return oem(design, times, model), span
    write = {"czml": czml, "geojson": geojson}[format]
    return {f"design.{format}": write(design, times, model)}, span
