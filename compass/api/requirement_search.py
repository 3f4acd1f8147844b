"""The smallest constellations that meet requirements, and the sentence that says what to build."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, inf, radians, sin
from pathlib import Path
from typing import TYPE_CHECKING, Any

from compass.api.results import Result
from compass.design import Design
from compass.document import Bracket, Page, Proven, Sentence, Table, Value, Verdict
from compass.document.blocks import Block
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.handover.toml import design_toml
from compass.inputs.requirement_file import Needs, read_needs
from compass.orbits.constellation import Constellation
from compass.quantities import quantity
from compass.requirement import Requirement
from compass.saving import replacing
from compass.sites import Mask
from compass.study.requirement_question import Outcome, Question, Trial
from compass.study.requirement_search import MOST_CERTIFIED
from compass.words import counted

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, repr=False)
class RequirementSearchResult(Result):
    """Constellations that meet requirements, of the smallest size, the best first.

    Attributes
    ----------
    question
        What was looked for.
    outcome
        What was found.
    heights
        Of a range of radii the result at each, this one among them.
    """

    question: Question
    outcome: Outcome
    heights: tuple["RequirementSearchResult", ...] = ()

    @property
    def size(self) -> float:
        """The smallest size; infinite if nothing was found."""
        return self.best.constellation.size if self.holds else inf

    @property
    def bought(self) -> str:
        """What height buys: the smallest size at each radius, in words; nothing of one radius."""
        said = [
            f"{one.size:.0f} at {one.question.radius / 1e3:.6g} km"
            if one.holds
            else f"none at {one.question.radius / 1e3:.6g} km"
            for one in self.heights
        ]
        return f"; smallest by radius: {', '.join(said)}" if said else ""

    @property
    def holds(self) -> bool:
        """Whether there is any."""
        return bool(self.outcome.met)

    @property
    def best(self) -> Trial:
        """The first of the smallest.

        Raises
        ------
        ArgumentError
            Nothing was found.
        """
        if not self.outcome.met:
            raise ArgumentError(f"search: {self.sentence}")
        return self.outcome.met[0]

    @property
    def sentence(self) -> str:
        """What to build, what is next best, and what was kept out and why."""
        q, met = self.question, self.outcome.met
        kept = "; ".join(f"{_name(k.constellation)} ({k.reason})" for k in self.outcome.kept_out)
        out = f"; kept out: {kept}" if kept else ""
        if not met:
            none = f"No {' or '.join(q.kinds)} of up to {q.largest} satellites"
            return f"{none} meets all requirements{out}{self.bought}."
        best = met[0]
        c, angle = best.constellation, best.closest_approach
        parts = [
            f"Build {_name(c)} at {q.radius / 1e3:.6g} km: {c.size} satellites, "
            + ", ".join(_said(verdict) for verdict in best.verdicts)
        ]
        if c.size > 1:
            apart = 2.0 * q.radius * sin(angle / 2.0) / 1e3
            parts.append(f"closest approach {apart:.0f} km ({degrees(angle):.1f} deg)")
        if q.days is not None:
            parts.append(f"left alone on real orbits, it is proven for {counted(q.days, 'day')}")
        if not q.geometry:
            parts.append("geometry was not asked for")
        other = met[1] if len(met) > 1 else self.outcome.next_best
        none = f"none of up to {counted(q.largest, 'satellite')}"
        parts.append(f"next best {none if other is None else _next(other, c.size)}")
        return "; ".join(parts) + out + self.bought + "."

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        following = self.outcome.next_best
        return plain(
            {
                "smallest": self.best.constellation.size if self.holds else None,
                "candidates": [one.as_dict() for one in self.outcome.met],
                "next_best": following.as_dict() if following else None,
                "kept_out": [
                    {"notation": _name(k.constellation), "reason": k.reason}
                    for k in self.outcome.kept_out
                ],
                "sentence": self.sentence,
                "by_radius": [
                    {
                        "radius_km": one.question.radius / 1e3,
                        "smallest": one.best.constellation.size if one.holds else None,
                    }
                    for one in self.heights
                ],
                "radius_km": self.question.radius / 1e3,
                "repeat": self.question.repeat,
                "least_approach_deg": degrees(self.question.least_approach),
                "max_satellites": self.question.largest,
                "days": self.question.days,
                "looked_at": self.outcome.looked_at,
                "requirements": [r.claim for r in self.question.requirements],
            }
        )

    def document(self) -> Page:
        """The sentence, then what was found."""
        how = (
            f"{self.outcome.looked_at} patterns at an inclination (in whole degrees) and, where "
            "tracks are declared closed, a turn over the ground; folds proven or refuted for each; "
            "random samples put what is left in order, certified figures decide, of at most "
            f"{MOST_CERTIFIED} a size"
        )
        word = "found" if self.holds else "none"
        wanted = "; ".join(f"{r.name}: {r.claim}" for r in self.question.requirements)
        blocks: list[Block] = [Verdict(word, self.sentence, self.holds), Sentence(wanted)]
        if self.holds:
            blocks.append(self._table())
        return Page("Search for requirements", (*blocks, Sentence(how)))

    def plot(self, *, axes: "Axes | None" = None) -> "Axes":
        """Draw the margin of every constellation found; of several radii the smallest size of each.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.bars import draw_bars

        if self.heights:
            return draw_bars(
                axes,
                [f"{one.question.radius / 1e3:.6g} km" for one in self.heights],
                [one.size if one.holds else None for one in self.heights],
                quantity("satellites"),
                "Smallest constellation by orbit radius",
            )
        following = self.outcome.next_best
        shown = [*self.outcome.met, *([following] if following else [])]
        return draw_bars(
            axes,
            [f"{one.constellation.size}: {_name(one.constellation)}" for one in shown],
            [None if one.margin is None else degrees(one.margin) for one in shown],
            quantity("requirement_margin_deg"),
            "Constellations that meet all requirements",
        )

    def _table(self) -> Table:
        near, margin = quantity("closest_approach_deg"), quantity("requirement_margin_deg")
        share = quantity("requirement_share")
        rows = []
        following = self.outcome.next_best
        for one in (*self.outcome.met, *((following,) if following else ())):
            shares = [v.share for v in one.verdicts if v.share is not None]
            low = min((s[0] for s in shares), default=1.0)
            high = min((s[1] for s in shares), default=1.0)
            room = None if one.margin is None else degrees(one.margin)
            rows.append(
                (
                    _name(one.constellation),
                    Value(quantity("satellites"), one.constellation.size),
                    Value(margin, room),
                    Value(share, low, Proven() if low == high else Bracket(low, high)),
                    Value(near, degrees(one.closest_approach)),
                )
            )
        header = (
            "pattern", quantity("satellites").heading, margin.heading, share.heading, near.heading,
        )  # fmt: skip
        return Table("Constellations that meet all requirements", header, tuple(rows))

    def write(self, path: str | Path, *, command: str = "compass.search") -> None:
        """Write the best as a design file.

        Raises
        ------
        ArgumentError, OutputError
            Nothing was found, or the file cannot be written.
        """
        q = self.question
        design = Design(
            self.best.constellation,
            source=f"Found by: {command}. {self.sentence}",
            figure=q.figure,
            mask=q.mask,
            fold=max((r.fold or 4 for r in q.requirements), default=4),
            stations=tuple({site.name: site for r in q.requirements for site in r.sites}.values()),
            requirements=q.requirements,
        )
        text = design_toml(design)
        with replacing(Path(path)) as temporary:
            temporary.write_text(text, encoding="utf-8")


def needs_of(
    require: str | Path | Sequence[Requirement] | None,
    region: Sequence[str],
    *,
    fold: int | None,
    mask_deg: float,
    limits: Sequence[tuple[str, float]],
    share: float,
    share_of: Any,
    figure: str,
) -> Needs:
    """What is needed: of a file, of requirements, or of options.

    Raises
    ------
    ArgumentError, DesignError
        Nothing is asked for, or as `read_needs`.
    """
    if isinstance(require, str | Path):
        return read_needs(require)
    shape, mask = FIGURES[figure], Mask.constant(radians(mask_deg))
    if require is not None:
        several: tuple[Any, ...] = tuple(require) if isinstance(require, Sequence) else (require,)
        for each in several:
            if not isinstance(each, Requirement):
                raise ArgumentError(
                    f"require = {each!r}: must be Requirements, or the path of a file of them"
                )
        return Needs("requirements", shape, mask, several)
    if fold is None and not limits:
        raise ArgumentError("fold: missing; give it, pdop_at_most, or requirements (require)")
    wanted = []
    if fold is not None:
        wanted.append(Requirement("fold", regions=tuple(region), fold=fold))
    if limits:
        at_most: dict[str, Any] = {f"{name}_at_most": limit for name, limit in limits}
        wanted.append(
            Requirement.of(
                "geometry",
                regions=region,
                share=share,
                share_of=share_of,
                **at_most,
            )
        )
    return Needs("options", shape, mask, tuple(wanted))


def _name(c: Constellation) -> str:
    p = c.pattern
    assert p is not None
    kind = "" if p.kind == "walker-delta" else f"{p.kind} "
    turned = f" from node {degrees(p.raan):.4g} deg" if p.raan else ""
    counts = f"{p.satellites}/{p.planes}/{p.phasing}"
    return f"{kind}{counts} at {degrees(p.inclination):.4g} deg{turned}"


def _next(other: Trial, size: int) -> str:
    """What comes next, and of how many satellites if not of so many."""
    c = other.constellation
    more = "" if c.size == size else f" ({counted(c.size, 'satellite')})"
    return f"{_name(c)}{more}"


def _said(verdict: Any) -> str:
    """How a requirement is met, in some words."""
    wanted = verdict.requirement
    if verdict.evidence == "proven":
        return f"{wanted.wanted} proven ({wanted.name})"
    low = int(verdict.share[0] * 1e5) / 1e3
    of = "of the time" if wanted.share_of == "time" else "of area and time"
    return f"{wanted.wanted} for at least {low:g} % {of} ({wanted.name})"
