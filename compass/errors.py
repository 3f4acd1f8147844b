"""What can go wrong because of what a user wrote, said in a way that helps to mend it."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from difflib import get_close_matches


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


#: How alike two names must be, of 1, for the one to be offered for the other: a letter or two off.
LIKENESS = 0.8


def near(name: str, known: Iterable[str], most: int = 1) -> list[str]:
    """Names that someone who wrote `name` may have meant, nearest first; often none."""
    return get_close_matches(name, list(known), n=most, cutoff=LIKENESS)


@contextmanager
def said_of(label: str) -> Iterator[None]:
    """Let what is refused inside name the one of several things that it is about."""
    try:
        yield
    except ArgumentError as error:
        raise ArgumentError(f"{label}: {error}") from error
