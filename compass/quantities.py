"""What a number is: one record a quantity, read by text, JSON, HTML, netCDF, axes and studies.

The record is a number's birth certificate: its name with the unit in it, as in JSON and files, its
unit, the words for it, how many digits say something, which way is better. Nobody else spells a
label or a digit.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Literal

from compass.errors import ArgumentError

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
        """The unit as a reader sees it: per cent of a share, nothing of a pure number."""
        return "%" if self.form == "share" else "" if self.unit == "1" else self.unit

    @property
    def heading(self) -> str:
        """Title and unit, for a column or an axis."""
        return self.title + (f", {self.shown_unit}" if self.shown_unit else "")

    def attributes(self) -> dict[str, str]:
        """Attributes of a gridded variable after the CF convention."""
        unit = "1" if self.form != "real" else self.unit
        named = {"standard_name": self.standard_name} if self.standard_name else {}
        return {"units": unit, "long_name": self.title, **named}


_COVERAGE = (
    Quantity(
        "fold", "1", "fold wanted", form="count",
        meaning="How many satellites must be in view at once.",
    ),
    Quantity(
        "min_fold", "1", "least fold", better="more", form="count",
        meaning="Fewest satellites above the mask at any place and time looked at.",
    ),
    Quantity(
        "max_fold", "1", "greatest fold", better="more", form="count",
        meaning="Most satellites above the mask at any place and time looked at.",
    ),
    Quantity(
        "cap_radius_min_deg", "deg", "smallest cap radius for the fold", 4, "less",
        meaning="Caps about the points below the satellites need this radius for the fold "
        "wanted everywhere and always.",
    ),
    Quantity(
        "mask_margin_deg", "deg", "highest mask with the fold", 3, "more",
        meaning="The elevation mask may be raised to this before the fold wanted is lost.",
    ),
    Quantity(
        "mask_deg", "deg", "elevation mask", 4,
        meaning="A satellite counts as in view above this elevation.",
    ),
    Quantity(
        "lowest_altitude_km", "km", "lowest altitude at this mask", 5, "less",
        meaning="The same pattern, lower, keeps the fold wanted down to this altitude.",
    ),
    Quantity(
        "fold_share", "1", "share of area and time", 5, form="share",
        meaning="Part of the sphere and of the time with so many satellites in view.",
    ),
    Quantity(
        "alike", "1", "sets alike", form="count",
        meaning="Sets of satellites that the pattern's symmetry makes equal to this one.",
    ),
    Quantity(
        "closest_approach_deg", "deg", "closest two satellites", 3, "more",
        meaning="Least angle between two satellites, seen from Mars's centre, at any time.",
    ),
    Quantity(
        "fold_proven", "1", "continuous fold at the mask", better="more", form="yes-no",
        meaning="Whether the fold wanted is proven everywhere and always.",
    ),
)  # fmt: skip

#: All quantities, by name.
QUANTITIES: Mapping[str, Quantity] = {q.name: q for q in (*_COVERAGE,)}


def quantity(name: str) -> Quantity:
    """Return the record of a name.

    Raises
    ------
    ArgumentError
        There is none; the message has the names that are near.
    """
    if name in QUANTITIES:
        return QUANTITIES[name]
    near = get_close_matches(name, QUANTITIES, n=3)
    raise ArgumentError(
        f"quantity {name!r}: not known; "
        + (f"did you mean {', '.join(near)}?" if near else f"known: {', '.join(QUANTITIES)}")
    )
