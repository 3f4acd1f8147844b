"""The filters that a lander may carry: what they estimate, and how they take a measurement."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.kinds import INFORMATION, PLAIN, RELINEARISED, ROOTED, UNSCENTED
from compass.entry.layout import Layout, Part
from compass.errors import ArgumentError

Method = Literal["plain", "unscented", "relinearised", "square-root", "information"]

#: Numbers by which the kernels know the methods.
METHODS: dict[Method, int] = {
    "plain": PLAIN,
    "unscented": UNSCENTED,
    "relinearised": RELINEARISED,
    "square-root": ROOTED,
    "information": INFORMATION,
}


@dataclass(frozen=True)
class Filter:
    """An extended Kalman filter on Mars-fixed position and velocity, and on further blocks.

    Attributes
    ----------
    covariance0
        Covariance of the first position and velocity, (6, 6), SI.
    noise
        Process noise variance per second of the six spherical numbers, (6,).
    iterations
        Passes of each update: 1 is the plain filter, more the iterated one.
    parts
        Further blocks, estimated or considered.
    method
        ``plain``: extended; ``unscented``: moved on through spread points; ``relinearised``: looks
        back when density or L/D is known twice as well; ``square-root``: extended, with a root of
        its covariance in its stead; ``information``: extended, what an epoch tells is gathered as
        information before it is inverted; see `compass.core.entry.filter`.
    """

    covariance0: NDArray[np.float64]
    noise: NDArray[np.float64]
    iterations: int = 1
    parts: tuple[Part, ...] = ()
    method: Method = "plain"

    def __post_init__(self) -> None:
        if self.method not in get_args(Method):
            allowed = ", ".join(get_args(Method))
            raise ArgumentError(f"method = {self.method!r}: allowed {allowed}")
        if self.method == "relinearised" and (
            np.any(self.noise) or any(part.scales or part.walk for part in self.parts)
        ):
            raise ArgumentError(
                "filter: with process noise or a density that wanders there is no one flight to "
                'look back along; take method = "unscented"'
            )
        if self.method == "information" and any(part.considered for part in self.parts):
            raise ArgumentError(
                "filter: information knows no block that is only considered; estimate it, or take "
                'method = "plain"'
            )
        if self.iterations < 1:
            raise ArgumentError(f"iterations = {self.iterations}: must be at least 1")
        if np.any(~(np.asarray(self.noise) >= 0)):
            raise ArgumentError("process noise: every variance must be 0 or more")
        try:
            root(np.asarray(self.covariance0, dtype=float))
        except np.linalg.LinAlgError as error:
            raise ArgumentError(
                "initial covariance: not positive definite; every sigma must be above 0"
            ) from error

    def layout(self, beacons: int) -> Layout:
        """Where the blocks of the state stand, for so many beacons."""
        return Layout(self.parts, beacons)


def root(covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Cholesky factor, of the correlation matrix scaled back: metres beside radians cost none."""
    scale = np.sqrt(np.diag(covariance))
    if not np.all(scale > 0):
        raise np.linalg.LinAlgError("a variance is not positive")
    factor: NDArray[np.float64] = np.linalg.cholesky(covariance / np.outer(scale, scale))
    return scale[:, None] * factor
