"""What public functions are given: of the kinds their signatures name, or refused in a sentence."""

from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from inspect import Parameter, Signature, signature
from numbers import Real
from os import PathLike
from pathlib import Path
from reprlib import repr as shortened
from types import NoneType, UnionType
from typing import Any, Literal, ParamSpec, TypeVar, Union, get_args, get_origin

import numpy as np
from numpy.typing import ArrayLike

from compass.allowed import RANGES, check_allowed
from compass.errors import ArgumentError, near, real_number, whole_number

Given = ParamSpec("Given")
Returned = TypeVar("Returned")

#: How a refusal names each kind.
_WORDS: dict[object, str] = {
    int: "a whole number",
    float: "a finite number",
    str: "a text",
    bool: "True or False",
    Path: "a path",
    NoneType: "None",
}


def checked(function: Callable[Given, Returned]) -> Callable[Given, Returned]:
    """Let a function begin only when its arguments are of the kinds that its signature names.

    Checked are numbers, texts, choices (`Literal`), paths, yes or no, classes, arrays (finite) and
    several of these. Left to the function are ranges, lists of lists, and what may be a thing or
    the file that describes it. NumPy's numbers become Python's.

    Raises
    ------
    ArgumentError
        When called: an argument is of another kind, or a number out of its range
        (`compass.allowed`).
    """
    wanted, where = signature(function), function.__qualname__

    @wraps(function)
    def call(*args: Given.args, **kwargs: Given.kwargs) -> Returned:
        try:
            given = wanted.bind(*args, **kwargs)
        except TypeError as error:
            raise TypeError(_unfitting(wanted, len(args), kwargs, str(error))) from None
        for name, value in given.arguments.items():
            parameter = wanted.parameters[name]
            hint = parameter.annotation
            if parameter.kind is Parameter.VAR_POSITIONAL:
                given.arguments[name] = tuple(_taken(name, each, hint) for each in value)
            elif parameter.kind is Parameter.VAR_KEYWORD:
                given.arguments[name] = {key: _taken(key, value[key], hint) for key in value}
            else:
                given.arguments[name] = _taken(name, value, hint)
            check_range(where, name, given.arguments[name])
        return function(*given.args, **given.kwargs)

    return call


def _unfitting(wanted: Signature, positional: int, given: Iterable[str], otherwise: str) -> str:
    """Say which name is unknown and which was meant, or what must be named; else as Python."""
    parameters = wanted.parameters
    by_place = [
        name
        for name, parameter in parameters.items()
        if parameter.kind is Parameter.POSITIONAL_OR_KEYWORD and name not in ("self", "cls")
    ]
    for name in given:
        if name not in parameters:
            meant = [known for known in parameters if known.startswith(f"{name}_")]
            meant = meant or near(name, parameters)
            told = f"did you mean {' or '.join(meant)}" if meant else f"allowed {_all(parameters)}"
            return f"{name}: unknown argument; {told}?" if meant else f"{name}: unknown; {told}"
    if "too many positional" in otherwise:
        positional -= len({"self", "cls"} & parameters.keys())
        others = _all(name for name in parameters if name not in by_place)
        return (
            f"{positional} arguments by position: allowed {_all(by_place) or 'none'}; "
            f"give the others by name: {others}"
        )
    return otherwise


def _all(names: Iterable[str]) -> str:
    return ", ".join(name for name in names if name not in ("self", "cls"))


def _taken(name: str, value: Any, hint: Any) -> Any:
    """Return the value as the function takes it, of the first kind of its hint that it is."""
    kinds = _kinds(hint)
    if not _is_known(hint) or (value is None and NoneType in kinds):
        return value
    kinds = [kind for kind in kinds if kind is not NoneType]
    if len(kinds) == 1:
        return _of_kind(name, value, kinds[0])
    for kind in kinds:
        try:
            return _of_kind(name, value, kind)
        except ArgumentError:
            continue
    words = " or ".join(dict.fromkeys(_words(kind) for kind in kinds))
    raise ArgumentError(f"{name} = {shortened(value)}: must be {words}")


def check_range(where: str, name: str, value: Any) -> None:
    """Refuse a number that its range does not have, or the least such of a list.

    Raises
    ------
    ArgumentError
        As `compass.allowed.check_allowed`.
    """
    if isinstance(value, dict):  # arguments of any name
        for key in value:
            check_range(where, key, value[key])
    elif not RANGES.keys() & {name, f"{where}.{name}"}:
        return
    elif isinstance(value, Real) and not isinstance(value, bool):
        check_allowed(name, value if isinstance(value, int) else float(value), where)
    elif not isinstance(value, str) and are_numbers(value) and np.ndim(value) == 1:
        for number in np.unique(np.asarray(value, dtype=float)):
            check_allowed(name, float(number), where)


def _kinds(hint: Any) -> list[Any]:
    """Return what a hint allows, one by one; the many ways to write an array are one kind."""
    kinds = list(get_args(hint)) if get_origin(hint) in (Union, UnionType) else [hint]
    ways = get_args(ArrayLike)
    if set(ways) <= set(kinds):
        return [ArrayLike, *(kind for kind in kinds if kind not in ways)]
    return kinds


def _is_known(hint: Any) -> bool:
    """Whether values of a hint are checked here."""
    kinds = _kinds(hint)
    described = Path in kinds and any(kind not in _WORDS for kind in kinds)
    return not described and all(
        kind is ArrayLike
        or get_origin(kind) is Literal
        or (get_origin(kind) is None and isinstance(kind, type) and kind is not Parameter.empty)
        or (
            get_origin(kind) in (Sequence, tuple)
            and not any(get_origin(part) is Sequence for part in get_args(kind))
            and all(_is_known(part) for part in get_args(kind) if part is not Ellipsis)
        )
        for kind in kinds
    )


def _words(kind: Any) -> str:
    """Say what a value of a kind is."""
    if kind is ArrayLike:
        return "a finite number or an array of them, without units"
    if get_origin(kind) is Literal:
        return "one of " + ", ".join(get_args(kind))
    if get_origin(kind) is tuple and Ellipsis not in get_args(kind):
        return f"{len(get_args(kind))} of them"
    if get_origin(kind) in (Sequence, tuple):
        return "a list"
    return _WORDS.get(kind, f"a {kind.__name__}")


def _of_kind(name: str, value: Any, kind: Any) -> Any:
    """Return the value as one of a kind, or refuse it."""
    of = get_origin(kind)
    if kind in (int, float):
        if isinstance(value, Real) and not isinstance(value, bool):
            if kind is int:
                return whole_number(name, value)
            real_number(name, value)
            return value if isinstance(value, int | float) else float(value)
    elif kind is ArrayLike:
        if are_numbers(value):
            return value
    elif kind is bool:
        if isinstance(value, bool | np.bool_):
            return bool(value)
    elif of is Literal:
        if isinstance(value, str) and value in get_args(kind):
            return value
    elif of in (Sequence, tuple):
        parts = get_args(kind)
        fixed = of is tuple and Ellipsis not in parts
        if _is_several(value) and (not fixed or len(value) == len(parts)):
            part = parts[0]
            return tuple(_taken(f"{name}[{k}]", each, part) for k, each in enumerate(value))
    elif isinstance(value, str | PathLike if kind is Path else kind):
        return value
    raise ArgumentError(f"{name} = {shortened(value)}: must be {_words(kind)}")


def are_numbers(value: object) -> bool:
    """Whether a value is a finite number or an array of them; one with a unit is none."""
    if hasattr(type(value), "units") or hasattr(type(value), "unit"):
        return False
    try:
        given = np.asarray(value)
    except ValueError:  # rows of different lengths
        return False
    return given.dtype.kind in "iuf" and bool(np.all(np.isfinite(given)))


def _is_several(value: object) -> bool:
    """Whether a value has others in order: a list, a tuple, an array of one axis or more."""
    return (
        hasattr(value, "__len__")
        and hasattr(value, "__getitem__")
        and not isinstance(value, str | bytes | dict)
        and getattr(value, "ndim", 1) > 0
    )
