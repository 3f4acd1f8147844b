"""What a design must do: a requirement on satellites in view, geometry, errors or protection."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from compass.arguments import checked
from compass.errors import ArgumentError
from compass.sites import Site
from compass.words import counted, latitude_words

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
        '4 satellites and PDOP at most 6, for 90 % of the time, all of Mars'
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
        named = [*(site.name for site in self.sites), *map(_area_words, self.areas)]
        return ", ".join(named) + standing_words(self.altitude, self.beam)


def _area_words(area: str) -> str:
    """A region as a reader says it; corners of a polygon as they were given."""
    kind, _, given = area.partition(":")
    if kind == "lat":
        return " to ".join(latitude_words(float(bound), "g") for bound in given.split(":"))
    return "all of Mars" if area == "globe" else area


def standing_words(altitude: float, beam: float | None) -> str:
    """How high users stand, metres, and in which beams, radians, behind where they are."""
    high = f", {altitude / 1e3:g} km above the ground" if altitude else ""
    return high + ("" if beam is None else f", in beams of {np.degrees(beam):g} deg")
