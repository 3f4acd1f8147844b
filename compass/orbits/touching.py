"""Ellipses that touch real orbits at a moment: what flies for the hours about it."""

from compass.frames import mci_from_icrf
from compass.orbits.constellation import Constellation
from compass.orbits.motion import Motion
from compass.orbits.states import from_states

#: Seconds past the moment to which a path must reach: a table may end there.
AFTER = 1.0


def touching(constellation: Constellation, motion: Motion, start: float) -> Constellation:
    """Osculating ellipses at a moment, which is their epoch.

    An hour on, at areosynchronous radius, the flattening of Mars has moved a satellite off its
    ellipse by 60 m: half of 9e-6 m/s^2 times the time squared.

    Parameters
    ----------
    constellation, motion
        What moves, and how.
    start
        Seconds after the epoch; 0 gives the elements themselves under a motion of elements.

    Raises
    ------
    ArgumentError
        A moment outside what is known.
    """
    c = constellation
    if motion.is_closed_form and start == 0.0:
        return c
    path = motion.trajectory(c, start, start + AFTER)
    r, v = (a[:, 0] for a in path.states([start]))
    # the frame of another moment is another one: the pole precesses
    turn = mci_from_icrf(c.epoch + start) @ mci_from_icrf(c.epoch).T
    return from_states(
        r @ turn.T,
        v @ turn.T,
        name=c.name,
        epoch=c.epoch + start,
        satellite_names=c.satellite_names,
        gm=c.gm if motion.forces is None else motion.forces.field.gm,
    )
