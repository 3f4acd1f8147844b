"""Ranges as certified figures weigh them: fixes by weighted least squares, errors in metres."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from compass.core import error
from compass.core.certified import weights
from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import mcmf_from_mci, prime_meridian_angle
from compass.orbits import Constellation
from compass.orbits.motion import Motion
from compass.ranging import FACTOR_95
from compass.requirement import Requirement
from compass.signal.budget import mean_age_covariance
from compass.signal.ranges import radial_along_cross, shared_numbers
from compass.sites import Site

#: Errors of a fix and the dilutions whose parts of the covariance they are, in the order of
#: `compass.coverage.errors.ERRORS`.
ERROR_DOPS = {
    "error_horizontal_m": "hdop",
    "error_vertical_m": "vdop",
    "error_position_m": "pdop",
    "error_time_m": "tdop",
}


@dataclass(frozen=True, eq=False)
class Ranges:
    """The errors of ranges, without regard to where the Sun stands.

    Attributes
    ----------
    covariance
        Of radial, along, cross and clock of each satellite, m^2, shape (n, 4, 4).
    numbers
        That all ranges share, m and m^2: n, z, a, b (distances in equatorial radii), square of the
        ionosphere's delay straight up, square of the equatorial radius over the shell's.
    radius
        Equatorial radius, m.
    shared, shared_time
        Variances that all satellites share, of a horizontal coordinate and of time, m^2.
    """

    covariance: NDArray[np.float64]
    numbers: tuple[float, ...]
    radius: float
    shared: float = 0.0
    shared_time: float = 0.0

    @property
    def keeps_symmetry(self) -> bool:
        """Whether satellites are alike, and their errors the same seen in a mirror or backwards.

        A mirror turns the cross-track direction round, time that runs backwards along and cross:
        what ties these to anything else changes its sign.
        """
        tied = self.covariance * (1.0 - np.eye(4))
        tied[:, 0, 3] = tied[:, 3, 0] = 0.0
        return not tied.any() and bool(np.all(self.covariance == self.covariance[:1]))

    @property
    def is_isotropic(self) -> bool:
        """Whether the errors of places are the same in all directions, and tied to no clock's."""
        radial = self.covariance[:, :1, :1] * np.eye(3)
        alone = not self.covariance[:, :3, 3].any()
        return alone and bool(np.all(self.covariance[:, :3, :3] == radial))

    def alike_all_around(self, lean: float) -> tuple["Ranges", "Ranges"]:
        """Ranges whose errors have no direction, none of them less than these, and none more.

        Who is seen at an angle of a sine up to `lean` from the way down has ranges along
        ``x = (c, s t)``: c in ``[sqrt(1 - lean^2), 1]``, s in ``[0, lean]``, t any unit vector
        along and across the track. The variance, ``(x, 1)' P (x, 1)``, is between sums of the
        bounds of its terms; those in c alone are linear in c or c^2, and extreme at the ends.
        """
        least, most = np.zeros_like(self.covariance), np.zeros_like(self.covariance)
        ends = np.array([np.sqrt(max(0.0, 1.0 - lean * lean)), 1.0])
        for k, p in enumerate(self.covariance):
            down = np.sort(2.0 * p[0, 3] * ends)
            across = np.linalg.eigvalsh(p[1:3, 1:3])
            tied = 2.0 * lean * (np.linalg.norm(p[0, 1:3]) + np.linalg.norm(p[1:3, 3]))
            low = (p[0, 0] * ends**2 + across[0] * (1.0 - ends**2)).min() + down[0] - tied
            high = (p[0, 0] * ends**2 + across[1] * (1.0 - ends**2)).max() + down[1] + tied
            least[k, 3, 3], most[k, 3, 3] = max(0.0, low + p[3, 3]), high + p[3, 3]
        return replace(self, covariance=most), replace(self, covariance=least)

    def without(self, lost: Sequence[int]) -> "Ranges":
        """Return the ranges that are left without satellites of these indices."""
        return replace(self, covariance=np.delete(self.covariance, list(lost), axis=0))

    def shared_in(self, name: str) -> float:
        """Variance that all satellites share of one of `ERROR_DOPS`, m^2."""
        return {
            "error_horizontal_m": 2.0 * self.shared,
            "error_position_m": 2.0 * self.shared,
            "error_time_m": self.shared_time,
        }.get(name, 0.0)

    def least(self, nearest: float) -> float:
        """Variance below which no range is, m^2; `nearest` the least distance, equatorial radii.

        Raises
        ------
        ArgumentError
            None is known that is above 0: a range without an error would weigh infinitely much.
        """
        noise, zenith, a, b, delay2, _ = self.numbers
        heard = (noise + zenith) ** 2 + a * nearest**2 + b * nearest**4 + delay2
        floor = min(_least(p) for p in self.covariance) + heard
        if not floor > 0.0:
            raise ArgumentError(
                "signal: ranges may be without any error, and weigh infinitely much; give clock_m, "
                "all of ephemeris_m, or a receiver's noise_m"
            )
        return floor

    def columns(self, orbits: NDArray[np.float64], scale: float) -> NDArray[np.float64]:
        """What kernels take of each satellite, variances over `scale`.

        The axes turn with the true anomaly, at ``(1 + e)^2/(1 - e^2)^1.5`` of the mean motion at
        most, which changes by ``2 e (1 + e)^3/(1 - e^2)^3``, with periapsis, and with the node.
        """
        e, node, periapsis, mean = orbits[:, 1], np.abs(orbits[:, 7]), orbits[:, 8], orbits[:, 9]
        spin = mean * (1 + e) ** 2 / (1 - e * e) ** 1.5 + np.abs(periapsis)
        change = 2 * mean**2 * e * (1 + e) ** 3 / (1 - e * e) ** 3
        turn = spin + node
        columns, p = np.zeros((len(orbits), weights.RANGE)), self.covariance / scale
        for k, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))):
            columns[:, weights.QUAD + k] = p[:, i, j]
        columns[:, weights.LINE : weights.REST] = p[:, :3, 3]
        columns[:, weights.REST] = p[:, 3, 3]
        columns[:, weights.SIZE] = np.linalg.norm(p[:, :3, :3], axis=(1, 2))
        columns[:, weights.TURN] = turn * (1 + 1e-12)
        columns[:, weights.TURN2] = (change + spin * node + turn**2) * (1 + 1e-12)
        return columns

    def shared_row(self, scale: float) -> NDArray[np.float64]:
        """What kernels take of all ranges, variances over `scale`."""
        noise, zenith, a, b, delay2, shell2 = self.numbers
        root = np.sqrt(scale)
        return np.array([noise / root, zenith / root, a / scale, b / scale, delay2 / scale, shell2])

    def sigmas(
        self, c: Constellation, site: Site, time: float, motion: Motion
    ) -> NDArray[np.float64]:
        """One sigma of the range to every satellite in view of a site at a moment, m."""
        r_mci, v_mci = (x[:, 0] for x in motion.states(c, [time]))
        angle = prime_meridian_angle(c.epoch, time)
        r = mcmf_from_mci(r_mci, angle)
        seen = site.sees(r)
        axes = np.stack(
            [
                mcmf_from_mci(axis, angle)
                for axis in np.moveaxis(radial_along_cross(r_mci, v_mci), -2, 0)
            ],
            axis=-2,
        )[seen]
        sight = r[seen] - site.r_mcmf
        far = np.linalg.norm(sight, axis=1)
        unit = sight / far[:, np.newaxis]
        to = np.append((axes @ unit[:, :, np.newaxis])[..., 0], np.ones((len(unit), 1)), axis=1)
        orbit = np.einsum("ni,nij,nj->n", to, self.covariance[seen], to)
        noise, zenith, a, b, delay2, shell2 = self.numbers
        sine = unit @ site.enu_mcmf[2]
        d2 = (far / self.radius) ** 2
        through = delay2 / (1.0 - shell2 * (1.0 - sine**2))
        heard = (noise + zenith / sine) ** 2 + a * d2 + b * d2**2
        return np.asarray(np.sqrt(orbit + heard + through))


def ranges_of(design: Design, sun: Literal["overhead", "set"] = "overhead") -> Ranges:
    """Ranges of a design with a signal, the Sun overhead for all users or set for all.

    The ionosphere delays no user more, and none less.

    Raises
    ------
    ArgumentError
        No signal, or as `compass.signal.ranges.range_errors`.
    """
    if design.signal is None:
        raise ArgumentError(
            "signal: missing; errors in metres follow from the errors of ranges: add a [signal]"
        )
    numbers = shared_numbers(design)
    if sun == "set":
        numbers[error.DELAY2] = 0.0
    places = (error.NOISE, error.ZENITH, error.LOOP, error.LOOP2, error.DELAY2, error.SHELL2)
    return Ranges(
        mean_age_covariance(design.signal, design.constellation.size),
        tuple(float(numbers[k]) for k in places),
        design.figure.equatorial_radius,
        float(numbers[error.SHARED]),
        float(numbers[error.SHARED_TIME]),
    )


def skies_of(design: Design, span: tuple[float, float] | None, height: float) -> tuple[Ranges, ...]:
    """Ranges whose fixes are no better than a design's, and those whose are no worse.

    With the Sun overhead of all users, and set for all. Along integrated or given paths errors
    that have a direction stand between two that have none. One where both are the same.

    Parameters
    ----------
    design
        Has a signal.
    span
        Seconds after the epoch; along paths there must be one.
    height
        Of the highest users, m.

    Raises
    ------
    ArgumentError
        As `ranges_of` and `compass.orbits.motion.Motion.trajectory`.
    """
    worst = ranges_of(design)
    best = ranges_of(design, "set") if _delays(design) else worst
    if not (design.motion.is_closed_form or worst.is_isotropic):
        assert span is not None
        path = design.motion.trajectory(design.constellation, *span)
        lean = (design.figure.equatorial_radius + height) / float(path.bounds(*span)[:, 0].min())
        worst, _ = worst.alike_all_around(min(lean, 1.0))
        _, best = best.alike_all_around(min(lean, 1.0))
    return (worst,) if worst is best else (worst, best)


def ranges_wanted(
    design: Design, requirement: Requirement, sun: Literal["overhead", "set"] = "overhead"
) -> Ranges | None:
    """Ranges of a design if a requirement wants errors, as `ranges_of`; else None."""
    wanted = any(name in ERROR_DOPS for name, _ in requirement.limits)
    return ranges_of(design, sun) if wanted else None


def sigma_allowed(requirement: Requirement, limit: float) -> float:
    """Largest sigma that a limit on an error allows, m."""
    return limit if requirement.error_as == "one-sigma" else limit / FACTOR_95


def _delays(design: Design) -> bool:
    """Whether the ionosphere adds to ranges, so that it matters where the Sun stands."""
    return bool(shared_numbers(design)[error.DELAY2] > 0.0)


def _least(p: NDArray[np.float64]) -> float:
    """Bound from below of ``(x, 1)' P (x, 1)`` over unit vectors x."""
    place, tie, clock = p[:3, :3], p[:3, 3], float(p[3, 3])
    least = [0.0, 2.0 * float(np.linalg.eigvalsh(p)[0])]
    if not tie.any():
        least.append(float(np.linalg.eigvalsh(place)[0]) + clock)
    elif clock > 0.0:
        least.append(float(np.linalg.eigvalsh(place - np.outer(tie, tie) / clock)[0]))
    return max(least)
