"""Noise of ranges from the link: distance, the lander's antenna, plasma, and its code loop."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from compass.design import Radio
from compass.entry.atmosphere import Atmosphere
from compass.entry.beacons import Beacons
from compass.entry.radio import ElectronModel, ElectronTable, attenuation, electron_density
from compass.errors import ArgumentError
from compass.ranging import Receiver

Array = NDArray[np.float64]

Pointing = Literal["aft", "zenith"]


@dataclass(frozen=True)
class Link:
    """Radio from every beacon to the lander.

    Attributes
    ----------
    radio
        Frequency, EIRP, the lander's G/T along its antenna's axis, and the C/N0 below which
        nothing is measured.
    receiver
        The code loop.
    beamwidth
        Full width at half power of the lander's antenna, radians, up to pi: ``G = cos^q`` of the
        angle off the axis and nothing behind (Stutzman and Thiele 2013, Antenna Theory and
        Design, 3rd ed., section 9.5); infinite: alike in all directions.
    pointing
        Its axis: ``aft``, against the velocity, or ``zenith``.
    electrons
        Plasma that signals cross, or None.
    thickness
        Of the plasma, m.
    """

    radio: Radio
    receiver: Receiver
    beamwidth: float = float("inf")
    pointing: Pointing = "aft"
    electrons: ElectronModel | ElectronTable | None = None
    thickness: float = 0.0

    def __post_init__(self) -> None:
        if self.pointing not in get_args(Pointing):
            allowed = ", ".join(get_args(Pointing))
            raise ArgumentError(f"pointing = {self.pointing!r}: allowed {allowed}")
        if not (0 < self.beamwidth < np.pi or np.isinf(self.beamwidth)):
            raise ArgumentError(
                f"beamwidth = {np.degrees(self.beamwidth):g} deg: allowed above 0 and below 180, "
                "or leave it out for an antenna alike in all directions"
            )
        if not 0 <= self.thickness < float("inf"):
            raise ArgumentError(f"thickness = {self.thickness:g} m: must be 0 or more")

    def carrier_to_noise(
        self, beacons: Beacons, path: Array, air: Atmosphere, planet_radius: float
    ) -> Array:
        """C/N0 of every beacon's signal along a flight (t, 6), dB Hz, shape (t, n)."""
        from compass.contacts.radio import carrier_to_noise

        line = beacons.r - path[:, None, :3]
        distance = np.linalg.norm(line, axis=2)
        free = carrier_to_noise(self.radio, distance)
        found = free - self._antenna(path, line / distance[..., None])
        if self.electrons is not None:
            r, speed = np.linalg.norm(path[:, :3], axis=1), np.linalg.norm(path[:, 3:], axis=1)
            n = electron_density(self.electrons, r - planet_radius, air.density(r), speed)
            found -= (self.thickness * attenuation(n, self.radio.frequency))[:, None]
        return found

    def _antenna(self, path: Array, toward: Array) -> Array:
        """Loss off the antenna's axis, dB, shape (t, n)."""
        if np.isinf(self.beamwidth):
            return np.zeros(toward.shape[:2])
        axis = path[:, :3] if self.pointing == "zenith" else -path[:, 3:]
        cosine = (toward * (axis / np.linalg.norm(axis, axis=1)[:, None])[:, None]).sum(axis=2)
        # ln cos of half the width, of a narrow one too
        power = np.log(0.5) / np.log1p(-2.0 * np.sin(self.beamwidth / 4.0) ** 2)
        with np.errstate(divide="ignore"):
            return np.asarray(-10.0 * power * np.log10(np.maximum(cosine, 0.0)))

    def range_variance(
        self, beacons: Beacons, path: Array, air: Atmosphere, planet_radius: float
    ) -> Array:
        """Variance of ranges by the code loop, m^2, (t, n); nan below the C/N0 it needs."""
        decibels = self.carrier_to_noise(beacons, path, air, planet_radius)
        heard = decibels >= self.radio.required
        a, b = self.receiver.loop(1.0)  # at a C/N0 of 1 Hz
        inverse = 10.0 ** (-np.where(heard, decibels, np.nan) / 10.0)
        return np.asarray(a * inverse + b * inverse**2)
