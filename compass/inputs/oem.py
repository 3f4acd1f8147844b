"""CCSDS Orbit Ephemeris Messages: other people's orbits, as trajectories."""

import math
import re
import warnings
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from glob import glob
from pathlib import Path

import erfa
import numpy as np
from numpy.typing import NDArray

from compass.errors import DesignError
from compass.frames import SECONDS_PER_DAY, mci_from_icrf
from compass.orbits.tables import from_tables
from compass.orbits.trajectory import Trajectory
from compass.words import counted

#: Frames that are read, all but turned alike: EME2000 is 0.02 arc seconds from the ICRF.
FRAMES = ("ICRF", "EME2000", "GCRF")
TIME_SYSTEMS = ("TDB", "UTC", "TAI", "TT")

#: Highest interpolation degree that is followed.
MOST_DEGREE = 15

#: Distances that a satellite of Mars can have, km: from its poles to well beyond where its pull
#: rules over the Sun's, 577,000 km. Other units fall outside.
NEAREST_KM, FARTHEST_KM = 3300.0, 1e6

#: A date of CCSDS, of a month or of a year's day.
_DATE = re.compile(r"\d{4}-(\d{2}-\d{2}|\d{3})T\d{2}:\d{2}:\d{2}(\.\d*)?Z?", re.ASCII)

#: Bytes that a file may have: ten years of one satellite each minute.
MOST_BYTES = 600_000_000


@dataclass(frozen=True)
class Message:
    """What one message holds: one object, one unbroken table.

    Attributes
    ----------
    name
        The object's.
    times
        TDB seconds past J2000, increasing, shape (t,).
    states
        Position and velocity in the ICRF about Mars, m and m/s, shape (t, 6).
    degree
        Of the interpolation that the message asks for.
    label
        The file's name.
    """

    name: str
    times: NDArray[np.float64]
    states: NDArray[np.float64]
    degree: int
    label: str


def read_ephemerides(patterns: list[str], folder: Path, epoch: float | None) -> Trajectory:
    """Trajectory of the satellites of all files, over the time that all of them cover.

    Parameters
    ----------
    patterns
        File names, or patterns such as ``*.oem``, relative to `folder`.
    folder
        Where the design is.
    epoch
        TDB seconds past J2000 that count as time 0; the first common moment if None.

    Raises
    ------
    DesignError
        No file, a file that cannot be used, a name used twice, no common span.
    """
    paths = []
    for pattern in patterns:
        files = sorted(glob(str(folder / pattern)))
        if not files:
            raise DesignError(f"constellation.files: {pattern!r} matches no file in {folder}")
        paths += [Path(name) for name in files]
    messages = [read_oem(path) for path in dict.fromkeys(paths)]
    names = [message.name for message in messages]
    for name in names:
        if names.count(name) > 1:
            raise DesignError(
                f"constellation.files: object {name!r} is in {names.count(name)} files; "
                "one message an object"
            )
    start = max(float(message.times[0]) for message in messages)
    stop = min(float(message.times[-1]) for message in messages)
    if stop <= start:
        raise DesignError("constellation.files: there is no time that all files cover")
    zero = start if epoch is None else epoch
    if not start <= zero < stop:
        raise DesignError(
            f"epoch: {(zero - start) / SECONDS_PER_DAY:.6g} days after the first moment that all "
            f"files cover; allowed 0 to {(stop - start) / SECONDS_PER_DAY:.6g}; leave the epoch out"
        )
    turn = mci_from_icrf(zero).T
    return from_tables(
        [message.times - zero for message in messages],
        [
            np.concatenate([m.states[:, :3] @ turn, m.states[:, 3:] @ turn], axis=1)
            for m in messages
        ],
        [message.degree for message in messages],
        epoch=zero,
        satellite_names=names,
        source=f"ephemerides of {counted(len(messages), 'file')}",
    )


def read_oem(path: Path) -> Message:
    """Read one message in KVN; several segments of one object must join without a gap.

    Raises
    ------
    DesignError
        Another format, centre, frame, time system or interpolation; too few states; times that do
        not increase or leave a gap.
    """
    try:
        if path.stat().st_size > MOST_BYTES:
            raise DesignError(f"{path}: over {MOST_BYTES / 1e6:.0f} MB; split the ephemeris")
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise DesignError(f"{path}: cannot be read: {error}") from error
    if "CCSDS_OEM_VERS" not in text[:2000]:
        raise DesignError(
            f"{path}: is no CCSDS OEM in KVN (it would begin with CCSDS_OEM_VERS); convert it"
        )
    heads, rows, starts = _segments(text, path)
    for head in heads:
        _check_head(head, path)
    if len({head["OBJECT_NAME"] for head in heads}) > 1:
        raise DesignError(f"{path}: holds several objects; write one message an object")
    for key in ("TIME_SYSTEM", "INTERPOLATION_DEGREE"):
        told = {head.get(key, "").upper() for head in heads}
        if len(told) > 1:
            raise DesignError(
                f"{path}: {key} = {', '.join(sorted(told))}: segments differ; allowed one for all"
            )
    times = _seconds([row[0] for row in rows], heads[0]["TIME_SYSTEM"].upper(), path)
    times, states = _joined(times, _numbers(rows, path), starts, path)
    degree = int(heads[0].get("INTERPOLATION_DEGREE", 7))
    points = degree // 2 + 1
    if len(times) < 2 * points:
        raise DesignError(
            f"{path}: {len(times)} states; interpolation of degree {degree}, and an estimate of "
            f"its error, need {2 * points} or more"
        )
    return Message(heads[0]["OBJECT_NAME"], times, states * 1e3, degree, path.name)


def _segments(text: str, path: Path) -> tuple[list[dict[str, str]], list[list[str]], list[int]]:
    """Heads of the segments, all their rows, and where each segment begins."""
    heads: list[dict[str, str]] = []
    rows: list[list[str]] = []
    starts: list[int] = []
    place = "header"
    for line in text.splitlines():
        words = line.split()
        if not words or words[0] == "COMMENT":
            continue
        if words[0] == "META_START":
            place = "meta"
            heads.append({})
            starts.append(len(rows))
        elif words[0] == "META_STOP":
            place = "data"
        elif words[0] == "COVARIANCE_START":
            place = "covariance"
        elif words[0] == "COVARIANCE_STOP":
            place = "data"
        elif place == "meta":
            key, _, value = line.partition("=")
            heads[-1][key.strip()] = value.strip()
        elif place == "data":
            rows.append(words)
    if not heads or not rows:
        raise DesignError(f"{path}: has no META_START ... META_STOP with states after it")
    return heads, rows, starts


def _numbers(rows: list[list[str]], path: Path) -> NDArray[np.float64]:
    """Positions, km, and velocities, km/s, of rows, shape (t, 6)."""
    states = np.full((len(rows), 6), np.nan)
    for state, row in zip(states, rows, strict=True):
        with suppress(ValueError):  # not six, or no numbers: stays nan
            state[:] = [float(x) for x in row[1:7]]
    for k in np.flatnonzero(~np.isfinite(states).all(axis=1))[:1]:
        raise DesignError(
            f"{path}: state {k + 1}, {' '.join(rows[k])[:80]!r}: needs a date and six finite "
            "numbers, km and km/s"
        )
    distance = np.linalg.norm(states[:, :3], axis=1)
    for k in np.flatnonzero((distance < NEAREST_KM) | (distance > FARTHEST_KM))[:1]:
        raise DesignError(
            f"{path}: state {k + 1} is {distance[k]:.6g} km from the centre of Mars; allowed "
            f"{NEAREST_KM:g} to {FARTHEST_KM:g}; check the units, km and km/s"
        )
    return states


def _check_head(head: dict[str, str], path: Path) -> None:
    allowed = {
        "CENTER_NAME": ("MARS",),
        "REF_FRAME": FRAMES,
        "TIME_SYSTEM": TIME_SYSTEMS,
        "INTERPOLATION": ("HERMITE", "LAGRANGE"),
    }
    for key, values in allowed.items():
        given = head.get(key, "HERMITE" if key == "INTERPOLATION" else "")
        if given.upper() not in values:
            shown = given or "missing"
            raise DesignError(f"{path}: {key} = {shown}: allowed {', '.join(values)}")
    if not head.get("OBJECT_NAME"):
        raise DesignError(f"{path}: OBJECT_NAME: missing; name the satellite")
    degree = head.get("INTERPOLATION_DEGREE", "7")
    if not degree.isdigit() or not 1 <= int(degree) <= MOST_DEGREE:
        raise DesignError(f"{path}: INTERPOLATION_DEGREE = {degree}: allowed 1 to {MOST_DEGREE}")


def _seconds(dates: list[str], system: str, path: Path) -> NDArray[np.float64]:
    """TDB seconds past J2000 of dates; years 1900 to 2100."""
    for k, date in enumerate(dates):
        if not _DATE.fullmatch(date):
            raise DesignError(
                f"{path}: state {k + 1}, {date[:40]!r}: a date that cannot be read; write for "
                "example 2030-01-31T12:00:00.000 or 2030-031T12:00:00.000, without a time zone"
            )
    try:
        stamps = np.array(
            [
                datetime.strptime(date[:4] + date[5:8], "%Y%j").strftime("%Y-%m-%d") + date[8:]
                if len(date) > 8 and date[8] == "T"
                else date
                for date in (text.rstrip("Z") for text in dates)
            ],
            dtype="datetime64[ns]",
        )
    except ValueError as error:
        raise DesignError(f"{path}: a date that cannot be read: {error}") from error
    seconds = (stamps - np.datetime64("2000-01-01T12:00:00", "ns")) / np.timedelta64(1, "s")
    if system == "TDB":
        return np.asarray(seconds, dtype=float)
    days = np.asarray(seconds, dtype=float) / SECONDS_PER_DAY
    if system == "UTC":
        with warnings.catch_warnings():
            # leap seconds past those announced are not known; none is assumed
            warnings.simplefilter("ignore", erfa.ErfaWarning)
            tai = erfa.utctai(2451545.0, days)
    else:
        tai = erfa.tttai(2451545.0, days) if system == "TT" else (2451545.0, days)
    tt = erfa.taitt(*tai)
    # TDB - TT is below 2 ms: at the speed of 3 km/s some metres, so it is counted
    tdb = erfa.tttdb(*tt, erfa.dtdb(*tt, 0.0, 0.0, 0.0, 0.0))
    whole, part = np.broadcast_arrays(*tdb)
    return ((whole - 2451545.0) + part) * SECONDS_PER_DAY


def _joined(
    times: NDArray[np.float64], states: NDArray[np.float64], starts: list[int], path: Path
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """One table of the segments: each must begin where the last one ended, or a step after."""
    keep = np.ones(len(times), dtype=bool)
    for first in starts[1:]:
        keep[first] = times[first] > times[first - 1] + 1e-6
    times, states = times[keep], states[keep]
    steps = np.diff(times)
    if steps.size and steps.min() <= 0.0:
        k = int(np.argmin(steps))
        raise DesignError(f"{path}: state {k + 2} is not later than the one before; sort the times")
    if steps.size and steps.max() > 3.0 * float(np.median(steps)):
        k = int(np.argmax(steps))
        gap = steps[k] / 60.0
        raise DesignError(
            f"{path}: a gap of {gap:.6g} min after state {k + 1}, {times[k]:.0f} TDB s past J2000; "
            f"steps are {math.floor(float(np.median(steps)) / 6) / 10:g} min; fill it, or give two "
            "files and two designs"
        )
    return times, states
