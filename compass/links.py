"""Which links a design wants, and the radios that they are made by."""

from dataclasses import dataclass
from typing import Literal

#: What can stand at an end of a link.
LinkEnd = Literal["station", "satellite", "moon", "earth"]


@dataclass(frozen=True)
class Wanted:
    """What to link besides stations and satellites.

    Attributes
    ----------
    moons
        Names of the moons.
    earth
        Whether to link with the Earth.
    crosslinks
        Whether to link satellites with each other.
    atmosphere_height
        How far above the figure a ray between two nodes off the surface must pass, metres.
    """

    moons: tuple[str, ...] = ()
    earth: bool = False
    crosslinks: bool = False
    atmosphere_height: float = 0.0


@dataclass(frozen=True)
class Radio:
    """A radio link between two kinds of nodes.

    Attributes
    ----------
    between
        The two kinds, in either order.
    frequency
        Carrier, Hz.
    eirp
        Equivalent isotropic radiated power of the sender, dBW.
    figure_of_merit
        G/T of the receiver, dB/K.
    required
        C/N0 at which the link is usable, dB Hz.
    """

    between: tuple[LinkEnd, LinkEnd]
    frequency: float
    eirp: float
    figure_of_merit: float
    required: float

    def serves(self, one: str, two: str) -> bool:
        """Whether the link is for nodes of these kinds."""
        return sorted(self.between) == sorted((one, two))
