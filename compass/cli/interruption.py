"""What a ^C interrupts: nothing loses it, and nothing turns it into another error unseen."""

import signal
import sys
from _thread import interrupt_main
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Timer
from types import FrameType

#: Seconds after which a ^C that went where nothing can be raised is raised again.
RETRY_S = 0.05


@contextmanager
def interrupts_noted() -> Iterator[list[int]]:
    """Note each ^C: what it interrupts may turn it into an error of another kind.

    Or lose it: what is raised while an import clears up its locks goes to a hook, no further; and
    LLVM, which asks Python for compiled code, does not survive that. It comes a moment later then.
    """
    noted: list[int] = []

    def later() -> None:
        once_more = Timer(RETRY_S, interrupt_main)
        once_more.daemon = True
        once_more.start()

    def note(number: int, frame: FrameType | None) -> None:
        noted.append(number)
        if _in_llvm(frame):
            later()
        else:
            raise KeyboardInterrupt

    def again(lost: "sys.UnraisableHookArgs") -> None:
        if isinstance(lost.exc_value, KeyboardInterrupt):
            later()
        else:
            hook(lost)

    hook = sys.unraisablehook
    before = signal.getsignal(signal.SIGINT)
    if before is not signal.default_int_handler:  # ^C is ignored, or someone else's
        yield noted
        return
    signal.signal(signal.SIGINT, note)
    sys.unraisablehook = again
    try:
        yield noted
    finally:
        signal.signal(signal.SIGINT, before)
        sys.unraisablehook = hook


def _in_llvm(frame: FrameType | None) -> bool:
    """Whether LLVM is at work below, and waits for what Python answers."""
    while frame is not None:
        if str(frame.f_globals.get("__name__")).startswith("llvmlite."):
            return True
        frame = frame.f_back
    return False
