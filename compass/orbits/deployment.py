"""Planes from one launch: waiting where the flattening of Mars turns nodes apart.

A group of satellites is launched into one plane and a circular orbit. Those of other planes go up
(or stay) to a waiting orbit of the same inclination, whose node J2 turns at another rate than the
constellation's, until their plane is reached, and then on to their radius. Against that stands
turning the node by an impulse at once.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.bodies import MARS_GM
from compass.orbits.constellation import Constellation
from compass.orbits.impulses import hohmann, node_change
from compass.orbits.period import secular_rates

#: Waiting orbits that are weighed, between the lowest and the highest.
WEIGHED = 235


@dataclass(frozen=True)
class Plane:
    """How one plane is reached.

    Attributes
    ----------
    node
        East of the plane launched into, radians, 0 up to a whole turn.
    waits
        In every waiting orbit, s, shape (k,); infinite where nodes do not part.
    direct
        Delta-v of one satellite if its node is turned by an impulse at once, m/s.
    """

    node: float
    waits: NDArray[np.float64]
    direct: float


@dataclass(frozen=True)
class Deployment:
    """How long waiting takes and what it costs.

    Attributes
    ----------
    radii
        Of the waiting orbits, m, shape (k,).
    parting
        Rate of a waiting orbit's node less the constellation's, rad/s, shape (k,).
    delta_v
        Of one satellite that waits there, m/s, shape (k,).
    planes
        Those of one launch that are not launched into.
    transfer
        Delta-v of a satellite of the plane launched into, m/s.
    launches, planes_a_launch
        How many, and planes of each.
    """

    radii: NDArray[np.float64]
    parting: NDArray[np.float64]
    delta_v: NDArray[np.float64]
    planes: tuple[Plane, ...]
    transfer: float
    launches: int
    planes_a_launch: int

    @property
    def waits(self) -> NDArray[np.float64]:
        """Until the last plane is reached, s, shape (k,)."""
        if not self.planes:
            return np.zeros(self.radii.size)
        return np.asarray(np.max([plane.waits for plane in self.planes], axis=0))

    def cheapest(self, longest: float) -> int | None:
        """Place of the waiting orbit of least delta-v that takes no longer; None if none does."""
        quick = np.flatnonzero(self.waits <= longest)
        return int(quick[self.delta_v[quick].argmin()]) if quick.size else None


def deploy_by_drift(
    constellation: Constellation, launched: float, waiting: ArrayLike, satellites_a_launch: int
) -> Deployment:
    """Work out waiting times and delta-v of the planes of one launch.

    ``node' = -3/2 n J2 (R/a)^2 cos i`` of both orbits; the planes of a launch stand next to each
    other, and each is waited for in the direction in which the waiting orbit's node goes.

    Parameters
    ----------
    constellation
        Circles of one radius and inclination.
    launched
        Radius of the orbit launched into, m.
    waiting
        Radii of waiting orbits to weigh, m, shape (k,).
    satellites_a_launch
        At least those of one plane.
    """
    c = constellation
    a, i = float(c.semi_major_axis[0]), float(c.inclination[0])
    radii = np.atleast_1d(np.asarray(waiting, dtype=float))
    nodes = np.unique(np.round(np.mod(c.raan, 2 * np.pi), 12))
    each = max(satellites_a_launch // max(c.size // nodes.size, 1), 1)
    each = min(each, nodes.size)
    parting = secular_rates(radii, 0.0, i, c.gm)[0] - secular_rates(a, 0.0, i, c.gm)[0]
    transfer = hohmann(launched, radii, c.gm) + hohmann(radii, a, c.gm)
    straight = float(hohmann(launched, a, c.gm))
    planes = []
    for node in nodes[1:each] - nodes[0]:
        # eastwards by the node itself, westwards by the rest of the turn
        way = np.where(parting > 0.0, node, 2 * np.pi - node)
        with np.errstate(divide="ignore"):
            waits = np.where(parting == 0.0, np.inf, way / np.abs(parting))
        planes.append(Plane(float(node), waits, straight + float(node_change(a, i, node, c.gm))))
    launches = -(-nodes.size // each)
    return Deployment(
        radii=radii,
        parting=parting,
        delta_v=transfer,
        planes=tuple(planes),
        transfer=straight,
        launches=launches,
        planes_a_launch=each,
    )


def cheapest_drift(
    radius: ArrayLike,
    inclination: ArrayLike,
    parting: ArrayLike,
    planes_a_launch: ArrayLike,
    launched: float,
    waiting: ArrayLike,
    longest: float,
    gm: float = MARS_GM.value,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Least delta-v of a satellite that waits, and its wait, for many patterns at once.

    What `deploy_by_drift` finds of each, by its farthest plane alone; nan where no waiting orbit
    brings all planes in time.

    Parameters
    ----------
    radius, inclination
        Of the constellations' circles, m and radians, shape (n,).
    parting
        Between the nodes of neighbouring planes, radians, shape (n,).
    planes_a_launch
        Planes of one launch, shape (n,).
    launched, waiting
        As in `deploy_by_drift`.
    longest
        Until the last plane is reached, s.

    Returns
    -------
    delta_v, wait
        m/s and s, shape (n,).
    """
    each = np.column_stack([radius, inclination, parting, planes_a_launch]).astype(float)
    alike, which = np.unique(each, axis=0, return_inverse=True)  # but for phases and numbers
    a, i, apart, planes = alike.T[:, :, None]
    radii = np.atleast_1d(np.asarray(waiting, dtype=float))[None, :]
    rate = secular_rates(radii, 0.0, i, gm)[0] - secular_rates(a, 0.0, i, gm)[0]
    # eastwards the last plane is the farthest, westwards the first
    way = np.where(rate > 0.0, (planes - 1) * apart, 2 * np.pi - apart)
    with np.errstate(divide="ignore", invalid="ignore"):
        waits = np.where(planes > 1, np.where(rate == 0.0, np.inf, way / np.abs(rate)), 0.0)
    cost = np.where(waits <= longest, hohmann(launched, radii, gm) + hohmann(radii, a, gm), np.inf)
    best = cost.argmin(axis=1)[:, None]
    cheapest = np.stack([np.take_along_axis(values, best, axis=1) for values in (cost, waits)])
    cheapest = np.where(np.isfinite(cheapest[0]), cheapest, np.nan)[:, which.ravel(), 0]
    return cheapest[0], cheapest[1]
