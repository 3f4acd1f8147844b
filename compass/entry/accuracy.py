"""Where a landing comes down and how well it is known: projected, along and across, ellipse."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.core.entry.filter import covariance_run
from compass.core.entry.kinds import PLAIN
from compass.core.entry.rates import World, acceleration, through_air, wind_gradient
from compass.entry.covariance import LONGEST_STEP, Bound, problem_of
from compass.entry.layout import Layout
from compass.entry.model import EntryModel
from compass.entry.start import Trigger
from compass.entry.trajectory import Event, Trajectory
from compass.entry.views import along_cross_down, cartesian_of, local_axes

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Ellipse:
    """Horizontal error ellipse.

    Attributes
    ----------
    east, north
        Centre, metres from the true point.
    semi_major, semi_minor
        Metres.
    azimuth
        Of the major axis, clockwise from north, radians in [0, pi).
    level
        Probability inside, for Gaussian errors.
    """

    east: float
    north: float
    semi_major: float
    semi_minor: float
    azimuth: float
    level: float

    def outline(self, points: int = 181) -> NDArray[np.float64]:
        """East and north of points around the ellipse, metres, shape (points, 2)."""
        angle = np.linspace(0, 2 * np.pi, points)
        along, across = self.semi_major * np.cos(angle), self.semi_minor * np.sin(angle)
        s, c = np.sin(self.azimuth), np.cos(self.azimuth)
        return np.stack(
            [self.east + along * s + across * c, self.north + along * c - across * s], axis=-1
        )


def error_ellipse(
    mean: NDArray[np.float64], covariance: NDArray[np.float64], level: float = 0.95
) -> Ellipse:
    """Ellipse of east and north errors that holds `level` of a Gaussian distribution.

    Parameters
    ----------
    mean
        East and north, metres, shape (2,).
    covariance
        Shape (2, 2), m^2.
    level
        Probability inside: radius ``sqrt(-2 ln(1 - level))`` sigma.
    """
    values, vectors = np.linalg.eigh(covariance)
    radius = np.sqrt(-2 * np.log(1 - level))
    major, minor = radius * np.sqrt(np.maximum(values[::-1], 0.0))
    azimuth = float(np.mod(np.arctan2(vectors[0, 1], vectors[1, 1]), np.pi))
    return Ellipse(float(mean[0]), float(mean[1]), float(major), float(minor), azimuth, level)


def circular_error(covariance: NDArray[np.float64], share: float = 0.5) -> float:
    """Radius, m, of the circle about the mean that holds a share of a plane Gaussian; 0.5: CEP.

    ``P(R) = 1/(2 pi) integral (1 - exp(-R^2 k/2)) / (a b k) dtheta``, ``k = cos^2/a^2 +
    sin^2/b^2``, by the trapezoidal rule, exact to rounding for a periodic integrand.

    Parameters
    ----------
    covariance
        Shape (2, 2), m^2.
    share
        Probability inside.
    """
    from scipy.optimize import brentq

    b2, a2 = np.linalg.eigvalsh(covariance)
    a, b = float(np.sqrt(max(a2, 0.0))), float(np.sqrt(max(b2, 0.0)))
    if a == 0.0:
        return 0.0
    b = max(b, 1e-4 * a)  # a line: the circle then is off by less than 1e-8
    angle = np.linspace(0.0, np.pi, 40_000, endpoint=False)
    k = (np.cos(angle) / a) ** 2 + (np.sin(angle) / b) ** 2

    def inside(radius: float) -> float:
        return float((-np.expm1(-0.5 * radius**2 * k) / (a * b * k)).mean()) - share

    return float(brentq(inside, 0.0, 10.0 * a, xtol=1e-9 * a))


@dataclass(frozen=True)
class Spread:
    """How far apart a place may be, at the end of an entry.

    Attributes
    ----------
    along_cross_down
        One sigma along the ground track, across it and down, m, shape (3,).
    ellipse
        Horizontal, 95 %, about the nominal place.
    cep
        Radius of the circle that holds half, m.
    """

    along_cross_down: Array
    ellipse: Ellipse
    cep: float


@dataclass(frozen=True)
class Accuracy:
    """What a landing comes to at deployment: two things that differ by orders.

    Attributes
    ----------
    name, time, path
        Of deployment: what it is, s, and the nominal state there (6,).
    projected
        Whether it is an event with a surface, onto which the covariances are projected, or only
        the last time flown.
    knowledge
        How well the filter can know where the vehicle is (linear covariance).
    delivery
        How far from the nominal place the vehicle comes to it, unguided, from what is not known of
        the first state (and of air and lift, where these are uncertain).
    surface
        From errors at the time to errors on the event's surface, `projection`, (6, 6).
    """

    name: str
    time: float
    path: Array
    projected: bool
    knowledge: Spread
    delivery: Spread
    surface: Array

    @property
    def anywhere(self) -> bool:
        """Whether delivery spreads over more than a radian of the ground.

        So far a plane through the nominal place, and a covariance about it, say nothing.
        """
        return bool(self.delivery.ellipse.semi_major > np.linalg.norm(self.path[:3]))


def projection(rate: ArrayLike, gradient: ArrayLike) -> Array:
    """``M = I - f g^T / (g^T f)``, (6, 6): from errors at a time to errors on a surface.

    Parameters
    ----------
    rate, gradient
        Of the state, f, and of the quantity whose level is the surface, g, shape (6,).
    """
    f, g = np.asarray(rate, dtype=float), np.asarray(gradient, dtype=float)
    return np.eye(6) - np.outer(f, g) / (g @ f)


def accuracy(
    flight: Trajectory,
    bound: Bound,
    layout: Layout,
    covariance0: ArrayLike,
    noise: ArrayLike,
    trigger: Trigger | None = None,
) -> Accuracy:
    """Knowledge and delivery at a trigger of a flight, or at its last time.

    Parameters
    ----------
    flight
        The nominal flight, in the world that the filter knows.
    bound
        Linear covariance at its times.
    layout, covariance0, noise
        Blocks, prior of position and velocity (6, 6) and process noise that `bound` was made with.
    trigger
        What counts as deployment; its event must be among the flight's.
    """
    event = _event(flight, trigger)
    time = event.time if event else float(flight.times[-1])
    path = cartesian_of(event.state[:6]) if event else flight.path[-1]
    k = int(np.searchsorted(flight.times, time, side="right")) - 1
    m = np.eye(6)
    if event and trigger:
        m = projection(_rate(flight, path, time), _gradient(flight.model, path, trigger))
    last, both = np.array([flight.times[k], time]), np.stack([flight.path[k], path])
    known = _unmeasured(flight, last, both, bound.covariance[k], layout, noise)
    prior = layout.covariance(np.asarray(covariance0, dtype=float))
    times = np.append(flight.times[: k + 1], time)
    flown = _unmeasured(
        flight, times, np.vstack([flight.path[: k + 1], path]), prior, layout, noise
    )
    return Accuracy(
        trigger.name if event and trigger else "the last time flown",
        time,
        path,
        event is not None,
        _spread(m @ known[:6, :6] @ m.T, path),
        _spread(m @ flown[:6, :6] @ m.T, path),
        m,
    )


def _event(flight: Trajectory, trigger: Trigger | None) -> Event | None:
    for event in flight.events:
        if trigger is not None and event.name == trigger.name:
            return event
    return None


def _unmeasured(
    flight: Trajectory,
    times: Array,
    path: Array,
    covariance: Array,
    layout: Layout,
    noise: ArrayLike,
) -> Array:
    """Return a covariance at the first of `times` moved on to the last with nothing measured."""
    out = np.empty((times.size, layout.size, layout.size))
    nothing = np.empty((times.size, 0, 6)), np.empty((times.size, 0, 0)), np.empty(0, np.int64)
    covariance_run(
        path,
        covariance,
        problem_of(flight.model, layout, path, times, nothing, noise, LONGEST_STEP),
        PLAIN,
        out,
    )
    return out[-1]


def _rate(flight: Trajectory, path: Array, time: float) -> Array:
    """Rate of the state, (6,), at a state of a flight."""
    model, force = flight.model, np.empty(3)
    bank = float(model.vehicle.bank(time))
    thicker = flight.constants[0] - model.atmosphere.log_reference_density
    world = World(model.flight_parameters(), thicker, flight.constants[1])
    acceleration(path, world, np.cos(bank), np.sin(bank), force)
    return np.concatenate([path[3:], force])


def _gradient(model: EntryModel, path: Array, trigger: Trigger) -> Array:
    """Direction in which a trigger's quantity grows, (6,)."""
    out = np.zeros(6)
    if trigger.quantity == "mach":
        p, blown = model.flight_parameters(), np.empty((3, 3))
        wind_gradient(path, p, blown)
        out[3:] = through_air(path, p)
        out[:3] = -out[3:] @ blown
        return out
    part = slice(0, 3) if trigger.quantity == "altitude" else slice(3, 6)
    out[part] = path[part]
    return out


def _spread(covariance: Array, path: Array) -> Spread:
    place = covariance[:3, :3]
    axes = along_cross_down(path)
    level = local_axes(path[:3])[:2]
    horizontal = level @ place @ level.T
    return Spread(
        np.sqrt(np.maximum(np.einsum("ia,ab,ib->i", axes, place, axes), 0.0)),
        error_ellipse(np.zeros(2), horizontal),
        circular_error(horizontal),
    )
