"""CCSDS Orbit Ephemeris Messages: states that flight dynamics programs read."""

import re
import textwrap
import unicodedata

import numpy as np
from numpy.typing import NDArray

import compass
from compass.design import Design
from compass.frames import mci_from_icrf
from compass.handover.instants import iso, tdb
from compass.orbits import states_mci
from compass.orbits.motion import AnyMotion, as_motion
from compass.words import counted

#: Highest degree of the interpolation that readers are told to use.
DEGREE = 7

_LONGEST_NAME = 200  # of the 254 characters that a line may have
_STATE = "%s %.6f %.6f %.6f %.9f %.9f %.9f"  # km to the millimetre, km/s to the micrometre


def oem(
    design: Design,
    times: NDArray[np.float64],
    motion: AnyMotion = "two-body",
    created: np.datetime64 | None = None,
) -> dict[str, str]:
    """Ephemerides as OEM 2.0 in KVN, ICRF axes about Mars, TDB: file names and their text.

    One message a satellite, for the standard (5.1.3) lets a message be of one object only.
    Inertial Mars axes of the epoch are turned to ICRF by the transpose of
    `frames.mci_from_icrf`; the ICRF is known to other programs, Mars's equator of a date is not.
    Text outside printable ASCII, which the format does not allow, is written as escapes.

    Parameters
    ----------
    design
        What to export.
    times
        Seconds after the epoch, increasing, shape (t,).
    motion
        As in `orbits.states_mci`.
    created
        Date of creation, UTC; now if left out.

    References
    ----------
    CCSDS 502.0-B-2, Orbit Data Messages, sections 5 and 7.
    """
    c = design.constellation
    to_icrf = mci_from_icrf(c.epoch)
    r, v = states_mci(c, times, motion)
    states = np.concatenate([r @ to_icrf, v @ to_icrf], axis=-1) / 1e3
    dates = iso(tdb(c.epoch, times))
    stamp = np.datetime64("now") if created is None else created
    moved = as_motion(motion)
    gm = c.gm if moved.forces is None else moved.forces.field.gm
    remarks = [
        f"{design.name}: {counted(c.size, 'satellite')}",
        f"Motion: {moved.title}, GM = {gm!r} m^3/s^2",
    ]
    if design.source:
        remarks.append(f"Source: {design.source}")
    table = "\n".join([_STATE] * times.size)
    digits = len(str(c.size))
    messages = {}
    for k, name in enumerate(c.satellite_names):
        rows: list[object] = [None] * (7 * times.size)
        rows[::7] = dates
        for column in range(6):
            rows[column + 1 :: 7] = states[k, :, column].tolist()
        lines = [
            "CCSDS_OEM_VERS = 2.0",
            *(line for remark in remarks for line in _comment(remark)),
            f"CREATION_DATE = {np.datetime_as_string(stamp, unit='s')}",
            f"ORIGINATOR = COMPASS {compass.__version__}",
            "",
            "META_START",
            f"OBJECT_NAME = {_printable(name)[:_LONGEST_NAME].strip() or 'UNNAMED'}",
            f"OBJECT_ID = SATELLITE-{k + 1:05d}",
            "CENTER_NAME = MARS",
            "REF_FRAME = ICRF",
            "TIME_SYSTEM = TDB",
            f"START_TIME = {dates[0]}",
            f"STOP_TIME = {dates[-1]}",
            "INTERPOLATION = HERMITE",
            f"INTERPOLATION_DEGREE = {min(DEGREE, 2 * times.size - 1)}",
            "META_STOP",
            "",
            table % tuple(rows),
            "",
        ]
        stem = re.sub(r"[^A-Za-z0-9._-]+", "_", _printable(name))[:60]
        messages[f"{k + 1:0{digits}d}-{stem}.oem"] = "\n".join(lines)
    return messages


def _comment(text: str) -> list[str]:
    """COMMENT lines of a text, wrapped."""
    return [f"COMMENT {line}" for line in textwrap.wrap(_printable(text), 90)]


def _printable(text: str) -> str:
    """Text as one line of printable ASCII: accents dropped, other characters escaped."""
    plain = unicodedata.normalize("NFKD", " ".join(text.split()))
    bare = (mark for mark in plain if not unicodedata.combining(mark))
    return "".join(mark if " " <= mark <= "~" else ascii(mark)[1:-1] for mark in bare)
