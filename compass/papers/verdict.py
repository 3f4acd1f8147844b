"""Comparing a printed number with a computed one, to the digits that were printed."""

from dataclasses import asdict, dataclass
from decimal import Decimal
from typing import Any


@dataclass(frozen=True)
class Row:
    """One number or claim of a paper.

    Attributes
    ----------
    item
        What it is.
    where
        Table, equation, figure or section.
    published
        As printed, digits kept; None if the paper prints none.
    computed
        What this project finds: a number, or text for a claim.
    unit
        Unit of both.
    verdict
        ``reproduced``, ``erratum: reason``, ``differs: reason``, or ``not printed`` for a number
        that the paper ought to have given.
    reason
        The reason alone; empty when reproduced.
    """

    item: str
    where: str
    published: str | None
    computed: float | str
    unit: str
    verdict: str
    reason: str = ""

    @property
    def difference(self) -> float | None:
        """Computed minus published, in `unit`; None where they are not both numbers."""
        if self.published is None or isinstance(self.computed, str):
            return None
        try:
            return self.computed - float(self.published)
        except ValueError:
            return None

    @property
    def holds(self) -> bool:
        """Whether the row is reproduced or its difference explained by an erratum."""
        return not self.verdict.startswith("differs")

    def as_dict(self) -> dict[str, Any]:
        """Row as plain values for JSON."""
        return {**asdict(self), "difference": self.difference}


def printed_tolerance(published: str) -> float:
    """Half a unit of the last printed digit: ``"3.3962e3"`` gives 0.05.

    Two programs that agree before rounding can still print digits one unit apart only if the
    value lies at the rounding edge, so half a unit (plus one part in 10^12 for conversion) is
    the whole tolerance.
    """
    exponent = Decimal(published).as_tuple().exponent
    assert isinstance(exponent, int)
    return 0.5 * 10.0**exponent + 1e-12 * abs(float(published))


def compare(
    item: str,
    where: str,
    published: str,
    computed: float,
    unit: str = "1",
    *,
    erratum: str = "",
    differs: str = "",
    tolerance: float | None = None,
) -> Row:
    """Judge a computed number against a printed one.

    ``reproduced`` if they agree to `tolerance` (default: half a unit of the last printed
    digit); else ``erratum`` if the paper's error is known, else ``differs``.
    """
    allowed = printed_tolerance(published) if tolerance is None else tolerance
    if abs(computed - float(published)) <= allowed:
        return Row(item, where, published, computed, unit, "reproduced")
    if erratum:
        return Row(item, where, published, computed, unit, f"erratum: {erratum}", erratum)
    reason = differs or "no reason on record"
    return Row(item, where, published, computed, unit, f"differs: {reason}", reason)


def judge_claim(
    item: str,
    where: str,
    published: str,
    computed: float | str,
    unit: str,
    holds: bool,
    reason: str,
) -> Row:
    """Judge a claim made in words: ``reproduced`` if it holds, else an erratum with its reason."""
    verdict = "reproduced" if holds else f"erratum: {reason}"
    return Row(item, where, published, computed, unit, verdict, "" if holds else reason)
