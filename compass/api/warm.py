"""The commands' kernels compiled at once, before the first question: for images and clusters."""

import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

from compass.api.new import new
from compass.api.progress import bar
from compass.api.results import Result
from compass.arguments import checked
from compass.core.kernel_cache import REMEDY, compiled, is_lasting, places
from compass.cores import cores
from compass.document import Page, Sentence, Verdict
from compass.document.blocks import columns, values
from compass.document.plain import plain
from compass.errors import OutputError

#: Files that the commands below are run on: the kind, and the shipped one it is like.
FILES = {
    "design.toml": ("design", None),
    "ellipsoid.toml": ("design", "areostationary-trio"),
    "sites.toml": ("design", "five-landing-sites"),
    "tracked.toml": ("design", "tracked-15-5-1"),
    "scenario.toml": ("scenario", None),
    "fused.toml": ("scenario", "lou2019-recommended"),
    "beacons.toml": ("scenario", "entry-ground-beacons"),
    "study.toml": ("study", None),
}

#: What is run, longest to compile first. Rarer options (rivals, relaying, protection levels,
#: horizons from terrain, beacons in orbit) and the papers' own filters compile theirs when asked.
COMMANDS = (
    ("land", "scenario.toml", "--runs", "2"),
    ("judge", "design.toml", "-s", "scenario.toml", "--samples", "8", "--runs", "8"),
    ("land", "fused.toml", "--runs", "2"),
    ("optimize", "beacons.toml"),
    ("fold", "design.toml", "--losses", "1"),
    ("fold", "ellipsoid.toml", "--fold", "1"),
    ("check", "sites.toml"),
    ("map", "design.toml", "--step-deg", "10", "--fold", "1"),
    ("map", "tracked.toml", "--step-deg", "10"),
    ("determine", "tracked.toml"),
    ("drift", "design.toml", "--days", "2"),
    ("keep", "design.toml", "--years", "0.1"),
    ("access", "design.toml", "--earth", "--crosslinks", "--moon", "phobos"),
    ("search", "--orbit", "areosynchronous", "--fold", "1", "--max-satellites", "6"),
    ("trade", "study.toml", "--workers", "1"),
)


@dataclass(frozen=True)
class Run:
    """One command that was run, and for how long (s)."""

    command: str
    seconds: float


@dataclass(frozen=True, repr=False)
class WarmResult(Result):
    """What was compiled, and where it is kept.

    Attributes
    ----------
    runs
        Commands that were run.
    seconds
        All of it.
    place
        Folder of the compiled kernels.
    kernels
        Compiled forms in it.
    size_mb
        What they take.
    """

    runs: Sequence[Run]
    seconds: float
    place: Path
    kernels: int
    size_mb: float

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return plain(
            {
                "place": str(self.place),
                "kernels": self.kernels,
                "size_mb": self.size_mb,
                "elapsed_s": self.seconds,
                "runs": [{"command": run.command, "elapsed_s": run.seconds} for run in self.runs],
            }
        )

    def document(self) -> Page:
        """Where they are, and what was run."""
        said = f"{self.kernels} compiled kernels, {self.size_mb:.0f} MB, in {self.place}"
        rows = [
            values("warm", {"command": run.command, "elapsed_s": run.seconds}) for run in self.runs
        ]
        table = columns("Commands that were run", rows)
        copied = Sentence(
            "Copied with the package, or with NUMBA_CACHE_DIR at a copy of the folder above it, "
            "they serve the same version on the same kind of processor."
        )
        return Page("kernels", (Verdict("", said), table, copied))


@checked
def warm(*, workers: int | None = None, progress: bool = False) -> WarmResult:
    """Compile the kernels of the commands now, by running small jobs of them.

    Rarer options compile theirs when they are first asked for.

    Parameters
    ----------
    workers
        Commands run at a time; by default one a core.
    progress
        Whether to show a bar on stderr.

    Raises
    ------
    OutputError
        No folder that lasts can be written, or a command failed.

    Examples
    --------
    >>> import compass
    >>> compass.warm().kernels > 100  # doctest: +SKIP
    True
    """
    place = places()[1]
    if place is None or not is_lasting():
        raise OutputError(f"warm: {REMEDY}")
    begin = perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        write_files(Path(folder))
        with ThreadPoolExecutor(cores(workers)) as pool:
            started = [pool.submit(_run, command, Path(folder)) for command in COMMANDS]
            try:
                for done in bar(progress, "warm", as_completed(started), total=len(started)):
                    done.result()
            except BaseException:
                pool.shutdown(cancel_futures=True)
                raise
    kept = [file.stat().st_size for file in compiled(place)]
    return WarmResult(
        [job.result() for job in started], perf_counter() - begin, place, len(kept), sum(kept) / 1e6
    )


def write_files(folder: Path) -> None:
    """Write the files that the commands are run on."""
    for name, (kind, like) in FILES.items():
        new(kind, like=like).write(folder / name)


def _run(command: Sequence[str], folder: Path) -> Run:
    """Run the program in a folder; what a command needs to compile, no list could say better."""
    begin = perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "compass", *command, "--json"],
        cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode not in (0, 1):  # a claim that does not hold is compiled too
        last = done.stderr.strip().splitlines()[-1:]
        raise OutputError(f"warm: compass {' '.join(command)} failed: {' '.join(last)}")
    return Run(" ".join(("compass", *command)), perf_counter() - begin)
