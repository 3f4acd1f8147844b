"""Reading a TOML file into a checked model, whatever the file turns out to be."""

import re
import tomllib
from collections.abc import Callable
from glob import glob
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from compass.errors import DesignError
from compass.inputs.faults import model_faults

#: A design file is some kilobytes; anything past this is not one.
MAX_BYTES = 1_000_000

#: Tables and lists within each other; no file of ours has more than six.
DEEPEST = 30

#: The table by which each kind of file is known.
KINDS = {"constellation": "a design", "vehicle": "a scenario of landing", "study": "a study"}

Model = TypeVar("Model", bound=BaseModel)


def read_text(path: Path) -> str:
    """Text of a small UTF-8 file.

    Raises
    ------
    DesignError
        The path is missing, a directory or a device, unreadable, empty, too large or binary.
    """
    try:
        if not path.exists():
            raise DesignError(f"{path}: no such file; check the path")
        if path.is_dir():
            raise DesignError(f"{path}: is a directory; give the TOML file inside it")
        if not path.is_file():
            raise DesignError(f"{path}: is not a regular file; give a TOML file")
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise DesignError(
                f"{path}: {size / 1e6:.1f} MB; a design file has at most {MAX_BYTES / 1e6:.0f} MB"
            )
        text = path.read_bytes().decode("utf-8-sig")
    except OSError as error:  # the very look at a path may fail: a name too long, a link to itself
        raise DesignError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise DesignError(
            f"{path}: line {line} is not text in UTF-8; a design file is TOML, saved as UTF-8"
        ) from error
    if not text.strip():
        raise DesignError(f"{path}: empty; see designs/ for examples")
    return text.replace("\r\n", "\n")


def key_given_twice(text: str, fault: str) -> str | None:
    """Name the key behind the parser's "Cannot overwrite a value", which tells its line alone."""
    place = re.match(r"Cannot overwrite a value \(at (?:line (\d+),|end of document)", fault)
    if place is None:
        return None
    lines = text.split("\n")
    end = int(place[1] or len(lines))
    for first in range(end, 0, -1):  # a value may begin lines before it ends
        try:
            held: Any = tomllib.loads("\n".join(lines[first - 1 : end]))
        except ValueError:
            continue
        parts = []
        while isinstance(held, dict) and len(held) == 1:
            [(part, held)] = held.items()
            parts.append(part)
        if parts:
            return f"{'.'.join(parts)} is given twice, again in line {first}; leave one out"
    return None


def tables_of(text: str) -> dict[str, Any]:
    """Raw tables of a file's text, none nested so deeply that what reads them must give up.

    Raises
    ------
    ValueError
        It is not valid TOML, and why.
    """
    try:
        raw = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        if twice := key_given_twice(text, str(error)):
            raise ValueError(twice) from error
        raise
    except RecursionError:
        raise ValueError("nested too deeply") from None
    except ValueError as error:  # Python's own limit, or a date that no calendar has
        raise ValueError(f"a value that cannot be: {str(error).partition(';')[0]}") from error
    level: list[Any] = [raw]
    for _ in range(DEEPEST):
        inner = [list(held.values()) if isinstance(held, dict) else held for held in level]
        level = [held for values in inner for held in values if isinstance(held, dict | list)]
    if level:
        raise ValueError(f"nested too deeply, more than {DEEPEST} times")
    return raw


def tables(path: Path) -> dict[str, Any]:
    """Raw tables of a file; none if it is no TOML.

    Raises
    ------
    DesignError
        It cannot be read.
    """
    try:
        return tables_of(read_text(path))
    except ValueError:
        return {}


def named_files(path: Path) -> list[Path]:
    """Return the files that a file names, and those that these name in turn: none if it is no TOML.

    A name is any text of the file that is the path of a file, seen from the folder it is in, or a
    pattern of some, such as ``*.oem``.
    """
    files: list[Path] = []
    waiting = [path]
    while waiting:
        here = waiting.pop()
        texts = [text for text in _texts(tables(here)) if len(text) < 200 and "\n" not in text]
        for other in (one for text in texts for one in _of_name(here.parent, text)):
            if other not in (path, *files) and other.is_file():
                files.append(other)
                waiting += [other] if other.suffix == ".toml" else []
    return sorted(files)


def _of_name(folder: Path, text: str) -> list[Path]:
    return [Path(one) for one in glob(str(folder / text))] if "*" in text else [folder / text]


def _texts(value: Any) -> list[str]:
    if isinstance(value, dict):
        return [text for inner in value.values() for text in _texts(inner)]
    if isinstance(value, list):
        return [text for inner in value for text in _texts(inner)]
    return [value] if isinstance(value, str) else []


def parse(
    text: str, label: str, model: type[Model], cross_faults: Callable[[dict[str, Any]], list[str]]
) -> Model:
    """Parse TOML `text` and check it against `model` and against `cross_faults`.

    Parameters
    ----------
    text
        The file's text.
    label
        The file's name, put before every fault.
    model
        What the file must say.
    cross_faults
        Checks that concern several fields at once; takes the raw tables, whatever is in them,
        and returns its faults. It runs even if `model` found faults, so all come together.

    Raises
    ------
    DesignError
        With every fault of the file.
    """
    try:
        raw = tables_of(text)
    except ValueError as error:
        raise DesignError(f"{label}: not valid TOML: {error}") from error
    if other := _other_kind(raw, model):
        raise DesignError(f"{label}: {other}")
    faults: list[str] = []
    checked: Model | None = None
    try:
        checked = model.model_validate(raw)
    except ValidationError as error:
        faults += model_faults(error.errors(include_url=False), model)
    refused = tuple(text.partition(" = ")[0] + " = " for text in faults if " = " in text)
    # what is no value of its field is nothing to compare with others
    faults += [text for text in cross_faults(raw) if not text.startswith(refused)]
    if faults or checked is None:
        raise DesignError([f"{label}: {text}" for text in dict.fromkeys(faults)])
    return checked


def _other_kind(raw: dict[str, Any], model: type[BaseModel]) -> str:
    """What is wrong with a file of another kind, said once; nothing if it may be of this one."""
    own = [table for table in KINDS if table in model.model_fields]
    tables = [table for table in KINDS if table in raw]
    if not own or not tables or own[0] in tables:
        return ""
    return f"is {KINDS[tables[0]]}, not {KINDS[own[0]]}; give a file with a table [{own[0]}]"
