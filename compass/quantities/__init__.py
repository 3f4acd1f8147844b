"""What a number is: one record a quantity, read by text, JSON, HTML, netCDF, axes and studies.

The record is a number's birth certificate: its name with the unit in it, as in JSON and files, its
unit, the words for it, how many digits say something, which way is better. Nobody else spells a
label or a digit.
"""

from collections.abc import Mapping
from difflib import get_close_matches

from compass.errors import ArgumentError
from compass.quantities.access import ACCESS
from compass.quantities.coverage import CONTINUOUS, MAPS
from compass.quantities.design import DESIGN
from compass.quantities.geometry import GEOMETRY
from compass.quantities.lasting import LASTING
from compass.quantities.record import Quantity
from compass.quantities.signal import SIGNAL

__all__ = ["QUANTITIES", "Quantity", "quantity"]

#: All quantities, by name.
QUANTITIES: Mapping[str, Quantity] = {
    q.name: q for q in (*DESIGN, *GEOMETRY, *CONTINUOUS, *MAPS, *ACCESS, *LASTING, *SIGNAL)
}


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
