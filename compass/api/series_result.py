"""What stations see over time, as `compass.series` returns it: tables, files, curves."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.api.access_result import WINDOWS_GOOD_TO
from compass.api.results import Result
from compass.contacts.gaps import GapStatistics
from compass.coverage.errors import ERRORS
from compass.design import Design
from compass.document import Interval, Page, Sentence, Table, Value, Verdict
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.quantities import Quantity, quantity
from compass.quantities.draws import percentiles, share_of
from compass.saving import ENDINGS, check_ending, replacing, save_netcdf, write_csv
from compass.signal.budget import basis
from compass.words import capital, counted

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

#: What stands in files, over stations and time.
NAMES = ("count", "gdop", "pdop", "hdop", "vdop", "tdop", "age_h")

#: Shares of the time of users, in the order of their hits.
SHARES = ("fix_share", "few_share", "beyond_beam_share")

#: Why there are no errors in metres.
NO_SIGNAL = "needs the errors of ranges; give one design with a table [signal]"


@dataclass(frozen=True, repr=False)
class SeriesResult(Result):
    """What stations see over time.

    Attributes
    ----------
    design
        With the stations that were asked for.
    fold
        Satellites wanted in view.
    days, start_day
        Length of the span, and the day after the epoch at which it begins.
    motion
        How the satellites move, in words.
    gaps
        By station: when fewer are in view, found by rise and set.
    fewest
        By station: in view at any time, likewise.
    dataset
        Count and dilutions over station and time.
    errors
        Of a design with a signal: satellites in view and errors of fixes over user and time,
        stations first, then who moves; else None.
    beam_deg
        Half angle of the antennas that errors are within, about the way down; None all around.
    drawn, drawn_errors
        As `dataset` and `errors`, at random moments: what shares and percentiles are told by.
    """

    design: Design = field(repr=False)
    fold: int
    days: float
    start_day: float
    motion: str
    gaps: dict[str, GapStatistics]
    fewest: dict[str, int]
    dataset: "xr.Dataset" = field(repr=False)
    errors: "xr.Dataset | None" = field(repr=False, default=None)
    beam_deg: float | None = None
    drawn: "xr.Dataset" = field(repr=False, kw_only=True)
    drawn_errors: "xr.Dataset | None" = field(repr=False, default=None)

    @property
    def holds(self) -> bool:
        """Whether no station has a gap."""
        return not any(one.count for one in self.gaps.values())

    def rows(self) -> list[dict[str, Any]]:
        """Numbers of every station; dilutions may be infinite."""
        found = []
        for name, gaps in self.gaps.items():
            drawn = self.drawn.sel(station=name)
            dilutions: dict[str, Any] = {}
            for dop in ("gdop", "pdop"):
                known = percentiles(drawn[dop].values, (95,))
                dilutions |= {f"{dop}_{key}": value for key, value in known.items()}
            found.append(
                {
                    "station": name,
                    "fewest": self.fewest[name],
                    "share": gaps.share,
                    "gaps": gaps.count,
                    "cut": gaps.cut,
                    "longest_gap_h": gaps.longest / 3600.0,
                    "mean_gap_h": gaps.mean / 3600.0,
                    "p95_gap_h": gaps.p95 / 3600.0,
                    "time_average_gap_h": gaps.time_average / 3600.0,
                    "response_h": gaps.response / 3600.0,
                    "age_h": gaps.age / 3600.0,
                }
                | dilutions
            )
        return found

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        known = self.evidence()
        gaps = dict.fromkeys(("fewest", "share", "p95_gap_h"), known["gaps"])
        drawn = dict.fromkeys(("gdop_p95", "pdop_p95", *ERRORS, *SHARES), known["drawn"])
        return plain(
            {
                "design": self.design.name,
                "fold": self.fold,
                "motion": self.motion,
                "start_day": self.start_day,
                "days": self.days,
                "epochs": self.dataset.sizes["time"],
                "evidence": known | gaps | drawn,
                "stations": self.rows(),
                **({} if self.errors is None else {"users": self.error_rows()}),
            }
        )

    def error_rows(self) -> list[dict[str, Any]]:
        """Errors in metres of every user, one sigma, which may be infinite.

        The worst is that of the moments of `errors`, and of those drawn.
        """
        found: list[dict[str, Any]] = []
        if self.errors is None or self.drawn_errors is None:
            return found
        for name in self.errors.user.values.tolist():
            seen, drawn = self.errors.sel(user=name), self.drawn_errors.sel(user=name)
            few = drawn["in_view"].values < 4
            hits = (
                np.isfinite(drawn["error_position_m"].values),
                few,
                few & (drawn["in_view_all_around"].values >= 4),
            )
            row: dict[str, Any] = {"user": name}
            for share, hit in zip(SHARES, hits, strict=True):
                row |= share_of(share, hit)
            for each in ERRORS:
                row[each] = percentiles(drawn[each].values, (50, 95))
                row[each]["worst"] = float(max(of[each].max() for of in (seen, drawn)))
            found.append(row)
        return found

    def evidence(self) -> dict[str, str]:
        """How well the numbers of a station are known: of gaps, and at the moments looked at."""
        moments = (
            {}
            if self.errors is None
            else {
                "errors": "one sigma of weighted least squares of the ranges of each moment "
                f"alone: {basis(self.design)}"
            }
        )
        return moments | {
            "gaps": f"by rise and set, to {WINDOWS_GOOD_TO}; of this span alone",
            "drawn": f"{Interval.WORDS}, each by itself: {self.drawn.sizes['time']:,} random "
            "moments of the span",
        }

    def document(self) -> Page:
        """Whether there are gaps, then a table of them and of the dilutions; then errors."""
        if not self.gaps:
            return Page(self.design.name, (self._verdict_of_movers(), *self.error_blocks()))
        lacking = [name for name, one in self.gaps.items() if one.count]
        span = counted(self.days, "day")
        claim = f"{counted(self.fold, 'satellite')} in view at all times over {span}"
        if lacking:
            claim = f"fewer than {self.fold} in view at times at {', '.join(lacking)}"
        known = self.evidence()
        how = (
            f"{self.motion}; gaps and fewest in view {known['gaps']}, each station over its own "
            "horizon; those that the ends of the span cut off count with what lies inside; "
            "data are as old in the mean as the mean response is long. "
            f"Dilutions: {known['drawn']}; infinite with fewer than four in view, and that counts"
        )
        blocks = (Verdict("" if not lacking else "gaps", claim, not lacking), self._table())
        return Page(self.design.name, (*blocks, Sentence(how), *self.error_blocks()))

    def _verdict_of_movers(self) -> Verdict:
        """Whether users who move have a fix at every moment looked at; no gaps were asked for."""
        without = [row["user"] for row in self.error_rows() if row["fix_share"] < 1.0]
        moments = f"at all {self.drawn.sizes['time']:,} moments over {counted(self.days, 'day')}"
        claim = f"a fix {moments}" if not without else f"no fix at times for {', '.join(without)}"
        return Verdict("", f"{claim}; {self.motion}", None)

    def error_blocks(self) -> tuple[Table | Sentence, ...]:
        """Errors of fixes in metres over time, of a design with a signal."""
        rows = self.error_rows()
        if not rows:
            return ()
        known, how = {name: quantity(name) for name in ERRORS}, self.evidence()["errors"]
        header = [f"{q.heading}, {p} % below" for q in known.values() for p in (50, 95)]
        part = quantity("part_share")
        shares = {"fix_share": "time with a fix, %", "few_share": "fewer than four in view, %"}
        if self.beam_deg is not None:
            shares["beyond_beam_share"] = "fewer because of beams alone, %"
        lines = tuple(
            (
                row["user"],
                *(_between(part, row, share) for share in shares),
                *(_between(known[name], row[name], p) for name in ERRORS for p in ("p50", "p95")),
            )
            for row in rows
        )
        return (
            Table("Errors of fixes over time", ("user", *shares.values(), *header), lines),
            Sentence(
                f"{capital(how)}; {self.evidence()['drawn']}; infinite where four satellites are "
                "not in view or their lines tell no fix, and that counts. An orbiter is hidden "
                "from them by Mars alone, has the receiver's noise of the zenith, no ionosphere."
            ),
            *(Sentence(words) for words in self.why_outside()),
        )

    def why_outside(self) -> tuple[str, ...]:
        """What beams leave of errors, and that gaps know nothing of them; nothing without beams."""
        if self.beam_deg is None:
            return ()
        return (
            f"A satellite is heard within {self.beam_deg:g} deg of its way down: where four stand "
            "over the horizon and fewer are heard, errors are infinite because of the beams. Gaps "
            "and dilutions above are of antennas that reach all around.",
        )

    def _table(self) -> Table:
        left = ("station", "age_h")
        names = [n for n in self.rows()[0] if n not in left and not n.endswith(Interval.SUFFIX)]
        known = {
            name: quantity(
                f"station.{name}"
                if name in ("fewest", "gdop_p95", "pdop_p95")
                else f"series.{name}"
            )
            for name in names
        }
        header = ("station", *(known[name].heading for name in names))
        rows = tuple(
            (row["station"], *(_between(known[name], row, name) for name in names))
            for row in self.rows()
        )
        return Table(f"Fewer than {self.fold} in view, and dilutions over time", header, rows)

    def write(self, path: str | Path, *, command: str = "compass.series") -> None:
        """Write the series as netCDF or CSV, as the file's name asks; errors stand in netCDF.

        Raises
        ------
        OutputError
            The name has another ending, or the file cannot be written.
        """
        chosen = Path(path)
        check_ending(chosen, ENDINGS["series"] if self.gaps else [".nc"])
        if chosen.suffix == ".nc":
            every = self.dataset if self.errors is None else self.dataset.merge(self.errors)
            save_netcdf(chosen, every.assign_attrs(self.dataset.attrs, history=command))
            return
        times = self.dataset.time.values
        columns = {name: self.dataset[name].values for name in NAMES}
        lines = (
            (station, float(times[t]), *(columns[name][k, t] for name in NAMES))
            for k, station in enumerate(self.dataset.station.values.tolist())
            for t in range(len(times))
        )
        with replacing(chosen) as temporary:
            write_csv(temporary, ["station", "time_s", *NAMES], lines)

    def plot(self, *, name: str = "count", axes: "Axes | None" = None) -> "Axes":
        """Draw satellites in view, or a dilution, against time, a line a station.

        Parameters
        ----------
        name
            ``count``, ``gdop``, ``pdop``, ``hdop``, ``vdop``, ``tdop`` or ``age_h``: hours since so
            many were last in view; or an error of a design with a signal, ``error_horizontal_m``,
            ``error_vertical_m``, ``error_position_m``, ``error_time_m``, of everyone.
        axes
            Where to; new ones without.

        Raises
        ------
        ArgumentError
            Another name.
        """
        if name in ERRORS and self.errors is None:
            raise ArgumentError(f"name = {name!r}: {NO_SIGNAL}")
        if name not in (*NAMES, *ERRORS):
            raise ArgumentError(f"name = {name!r}: allowed {', '.join((*NAMES, *ERRORS))}")
        if name in NAMES and not self.gaps:
            raise ArgumentError(f"{name}: is of stations; add one, or draw an error in metres")
        from compass.pictures.series import draw_errors, draw_series
        from compass.pictures.style import axes_or_new

        drawn = axes_or_new(axes, 8.0, 3.5)
        if self.errors is not None and name in ERRORS:
            draw_errors(drawn, self.errors, name)
        else:
            draw_series(drawn, self.dataset, name, self.fold)
        return drawn

    def save_plot(self, path: str | Path, name: str = "count") -> None:
        """Write `plot` as a PNG file; a killed run leaves no partial one."""
        from compass.pictures.files import save_axes

        save_axes(self.plot(name=name), path, bbox_inches="tight")


def _between(what: Quantity, row: dict[str, Any], key: str) -> Value:
    """A number with its bounds, if it has any."""
    return Value(what, row[key], Interval.beside(row, key))
