"""A design: a constellation, who uses it, and the stations and radios around it. No files."""

import shlex
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from hashlib import sha256
from typing import Any, NoReturn

import numpy as np

from compass.bodies import SOLAR_DAY
from compass.errors import ArgumentError, whole_number
from compass.frames import BY_NAME, FigureByName
from compass.integrity import Integrity
from compass.links import Radio, Wanted
from compass.orbits.constellation import Constellation
from compass.orbits.motion import Motion
from compass.orbits.patterns import with_changes, worded
from compass.ranging import Signal
from compass.requirement import Requirement
from compass.sites import Mask, Site
from compass.tracking import Tracking

#: Largest PDOP that counts as good, unless someone says otherwise.
PDOP_MAX = 6.0


@dataclass(frozen=True)
class Upkeep:
    """What satellites keep themselves with.

    Attributes
    ----------
    specific_impulse, dry_mass
        Of the propulsion, s, and of a satellite without propellant, kg.
    smallest_burn
        That can be commanded, m/s; a smaller one is made as large.
    execution_error
        Of every burn, relative, 1 sigma.
    navigation_error
        Of the place along the track that burns are decided on, m, 1 sigma.
    duration
        For how long, s.
    """

    specific_impulse: float = 220.0
    dry_mass: float = 100.0
    smallest_burn: float = 0.005
    execution_error: float = 0.01
    navigation_error: float = 1000.0
    duration: float = 365.25 * 86400.0


@dataclass(frozen=True)
class Launching:
    """How satellites are brought to their planes.

    Attributes
    ----------
    launched
        Altitude of the circular orbit launched into, m.
    waiting
        Lowest and highest altitude of waiting orbits, m.
    longest_wait
        Until the last plane is reached, s.
    satellites_a_launch
        At most; None for all in one.
    """

    launched: float = 400e3
    waiting: tuple[float, float] = (300e3, 12000e3)
    longest_wait: float = 365.25 * 86400.0
    satellites_a_launch: int | None = None


@dataclass(frozen=True, repr=False)
class Design:
    """A constellation and what it is for. Two are equal if all their values are.

    Examples
    --------
    >>> import compass
    >>> pattern = compass.walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
    >>> design = compass.Design(pattern, figure="kelly2018-sphere", mask=compass.Mask.of(5))
    >>> design.name, design.figure.name
    ('45°: 15/5/1', 'kelly2018-sphere')
    >>> design.varied(inclination_deg=50).name
    '50°: 15/5/1'

    Attributes
    ----------
    constellation
        The orbits.
    name
        What to call it; as the constellation is called if not said.
    source
        Where it comes from.
    paper
        Key of the source paper whose printed values the design is compared with, or None.
    figure
        Reference figure of Mars; its name will do.
    mask
        Elevation mask of users on the surface.
    fold
        Satellites that must be in view at once.
    stations
        Named sites.
    access
        What to link besides.
    access_duration
        Span over which to look for access, seconds.
    conjunction
        Sun-Earth-Mars angle below which links to the Earth are lost, radians.
    radios
        Radio links.
    motion
        How the satellites move.
    upkeep
        What they keep their slots with.
    launching
        How they come to their planes.
    requirements
        What must be so.
    signal
        The errors of ranges to the satellites, or None where nothing is known of them.
    tracking
        Who tracks the satellites, or None.
    integrity
        What users are promised, or None.
    text
        Of the file it was read from, for provenance; empty without one.
    label
        The file's name as given; of several designs that are one network the first's.
    beacons
        Places on the ground that transmit as satellites do, to sites over whose horizon they stand.
    others
        Names of the files of the others of that network.
    """

    constellation: Constellation
    name: str = ""
    source: str = ""
    paper: str | None = None
    figure: FigureByName = BY_NAME
    mask: Mask = field(default_factory=Mask)
    fold: int = 4
    stations: tuple[Site, ...] = ()
    access: Wanted = field(default_factory=Wanted)
    access_duration: float = 10 * SOLAR_DAY.value
    conjunction: float = float(np.radians(2.0))
    radios: tuple[Radio, ...] = ()
    motion: Motion = field(default_factory=Motion)
    upkeep: Upkeep = field(default_factory=Upkeep)
    launching: Launching = field(default_factory=Launching)
    requirements: tuple[Requirement, ...] = ()
    signal: Signal | None = None
    tracking: Tracking | None = None
    integrity: Integrity | None = None
    text: str = field(default="", compare=False)
    label: str = field(default="design", compare=False)
    others: tuple[str, ...] = field(default=(), compare=False)
    beacons: tuple[Site, ...] = ()

    def __post_init__(self) -> None:
        """Take a name from the constellation if there is no other, and lists as tuples.

        Raises
        ------
        ArgumentError
            A field holds something else than it must, or the fold is no whole number from 1 on.
        """
        for several in ("stations", "radios", "requirements"):
            if isinstance(given := getattr(self, several), str) or not isinstance(given, Iterable):
                raise ArgumentError(f"{several} = {given!r}: must be a list")
            object.__setattr__(self, several, tuple(given))
        for name, kind, remedy in (
            ("constellation", Constellation, "make it by walker_delta or from_elements, say"),
            ("mask", Mask, "make it of degrees, Mask.of(5)"),
            ("motion", Motion, "make it of a name, Motion('j2')"),
        ):
            _check_kind(name, getattr(self, name), kind, remedy)
        self.mask.on_the_ground()
        for site in self.stations:
            _check_kind("stations", site, Site, "make it of degrees, Site.of(...)")
        for radio in self.radios:
            _check_kind("radios", radio, Radio, "make it by Radio(...)")
        for wanted in self.requirements:
            _check_kind("requirements", wanted, Requirement, "make it by Requirement.of(...)")
        object.__setattr__(self, "fold", whole_number("fold", self.fold, 1))
        if not self.name:
            object.__setattr__(self, "name", self.constellation.name)

    def __repr__(self) -> str:
        mask = f"{np.degrees(self.mask.lowest):g}"
        if not self.mask.is_constant:
            mask += f" to {np.degrees(self.mask.highest):g}"
        counted = [("station", self.stations), ("requirement", self.requirements)]
        beside = "".join(
            f", {len(several)} {word}{'s' if len(several) > 1 else ''}"
            for word, several in counted
            if several
        )
        return (
            f"Design {self.name}: {self.constellation.words}; {self.fold} wanted in view above "
            f"{mask} deg, {self.motion.title}, {self.figure.words}{beside}"
        )

    @property
    def digest(self) -> str:
        """SHA-256 of the text in hexadecimal, for provenance."""
        return sha256(self.text.encode()).hexdigest()

    @property
    def typed(self) -> str:
        """Its files as typed on a command line; a network's one after the other."""
        return shlex.join((self.label, *self.others))

    def __add__(self, other: object) -> NoReturn:
        raise ArgumentError(
            f"{self.name} + {getattr(other, 'name', type(other).__name__)}: designs do not add, "
            "for their masks, stations and figures may differ; join their constellations, as in "
            "compass.Design(one.constellation + other.constellation, mask=one.mask)"
        )

    def with_satellites(self, kept: Sequence[int]) -> "Design":
        """Return the design with the satellites of these indices alone, and their covariances."""
        lost = [k for k in range(self.constellation.size) if k not in set(kept)]
        signal = self.signal
        if signal is not None and len(signal.covariance) > 1:
            signal = replace(signal, covariance=tuple(signal.covariance[k] for k in sorted(kept)))
        return replace(self, constellation=self.constellation.without(lost), signal=signal)

    def varied(
        self, *, mask_deg: float | None = None, fold: int | None = None, **changes: Any
    ) -> "Design":
        """Return the design with some of its numbers changed, by their keys in design files.

        Parameters
        ----------
        mask_deg
            As `compass.Mask.of`.
        fold
            Satellites wanted in view at once.
        **changes
            Of its pattern: ``satellites``, ``planes``, ``phasing``, ``inclination_deg``,
            ``raan_deg``, ``phase_deg``, and one of ``radius_km``, ``altitude_km``, ``orbit`` and
            ``repeat``. A design so changed is another: it is no longer compared with a paper.

        Raises
        ------
        ArgumentError
            A number that is not allowed or has another name; a pattern is to be changed where
            the orbits form none.

        Examples
        --------
        >>> import compass
        >>> design = compass.read_design("designs/walker-15-15-6.toml")
        >>> design.varied(inclination_deg=50, mask_deg=5).constellation.pattern.notation
        '50°: 15/15/6'
        """
        made = replace(
            self,
            mask=self.mask if mask_deg is None else Mask.of(mask_deg),
            fold=self.fold if fold is None else fold,
            text="",
        )
        if not changes:
            return made
        if self.motion.table is not None:
            raise ArgumentError(
                f"{next(iter(changes))}: the paths of {self.name} are given by a table; change that"
            )
        moved = with_changes(self.constellation, changes, self.figure)
        named = self.name == self.constellation.name
        return replace(
            made,
            constellation=moved,
            name=moved.name if named else f"{self.name}, {worded(changes)}",
            paper=None,
        )


def _check_kind(name: str, value: object, kind: type, remedy: str) -> None:
    """Refuse what a field cannot hold."""
    if not isinstance(value, kind):
        raise ArgumentError(f"{name} = {value!r}: must be a {kind.__name__}; {remedy}")
