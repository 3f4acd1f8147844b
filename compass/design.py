"""A design: a constellation, who uses it, and the stations and radios around it. No files."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from hashlib import sha256
from typing import Any, Literal, NoReturn, get_args

import numpy as np

from compass.arguments import checked
from compass.bodies import SOLAR_DAY
from compass.errors import ArgumentError, whole_number
from compass.frames import BY_NAME, FigureByName
from compass.integrity import Integrity
from compass.orbits.constellation import Constellation
from compass.orbits.motion import Motion
from compass.orbits.patterns import with_changes, worded
from compass.ranging import Signal
from compass.sites import Mask, Site
from compass.tracking import Tracking
from compass.words import counted

#: Largest PDOP that counts as good, unless someone says otherwise.
PDOP_MAX = 6.0

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


#: What a requirement may limit from above: dilutions of precision, errors of a fix in metres, and
#: protection levels, which are sampled.
DILUTIONS = ("pdop", "gdop", "hdop", "vdop", "tdop")
ERRORS = ("error_horizontal_m", "error_vertical_m", "error_position_m", "error_time_m")
PROTECTIONS = ("protection_horizontal_m", "protection_vertical_m")
LIMITS = DILUTIONS + ERRORS + PROTECTIONS

#: Satellites without which a dilution of precision is infinite.
FEWEST = 4

#: What an error in metres is meant as.
ErrorAs = Literal["one-sigma", "95-percent"]


@dataclass(frozen=True)
class Requirement:
    """What must be so at places; whether it is so is another matter (`compass.check`).

    `Requirement.of` makes it of degrees and kilometres.

    Attributes
    ----------
    name
        What to call it.
    sites
        Places, each over its own horizon where that is higher than the mask.
    regions
        As `compass.coverage.region.read_regions` reads them; without these and sites the globe.
    fold
        Satellites wanted in view at once, or None.
    mask
        Elevation mask, radians; None for the design's.
    limits
        Names of `LIMITS` and the largest values allowed.
    beam
        Half angle of the satellites' antennas about the way down, radians, outside of which users
        see nothing; None all around.
    error_as
        Whether errors are one sigma, or what 95 % of them stay below: 1.96 sigma, which holds at
        least so many of a horizontal or position error.
    share
        Part of the time, or of area and time, for which it must be so; 1 means always.
    share_of
        ``time``, at the worst place, or ``area-time``.
    altitude
        Height of the users of regions above the figure, metres.
    losses
        It must be so without any so many satellites.
    """

    name: str
    sites: tuple[Site, ...] = ()
    regions: tuple[str, ...] = ()
    fold: int | None = None
    mask: float | None = None
    limits: tuple[tuple[str, float], ...] = ()
    share: float = 1.0
    share_of: Literal["time", "area-time"] = "time"
    altitude: float = 0.0
    losses: int = 0
    error_as: ErrorAs = "one-sigma"
    beam: float | None = None

    @classmethod
    @checked
    def of(
        cls,
        name: str,
        *,
        sites: Sequence[Site] = (),
        regions: str | Sequence[str] = (),
        fold: int | None = None,
        mask_deg: float | None = None,
        share: float = 1.0,
        share_of: Literal["time", "area-time"] = "time",
        altitude_km: float = 0.0,
        losses: int = 0,
        error_as: ErrorAs = "one-sigma",
        beam_deg: float | None = None,
        **at_most: float,
    ) -> "Requirement":
        """Make a requirement of degrees and kilometres, by the keys of design files.

        Parameters
        ----------
        name, sites, regions, fold, share, share_of, losses, error_as
            As of the class.
        mask_deg
            Elevation mask, above -90 to below 90; the design's if left out.
        altitude_km
            Height of the users of regions above the figure, from 0; who is above satellites sees
            those beyond the limb of Mars (`mask_deg` from there on).
        beam_deg
            Half angle of the satellites' antennas about the way down, above 0 to below 180.
        **at_most
            ``pdop_at_most``, ``gdop_at_most``, ...: the largest dilutions allowed, from 1;
            ``error_horizontal_m_at_most``, ...: the largest errors of a fix, above 0 m, of designs
            with a signal; ``protection_horizontal_m_at_most``, ...: the largest protection levels,
            of designs with integrity besides.

        Raises
        ------
        ArgumentError
            Nothing is asked for, or something is out of its range.

        Examples
        --------
        >>> import compass
        >>> compass.Requirement.of("survey", fold=4, pdop_at_most=6, share=0.9).claim
        '4 satellites and PDOP at most 6, for 90 % of the time, globe'
        """
        known = {f"{limit}_at_most": limit for limit in LIMITS}
        for key in at_most:
            if key not in known:
                raise ArgumentError(f"{key}: unknown; allowed {', '.join(known)}")
        if fold is None and not at_most:
            raise ArgumentError(
                f"requirement {name}: asks for nothing; add fold or one of {', '.join(known)}"
            )
        if error_as not in get_args(ErrorAs):
            known_as = ", ".join(get_args(ErrorAs))
            raise ArgumentError(f"error_as = {error_as!r}: allowed {known_as}")
        return cls(
            name,
            tuple(sites),
            (regions,) if isinstance(regions, str) else tuple(regions),
            fold,
            None if mask_deg is None else float(np.radians(mask_deg)),
            tuple((known[key], limit) for key, limit in at_most.items()),
            share,
            share_of,
            altitude_km * 1e3,
            losses,
            error_as,
            None if beam_deg is None else float(np.radians(beam_deg)),
        )

    @property
    def counts(self) -> int | None:
        """Satellites in view to be asked for by themselves; None where its limits imply them.

        A dilution of precision, or an error, is finite only where `FEWEST` are in view: whoever
        keeps the limit for a share of the time has so many at the same moments.
        """
        implied = self.limits and self.share < 1.0 and (self.fold or 0) <= FEWEST
        return None if implied else self.fold

    @property
    def areas(self) -> tuple[str, ...]:
        """Its regions; the globe where it names neither a region nor a site."""
        return self.regions or (() if self.sites else ("globe",))

    @property
    def claim(self) -> str:
        """What must be so, when and where, in words."""
        return f"{self.wanted}, {self.when}, {self.where}"

    @property
    def wanted(self) -> str:
        """What is wanted, in words."""
        parts = [counted(self.fold, "satellite")] if self.fold is not None else []
        parts += [
            f"{self.titled(name)} at most {limit:g}{self.unit(name)}" for name, limit in self.limits
        ]
        after = f" without any {self.losses}" if self.losses else ""
        return " and ".join(parts) + after

    def titled(self, limited: str) -> str:
        """One of its limits' names in words."""
        if limited in DILUTIONS:
            return limited.upper()
        if limited in PROTECTIONS:
            return f"{limited.split('_')[1]} protection level"
        way = "" if self.error_as == "one-sigma" else ", 95 %"
        return f"{limited.split('_')[1]} error{way}"

    @staticmethod
    def unit(limited: str) -> str:
        """Unit of one of its limits, behind a number."""
        return "" if limited in DILUTIONS else " m"

    @property
    def when(self) -> str:
        """How much of the time, in words."""
        if self.share == 1.0:
            return "always"
        of = "of the time" if self.share_of == "time" else "of area and time"
        return f"for {100 * self.share:g} % {of}"

    @property
    def where(self) -> str:
        """Where, in words."""
        named = [*(site.name for site in self.sites), *self.areas]
        return ", ".join(named) + standing_words(self.altitude, self.beam)


def standing_words(altitude: float, beam: float | None) -> str:
    """How high users stand, metres, and in which beams, radians, behind where they are."""
    high = f", {altitude / 1e3:g} km above the ground" if altitude else ""
    return high + ("" if beam is None else f", in beams of {np.degrees(beam):g} deg")


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
        The file's name as given.
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

    def __add__(self, other: object) -> NoReturn:
        raise ArgumentError(
            f"{self.name} + {getattr(other, 'name', type(other).__name__)}: designs do not add, "
            "for their masks, stations and figures may differ; join their constellations, as in "
            "compass.Design(one.constellation + other.constellation, mask=one.mask)"
        )

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
