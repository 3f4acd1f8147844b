"""Places on Mars and the elevation mask of what stands around them."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import degrees

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.arguments import are_numbers, checked
from compass.errors import ArgumentError, real_number
from compass.frames import (
    BY_NAME,
    DEFAULT_FIGURE,
    Figure,
    FigureByName,
    direction,
    east_north_up,
    planetographic_latitude,
)
from compass.words import place_words


def _degrees(radians: ArrayLike) -> list[float]:
    """Degrees as they were given: what radians have rounded is rounded back."""
    return [float(f"{x:.12g}") for x in np.degrees(radians)]


@dataclass(frozen=True)
class Mask:
    """Elevation below which nothing is seen, as a function of azimuth.

    Attributes
    ----------
    azimuth
        Azimuths clockwise from north, radians, strictly increasing in [0, 2 pi).
    elevation
        Mask elevation at each azimuth, radians, in [0, pi/2), above -pi/2 for users above the
        ground; linear between, periodic. A single pair is a constant mask.
    """

    azimuth: tuple[float, ...] = (0.0,)
    elevation: tuple[float, ...] = (0.0,)

    def __post_init__(self) -> None:
        if len(self.azimuth) != len(self.elevation) or not self.azimuth:
            raise ArgumentError(
                f"mask: {len(self.azimuth)} azimuths and {len(self.elevation)} elevations; "
                "give as many of one as of the other, and at least one"
            )
        azimuth, elevation = np.array(self.azimuth), np.array(self.elevation)
        if not np.all((azimuth >= 0) & (azimuth < 2 * np.pi)) or np.any(np.diff(azimuth) <= 0):
            raise ArgumentError(
                f"mask: azimuths {_degrees(azimuth)} deg; they must increase "
                "strictly from 0 up to below 360"
            )
        if not np.all(np.abs(elevation) < np.pi / 2):
            self._refuse()

    def on_the_ground(self) -> "Mask":
        """Return the mask if it hides all that the ground does.

        Raises
        ------
        ArgumentError
            It reaches below 0 somewhere.
        """
        if self.lowest < 0:
            self._refuse()
        return self

    def _refuse(self) -> None:
        raise ArgumentError(
            f"mask: elevations {_degrees(self.elevation)} deg; allowed 0 up to below 90, in orbit "
            "from above -90 on"
        )

    @classmethod
    def constant(cls, elevation: float) -> "Mask":
        """Return the same mask elevation (radians) all around."""
        return cls((0.0,), (float(elevation),))

    @classmethod
    def of(cls, mask_deg: float | Sequence[Sequence[float]]) -> "Mask":
        """Make a mask of degrees: an elevation all around, or pairs of azimuth and elevation.

        Raises
        ------
        ArgumentError
            An azimuth or an elevation that is not allowed.

        Examples
        --------
        >>> import compass
        >>> compass.Mask.of(5).is_constant
        True
        >>> compass.Mask.of([(0, 5), (180, 12)]).is_constant
        False
        """
        given = np.array(mask_deg, dtype=float) if are_numbers(mask_deg) else np.empty(0)
        pairs = np.array([[0.0, float(given)]]) if given.ndim == 0 else given
        if pairs.ndim != 2 or pairs.shape[1] != 2:
            raise ArgumentError(
                f"mask_deg = {mask_deg}: must be an elevation, or pairs of azimuth and elevation"
            )
        azimuth, elevation = np.radians(pairs).T
        return cls(tuple(azimuth.tolist()), tuple(elevation.tolist())).on_the_ground()

    @property
    def is_constant(self) -> bool:
        """Whether the mask is the same in every direction."""
        return len(set(self.elevation)) == 1

    @property
    def lowest(self) -> float:
        """The smallest mask elevation, radians."""
        return min(self.elevation)

    @property
    def highest(self) -> float:
        """The largest mask elevation, radians."""
        return max(self.elevation)

    def or_higher(self, other: "Mask") -> "Mask":
        """The higher of two masks in every direction, exactly: where they cross there is a corner.

        Beside the crossing another corner may be needed at azimuths that double numbers tell apart
        no more; there the higher of both is kept.
        """
        if self.is_constant and other.is_constant:
            return Mask.constant(max(self.highest, other.highest))
        azimuths = np.union1d(self.azimuth, other.azimuth)
        following = np.append(azimuths[1:], azimuths[0] + 2 * np.pi)
        start = self.at(azimuths) - other.at(azimuths)
        end = np.roll(start, -1)
        cross = start * end < 0
        part = start[cross] / (start[cross] - end[cross])
        between = azimuths[cross] + part * (following - azimuths)[cross]
        azimuths = np.union1d(azimuths, np.mod(between, 2 * np.pi))
        highest = np.maximum(self.at(azimuths), other.at(azimuths))
        return Mask(tuple(azimuths.tolist()), tuple(highest.tolist()))

    def at(self, azimuth: ArrayLike) -> NDArray[np.float64]:
        """Mask elevation, radians, at azimuths in radians (any shape)."""
        return np.interp(np.asarray(azimuth), self.azimuth, self.elevation, period=2 * np.pi)


@dataclass(frozen=True, repr=False)
class Site:
    """A place on the surface; `Site.of` makes it of degrees and kilometres.

    Attributes
    ----------
    name
        What to call it.
    latitude
        Planetocentric latitude of the surface point, radians.
    longitude
        East longitude, radians.
    height
        Height above the reference figure along its normal, metres.
    mask
        What the site's horizon hides.
    figure
        The reference figure, or its name; its normal is the site's up.
    """

    name: str
    latitude: float
    longitude: float
    height: float = 0.0
    mask: Mask = field(default_factory=Mask)
    figure: FigureByName = BY_NAME

    def __post_init__(self) -> None:
        for name in ("latitude", "longitude", "height"):
            real_number(name, getattr(self, name))
        if not isinstance(self.mask, Mask):
            raise ArgumentError(
                f"mask = {self.mask!r}: must be a Mask; make it of degrees, Mask.of({self.mask!r})"
            )
        if not abs(self.latitude) <= np.pi / 2:
            raise ArgumentError(
                f"latitude = {self.latitude:g} rad: allowed -pi/2 to pi/2; "
                "Site.of takes degrees (latitude_deg)"
            )
        if self.height <= 0.0:
            self.mask.on_the_ground()

    def __repr__(self) -> str:
        place = place_words(degrees(self.latitude), degrees(self.longitude), ".6g")
        return f"Site {self.name}: {place}, height {self.height / 1e3:g} km, {self.figure.words}"

    @classmethod
    @checked
    def of(
        cls,
        name: str,
        *,
        latitude_deg: float,
        longitude_deg: float,
        height_km: float = 0.0,
        mask_deg: float | Sequence[Sequence[float]] = 0.0,
        figure: Figure | str = DEFAULT_FIGURE,
    ) -> "Site":
        """Make a site of degrees and kilometres, as design files have them.

        Parameters
        ----------
        name
            What to call it.
        latitude_deg, longitude_deg
            Planetocentric, -90 to 90; east, -180 to 360.
        height_km
            Over the figure, -10 to 30.
        mask_deg
            As `Mask.of`.
        figure
            The reference figure, or its name.

        Raises
        ------
        ArgumentError
            One of them is not allowed.

        Examples
        --------
        >>> import compass
        >>> gale = compass.Site.of("Gale", latitude_deg=-4.6, longitude_deg=137.4, mask_deg=10)
        >>> round(float(abs(gale.r_mcmf @ gale.r_mcmf) ** 0.5))
        3396190
        """
        for field_name, value, (low, high) in (
            ("latitude_deg", latitude_deg, (-90, 90)),
            ("longitude_deg", longitude_deg, (-180, 360)),
            ("height_km", height_km, (-10, 30)),
        ):
            if not low <= real_number(field_name, value) <= high:
                raise ArgumentError(f"{field_name} = {value:g}: allowed {low} to {high}")
        place = float(np.radians(latitude_deg)), float(np.radians(longitude_deg))
        return cls(name, *place, height_km * 1e3, Mask.of(mask_deg), figure)

    @cached_property
    def r_mcmf(self) -> NDArray[np.float64]:
        """Mars-fixed position, metres, shape (3,)."""
        a, b = self.figure.equatorial_radius, self.figure.polar_radius
        radius = a * b / np.hypot(b * np.cos(self.latitude), a * np.sin(self.latitude))
        surface = radius * direction(self.latitude, self.longitude)
        return surface + self.height * self.enu_mcmf[2]

    @cached_property
    def enu_mcmf(self) -> NDArray[np.float64]:
        """Unit vectors east, north, up (rows) in the Mars-fixed frame, shape (3, 3)."""
        up_latitude = planetographic_latitude(self.latitude, self.figure)
        return east_north_up(up_latitude, self.longitude)

    def elevation_azimuth(
        self, r_mcmf: ArrayLike
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Elevation and azimuth (clockwise from north, in [0, 2 pi)) of points, radians.

        Parameters
        ----------
        r_mcmf
            Mars-fixed positions, metres, shape (..., 3).
        """
        east, north, up = np.moveaxis((np.asarray(r_mcmf) - self.r_mcmf) @ self.enu_mcmf.T, -1, 0)
        elevation = np.arctan2(up, np.hypot(east, north))
        return elevation, np.mod(np.arctan2(east, north), 2 * np.pi)

    def sees(self, r_mcmf: ArrayLike) -> NDArray[np.bool_]:
        """Whether each point (..., 3), metres, stands at or above the site's mask."""
        elevation, azimuth = self.elevation_azimuth(r_mcmf)
        return elevation >= self.mask.at(azimuth)
