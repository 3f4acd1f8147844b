"""What a number is: one record a quantity, read by text, JSON, HTML, netCDF, axes and studies.

The record is a number's birth certificate: its name with the unit in it, as in JSON and files, its
unit, the words for it, how many digits say something, which way is better. Nobody else spells a
label or a digit.
"""

from collections.abc import Mapping

from compass.errors import ArgumentError, near
from compass.quantities.access import ACCESS
from compass.quantities.coverage import CONTINUOUS, MAPS
from compass.quantities.design import DESIGN
from compass.quantities.geometry import GEOMETRY
from compass.quantities.lasting import LASTING
from compass.quantities.merits import MERITS
from compass.quantities.program import PROGRAM
from compass.quantities.record import Quantity
from compass.quantities.signal import SIGNAL

__all__ = ["QUANTITIES", "Quantity", "quantity"]

#: All quantities, by name.
QUANTITIES: Mapping[str, Quantity] = {
    q.name: q
    for q in (
        *DESIGN, *GEOMETRY, *CONTINUOUS, *MAPS, *ACCESS, *LASTING, *SIGNAL, *PROGRAM,
        *(merit.quantity for merit in MERITS.values()),
    )
}  # fmt: skip


def quantity(name: str) -> Quantity:
    """Return the record of a name.

    Raises
    ------
    ArgumentError
        There is none; the message has the names that are near.
    """
    if name in QUANTITIES:
        return QUANTITIES[name]
    guesses = near(name, QUANTITIES, 3)
    raise ArgumentError(
        f"quantity {name!r}: not known; "
        + (f"did you mean {', '.join(guesses)}?" if guesses else f"known: {', '.join(QUANTITIES)}")
    )
