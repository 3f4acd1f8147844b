"""What a file may say, as JSON Schema for editors and other programs."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from compass.api.results import Result
from compass.arguments import checked
from compass.document import Page, Table
from compass.inputs.commented import Key
from compass.inputs.shipped import model_of

DIALECT = "https://json-schema.org/draft/2020-12/schema"


@dataclass(frozen=True, repr=False)
class SchemaResult(Result):
    """JSON Schema of a kind of file.

    Attributes
    ----------
    kind
        ``design``, ``scenario`` or ``study``.
    schema
        The schema, as plain values.
    """

    kind: str
    schema: Mapping[str, Any]

    def to_dict(self) -> dict[str, Any]:
        """The schema."""
        return dict(self.schema)

    def document(self) -> Page:
        """Keys at the top of the file, with their meaning."""
        fields = model_of(self.kind).model_fields
        rows = tuple((name, Key(name, field).comment) for name, field in fields.items())
        return Page(f"{self.kind} file", (Table("Keys", ("key", "meaning"), rows),))

    def __str__(self) -> str:
        return json.dumps(self.to_dict(), indent=2, ensure_ascii=False)


@checked
def schema(kind: str) -> SchemaResult:
    """Return the JSON Schema of a design, scenario or study file.

    It is made from the models that read the file. What concerns several keys at once (planes
    that divide satellites) is checked when the file is read, and not in the schema.

    Parameters
    ----------
    kind
        ``design``, ``scenario`` or ``study``.

    Raises
    ------
    ArgumentError
        No such kind.

    Examples
    --------
    >>> import compass
    >>> compass.schema("study").to_dict()["required"]
    ['name', 'study', 'objective']
    """
    made = model_of(kind).model_json_schema()
    return SchemaResult(kind, {"$schema": DIALECT, **made})
