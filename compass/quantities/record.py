"""The record of a quantity."""

from dataclasses import dataclass
from typing import Literal

Form = Literal["real", "count", "share", "yes-no", "text"]


@dataclass(frozen=True)
class Quantity:
    """What a number is.

    Attributes
    ----------
    name
        As in JSON, files and columns, with the unit in it: ``mask_margin_deg``.
    unit
        As CF writes it (``deg``, ``km``, ``m s-1``); ``1`` for a pure number.
    title
        The words for it, without the unit.
    digits
        Significant digits that say something.
    better
        ``more``, ``less``, or ``""`` where neither is.
    form
        ``real``, ``count``, ``share`` (0 to 1, shown in per cent), ``yes-no`` or ``text``.
    limits
        Ends of axes and colours that all pictures of it share, or None.
    ticks
        Marks between them.
    meaning
        A sentence for who has not met it.
    standard_name
        The CF convention's name, if it has one.
    """

    name: str
    unit: str
    title: str
    digits: int = 4
    better: Literal["more", "less", ""] = ""
    form: Form = "real"
    limits: tuple[float, float] | None = None
    ticks: tuple[float, ...] = ()
    meaning: str = ""
    standard_name: str | None = None

    @property
    def shown_unit(self) -> str:
        """The unit as a reader sees it: per cent of a share, nothing of a pure number, m/s."""
        if self.form == "share":
            return "%"
        first, *others = self.unit.split(" ")
        rest = (f"/{unit[:-2]}" if unit.endswith("-1") else f" {unit}" for unit in others)
        return "" if self.unit == "1" else first + "".join(rest)

    @property
    def heading(self) -> str:
        """Title and unit, for a column or an axis."""
        return self.title + (f", {self.shown_unit}" if self.shown_unit else "")

    def attributes(self) -> dict[str, str]:
        """Attributes of a gridded variable after the CF convention."""
        unit = "1" if self.form != "real" else self.unit
        named = {"standard_name": self.standard_name} if self.standard_name else {}
        return {"units": unit, "long_name": self.title, **named}
