"""Which measurement is due, above the mask, at each epoch: the only place that decides."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.entry.kinds import RANGE, RATE
from compass.entry.beacons import Beacons
from compass.entry.instruments import Features, Instrument, in_sight
from compass.entry.link import Link
from compass.entry.model import EntryModel
from compass.entry.views import cartesian_of
from compass.errors import ArgumentError

#: Of a lander that knows nothing by sight.
NO_FEATURES = Features()


def in_view(beacons: Beacons, states: ArrayLike, planet_radius: float) -> NDArray[np.bool_]:
    """Whether the lander is in view of each beacon, shape (t, n).

    Line of sight past the sphere (eqs. 58 to 60 of Yu et al. 2018):
    ``theta < acos(R/|r|) + acos(R/|r_B|)``, theta the central angle; for a beacon on the surface
    that is eq. 52, the lander above its horizon. A mask asks for more: of a beacon at rest that
    the lander stands so high over its horizontal, of an orbiting one that it stands so high over
    the lander's limb, ``sin(elevation) >= sin(mask - dip)``, ``cos(dip) = R/r``, as in judging.

    Parameters
    ----------
    beacons
        Beacons at the times of `states`, with their masks.
    states
        Entry states, shape (t, >= 6).
    planet_radius
        R, metres.
    """
    lander = cartesian_of(states)[:, None, :3]
    far_lander = np.linalg.norm(lander, axis=2)
    far_beacon = np.linalg.norm(beacons.r, axis=2)
    cosine = (lander * beacons.r).sum(axis=2) / (far_lander * far_beacon)
    dip = np.arccos(np.minimum(1.0, planet_radius / far_lander))
    limit = dip + np.arccos(np.minimum(1.0, planet_radius / far_beacon))
    seen = np.arccos(np.clip(cosine, -1.0, 1.0)) < limit
    line = lander - beacons.r
    length = np.linalg.norm(line, axis=2)
    length[length == 0] = 1.0
    at_beacon = (line * beacons.r).sum(axis=2) / (far_beacon * length)
    at_lander = -(line * lander).sum(axis=2) / (far_lander * length)
    masked = np.isfinite(beacons.masks)
    mask = np.where(masked, beacons.masks, 0.0)
    high = np.where(beacons.moving, at_lander >= np.sin(mask - dip), at_beacon >= np.sin(mask))
    return np.asarray(seen & (high | ~masked))


@dataclass(frozen=True)
class Measurements:
    """What is measured, how well and when.

    Attributes
    ----------
    range_sigma
        One sigma of the range noise, m, or 0 for that of the link alone; None if ranges are not
        measured.
    rate_sigma
        One sigma of the range-rate noise, m/s; None if rates are not measured.
    interval
        Seconds between measurements, a multiple of the time step.
    start, stop
        Seconds between which measurements are taken; the first at the first epoch from `start` on.
    in_turn
        Whether the lander hears one beacon at a time, in turn, rather than all at once.
    instruments
        What it measures beside ranges and range rates.
    features
        What it knows by sight, for an instrument of that kind.
    link
        What adds to the noise of the ranges, and decides what is heard at all.
    """

    range_sigma: float | None = 50.0
    rate_sigma: float | None = None
    interval: float = 1.0
    start: float = 0.0
    stop: float = float("inf")
    in_turn: bool = False
    instruments: tuple[Instrument, ...] = ()
    features: Features = NO_FEATURES
    link: Link | None = None

    def __post_init__(self) -> None:
        for name, unit in (("range_sigma", "m"), ("rate_sigma", "m/s")):
            sigma = getattr(self, name)
            if sigma == 0 and name == "range_sigma" and self.link is not None:
                continue
            if sigma is not None and not 0 < sigma < float("inf"):
                raise ArgumentError(f"{name} = {sigma} {unit}: must be positive")
        radio = any(instrument.of_beacons for instrument in self.instruments)
        if self.range_sigma is None and self.rate_sigma is None and not radio:
            raise ArgumentError("measurements: give range_sigma, rate_sigma or both")
        if not self.interval > 0:
            raise ArgumentError(f"interval = {self.interval} s: must be positive")

    @property
    def measures(self) -> tuple[bool, bool]:
        """Whether ranges and range rates to beacons are measured, one way or both ways."""
        kinds = [one.kind for one in self.instruments]
        return (
            self.range_sigma is not None or "two_way_range" in kinds,
            self.rate_sigma is not None or "two_way_rate" in kinds,
        )

    @property
    def radio(self) -> tuple[Instrument, ...]:
        """Instruments that beacons answer to."""
        return tuple(one for one in self.instruments if one.of_beacons)

    @property
    def own(self) -> tuple[Instrument, ...]:
        """Instruments that need no beacon."""
        return tuple(one for one in self.instruments if not one.of_beacons)

    @property
    def plain(self) -> bool:
        """Whether there is nothing but one-way radio of one noise."""
        return not self.instruments and self.link is None

    def readings(self, variances: NDArray[np.float64]) -> tuple[tuple[str, int], ...]:
        """Title of every instrument beside one-way radio, and how many numbers it reads.

        `variances` are those of `heard`.
        """
        counts, ordered = np.isfinite(variances).sum(axis=(0, 1)), (*self.radio, *self.own)
        firsts = 2 + np.cumsum([0, *(len(one.numbers) for one in ordered)])
        return tuple(
            (one.title, int(counts[first : first + len(one.numbers)].sum()))
            for one, first in zip(ordered, firsts, strict=False)
        )

    def sigmas(self, count: int) -> NDArray[np.float64]:
        """One sigma of ranges (m) and range rates (m/s) of so many beacons, (n, 2); nan if none."""
        pair = (self.range_sigma, self.rate_sigma)
        return np.tile([np.nan if sigma is None else sigma for sigma in pair], (count, 1))

    def heard(
        self,
        beacons: Beacons,
        taken: ArrayLike,
        path: NDArray[np.float64],
        model: EntryModel,
        sigmas: NDArray[np.float64] | None = None,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
        """Sources, variances and kinds of everything that is measured along a flight.

        Parameters
        ----------
        beacons, taken
            At the epochs of `path`, and which are measured, (t, n).
        path
            The flight, (t, 6).
        model
            The world in which it is flown.
        sigmas
            Of one-way ranges and range rates, (n, 2), where they differ from beacon to beacon.

        Returns
        -------
        sources
            Positions and velocities (t, n + k, 6): beacons, features, and at the end the centre
            of Mars, to which what the lander reads of itself belongs.
        variances
            Of every kind's reading of every source, (t, n + k, c); nan where there is none.
        kinds
            Numbers of `compass.core.entry.measure`, (c,): ranges, range rates, radio both ways,
            then the instruments that need no beacon.
        """
        chosen, planet_radius = np.asarray(taken, dtype=bool), model.planet_radius
        loop = np.zeros(chosen.shape)
        if self.link is not None:
            loop = self.link.range_variance(beacons, path, model.atmosphere, planet_radius)
            chosen = chosen & np.isfinite(loop)
        each = self.sigmas(beacons.size) if sigmas is None else sigmas
        own = np.where(chosen[..., None], np.square(each), np.nan)
        own[..., 0] += np.where(chosen, loop, np.nan)
        if not self.instruments:
            return beacons.states, own, np.array([RANGE, RATE])
        epochs, n, k = len(path), beacons.size, len(self.features.names)
        sources = np.zeros((epochs, n + k + 1, 6))
        sources[:, :n] = beacons.states
        sources[:, n : n + k, :3] = self.features.places(planet_radius)
        both = [number for one in self.radio for number in one.numbers]
        read, numbers = self.own_readings(beacons.times, path, sources[0, n:-1, :3], planet_radius)
        variances = np.full((epochs, n + k + 1, 2 + len(both) + numbers.size), np.nan)
        variances[:, :n, :2] = own
        for at, one in enumerate(self.radio, start=2):
            noise = one.sigma**2 + (loop if one.kind == "two_way_range" else 0.0)
            variances[:, :n, at] = np.where(chosen, noise, np.nan)
        variances[:, n:, 2 + len(both) :] = read
        return sources, variances, np.array([RANGE, RATE, *both, *numbers])

    def own_readings(
        self,
        times: NDArray[np.float64],
        path: NDArray[np.float64],
        at: NDArray[np.float64],
        planet_radius: float,
    ) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Variances and kinds of what needs no beacon, along flights (..., t, 6).

        Of features at `at` (..., k, 3) and, last, of the lander itself: (..., t, k + 1, c), nan
        where there is no reading.
        """
        kinds = [number for one in self.own for number in one.numbers]
        shape = (*path.shape[:-1], at.shape[-2] + 1, len(kinds))
        variances, first = np.full(shape, np.nan), 0
        for one in self.own:
            mine = variances[..., first : first + len(one.numbers)]
            first += len(one.numbers)
            square = one.variances(path, planet_radius)
            square = np.where(every(times, one.interval), square, np.nan)
            if one.kind == "features":
                seen = in_sight(at, path)
                mine[..., :-1, :] = np.where(seen, square[..., None], np.nan)[..., None]
            else:
                mine[..., -1, :] = square[..., None]
        return variances, np.array(kinds, dtype=np.int64)

    def radio_variances(self) -> NDArray[np.float64]:
        """Variances of ranges and rates one way, then there and back, (4,); nan for none."""
        sigmas = {one.kind: one.sigma for one in self.radio}
        both = (sigmas.get("two_way_range"), sigmas.get("two_way_rate"))
        each = (self.range_sigma, self.rate_sigma, *both)
        return np.array([np.nan if sigma is None else sigma**2 for sigma in each])

    def reaching(
        self,
        seen: NDArray[np.bool_],
        beacons: Beacons,
        path: NDArray[np.float64],
        model: EntryModel,
    ) -> NDArray[np.bool_]:
        """Of the beacons in view, (t, n), those whose signal is as strong as the link needs."""
        if self.link is None:
            return seen
        loop = self.link.range_variance(beacons, path, model.atmosphere, model.planet_radius)
        return seen & np.isfinite(loop)

    def taken(self, seen: NDArray[np.bool_], times: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Which beacons in view are measured, shape (t, n), given `seen` of that shape.

        In turn, the k-th measurement time goes to the next beacon in view after the last heard.
        """
        due = (times >= self.start - 1e-9) & (times <= self.stop + 1e-9)
        since = times - times[due].min() if due.any() else times
        due &= every(since, self.interval)
        taken = seen & due[:, None]
        if self.in_turn and seen.shape[1]:
            heard = -1
            for row in taken:  # a few hundred rows; each depends on the one before
                order = (heard + 1 + np.arange(row.size)) % row.size
                ready = order[row[order]]
                row[:] = False
                if ready.size:
                    heard = int(ready[0])
                    row[heard] = True
        return taken


def every(times: NDArray[np.float64], interval: float) -> NDArray[np.bool_]:
    """Which of some times are a whole number of intervals, shape (t,)."""
    off = np.abs(np.mod(times / interval + 0.5, 1.0) - 0.5) * interval
    return np.asarray(off < 1e-6)


def check_apart(beacons: Beacons, states: ArrayLike) -> None:
    """Refuse beacons at the lander's place, where the direction is undefined.

    Raises
    ------
    ArgumentError
        A beacon within a metre of the trajectory.
    """
    distance = np.linalg.norm(cartesian_of(states)[:, None, :3] - beacons.r, axis=2)
    if distance.size and distance.min() < 1.0:
        t, k = np.unravel_index(int(distance.argmin()), distance.shape)
        raise ArgumentError(
            f"beacon {beacons.names[k]}: at the lander's own place at {beacons.times[t]:g} s "
            f"({distance[t, k]:.3g} m apart); its direction is undefined, move it"
        )
