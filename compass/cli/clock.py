"""Since when a command is at work, for who waits at a terminal where nothing else moves.

A bar whose next part takes long moves too: its own time is brought up to date.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Lock, Thread
from time import monotonic

#: Seconds after which it is told, and from then on how often.
AFTER_S, EVERY_S = 2.0, 1.0

_CLEAR = "\r\x1b[K"
#: Held by who writes on the terminal.
_writing = Lock()


@contextmanager
def clock(title: str, wanted: bool) -> Iterator[None]:
    """Tell on stderr for how long a command works, where no bar tells more; gone at its end."""
    if not (wanted and sys.stderr.isatty()):
        yield
        return
    over, begun = Event(), monotonic()
    thread = Thread(target=_tell, args=(title, begun, over), daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


@contextmanager
def line_of_its_own() -> Iterator[None]:
    """What is written meanwhile stands at the beginning of a line."""
    with _writing:
        if sys.stderr.isatty():
            sys.stderr.write(_CLEAR)
            sys.stderr.flush()
        yield


def _tell(title: str, begun: float, over: Event) -> None:
    told, wait = False, AFTER_S
    while not over.wait(wait):
        wait = EVERY_S
        if _bars_told():
            told = False
            continue
        with _writing:
            sys.stderr.write(f"{_CLEAR}{title}: at work for {monotonic() - begun:.0f} s")
            sys.stderr.flush()
            told = True
    if told:
        with _writing:
            sys.stderr.write(_CLEAR)
            sys.stderr.flush()


def _bars_told() -> bool:
    """Bring the time of every bar that is shown up to date; False where none is."""
    loaded = sys.modules.get("tqdm")
    if loaded is None:
        return False
    with _writing, loaded.tqdm.get_lock():  # none ends meanwhile
        bars = [bar for bar in getattr(loaded.tqdm, "_instances", ()) if not bar.disable]
        # one that waits for its time to come is not there yet, and would not leave
        shown = [bar for bar in bars if bar.last_print_t >= bar.start_t + bar.delay]
        for bar in shown:
            bar.refresh(nolock=True)
    return bool(shown)
