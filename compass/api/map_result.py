"""The maps of a design as text, numbers, pictures and a file."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.api.map_areas import AREAS_KNOWN, area_blocks, with_areas
from compass.api.map_errors import (
    error_blocks,
    protection_blocks,
    rest_of,
    why_no_fix,
    why_no_level,
)
from compass.api.map_global import with_global
from compass.api.map_statistics import (
    epochs_on,
    error_statistics,
    folds_met,
    protection_statistics,
    statistics,
)
from compass.api.progress import bar
from compass.api.results import Result
from compass.conventions import dated
from compass.coverage.areas import AreaFigures
from compass.coverage.certified_geometry import CertifiedGeometry
from compass.coverage.certified_percentile import bounded
from compass.coverage.drawn import Drawn
from compass.coverage.errors import ERRORS
from compass.coverage.files import write_map
from compass.coverage.gaps import next_prime
from compass.coverage.maps import DOPS
from compass.coverage.protection import LEVELS
from compass.design import Design
from compass.document import (
    Bracket,
    Interval,
    Page,
    Proven,
    Sampled,
    Sentence,
    Table,
    Value,
    Verdict,
)
from compass.document.blocks import facts
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.quantities import QUANTITIES, Quantity, quantity
from compass.requirement import standing_words
from compass.study.mapping import DesignMap

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


@dataclass(frozen=True, repr=False)
class MapResult(Result):
    """Maps of a design, and their numbers over the whole sphere and period.

    Attributes
    ----------
    design
        What was mapped.
    made
        The dataset, its cells, the constellation at the epochs.
    certified
        What is certain of availability and GDOP over all area and time; None where the motion
        has no bounds or none were asked for.
    areas
        Figures at the sites and in the regions that were asked for.
    drawn
        Figures at random places and moments, by which shares and percentiles are known that are
        not certified; None where nothing was drawn.
    """

    design: Design = field(repr=False)
    made: DesignMap = field(repr=False)
    certified: CertifiedGeometry | None = None
    areas: tuple[AreaFigures, ...] = ()
    drawn: Drawn | None = field(default=None, repr=False)

    @cached_property
    def dataset(self) -> "xr.Dataset":
        """Everything by cell, zone and epoch, area, and over the whole sphere, CF attributes."""
        known = with_global(self.made.dataset, self.numbers(), self.drawn)
        return dated(with_areas(known, self.areas))

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON, the answer first, in the order of the text."""
        answer = {"design": self.design.name, "fold": self.made.dataset.attrs["wanted_fold"]}
        areas = [area.as_dict() for area in self.areas]
        known = {"evidence": self.evidence(), "provenance": self.made.dataset.attrs}
        return plain(answer | {"met": self.met, "areas": areas} | self.numbers() | known)

    @property
    def users(self) -> str:
        """How high users stand and in which beams, in words; nothing on the ground, all around."""
        attrs = self.made.dataset.attrs
        beam = attrs.get("beam_deg")
        return standing_words(
            attrs["user_altitude_km"] * 1e3, None if beam is None else math.radians(beam)
        )

    @property
    def met(self) -> bool:
        """Whether the fold wanted is there everywhere, as far as any place looked at tells."""
        return bool(self.numbers()["count"]["min"] >= self.made.dataset.attrs["wanted_fold"])

    def evidence(self) -> dict[str, str]:
        """How well each number of the JSON is known, by its name there; `others` is the rest."""
        known = dict.fromkeys((name for name, _ in with_intervals(self.numbers())), self.interval)
        if self.certified:
            names = (*self.certified.brackets, "pdop_worst_bracket")
            known |= dict.fromkeys(names, f"between proven bounds, {self.certified.scope}")
            if (least := self.certified.in_view) and not self._open(*least.least):
                known["met"] = str(Proven(self.certified.scope))
        if self.areas:
            known["areas"] = AREAS_KNOWN
        gaps = f"sampled at cells, at each to {self.made.dataset.attrs['gap_step_s']:.3g} s"
        known |= dict.fromkeys(("longest_gap_s", "mean_response_time_s"), gaps)
        return known | {"others": self.sampled}

    def _open(self, low: int, high: int) -> bool:
        """Whether the fold wanted lies between bounds of the fewest in view."""
        return low < self.made.dataset.attrs["wanted_fold"] <= high

    @property
    def sampled(self) -> str:
        """What the figures that are not certified are of, and how well that says them."""
        attrs = self.made.dataset.attrs
        return (
            f"sampled {self.looked.how} of the {attrs['figure']}{self.users}, over "
            f"{attrs['period_s'] / 3600:.6g} h of {attrs['motion_model']} motion: "
            "what lies between is not seen, and by how much that moves them is not known; "
            "weighted by area and time, infinities count"
        )

    def numbers(self) -> dict[str, Any]:
        """Numbers over all area and time; certified ones are the middle of their brackets."""
        return self._numbers

    @cached_property
    def _numbers(self) -> dict[str, Any]:
        numbers = statistics(self.made.dataset, self.drawn)
        if self.certified:
            known = self.certified.numbers()
            several = {*self.certified.dops, "fold_share", "count"} & known.keys()
            numbers |= known | {name: _beside(numbers[name] | known[name]) for name in several}
            for name, fold in (("fewer_than_four_share", "4"), ("fewer_than_five_share", "5")):
                few = rest_of(fold, numbers["fold_share"]) if fold in numbers["fold_share"] else {}
                proven, told = Bracket.beside(few, fold), Interval.beside(numbers, name)
                if proven and told and proven.high - proven.low <= told.high - told.low:
                    numbers |= {name: few[fold], name + Bracket.SUFFIX: [proven.low, proven.high]}
        return _beside(numbers)

    @property
    def interval(self) -> str:
        """How well what was drawn is known, in words."""
        return f"{Interval.WORDS}, {self.drawn.how if self.drawn else ''}"

    def document(self) -> Page:
        """Fold and availability in a sentence, then the numbers."""
        numbers, attrs = self.numbers(), self.made.dataset.attrs
        fold = attrs["wanted_fold"]
        p50, p95 = (self._percentile("gdop", numbers, q) for q in ("p50", "p95"))
        weaker = [p.evidence for p in (p95, p50) if not isinstance(p.evidence, Bracket)]
        sure = str(weaker[0]) if weaker else Bracket.WORDS
        users = f", of users{self.users[1:]}" if self.users else ""
        claim = (
            f"{numbers['count']['min']} to {numbers['count']['max']} satellites in view, "
            f"{fold} wanted; GDOP {p50} (median), {p95} (95 % of area and time){users}; {sure}"
        )
        others = "the other figures are " if self.certified else ""
        return Page(
            self.design.name,
            (
                Verdict("" if self.met else "missed", claim, self.met),
                *area_blocks(self.areas),
                *self.tables(),
                *error_blocks(self),
                *protection_blocks(self),
                *(Sentence(said) for said in (*self.certain(), *self.by_chance())),
                Sentence(others + self.sampled),
                *self._between_epochs(),
            ),
        )

    def _percentile(self, name: str, numbers: dict[str, Any], percentile: str) -> Value:
        """One percentile of a dilution, with its bounds.

        Infinite where it is beyond all that is looked for, as it counts.
        """
        of = numbers[name]
        proven = bounded(name, of, percentile)
        if proven.evidence is not None and proven.value == math.inf:
            return proven
        return self.value(quantity(name), of, percentile)

    def value(self, what: Quantity, of: dict[str, Any], key: str, whose: str = "") -> Value:
        """A number with the bounds that stand beside it; else as cells and epochs were sampled."""
        how = self.drawn.how if self.drawn else ""
        known = Bracket.beside(of, key) or Interval.beside(of, key, how) or self.looked
        return Value(what, of[key], known, whose)

    def certain(self) -> tuple[str, ...]:
        """What was certified, and how, in a sentence; nothing where nothing was."""
        if not self.certified:
            return ()
        holds = (
            "Figures between proven bounds hold everywhere and not only at cells"
            if self.certified.brackets
            else "No figures are known between proven bounds"
        )
        return f"{holds}, {self.certified.scope}.", *self._worst()

    def by_chance(self) -> tuple[str, ...]:
        """Of what the bounds are that are not proven, in a sentence; nothing without any."""
        if self.drawn is None:
            return ()
        hours = self.made.dataset.attrs["period_s"] / 3600
        return (
            f"Other bounds hold in 95 of 100 cases, each by itself: by {self.drawn.how} in "
            f"{hours:.6g} h, anywhere by area.",
        )

    def _worst(self) -> tuple[str, ...]:
        """The largest PDOP, and where, in a sentence; nothing where it was not looked for."""
        worst = self.certified.worst if self.certified else None
        return () if worst is None else (f"The largest PDOP is {worst.sentence}.",)

    @cached_property
    def errors(self) -> dict[str, Any]:
        """Numbers of the errors of fixes, as `compass.api.map_statistics.error_statistics`."""
        return error_statistics(self.made.dataset, self.drawn)

    @cached_property
    def levels(self) -> dict[str, Any]:
        """Of protection levels, as `compass.api.map_statistics.protection_statistics`."""
        return protection_statistics(self.made.dataset, self.drawn)

    def _between_epochs(self) -> list[Sentence]:
        """How well gaps are known, and whether the epochs are too few for the quickest pass."""
        attrs = self.made.dataset.attrs
        ends = "go on at its start" if attrs["gap_span_repeats"] else "are cut there"
        told = [
            Sentence(
                f"gaps are followed every {attrs['gap_step_s']:.3g} s and known to that; those at "
                f"the end of the span {ends}"
            )
        ]
        step, quickest = attrs["period_s"] / attrs["epochs"], attrs["shortest_pass_s"]
        if step > quickest / 4:
            enough = next_prime(math.ceil(4 * attrs["period_s"] / quickest))
            told.append(
                Sentence(
                    f"WARNING: the epochs are {step / 60:.3g} min apart, and the quickest "
                    f"satellite crosses overhead in {quickest / 60:.3g} min: shares and "
                    f"percentiles can be far off; ask for {enough} epochs or more"
                )
            )
        return told

    def tables(self) -> tuple[Table, ...]:
        """Satellites in view, and dilution of precision, over area and time."""
        numbers = self.numbers()
        attrs, share = self.made.dataset.attrs, quantity("fold_share")
        threshold, fold, step = attrs["pdop_threshold"], attrs["wanted_fold"], attrs["gap_step_s"]
        followed = Sampled(step, f"at cells, at each to {step:.3g} s")
        count, folds = numbers["count"], numbers["fold_share"]
        in_view = facts(
            "Satellites in view, over area and time",
            [
                *(
                    self.value(quantity(f"count.{name}"), count, name)
                    for name in ("min", "mean", "max")
                ),
                *(
                    self.value(share, folds, k, f"at least {k} in view")
                    for k in map(str, folds_met(self.made.dataset))
                    if int(k) >= min(fold, count["min"])  # fewer are in view everywhere
                ),
                self.value(
                    quantity("availability"), numbers, "availability", f"{threshold:g} or less"
                ),
                *(
                    Value(quantity(name), numbers[name], followed, f"{fold} in view")
                    for name in ("longest_gap_s", "mean_response_time_s")
                    if numbers[name] > 0
                ),
            ],
        )
        percentiles = [f"p{int(q)}" for q in self.made.dataset.global_percentile.values]
        rows = tuple(
            (
                quantity(name).title,
                *(self._percentile(name, numbers, p) for p in percentiles),
                self._known(name, percentiles),
            )
            for name in DOPS
        )
        title = "Dilution of precision: percentiles over area and time"
        none = "No dilution of precision is told: over half of area and time has no fix."
        return in_view, Table(title, ("", *percentiles, "evidence"), rows, None, none)

    def _known(self, name: str, percentiles: list[str]) -> str:
        """How well the percentiles of a dilution are known, in words."""
        sampled = self.interval if self.drawn else str(self.looked)
        brackets = self.certified.brackets if self.certified else {}
        proven = [p for p in percentiles if f"{name}.{p}" in brackets]
        if not proven:
            return sampled
        if len(proven) == len(percentiles):
            return Bracket.WORDS
        return f"{', '.join(proven)} {Bracket.WORDS}; the rest {sampled}"

    @property
    def looked(self) -> Sampled:
        """How the figures that are not certified are known: at so many epochs and cells."""
        attrs = self.made.dataset.attrs
        return Sampled(how=f"at {epochs_on(attrs['epochs'], attrs['grid'])}")

    def write(self, path: str | Path, *, time_series: bool = False, progress: bool = False) -> None:
        """Write the maps as CF netCDF; with `time_series` also every epoch's counts and DOPs.

        Raises
        ------
        OutputError
            The file cannot be written.
        """
        series = (self.made.view, self.made.grid) if time_series else None
        with bar(progress, "series", unit="row", leave=False) as rows:
            write_map(
                self.dataset, Path(path), self.design.figure, series=series, progress=rows.update
            )

    def plot(
        self, name: str = "gdop", *, percentile: int = 95, axes: "Axes | None" = None
    ) -> "Axes":
        """Draw a map of Mars.

        Parameters
        ----------
        name
            A variable of the dataset over (lat, lon): ``gdop`` ... ``tdop``, ``count_min``,
            ``count_mean``, ``count_max``, ``availability``, ``longest_gap``, ...
        percentile
            Of a dilution of precision over time: 50 or 95.
        axes
            Where to; new ones without.

        Raises
        ------
        ArgumentError
            There is no such variable or percentile.
        """
        from compass.pictures.maps import LARGE, draw_map
        from compass.pictures.style import axes_or_new

        values, title = self._layer(name, percentile)
        title += self._why_nowhere(name, percentile)
        known = QUANTITIES.get(name)
        drawn = axes_or_new(axes, *LARGE)
        draw_map(
            drawn,
            values.values,
            self.made.grid,
            f"{self.design.name}{self.users}: {title}",
            known.heading if known else str(values.attrs["long_name"]),
            figure_name=self.design.figure.name,
            scale=_scale(name, values),
            of=name,
            wanted=self.design.fold,
        )
        return drawn

    def nowhere(self, name: str, percentile: int = 95) -> bool:
        """Whether a map is infinite at every cell, and shows nothing."""
        return not np.isfinite(self._layer(name, percentile)[0].values).any()

    def _why_nowhere(self, name: str, percentile: int) -> str:
        """Why a map of errors or levels is infinite everywhere, for its title; else nothing."""
        if name not in (*ERRORS, *LEVELS) or not self.nowhere(name, percentile):
            return ""
        why = why_no_fix(self) if name in ERRORS else why_no_level(self)
        return "".join("\n" + fill(words, 90) for words in why)

    def save_plot(self, path: str | Path, name: str = "gdop", *, percentile: int = 95) -> None:
        """Write `plot` as a PNG file; a killed run leaves no partial one."""
        from compass.pictures.files import save_axes

        save_axes(self.plot(name, percentile=percentile), path)

    def _layer(self, name: str, percentile: int) -> "tuple[xr.DataArray, str]":
        """Values by cell and what they are."""
        flat = [
            str(key)
            for key, variable in self.dataset.data_vars.items()
            if variable.dims in (("lat", "lon"), ("percentile", "lat", "lon"))
        ]
        if name not in flat:
            raise ArgumentError(f"name = {name!r}: not a map; allowed {', '.join(flat)}")
        layer = self.dataset[name]
        if "percentile" not in layer.dims:
            return layer, str(layer.attrs["long_name"])
        allowed = layer.percentile.values.tolist()
        if percentile not in allowed:
            raise ArgumentError(
                f"percentile = {percentile}: allowed {' or '.join(str(q) for q in allowed)}"
            )
        chosen = layer.sel(percentile=percentile)
        return chosen, f"{quantity(name).title}, {percentile}th percentile over time"


def _beside(known: dict[str, Any]) -> dict[str, Any]:
    """Numbers in their order, behind each its bracket; else its interval."""
    beside: dict[str, Any] = {}
    for name, value in known.items():
        if name.endswith((Bracket.SUFFIX, Interval.SUFFIX)):
            continue
        beside[name] = value
        for key in (name + Bracket.SUFFIX, name + Interval.SUFFIX):
            if key in known:
                beside[key] = known[key]
                break
    return beside | {name: known[name] for name in ("pdop_worst_bracket",) if name in known}


def with_intervals(known: dict[str, Any], path: str = "") -> Iterator[tuple[str, list[float]]]:
    """Names of numbers with an interval beside them, and that."""
    for name, value in known.items():
        if isinstance(value, dict):
            yield from with_intervals(value, f"{path}{name}.")
        elif name.endswith(Interval.SUFFIX):
            yield path + name.removesuffix(Interval.SUFFIX), value


def _scale(name: str, values: "xr.DataArray") -> Any:
    """How the colours of a map run."""
    if name in DOPS or name in ERRORS or name in LEVELS:
        return "dilution"
    if np.issubdtype(values.dtype, np.integer):
        return "counts"
    return "share" if name in ("availability", "detection_share", "protection_share") else "linear"
