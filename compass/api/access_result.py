"""Access windows of a design as text, numbers, picture and files."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import compass
from compass.api.results import Result
from compass.contacts.dataset import windows_dataset
from compass.contacts.survey import Survey
from compass.conventions import dated, epoch_text
from compass.design import Design
from compass.document import Page, Sentence, Table, Value, Verdict
from compass.document.plain import plain
from compass.errors import ArgumentError, meant
from compass.orbits.motion import Motion
from compass.quantities import quantity
from compass.saving import ENDINGS, check_ending, replacing, save_netcdf, write_csv
from compass.words import capital, counted

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

#: What needs no word: how satellites of most designs move.
TWO_BODY = Motion().title

#: How well rise and set are known, as `compass.contacts.windows.windows` has it.
WINDOWS_GOOD_TO = "1 ms of the motion modelled"

#: How well what windows come to is known.
EVIDENCE = (
    f"rise and set are found to {WINDOWS_GOOD_TO}; shares, gaps and waits are of this span alone"
)


class Window(NamedTuple):
    """When two nodes see each other; seconds after the epoch."""

    first: str
    second: str
    start_s: float
    end_s: float
    duration_s: float
    culmination_s: float
    max_elevation_deg: float


@dataclass(frozen=True, repr=False)
class AccessResult(Result):
    """Windows of all pairs, and what they come to.

    Attributes
    ----------
    design
        With the links and stations that were asked for beside its own.
    survey
        The windows, in SI units.
    record
        Plain values with units in their names.
    pairs
        Whether the text has a line for every pair.
    """

    design: Design = field(repr=False)
    survey: Survey = field(repr=False)
    record: dict[str, Any] = field(repr=False)
    pairs: bool = False

    @property
    def windows(self) -> tuple[Window, ...]:
        """Every window, a row each: ``pandas.DataFrame(found.windows)`` is the table of them."""
        return tuple(
            Window(pair["first"], pair["second"], **window)
            for pair in self.record["pairs"]
            for window in pair["windows"]
        )

    @property
    def dataset(self) -> "xr.Dataset":
        """All windows as a CF contiguous ragged array."""
        made = windows_dataset(
            self.survey.windows,
            title=f"Access windows of {self.design.name}",
            design=self.design.text,
            design_sha256=self.design.digest,
            epoch_tdb=epoch_text(self.survey.epoch),
            source=f"compass {compass.__version__}",
        )
        return dated(made, "start", "end", "culmination")

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        epoch = self.survey.epoch
        named = {"design": self.design.name, "epoch_tdb_s_past_j2000": epoch}
        return plain({**named, "evidence": EVIDENCE, **self.record})

    def document(self) -> Page:
        """Who is seen how much, then a table a question."""
        return Page(
            self.design.name,
            (
                Verdict("", f"access over {self.record['duration_sols']:g} sols"),
                *(Sentence(words) for words in self.summary()),
                *self.tables(),
                *(Sentence(words) for words in self.notes()),
            ),
        )

    def summary(self) -> tuple[str, ...]:
        """Who sees how many satellites, how much of the time; a sentence a node."""
        return tuple(_seen(r) for r in self.record["nodes"])

    def notes(self) -> tuple[str, ...]:
        """How well it is known, what is left out, and the Sun's part in links to the Earth."""
        notes = [f"{capital(EVIDENCE)}."]
        notes += [] if self.record["motion"] == TWO_BODY else [f"In {self.record['motion']}."]
        if self.record["latency"] is None:
            notes.append("Store and forward between stations is left out: there is too much of it.")
        elif self.record["latency"] and not self._waits():
            notes.append("Between any two stations a message passes without waiting, always.")
        if clear := [r["node"] for r in self.record["eclipses"] if not r["count"]]:
            notes.append(f"No eclipses of {', '.join(clear)}.")
        if earth := self.record["earth"]:
            angle, seasons = earth["sun_earth_mars_angle_deg"], len(earth["conjunction_seasons"])
            notes.append(
                f"Sun-Earth-Mars angle {angle['least']:.2f} to {angle['largest']:.2f} deg; "
                f"{counted(seasons, 'season')} below {earth['conjunction_deg']:g} deg"
            )
        return tuple(notes)

    def _waits(self) -> list[dict[str, Any]]:
        """Store and forward between stations, all of it if anything ever waits."""
        rows: list[dict[str, Any]] = self.record["latency"] or []
        return rows if any(r["longest_h"] or r["undelivered"] for r in rows) else []

    def tables(self) -> tuple[Table, ...]:
        """The tables for which there is something to say."""
        earth = self.record["earth"]["stations"] if self.record["earth"] else []
        parts = {
            "Satellites in sight": self.record["nodes"],
            "Reaching the Earth": earth,
            "Store and forward between stations": self._waits(),
            "In Mars's shadow": [r for r in self.record["eclipses"] if r["count"]],
            "Radio links along their windows": self.record["radio"],
            "Pairs": self.record["pairs"] if self.pairs else [],
        }
        return tuple(_table(title, rows) for title, rows in parts.items() if rows)

    def write(self, path: str | Path, *, command: str = "compass.access") -> None:
        """Write all windows as netCDF, CSV or JSON, as the file's name asks.

        Raises
        ------
        OutputError
            The name has another ending, or the file cannot be written.
        """
        chosen = Path(path)
        check_ending(chosen, ENDINGS["access"])
        if chosen.suffix == ".nc":
            save_netcdf(chosen, self.dataset.assign_attrs(history=command))
            return
        with replacing(chosen) as temporary:
            if chosen.suffix == ".json":
                text = json.dumps(self.to_dict(), indent=2, allow_nan=False)
                temporary.write_text(text + "\n", encoding="utf-8")
            else:
                write_csv(temporary, list(Window._fields), self.windows)

    def plot(self, name: str | None = None, *, axes: "Axes | None" = None) -> "Axes":
        """Draw when a node sees each satellite: a row a satellite, a bar a window.

        Parameters
        ----------
        name
            A station, a moon or ``Earth``; the first one without.
        axes
            Where to; new ones without.

        Raises
        ------
        ArgumentError
            There is no such node.
        """
        from compass.pictures.access import draw_timeline, height_of
        from compass.pictures.style import axes_or_new

        names = [str(record["node"]) for record in self.record["nodes"]]
        chosen = name or (names[0] if names else "")
        if chosen not in names:
            raise ArgumentError(
                f"name = {name!r}: no such node; {meant(chosen, names)}allowed "
                f"{', '.join(names) or 'none'}"
            )
        drawn = axes_or_new(axes, 8.0, height_of(self.survey, chosen))
        draw_timeline(drawn, self.survey, chosen)
        return drawn


#: What is the name of a row rather than a quantity, and its heading; shares by hops are words.
_WORDS = {
    "node": "node", "station": "station", "source": "from", "target": "to", "first": "from",
    "second": "to", "by_hops": "by links in the chain",
}  # fmt: skip

#: In JSON, but not in a table.
_UNTOLD = {"windows", "largest_cn0_dbhz"}


def _table(title: str, rows: Sequence[dict[str, Any]]) -> Table:
    """Table of records with the same keys."""
    unpaired = {"largest_range_rate_km_s", "largest_light_time_s"} if title == "Pairs" else set()
    if title.startswith("Radio"):
        unpaired = {"least_range_km"}
    names = [name for name in rows[0] if name not in _UNTOLD | unpaired]
    header = tuple(
        _WORDS[name] if name in _WORDS else quantity(f"access.{name}").heading for name in names
    )
    return Table(title, header, tuple(tuple(_cell(r, name) for name in names) for r in rows))


def _seen(row: dict[str, Any]) -> str:
    """How many satellites a node sees, and how much of the time."""
    if not row["seen"]:
        return f"{row['node']} never sees a satellite."
    share = Value(quantity("access.any_share"), row["any_share"])
    if row["satellites"] == 1:
        return f"{row['node']} sees the satellite {share} % of the time."
    return (
        f"{row['node']} sees {row['seen']} of {row['satellites']} satellites, at least one of them "
        f"{share} % of the time."
    )


def _cell(row: dict[str, Any], name: str) -> object:
    value = row[name]
    if name == "by_hops":
        shares = ((n, Value(quantity("access.share"), share)) for n, share in (value or {}).items())
        return ", ".join(f"{n}: {share} %" for n, share in shares) or "–"
    if name in _WORDS:
        return value
    return "–" if value is None else Value(quantity(f"access.{name}"), value)
