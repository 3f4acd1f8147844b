"""How well a number is known: proven, between bounds, or sampled with an error."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self


@dataclass(frozen=True)
class Proven:
    """Exact but for rounding on the safe side; `scope` says for which orbits and how long."""

    scope: str = ""

    def __str__(self) -> str:
        return "proven" + (f", {self.scope}" if self.scope else "")


@dataclass(frozen=True)
class Between:
    """Between two bounds; `scope` says for what, or of what."""

    low: float
    high: float
    scope: str = ""

    #: How the bounds are told, and what they are called beside a plain number.
    WORDS: ClassVar[str]
    SUFFIX: ClassVar[str]

    def __post_init__(self) -> None:
        if not self.low <= self.high:
            name = self.SUFFIX.strip("_")
            raise ValueError(f"{name} from {self.low} to {self.high}: the bounds are not in order")

    @classmethod
    def beside(cls, known: Mapping[str, Any], name: str, scope: str = "") -> Self | None:
        """Bounds beside a plain number, called ``NAME_bracket``; None where there are none."""
        if (bounds := known.get(name + cls.SUFFIX)) is None:
            return None
        low, high = bounds
        return cls(low, high, scope)

    def __str__(self) -> str:
        return self.WORDS + (f", {self.scope}" if self.scope else "")


class Bracket(Between):
    """Between two bounds that are proven; `scope` as of `Proven`."""

    WORDS, SUFFIX = "between proven bounds", "_bracket"


class Interval(Between):
    """Between two bounds that hold in 95 of 100 cases; `scope` says what was drawn."""

    WORDS, SUFFIX = "bounds that hold in 95 of 100 cases", "_interval"


@dataclass(frozen=True)
class Sampled:
    """From a sample or a quadrature: `error` is in the number's own unit, `how` says of what.

    An error of None means that none is known, which is said too.
    """

    error: float | None = None
    how: str = ""

    def __str__(self) -> str:
        error = "error not known" if self.error is None else ""
        return ", ".join(part for part in ("sampled", self.how, error) if part)


Evidence = Proven | Bracket | Interval | Sampled
