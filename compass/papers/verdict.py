"""Rows of a paper: what it says, what is found, and the verdict that follows from both.

A verdict is never written down. It is worked out from the published text and the numbers found
each time it is asked for, so that another number gives another verdict.
"""

from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from enum import StrEnum
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from compass.document.numbers import significant

#: Whether something holds of the numbers found; false of nan.
Condition = Callable[..., bool]

#: Numbers found: one, or several.
Found = ArrayLike


class Verdict(StrEnum):
    """What a row comes to."""

    REPRODUCED = "reproduced"  # within the tolerance printed beside it
    DIFFERS = "differs"  # not so, and the paper is not shown to be wrong
    ERRATUM = "erratum"  # not so, and the paper's error is demonstrated by numbers computed here
    FITTED = "fitted"  # within the tolerance, but the number was used to choose a parameter
    COMPUTED = "computed"  # the paper says nothing to compare with


@dataclass(frozen=True)
class Erratum:
    """An error of the paper, and what demonstrates it.

    At least one of the two is given; what is given must hold, else the row differs.

    Attributes
    ----------
    reason
        What is wrong.
    makes
        The number that the error described leads to: it must be the published one, within the
        row's tolerance, while the number found is finite.
    shown
        Condition on the numbers found under which the paper's statement is false for this reason.
    """

    reason: str
    makes: float | None = None
    shown: Condition | None = None

    def __post_init__(self) -> None:
        if self.makes is None and self.shown is None:
            raise ValueError(f"erratum without a demonstration: {self.reason}")

    def demonstrated(self, row: "Row") -> bool:
        """Whether the numbers show the error."""
        if self.makes is not None and not (
            isfinite(row.found[0]) and _near(self.makes, row.published, row.tolerance)
        ):
            return False
        return self.shown is None or bool(self.shown(*row.found))


@dataclass(frozen=True)
class Row:
    """One number or statement of a paper beside what is found.

    Attributes
    ----------
    item
        What it is.
    where
        Table, equation, figure or section.
    published
        As printed, digits kept, or the statement; None where the paper says nothing.
    found
        The numbers found, in `unit`.
    unit
        Of both.
    criterion
        What agreement means, in words or as a tolerance.
    tolerance
        Allowed difference of a number; None for a statement.
    holds_if
        Condition on the numbers found under which a statement holds.
    erratum
        The paper's error, if one is known.
    fitted
        Which parameter the published value was used to choose.
    note
        Why the row differs, as far as known, should it; or of a number computed, what of it.
    shown
        Format of the numbers found, for more than one.
    """

    item: str
    where: str
    published: str | None
    found: tuple[float, ...]
    unit: str
    criterion: str = ""
    tolerance: float | None = None
    holds_if: Condition | None = None
    erratum: Erratum | None = None
    fitted: str = ""
    note: str = ""
    shown: str = ""

    @property
    def computed(self) -> float | str:
        """What is found: a number, or text of several."""
        return self.shown.format(*self.found) if self.shown else self.found[0]

    @property
    def agrees(self) -> bool:
        """Whether the numbers found agree with what is published."""
        if self.holds_if is not None:
            return bool(self.holds_if(*self.found))
        return _near(self.found[0], self.published, self.tolerance)

    @property
    def off(self) -> float | None:
        """Number found less the printed one, in tolerances; None of statements and of nan."""
        if self.published is None or not self.tolerance or not isfinite(self.found[0]):
            return None
        return (self.found[0] - float(self.published)) / self.tolerance

    @property
    def verdict(self) -> Verdict:
        """What the row comes to."""
        if self.published is None:
            return Verdict.COMPUTED
        if self.agrees:
            return Verdict.FITTED if self.fitted else Verdict.REPRODUCED
        if self.erratum is not None and self.erratum.demonstrated(self):
            return Verdict.ERRATUM
        return Verdict.DIFFERS

    @property
    def reason(self) -> str:
        """Why the verdict is what it is; empty where a row is reproduced."""
        verdict = self.verdict
        if verdict is Verdict.ERRATUM and self.erratum is not None:
            made = self.erratum.makes
            gives = "" if made is None else f" (that gives {significant(made, 6)})"
            return self.erratum.reason + gives
        if verdict is Verdict.DIFFERS:
            return self.note or "no reason on record"
        if verdict is Verdict.COMPUTED:
            return self.note
        return self.fitted if verdict is Verdict.FITTED else ""

    @property
    def told(self) -> str:
        """Verdict and reason in one line."""
        return f"{self.verdict}: {self.reason}" if self.reason else str(self.verdict)

    @property
    def difference(self) -> float | None:
        """Computed minus published, in `unit`; None where they are not both numbers."""
        if self.published is None or self.tolerance is None:
            return None
        return self.found[0] - float(self.published)

    @property
    def holds(self) -> bool:
        """Whether the row agrees, its error is demonstrated, or there is nothing to compare."""
        return self.verdict is not Verdict.DIFFERS

    def as_dict(self) -> dict[str, Any]:
        """Row as plain values for JSON."""
        names = ("item", "where", "published", "computed", "unit", "criterion", "reason")
        return {name: getattr(self, name) for name in names} | {
            "verdict": str(self.verdict),
            "tolerance": self.tolerance,
            "difference": self.difference,
        }


def _near(value: float, published: str | None, tolerance: float | None) -> bool:
    """Whether a number lies within the tolerance of a printed one; false of nan."""
    if published is None or tolerance is None:
        return False
    return abs(value - float(published)) <= tolerance


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
    found: float,
    unit: str = "1",
    *,
    tolerance: float | None = None,
    why: str = "",
    erratum: Erratum | None = None,
    fitted: str = "",
    note: str = "",
) -> Row:
    """Row of a printed number.

    Parameters
    ----------
    tolerance
        Allowed difference; half a unit of the last printed digit if left out.
    why
        Where another tolerance comes from.
    """
    allowed = printed_tolerance(published) if tolerance is None else tolerance
    criterion = f"within {significant(allowed, 2)}" + (f": {why}" if why else "")
    return Row(
        item, where, published, (float(found),), unit, criterion, allowed, None, erratum, fitted,
        note,
    )  # fmt: skip


def claim(
    item: str,
    where: str,
    published: str,
    found: Found,
    unit: str,
    criterion: str,
    holds_if: Condition,
    *,
    shown: str = "",
    erratum: Erratum | None = None,
    fitted: str = "",
    note: str = "",
) -> Row:
    """Row of a statement in words: it holds where `holds_if` is true of the numbers found."""
    return Row(
        item, where, published, _floats(found), unit, criterion, None, holds_if, erratum, fitted,
        note, shown,
    )  # fmt: skip


def extremes(where: str, published: str, printed: tuple[str, str], ends: Found, unit: str) -> Row:
    """Row of what is printed as the maximum and the minimum, in this order, of a degree.

    An erratum where they are exchanged: the second is larger, and of the least and greatest degree
    found (`ends`) each is nearer, as a ratio, to what is printed as the other.
    """

    def exchanged(maximum: float, minimum: float, least: float, greatest: float) -> bool:
        if not 0 < min(maximum, minimum, least, greatest) < np.inf:
            return False
        beside = abs(np.log(least / minimum)) + abs(np.log(greatest / maximum))
        across = abs(np.log(least / maximum)) + abs(np.log(greatest / minimum))
        return bool(maximum < minimum and across < beside)

    return claim(
        "What is printed as the maximum and as the minimum of the observability degree; least and "
        "greatest found",
        where,
        published,
        (*map(float, printed), *_floats(ends)),
        unit,
        "the first is larger",
        lambda maximum, minimum, least, greatest: maximum > minimum and greatest >= least > 0,
        shown="{:.4g}, {:.4g}; {:.3g}, {:.3g}",
        erratum=Erratum("exchanged: what is found lies by the other", shown=exchanged),
    )


def computed(
    item: str,
    where: str,
    found: Found,
    unit: str,
    *,
    note: str = "",
    shown: str = "",
) -> Row:
    """Row of something that the paper does not say."""
    return Row(item, where, None, _floats(found), unit, note=note, shown=shown)


def _floats(found: Found) -> tuple[float, ...]:
    return tuple(float(value) for value in np.atleast_1d(np.asarray(found, dtype=float)))
