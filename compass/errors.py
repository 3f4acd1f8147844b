"""What can go wrong because of what a user wrote, said in a way that helps to mend it."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from difflib import get_close_matches
from math import isfinite
from numbers import Real


class CompassError(Exception):
    """The base of every error that a user can mend; the command line turns it into exit code 2."""


class DesignError(CompassError):
    """A design, scenario or study file that does not say what it must.

    Parameters
    ----------
    faults
        Every fault of the file, each a full sentence naming file, field, value, what is
        allowed and the remedy.
    """

    def __init__(self, faults: str | Sequence[str]) -> None:
        self.faults: tuple[str, ...] = (faults,) if isinstance(faults, str) else tuple(faults)
        super().__init__("\n".join(self.faults))


class ArgumentError(CompassError, ValueError):
    """A function argument or command-line option outside what is allowed."""


class OutputError(CompassError):
    """A result that cannot be written where it was asked for."""


@contextmanager
def found_so_far(said: Callable[[], str]) -> Iterator[None]:
    """Let an interruption of what is done here say what is known by then: the program prints it."""
    try:
        yield
    except KeyboardInterrupt as stop:
        if sentence := said():
            stop.add_note(sentence)
        raise


#: How alike two names must be, of 1, for the one to be offered for the other: a letter or two off.
LIKENESS = 0.8

#: The same for words as short as commands and sites are: of four letters two swapped leave so much.
SHORT = 0.7


def near(
    name: str, known: Iterable[str], most: int = 1, *, likeness: float = LIKENESS
) -> list[str]:
    """Names that someone who wrote `name` may have meant, nearest first; often none.

    Capitals count for nothing.
    """
    alike = {one.casefold(): one for one in known}
    found = get_close_matches(name.casefold(), list(alike), n=most, cutoff=likeness)
    return [alike[one] for one in found]


def meant(name: str, known: Iterable[str]) -> str:
    """Ask whether the nearest of names was meant; nothing where none is near."""
    likeness = SHORT if len(name) < 6 else LIKENESS
    return "".join(f"did you mean {one}? " for one in near(name, known, likeness=likeness))


def whole_number(
    name: str, value: object, least: int | None = None, most: int | None = None
) -> int:
    """Return a number that must be whole, as 15 or 15.0, within its range if it has one.

    Raises
    ------
    ArgumentError
        It is something else.
    """
    if isinstance(value, Real) and not isinstance(value, bool) and isfinite(value):
        whole = int(float(value))
        low, high = whole if least is None else least, whole if most is None else most
        if whole == value and low <= whole <= high:
            return whole
    words = "" if least is None else f" from {least} " + ("on" if most is None else f"to {most}")
    raise ArgumentError(f"{name} = {value!r}: must be a whole number{words}")


def real_number(name: str, value: object) -> float:
    """Return a number that must be finite.

    Raises
    ------
    ArgumentError
        It is something else.
    """
    if not isinstance(value, Real) or isinstance(value, bool) or not isfinite(value):
        raise ArgumentError(f"{name} = {value!r}: must be a finite number")
    return float(value)


@contextmanager
def said_of(label: str) -> Iterator[None]:
    """Let what is refused inside name the one of several things that it is about."""
    try:
        yield
    except ArgumentError as error:
        raise ArgumentError(f"{label}: {error}") from error
