"""Faults of an input file, each said with field, value, what is allowed and the remedy."""

from collections.abc import Iterable
from datetime import date, time
from typing import Any, get_origin

from pydantic import BaseModel
from pydantic_core import ErrorDetails

from compass.errors import near

_KINDS = {
    "int": "a whole number",
    "float": "a number",
    "string": "text in quotes",
    "bool": "true or false",
    "list": "a list [...]",
    "tuple": "a list [...]",
    "dict": "a table",
    "model": "a table [...]",
    "datetime": "a date and time such as 2030-01-01T00:00:00, without quotes",
}


def fault(field: str, value: object, problem: str) -> str:
    """One fault: ``field = value: problem``; long values are cut."""
    shown = _in_toml(value)
    return f"{field} = {shown if len(shown) <= 60 else shown[:57] + '...'}: {problem}"


def _in_toml(value: object) -> str:
    """A value as a file has it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{key} = {_in_toml(of)}' for key, of in value.items())} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_in_toml, value))}]"
    return value.isoformat() if isinstance(value, date | time) else repr(value)


def table_in(raw: dict[str, Any], key: str) -> dict[str, Any]:
    """Return a table, empty where there is none (the model reports what is none)."""
    given = raw.get(key)
    return given if isinstance(given, dict) else {}


def tables_in(raw: dict[str, Any], key: str) -> list[dict[str, Any]]:
    """Return the tables of an array that are tables (the model reports the others)."""
    given = raw.get(key)
    return [t for t in given if isinstance(t, dict)] if isinstance(given, list) else []


def satellites_given(raw: dict[str, Any]) -> int | None:
    """How many satellites the raw tables of a design give; None where they do not say."""
    constellation = table_in(raw, "constellation")
    listed = constellation.get("satellite")
    count = len(listed) if isinstance(listed, list) else constellation.get("satellites")
    return count if isinstance(count, int) else None


#: Ends of the names of faults of a value that is not even of the kind.
_OTHER_KIND = ("_type", "_parsing")


def model_faults(errors: Iterable[ErrorDetails], model: type[BaseModel]) -> list[str]:
    """Say pydantic's errors in the project's words, one sentence a fault.

    A value with a fault inside is not refused as a whole too, as other members of a union would;
    nor is it by each of them: by the one that takes its kind and not its size, or by the first.
    """
    faults: dict[str, ErrorDetails] = {}
    for error in errors:
        path = _locate(error["loc"], model)[2]
        known = faults.setdefault(path, error)
        if known["type"].endswith(_OTHER_KIND) and not error["type"].endswith(_OTHER_KIND):
            faults[path] = error
    return [
        _sentence(error, model)
        for path, error in faults.items()
        if not any(other.startswith((f"{path}[", f"{path}.")) for other in faults)
    ]


def _sentence(error: ErrorDetails, model: type[BaseModel]) -> str:
    kind, context = error["type"], error.get("ctx", {})
    owner, field, path = _locate(error["loc"], model)
    hint = f"; {field}" if field else ""
    value: Any = error["input"]
    if kind == "missing":
        return f"{path}: missing{hint or '; add it'}"
    if kind == "extra_forbidden":
        return fault(path, value, f"unknown key; {_guess(path, owner, model)}")
    if kind == "union_tag_not_found":
        name = str(context["discriminator"]).strip("'")
        return f"{path}.{name}: missing; add one of the kinds that {path} can have{hint}"
    if kind == "union_tag_invalid":
        tag = str(context["discriminator"]).strip("'")
        return fault(f"{path}.{tag}", context["tag"], f"allowed: {context['expected_tags']}")
    if kind == "literal_error":
        return fault(path, value, f"allowed: {context['expected']}")
    if kind in ("too_short", "too_long", "string_too_short", "string_too_long"):
        count = context.get("min_length", context.get("max_length"))
        word = "least" if kind.endswith("short") else "most"
        unit = "character" if kind.startswith("string") else "value"
        plural = "" if count == 1 else "s"
        return fault(path, value, f"must have at {word} {count} {unit}{plural}{hint}")
    if kind == "finite_number":
        return fault(path, value, f"must be a finite number{hint}")
    if kind in ("greater_than", "greater_than_equal", "less_than", "less_than_equal"):
        (bound,) = context.values()
        words = {
            "greater_than": "must be above",
            "greater_than_equal": "must be at least",
            "less_than": "must be below",
            "less_than_equal": "must be at most",
        }
        return fault(path, value, f"{words[kind]} {bound:.12g}{hint}")
    for stem, words_for in _KINDS.items():
        if kind.startswith(stem) and (kind.endswith("_type") or kind.endswith("_parsing")):
            return fault(path, value, f"must be {words_for}{hint}")
    return fault(path, value, f"{error['msg'].removeprefix('Value error, ')}{hint}")


def _guess(path: str, owner: type[BaseModel] | None, model: type[BaseModel]) -> str:
    """Say what may have been meant by an unknown key, and what is allowed in its place.

    A key of another table of nearly the same name is that table's: `name` in ``[beacons]``.
    """
    table, _, key = path.rpartition(".")
    known = sorted(owner.model_fields) if owner else []
    guess = "".join(f"did you mean {_written(name, owner)}? " for name in near(key, known))
    for other in near(table, [name for name in model.model_fields if name != table]):
        if any(
            key in inner.model_fields for inner in _models(model.model_fields[other].annotation)
        ):
            guess += f"{_written(other, model)} has it; did you mean that? "
    return f"{guess}allowed: {', '.join(known)}"


def _written(name: str, owner: type[BaseModel] | None) -> str:
    """Write a key as it stands in a file: ``[table]``, ``[[one of several]]`` or its name.

    By its name, too, what may be a table but mostly is a list or a number.
    """
    annotation = owner.model_fields[name].annotation if owner else None
    models = _models(annotation)
    if not models or any(hasattr(model, "IMPLIED") for model in models):
        return name
    return f"[[{name}]]" if get_origin(annotation) is list else f"[{name}]"


def _locate(
    location: tuple[int | str, ...], model: type[BaseModel]
) -> tuple[type[BaseModel] | None, str, str]:
    """Walk `location` through nested models; return owner, field description, dotted path.

    Tags of discriminated unions and of plain unions, and keys that a model says are implied, which
    pydantic puts into the location but which are not written in the file, are left out of the path.
    """
    owner: type[BaseModel] | None = model
    here: Any = model
    description, path = "", ""
    for part in location:
        if isinstance(part, int):
            path += f"[{part + 1}]"
            continue
        candidates = _models(here)
        tagged = [m for m in candidates if part in _tags(m)]
        if tagged:
            here = owner = tagged[0]
            continue
        holder = next((m for m in candidates if part in m.model_fields), None)
        if holder is None and not candidates:
            continue  # a tag of a plain union, such as "float"
        owner = holder or (candidates[0] if candidates else None)
        if part != getattr(holder, "IMPLIED", None):
            path += f".{part}" if path else part
        field = holder.model_fields[part] if holder else None
        description = (field.description or "") if field else ""
        here = field.annotation if field else None
    return owner, description, path


def _models(annotation: Any) -> list[type[BaseModel]]:
    """All pydantic models inside a type annotation."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [m for inner in getattr(annotation, "__args__", ()) for m in _models(inner)]


def _tags(model: type[BaseModel]) -> tuple[str, ...]:
    """Values of the model's discriminating field, if it has one."""
    field = model.model_fields.get("pattern")
    return tuple(getattr(field.annotation, "__args__", ())) if field else ()
