"""Where the error of a landing's known place comes from: every source's share in its covariance."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from compass.entry.accuracy import Accuracy
from compass.entry.beacons import Beacons
from compass.entry.covariance import longest_step, problem_of
from compass.entry.filters import Filter
from compass.entry.layout import Part
from compass.entry.schedule import Measurements
from compass.entry.trajectory import Trajectory
from compass.entry.unknowns import range_variances
from compass.entry.views import along_cross_down

Array = NDArray[np.float64]

#: Of a beacon that is known exactly beside others that are not: a filter's block has a state for
#: each, and a covariance without a zero on its diagonal.
EXACT = 1e-6

#: What further blocks are called as sources; that of biases is told by what they come from.
_SOURCES = {
    "air": "density",
    "lift": "lift-to-drag ratio",
    "clock": "receiver's clock",
    "imu": "accelerometers",
    "attitude": "axes of the instruments",
    "gyro": "gyros",
    "frame": "satellites' frame",
}
FIRST, SHAKEN = "first state", "process noise"
RADIO = ("noise of the ranges", "noise of the range rates")


@dataclass(frozen=True)
class Share:
    """What one source leaves of the error of the place at the end of a landing.

    Attributes
    ----------
    name
        Of the source.
    along_cross_down
        One sigma along the ground track, across it and down, m, (3,).
    """

    name: str
    along_cross_down: Array

    @property
    def sigma(self) -> float:
        """One sigma in space, m: the root of the trace."""
        return float(np.linalg.norm(self.along_cross_down))


@dataclass(frozen=True)
class Biased:
    """A filter that counts errors of the ranges to each beacon, and what they come from.

    Attributes
    ----------
    settings
        The filter, with its block of biases.
    variances
        Of each beacon's range by source, m^2, (n,) each; empty for a filter without that block.
    """

    settings: Filter
    variances: dict[str, Array]


def with_satellites(
    settings: Filter,
    satellites: Array | None,
    beacons: Beacons,
    path: Array,
    omega: float,
    *,
    one_way: bool = True,
    turns: Array | None = None,
) -> Biased:
    """Return a filter that considers what satellites' orbits and clocks do to its ranges.

    Errors of broadcast data are constant over an entry, and so a bias of the ranges to each
    satellite, the size of its error along the line of sight. Where the filter has biases of its
    own they grow by as much, and stay as they are: estimated or considered (Schmidt). A turn of
    the frame in which places of satellites are told moves them all alike, and the lander with them.

    Parameters
    ----------
    settings
        The filter.
    satellites
        Covariance of each beacon's radial, along, cross and clock error, m^2, (n, 4, 4); None
        where all are known exactly.
    beacons, path, omega, one_way
        As in `compass.entry.unknowns.range_variances`.
    turns
        One sigma of the turn about each axis of the frame of each beacon, rad, (n,), which those
        share that are not 0; None where nothing is turned.
    """
    if turns is not None and turns.any():
        sigma, told = (float(turns.max()),) * 3, tuple((turns > 0.0).tolist())
        frame = Part("frame", sigma, considered=settings.method != "information", told=told)
        settings = replace(settings, parts=(*settings.parts, frame))
    own = next((part for part in settings.parts if part.name == "bias"), None)
    given = np.zeros((beacons.size, 4, 4)) if satellites is None else satellites
    single = 0.0 if own is None else own.sigma[0]
    variances = range_variances(given, single, beacons, path, omega, one_way=one_way)
    if not variances:
        return Biased(settings, {})
    sigmas = np.maximum(np.sqrt(np.sum(list(variances.values()), axis=0)), EXACT)
    considered = own is None or own.considered
    part = Part("bias", tuple(sigmas.tolist()), considered)
    others = tuple(one for one in settings.parts if one.name != "bias")
    return Biased(replace(settings, parts=(*others, part)), variances)


def landing_budget(
    flight: Trajectory,
    beacons: Beacons,
    taken: NDArray[np.bool_],
    measurements: Measurements,
    biased: Biased,
    at: Accuracy,
) -> tuple[Share, ...]:
    """What every source leaves of the knowledge of the place where a landing is judged.

    The gains are those of the whole; through them each source's covariance goes by itself,
    ``S = (I - K H) S (I - K H)^T + K R_s K^T``, so that squares add up to those of `at`.

    Parameters
    ----------
    flight, beacons, taken, measurements
        As in `compass.entry.assess.assess`; the world is that of the flight.
    biased
        The filter.
    at
        Where the landing is judged.
    """
    from compass.core.entry.shares import shares_run

    settings, layout = biased.settings, biased.settings.layout(beacons.size)
    k = int(np.searchsorted(flight.times, at.time, side="right"))
    times, path = np.append(flight.times[:k], at.time), np.vstack([flight.path[:k], at.path])
    sources, variances, kinds = measurements.heard(beacons, taken, flight.path, flight.model)
    sources = np.concatenate([sources[:k], sources[k - 1 : k]])
    variances = np.concatenate([variances[:k], np.full_like(variances[:1], np.nan)])
    whole = layout.covariance(np.asarray(settings.covariance0, dtype=float))
    starts = _starts(biased, beacons.size, whole)
    if np.any(settings.noise):
        starts[SHAKEN] = np.zeros_like(whole)
    of_kind = [*RADIO]
    for one in (*measurements.radio, *measurements.own):
        of_kind += [f"noise: {one.title}"] * len(one.numbers)
    of_kind = of_kind[: kinds.size]
    for name, column in zip(of_kind, np.moveaxis(variances, 2, 0), strict=True):
        if np.isfinite(column).any():
            starts.setdefault(name, np.zeros_like(whole))
    names = list(starts)
    shares = np.empty((len(names), layout.size, layout.size))
    walked = np.full(layout.size, -1)
    for block, source in (("air", "air"), ("attitude", "gyro")):
        if layout.place(source) >= 0:
            first = layout.place(block)
            walked[first : first + (3 if source == "gyro" else 1)] = names.index(_SOURCES[source])
    heard, longest = (sources, variances, kinds), longest_step(measurements)
    problem = problem_of(flight.model, layout, path, times, heard, settings.noise, longest)
    if SHAKEN not in names:  # no columns, where filters want no rows
        problem = problem._replace(noise=np.empty((times.size, 6, 0)))
    shares_run(
        np.ascontiguousarray(path),
        problem,
        np.stack(list(starts.values())),
        names.index(SHAKEN) if SHAKEN in names else -1,
        walked,
        np.array([names.index(name) if name in names else -1 for name in of_kind]),
        shares,
    )
    axes = along_cross_down(at.path)
    places = (at.surface @ shares[:, :6, :6] @ at.surface.T)[:, :3, :3]
    sigmas = np.sqrt(np.maximum(np.einsum("ia,sab,ib->si", axes, places, axes), 0.0))
    made = [Share(name, sigma) for name, sigma in zip(names, sigmas, strict=True)]
    return tuple(sorted(made, key=lambda share: -share.sigma))


def _starts(biased: Biased, beacons: int, whole: Array) -> dict[str, Array]:
    """What each source leaves at the first time; together the whole covariance, (s, s)."""
    layout = biased.settings.layout(beacons)
    starts = {FIRST: np.zeros_like(whole)}
    starts[FIRST][:6, :6] = whole[:6, :6]
    for part in layout.order:
        place = layout.place(part.name)
        states = range(place, place + layout.count(part))
        if part.name == "bias" and biased.variances:
            for name, variances in biased.variances.items():
                starts[name] = np.zeros_like(whole)
                starts[name][states, states] = variances
        else:
            name = _SOURCES[part.name]
            starts[name] = np.zeros_like(whole)
            starts[name][states, states] = whole[states, states]
    return starts
