"""The durable store of a study: a file to which every finished batch is added at once.

One line a batch: the CRC-32 of a JSON object, a space, the object. A line is one `write`, then
an `fsync`, so after a kill or a power cut the file holds every batch reported as stored and at
most one torn line, which its checksum gives away. Appending never rewrites what is there, which
is why this is neither Parquet nor Zarr: both keep an index (footer, chunk metadata) whose update
and the data's are two writes, and a part file a batch would make 10^5 files of a large study.
The finished study is also exported as one netCDF file for other programs.

A lock on the file refuses a second run; the first line says which study and which version of
the program the numbers are from, and a store of another is refused.
"""

import json
import os
import stat
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

import compass
from compass.errors import ArgumentError, OutputError
from compass.inputs.study import Study
from compass.study.candidates import PATTERNS, ROW, identities
from compass.study.stages import Found

FILE = "candidates.jsonl"
FORMAT = 1


def batch_record(stage: str, rows: NDArray, found: Found) -> dict[str, Any]:
    """What is kept of a batch, as plain values."""
    columns: dict[str, Any] = {name: rows[name].tolist() for name in ROW.names or ()}
    columns["pattern"] = [PATTERNS[code] for code in columns["pattern"]]
    return {
        "stage": stage,
        "candidates": columns,
        "figures": {name: _plain(values) for name, values in found.figures.items()},
        "errors": {str(k): text for k, text in found.errors.items()},
        "seconds": round(found.seconds, 6),
    }


def _plain(values: NDArray[np.float64]) -> list[float | str | None]:
    """Values for JSON, which has neither nan (null) nor infinity (a word)."""
    plain = values.astype(object)
    plain[np.isnan(values)], plain[np.isinf(values)] = None, "inf"
    return list(plain)


def rows_of(record: dict[str, Any]) -> NDArray:
    """Candidates of a stored batch, of dtype `ROW`."""
    columns = record["candidates"]
    rows = np.empty(len(columns["satellites"]), ROW)
    for name in ROW.names or ():
        values = columns[name]
        rows[name] = [PATTERNS.index(v) for v in values] if name == "pattern" else values
    return rows


def figures_in(record: dict[str, Any]) -> dict[str, NDArray[np.float64]]:
    """Figures of a stored batch, shape (n,) each; null is nan."""
    return {
        name: np.array([np.nan if v is None else float(v) for v in values])
        for name, values in record["figures"].items()
    }


def read_lines(path: Path, start: int = 0) -> Iterator[tuple[dict[str, Any] | None, int]]:
    """Objects of a store's file and where each line ends; None for a line that is damaged.

    Raises
    ------
    OutputError
        It cannot be read, or is not there any more.
    """
    end = start
    try:
        with path.open("rb") as file:
            file.seek(start)
            for line in file:
                end += len(line)
                yield _parse(line), end
    except OSError as error:
        raise OutputError(f"{path}: cannot be read: {error.strerror}") from error


def _line(record: dict[str, Any]) -> bytes:
    text = json.dumps(record, allow_nan=False, separators=(",", ":")).encode()
    return b"%08x %s\n" % (crc32(text), text)


def _parse(line: bytes) -> dict[str, Any] | None:
    checksum, _, text = line[:-1].partition(b" ")
    if not line.endswith(b"\n") or checksum != b"%08x" % crc32(text):
        return None
    found = json.loads(text)
    return found if isinstance(found, dict) else None


def header(study: Study) -> dict[str, Any]:
    """First line of a store."""
    return {
        "format": FORMAT,
        "version": compass.__version__,
        "study": study.digest,
        "name": study.name,
    }


def check_header(found: dict[str, Any] | None, study: Study, path: Path) -> None:
    """Refuse a store of another study or of another version.

    Raises
    ------
    ArgumentError
        It is; or the file is no store at all.
    """
    remedy = "give another folder (trade -o, report --store), or move this one away"
    if found is None or "format" not in found:
        raise ArgumentError(
            f"{path}: not a store of candidates, or its first line is damaged; {remedy}"
        )
    if found["format"] != FORMAT or found["version"] != compass.__version__:
        raise ArgumentError(
            f"{path}: made by compass {found['version']}, this is {compass.__version__}, whose "
            f"numbers may differ; {remedy}, or go on with that version"
        )
    if found["study"] != study.digest:
        raise ArgumentError(
            f"{path}: the store of another study ({found['name']!r}, or {study.label} or a file "
            f"that it names has changed since); {remedy}"
        )


class Store:
    """A study's store, open for one run; a context manager.

    Attributes
    ----------
    done
        Identities of the candidates that each stage has finished.
    damaged
        Lines that were torn or spoilt, and ignored: their candidates are computed again.

    Raises
    ------
    ArgumentError
        Another run has it, or it is of another study or version.
    OutputError
        It cannot be written: full disk, no permission. What it holds stays good.
    """

    def __init__(self, folder: Path, study: Study) -> None:
        self.path = folder / FILE
        self.done: dict[str, set[str]] = {}
        self.damaged = 0
        self._end = 0
        try:
            folder.mkdir(parents=True, exist_ok=True)
            # appending: whatever is there, nothing of it is overwritten
            self._file = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
        except OSError as error:
            raise OutputError(
                f"{self.path}: cannot be used: {error.strerror}; give another folder with -o"
            ) from error
        try:
            self._claim()
            self._open(study)
            _sync_folder(folder)
        except BaseException:
            self.close()
            raise

    def _claim(self) -> None:
        import fcntl

        if not stat.S_ISREG(os.fstat(self._file).st_mode):
            raise OutputError(f"{self.path}: cannot be used: not a file")
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise ArgumentError(
                f"{self.path.parent}: another run is at work on this store; wait for it, or give "
                "another folder with -o"
            ) from error
        except OSError as error:
            raise OutputError(f"{self.path}: cannot be locked: {error.strerror}") from error

    def _open(self, study: Study) -> None:
        """Learn what is there, and drop what is after the last good line."""
        first = _line(header(study))
        beginning = os.pread(self._file, len(first), 0)
        if len(beginning) < len(first) and first.startswith(beginning):
            self._truncate()  # new, or killed while its first line was written
            self._append(header(study))
            return
        for number, (record, end) in enumerate(read_lines(self.path)):
            if number == 0:
                check_header(record, study, self.path)
            elif record is None:
                self.damaged += 1
            else:
                self._note(record["stage"], rows_of(record))
            if record is not None:
                self._end = end
        self._truncate()  # or the rest would spoil the next line

    def _truncate(self) -> None:
        try:
            os.ftruncate(self._file, self._end)
        except OSError as error:
            raise OutputError(f"{self.path}: cannot be written: {error.strerror}") from error

    def _note(self, stage: str, rows: NDArray) -> None:
        self.done.setdefault(stage, set()).update(identities(rows))

    def add(self, stage: str, rows: NDArray, found: Found) -> None:
        """Store a finished batch; it is on the disk when this returns."""
        self._append(batch_record(stage, rows, found))
        self._note(stage, rows)

    def _append(self, record: dict[str, Any]) -> None:
        self._check_place()
        line = _line(record)
        try:
            written = 0
            while written < len(line):
                written += os.write(self._file, line[written:])
            os.fsync(self._file)
        except OSError as error:
            with suppress(OSError):  # the next run does it, if it must
                os.ftruncate(self._file, self._end)
            raise OutputError(
                f"{self.path}: cannot be written: {error.strerror}; all {self.finished} finished "
                "candidates stored so far are safe; make room and run the same command again"
            ) from error
        self._end += len(line)

    def _check_place(self) -> None:
        """Do not go on writing to a file that nobody can find."""
        with suppress(OSError):
            if os.path.samestat(os.stat(self.path), os.fstat(self._file)):
                return
        raise OutputError(
            f"{self.path}: deleted or moved while in use; put it back if you have it, and run "
            "the same command again"
        )

    @property
    def finished(self) -> int:
        """Candidates that have been through the first stage."""
        return len(self.done.get("screen", ()))

    def records(self, stage: str) -> Iterator[dict[str, Any]]:
        """Stored batches of a stage."""
        for record, _ in read_lines(self.path):
            if record is not None and record.get("stage") == stage:
                yield record

    def close(self) -> None:
        """Give the store free."""
        if self._file >= 0:
            os.close(self._file)
        self._file = -1

    def __enter__(self) -> "Store":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def _sync_folder(folder: Path) -> None:
    """Make the folder's entry of a new file outlive a power cut."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
