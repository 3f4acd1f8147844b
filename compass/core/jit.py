"""How kernels are compiled: one floating-point contract, and a cache that cannot be stale."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba import config, njit

# Everything of fastmath but `nnan` and `ninf`: kernels test for nan and inf.
FASTMATH = {"contract", "reassoc", "nsz", "arcp", "afn"}


def _cache_folder() -> str:
    """Folder of compiled kernels, named by a digest of all kernel sources.

    Numba keys a compiled kernel to its own file; one that calls a kernel of another file, which
    is compiled into it, would keep the old one after an update.
    """
    here = Path(__file__).parent
    digest = hashlib.sha256()
    for source in sorted(here.rglob("*.py")):
        digest.update(source.read_bytes())
    return str(here / "__pycache__" / f"kernels-{digest.hexdigest()[:16]}")


_FOLDER = _cache_folder()


def _compiler(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    def compile_cached(function: Callable[..., Any]) -> Any:
        # the folder is read when caching is switched on; other packages keep their own
        theirs, config.CACHE_DIR = config.CACHE_DIR, config.CACHE_DIR or _FOLDER
        try:
            return njit(cache=True, nogil=True, error_model="numpy", **options)(function)
        finally:
            config.CACHE_DIR = theirs

    return compile_cached


#: Compile for exact floating-point semantics; cached on disk, releases the GIL.
kernel = _compiler()

#: Compile with sums reordered and multiply-adds fused; never where rounding is accounted for.
fast_kernel = _compiler(fastmath=FASTMATH)

#: As `fast_kernel`, and part of every loop that calls it: one that is only called keeps the loop
#: from working on several elements at once.
inline_kernel = _compiler(fastmath=FASTMATH, forceinline=True)
