"""The nodes of the network: satellites, stations, moons, the Earth and the Sun."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial
from numpy.typing import NDArray

from compass.bodies import SOLAR_DAY
from compass.core.motion import ELLIPSE, SITE, TABLE, WIDTH
from compass.errors import ArgumentError, meant
from compass.frames import SECONDS_PER_DAY, mci_from_icrf, prime_meridian_angle
from compass.moons import MoonModel, moon_row
from compass.orbits.constellation import Constellation
from compass.orbits.period import secular_rates
from compass.orbits.trajectory import Trajectory
from compass.planets import sun_earth_mci
from compass.sites import Mask, Site

NodeKind = Literal["satellite", "station", "moon", "earth", "sun"]
DriftModel = Literal["two-body", "j2"]

#: Longest span, sols: linear drifts of moons and of the prime meridian hold over it.
MAX_SOLS = 1000.0

#: By how much a table of a satellite's states may miss its path between rows, m.
TABLE_ERROR = 0.01


@dataclass(frozen=True)
class Node:
    """One end of a link, as the kernels see it.

    Attributes
    ----------
    name
        What to call it.
    kind
        ``satellite``, ``station``, ``moon``, ``earth`` or ``sun``.
    row
        Its motion (`compass.core.motion`), in the inertial frame of the epoch.
    states
        States of a tabulated node (Earth, Sun), shape (rows, 6), m and m/s; else empty.
    rate
        Its angular rate about Mars, rad/s.
    lowest
        Its smallest distance from Mars's centre, metres.
    site
        The station's site, else None.
    """

    name: str
    kind: NodeKind
    row: NDArray[np.float64]
    rate: float
    lowest: float
    states: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 6)))
    site: Site | None = None

    @property
    def highest(self) -> float:
        """A satellite's or moon's largest distance from Mars's centre, metres."""
        return float(self.row[6] if self.row[0] == TABLE else self.row[1] * (1 + self.row[2]))

    @property
    def mask(self) -> Mask:
        """The station's mask; nothing is hidden from other nodes but by Mars."""
        return self.site.mask if self.site else Mask()


def check_duration(duration: float) -> None:
    """Raise `ArgumentError` unless a span in seconds is positive and at most `MAX_SOLS`."""
    sols = duration / SOLAR_DAY.value
    if not 0 < sols <= MAX_SOLS * (1 + 1e-12):
        raise ArgumentError(
            f"duration = {sols:.6g} sols: must be above 0 and at most {MAX_SOLS:g}; "
            "start later spans at another epoch"
        )


def satellite_nodes(constellation: Constellation, model: DriftModel = "two-body") -> list[Node]:
    """Nodes of all satellites, moving by two-body motion or with J2's secular drift."""
    c = constellation
    if model == "two-body":
        still = np.zeros(c.size)
        rates = (still, still, c.mean_motion)
    elif model == "j2":
        rates = secular_rates(c.semi_major_axis, c.eccentricity, c.inclination, c.gm)
    else:
        raise ArgumentError(f"model = {model!r}: allowed two-body, j2")
    rows = np.zeros((c.size, WIDTH))
    rows[:, 0] = ELLIPSE
    rows[:, 1], rows[:, 2] = c.semi_major_axis, c.eccentricity
    rows[:, 3], rows[:, 4] = np.cos(c.inclination), np.sin(c.inclination)
    rows[:, 5], rows[:, 6], rows[:, 7] = c.raan, c.argument_of_periapsis, c.mean_anomaly
    rows[:, 8], rows[:, 9], rows[:, 10] = rates
    rows[:, 11:] = np.eye(3).ravel()
    # at periapsis the direction turns fastest
    fastest = c.mean_motion * np.sqrt(1 + c.eccentricity) / (1 - c.eccentricity) ** 1.5
    return [
        Node(name, "satellite", rows[k], float(fastest[k]), float(c.periapsis_radius[k]))
        for k, name in enumerate(c.satellite_names)
    ]


def path_nodes(path: Trajectory, start: float, duration: float) -> list[Node]:
    """Nodes of satellites on paths, from `start` seconds after the paths' epoch on.

    They are tables of states in the frame of the moment `start`, so close that the cubics between
    them miss the paths by less than `TABLE_ERROR`: by ``h^4 / 384`` times the fourth derivative,
    which is ``n^4 r``.

    Raises
    ------
    ArgumentError
        The paths do not cover the span.
    """
    looks = np.linspace(start, start + duration, 64)
    r, v = path.states(looks)
    turning = np.linalg.norm(np.cross(r, v), axis=-1) / (r * r).sum(axis=-1)
    bend = float((turning**4 * np.linalg.norm(r, axis=-1)).max())
    longest = (384.0 * TABLE_ERROR / bend) ** 0.25
    count = int(np.ceil(duration / longest)) + 1
    step = duration / (count - 1)
    r, v = path.states(start + step * np.arange(count))
    # the pole precesses: the frame of another moment is another one
    turn = mci_from_icrf(path.epoch + start) @ mci_from_icrf(path.epoch).T
    states = np.concatenate([r @ turn.T, v @ turn.T], axis=-1)
    return [
        _table_node(name, "satellite", states[k], step)
        for k, name in enumerate(path.satellite_names)
    ]


def station_node(site: Site, epoch: float, duration: float) -> Node:
    """Node of a site over a span.

    The prime meridian's angle W enters as the cubic that interpolates it at four Chebyshev
    points of the span: to 1 mm of position over 30 sols (tests), and over any span to the sum
    of W's fast periodic terms, 6e-6 rad or 20 m.
    """
    half = 0.5 * duration
    cubic = Chebyshev.interpolate(
        lambda x: prime_meridian_angle(epoch, half + half * x) - prime_meridian_angle(epoch, half),
        3,
    )
    coefficients = np.zeros(4)
    power = cubic.convert(kind=Polynomial).coef
    coefficients[: power.size] = power
    coefficients[0] += np.mod(prime_meridian_angle(epoch, half), 2 * np.pi)
    row = np.zeros(WIDTH)
    x, y, z = site.r_mcmf
    up = site.enu_mcmf[2]
    row[:4] = SITE, np.hypot(x, y), z, site.longitude
    row[4:6] = up @ [np.cos(site.longitude), np.sin(site.longitude), 0.0], up[2]
    row[6:8] = half, half
    row[8:12] = coefficients
    rate = coefficients[1] / half
    return Node(site.name, "station", row, rate, float(np.linalg.norm(site.r_mcmf)), site=site)


def moon_node(name: str, epoch: float, duration: float, model: MoonModel = "precessing") -> Node:
    """Node of Phobos or Deimos (its centre) over a span; see `moon_row`."""
    row = moon_row(name, epoch, 0.5 * duration, model)
    return Node(name.capitalize(), "moon", row, float(row[10]), float(row[1] * (1 - row[2])))


def earth_node(epoch: float, duration: float) -> Node:
    """Node of the Earth's centre over a span."""
    return _tabulated("Earth", "earth", epoch, duration)


def sun_node(epoch: float, duration: float) -> Node:
    """Node of the Sun's centre over a span."""
    return _tabulated("Sun", "sun", epoch, duration)


def _tabulated(name: str, kind: NodeKind, epoch: float, duration: float) -> Node:
    """Node interpolated between daily states: to 20 km, for the theory's speeds err by 2 m/s."""
    step = SECONDS_PER_DAY
    count = int(np.ceil(duration / step)) + 1
    sun, earth = sun_earth_mci(epoch, step * np.arange(count))
    return _table_node(name, kind, earth if kind == "earth" else sun, step)


def _table_node(name: str, kind: NodeKind, states: NDArray[np.float64], step: float) -> Node:
    """Node of states that are `step` seconds apart, the first at the epoch."""
    p, v = states[:, :3], states[:, 3:]
    jump = 6.0 * np.diff(p, axis=0) / step
    # the acceleration of a cubic is linear: largest at one of its ends
    at_left = (jump - 4.0 * v[:-1] - 2.0 * v[1:]) / step
    at_right = (2.0 * v[:-1] + 4.0 * v[1:] - jump) / step
    acceleration = np.linalg.norm(np.concatenate([at_left, at_right]), axis=1).max()
    speed = np.linalg.norm(v, axis=1).max() + acceleration * step
    distance = np.linalg.norm(p, axis=1)
    # between rows a distance is off the line through its ends by less than its bend h^2 / 8
    near = distance.min() - 0.5 * speed * step
    swing = 0.125 * (acceleration + speed**2 / max(near, 1.0)) * step**2
    low, high = max(distance.min() - swing, near), distance.max() + swing
    row = np.zeros(WIDTH)
    row[:5] = TABLE, 0.0, len(states), 0.0, step
    row[5:9] = low, high, speed, acceleration
    return Node(name=name, kind=kind, row=row, rate=speed / low, lowest=low, states=states)


def find_node(nodes: Sequence[Node], name: str) -> Node:
    """Return the node of that name.

    Raises
    ------
    ArgumentError
        There is none.
    """
    for node in nodes:
        if node.name == name:
            return node
    known = [node.name for node in nodes]
    guess = meant(name, known)
    raise ArgumentError(f"node {name!r}: unknown; {guess}there are {', '.join(known)}")
