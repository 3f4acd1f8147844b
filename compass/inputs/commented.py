"""A file of every key: those in use as they are, all others as comments with range and default.

It is made from the models that read the file, so that it cannot say less, or otherwise, than they
do.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any, Literal, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt
from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from compass.inputs.toml_values import toml_value

#: Where comments begin, in characters.
COLUMN = 38
#: Below this a value and its comment stand on one line.
WIDTH = 110
#: Bounds of this size only keep absurd numbers out, and are not worth a word.
ABSURD = 1e6


@dataclass(frozen=True)
class Key:
    """One key of a table: its name, its field, what a reader is told of it."""

    name: str
    field: FieldInfo

    @property
    def models(self) -> list[type[BaseModel]]:
        """The tables it may hold; none if it holds a value."""
        return [] if hasattr(self.field.annotation, "IMPLIED") else _tables(self.field.annotation)

    @property
    def many(self) -> bool:
        """Whether it holds a list of tables."""
        return any(get_origin(part) is list for part in _parts(self.field.annotation))

    @property
    def default(self) -> Any:
        """What holds if it is left out; None if nothing does."""
        made = self.field.get_default(call_default_factory=True)
        if isinstance(made, BaseModel):
            made = next((v for v in made.model_dump(exclude_unset=True).values()), None)
        return None if made is PydanticUndefined else made

    @property
    def comment(self) -> str:
        """Meaning, range and whether it is needed."""
        said = self.field.description or ""
        extra = [text for text in (self._choices(), self._range(said)) if text]
        if self.field.is_required():
            extra.append("needed")
        return f"{said} ({'; '.join(extra)})" if extra else said

    def _choices(self) -> str:
        inside = (inner for p in _parts(self.field.annotation) for inner in (p, *get_args(p)))
        literals = [part for part in inside if get_origin(part) is Literal]
        words = list(dict.fromkeys(toml_value(w) for part in literals for w in get_args(part)))
        return f"one of {', '.join(words)}" if len(words) > 1 else ""

    def _range(self, said: str) -> str:
        """Bounds of a number or of a length, unless the description has them."""
        words = {Ge: "from {}", Gt: "above {}", Le: "to {}", Lt: "below {}"}
        bounds = [
            (word.format(f"{bound:g}"), f"{bound:g}")
            for kind, word in words.items()
            for bound in _bounds(self.field, kind)
            if abs(bound) < ABSURD
        ]
        if not bounds or all(number in said for _, number in bounds):
            return ""
        return " ".join(word for word, _ in bounds)


def commented(model: type[BaseModel], values: Mapping[str, Any]) -> str:
    """TOML of `values` in which every key of `model` that they leave out is a comment.

    Parameters
    ----------
    model
        What the file must say.
    values
        Its raw tables, as TOML gives them.
    """
    return "\n".join([*_table(model, values, (), live=True), ""])


def _table(
    model: type[BaseModel], values: Mapping[str, Any], path: tuple[str, ...], live: bool
) -> Iterator[str]:
    keys = [Key(name, field) for name, field in model.model_fields.items()]
    short = [key.name for key in keys if not key.models or _is_short(values.get(key.name))]
    for key in keys:
        if key.name in short:
            yield from _value_lines(key, values, live)
    for key in keys:
        if key.models:
            given = None if key.name in short else values.get(key.name)
            yield from _nested(key, given, (*path, key.name), live)


def _is_short(given: Any) -> bool:
    """Whether a value stands where a table could: the name of a clock, say."""
    return given is not None and not isinstance(given, dict | list)


def _value_lines(key: Key, values: Mapping[str, Any], live: bool) -> Iterator[str]:
    if key.name in values:
        line = f"{'' if live else '# '}{key.name} = {toml_value(values[key.name])}"
    else:
        line = f"# {key.name} = {_placeholder(key)}"
    if "\n" in line or (len(line) >= COLUMN and len(line) + len(key.comment) > WIDTH):
        yield f"# {key.comment}"
        yield line
    else:
        yield f"{line.ljust(COLUMN)} # {key.comment}"


def _placeholder(key: Key) -> str:
    """Write the default; where there is none, what is to stand there."""
    if key.default not in (None, [], {}):
        return toml_value(key.default)
    for part in _parts(key.field.annotation):
        if get_origin(part) is Literal:
            return toml_value(get_args(part)[0])
    kinds = {
        datetime: "2030-01-01T00:00:00", int: "whole number", float: "number", str: "text",
        bool: "true or false",
    }  # fmt: skip
    hints = {get_origin(part) or part for part in _parts(key.field.annotation)}
    if list in hints:
        return "[...]"
    return f"<{next((word for kind, word in kinds.items() if kind in hints), 'value')}>"


def _nested(key: Key, given: Any, path: tuple[str, ...], live: bool) -> Iterator[str]:
    """Tables of a key: those given, then as comments those it could hold beside or instead."""
    heads = ("[[", "]]") if key.many else ("[", "]")
    head = f"{heads[0]}{'.'.join(path)}{heads[1]}"
    tables = given if isinstance(given, list) else [] if given is None else [given]
    for k, values in enumerate(tables):
        chosen = _chosen(key.models, values)
        yield from ("", f"{head} # {key.comment}" if k == 0 else head)
        lines = _table(chosen, values, path, live)
        yield from lines if k == 0 else (line for line in lines if not line.startswith("#"))
    used = {_chosen(key.models, values) for values in tables}
    for other in key.models:
        if other not in used:
            why = f"or so: {other.__doc__}" if used else key.comment
            yield from ("", f"# {head} # {why}", *_table(other, _tag(other), path, live=False))


def _chosen(models: list[type[BaseModel]], values: Mapping[str, Any]) -> type[BaseModel]:
    """Of the tables that a key may hold, the one of its pattern."""
    if len(models) == 1:
        return models[0]
    return next(m for m in models if values["pattern"] in get_args(_annotation(m, "pattern")))


def _tag(model: type[BaseModel]) -> dict[str, Any]:
    """Return what says of a table which it is."""
    if "pattern" not in model.model_fields:
        return {}
    return {"pattern": get_args(_annotation(model, "pattern"))[0]}


def _annotation(model: type[BaseModel], name: str) -> Any:
    return model.model_fields[name].annotation


def _parts(annotation: Any) -> Iterator[Any]:
    """Yield an annotation and what stands at its top: members of unions, not of lists."""
    yield annotation
    if get_origin(annotation) not in (list, Literal):
        for inner in get_args(annotation):
            yield from _parts(inner)


def _tables(annotation: Any) -> list[type[BaseModel]]:
    """All tables inside an annotation, lists of them too; not values that are written as tables."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [] if hasattr(annotation, "IMPLIED") else [annotation]
    if get_origin(annotation) is Literal:
        return []
    return [model for inner in get_args(annotation) for model in _tables(inner)]


def _bounds(field: FieldInfo, kind: type) -> Iterator[float]:
    """Yield bounds of a kind on a field or on what it may be."""
    extra = [m for part in _parts(field.annotation) for m in getattr(part, "__metadata__", ())]
    stated = [*field.metadata, *(m for f in extra for m in getattr(f, "metadata", [f]))]
    for bound in stated:
        if isinstance(bound, kind):
            yield getattr(bound, kind.__name__.lower())
            return
