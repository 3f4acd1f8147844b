"""The flight itself: integrated, with events, loads and heating."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.bodies import Constant
from compass.core.dop853 import (
    ARRIVED,
    EVENT,
    STANDSTILL,
    VERTICAL,
    dop853_flight,
    rk4_flight,
)
from compass.core.entry_dynamics import STATES
from compass.entry.model import EntryModel
from compass.entry.state import longitude_degrees
from compass.errors import ArgumentError

if TYPE_CHECKING:
    import xarray as xr

STANDARD_GRAVITY = Constant(9.80665, "m/s^2", 0.0, "BIPM 2019, The International System of Units")
SUTTON_GRAVES_MARS = Constant(
    1.9027e-4,
    "kg^0.5/m",
    0.0,
    "Sutton and Graves 1971, NASA TR R-376: stagnation-point convection in Mars's gas mixture",
)

#: Local error allowed in a step: relative, and absolute in m, rad and m/s.
RELATIVE_TOLERANCE = 1e-13
ABSOLUTE_TOLERANCE = np.array([1e-7, 1e-14, 1e-14, 1e-10, 1e-14, 1e-14])


@dataclass(frozen=True)
class Trigger:
    """Something to be noticed on the way down: the first fall to a level.

    Attributes
    ----------
    name
        What to call it.
    quantity
        ``altitude`` (m over the planet's sphere), ``speed`` (m/s) or ``mach``.
    level
        In the quantity's unit.
    """

    name: str
    quantity: Literal["altitude", "speed", "mach"]
    level: float


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
    states
        ``[r, lon, lat, V, gamma, psi, ln_rho0, kappa]``, shape (t, 8), SI, psi from north.
    events
        In order of time.
    ending
        Empty if every time asked for was reached, else why not, when and where.
    """

    model: EntryModel
    times: NDArray[np.float64]
    states: NDArray[np.float64]
    events: tuple[Event, ...]
    ending: str

    @property
    def altitude(self) -> NDArray[np.float64]:
        """Height over the planet's sphere, metres, shape (t,)."""
        return self.states[:, 0] - self.model.planet_radius


def fly(
    model: EntryModel,
    state: ArrayLike,
    times: ArrayLike,
    *,
    triggers: Sequence[Trigger] = (),
    method: Literal["dop853", "rk4"] = "dop853",
    substeps: int = 1,
) -> Trajectory:
    """Integrate the equations of motion from the first of `times` through all of them.

    The flight ends early at the ground, or where the speed or the cosine of the flight-path
    angle comes to zero; what was flown is kept and `Trajectory.ending` says what happened. A
    rise back through the starting radius (a skip out of the atmosphere) is noted as an event.

    Parameters
    ----------
    model
        The world.
    state
        ``[r, lon, lat, V, gamma, psi]`` or all eight states at the first time.
    times
        Seconds, strictly increasing, shape (t,).
    triggers
        What to notice (with ``dop853``).
    method
        ``dop853``: adaptive Dormand-Prince 8(5,3); ``rk4``: classical Runge-Kutta steps.
    substeps
        Runge-Kutta steps between two times.

    Raises
    ------
    ArgumentError
        Times that do not increase, a start that is not above the ground, without speed,
        vertical or at a pole.
    """
    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    given = np.asarray(state, dtype=float)
    x0 = given.copy() if given.size == STATES else model.full_state(given)
    if seconds.size < 1 or not np.isfinite(seconds).all() or np.any(np.diff(seconds) <= 0):
        raise ArgumentError("times: must be finite numbers of seconds that increase strictly")
    check_start(model, x0)
    switches = [t for t in model.vehicle.bank_times if seconds[0] < t < seconds[-1]]
    grid = np.union1d(seconds, switches)
    banks, p = model.vehicle.bank(grid), model.parameters()
    states = np.empty((grid.size, STATES))
    if method == "rk4":
        count = rk4_flight(x0, p, grid, banks, substeps, states)
        below = np.flatnonzero(states[:count, 0] < model.planet_radius)
        ending = ""
        if below.size:
            count = int(below[0])
            ending = _ending("reached the ground", grid[count], states[count])
        elif count < grid.size:
            ending = _ending("left the domain of the equations", grid[count - 1], states[count - 1])
        kept = np.isin(grid[:count], seconds)
        return Trajectory(model, grid[:count][kept], states[:count][kept], (), ending)

    names, watch = _watch_list(model, x0, triggers)
    event_times, event_states = np.empty(len(names)), np.empty((len(names), STATES))
    status, count, when = dop853_flight(
        x0,
        p,
        grid,
        banks,
        RELATIVE_TOLERANCE,
        ABSOLUTE_TOLERANCE,
        watch,
        states,
        event_times,
        event_states,
    )
    happened = [
        Event(names[e], float(event_times[e]), event_states[e])
        for e in np.argsort(event_times, kind="stable")
        if np.isfinite(event_times[e])
    ]
    kept = np.isin(grid[:count], seconds)
    last = happened[-1].state if status == EVENT else states[count - 1]
    reason = {
        EVENT: "reached the ground",
        STANDSTILL: "came to a standstill, where the heading is undefined",
        VERTICAL: "became vertical, where the heading is undefined",
    }.get(status, "could not be integrated any further")
    ending = "" if status == ARRIVED else _ending(reason, when, last)
    return Trajectory(model, grid[:count][kept], states[:count][kept], tuple(happened), ending)


def check_start(model: EntryModel, x: NDArray[np.float64]) -> None:
    """Raise `ArgumentError` unless a flight can start from state `x`, as said of `fly`."""
    if not np.isfinite(x).all():
        raise ArgumentError("entry state: every component must be a finite number")
    if x[0] <= model.planet_radius:
        raise ArgumentError(
            f"entry.radius_km = {x[0] / 1e3:g}: not above the ground; must be more than "
            f"{model.planet_radius / 1e3:g} km"
        )
    if x[3] <= 0:
        raise ArgumentError(f"entry.speed_m_s = {x[3]:g}: must be above 0")
    if abs(np.cos(x[4])) < 1e-6:
        raise ArgumentError(
            f"entry.flight_path_deg = {np.degrees(x[4]):g}: vertical, the heading is undefined; "
            "must be strictly between -90 and 90"
        )
    if abs(np.cos(x[2])) < 1e-9:
        raise ArgumentError(
            f"entry.latitude_deg = {np.degrees(x[2]):g}: at a pole the longitude is undefined; "
            "move away"
        )


def _watch_list(
    model: EntryModel, x0: NDArray[np.float64], triggers: Sequence[Trigger]
) -> tuple[list[str], NDArray[np.float64]]:
    """Names of the events, and what the kernel needs to find them."""
    names = ["ground", "skip-out"]
    watch = [(0.0, model.planet_radius, -1.0, 1.0), (0.0, x0[0], 1.0, 0.0)]
    for trigger in triggers:
        names.append(trigger.name)
        if trigger.quantity == "altitude":
            watch.append((0.0, model.planet_radius + trigger.level, -1.0, 0.0))
        else:
            unit = model.atmosphere.speed_of_sound if trigger.quantity == "mach" else 1.0
            watch.append((3.0, trigger.level * unit, -1.0, 0.0))
    return names, np.array(watch)


def _ending(reason: str, time: float, state: NDArray[np.float64]) -> str:
    lat, lon = np.degrees(state[2]), longitude_degrees(state[1])
    return (
        f"the flight {reason} at {time:.3f} s, latitude {lat:.4f} deg, longitude {lon:.4f} deg, "
        f"speed {state[3]:.1f} m/s"
    )


def trajectory_dataset(flight: Trajectory) -> "xr.Dataset":
    """States, loads and heating over time, with units.

    Deceleration ``sqrt(D^2 + L^2)`` in standard gravities; convective heat flux at the
    stagnation point ``k sqrt(rho/R_n) V^3`` (Sutton and Graves 1971) and its integral.
    """
    import xarray as xr

    model, x = flight.model, flight.states
    air = model.atmosphere
    density = air.density(x[:, 0]) * np.exp(x[:, 6]) / air.reference_density
    speed = x[:, 3]
    drag = 0.5 * density * model.vehicle.drag_area_per_mass * speed**2
    heat = SUTTON_GRAVES_MARS.value * np.sqrt(density / model.vehicle.nose_radius) * speed**3
    steps = 0.5 * (heat[1:] + heat[:-1]) * np.diff(flight.times)
    load = drag * np.hypot(1.0, x[:, 7]) / STANDARD_GRAVITY.value
    columns = {
        "radius": (x[:, 0], "m", "distance from Mars's centre"),
        "altitude": (flight.altitude, "m", "height over the sphere"),
        "longitude": (np.degrees(x[:, 1]), "degrees_east", "east longitude"),
        "latitude": (np.degrees(x[:, 2]), "degrees_north", "planetocentric latitude"),
        "speed": (speed, "m s-1", "speed relative to the rotating planet"),
        "flight_path_angle": (np.degrees(x[:, 4]), "degree", "flight-path angle, positive up"),
        "azimuth": (np.degrees(x[:, 5]), "degree", "azimuth clockwise from north"),
        "bank": (np.degrees(model.vehicle.bank(flight.times)), "degree", "bank angle commanded"),
        "density": (density, "kg m-3", "density of the air"),
        "drag": (drag, "m s-2", "drag acceleration"),
        "lift": (x[:, 7] * drag, "m s-2", "lift acceleration"),
        "g_load": (load, "1", "aerodynamic acceleration in standard gravities"),
        "mach": (speed / air.speed_of_sound, "1", "Mach number"),
        "dynamic_pressure": (0.5 * density * speed**2, "Pa", "dynamic pressure"),
        "heat_flux": (heat, "W m-2", "stagnation-point convective heat flux"),
        "heat_load": (np.concatenate([[0.0], np.cumsum(steps)]), "J m-2", "heat flux integrated"),
    }
    return xr.Dataset(
        {
            name: ("time", values, {"units": unit, "long_name": text})
            for name, (values, unit, text) in columns.items()
        },
        coords={"time": ("time", flight.times, {"units": "s", "long_name": "time after entry"})},
        attrs={"ending": flight.ending, "rotation": model.rotation},
    )
