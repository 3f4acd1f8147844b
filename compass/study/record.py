"""What a line of a store says: a batch of candidates through a stage, and whose it is.

A line is the CRC-32 of a JSON object, a space, the object. It is read like any file that a user
may have had in hand: one that says anything that no run of the study writes is damaged, however
good its checksum, and its candidates are computed again.
"""

import json
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

import compass
from compass.inputs.study import Study
from compass.study.candidates import PATTERNS, ROW, Members
from compass.study.stages import FINDERS, Found, figures_of

FORMAT = 6

_COUNTS = ("satellites", "planes", "phasing")


class DamagedError(ValueError):
    """A line that no run of the study has written; says why."""


@dataclass(frozen=True)
class Batch:
    """A stored batch: its stage, its candidates (of dtype `ROW`) and what was found of them."""

    stage: str
    rows: NDArray
    found: Found


def mark(study: Study) -> str:
    """Whose a line is: the study and the version of the program that its numbers are from."""
    return f"{study.digest[:32]} {compass.__version__}"


def header(study: Study) -> dict[str, Any]:
    """First line of a store."""
    return {
        "format": FORMAT,
        "version": compass.__version__,
        "study": study.digest,
        "name": study.name,
    }


def batch_record(study: Study, stage: str, rows: NDArray, found: Found) -> dict[str, Any]:
    """What is kept of a batch, as plain values."""
    columns: dict[str, Any] = {name: rows[name].tolist() for name in ROW.names or ()}
    columns["pattern"] = [PATTERNS[code] for code in columns["pattern"]]
    return {
        "of": mark(study),
        "stage": stage,
        "candidates": columns,
        "figures": {name: _plain(values) for name, values in found.figures.items()},
        "errors": {str(k): text for k, text in found.errors.items()},
        "seconds": round(found.seconds, 6),
    }


def _plain(values: NDArray[np.float64]) -> list[float | str | None]:
    """Values for JSON, which has neither nan (null) nor infinity (a word)."""
    plain = values.astype(object)
    plain[np.isnan(values)] = None
    plain[np.isposinf(values)], plain[np.isneginf(values)] = "inf", "-inf"
    return list(plain)


def as_line(record: dict[str, Any]) -> bytes:
    """A line of an object."""
    text = json.dumps(record, allow_nan=False, separators=(",", ":")).encode()
    return b"%08x %s\n" % (crc32(text), text)


def from_line(line: bytes) -> dict[str, Any]:
    """The object of a line.

    Raises
    ------
    DamagedError
        It is torn or spoilt, or holds no JSON object.
    """
    checksum, _, text = line[:-1].partition(b" ")
    if not line.endswith(b"\n") or checksum != b"%08x" % crc32(text):
        raise DamagedError("torn or spoilt")
    try:
        loads = json.loads(text, parse_constant=_no_number)
    except (ValueError, RecursionError) as error:
        raise DamagedError("no JSON") from error
    return _is(loads, dict, "the line")


def batch_of(record: dict[str, Any], study: Study, members: Members) -> Batch:
    """A batch of a store's line.

    Parameters
    ----------
    record
        Of `from_line`.
    study, members
        Whose it must be, and the candidates that it may have.

    Raises
    ------
    DamagedError
        It says something that no run of the study writes.
    """
    known = ("of", "stage", "candidates", "figures", "errors", "seconds")
    if set(record) != set(known):
        raise DamagedError(f"keys {_some(record)}: must be {', '.join(known)}")
    if record["of"] != mark(study):
        raise DamagedError("of another study, or of another version")
    stage = record["stage"]
    if type(stage) is not str or stage not in FINDERS:
        raise DamagedError(f"stage = {stage!r:.40}: must be one of {', '.join(FINDERS)}")
    rows = _rows(_is(record["candidates"], dict, "candidates"))
    if not members.have(rows).all():
        raise DamagedError("a candidate that the study does not have")
    figures = _is(record["figures"], dict, "figures")
    if set(figures) != set(figures_of(stage, study)):
        raise DamagedError(f"figures {_some(figures)}: must be those of the stage {stage}")
    errors = {}
    for place, text in _is(record["errors"], dict, "errors").items():
        if place not in map(str, range(rows.size)):
            raise DamagedError(f"errors.{place:.20}: no candidate of the batch")
        errors[int(place)] = _is(text, str, f"errors.{place}")
    seconds = float(_numbers([record["seconds"]], 1, "seconds")[0])
    if not 0 <= seconds < np.inf:
        raise DamagedError(f"seconds = {seconds:g}: must be finite and not negative")
    names = figures_of(stage, study)
    values = {name: _numbers(figures[name], rows.size, f"figures.{name}") for name in names}
    return Batch(stage, rows, Found(values, errors, seconds))


def _rows(columns: dict[str, Any]) -> NDArray:
    """Candidates from their columns."""
    if set(columns) != set(ROW.names or ()):
        raise DamagedError(f"candidates {_some(columns)}: must be {', '.join(ROW.names or ())}")
    size = len(_is(columns["pattern"], list, "candidates.pattern"))
    if not size:
        raise DamagedError("no candidate")
    rows = np.empty(size, ROW)
    for name in ROW.names or ():
        values = _is(columns[name], list, f"candidates.{name}")
        if name == "pattern":
            if not all(type(v) is str and v in PATTERNS for v in values):
                raise DamagedError("candidates.pattern: must be names of patterns")
            rows[name] = [PATTERNS.index(v) for v in values]
            continue
        numbers = _numbers(values, size, f"candidates.{name}")
        most = np.iinfo(ROW[name]).max if name in _COUNTS else np.finfo(float).max
        whole = name not in _COUNTS or set(map(type, values)) == {int}
        if not (whole and np.all((numbers >= 0) & (numbers <= most))):
            raise DamagedError(f"candidates.{name}: must be numbers that a candidate has")
        rows[name] = numbers
    return rows


def _numbers(values: Any, size: int, name: str) -> NDArray[np.float64]:
    """Numbers, null for nan and words for infinities, exactly `size` of them."""
    if len(_is(values, list, name)) != size:
        raise DamagedError(f"{name}: {len(values)} values for {size} candidates")
    words = []
    if not set(map(type, values)) <= {int, float, type(None)}:
        words = [v for v in values if type(v) not in (int, float, type(None))]
        if not all(type(v) is str and v in ("inf", "-inf") for v in words):
            raise DamagedError(f"{name}: must be numbers")
    try:
        found = np.array(values, dtype=float)  # nan of null
    except OverflowError as error:
        raise DamagedError(f"{name}: a number beyond all numbers") from error
    if np.isinf(found).sum() != len(words):
        raise DamagedError(f"{name}: a number beyond all numbers")
    return found


def _no_number(word: str) -> None:
    raise ValueError(word)


def _is(value: Any, kind: type, name: str) -> Any:
    if type(value) is not kind:
        raise DamagedError(f"{name}: must be a {kind.__name__}")
    return value


def _some(names: Iterable[str]) -> str:
    return ", ".join(sorted(names))[:60] or "none"
