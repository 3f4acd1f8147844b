"""The durable store of a study: a file to which every finished batch is added at once.

One line a batch (`compass.study.record`). A line is one `write`, then an `fsync`, so after a kill
or a power cut the file holds every batch reported as stored and at most one torn line, which its
checksum gives away. Appending never rewrites what is there, which is why this is neither Parquet
nor Zarr: both keep an index (footer, chunk metadata) whose update and the data's are two writes,
and a part file a batch would make 10^5 files of a large study. The finished study is also exported
as one netCDF file for other programs.

A lock on the file refuses a second run; the first line says which study and which version of
the program the numbers are from, and a store of another is refused. So does every other line, so
that a damaged first one costs nothing.
"""

import os
import stat
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from numpy.typing import NDArray

import compass
from compass.errors import ArgumentError, OutputError
from compass.inputs.study import Study
from compass.study.candidates import Members, identities
from compass.study.record import (
    FORMAT,
    Batch,
    DamagedError,
    as_line,
    batch_of,
    batch_record,
    from_line,
    header,
)
from compass.study.stages import FINDERS, Found

FILE = "candidates.jsonl"


@dataclass(frozen=True)
class Line:
    """A line of a store's file: its number, what it says or why it is damaged, where it ends.

    The first, which says whose the store is, has neither batch nor damage.
    """

    number: int
    batch: Batch | None
    damage: str
    end: int


def read_lines(path: Path, study: Study) -> Iterator[Line]:
    """Lines of a study's store.

    Where the first line is damaged, the others still say whose they are.

    Raises
    ------
    OutputError
        It cannot be read, or is not there any more.
    ArgumentError
        It is of another study or another version, or no line is of a store of this study.
    """
    end, members, known = 0, Members(study), False
    try:
        with path.open("rb") as file:
            for number, text in enumerate(file, start=1):
                end += len(text)
                batch, damage = None, ""
                try:
                    record = from_line(text)
                    if end == len(text):
                        check_header(record, study, path)
                    else:
                        batch = batch_of(record, study, members)
                    known = True
                except DamagedError as error:
                    damage = str(error)
                yield Line(number, batch, damage, end)
    except OSError as error:
        raise OutputError(f"{path}: cannot be read: {error.strerror}") from error
    if end and not known:
        raise ArgumentError(
            f"{path}: not a store of candidates, or its first line is damaged and no other is of "
            f"this study; {_REMEDY}"
        )


_REMEDY = "give another folder (trade -o, report --store), or move this one away"


def check_header(found: dict[str, Any], study: Study, path: Path) -> None:
    """Refuse a store of another study or of another version.

    Raises
    ------
    ArgumentError
        It is.
    DamagedError
        The line is no first line of a store.
    """
    if set(found) != set(header(study)) or not all(
        type(found[key]) is type(value) for key, value in header(study).items()
    ):
        raise DamagedError("not a first line of a store")
    if found["format"] != FORMAT or found["version"] != compass.__version__:
        raise ArgumentError(
            f"{path}: made by compass {found['version']:.20}, format {found['format']}, this is "
            f"{compass.__version__}, format {FORMAT}, whose numbers may differ; {_REMEDY}, or go "
            "on with that version"
        )
    if found["study"] != study.digest:
        raise ArgumentError(
            f"{path}: the store of another study ({found['name']!r:.80}, or {study.label} or a "
            f"file that it names has changed since); {_REMEDY}"
        )


class Store:
    """A study's store, open for one run; a context manager.

    Attributes
    ----------
    done
        Identities of the candidates that each stage has finished.
    damaged
        Lines that were torn or spoilt, or that no run has written, with why; they are ignored, and
        their candidates computed again.
    study
        Whose store it is.
    batches
        All that is stored, by stage, as read and checked when the store was opened or as added.

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
        self.damaged: list[str] = []
        self.batches: dict[str, list[Batch]] = {stage: [] for stage in FINDERS}
        self.study = study
        self._end = self._first = 0
        self._missing = [place for place in (folder, *folder.parents) if not place.exists()]
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
        first = as_line(header(study))
        beginning = os.pread(self._file, len(first), 0)
        if len(beginning) < len(first) and first.startswith(beginning):
            self._truncate()  # new, or killed while its first line was written
            self._append(header(study))
            self._first = self._end
            return
        for line in read_lines(self.path, study):
            if line.damage:
                self.damaged.append(f"line {line.number}: {line.damage}")
                continue
            if line.batch is not None:
                self._note(line.batch)
            self._end = line.end
        self._truncate()  # or the rest would spoil the next line

    def _truncate(self) -> None:
        try:
            os.ftruncate(self._file, self._end)
        except OSError as error:
            raise OutputError(f"{self.path}: cannot be written: {error.strerror}") from error

    def _note(self, batch: Batch) -> None:
        self.batches[batch.stage].append(batch)
        self.done.setdefault(batch.stage, set()).update(identities(batch.rows))

    def add(self, stage: str, rows: NDArray, found: Found) -> None:
        """Store a finished batch; it is on the disk when this returns."""
        self._append(batch_record(self.study, stage, rows, found))
        self._note(Batch(stage, rows, found))

    def _append(self, record: dict[str, Any]) -> None:
        self._check_place()
        line = as_line(record)
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

    def close(self) -> None:
        """Give the store free; a new one in which nothing is finished is not left behind."""
        if self._file < 0:
            return
        # as long as it is: ^C may have come between writing a batch and noting that
        if 0 < self._first == os.fstat(self._file).st_size:
            with suppress(OSError, OutputError):  # somebody else's, or not empty
                self._check_place()
                self.path.unlink()
                for folder in self._missing:
                    folder.rmdir()
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
