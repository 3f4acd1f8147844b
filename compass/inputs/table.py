"""What all tables of files have in common."""

import unicodedata
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationInfo, field_validator


class Table(BaseModel):
    """A TOML table: no unknown keys, no silent conversion, no nan or inf, text that can be shown.

    A text is one line, but for `source`. Anything else in it would be drawn, printed and written
    as something else than what it is: a terminal obeys it, a file format ends a line there.
    """

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)

    @field_validator("*", mode="after")
    @classmethod
    def _shown(cls, given: Any, info: ValidationInfo) -> Any:
        lines = "\n\t" if info.field_name == "source" else ""
        for letter in given if isinstance(given, str) else "":
            if unicodedata.category(letter) == "Cc" and letter not in lines:
                raise ValueError(f"has the control character U+{ord(letter):04X}; leave it out")
        return given
