"""Coverage over a span of real paths: proven for so many days, or lost at a moment and a place."""

from dataclasses import dataclass
from math import degrees
from typing import TYPE_CHECKING, Any

from compass.api.fold_claim import FoldClaim
from compass.coverage.certificate import Outcome
from compass.coverage.lasting import RESOLUTION, Lasting
from compass.document import Page, Proven, Sentence, Value, Verdict
from compass.document.blocks import Block, facts
from compass.document.plain import plain
from compass.quantities import quantity
from compass.words import counted, place_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, repr=False)
class LastingResult(FoldClaim):
    """Whether a design keeps its fold for so many days.

    Attributes
    ----------
    design, fold, mask_deg
        As of `FoldClaim`.
    motion
        Under what motion.
    lasting
        What was found, SI.
    ground
        What its users stand on, where that is not the design's figure.
    """

    motion: str
    lasting: Lasting
    ground: str = ""

    @property
    def outcome(self) -> Outcome:
        """Proven, refuted or undecided."""
        return self.lasting.outcome

    @property
    def days(self) -> float:
        """Length of the span."""
        return (self.lasting.stop - self.lasting.start) / 86400.0

    @property
    def figure(self) -> str:
        """On what users stand."""
        return self.ground or self.design.figure.title

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        lasting = self.lasting
        return plain(
            {
                "design": self.design.name,
                "outcome": self.outcome,
                "fold": lasting.fold,
                "mask_deg": self.mask_deg,
                "region": lasting.region.name,
                "figure": self.figure,
                "motion": self.motion,
                "start_day": lasting.start / 86400.0,
                "days": self.days,
                "days_proven": lasting.days_proven,
                "first_loss_days": lasting.first_loss_days,
                "lost_between_s": None
                if lasting.lost_at is None
                else [lasting.proven_until, lasting.lost_at],
                "witness": lasting.witness.as_dict() if lasting.witness else None,
                "unsettled_s": lasting.unsettled,
                "intervals": lasting.intervals,
                "estimated_error": lasting.estimated,
            }
        )

    def document(self) -> Page:
        """The verdict, the place of the loss, and how it was settled."""
        return Page(self.design.name, self.blocks())

    def blocks(self) -> tuple[Block, ...]:
        """What other results show of it."""
        lasting = self.lasting
        holds = {Outcome.PROVEN: True, Outcome.REFUTED: False}.get(self.outcome)
        claim = (
            f"{lasting.fold} or more satellites above {self.mask_deg:g} deg, "
            f"{lasting.region.name}, {self.days:.6g} days from day {lasting.start / 86400:g} "
            f"({self.figure})"
        )
        given = f"given an estimated {lasting.estimated}" if lasting.estimated else ""
        numbers = [
            Value(quantity("days_proven"), lasting.days_proven, Proven(given)),
            Value(quantity("first_loss_days"), lasting.first_loss_days, Proven(given)),
        ]
        how = (
            f"{self.motion}; {counted(lasting.intervals, 'interval')} of time, no symmetry "
            "and no sample; "
            f"a loss is found to {RESOLUTION:g} s" + (f"; {given}" if given else "")
        )
        return (
            Verdict(self.outcome, claim, holds),
            *([Sentence(self._loss())] if lasting.witness else []),
            *([Sentence(self._open())] if lasting.unsettled else []),
            facts("How long", numbers),
            Sentence(how),
        )

    def plot(self, *, axes: "Axes | None" = None) -> "Axes":
        """Draw the days as a bar: proven, open, and where the fold is lost.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.style import CYCLE, FAINT, MARS, axes_or_new, look

        lasting, drawn = self.lasting, axes_or_new(axes, 8.0, 1.8)
        day = 86400.0
        with look():
            for start, stop, colour, word in (
                (lasting.start, lasting.proven_until, CYCLE[2], "proven"),
                *((*piece, FAINT, "open") for piece in lasting.unsettled),
            ):
                drawn.barh(0, (stop - start) / day, left=start / day, color=colour, label=word)
            if lasting.lost_at is not None:
                drawn.axvline(lasting.lost_at / day, color=MARS, label="lost")
            drawn.set(
                xlabel="days after the epoch", xlim=(lasting.start / day, lasting.stop / day),
                ylim=(-1.0, 1.0), yticks=(),
                title=f"{self.design.name}: {lasting.fold}-fold above {self.mask_deg:g} deg",
            )  # fmt: skip
            told = dict(zip(*reversed(drawn.get_legend_handles_labels()), strict=True))
            drawn.legend(told.values(), told.keys(), loc="upper left", ncols=3)
        return drawn

    def _loss(self) -> str:
        lasting = self.lasting
        assert lasting.witness is not None
        w = lasting.witness
        names = ", ".join(w.satellites) or "none"
        return (
            f"lost on day {w.time / 86400:.6f}: {w.fold} in view ({names}) at "
            f"{place_words(degrees(w.latitude), degrees(w.longitude), '.4f')}; proven up to "
            f"day {lasting.proven_until / 86400:.6f}"
        )

    def _open(self) -> str:
        parts = "; ".join(f"{a:.9g} to {b:.9g} s" for a, b in self.lasting.unsettled[:5])
        return f"unsettled: {parts}"
