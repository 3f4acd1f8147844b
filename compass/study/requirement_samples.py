"""Random places and moments: which patterns break a claim there, and which keep it with most room.

A moment that breaks what is wanted always refutes a candidate; else samples only put candidates in
order, and drop those that chance cannot excuse. Nothing is proven by them.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from compass.bodies import MARS_ROTATION_RATE
from compass.core.pattern_samples import Circles, Claim, sample_pattern
from compass.coverage.certified_question import DOPS
from compass.coverage.certified_ranges import ERROR_DOPS, Ranges, sigma_allowed
from compass.coverage.samples import points_in, stand
from compass.coverage.users import Users
from compass.frames import (
    east_north_up,
    latitude_longitude,
    planetographic_latitude,
    prime_meridian_angle,
)
from compass.orbits import Constellation
from compass.requirement import Requirement

#: Random places and moments at which each group of users is looked at.
SAMPLES = 1000


@dataclass(frozen=True, eq=False)
class Moments:
    """Random moments of users, and what is wanted of them.

    Attributes
    ----------
    rows
        As `compass.core.pattern_samples.sample_pattern` takes them.
    users, wanted
        Whose they are, and the requirement.
    least_range
        What no range's error is below, m, where errors are wanted.
    """

    rows: NDArray[np.float64]
    users: Users
    wanted: Requirement
    least_range: float = 0.0

    @property
    def fold(self) -> int:
        """Satellites that must be in view: with geometry four, and as many more as may be lost."""
        return max(self.wanted.fold or 0, 4 if self.wanted.limits else 0) + self.wanted.losses

    @property
    def folds_alone(self) -> "Moments":
        """The same moments, at which nothing but the satellites in view count."""
        alone = replace(self.wanted, fold=self.fold - self.wanted.losses, limits=())
        return replace(self, wanted=alone)

    def look(
        self,
        c: Constellation,
        inclinations: NDArray[np.float64],
        nodes: NDArray[np.float64],
        share: NDArray[np.float64],
        worst: NDArray[np.float64],
    ) -> None:
        """Lower shares and raise worst values (over their limit) of a pattern, in place.

        Parameters
        ----------
        c
            Equal circular orbits; of the pattern its nodes and phases count.
        inclinations, nodes
            Of candidates; nodes are added to those of the pattern; shape (k,).
        share, worst
            Of the candidates so far, shape (k,): those of share 0 are not looked at.
        """
        mask = self.users.mask
        azimuths, elevations = np.array(mask.azimuth), np.array(mask.elevation)
        if mask.is_constant:
            azimuths, elevations = azimuths[:1], elevations[:1]
        pattern = Circles(c.raan, c.mean_anomaly, float(c.semi_major_axis[0]))
        always = self.wanted.share == 1.0
        claim = Claim(azimuths, elevations, self.fold, self._limits(), always)
        sample_pattern(pattern, inclinations, nodes, self.rows, claim, share, worst)

    def _limits(self) -> NDArray[np.float64]:
        """Largest dilutions allowed; of errors what they must stay below if every range is best."""
        limits = np.full(len(DOPS), np.inf)
        for name, limit in self.wanted.limits:
            k = DOPS.index(ERROR_DOPS.get(name, name))
            if name in ERROR_DOPS:
                limit = sigma_allowed(self.wanted, limit) / self.least_range
            limits[k] = min(limits[k], limit)
        return limits


def moments_of(
    c: Constellation, users: Users, wanted: Requirement, ranges: Ranges | None = None
) -> Moments:
    """Random moments of users under orbits of that radius, epoch and repeat, always the same."""
    times, latitude, longitude = _moments(c, users, np.random.default_rng(0))
    axes = east_north_up(latitude, longitude)
    phase = times * c.mean_motion[0]
    rows = np.column_stack(
        [
            stand(users, latitude, axes[:, 2]),
            axes.reshape(len(times), 9),
            np.cos(phase),
            np.sin(phase),
        ]
    )
    least = 0.0
    if ranges is not None:
        nearest = float(c.semi_major_axis[0]) / users.figure.equatorial_radius - 1.0
        least = np.sqrt(
            ranges.least(max(nearest - users.height / users.figure.equatorial_radius, 0.0))
        )
    return Moments(np.ascontiguousarray(rows), users, wanted, float(least))


def is_hopeless(share: NDArray[np.float64], wanted: float) -> NDArray[np.bool_]:
    """Whether shares of samples are so far below the share wanted that chance does not explain it.

    Of what is wanted always, a sample that misses is a miss.
    """
    if wanted == 1.0:
        return share < 1.0
    sigma = np.sqrt(max(wanted * (1.0 - wanted), 1.0 / SAMPLES) / SAMPLES)
    return share < wanted - 4.0 * sigma


def _moments(
    c: Constellation, users: Users, rng: np.random.Generator
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Seconds after the epoch, and where users then stand: geodetic latitude, inertial longitude.

    Who stands on Mars under closed tracks keeps to his longitude, or his region's; all others take
    any.
    """
    low, high = np.sin([users.south, users.north])
    latitude = np.arcsin(rng.uniform(low, high, SAMPLES))
    times = rng.uniform(0, 1e7, SAMPLES)
    longitude = rng.uniform(0, 2 * np.pi, SAMPLES)
    if c.repeat is None or users.is_belt:
        return times, latitude, longitude
    if users.longitude is not None:
        longitude = np.full(SAMPLES, users.longitude)
    else:
        centric, longitude = latitude_longitude(points_in(users.region, rng, SAMPLES))
        latitude = planetographic_latitude(centric, users.figure)
    turned = prime_meridian_angle(c.epoch, 0.0) + MARS_ROTATION_RATE.value * times
    return times, latitude, longitude + turned
