"""Values as TOML writes them."""

import json
from datetime import date, datetime, time
from typing import Any


def toml_text(text: str) -> str:
    """TOML string; one of several lines keeps them."""
    lines = [json.dumps(line, ensure_ascii=False)[1:-1] for line in text.split("\n")]
    escaped = "\n".join(lines).replace("\x7f", "\\u007f")  # JSON allows DEL, TOML does not
    return f'"""\n{escaped}"""' if len(lines) > 1 else f'"{escaped}"'


def toml_value(value: Any) -> str:
    """TOML of a value that TOML can hold; tables within tables stand on the line, in braces."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return toml_text(value)
    if isinstance(value, datetime | date | time):
        return value.isoformat()
    if isinstance(value, dict):
        inside = ", ".join(f"{key} = {toml_value(each)}" for key, each in value.items())
        return f"{{ {inside} }}" if inside else "{}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(toml_value(each) for each in value)}]"
    return repr(value)
