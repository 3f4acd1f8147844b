"""A file to start from: commented, with every key, and ready to run."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from compass.api.results import Result
from compass.arguments import checked
from compass.document import Page, Sentence
from compass.errors import OutputError
from compass.inputs.commented import commented
from compass.inputs.reading import tables
from compass.inputs.shipped import companions, model_of, source
from compass.saving import check_writable, write_files

_HEAD = """\
# A {kind} for compass. It runs as it is. Keys behind a # are left out: what stands there is what
# holds then, or, in <angle brackets>, what could be given. Take the # away to say something else.
# An editor completes and checks it by the schema that `compass schema {kind}` prints.

"""


@dataclass(frozen=True, repr=False)
class NewResult(Result):
    """A file to start from.

    Attributes
    ----------
    kind
        ``design``, ``scenario`` or ``study``.
    text
        What stands in it.
    companions
        Files that it names, to stand beside it.
    """

    kind: str
    text: str
    companions: Sequence[Path] = field(default=())

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "kind": self.kind,
            "text": self.text,
            "companions": [path.name for path in self.companions],
        }

    def document(self) -> Page:
        """The file as lines of text."""
        return Page(f"a new {self.kind}", tuple(Sentence(line) for line in self.text.split("\n")))

    def __str__(self) -> str:
        return self.text.rstrip("\n")

    def write(self, path: str | Path) -> list[Path]:
        """Write the file, and beside it those that it names; return them all.

        Raises
        ------
        OutputError
            There is a file already, or it cannot be written.
        """
        path = Path(path)
        check_writable(path)
        if path.exists():
            raise OutputError(f"{path}: is there already; give a new name")
        beside = {other.name: other.read_text(encoding="utf-8") for other in self.companions}
        for name, text in beside.items():
            there = path.parent / name
            if there.exists() and there.read_text(encoding="utf-8") != text:
                raise OutputError(f"{there}: is there already, and says something else; move it")
        write_files(path.parent, {**beside, path.name: self.text})
        return [path, *(path.parent / name for name in beside)]


@checked
def new(kind: str, *, like: str | Path | None = None) -> NewResult:
    """Return a commented file that runs as it is: every key with unit, range and default.

    Parameters
    ----------
    kind
        ``design``, ``scenario`` or ``study``.
    like
        Name of a file that comes with compass, or path of any, whose values it takes; by default
        a small one made for starting.

    Raises
    ------
    ArgumentError
        No such kind or name.
    DesignError
        The file cannot be read, or has faults.

    Examples
    --------
    >>> import compass
    >>> started = compass.new("design")
    >>> [line for line in started.text.splitlines() if line.startswith("mask_deg")][0][:12]
    'mask_deg = 5'
    """
    model, path = model_of(kind), source(kind, like)
    text = _HEAD.format(kind=kind) + commented(model, tables(path))
    return NewResult(kind, text, companions(path))
