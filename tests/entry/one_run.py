"""One run of a filter over given measurements: what the Monte Carlo does many times."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.entry.filter import filter_run
from compass.core.entry.kinds import RANGE, RATE
from compass.core.entry.measure import PLACES, ideal_values
from compass.entry.beacons import Beacons
from compass.entry.covariance import longest_step, problem_of
from compass.entry.filters import METHODS, Filter
from compass.entry.model import EntryModel
from compass.entry.schedule import Measurements
from compass.entry.trajectory import fly
from compass.entry.views import spherical_of


def ideal_measurements(path: ArrayLike, beacons: Beacons) -> NDArray[np.float64]:
    """Ranges (m) and range rates (m/s) without noise, (t, n, 2), from states (t, 6)."""
    out = np.empty((*beacons.r.shape[:2], 2))
    flown = np.ascontiguousarray(path, dtype=float)
    world, bank = np.empty(0), np.zeros((1, 2))  # radio asks for neither
    times, places = np.array(beacons.times, dtype=float), np.full(PLACES, -1)
    ideal_values(flown, beacons.states, np.array([RANGE, RATE]), places, world, bank, times, out)
    return out


def run_filter(
    model: EntryModel,
    estimate: ArrayLike,
    beacons: Beacons,
    taken: ArrayLike,
    measurements: Measurements,
    settings: Filter,
    z: ArrayLike,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """States (t, s) and covariances (t, s, s) after each epoch's measurements.

    Parameters
    ----------
    model
        The world as the filter knows it.
    estimate
        First estimate of position and velocity, (6,), Mars-fixed; further blocks begin at 0.
    beacons, taken, measurements
        What is measured, `taken` of shape (t, n).
    settings
        The filter.
    z
        Ranges and range rates, (t, n, 2); entries not taken are not looked at. Of further kinds
        as `compass.entry.schedule.Measurements.heard` orders sources and kinds.
    """
    count, layout = beacons.times.size, settings.layout(beacons.size)
    first = np.zeros(layout.size)
    first[:6] = np.asarray(estimate, dtype=float)
    expected = _expected(model, first[:6], beacons, settings, measurements)
    heard = measurements.heard(beacons, taken, expected, model)
    states, covariances = (
        np.empty((count, layout.size)),
        np.empty((count, layout.size, layout.size)),
    )
    filter_run(
        first,
        layout.covariance(settings.covariance0),
        problem_of(
            model,
            layout,
            expected,
            beacons.times,
            heard,
            settings.noise,
            longest_step(measurements),
        ),
        np.where(np.isnan(heard[1]), np.nan, np.asarray(z, dtype=float)),
        settings.iterations,
        METHODS[settings.method],
        states,
        covariances,
    )
    return states, covariances


def _expected(
    model: EntryModel,
    first: NDArray[np.float64],
    beacons: Beacons,
    settings: Filter,
    measurements: Measurements,
) -> NDArray[np.float64]:
    """Flight from the first estimate, along which noise, density and instruments are taken."""
    wanders = any(part.scales for part in settings.parts)
    if not (np.any(settings.noise) or wanders or measurements.instruments or measurements.link):
        return np.tile(first, (beacons.times.size, 1))
    path = fly(model, spherical_of(first), beacons.times).path
    return path[np.minimum(np.arange(beacons.times.size), len(path) - 1)]
