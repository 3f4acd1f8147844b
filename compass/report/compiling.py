"""Whether kernels are still to be compiled, so that a first run can say why it takes longer."""

from collections.abc import Callable
from pathlib import Path


def announce_compilation(say: Callable[[str], None]) -> None:
    """Call `say` with a message if the main kernel has no compiled copy in its cache yet."""
    from compass.core.coverage_map import map_row

    cache = getattr(getattr(map_row, "_cache", None), "_cache_path", None)
    if cache is None:  # compilation is switched off
        return
    if not any(Path(cache).glob("coverage_map.map_row*.nbi")):
        say("first run: compiling kernels, about half a minute; later runs start at once")
