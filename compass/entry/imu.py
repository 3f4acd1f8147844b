"""The accelerometers of an inertial measurement unit."""

from dataclasses import dataclass
from math import isfinite

from compass.errors import ArgumentError


@dataclass(frozen=True)
class Imu:
    """Accelerometers along the drag, side and lift axes: ``a~ = a + b + noise``.

    Attributes
    ----------
    sigma
        Standard deviation of the white noise of one sample, m/s^2, one for each axis.
    bias
        Constant bias b, m/s^2, one for each axis.
    """

    sigma: tuple[float, float, float] = (1e-3, 1e-3, 1e-3)
    bias: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for sigma in self.sigma:
            if not (isfinite(sigma) and sigma >= 0):
                raise ArgumentError(f"imu: sigma = {sigma} m/s^2: must be 0 or more, and finite")
        for bias in self.bias:
            if not isfinite(bias):
                raise ArgumentError(f"imu: bias = {bias} m/s^2: must be a finite number")
