"""When the samples of an exported ephemeris are, and how to write those instants down."""

import numpy as np
from numpy.typing import NDArray

from compass.errors import ArgumentError
from compass.orbits import Constellation, repeat_period
from compass.words import counted

#: Samples in the time of one turn at the fastest satellite's rate at periapsis. One step is then
#: 2.4 degrees: interpolation of degree 7 between the samples errs by less than a millimetre.
STEPS_A_TURN = 150

#: An export of more states than this is refused; as OEM it would be a quarter of a gigabyte.
MOST_STATES = 2_000_000

LONGEST_HOURS = 87_600.0

_J2000 = np.datetime64("2000-01-01T12:00:00.000000")
_LAST = np.datetime64("9999-12-31T23:59:59.999999")
_TT_MINUS_TAI = np.timedelta64(32_184_000, "us")
# The dates from which UTC is one second further behind TAI, 10 s on the first (IERS Bulletin C).
_LEAPS = np.array(
    [
        "1972-01-01", "1972-07-01", "1973-01-01", "1974-01-01", "1975-01-01", "1976-01-01",
        "1977-01-01", "1978-01-01", "1979-01-01", "1980-01-01", "1981-07-01", "1982-07-01",
        "1983-07-01", "1985-07-01", "1988-01-01", "1990-01-01", "1991-01-01", "1992-07-01",
        "1993-07-01", "1994-07-01", "1996-01-01", "1997-07-01", "1999-01-01", "2006-01-01",
        "2009-01-01", "2012-07-01", "2015-07-01", "2017-01-01",
    ],
    dtype="datetime64[us]",
)  # fmt: skip


def sample_times(
    constellation: Constellation,
    duration_h: float | None = None,
    step_s: float | None = None,
    start: float = 0.0,
) -> NDArray[np.float64]:
    """Seconds after the epoch from `start` for the duration, both included, whole microseconds.

    Parameters
    ----------
    constellation
        The orbits.
    duration_h
        Hours; by default until the ground tracks repeat.
    step_s
        Seconds between samples (the last step may be shorter); by default `STEPS_A_TURN`
        samples in the time of a turn at the fastest satellite's rate at periapsis,
        ``n sqrt(1 + e) / (1 - e)^(3/2)``, whole seconds.
    start
        Seconds after the epoch of the first one.

    Raises
    ------
    ArgumentError
        A duration or a step out of range, too many states, or an end after the year 9999.
    """
    if duration_h is not None and not 0 < duration_h <= LONGEST_HOURS:
        raise ArgumentError(
            f"duration_h = {duration_h:g}: must be above 0 and at most {LONGEST_HOURS:g}"
        )
    duration = repeat_period(constellation).duration if duration_h is None else duration_h * 3600
    step = min(default_step(constellation), duration) if step_s is None else step_s
    if not 1e-3 <= step <= duration:
        raise ArgumentError(
            f"step_s = {step:g}: must be at least 0.001 and at most the duration, {duration:.7g} s"
        )
    whole = int(np.floor(duration / step * (1 + 1e-12)))
    if (whole + 2) * constellation.size > MOST_STATES:
        least = duration / max(MOST_STATES // constellation.size - 2, 1)
        raise ArgumentError(
            f"step_s = {step:g}: {counted(constellation.size, 'satellite')} over "
            f"{duration / 3600:.6g} h make {(whole + 1) * constellation.size} states, "
            f"more than {MOST_STATES}; take steps from {np.ceil(least):g} s on, or a shorter "
            "duration"
        )
    times = np.round(step * np.arange(whole + 1), 6)
    end = np.round(duration, 6)
    if end - times[-1] >= 1e-3:
        times = np.append(times, end)
    else:
        times[-1] = end
    times = np.round(start + times, 6)
    if tdb(constellation.epoch, times[-1:])[0] > _LAST:
        raise ArgumentError(
            f"duration_h = {duration / 3600:g}: ends after the year 9999, which dates of four "
            "digits cannot say; take an earlier epoch"
        )
    return times


def default_step(constellation: Constellation) -> float:
    """Whole seconds, at least one, between samples close enough for interpolation."""
    e = constellation.eccentricity
    fastest = np.max(constellation.mean_motion * np.sqrt(1 + e) / (1 - e) ** 1.5)
    return max(1.0, float(np.floor(2 * np.pi / fastest / STEPS_A_TURN)))


def tdb(epoch: float, times: NDArray[np.float64]) -> NDArray[np.datetime64]:
    """Dates in TDB to the microsecond, of seconds `times` after an epoch past J2000."""
    start = _J2000 + np.timedelta64(round(epoch * 1e6), "us")
    return start + np.round(times * 1e6).astype("timedelta64[us]")


def utc(epoch: float, times: NDArray[np.float64]) -> NDArray[np.datetime64]:
    """Dates in UTC, to the 2 ms by which TDB swings about terrestrial time.

    No leap second is known after 2017, so 37 s stay; before 1972 the difference of that year,
    10 s, is kept. A leap second itself reads as the second after it.

    References
    ----------
    IERS Bulletin C; terrestrial time is TAI + 32.184 s (IAU 1991, recommendation IV).
    """
    tai = tdb(epoch, times) - _TT_MINUS_TAI
    ranks = np.arange(_LEAPS.size) + 10
    reached = np.searchsorted(_LEAPS + ranks.astype("timedelta64[s]"), tai, side="right")
    return tai - np.maximum(9 + reached, 10).astype("timedelta64[s]")


def iso(dates: NDArray[np.datetime64]) -> list[str]:
    """Dates as ISO 8601 with six decimals and no time zone."""
    return [str(text) for text in np.datetime_as_string(dates, unit="us")]
