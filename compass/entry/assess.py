"""One scenario from end to end: flight, view, observability, bound and filter."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from compass.entry.accuracy import Accuracy, accuracy
from compass.entry.beacons import Beacons
from compass.entry.budget import Share, landing_budget, with_satellites
from compass.entry.consistency import Consistency, consistency
from compass.entry.covariance import Bound, linear_covariance
from compass.entry.filters import Filter
from compass.entry.layout import Layout
from compass.entry.model import EntryModel
from compass.entry.navigation import MonteCarlo, run_monte_carlo
from compass.entry.observability import BlindSpots, Observability, blind_spots, observability
from compass.entry.schedule import Measurements, check_apart, in_view
from compass.entry.start import Trigger
from compass.entry.trajectory import Trajectory, trajectory_dataset

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Assessment:
    """How well a lander can navigate, and does.

    Attributes
    ----------
    flight
        The true trajectory.
    beacons
        At its times.
    seen, taken
        Which are in view, and which are measured, shape (t, n).
    observability
        Of beacons in view and strong enough at every epoch.
    blind
        What cannot be seen at the epoch of lowest rank (of these the first; of full rank, the one
        of lowest degree).
    blind_epoch
        Index of that epoch.
    bound
        Linear covariance with the filter's prior and process noise: the Cramer-Rao bound.
    monte_carlo
        The filter, many times.
    consistency
        Whether its errors in position and velocity are what it claims.
    whole
        The same of all states that it estimates.
    accuracy
        Knowledge and delivery at deployment; without one, on the ground if that is reached.
    ground
        The same on the ground, of a flight that goes on past deployment to it.
    readings
        Of every kind that is measured, its title and how many numbers are read in all.
    range_noise
        One sigma of each range one way, m, (t, n); nan where none is measured.
    budget
        What each source leaves of the error of the place in `accuracy`, largest first.
    known_exactly
        Whether satellites' orbits and clocks count as known.
    settings
        The filter, with what it counts of satellites' errors.
    """

    flight: Trajectory
    beacons: Beacons
    seen: NDArray[np.bool_]
    taken: NDArray[np.bool_]
    observability: Observability
    blind: BlindSpots
    blind_epoch: int
    bound: Bound
    monte_carlo: MonteCarlo
    consistency: Consistency
    whole: Consistency
    accuracy: Accuracy
    ground: Accuracy | None = None
    readings: tuple[tuple[str, int], ...] = ()
    range_noise: NDArray[np.float64] | None = None
    budget: tuple[Share, ...] = ()
    known_exactly: bool = True
    settings: Filter | None = None

    @property
    def claim_m(self) -> float | None:
        """Position error (m, 1 sigma, 3-D) that may be claimed at deployment, or None.

        The worse of the linear covariance and the filter's own errors at the last epoch before; an
        inconsistent filter makes no claim.
        """
        if not self.consistency.holds:
            return None
        k = int(np.searchsorted(self.flight.times, self.accuracy.time, side="right")) - 1
        linear = float(np.linalg.norm(self.accuracy.knowledge.along_cross_down))
        return linear * max(
            1.0, float(self.monte_carlo.position_rms[k] / self.bound.position_sigma[k])
        )


def assess(
    model: EntryModel,
    flight: Trajectory,
    beacons: Beacons,
    measurements: Measurements,
    settings: Filter,
    *,
    deployment: Trigger | None = None,
    satellites: NDArray[np.float64] | None = None,
    turns: NDArray[np.float64] | None = None,
    runs: int = 500,
    seed: int = 0,
) -> Assessment:
    """Assess navigation along a flight.

    Parameters
    ----------
    model
        The world as the filter knows it; `flight.model` is the world as it is.
    flight
        The true trajectory.
    beacons
        At the flight's times.
    measurements, settings, runs, seed
        As in `compass.entry.navigation.run_monte_carlo`.
    deployment
        The trigger at which the landing is judged; the ground or the last time flown if left out.
    satellites
        Covariance of each beacon's radial, along, cross and clock error, m^2, (n, 4, 4), which
        the filter considers; known exactly if left out.
    turns
        One sigma of the turn about each axis of each beacon's frame, rad, (n,), which those share
        that are not 0; none if left out.

    Raises
    ------
    ArgumentError
        A beacon at the lander's own place.
    """
    check_apart(beacons, flight.states)
    seen = in_view(beacons, flight.states, flight.model.planet_radius)
    reaching = measurements.reaching(seen, beacons, flight.path, flight.model)
    taken = measurements.taken(seen, flight.times) & reaching
    _, variances, _ = measurements.heard(beacons, taken, flight.path, flight.model)
    ranges, rates = measurements.measures
    visible = observability(
        flight.model, flight.states, beacons, reaching, ranges=ranges, rates=rates
    )
    degree = np.where(visible.rank < 6, 0.0, visible.degree)  # that of a lower rank is rounding
    worst = int(np.lexsort((degree, visible.rank))[0])
    one_way = measurements.range_sigma is not None
    biased = with_satellites(
        settings,
        satellites,
        beacons,
        flight.path,
        flight.model.omega,
        one_way=one_way,
        turns=turns,
    )
    settings = biased.settings
    layout = settings.layout(beacons.size)
    bound = linear_covariance(
        flight.model,
        flight.path,
        beacons,
        taken,
        measurements,
        settings.covariance0,
        settings.noise,
        layout,
        square_root=settings.method == "square-root",
    )
    runs_made = run_monte_carlo(
        model, flight, beacons, taken, measurements, settings, runs=runs, seed=seed
    )
    accuracies = _accuracies(flight, bound, layout, settings, deployment)
    return Assessment(
        flight,
        beacons,
        seen,
        taken,
        visible,
        blind_spots(
            flight.model,
            flight.states[worst],
            beacons,
            worst,
            reaching[worst],
            ranges=ranges,
            rates=rates,
        ),
        worst,
        bound,
        runs_made,
        consistency(runs_made.nees, flight.times, 6, runs_made.diverged),
        consistency(runs_made.nees_all, flight.times, runs_made.estimated, runs_made.diverged),
        *accuracies,
        measurements.readings(variances),
        np.sqrt(variances[:, : beacons.size, 0]),
        landing_budget(flight, beacons, taken, measurements, biased, accuracies[0]),
        satellites is None,
        settings,
    )


#: The level at which a flight that is not stopped before ends.
GROUND = Trigger("ground", "altitude", 0.0)


def _accuracies(
    flight: Trajectory,
    bound: Bound,
    layout: Layout,
    settings: Filter,
    deployment: Trigger | None,
) -> tuple[Accuracy, Accuracy | None]:
    """Knowledge and delivery where a landing is judged, and on the ground if it goes on to it."""
    happened = {event.name for event in flight.events}
    down = GROUND.name in happened
    if deployment is None or deployment.name not in happened:
        deployment, down = (GROUND, False) if down else (deployment, False)
    places = (deployment, *([GROUND] if down else []))
    accuracies = [
        accuracy(flight, bound, layout, settings.covariance0, settings.noise, place)
        for place in places
    ]
    return accuracies[0], accuracies[1] if down else None


def assessment_dataset(assessment: Assessment) -> "xr.Dataset":
    """Everything over time: the trajectory's variables, view, observability, bound and errors."""
    data = trajectory_dataset(assessment.flight)
    mc, by_time = assessment.monte_carlo, ("time",)
    observability, bound = assessment.observability, assessment.bound
    columns = {
        "observability_degree": (
            observability.spherical_degree,
            "1",
            "smallest over largest singular value of the observability matrix of radius, angles "
            "and speed, in m, s, rad",
        ),
        "observability_degree_scaled": (
            observability.degree,
            "1",
            "the same of position and velocity, with lengths in 3400 km and times in 100 s",
        ),
        "observability_rank": (observability.rank, "1", "rank of the observability matrix"),
        "geometric_index": (
            observability.index,
            "1",
            "sum over triples of beacons of [n_i . (n_j x n_k)]^2",
        ),
        "position_bound": (bound.position_sigma, "m", "Cramer-Rao bound of the position"),
        "velocity_bound": (bound.velocity_sigma, "m s-1", "Cramer-Rao bound of the velocity"),
        "position_rms_error": (mc.position_rms, "m", "root mean square position error"),
        "velocity_rms_error": (mc.velocity_rms, "m s-1", "root mean square velocity error"),
        "position_sigma": (_mean_sigma(mc, 0), "m", "position sigma claimed by the filter"),
        "velocity_sigma": (_mean_sigma(mc, 1), "m s-1", "velocity sigma claimed by the filter"),
        "nees": (mc.mean_nees, "1", "mean normalised estimation error squared, 6 if consistent"),
    }
    for name, (values, unit, text) in columns.items():
        data[name] = (by_time, values, {"units": unit, "long_name": text})
    data = data.assign_coords(beacon=list(assessment.beacons.names), axis=["x", "y", "z"])
    for name, marks, text in (
        ("in_view", assessment.seen, "beacon in view"),
        ("measured", assessment.taken, "beacon measured"),
    ):
        about = {"units": "1", "long_name": text}
        data[name] = (("time", "beacon"), marks.astype("i1"), about)
    about = {"units": "m", "long_name": "beacon position, Mars-fixed"}
    data["beacon_position"] = (("time", "beacon", "axis"), assessment.beacons.r, about)
    data.attrs["monte_carlo_runs"] = len(mc.errors)
    data.attrs["monte_carlo_diverged"] = int(mc.diverged.sum())
    return data


def _mean_sigma(mc: MonteCarlo, part: int) -> NDArray[np.float64]:
    """Root mean square over the runs of what the filter claims, shape (t,)."""
    kept = mc.sigmas[~mc.diverged, :, part]
    return np.sqrt((kept**2).mean(axis=0)) if len(kept) else np.full(mc.sigmas.shape[1], np.nan)
