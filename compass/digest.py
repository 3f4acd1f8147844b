"""A value's digest: all of it, field by field, so that a new field is in every key by itself."""

import hashlib
import struct
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from fractions import Fraction
from pathlib import PurePath
from typing import Any

import numpy as np

#: Fields that say where a thing was read: no answer depends on them.
PROVENANCE = frozenset({"text", "digest", "label"})


def digest_of(value: object) -> str:
    """SHA-256 of a value, in hexadecimal: equal for equal values, whatever run they are of.

    Dataclasses and models go field by field but for `PROVENANCE`, arrays by type, shape and
    content, floating-point numbers by their bits. A number, a text and a list that look alike
    are not.

    Raises
    ------
    TypeError
        Something in it has no content that could be told, as a function.
    """
    hashed = hashlib.sha256()
    for part in _parts(value):
        hashed.update(len(part).to_bytes(8, "little"))
        hashed.update(part)
    return hashed.hexdigest()


def _parts(value: Any) -> Iterator[bytes]:
    """What a value is, as bytes, each part told from the next by its length."""
    kind = type(value)
    yield f"{kind.__module__}.{kind.__qualname__}".encode()
    if value is None or isinstance(value, bool | int | Fraction):
        yield str(value).encode()
    elif isinstance(value, float | complex):
        number = complex(value)
        yield struct.pack("<dd", number.real, number.imag)
    elif isinstance(value, str | PurePath):
        yield str(value).encode("utf-8", "surrogateescape")
    elif isinstance(value, bytes):
        yield value
    elif isinstance(value, Enum):
        yield value.name.encode()
    elif isinstance(value, np.ndarray | np.generic):
        if value.dtype.hasobject:
            raise TypeError("an array of objects has no content that could be told")
        yield f"{value.dtype.descr} {value.shape}".encode()
        yield np.ascontiguousarray(value).tobytes()
    elif isinstance(value, Mapping):
        for key in sorted(value, key=repr):
            yield from _parts(key)
            yield from _parts(value[key])
    elif isinstance(value, set | frozenset):
        yield "".join(sorted(map(digest_of, value))).encode()
    elif isinstance(value, list | tuple):
        yield str(len(value)).encode()
        for item in value:
            yield from _parts(item)
    elif (is_dataclass(value) and kind is not type) or hasattr(kind, "model_fields"):
        names = [f.name for f in fields(value)] if is_dataclass(value) else kind.model_fields
        for name in names:
            if name not in PROVENANCE:
                yield name.encode()
                yield from _parts(getattr(value, name))
    else:
        raise TypeError(f"{kind.__qualname__} has no content that could be told")
