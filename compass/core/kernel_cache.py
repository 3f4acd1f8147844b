"""Where compiled kernels are kept: under a digest of all that they are made of, in any place.

Numba keys a compiled kernel to its own file. One that calls a kernel of another file, which is
compiled into it, would keep the old one after an update; so the digest of a file and of all that it
imports from here, however far, stands in the path of its kernels. What an edit does not reach is
not compiled again.
"""

import hashlib
import os
import re
import stat
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import IO, Any, ClassVar

from numba import config
from numba.core.caching import (
    CompileResultCacheImpl,
    FunctionCache,
    _CacheLocator,
    _SourceFileBackedLocatorMixin,
)
from numba.core.runtime import rtsys
from numba.np import linalg

SOURCES = Path(__file__).parent

#: What is wrong, and what helps, where no lasting place can be written.
REMEDY = "no folder to keep them can be written; set NUMBA_CACHE_DIR to one that can"


#: An import of the house's style: `from package.module import name, name`.
IMPORT = re.compile(rb"^\s*from ([\w.]+) import (\([^)]*\)|[^\n]*)", re.MULTILINE)


@cache
def imports(source: Path) -> frozenset[Path]:
    """Files below `SOURCES` that a file imports itself.

    An import that the pattern missed would leave old code in use, so a test compares what it
    finds in every kernel source with what Python itself reads there.
    """
    package = SOURCES.parent.parent
    imported = set()
    for module, names in IMPORT.findall(source.read_bytes()):
        home = package.joinpath(*module.decode().split("."))
        among = [home, *(home / name for name in re.findall(r"\w+", names.decode()))]
        files = [file for path in among for file in (path.with_suffix(".py"), path / "__init__.py")]
        imported |= {file for file in files if file.is_relative_to(SOURCES) and file.is_file()}
    return frozenset(imported)


@cache
def parts(source: Path) -> tuple[Path, ...]:
    """A file and all that it imports from `SOURCES`, however far, in order of their names."""
    reached, new = {source}, {source}
    while new:
        new = {file for part in new for file in imports(part)} - reached
        reached |= new
    return tuple(sorted(reached))


@cache
def digest(source: Path) -> str:
    """Sixteen hexadecimal digits of a file and of all that it imports from here."""
    hashed = hashlib.sha256()
    for part in parts(source):
        hashed.update(hashlib.sha256(part.read_bytes()).digest())
    return hashed.hexdigest()[:16]


def lasting_places() -> list[Path]:
    """Folders of compiled kernels, the first that can be written to be taken.

    The user's own choice, the package's folder, the user's folder for caches.
    """
    roots = [SOURCES / "__pycache__"]
    if config.CACHE_DIR:
        roots.insert(0, Path(config.CACHE_DIR))
    with suppress(RuntimeError):  # a user without a home
        own = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        roots.append(Path(own) / "compass")
    return [root / "kernels" for root in roots]


def passing_place() -> Path | None:
    """Folder for compiled kernels until the machine starts anew; None if there is none.

    It is nobody else's: whoever can write there can have anything run.
    """
    with suppress(OSError):
        place = Path(tempfile.gettempdir()) / f"compass-{os.getuid()}"
        place.mkdir(mode=0o700, exist_ok=True)
        status = place.lstat()
        own = stat.S_ISDIR(status.st_mode) and status.st_uid == os.getuid()
        if own and not status.st_mode & 0o022:
            return place / "kernels"
    return None


def folder_of(source: Path) -> Path:
    """Folder, in any place, of the compiled kernels of a source file as it is now."""
    inside = source.is_relative_to(SOURCES)
    part = source.relative_to(SOURCES).with_suffix("") if inside else Path(source.stem)
    return part.with_name(f"{part.name}-{digest(source)}")


def compiled(place: Path) -> list[Path]:
    """Compiled forms in a place that serve the sources as they are now."""
    folders = [place / folder_of(source) for source in SOURCES.rglob("*.py")]
    return sorted(file for folder in folders for file in folder.glob("*.nbc"))


def can_be_written(place: Path) -> bool:
    """Whether a file can be made there; the folder is made if it can be."""
    try:
        place.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=place).close()
    except OSError:
        return False
    return True


@cache
def places() -> tuple[tuple[Path, ...], Path | None]:
    """Where kernels may be found already, and where new ones are put (None: nowhere)."""
    lasting = lasting_places()
    passing = passing_place()
    candidates = [*lasting, passing] if passing else lasting
    new = next((place for place in candidates if can_be_written(place)), None)
    return tuple(place for place in candidates if place == new or place.is_dir()), new


def is_lasting() -> bool:
    """Whether what is compiled now is there the next time."""
    return places()[1] in lasting_places()


@cache
def _kept_in(place: Path) -> Callable[[Callable[..., Any]], Any]:
    """Numba's cache of a function in a folder."""

    class Locator(_SourceFileBackedLocatorMixin, _CacheLocator):
        def __init__(self, function: Callable[..., Any], file: str) -> None:
            self._py_file, self._lineno = file, function.__code__.co_firstlineno
            self._place = str(place / folder_of(Path(file)))

        def get_cache_path(self) -> str:
            return self._place

        def get_source_stamp(self) -> Any:
            # the path says what the source is; its date differs from one installation to another
            return self._lineno

        def ensure_cache_path(self) -> None:
            os.makedirs(self._place, exist_ok=True)

        @classmethod
        def from_function(cls, function: Callable[..., Any], file: str) -> Any:
            return cls(function, file)

    class Implementation(CompileResultCacheImpl):
        _locator_classes: ClassVar[Any] = [Locator]

    class Kept(FunctionCache):
        _impl_class = Implementation

        def load_overload(self, signature: Any, context: Any) -> Any:
            """Load what is kept without first filling the context with all that Numba can compile.

            That takes longer than to load our kernels, and only who compiles needs it: Numba's
            compiler fills the context itself. A kernel has to find the counters of references.
            """
            rtsys.initialize(context)
            with self._guard_against_spurious_io_errors():
                return self._load_overload(signature, context)

    return Kept


def spare_linear_algebra() -> None:
    """Have Numba load kernels without SciPy's linear algebra, which takes longer than they do.

    At its first kernel Numba imports it only to learn whether it is there, and for us it is. A
    kernel that solves equations imports it when it is called.
    """
    if "numba.np.arraymath" not in sys.modules:
        asked, linalg.ensure_blas = linalg.ensure_blas, lambda: None
        try:
            vars(import_module("numba.np.arraymath"))["ensure_blas"] = asked
        finally:
            linalg.ensure_blas = asked


class Turn:
    """One process at a time in a folder, as far as its file system can tell them apart.

    It ends with the process at the latest, however that ends.
    """

    def __init__(self) -> None:
        self._file: IO[bytes] | None = None

    def take(self, path: Path) -> None:
        """Wait until nobody else has it; a place without locks is everybody's."""
        with suppress(OSError, ImportError):
            import fcntl  # not on Windows

            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("ab")
            fcntl.flock(self._file, fcntl.LOCK_EX)

    def end(self) -> None:
        """Let the next one in."""
        if self._file:
            self._file.close()
            self._file = None


class KernelCache:
    """A kernel's compiled forms on disk, as Numba's dispatchers ask for them.

    A place that cannot be read, is full or is damaged costs a compilation and nothing else.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        readable, new = places()
        # Numba lets its environment replace the locators, and with them the digest
        theirs = getattr(config, "CACHE_LOCATOR_CLASSES", "")
        config.CACHE_LOCATOR_CLASSES = ""
        try:
            self._all = [_kept_in(place)(function) for place in readable]
        finally:
            config.CACHE_LOCATOR_CLASSES = theirs
        self._new = None if new is None else self._all[readable.index(new)]
        self.cache_path = None if self._new is None else self._new.cache_path
        self._turn, self._name = Turn(), function.__qualname__

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Return what is kept for a signature, or None: then it is this process's to compile.

        Where several ask at once, one compiles and the others wait here. Kernels are waited for
        in the order of calls, from the outer to the inner, so nobody waits in a circle.
        """
        spare_linear_algebra()
        kernel = self._load(signature, context)
        if kernel is None and self.cache_path is not None:
            self._turn.take(Path(self.cache_path) / f"{self._name}.lock")
            kernel = self._load(signature, context)
        return kernel

    def let_others_compile(self) -> None:
        """End this process's turn to compile, if it has it."""
        self._turn.end()

    def _load(self, signature: Any, context: Any) -> Any:
        for kept in self._all:
            with suppress(Exception):  # a damaged file may say anything
                if (kernel := kept.load_overload(signature, context)) is not None:
                    return kernel
        return None

    def save_overload(self, signature: Any, compiled: Any) -> None:
        """Keep what was compiled for a signature."""
        if self._new is not None:
            with suppress(OSError):
                self._new.save_overload(signature, compiled)
