"""Every requirement of a design: met or missed, with the evidence, the margin and the worst."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from math import degrees, isinf, pi
from pathlib import Path
from typing import TYPE_CHECKING, Any

from compass.api.given import in_metres, joined_designs, with_beacons
from compass.api.progress import bar
from compass.api.results import Result
from compass.arguments import checked
from compass.cores import cores, shared
from compass.coverage.certified_effort import Effort
from compass.coverage.requirement_verdict import verdict_of
from compass.coverage.verdict import NEAR
from compass.coverage.verdict import Verdict as Answer
from compass.design import Design
from compass.document import Bracket, Page, Proven, Sentence, Table, Value, Verdict
from compass.document.blocks import Block
from compass.document.plain import plain
from compass.orbits.motion import MotionModel
from compass.quantities import quantity
from compass.requirement import Requirement
from compass.sites import Site
from compass.words import counted, latitude_words, longitude_words, ordinal

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, repr=False)
class CheckResult(Result):
    """The requirements of a design and their verdicts.

    Attributes
    ----------
    design
        What was asked about.
    verdicts
        One a requirement, in the file's order.
    """

    design: Design = field(repr=False)
    verdicts: tuple[Answer, ...]

    @property
    def holds(self) -> bool:
        """Whether all are met."""
        return all(verdict.met is True for verdict in self.verdicts)

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return plain(
            {
                "design": self.design.name,
                "holds": self.holds,
                "requirements": [verdict.as_dict() for verdict in self.verdicts],
            }
        )

    def document(self) -> Page:
        """The answer, the table of verdicts, and what is said of each."""
        return Page(self.design.name, self.blocks())

    def plot(self, *, axes: "Axes | None" = None) -> "Axes":
        """Draw the margin of each requirement; of those without one only its name.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.bars import draw_bars

        return draw_bars(
            axes,
            [f"{v.requirement.name}: {v.word}" for v in self.verdicts],
            [None if v.margin is None else degrees(v.margin) for v in self.verdicts],
            quantity("requirement_margin_deg"),
            f"{self.design.name}: margins of the requirements",
            missed=[v.met is False for v in self.verdicts],
        )

    def blocks(self) -> tuple[Block, ...]:
        """What other results show of it."""
        counts = [sum(v.met is met for v in self.verdicts) for met in (True, False, None)]
        words = ("met", "missed", "undecided")
        told = ", ".join(f"{n} {word}" for n, word in zip(counts, words, strict=True) if n)
        holds = True if self.holds else False if counts[1] else None
        word = {True: "met", False: "missed", None: "undecided"}[holds]
        return (
            Verdict(word, f"{counted(len(self.verdicts), 'requirement')}: {told}", holds),
            verdict_table(self.verdicts),
            *(Sentence(text) for text in verdict_sentences(self.verdicts)),
        )


def verdict_table(verdicts: tuple[Answer, ...]) -> Table:
    """Requirements and their verdicts, one a row: the same table wherever they stand."""
    share, margin = quantity("requirement_share"), quantity("requirement_margin_deg")
    rows = tuple(
        (
            verdict.requirement.name,
            verdict.word,
            verdict.sure,
            _share(verdict),
            Value(margin, None if verdict.margin is None else degrees(verdict.margin)),
            verdict.requirement.claim,
        )
        for verdict in verdicts
    )
    header = ("", "verdict", "evidence", share.heading, margin.heading, "wanted")
    return Table("Requirements", header, rows)


def _share(verdict: Answer) -> Value:
    share = quantity("requirement_share")
    if verdict.share is None:
        return Value(share, None)
    low, high = verdict.share
    return Value(share, low, Proven() if low == high else Bracket(low, high))


def verdict_sentences(verdicts: tuple[Answer, ...]) -> list[str]:
    """For each requirement where and when it is tightest or missed, why it is open, its scope."""
    return [f"{verdict.requirement.name}: {_said(verdict)}" for verdict in verdicts]


def _said(verdict: Answer) -> str:
    parts = []
    if verdict.reason:
        parts.append(verdict.reason)
    if (worst := verdict.worst) is not None:
        when = "" if worst.time is None else f" at t = {worst.time:.3f} s"
        word = "missed" if verdict.met is False else "tightest"
        parts.append(f"{word} at {_place(verdict)}{when}, {_value(verdict)}")
    if verdict.lost:
        alike = f" or one of {verdict.alike} sets alike" if verdict.alike > 1 else ""
        parts.append(f"after the loss of {', '.join(verdict.lost)}{alike}, which hurts most")
    parts.append(verdict.scope)
    return "; ".join(parts)


def _place(verdict: Answer) -> str:
    """Where it is worst; of a site's latitude elsewhere on it, whose it is."""
    worst, whose = verdict.worst, ""
    assert worst is not None
    if (site := verdict.site) is not None:
        turn = 0.0 if worst.longitude is None else worst.longitude - site.longitude
        there = abs((turn + pi) % (2 * pi) - pi) < NEAR
        whose = f"{site.name}, " if there else f"{site.name}'s latitude, "
    latitude = latitude_words(degrees(worst.latitude), ".4f")
    if worst.longitude is None:
        return f"{whose}{latitude}"
    return f"{whose}{latitude}, {longitude_words(degrees(worst.longitude), '.4f')}"


def _value(verdict: Answer) -> str:
    worst = verdict.worst
    assert worst is not None
    if worst.of == "share":
        return f"at most {100 * worst.value:.4f} % of the time"
    if worst.of == "fold":
        if worst.rank is None or worst.elevation is None:
            return f"{worst.value:.0f} in view"
        which = f"{ordinal(worst.rank)} satellite at {degrees(worst.elevation):.2f} deg"
        return f"{which}; {worst.value:.0f} in view"
    wanted = verdict.requirement
    if not isinf(worst.value):
        found, unit = f"{wanted.titled(worst.of)} {worst.value:.6g}", wanted.unit(worst.of)
        if worst.most is None:
            return f"{found}{unit}"
        return (
            f"{found}{unit} or more" if isinf(worst.most) else f"{found} to {worst.most:.6g}{unit}"
        )
    seen, around = worst.seen, worst.around
    why = "" if seen is None else f": {counted(seen, 'satellite')} in view"
    if seen is not None and around is not None and around > seen:
        why += f", and {around - seen} more outside of whose beams the place is"
    return f"{wanted.titled(worst.of)} infinite{why}"


@checked
def check(
    design: Design | str | Path,
    *others: Design | str | Path,
    beacons: Site | str | Sequence[Site | str] = (),
    days: float | None = None,
    start_day: float = 0.0,
    motion: MotionModel | None = None,
    width: float | None = None,
    budget_s: float | None = None,
    leaves: str | Path | None = None,
    progress: bool = False,
) -> CheckResult:
    """Settle every requirement of a design; one without any has its ``[coverage]`` everywhere.

    Parameters
    ----------
    design, *others
        A design, or the path of its file; with several their satellites together are asked for
        the requirements of all.
    beacons
        On the ground: sites, names of stations, or ``NAME=LAT,LON[,MASK]``. Sites over whose
        horizon they stand count them with satellites, but not in metres; over regions and the whole
        surface satellites count alone.
    days, start_day
        For so many days from a day after the epoch on, at the places themselves; without days for
        ever. Needed where the motion is integrated or a table.
    motion
        ``two-body``, ``j2`` or ``numerical``; else the design's.
    width, budget_s
        How near bounds of each share of geometry are to come, by default 1e-4, and seconds that
        each share, of satellites in view too, may take; by default a number of boxes.
    leaves
        File of open boxes: what it holds of the same question is gone on from, and what is left
        open is kept there.
    progress
        Show bars on stderr.

    Raises
    ------
    ArgumentError, DesignError
        An option or the design is not allowed.

    Examples
    --------
    >>> import compass
    >>> found = compass.check("designs/compass-15-5-1.toml")
    >>> found.holds, found.verdicts[0].evidence
    (True, 'proven')
    """
    read = with_beacons(in_metres(joined_designs((design, *others))), beacons)
    effort = Effort(width, budget_s, None if leaves is None else Path(leaves), cores())
    if motion is not None:
        read = replace(read, motion=read.motion.or_of(motion))
    wanted = read.requirements or (Requirement("coverage", fold=read.fold),)

    def settle(each: Requirement) -> Answer:
        return verdict_of(read, each, days=days, start_day=start_day, effort=effort, thorough=True)

    # geometry shares its own boxes among threads, and can be interrupted in this one alone
    last = sorted(range(len(wanted)), key=lambda k: bool(wanted[k].limits))
    bare = sum(not each.limits for each in wanted)
    asked = [wanted[k] for k in last]
    settled = chain(shared(settle, asked[:bare]), map(settle, asked[bare:]))
    verdicts = dict(zip(last, bar(progress, "requirements", settled, total=len(last)), strict=True))
    return CheckResult(read, tuple(verdicts[k] for k in range(len(wanted))))
