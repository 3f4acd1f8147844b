"""Answers that took long, kept on disk: the same question is not worked out twice.

A key holds everything an answer depends on, and with it the program's own sources, the packages
that it computes with and whether kernels are compiled: what another version found is never taken
for what this one would find.
"""

import hashlib
import json
import os
import tempfile
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from compass.digest import digest_of

#: Answers that are kept, the oldest going first: kilobytes each.
MOST = 200


def folder() -> Path | None:
    """Where answers are kept: the user's folder for caches; None for a user without a home."""
    with suppress(RuntimeError):
        own = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        return Path(own) / "compass" / "answers"
    return None


@cache
def version() -> str:
    """Digest of the program's sources and data, of what it computes with, and how that runs."""
    import numba
    import numpy
    import scipy

    computing = (numba, numpy, scipy)
    ran = [bool(numba.config.DISABLE_JIT), *(package.__version__ for package in computing)]
    hashed, home = hashlib.sha256(repr(ran).encode()), Path(__file__).parent
    for path in sorted(p for p in home.rglob("*") if p.suffix in (".py", ".csv", ".npz")):
        hashed.update(str(path.relative_to(home)).encode())
        hashed.update(path.read_bytes())
    return hashed.hexdigest()


def kept(question: object, work_out: Callable[[], dict[str, Any]]) -> tuple[dict[str, Any], bool]:
    """Answer to a question, plain values as of JSON, and whether it was known already.

    A place that cannot be read or written, or holds something else than an answer, costs the time
    to work it out again and nothing more.

    Parameters
    ----------
    question
        All that the answer depends on, as `compass.digest.digest_of` takes it.
    work_out
        Finds the answer.
    """
    place = folder()
    name = digest_of((version(), question)) + ".json"
    if place is not None:
        with suppress(OSError, ValueError):
            known = json.loads((place / name).read_text(encoding="utf-8"))
            if isinstance(known, dict):
                return known, True
    answer = json.loads(json.dumps(work_out(), allow_nan=False))
    if place is not None:
        with suppress(OSError):
            _put(place, name, json.dumps(answer))
    return answer, False


def _put(place: Path, name: str, text: str) -> None:
    """Write an answer whole or not at all, and forget the oldest beyond `MOST`."""
    place.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=place)
    with os.fdopen(handle, "w", encoding="utf-8") as stream:
        stream.write(text)
    Path(temporary).replace(place / name)
    known = sorted(place.glob("*.json"), key=lambda path: path.stat().st_mtime)
    for old in known[:-MOST]:
        old.unlink(missing_ok=True)
