"""Plain values for JSON."""

import math
from enum import Enum
from typing import Any


def plain(value: Any) -> Any:
    """Plain JSON values of dicts, sequences, numpy scalars and arrays; non-finite is None."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, Enum):
        return plain(value.value)
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
