"""A study over many candidates, resumable, on a cluster if asked."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from tqdm import tqdm

from compass.allowed import check_all_allowed
from compass.api.cluster import check_cluster
from compass.api.given import given_study
from compass.api.map_areas import AREAS_KNOWN
from compass.api.progress import bar
from compass.api.results import Result
from compass.arguments import checked
from compass.clocks import clock_named
from compass.core.compiling import worked
from compass.cores import cores
from compass.document import Bracket, Interval, Page, Sampled, Sentence, Table, Value, Verdict
from compass.document.blocks import Block
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.inputs.study import Study
from compass.quantities.merits import MERITS, STAGES, merits_of
from compass.saving import check_writable
from compass.study.area_figures import BETWEEN, area_columns, shown_areas
from compass.study.bounds import bracketed_figures, limited_figures
from compass.study.candidates import check_space
from compass.study.clocks import errors_by_clock
from compass.study.cluster import Cluster, Tls
from compass.study.columns import Shown, shown
from compass.study.draw_bounds import drawn_figures
from compass.study.draws import entries_at
from compass.study.judge import check_lander, doubts_of
from compass.study.requirement_figures import requirement_columns, shown_requirements
from compass.study.results import first_front, results_of, write_results
from compass.study.sampling import front_known, rests_on_samples, sampled_over, sampling_of
from compass.study.stages import StudyJob
from compass.study.store import Store
from compass.study.trade import Summary, run_trade
from compass.study.workers import Processes, Workers
from compass.words import capital, counted

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

#: Rows of the front that the text lists.
LISTED = 25


@dataclass(frozen=True, repr=False)
class TradeResult(Result):
    """Every candidate of a study, and the front of the best.

    Attributes
    ----------
    study
        What was asked.
    store
        Folder in which every finished batch is kept.
    summary
        What this run did.
    dataset
        Figures of merit by candidate.
    by_clock
        Errors in metres of those on the front with every named clock, where the study asks for
        such errors.
    """

    study: Study = field(repr=False)
    store: Path
    summary: Summary
    dataset: "xr.Dataset" = field(repr=False)
    by_clock: tuple[dict[str, Any], ...] = field(default=(), repr=False)

    @property
    def front(self) -> list[dict[str, Any]]:
        """Candidates that no other one beats in every objective."""
        return first_front(self.study, self.dataset)

    @property
    def feasible(self) -> int:
        """How many meet every constraint."""
        return int(self.dataset.feasible.sum())

    @property
    def holds(self) -> bool:
        """Whether there is a front, and all candidates were looked at."""
        s = self.summary
        left = s.unfinished or self.dataset.attrs["waiting"] or s.over in STAGES
        return bool(self.front) and not left

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        s = self.summary
        return plain(
            {
                "study": self.study.name,
                "store": str(self.store),
                "candidates": s.candidates,
                "reached": s.reached,
                "computed": s.computed,
                "failed": s.failed,
                "unfinished": s.unfinished,
                "lethal": s.lethal,
                "seconds": s.seconds,
                "feasible": self.feasible,
                "bounded": s.bounded,
                "over": s.over,
                "waiting": int(self.dataset.attrs["waiting"]),
                "straddling": int(self.dataset.straddling.sum()),
                "requirements": [wanted.claim for wanted in self.study.requirements],
                "front": self.front,
                "by_clock": list(self.by_clock),
                "sampled_over": self._sampled_over,
                "evidence": dict.fromkeys(self._shares + self._areas, Bracket.WORDS)
                | {name: self._bounded(name) for name in self._bracketed}
                | {name: str(Sampled(how=how)) for name, how in self._sampled_over.items()}
                | dict.fromkeys(drawn_figures(self.study), Interval.WORDS),
                "drawn": s.drawn,
                "rests_on_samples": rests_on_samples(self.study),
            }
        )

    def document(self) -> Page:
        """How many are left, the front, and what the run did."""
        s, front = self.summary, self.front
        claim = (
            f"{s.candidates} candidates, {self.feasible} meet every constraint, {len(front)} on "
            "the Pareto front"
        )
        blocks: list[Block] = [Verdict("", claim, self.holds)]
        blocks += [Sentence(words) for words in self.notes()]
        if self.study.entry is not None:
            own = ["every candidate"] if self.study.signal is not None else []
            doubts = doubts_of(self.study.entry.scenario, self.study.entry.doubts)
            blocks.append(Sentence(doubts.sentence(own)))
        if front:
            goals = {objective.figure for objective in self.study.objectives}
            apart = {*requirement_columns(self.study), *area_columns(self.study)} - goals
            blocks.append(_front_table(front, apart))
            blocks += _each_table(
                "At sites and in regions, on the front", front, shown_areas(self.study)
            )
            blocks += _each_table(
                "Requirements on the front", front, shown_requirements(self.study)
            )
            blocks += [Sentence(words) for words in self._evidence()]
            blocks += clock_blocks(self.study, self.by_clock)
        stages = tuple(
            (n, s.reached[n], s.computed[n], s.failed[n], round(s.seconds.get(n, 0.0), 2))
            for n in s.reached
        )
        header = ("stage", "candidates", "computed now", "raised", "work s")
        return Page(self.study.name, (*blocks, Table("Stages", header, stages)))

    @property
    def _sampled_over(self) -> dict[str, str]:
        """What figures without proven bounds were sampled over, by name."""
        return {
            name: how
            for name in MERITS
            if name not in self._bracketed and (how := sampling_of(self.study, name))
        }

    @property
    def _bracketed(self) -> list[str]:
        """Figures of those that may be of the front that lie between proven bounds."""
        return bracketed_figures(self.study) if self.summary.bounded else []

    @staticmethod
    def _is_bare(row: dict[str, Any], name: str) -> bool:
        """Whether one of the front has a figure whose bounds are not found yet."""
        value = row.get(name)
        return value is not None and value == value and row.get(name + Bracket.SUFFIX) is None

    def _bounded(self, name: str) -> str:
        """How well a figure with bounds is known on the front."""
        if any(self._is_bare(row, name) for row in self.front):
            return f"{Bracket.WORDS}; sampled where {name}{Bracket.SUFFIX} is null"
        return Bracket.WORDS

    @property
    def _shares(self) -> list[str]:
        """Columns of shares of requirements, each an end of proven bounds."""
        if not self.study.requirements:
            return []
        columns = (*merits_of("requirements"), *requirement_columns(self.study))
        return [name for name in columns if name.endswith(("_share", "_share_most"))]

    @property
    def _areas(self) -> list[str]:
        """Figures and columns of sites and regions that lie between proven bounds, or are one."""
        return [*BETWEEN, *area_columns(self.study)] if "areas" in self.study.stages else []

    def _evidence(self) -> tuple[str, ...]:
        """How well the front is known: which figures are bracketed, which sampled."""
        front, said = self.front, []
        bounded = self._bracketed
        if everywhere := [name for name in bounded if name not in BETWEEN]:
            titles = ", ".join(MERITS[name].title for name in everywhere)
            words = f"between proven bounds, everywhere and for all time: {titles}"
            if any(self._is_bare(row, name) for row in front for name in everywhere):
                words += "; of one number alone the bounds are not found yet: it is sampled"
            said.append(words)
        told = [name for name in limited_figures(self.study) if name not in bounded]
        if told and self.summary.bounded:
            titles = ", ".join(MERITS[name].title for name in told)
            said.append(f"sampled, but on which side of its limit by proven bounds: {titles}")
        if self._areas:
            said.append(f"at sites and in regions: {AREAS_KNOWN}")
        if drawn := self._drawn():
            said.append(f"more was drawn of {drawn}")
        said.append(front_known(self.study, self.dataset))
        rest = [name for name in (*front[0], *self.study.named) if name not in bounded]
        if how := sampled_over(self.study, list(dict.fromkeys(rest))):
            said.append(f"sampled: {how}")
        return tuple(said)

    def _drawn(self) -> str:
        """Of how many candidates more was drawn, level by level; nothing if of none."""
        each = {level: number for level, number in self.summary.drawn.items() if number}
        entries = bool(drawn_figures(self.study, "entry"))
        return ", then of ".join(
            f"{number}" + f" (to {entries_at(level, self.study)} entries)" * entries
            for level, number in each.items()
        )

    def plot(self, *, axes: "Axes | None" = None) -> "Axes":
        """Draw the front in the first two objectives; of one objective against the satellites.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.front import draw_front
        from compass.pictures.style import axes_or_new, look

        named = dict.fromkeys([*(o.figure for o in self.study.objectives), "satellites", "planes"])
        first, second = list(named)[:2]
        drawn = axes_or_new(axes, 5.6, 5.2)
        with look():
            draw_front(drawn, self.dataset, first, second)
            drawn.set_title(self.study.name)
            drawn.legend(frameon=False, fontsize=8)
        return drawn

    def notes(self) -> tuple[str, ...]:
        """What went wrong, and what to do about it."""
        s, notes = self.summary, []
        if s.unfinished:
            more = ["..."] if s.unfinished > len(s.lethal) else []
            notes.append(
                f"{counted(s.unfinished, 'candidate')} left out, whose workers died or had too "
                "little memory; the same command tries them again:\n  "
                + "\n  ".join(s.lethal + more)
            )
        if s.over:
            notes.append(
                f"the time allowed was over during stage {s.over}; what was begun of a candidate "
                "is not kept, and the same command goes on from what is stored"
            )
        if (waiting := int(self.dataset.attrs["waiting"])) > s.unfinished:
            notes.append(f"{counted(waiting, 'candidate')} not looked at to the end so far")
        if open_ := int(self.dataset.straddling.sum()):
            notes.append(
                f"of {counted(open_, 'candidate')} it is not decided within the budget "
                "whether they meet a limit on geometry, which lies between their bounds; they "
                "are not counted; --budget-s (budget_s) looks longer"
            )
        errors = [text for text in self.dataset.error.values if text]
        if errors:
            notes.append(
                f"{counted(len(errors), 'candidate')} raised an error and went no "
                f"further; the first: {errors[0]}"
            )
        if self.feasible and not self.front:
            of_them = self.dataset.isel(candidate=self.dataset.feasible.values)
            figures = [objective.figure for objective in self.study.objectives]
            lacking = [figure for figure in figures if of_them[figure].isnull().all()]
            notes.append(
                "no candidate that meets every constraint has a value of "
                f"{' or of '.join(lacking) or 'every objective'}; choose another objective"
            )
        return tuple(notes)


def clock_blocks(study: Study, by_clock: Sequence[dict[str, Any]]) -> list[Block]:
    """What a better clock buys against more satellites, a table a figure and what it says.

    Nothing without errors in metres (`compass.study.clocks.errors_by_clock`).
    """
    blocks: list[Block] = []
    for figure in dict.fromkeys(one["figure"] for one in by_clock):
        rows = [one for one in by_clock if one["figure"] == figure]
        known = MERITS[figure].quantity
        cells = tuple(
            (
                one["identity"],
                one["satellites"],
                *(Value(known, error) for error in (one["own"], *one["m"].values())),
            )
            for one in rows
        )
        titles = (clock_named(name).title for name in rows[0]["m"])
        header = ("identity", "satellites", "the study's own", *titles)
        sure = f"sampled over {sampling_of(study, figure)}, with every clock the same samples"
        blocks.append(Table(f"With each clock: {known.heading} ({sure})", header, cells, LISTED))
        blocks += [Sentence(words) for words in _clock_against_satellites(study, rows)]
    return blocks


def _clock_against_satellites(study: Study, rows: Sequence[dict[str, Any]]) -> tuple[str, ...]:
    """What the smallest of them gains by the best clock, and by the next more satellites."""
    assert study.signal is not None
    assert study.signal.clock is not None
    finite = [one for one in rows if np.isfinite(one["own"])]
    sizes = sorted({one["satellites"] for one in finite})
    if len(sizes) < 2:
        return ()
    few, more = (next(one for one in finite if one["satellites"] == n) for n in sizes[:2])
    known, clock = MERITS[few["figure"]].quantity, study.signal.clock.title
    best = min(few["m"], key=few["m"].__getitem__)
    written = [Value(known, x) for x in (few["own"], few["m"][best], more["own"])]
    buys = "more" if few["m"][best] < more["own"] else "less"
    return (
        f"{capital(known.title)}, sampled: {sizes[0]} satellites with {clock} have {written[0]} m; "
        f"the best clock, {clock_named(best).title}, makes that {written[1]} m, "
        f"{sizes[1] - sizes[0]} more with {clock} make it {written[2]} m: here a better clock buys "
        f"{buys}",
    )


def _each_table(title: str, front: list[dict[str, Any]], asked: list[Shown]) -> list[Block]:
    """How those on the front do by each of several things; nothing where none is known."""
    columns = {name: [one[name] for one in front] for *_, names in asked for name in names}
    if not (found := shown(asked, columns)):
        return []
    cells = zip(*(values for _, values in found), strict=True)
    rows = tuple((one["identity"], *row) for one, row in zip(front, cells, strict=True))
    return [Table(title, ("identity", *(heading for heading, _ in found)), rows, LISTED)]


def _front_table(front: list[dict[str, Any]], apart: Collection[str]) -> Table:
    """The first front, bounds in the place of figures, without what is shown `apart`."""
    beside = Bracket.SUFFIX, Interval.SUFFIX
    names = [name for name in front[0] if not (name.endswith(beside) or name in apart)]

    def written(row: dict[str, Any], name: str) -> Any:
        known = Bracket.beside(row, name) or Interval.beside(row, name)
        return row[name] if known is None else Value(MERITS[name].quantity, row[name], known)

    rows = tuple(tuple(written(row, name) for name in names) for row in front)
    return Table("Pareto front", tuple(names), rows, LISTED)


@checked
def trade(
    study: Study | str | Path,
    *,
    store: str | Path | None = None,
    budget_s: float | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    tls_ca: str | Path | None = None,
    tls_cert: str | Path | None = None,
    tls_key: str | Path | None = None,
    progress: bool = False,
    notice: Callable[[str], object] = lambda words: None,
) -> TradeResult:
    """Judge every candidate of a study: an exact screen first, then maps, then entries.

    Every finished batch is stored at once; the same call resumes a run that was stopped.

    Parameters
    ----------
    study
        A study, or the path of its file.
    store
        Folder of the store; by default ``trades/`` and the name of the file.
    budget_s
        Seconds after which the run ends, wherever it is; the next goes on from what is stored.
        Those in which kernels are compiled for the first time do not count; on a cluster those
        until its first answer.
        What the default leaves of them brings bounds nearer, where it is still open who is on the
        front or meets a limit. By default the run takes as long as it takes.
    workers
        Processes on this machine; by default one a core.
    scheduler
        Address of a Dask scheduler, such as ``tcp://host:8786``, instead.
    tls_ca, tls_cert, tls_key
        Certificates of a cluster that wants them, all three.
    progress
        Show bars on stderr.
    notice
        Told what is to be known before the work begins, such as damaged lines of the store.

    Raises
    ------
    ArgumentError, DesignError, OutputError
        An option, the study or the store is not allowed.

    Examples
    --------
    >>> import tempfile
    >>> import compass
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     found = compass.trade("designs/study-small.toml", store=folder, workers=1)
    >>> found.front[0]["satellites"], found.feasible
    (15, 63)
    """
    began = worked()
    check_all_allowed(budget_s=budget_s)
    tls = check_cluster(workers, scheduler, tls_ca, tls_cert, tls_key)
    read = given_study(study)
    check_space(read)
    if read.entry is not None:
        check_lander(read.entry.scenario, read.entry.samples, read.seed)
    folder = Path(store) if store is not None else _folder(study)

    def bars(title: str, total: int, already: int) -> tqdm:
        return bar(progress, title, total=total, initial=already, smoothing=0.05)

    with Store(folder, read) as kept:
        if kept.damaged:
            notice(
                f"{kept.path}: {counted(len(kept.damaged), 'damaged line')} ignored "
                f"({kept.damaged[0]}); candidates that no other line has are computed again"
            )
        for suffix in (".nc", ".csv"):
            check_writable(folder / f"trade{suffix}")
        team = _team(read, workers, scheduler, tls)
        try:
            left = None if budget_s is None else max(budget_s - (worked() - began), 0.0)
            summary = run_trade(read, kept, team, bars, left)
        finally:
            team.close()
        results = results_of(read, kept.batches, kept.path)
        write_results(results, folder / "trade.nc")
    return TradeResult(read, folder, summary, results, tuple(errors_by_clock(read, results)))


def _folder(study: Study | str | Path) -> Path:
    """Where a study's store is by default."""
    if isinstance(study, Study):
        raise ArgumentError("store: needed for a study that is not read from a file; name a folder")
    return Path("trades") / Path(study).stem


def _team(study: Study, workers: int | None, scheduler: str | None, tls: Tls | None) -> Workers:
    """Who works on the study."""
    if scheduler is not None:
        return Cluster(StudyJob(study), scheduler, tls)
    count = cores(workers)
    return Processes(study, count)  # one too: a candidate may kill whoever looks at it
