"""The flight itself: integrated, with events, loads and heating."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.bodies import Constant
from compass.core.entry.dop853 import (
    ARRIVED,
    EVENT,
    STANDSTILL,
    VERTICAL,
    WATCH_AIRSPEED,
    WATCH_RADIUS,
    WATCH_SPEED,
    dop853_flight,
)
from compass.core.entry.rates import World, through_air
from compass.entry.model import EntryModel
from compass.entry.start import Trigger, check_start
from compass.entry.views import cartesian_of, spherical_of
from compass.errors import ArgumentError
from compass.words import place_words

if TYPE_CHECKING:
    import xarray as xr

STANDARD_GRAVITY = Constant(9.80665, "m/s^2", 0.0, "BIPM 2019, The International System of Units")
SUTTON_GRAVES_MARS = Constant(
    1.9027e-4,
    "kg^0.5/m",
    0.0,
    "Sutton and Graves 1971, NASA TR R-376: stagnation-point convection in Mars's gas mixture",
)

#: Local error allowed in a step: relative to the lengths of position and velocity, and absolute.
RELATIVE_TOLERANCE = 1e-13
ABSOLUTE_TOLERANCE = np.array([1e-7, 1e-7, 1e-7, 1e-10, 1e-10, 1e-10])

#: Seconds between the points at which loads are looked for, and the most points.
LOAD_STEP, LOAD_POINTS = 0.25, 40_000


@dataclass(frozen=True)
class Event:
    """What happened, when (s) and in which state (8 values)."""

    name: str
    time: float
    state: NDArray[np.float64]


@dataclass(frozen=True)
class Trajectory:
    """A flight.

    Attributes
    ----------
    model
        The world it was flown in.
    times
        Seconds, shape (t,): those asked for that were reached.
    path
        Mars-fixed position (m) and velocity relative to the planet (m/s), shape (t, 6).
    constants
        ``ln_rho0`` and lift-to-drag ratio that were flown.
    longitude0
        Longitude at which `states` begin, radians; they go on past a turn.
    events
        In order of time.
    missed
        Names of the triggers whose levels were never fallen to, with the reason.
    ending
        Empty if every time asked for was reached, else why not, when and where.
    """

    model: EntryModel
    times: NDArray[np.float64]
    path: NDArray[np.float64]
    constants: tuple[float, float]
    longitude0: float
    events: tuple[Event, ...]
    missed: tuple[str, ...]
    ending: str

    @cached_property
    def states(self) -> NDArray[np.float64]:
        """``[r, lon, lat, V, gamma, psi, ln_rho0, kappa]``, shape (t, 8), SI, psi from north."""
        return _viewed(self.path, self.constants, self.longitude0)

    @property
    def altitude(self) -> NDArray[np.float64]:
        """Height over the planet's sphere, metres, shape (t,)."""
        return np.linalg.norm(self.path[:, :3], axis=1) - self.model.planet_radius

    @property
    def speed(self) -> NDArray[np.float64]:
        """Speed relative to the planet, m/s, shape (t,)."""
        return np.linalg.norm(self.path[:, 3:], axis=1)


def _viewed(
    path: NDArray[np.float64], constants: tuple[float, float], longitude0: float
) -> NDArray[np.float64]:
    """Spherical states (t, 8), their longitudes without jumps, the first nearest `longitude0`."""
    six = spherical_of(path)
    longitude = np.unwrap(np.concatenate([[longitude0], six[:, 1]]))[1:]
    six[:, 1] = longitude
    return np.concatenate([six, np.broadcast_to(constants, (len(six), 2))], axis=1)


def fly(
    model: EntryModel,
    state: ArrayLike,
    times: ArrayLike,
    *,
    triggers: Sequence[Trigger] = (),
) -> Trajectory:
    """Integrate the equations of motion from the first of `times` through all of them.

    Adaptive steps (Dormand-Prince 8(5,3)) in Mars-fixed Cartesian axes, which begin anew at every
    switch of the bank: the times asked for decide nothing about the flight. It ends early at the
    ground, at rest, or where the velocity becomes vertical with lift; what was flown is kept and
    `Trajectory.ending` says what happened. A rise back through the starting radius (a skip out of
    the atmosphere) is noted as an event.

    Parameters
    ----------
    model
        The world.
    state
        ``[r, lon, lat, V, gamma, psi]`` or all eight states at the first time.
    times
        Seconds, strictly increasing, shape (t,).
    triggers
        What to notice.

    Raises
    ------
    ArgumentError
        Times that do not increase, a start that is not above the ground, without speed, or
        vertical.
    """
    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    x0 = model.full_state(state) if np.size(state) < 8 else np.array(state, dtype=float)
    if seconds.size < 1 or not np.isfinite(seconds).all() or np.any(np.diff(seconds) <= 0):
        raise ArgumentError("times: must be finite numbers of seconds that increase strictly")
    check_start(model, x0)
    switches = [t for t in model.vehicle.bank_times if seconds[0] < t < seconds[-1]]
    grid = np.union1d(seconds, switches)
    names, watch = _watch_list(model, x0, triggers)
    path = np.empty((grid.size, 6))
    event_times, event_paths = np.empty(len(names)), np.empty((len(names), 6))
    status, count, when = dop853_flight(
        cartesian_of(x0[:6]),
        World(model.flight_parameters(), x0[6] - model.atmosphere.log_reference_density, x0[7]),
        grid,
        model.vehicle.bank_schedule(),
        RELATIVE_TOLERANCE,
        ABSOLUTE_TOLERANCE,
        watch,
        path,
        event_times,
        event_paths,
    )
    constants, lon0 = (float(x0[6]), float(x0[7])), float(x0[1])
    order = [e for e in np.argsort(event_times) if np.isfinite(event_times[e])]
    happened = tuple(
        Event(names[e], float(event_times[e]), state)
        for e, state in zip(order, _viewed(event_paths[order], constants, lon0), strict=True)
    )
    kept = np.isin(grid[:count], seconds)
    flown = Trajectory(
        model, grid[:count][kept], path[:count][kept], constants, lon0, happened, (), ""
    )
    last = happened[-1].state if status == EVENT else _viewed(path[count - 1 :], constants, lon0)[0]
    reason = {
        EVENT: "reached the ground",
        STANDSTILL: "came to a standstill, where the direction of flight is undefined",
        VERTICAL: "became vertical, where the side of the lift is undefined",
    }.get(status, "could not be integrated any further")
    return replace(
        flown,
        missed=_missed(triggers, happened, when),
        ending="" if status == ARRIVED else _ending(reason, when, last),
    )


def _missed(triggers: Sequence[Trigger], happened: Sequence[Event], end: float) -> tuple[str, ...]:
    """Sentences on triggers that did not happen."""
    met = {event.name for event in happened}
    units = {"altitude": "m", "speed": "m/s", "mach": ""}
    return tuple(
        f"{trigger.name}: {trigger.quantity} {trigger.level:g} {units[trigger.quantity]}".rstrip()
        + f" is not fallen to by {end:.6g} s"
        for trigger in triggers
        if trigger.name not in met
    )


def _watch_list(
    model: EntryModel, x0: NDArray[np.float64], triggers: Sequence[Trigger]
) -> tuple[list[str], NDArray[np.float64]]:
    """Names of the events, and what the kernel needs to find them."""
    names = ["ground", "skip-out"]
    watch = [
        (WATCH_RADIUS, model.planet_radius, -1.0, 1.0),
        (WATCH_RADIUS, float(x0[0]), 1.0, 0.0),
    ]
    for trigger in triggers:
        names.append(trigger.name)
        what, level = watched_level(model, trigger)
        watch.append((what, level, -1.0, 0.0))
    return names, np.array(watch, dtype=float)


def watched_level(model: EntryModel, trigger: Trigger) -> tuple[int, float]:
    """Return what the kernels watch for a trigger, and the level in m or m/s."""
    if trigger.quantity == "altitude":
        return WATCH_RADIUS, model.planet_radius + trigger.level
    if trigger.quantity == "speed":
        return WATCH_SPEED, trigger.level
    return WATCH_AIRSPEED, trigger.level * model.atmosphere.speed_of_sound


def _ending(reason: str, time: float, state: NDArray[np.float64]) -> str:
    place = place_words(float(np.degrees(state[2])), float(np.degrees(state[1])), ".4f")
    return f"the flight {reason} at {time:.3f} s, {place}, speed {state[3]:.1f} m/s"


@dataclass(frozen=True)
class Loads:
    """What the vehicle bears, along a flight.

    Attributes
    ----------
    times
        Seconds, shape (t,).
    density, drag, g_load, dynamic_pressure, heat_flux, heat_load
        kg/m^3, m/s^2, standard gravities, Pa, W/m^2 and J/m^2, shape (t,).
    """

    times: NDArray[np.float64]
    density: NDArray[np.float64]
    drag: NDArray[np.float64]
    g_load: NDArray[np.float64]
    dynamic_pressure: NDArray[np.float64]
    heat_flux: NDArray[np.float64]
    heat_load: NDArray[np.float64]

    def largest(self, name: str) -> tuple[float, float]:
        """Largest value of a load and when: the parabola through the largest of the points."""
        values: NDArray[np.float64] = getattr(self, name)
        k = int(np.argmax(values))
        if not 0 < k < values.size - 1:
            return float(values[k]), float(self.times[k])
        a, b, c = np.polyfit(self.times[k - 1 : k + 2] - self.times[k], values[k - 1 : k + 2], 2)
        if not a < 0:
            return float(values[k]), float(self.times[k])
        return float(c - b * b / (4 * a)), float(self.times[k] - b / (2 * a))


def airspeeds(model: EntryModel, path: NDArray[np.float64]) -> NDArray[np.float64]:
    """Speed through the air at states (t, 6), m/s, shape (t,)."""
    p = model.flight_parameters()
    through = [through_air(state, p) for state in path]  # some thousand points
    return np.linalg.norm(np.reshape(through, (-1, 3)), axis=1)


def loads(flight: Trajectory) -> Loads:
    """Loads and heating from the flight itself, not from where it was written out.

    Deceleration ``sqrt(D^2 + L^2)`` in standard gravities; convective heat flux at the
    stagnation point ``k sqrt(rho/R_n) V^3`` (Sutton and Graves 1971) and its integral. Points
    are `LOAD_STEP` apart: a peak of half-width 10 s is met to 1e-7 by its parabola.
    """
    first, last = flight.times[0], flight.times[-1]
    count = int(np.clip(np.ceil((last - first) / LOAD_STEP), 1, LOAD_POINTS)) + 1
    times = np.union1d(np.linspace(first, last, count), flight.times)
    model, craft, air = flight.model, flight.model.vehicle, flight.model.atmosphere
    path = fly(model, flight.states[0], times).path if last > first else flight.path
    times = times[: len(path)]
    thicker = flight.constants[0] - air.log_reference_density
    density = air.density(np.linalg.norm(path[:, :3], axis=1)) * np.exp(thicker)
    speed = airspeeds(model, path)
    pressure = 0.5 * density * speed**2
    drag = pressure * craft.drag_area_per_mass
    heat = SUTTON_GRAVES_MARS.value * np.sqrt(density / craft.nose_radius) * speed**3
    steps = 0.5 * (heat[1:] + heat[:-1]) * np.diff(times)
    return Loads(
        times,
        density,
        drag,
        drag * np.hypot(1.0, flight.constants[1]) / STANDARD_GRAVITY.value,
        pressure,
        heat,
        np.concatenate([[0.0], np.cumsum(steps)]),
    )


def trajectory_dataset(flight: Trajectory) -> "xr.Dataset":
    """States, loads (see `loads`) and heating over time, with units."""
    import xarray as xr

    model, x, borne = flight.model, flight.states, loads(flight)
    at = np.searchsorted(borne.times, flight.times)
    columns = {
        "radius": (x[:, 0], "m", "distance from Mars's centre"),
        "altitude": (flight.altitude, "m", "height over the sphere"),
        "longitude": (np.degrees(x[:, 1]), "degrees_east", "east longitude"),
        "latitude": (np.degrees(x[:, 2]), "degrees_north", "planetocentric latitude"),
        "speed": (x[:, 3], "m s-1", "speed relative to the rotating planet"),
        "flight_path_angle": (np.degrees(x[:, 4]), "degree", "flight-path angle, positive up"),
        "azimuth": (np.degrees(x[:, 5]), "degree", "azimuth clockwise from north"),
        "bank": (np.degrees(model.vehicle.bank(flight.times)), "degree", "bank angle commanded"),
        "density": (borne.density[at], "kg m-3", "density of the air"),
        "drag": (borne.drag[at], "m s-2", "drag acceleration"),
        "lift": (x[:, 7] * borne.drag[at], "m s-2", "lift acceleration"),
        "g_load": (borne.g_load[at], "1", "aerodynamic acceleration in standard gravities"),
        "mach": (
            airspeeds(model, flight.path) / model.atmosphere.speed_of_sound,
            "1",
            "Mach number through the air",
        ),
        "dynamic_pressure": (borne.dynamic_pressure[at], "Pa", "dynamic pressure"),
        "heat_flux": (borne.heat_flux[at], "W m-2", "stagnation-point convective heat flux"),
        "heat_load": (borne.heat_load[at], "J m-2", "heat flux integrated"),
    }
    return xr.Dataset(
        {
            name: ("time", values, {"units": unit, "long_name": text})
            for name, (values, unit, text) in columns.items()
        },
        coords={"time": ("time", flight.times, {"units": "s", "long_name": "time after entry"})},
        attrs={"ending": flight.ending, "rotation": model.rotation},
    )
