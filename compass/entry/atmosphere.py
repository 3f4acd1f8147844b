"""The atmosphere: exponential as the papers take it, or a tabulated profile from a file."""

from dataclasses import dataclass, replace
from math import log, sqrt
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.bodies import Constant
from compass.errors import ArgumentError, DesignError

CO2_GAS_CONSTANT = Constant(
    188.924, "J/(kg K)", 1e-3, "8.314462618 J/(mol K) over 44.0095 g/mol (CODATA 2018, IUPAC 2021)"
)
CO2_HEAT_RATIO = Constant(
    1.294, "1", 5e-3, "Span and Wagner 1996, J. Phys. Chem. Ref. Data 25:1509: CO2 at 300 K, 0 MPa"
)


@dataclass(frozen=True)
class Atmosphere:
    """Density over radius, and the speed of sound.

    Attributes
    ----------
    reference_density
        Density at `reference_radius`, kg/m^3.
    reference_radius
        r0, metres from Mars's centre.
    scale_height
        h of ``rho0 exp((r0 - r)/h)``, metres; unused where a table is given.
    table_radius, table_density
        A tabulated profile, metres and kg/m^3, or empty; exponential between its rows, and taken
        as it is: `reference_density` becomes what it has at `reference_radius`.
    temperature
        Kelvin, for the speed of sound of an isothermal CO2 atmosphere.
    winds
        Distance from the centre (m, increasing) and wind to the east and to the north there, m/s,
        in air that turns with the planet; linear between, constant beyond; empty for none.
    """

    reference_density: float
    reference_radius: float
    scale_height: float
    table_radius: tuple[float, ...] = ()
    table_density: tuple[float, ...] = ()
    temperature: float = 200.0
    winds: tuple[tuple[float, float, float], ...] = ()

    def __post_init__(self) -> None:
        for name in ("reference_density", "reference_radius", "scale_height", "temperature"):
            if not 0 < getattr(self, name) < float("inf"):
                raise ArgumentError(f"{name} = {getattr(self, name)}: must be positive")
        if len(self.table_radius) != len(self.table_density) or len(self.table_radius) == 1:
            raise ArgumentError(
                f"atmosphere table: {len(self.table_radius)} radii and "
                f"{len(self.table_density)} densities; give as many of each, at least two"
            )
        if np.any(np.diff(self.table_radius) <= 0):
            raise ArgumentError("atmosphere table: altitudes must increase strictly")
        if (
            np.any(np.diff([row[0] for row in self.winds]) <= 0)
            or not np.isfinite(self.winds).all()
        ):
            raise ArgumentError("atmosphere winds: altitudes must increase strictly, all finite")
        if any(not 0 < density < float("inf") for density in self.table_density):
            raise ArgumentError("atmosphere table: every density must be positive")
        if self.table_radius:
            here = float(np.exp(self.log_density(self.reference_radius)))
            object.__setattr__(self, "reference_density", here)

    @property
    def log_reference_density(self) -> float:
        """``ln rho0``, the seventh state of the entry dynamics."""
        return log(self.reference_density)

    @property
    def speed_of_sound(self) -> float:
        """``sqrt(gamma R T)`` of CO2, m/s."""
        return sqrt(CO2_HEAT_RATIO.value * CO2_GAS_CONSTANT.value * self.temperature)

    def density(self, radius: ArrayLike) -> NDArray[np.float64]:
        """Density at distances from Mars's centre (m, any shape), kg/m^3."""
        return np.exp(self.log_density(np.asarray(radius, dtype=float)))

    def log_density(self, radius: ArrayLike) -> NDArray[np.float64]:
        """``ln rho`` (rho in kg/m^3) at distances from Mars's centre (m, any shape).

        Linear between the rows of a table, its end layers going on for ever; finite where the
        density itself is too small for a number.
        """
        r = np.asarray(radius, dtype=float)
        if not self.table_radius:
            return self.log_reference_density + (self.reference_radius - r) / self.scale_height
        rows, logs = np.array(self.table_radius), np.log(self.table_density)
        low = np.clip(np.searchsorted(rows, r, side="right") - 1, 0, rows.size - 2)
        slope = np.diff(logs) / np.diff(rows)
        return np.asarray(logs[low] + slope[low] * (r - rows[low]))

    def of_density(self, reference_density: float) -> "Atmosphere":
        """Return the atmosphere with another density at its reference radius, a table scaled."""
        share = reference_density / self.reference_density
        return replace(
            self,
            reference_density=reference_density,
            table_density=tuple(share * density for density in self.table_density),
        )

    def changed(
        self, *, density_bias: float = 0.0, scale_height_factor: float = 1.0
    ) -> "Atmosphere":
        """Return the atmosphere as it might really be.

        Parameters
        ----------
        density_bias
            Relative error of the density: the new density is ``1 + density_bias`` times the old.
        scale_height_factor
            Stretches the profile about the reference radius: the new scale height (of every
            layer of a table) is this many times the old.

        Raises
        ------
        ArgumentError
            A density or scale height that would not be positive.
        """
        if not 0 < scale_height_factor < float("inf"):
            raise ArgumentError(f"scale_height_factor = {scale_height_factor}: must be positive")
        r0 = self.reference_radius
        return replace(
            self,
            reference_density=self.reference_density * (1.0 + density_bias),
            table_density=tuple(density * (1.0 + density_bias) for density in self.table_density),
            scale_height=self.scale_height * scale_height_factor,
            table_radius=tuple(r0 + scale_height_factor * (r - r0) for r in self.table_radius),
        )


def read_atmosphere_table(path: Path) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Altitudes (m) and densities (kg/m^3) of a text file of two columns: km and kg/m^3.

    Columns are separated by a comma or blanks; lines that start with ``#`` are comments.

    Raises
    ------
    DesignError
        The file is missing or a row is not two numbers.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not text in UTF-8"
        raise DesignError(f"{path}: cannot be read: {reason}; check the path") from error
    rows = []
    for number, line in enumerate(lines, start=1):
        text = line.split("#")[0].replace(",", " ").split()
        if not text:
            continue
        try:
            altitude, density = (float(word) for word in text)
        except ValueError as error:
            raise DesignError(
                f"{path}: line {number} = {line.strip()!r}: must be two numbers, "
                "altitude in km and density in kg/m^3"
            ) from error
        rows.append((altitude * 1e3, density))
    altitudes, densities = zip(*rows, strict=True) if rows else ((), ())
    return tuple(altitudes), tuple(densities)
