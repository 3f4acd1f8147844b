"""A value, what it is and how well it is known, as a reader wants it."""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, floor, inf, isfinite, isnan, log10

from compass.document.evidence import Between, Evidence, Proven, Sampled
from compass.quantities import Quantity

#: Numbers nearer to zero than this are written with a power of ten.
SMALL = 1e-4


@dataclass(frozen=True)
class Value:
    """A number with its quantity and its evidence; None means that there is none.

    `whose` is said behind the quantity's title, for one of several: "exact", "published".
    """

    quantity: Quantity
    value: float | int | str | bool | None
    evidence: Evidence | None = None
    whose: str = ""

    @property
    def title(self) -> str:
        """What stands in the column of names."""
        return self.quantity.title + (f", {self.whose}" if self.whose else "")

    def __str__(self) -> str:
        """The value in the quantity's digits, with bounds or an error, without the unit."""
        q, evidence = self.quantity, self.evidence
        if isinstance(evidence, Between) and evidence.low != evidence.high:
            return _between(evidence, q)
        if isinstance(evidence, Proven) and isinstance(self.value, float) and q.better:
            # never better than what was proven
            return outward(self.value, q, floor if q.better == "more" else ceil)
        if isinstance(evidence, Sampled):
            return give_or_take(self.value, evidence.error, q)
        return in_words(self.value, q)


def give_or_take(
    value: float | int | str | bool | None, error: float | None, quantity: Quantity
) -> str:
    """A value and its error in the same decimals, those of the error's second digit.

    Zeros at the end stay, for they are known; nothing is rounded before the decimal point. An
    error finer than a digit beyond the quantity's is rounded up to that. None and words, what is
    infinite, and what has no error or one of zero, stand alone.
    """
    if not error or not isinstance(value, int | float) or quantity.form == "yes-no":
        return in_words(value, quantity)
    if not isfinite(value):
        return in_words(value, quantity)
    if not isfinite(error):
        return f"{in_words(value, quantity)} ± {significant(error, 2)}"
    scale = 100.0 if quantity.form == "share" else 1.0
    value, error = scale * value, scale * abs(error)
    size = max(abs(value), error)
    # one power of ten for both, where either needs one
    power = 0 if SMALL <= size < 1e15 else floor(log10(size))
    value, error, size = (each / 10.0**power for each in (value, error, size))
    wanted = 1 - int(f"{error:.1e}".split("e")[1])
    finest = max(0, quantity.digits - floor(log10(size)))
    if wanted > finest:
        error = ceil(error * 10.0**finest) / 10.0**finest
    decimals = max(0, min(wanted, finest))
    comma = "," if size >= 1e5 or quantity.form == "count" else ""
    tail = f"e{power}" if power else ""
    return " ± ".join(f"{each:{comma}.{decimals}f}{tail}" for each in (value, error))


def in_words(value: float | int | str | bool | None, quantity: Quantity) -> str:
    """One value of a quantity, without its unit."""
    if value is None:
        return "none"
    if isinstance(value, str):
        return value
    if quantity.form == "yes-no":
        return "yes" if value else "no"
    if quantity.form == "count" and float(value).is_integer():
        return f"{int(value):,}"
    return significant(100.0 * value if quantity.form == "share" else value, quantity.digits)


def _between(bounds: Between, quantity: Quantity) -> str:
    """Two bounds, to no finer digits than a hundredth of what lies between them."""
    scale = 100.0 if quantity.form == "share" else 1.0
    width = scale * (bounds.high - bounds.low)
    most = 2 - floor(log10(width)) if 0.0 < width < inf else None
    low, high = (
        outward(end, quantity, away, most)
        for end, away in ((bounds.low, floor), (bounds.high, ceil))
    )
    return f"{low} to {high}"


def outward(
    bound: float, quantity: Quantity, away: Callable[[float], int], decimals: int | None = None
) -> str:
    """One proven bound, rounded to its own side (floor or ceil), so that it still holds.

    It has at most so many `decimals`, fewer than the quantity's digits where those say nothing.
    """
    scale = 100.0 if quantity.form == "share" else 1.0
    value = scale * bound
    if quantity.form == "share" and 0.0 < value < SMALL:
        return significant(away(value / SMALL) * SMALL, 1)
    if quantity.form == "count" or not isfinite(value) or abs(value) < SMALL:
        return in_words(bound, quantity)
    behind = max(0, quantity.digits - 1 - floor(log10(abs(value))))
    place = 10.0 ** (behind if decimals is None else min(behind, max(0, decimals)))
    nearest = round(value * place) / place
    # what is written in full already needs no step further
    kept = nearest == value or abs(nearest - value) < 1e-15 * abs(value)
    return in_words((nearest if kept else away(value * place) / place) / scale, quantity)


def significant(value: float, digits: int) -> str:
    """Write a number to so many significant digits, never rounding before the decimal point.

    Zeros at the end are left out; infinity is a sign, and a number that is none is "none".
    """
    if isnan(value):
        return "none"
    if not isfinite(value):
        return "∞" if value > 0 else "-∞"
    if value == 0.0:
        return "0"
    if abs(value) < SMALL or abs(value) >= 1e15:
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        if "." in mantissa:
            mantissa = mantissa.rstrip("0").rstrip(".")
        return f"{mantissa}e{int(exponent)}"
    decimals = max(0, digits - 1 - floor(log10(abs(value))))
    written = f"{value:,.{decimals}f}" if abs(value) >= 1e5 else f"{value:.{decimals}f}"
    return written.rstrip("0").rstrip(".") if "." in written else written


def cell(value: object) -> str:
    """One cell of a table, whatever stands in it: a number without quantity to four digits."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return significant(value, 4)
    return str(value)


def is_number(value: object) -> bool:
    """Whether a cell is set as a number: on the right, on its decimal point."""
    if isinstance(value, Value):
        value = value.value
    return isinstance(value, int | float) and not isinstance(value, bool)


def number_of(value: object) -> float:
    """Return the number in a cell."""
    number = value.value if isinstance(value, Value) else value
    assert isinstance(number, int | float)
    return float(number)


def padding(written: list[str]) -> list[str]:
    """What to put behind the numbers of a column, unseen, so that their decimal points align."""
    behind = [len(entry) - entry.index(".") if "." in entry else 0 for entry in written]
    most = max(behind, default=0)
    return [("." if most and not long else "") + "0" * (most - max(long, 1)) for long in behind]
