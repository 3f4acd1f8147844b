"""Along a link: range, range rate, light time, and whether a radio closes it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.bodies import BOLTZMANN, SPEED_OF_LIGHT
from compass.contacts.nodes import Node
from compass.core.motion import states
from compass.links import Radio


@dataclass(frozen=True)
class Track:
    """Geometry of a link at some times, each array of shape (t,).

    Attributes
    ----------
    time
        Seconds after the epoch.
    distance
        Metres, at one time for both ends.
    range_rate
        m/s, positive when receding.
    light_time
        Distance over the speed of light, seconds.
    """

    time: NDArray[np.float64]
    distance: NDArray[np.float64]
    range_rate: NDArray[np.float64]
    light_time: NDArray[np.float64]


def node_states(node: Node, times: ArrayLike) -> NDArray[np.float64]:
    """Inertial states of a node, shape (t, 6), m and m/s, at seconds after the epoch."""
    table = node.states if len(node.states) else np.zeros((1, 6))
    moved: NDArray[np.float64] = states(node.row, table, np.atleast_1d(np.asarray(times, float)))
    return moved


def track(one: Node, two: Node, times: ArrayLike) -> Track:
    """Range, range rate and light time between two nodes."""
    seconds = np.atleast_1d(np.asarray(times, dtype=float))
    relative = node_states(two, seconds) - node_states(one, seconds)
    d, v = relative[:, :3], relative[:, 3:]
    distance = np.linalg.norm(d, axis=1)
    return Track(seconds, distance, (d * v).sum(axis=1) / distance, distance / SPEED_OF_LIGHT.value)


def free_space_loss(distance: ArrayLike, frequency: float) -> NDArray[np.float64]:
    """Free-space loss ``20 log10(4 pi d f / c)``, dB, at metres and Hz."""
    return 20 * np.log10(
        4 * np.pi * np.asarray(distance, dtype=float) * frequency / SPEED_OF_LIGHT.value
    )


def carrier_to_noise(radio: Radio, distance: ArrayLike) -> NDArray[np.float64]:
    """Carrier to noise density ``C/N0 = EIRP - L + G/T - 10 log10 k``, dB Hz, at metres.

    Free space only: pointing, polarisation and atmospheric losses belong into EIRP or G/T.

    References
    ----------
    Maral and Bousquet 2009, Satellite Communications Systems, 5th ed., section 5.6.
    """
    noise = 10 * np.log10(BOLTZMANN.value)
    return radio.eirp - free_space_loss(distance, radio.frequency) + radio.figure_of_merit - noise
