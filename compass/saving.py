"""Writing results so that a killed run leaves the old file or the new one, never half of one."""

import csv
import io
import os
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from compass.conventions import in_conventions
from compass.errors import OutputError

if TYPE_CHECKING:
    import h5netcdf
    import xarray as xr


def readable(name: object) -> str:
    """Return a path or a command line as text for files; bytes not UTF-8 as in Python's bytes."""
    return str(name).encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")


def check_writable(path: Path, inputs: Sequence[Path] = ()) -> None:
    """Refuse an output path before any work is spent on it.

    Raises
    ------
    OutputError
        The path is a directory or a device, is one of the inputs, or its folder is missing or
        read-only.
    """
    folder = Path(os.path.realpath(path)).parent if path.is_symlink() else path.parent
    if path.is_dir():
        raise OutputError(f"{path}: is a directory; give a file name inside it")
    if path.exists() and not path.is_file():
        raise OutputError(f"{path}: is a device or the like, which would be lost; give a file name")
    for source in inputs:
        if path.exists() and source.exists() and path.samefile(source):
            raise OutputError(f"{path}: is an input itself; choose another output name")
    if not folder.is_dir():
        raise OutputError(f"{path}: folder {folder} does not exist; create it first")
    if not os.access(folder, os.W_OK) or (path.exists() and not os.access(path, os.W_OK)):
        raise OutputError(f"{path}: not writable; choose another place or change its permissions")


#: Endings of the files that a command writes in several forms.
ENDINGS = {"access": (".nc", ".csv", ".json"), "series": (".nc", ".csv")}


def check_ending(path: Path, among: Sequence[str]) -> None:
    """Refuse a path whose ending does not say in which form to write.

    Raises
    ------
    OutputError
        It says none of those.
    """
    if path.suffix not in among:
        raise OutputError(
            f"{path}: unknown kind {path.suffix or 'of file'!r}; "
            f"the name must end in {', '.join(among)}"
        )


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary path beside `path`; on success rename it over `path`, else remove it.

    A link stays: what it points to is replaced.
    """
    check_writable(path)
    with _beside(path, Path.touch) as temporary:
        yield temporary


@contextmanager
def _beside(path: Path, make: Callable[[Path], None]) -> Iterator[Path]:
    """Make a file or folder beside `path` that becomes it on success and is removed otherwise."""
    try:
        place = Path(os.path.realpath(path))
        # in a folder of its own, so that it is made as any is and its name may be as long as any
        outer = Path(tempfile.mkdtemp(prefix=".compass-", dir=place.parent))
        temporary = outer / place.name
        try:
            make(temporary)
            yield temporary
            temporary.replace(place)
        finally:
            shutil.rmtree(outer, ignore_errors=True)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}") from error


def write_files(folder: Path, files: Mapping[str, str]) -> None:
    """Write texts, by their names, into a folder that is there.

    A folder in it belongs to them as a whole: what it held of a former run, which might be taken
    for a part of this one, is removed once its files are written.

    Raises
    ------
    OutputError
        A file or a folder cannot be written.
    """
    parts: dict[Path, set[str]] = {}
    for name, text in files.items():
        path = folder / name
        if path.parent != folder:
            parts.setdefault(path.parent, set()).add(path.name)
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise OutputError(f"{path.parent}: cannot be made: {error.strerror}") from error
        with replacing(path) as temporary:
            temporary.write_text(text, encoding="utf-8")
    for part, names in parts.items():
        for old in part.iterdir():
            if old.is_file() and old.name not in names:
                old.unlink()


def write_csv(path: Path, header: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Write a table in UTF-8, texts as texts: no spreadsheet takes one for a formula.

    A text that begins like one gets an apostrophe before it, which spreadsheets do not show.
    """

    def cell(value: str) -> str:
        return f"'{value}" if value.lstrip().startswith(("=", "+", "-", "@")) else value

    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(header)
        writer.writerows([cell(v) if isinstance(v, str) else v for v in row] for row in rows)


class _NeverFull(io.RawIOBase):
    """A file that HDF5 never finds full: what has no place is dropped, and the error kept.

    HDF5 itself crashes the program on a disk that is full.
    """

    def __init__(self, file: io.FileIO) -> None:
        self._file = file
        self.error: OSError | None = None

    def write(self, data: Any) -> int:
        """Write all of it, unless something was dropped before."""
        written = 0
        try:
            while self.error is None and written < len(data):
                written += self._file.write(data[written:])
        except OSError as error:
            self.error = error
        return len(data)

    def readinto(self, data: Any) -> int:
        """Read, and zeros where the file has ended."""
        count = self._file.readinto(data) or 0
        data[count:] = bytes(len(data) - count)
        return len(data)

    def truncate(self, size: int | None = None) -> int:
        """Cut or extend."""
        try:
            return self._file.truncate(size)
        except OSError as error:
            self.error = self.error or error
            return size or 0

    def seek(self, offset: int, whence: int = 0) -> int:
        """Go there."""
        return self._file.seek(offset, whence)

    def tell(self) -> int:
        """Where it is."""
        return self._file.tell()


@contextmanager
def netcdf_file(path: Path) -> Iterator["h5netcdf.File"]:
    """Yield an empty netCDF-4 file that comes to `path` once it is whole.

    Raises
    ------
    OutputError
        It cannot be written: no room, no permission.
    """
    import h5netcdf

    with replacing(path) as temporary, temporary.open("r+b", buffering=0) as raw:
        held = _NeverFull(raw)
        try:
            with h5netcdf.File(held, "w") as file:
                yield file
        finally:  # whatever HDF5 says of data that were dropped, this is why
            if held.error is not None:
                raise held.error


def put_dataset(
    file: "h5netcdf.File", dataset: "xr.Dataset", group: str | None = None, **options: Any
) -> None:
    """Put a dataset, as CF-1.11 wants it, into a netCDF-4 file.

    With options as of `xarray.Dataset.to_netcdf`.
    """
    from xarray.backends import H5NetCDFStore

    made = in_conventions(dataset)
    made.dump_to_store(H5NetCDFStore(file, group=group, mode="a"), **options)


def save_netcdf(
    path: Path, dataset: "xr.Dataset", groups: Iterable[tuple[str, "xr.Dataset"]] = ()
) -> None:
    """Write a dataset, and others as its groups, as one netCDF-4 file; errors as `netcdf_file`."""
    with netcdf_file(path) as file:
        for group, part in [(None, dataset), *groups]:
            put_dataset(file, part, group)


def check_new_folder(path: Path) -> None:
    """Refuse a folder to be made that is there already with something in it.

    Raises
    ------
    OutputError
        The path is a file or a folder in use, or its parent is missing or read-only.
    """
    if path.is_dir() and any(path.iterdir()):
        raise OutputError(f"{path}: has files in it; give a new folder, or empty this one")
    if path.exists() and not path.is_dir():
        raise OutputError(f"{path}: is a file; give the name of a new folder")
    if not path.is_dir():
        check_writable(path)


@contextmanager
def making_folder(path: Path) -> Iterator[Path]:
    """Yield a temporary folder beside `path`; on success rename it to `path`, else remove it."""
    check_new_folder(path)
    with _beside(path, Path.mkdir) as temporary:
        yield temporary
