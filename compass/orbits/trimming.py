"""Trimming: initial semi-major axes with which all satellites advance at one mean rate.

Equal osculating axes are unequal mean ones: J2 alone sets the axes of a 20,000 km orbit apart by
0.8 km with the argument of latitude, 0.02 degrees a day along the track. What is made equal here is
the mean rate of the angle turned in the orbit's own plane, ``theta' = h / r^2``, which is that of
the argument of latitude plus cos(i) times that of the node. Orbits whose axes J2 does not set apart
are meant to differ: each kind is trimmed to its own mean.

The trap is the fit of that rate. Near a resonance with Mars's rotation one term of the field, J22
where they keep pace, swings theta by degrees with a beat of weeks, and a plain line over a month
errs by a tenth of a degree a day. So the line is fitted over the whole horizon asked for, never
less than four beats, with a Hann window, whose response to a swing of m beats in the horizon falls
as m^-3.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import gcd
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from compass.bodies import MARS_J2, MARS_J2_RADIUS, MARS_ROTATION_RATE
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY
from compass.orbits.constellation import Constellation
from compass.orbits.forces import ForceModel
from compass.orbits.gravity import GravityField
from compass.orbits.motion import Motion
from compass.orbits.period import secular_rates
from compass.orbits.resonance import slow_pushes
from compass.orbits.trajectory import COARSE, Trajectory

#: Corrections of the axes at most, and beats that the horizon must hold.
ROUNDS, BEATS = 4, 4.0

#: Share of the excursion below which what the rates part by in the horizon is left alone.
GOOD = 0.05

#: Longest horizon that is followed for a trim, s: two Mars years.
LONGEST = 1400.0 * SECONDS_PER_DAY

#: Swing, radians, that rounding alone makes of a field that has no such term.
ROUNDING = 1e-12

#: A term with too long a beat to be fitted, which swings a satellite by less in all that time than
#: this, radians, is let be. Eccentricity above which the law of circular orbits is not asked.
SLIGHT, OVAL = np.radians(0.05), 0.05


@dataclass(frozen=True)
class Beat:
    """The term of Mars's field that swings satellites furthest along their tracks.

    Attributes
    ----------
    period
        Of the swing, s: long near a resonance.
    revolutions, rotations
        Whose numbers are equal in time at that resonance: of a satellite, of Mars.
    """

    period: float
    revolutions: int = 1
    rotations: int = 1

    @property
    def ratio(self) -> str:
        """The resonance, such as 2:1 for two revolutions in a rotation."""
        return f"{self.revolutions}:{self.rotations}"


@dataclass(frozen=True)
class Trim:
    """Trimmed elements and what they achieve.

    Attributes
    ----------
    constellation
        The same elements but for the osculating semi-major axes.
    shift
        Change of each axis, m, shape (n,).
    horizon
        Over which rates were fitted, s.
    beat
        Period of the swing under the term of the field that moves satellites most, s.
    spread_before, spread
        Largest difference between mean rates of one kind of orbit, rad/s; what is left is how
        well they agree.
    excursion_before, excursion
        Furthest any satellite runs ahead of or behind the mean of its kind in the horizon, radians.
    """

    constellation: Constellation
    shift: NDArray[np.float64]
    horizon: float
    beat: float
    spread_before: float
    spread: float
    excursion_before: float
    excursion: float


def trim(
    constellation: Constellation,
    forces: ForceModel,
    horizon: float,
    *,
    progress: Callable[[Sequence[Any]], Any] = iter,
) -> Trim:
    """Choose initial semi-major axes so that mean rates agree over a horizon.

    Newton's method on each axis (``d rate / da = -3/2 n / a``); of the corrections tried, the one
    with the least excursion is kept, so that the result is never worse than what was given.

    Parameters
    ----------
    constellation
        Osculating elements at the epoch.
    forces
        What acts.
    horizon
        Seconds to be good for.
    progress
        Wraps the list of corrections, as tqdm does.

    Raises
    ------
    ArgumentError
        No two orbits of one period; one so near the resonance that its beat is longer than can be
        fitted.
    """
    c = constellation
    beat = _beat(c, forces)
    span = float(np.clip(horizon, BEATS * beat, LONGEST))
    before, best = _fit(c, c, forces, span, progress)
    return Trim(
        constellation=best.constellation,
        shift=best.constellation.semi_major_axis - c.semi_major_axis,
        horizon=span,
        beat=beat,
        spread_before=before.spread,
        spread=best.spread,
        excursion_before=before.excursion,
        excursion=best.excursion,
    )


def trimmed_path(constellation: Constellation, forces: ForceModel, horizon: float) -> Trajectory:
    """Paths of trimmed orbits for a horizon, to `COARSE`, without asking how it was before.

    The trim begins with what J2 alone asks for, which spares most corrections.

    Parameters and errors as in `trim`.
    """
    c = constellation
    span = float(np.clip(horizon, BEATS * _beat(c, forces), LONGEST))
    _, best = _fit(c, _by_oblateness(c), forces, span, iter)
    if horizon <= span:
        return best.path
    return Motion("numerical", forces).trajectory(
        best.constellation, 0.0, horizon, tolerance=COARSE
    )


@dataclass(frozen=True)
class _Fit:
    """Axes that were tried, and how well rates agree with them."""

    constellation: Constellation
    path: Trajectory
    spread: float
    excursion: float


def _fit(
    c: Constellation,
    trial: Constellation,
    forces: ForceModel,
    span: float,
    progress: Callable[[Sequence[Any]], Any],
) -> tuple[_Fit, _Fit]:
    """Correct axes from those of a trial on: what that did, and the best of all tried."""
    kinds, fits = kinds_of(c), list[_Fit]()
    for _ in progress(list(range(ROUNDS + 1))):
        path = Motion("numerical", forces).trajectory(trial, 0.0, span, tolerance=COARSE)
        times, theta = turned(path)
        rates = mean_rates(times, theta)
        excursion = float(excursions(theta, kinds).max(initial=0.0))
        spreads = (float(np.ptp(rates[kinds == kind])) for kind in np.unique(kinds))
        now = _Fit(trial, path, max(spreads, default=0.0), excursion)
        first = fits[0] if fits else now
        fits = [first, min([*fits[1:], now], key=lambda fit: fit.excursion)]
        if now.spread * span <= GOOD * excursion:
            break
        step = _from_mean(rates, kinds) / (1.5 * c.mean_motion / c.semi_major_axis)
        trial = with_axes(trial, trial.semi_major_axis + step)
    return fits[0], fits[1]


def _beat(c: Constellation, forces: ForceModel) -> float:
    """Beat of orbits that can be trimmed, s.

    Raises
    ------
    ArgumentError
        They cannot.
    """
    if c.size > 1 and kinds_of(c).max() + 1 == c.size:
        raise ArgumentError(
            "trim: no two satellites have one period, so that there are no rates to make agree; "
            "leave the trim out"
        )
    told = beat_of(c, forces.field)
    if not can_trim(told):
        raise ArgumentError(
            f"trim: the orbits keep pace with Mars, {told.ratio}, to a beat of "
            f"{told.period / SECONDS_PER_DAY:.4g} days: they are in resonance, and no initial axis "
            "keeps them apart; choose a radius some hundred kilometres away, or keep them by burns"
        )
    return told.period


def _by_oblateness(c: Constellation) -> Constellation:
    """Axes that J2 alone asks for: of circles ``3/2 J2 R^2 / a sin^2 i cos 2u`` above the mean."""
    u = c.argument_of_periapsis + c.mean_anomaly
    swing = 1.5 * MARS_J2.value * MARS_J2_RADIUS.value**2 / c.semi_major_axis
    shift = swing * np.sin(c.inclination) ** 2 * np.cos(2.0 * u)
    return with_axes(c, c.semi_major_axis + np.where(c.eccentricity > OVAL, 0.0, shift))


def beat_of(constellation: Constellation, field: GravityField) -> Beat:
    """Beat of the term of a field that swings satellites furthest, in `LONGEST` at most.

    Of circular orbits by `compass.orbits.resonance.slow_pushes`; a term in exact resonance moves a
    satellite by ``3/2 |a_t| / a`` times the time squared. Of oval ones it is that of J22, half the
    synodic period with Mars's rotation.
    """
    c = constellation
    oval = c.eccentricity > OVAL
    node, periapsis, anomaly = secular_rates(c.semi_major_axis, c.eccentricity, c.inclination, c.gm)
    slip = np.abs(node + periapsis + anomaly - MARS_ROTATION_RATE.value)[oval]
    beats = [Beat(float(np.pi / max(slip.min(), 1e-12)))] if slip.size else []
    places = np.column_stack([np.round(c.semi_major_axis, -3), np.round(c.inclination, 4)])[~oval]
    if len(places):
        beats.append(_strongest(field, *np.unique(places, axis=0).T))
    return max(beats, key=lambda beat: beat.period, default=Beat(0.0))


def _strongest(field: GravityField, a: NDArray[np.float64], i: NDArray[np.float64]) -> Beat:
    """Beat of the strongest term along circular orbits of radii, m, and inclinations, radians."""
    slow = slow_pushes(field, a, i)
    period = 2.0 * np.pi / np.maximum(np.abs(slow.rates), 1e-12)
    gone = 1.5 * np.hypot(*np.moveaxis(slow.pushes, -1, 0)) / a[:, None] * LONGEST**2
    swing = np.minimum(slow.swings, gone)
    swing = np.where((BEATS * period > LONGEST) & (swing < SLIGHT), 0.0, swing)
    most = np.unravel_index(int(np.argmax(swing)), swing.shape)
    if swing[most] < ROUNDING:
        return Beat(0.0)
    rotations, revolutions = (int(wave) for wave in slow.waves[most])
    common = gcd(rotations, revolutions)
    return Beat(float(period[most]), revolutions // common, rotations // common)


def can_trim(beat: Beat) -> bool:
    """Whether orbits are far enough from a resonance for their beat to be fitted."""
    return beat.period * BEATS <= LONGEST


def turned(path: Trajectory) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Times of the breaks, and the angles turned in the orbits' planes since, radians, (p + 1, n).

    ``theta = integral of |r x v| / r^2`` by Gauss's rule on every stretch.
    """
    _, weights, rate = angular_rates(path)
    steps = (rate * weights).reshape(path.size, len(path.breaks) - 1, -1).sum(axis=-1)
    start = np.zeros((path.size, 1))
    return path.breaks, np.concatenate([start, np.cumsum(steps, axis=1)], axis=1).T


def angular_rates(
    path: Trajectory,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Gauss nodes of all stretches and their weights, s, (k,), and ``|r x v| / r^2``, (n, k)."""
    nodes, weights = legendre.leggauss(8)
    middle, half = 0.5 * (path.breaks[1:] + path.breaks[:-1]), 0.5 * np.diff(path.breaks)
    times = (middle[:, None] + half[:, None] * nodes).ravel()
    r, v = path.states(times)
    rate = np.linalg.norm(np.cross(r, v), axis=-1) / (r * r).sum(axis=-1)
    return times, (half[:, None] * weights).ravel(), rate


def mean_rates(times: NDArray[np.float64], theta: NDArray[np.float64]) -> NDArray[np.float64]:
    """Slope of a line through angles (t, n) under a Hann window over all times, rad/s, (n,)."""
    x = (times - times[0]) / (times[-1] - times[0]) - 0.5
    # the rows stand closer where steps are shorter: each counts for the time about it
    weight = (1.0 + np.cos(2 * np.pi * x)) * np.gradient(x)
    centred = x - (weight @ x) / weight.sum()
    lever = weight * centred
    slope = lever @ (theta - theta[0]) / (lever @ centred)
    return np.atleast_1d(slope) / (times[-1] - times[0])


def excursions(theta: NDArray[np.float64], kinds: NDArray[np.int64]) -> NDArray[np.float64]:
    """Furthest each satellite runs from the mean of its kind, radians, shape (n,)."""
    return np.asarray(np.abs(_from_mean(theta - theta[0], kinds)).max(axis=0))


def kinds_of(c: Constellation) -> NDArray[np.int64]:
    """Number of the kind of each orbit, shape (n,): axes that J2 cannot tell apart are one kind.

    It sets osculating axes apart by up to ``3 J2 R^2 / a`` from crest to trough; a gap of twice
    that begins another kind.
    """
    order = np.argsort(c.semi_major_axis)
    axes = c.semi_major_axis[order]
    wide = 6.0 * MARS_J2.value * MARS_J2_RADIUS.value**2 / axes[:-1]
    labels = np.zeros(c.size, dtype=np.int64)
    labels[order[1:]] = np.cumsum(np.diff(axes) > wide)
    return labels


def _from_mean(values: NDArray[np.float64], kinds: NDArray[np.int64]) -> NDArray[np.float64]:
    """Values, their last axis the satellites, less the mean of each kind."""
    osculating = np.array(values)
    for kind in np.unique(kinds):
        same = kinds == kind
        osculating[..., same] -= osculating[..., same].mean(axis=-1, keepdims=True)
    return osculating


def with_axes(
    c: Constellation, axes: NDArray[np.float64], gm: float | None = None
) -> Constellation:
    """Return the constellation with other semi-major axes, m, and another GM if given."""
    axes = np.array(axes)
    axes.flags.writeable = False
    return Constellation(
        name=c.name,
        semi_major_axis=axes,
        eccentricity=c.eccentricity,
        inclination=c.inclination,
        raan=c.raan,
        argument_of_periapsis=c.argument_of_periapsis,
        mean_anomaly=c.mean_anomaly,
        epoch=c.epoch,
        satellite_names=c.satellite_names,
        gm=c.gm if gm is None else gm,
    )
