"""Entries that differ from the planned one: where they come down, guided or not."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.entry.guide import Until
from compass.core.entry.guided import Carried, Flown, dispersed_flights
from compass.cores import in_blocks
from compass.entry.accuracy import Ellipse, error_ellipse
from compass.entry.carried import CarriedFilter, nothing_carried
from compass.entry.consistency import FALSE_ALARM, nees_bounds
from compass.entry.guidance import GROUND, Dispersion, Guidance
from compass.entry.model import EntryModel
from compass.entry.start import Trigger
from compass.entry.trajectory import watched_level
from compass.entry.views import cartesian_of, local_axes
from compass.errors import ArgumentError
from compass.frames import direction
from compass.quantities.draws import quantile_bounds
from compass.quantities.percentile import percentile

Array = NDArray[np.float64]

#: Entries handed to a thread at once; the numbers do not depend on it.
BLOCK = 16

#: Targets that a bank at its limits misses by more, m, are beyond it. (Towards the end any error
#: that is still found asks for all that is left.)
FAR = 500.0


@dataclass(frozen=True)
class Dispersed:
    """Where dispersed entries come to deployment.

    Attributes
    ----------
    event
        What ends them, in a word.
    times, ends
        When, s, (m,), nan where it does not come, and the state there, (m, 6), Mars-fixed.
    centre
        Unit vector to the target, or to where the planned entry comes, (3,).
    guided
        Whether they are guided to it.
    errors, nees
        Of what guidance knew of position and velocity when it last heard anything, (m, 6), and
        normalised, (m,); None where it knows the state as it is.
    beyond
        How far past the target guidance foresaw at its last decision on distance that the bank
        would bring it at best, m, (m,); short is negative, 0 where it was in reach. None unguided.
    """

    event: str
    times: Array
    ends: Array
    centre: Array
    guided: bool
    errors: Array | None = None
    nees: Array | None = None
    beyond: Array | None = None

    @property
    def reached(self) -> NDArray[np.bool_]:
        """Which come to the event, (m,)."""
        return np.isfinite(self.times)

    @property
    def offsets(self) -> Array:
        """East and north of the centre over the ground, m, of those that come there, (k, 2)."""
        at = self.ends[self.reached, :3]
        radius = np.linalg.norm(at, axis=1)
        line = at / radius[:, None]
        east, north, up = (line @ local_axes(self.centre).T).T
        flat = np.hypot(east, north)
        size = np.where(flat > 0, np.arctan2(flat, up) / np.where(flat > 0, flat, 1.0), 1.0)
        return np.asarray((radius * size)[:, None] * np.stack([east, north], axis=1))

    @property
    def ellipse(self) -> Ellipse:
        """That holds 95 % of them if they are normal."""
        flat = self.offsets
        return error_ellipse(flat.mean(axis=0), np.cov(flat.T))

    @property
    def knowledge(self) -> float:
        """Root mean square error of the position that guidance knew at last, m; nan for none."""
        if self.errors is None or not self.reached.any():
            return np.nan
        return float(np.sqrt((self.errors[self.reached, :3] ** 2).sum(axis=1).mean()))

    @property
    def claims_hold(self) -> bool:
        """Whether the errors of what guidance knew are what its filter claimed."""
        if self.nees is None or not self.reached.any():
            return True
        low, high = nees_bounds(6, int(self.reached.sum()), 1.0 - FALSE_ALARM)
        return bool(low <= self.nees[self.reached].mean() <= high)

    def within(self, percent: float) -> float:
        """Distance from the centre within which that many of all entries come, m.

        Infinite where fewer come to the event at all.
        """
        return float(percentile(self._misses, percent))

    def within_bounds(self, percent: float) -> tuple[float, float]:
        """Bounds of that distance that so few entries leave, m: `quantile_bounds`."""
        low, high = quantile_bounds(self._misses, percent)
        return max(low, 0.0), high

    @property
    def _misses(self) -> Array:
        """Distance of every entry from the centre, m, infinite where it does not come."""
        misses = np.full(self.times.size, np.inf)
        misses[self.reached] = np.hypot(*self.offsets.T)
        return misses


def beyond_words(beyond: Array | None) -> str:
    """How many targets lie where no bank within its limits comes; nothing without guidance."""
    if beyond is None:
        return ""
    parts = [
        f"{(way > FAR).sum()} {word}, by up to {way.max() / 1e3:.3g} km"
        for way, word in ((-beyond, "come short"), (beyond, "come too far"))
        if (way > FAR).any()
    ]
    if not parts:
        return " The bank's limits keep none of them from the target."
    return (
        f" The bank's limits keep {(np.abs(beyond) > FAR).sum()} of them from the target: "
        f"{', and '.join(parts)}, as guidance foresees."
    )


def fly_dispersed(
    truth: EntryModel,
    known: EntryModel,
    state: ArrayLike,
    dispersion: Dispersion,
    seconds: float,
    *,
    trigger: Trigger | None = None,
    guidance: Guidance | None = None,
    carried: CarriedFilter | None = None,
    seed: int = 0,
    threads: int | None = None,
) -> Dispersed:
    """Fly entries drawn about the planned one to an event.

    Parameters
    ----------
    truth, known
        The world as it is but for what is drawn, and as the guidance knows it.
    state
        ``[r, lon, lat, V, gamma, psi]`` of the planned entry.
    dispersion
        What is drawn.
    seconds
        When they end at the latest.
    trigger
        The event; the ground if left out.
    guidance
        To a target; without, all fly the bank of the vehicle.
    carried
        The filter by which guidance knows its state, and deployment; the true one if left out.
    seed
        Of the draws.
    threads
        Threads; one a processor if left out.

    Raises
    ------
    ArgumentError
        The planned entry without guidance does not come to the event.
    """
    planned, drawn = cartesian_of(np.asarray(state, dtype=float)[:6]), dispersion.draws(seed)
    if guidance is None:  # where the planned one comes to, they are measured from
        drawn = np.vstack([np.zeros(8), drawn])
    starts, worlds, count = planned + drawn[:, :6], drawn[:, 6:], len(drawn)
    filtered = nothing_carried(count)
    if carried is not None:
        filtered = carried.numbers(starts, seed)
    numbers = np.empty((count, 0))
    if guidance is not None:
        numbers = np.tile(guidance.numbers(), (count, 1))
    flown = flown_to(
        truth, known, starts, worlds, numbers, trigger, seconds, filtered, threads=threads
    )  # fmt: skip
    times, ends, told = flown.times, flown.ends, flown.told
    event = (trigger or GROUND).name
    if guidance is not None:
        return Dispersed(
            event,
            times,
            ends,
            np.asarray(direction(guidance.latitude, guidance.longitude)),
            True,
            errors=None if carried is None else told[:, :6],
            nees=None if carried is None else told[:, 6],
            beyond=told[:, 7] * truth.planet_radius,
        )
    if np.isnan(times[0]):
        raise ArgumentError(
            f"dispersion: the planned entry does not come to {event} by "
            f"{seconds:g} s; give a longer entry.duration_s or another trigger"
        )
    centre = ends[0, :3] / np.linalg.norm(ends[0, :3])
    return Dispersed(event, times[1:], ends[1:], centre, False)


def flown_to(
    truth: EntryModel,
    known: EntryModel,
    starts: Array,
    worlds: Array,
    guided: Array,
    trigger: Trigger | None,
    seconds: float,
    carried: Carried,
    *,
    rows: int = 0,
    threads: int | None = None,
) -> Flown:
    """Fly entries to a trigger, or to the ground, in so many seconds.

    As `compass.core.entry.guided.dispersed_flights` takes them, each `guided` by numbers of its
    own, (m, k), or none, (m, 0); of its bank so many `rows` are kept.
    """
    watch, level = watched_level(truth, trigger or GROUND)
    until = Until(float(seconds), carried.problem.longest, watch, level, truth.planet_radius)
    p, q = truth.flight_parameters(), known.flight_parameters()
    count, bank = len(starts), truth.vehicle.bank_schedule()
    flown = Flown(
        np.empty(count), np.empty((count, 6)), np.empty((count, rows, 2)),
        np.zeros(count, dtype=np.int64), np.zeros((count, 8)),
    )  # fmt: skip
    begins, offsets = np.ascontiguousarray(starts), np.ascontiguousarray(worlds)

    def work(part: slice) -> None:
        own = carried._replace(firsts=carried.firsts[part], draws=carried.draws[part])
        out: list[Any] = [values[part] for values in flown]
        dispersed_flights(
            begins[part], offsets[part], p, q, guided[part], bank, until, own, Flown(*out)
        )

    in_blocks(work, count, BLOCK, threads)
    return flown
