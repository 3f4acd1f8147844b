"""Delay of a signal by Mars's ionosphere: a thin shell whose content follows the Sun.

The troposphere is left out: at 6 hPa it delays by a centimetre or two at the zenith.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Height of the shell, and scale height of the gas in which light makes it, m: the main peak stands
#: at 120 to 150 km, scale heights are near 10 km (Withers 2009, Advances in Space Research 44:277).
SHELL, SCALE_HEIGHT = 150e3, 10e3

#: Metres of delay times Hz^2 for one TECU: 40.3 m^3/s^2 times 1e16 per m^2.
DELAY = 40.3e16


def zenith_delay(content: float, frequency: float) -> float:
    """Delay straight up, m: ``40.3 TEC / f^2`` of TECU and Hz."""
    return DELAY * content / frequency**2


def obliquity(elevation: ArrayLike, radius: float) -> NDArray[np.float64]:
    """Path through the shell over that straight up, seen from `radius` metres.

    ``1/sqrt(1 - (R cos(el)/(R + h))^2)``: 3.5 at Mars's horizon.
    """
    share = radius / (radius + SHELL) * np.cos(np.asarray(elevation, dtype=float))
    return 1.0 / np.sqrt(1.0 - share**2)
