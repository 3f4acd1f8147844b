"""Noise of ranges from the link: distance, the lander's antenna, plasma, and its code loop."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from compass.entry.atmosphere import Atmosphere
from compass.entry.beacons import Beacons
from compass.entry.radio import ElectronModel, ElectronTable, attenuation, electron_density
from compass.errors import ArgumentError
from compass.links import Radio
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

    def numbers(self) -> Array:
        """Numbers as the kernels take them, see `compass.core.entry.loop.NEAR`."""
        from compass.contacts.radio import carrier_to_noise  # brings kernels with it

        # ln cos of half the width, of a narrow one too
        sine = 0.0 if np.isinf(self.beamwidth) else np.sin(self.beamwidth / 4.0)
        width = np.log1p(-2.0 * sine**2)
        return np.array(
            [
                float(carrier_to_noise(self.radio, 1.0)),
                self.radio.required,
                np.log(0.5) / width if width else 0.0,
                float(self.pointing == "zenith"),
                *self.receiver.loop(1.0),  # at a C/N0 of 1 Hz
            ]
        )

    def dimmed(self, path: Array, air: Atmosphere, planet_radius: float) -> Array:
        """What plasma takes from signals at states (..., 6), dB, shape (...)."""
        r, speed = np.linalg.norm(path[..., :3], axis=-1), np.linalg.norm(path[..., 3:], axis=-1)
        if self.electrons is None:
            return np.zeros(r.shape)
        n = electron_density(self.electrons, r - planet_radius, air.density(r), speed)
        return np.asarray(self.thickness * attenuation(n, self.radio.frequency))

    def carrier_to_noise(
        self, beacons: Beacons, path: Array, air: Atmosphere, planet_radius: float
    ) -> Array:
        """C/N0 of every beacon's signal along a flight (t, 6), dB Hz, shape (t, n)."""
        from compass.core.entry.loop import carriers

        flown, out = np.ascontiguousarray(path), np.empty(beacons.r.shape[:2])
        dimmed = self.dimmed(flown, air, planet_radius)
        carriers(self.numbers(), flown, beacons.states, dimmed, out)
        return out

    def range_variance(
        self, beacons: Beacons, path: Array, air: Atmosphere, planet_radius: float
    ) -> Array:
        """Variance of ranges by the code loop, m^2, (t, n); nan below the C/N0 it needs."""
        from compass.core.entry.loop import loop_variances

        decibels = self.carrier_to_noise(beacons, path, air, planet_radius)
        out = np.empty(decibels.shape)
        loop_variances(self.numbers(), decibels, out)
        return out
