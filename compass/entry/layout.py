"""What a filter's state is made of: named blocks in order, estimated before considered ones."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from compass.errors import ArgumentError


@dataclass(frozen=True)
class Block:
    """One kind of block: its name, number of states (None: one a beacon), units and meaning."""

    name: str
    size: int | None
    units: tuple[str, ...]
    title: str


#: All blocks; a further one is a record here and a column in `compass.core.entry.measure.PLACES`.
BLOCKS = (
    Block("position", 3, ("m",), "Mars-fixed position"),
    Block("velocity", 3, ("m/s",), "velocity relative to the rotating planet"),
    Block("air", 1, ("1",), "logarithm of true over known density"),
    Block("lift", 1, ("1",), "true less known lift-to-drag ratio"),
    Block("clock", 2, ("m", "m/s"), "the receiver's clock and its drift"),
    Block("bias", None, ("m",), "bias of the ranges of each beacon"),
    Block("imu", 3, ("m/s^2", "m/s^2", "m/s^2"), "biases of the accelerometers"),
    Block("attitude", 3, ("rad", "rad", "rad"), "small turn of the axes in which the lander looks"),
    Block("gyro", 3, ("rad/s", "rad/s", "rad/s"), "drift of these axes, which gyros hold"),
    Block("frame", 3, ("rad", "rad", "rad"), "small turn of the frame that satellites share"),
)

#: In every state, at its head.
ALWAYS = ("position", "velocity")


def block(name: str) -> Block:
    """Return the block of a name.

    Raises
    ------
    ArgumentError
        There is none.
    """
    for known in BLOCKS:
        if known.name == name:
            return known
    allowed = ", ".join(b.name for b in BLOCKS)
    raise ArgumentError(f"block = {name!r}: allowed {allowed}")


@dataclass(frozen=True)
class Part:
    """A block that a filter carries beside position and velocity.

    Attributes
    ----------
    name
        Of the block, see `BLOCKS`.
    sigma
        One sigma of each of its states, in the block's units; of biases one for all, or one each.
    considered
        Whether its uncertainty is only taken into account (Schmidt), not reduced.
    scales
        Of the density: metres of altitude, and along the ground, over which its correlation
        falls to 1/e (infinite: never); empty for one factor all the way.
    profile
        Of a density that wanders: distance from the centre (m, increasing) and sigma there, log-
        linear between, constant beyond; `sigma` is that where the flight begins. Empty for the
        same everywhere.
    walk
        Of gyros: what the axes that they hold wander beside their drift, rad/s^(1/2).
    told
        Of a frame: whether each beacon's place is told in it.
    """

    name: str
    sigma: tuple[float, ...]
    considered: bool = False
    scales: tuple[float, ...] = ()
    profile: tuple[tuple[float, float], ...] = ()
    walk: float = 0.0
    told: tuple[bool, ...] = ()

    def __post_init__(self) -> None:
        units = block(self.name).units
        if self.name == "bias" and len(self.sigma) > 1:
            units *= len(self.sigma)
        if self.name in ALWAYS:
            raise ArgumentError(f"block = {self.name!r}: is always there; leave it out")
        if len(self.sigma) != len(units):
            raise ArgumentError(
                f"{self.name}: {len(self.sigma)} sigmas; give {len(units)} ({', '.join(units)})"
            )
        if self.scales and (self.name != "air" or len(self.scales) != 2 or min(self.scales) <= 0):
            raise ArgumentError(
                f"{self.name}: scales = {list(self.scales)} m: two of density alone, both positive"
            )
        if not 0 <= self.walk < float("inf") or (self.walk and self.name != "gyro"):
            raise ArgumentError(f"{self.name}: walk = {self.walk}: of gyros alone, 0 or more")
        heights = [radius for radius, _ in self.profile]
        spread = [sigma for _, sigma in self.profile]
        if self.profile and (
            not self.scales or np.any(np.diff(heights) <= 0) or not min(spread) > 0
        ):
            raise ArgumentError(
                f"{self.name}: a profile of sigmas is of density with scales, its heights "
                "increasing and all sigmas above 0"
            )
        for sigma, unit in zip(self.sigma, units, strict=True):
            if not 0 < sigma < float("inf"):
                raise ArgumentError(f"{self.name}: sigma = {sigma} {unit}: must be positive")

    def sigma_at(self, radius: NDArray[np.float64]) -> NDArray[np.float64]:
        """Sigma of the first state at distances from the centre, m."""
        if not self.profile:
            return np.full(radius.shape, self.sigma[0])
        at, sigma = np.array(self.profile).T
        return np.exp(np.interp(radius, at, np.log(sigma)))


@dataclass(frozen=True)
class Layout:
    """Where the blocks of a state stand.

    Attributes
    ----------
    parts
        Blocks beside position and velocity.
    beacons
        Number of beacons, for blocks with a state each.
    """

    parts: tuple[Part, ...] = ()
    beacons: int = 0

    def __post_init__(self) -> None:
        names = [part.name for part in self.parts]
        for name in names:
            if names.count(name) > 1:
                raise ArgumentError(f"block = {name!r}: given twice; leave one out")
        if "gyro" in names and "attitude" not in names:
            raise ArgumentError('block = "gyro": needs "attitude", the axes that gyros hold')
        for part in self.parts:
            if len(self._sigmas(part)) != self.count(part):
                raise ArgumentError(
                    f"{part.name}: {len(part.sigma)} sigmas for {self.count(part)} states"
                )
            if part.name == "frame" and len(part.told) != self.beacons:
                raise ArgumentError(f"frame: told of {len(part.told)} of {self.beacons} beacons")

    @cached_property
    def order(self) -> tuple[Part, ...]:
        """Parts as they stand: estimated before considered."""
        return tuple(sorted(self.parts, key=lambda part: part.considered))

    def _sigmas(self, part: Part) -> tuple[float, ...]:
        if len(part.sigma) == 1 and part.name == "bias":
            return part.sigma * self.beacons
        return part.sigma

    def count(self, part: Part) -> int:
        """Number of states of a part."""
        size = block(part.name).size
        return self.beacons if size is None else size

    @property
    def size(self) -> int:
        """Number of states."""
        return 6 + sum(self.count(part) for part in self.parts)

    @property
    def estimated(self) -> int:
        """Number of states that are estimated; the rest is considered."""
        return 6 + sum(self.count(part) for part in self.parts if not part.considered)

    def place(self, name: str) -> int:
        """First state of a block; -1 if it is left out."""
        at = {"position": 0, "velocity": 3}
        here = 6
        for part in self.order:
            at[part.name] = here
            here += self.count(part)
        return at.get(block(name).name, -1)

    def numbers(self) -> NDArray[np.int64]:
        """Places as the kernels take them, see `compass.core.entry.measure.PLACES`."""
        names = ("air", "lift", "clock", "bias", "imu", "attitude", "gyro", "frame")
        told = [one for part in self.parts for one in part.told]
        return np.array(
            [self.estimated, *(self.place(name) for name in names), *told], dtype=np.int64
        )

    def covariance(self, motion: NDArray[np.float64]) -> NDArray[np.float64]:
        """Covariance of the whole state from that of position and velocity, (6, 6)."""
        out = np.zeros((self.size, self.size))
        out[:6, :6] = motion
        sigmas = [sigma for part in self.order for sigma in self._sigmas(part)]
        out[range(6, self.size), range(6, self.size)] = np.square(sigmas)
        return out

    def steps(
        self, path: NDArray[np.float64], times: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """What blocks gather and what is left of the density from the epoch before to each.

        The density wanders by a Gauss-Markov chain: over a climb dh and a way ds along the
        ground, ``exp(-sqrt((dh/H)^2 + (ds/S)^2))`` of its logarithm is left, and as much variance
        comes back as keeps it at its sigma; where that changes with height, the logarithm grows
        or shrinks with it.

        Parameters
        ----------
        path, times
            The flight at the epochs, (t, 6), and these, s, (t,).

        Returns
        -------
        walk, fade
            Variances, (t, s), and factors, (t,).
        """
        walk, fade = np.zeros((len(path), self.size)), np.ones(len(path))
        for part in self.parts:
            if part.scales:
                r = np.linalg.norm(path[:, :3], axis=1)
                turn = np.linalg.norm(np.diff(path[:, :3] / r[:, None], axis=0), axis=1)
                ways = np.diff(r) / part.scales[0], r[1:] * turn / part.scales[1]
                kept, sigma = np.ones(len(path)), part.sigma_at(r)
                kept[1:] = np.exp(-np.hypot(*ways))
                fade[1:] = kept[1:] * sigma[1:] / sigma[:-1]
                walk[:, self.place("air")] = sigma**2 * (1 - kept**2)
            if part.walk:
                axes = self.place("attitude")
                walk[1:, axes : axes + 3] = part.walk**2 * np.diff(times)[:, None]
        return walk, fade
