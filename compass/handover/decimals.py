"""How numbers and texts stand in TOML."""

import json
from collections.abc import Callable

import numpy as np


def text(given: str) -> str:
    """TOML string; one of several lines keeps them."""
    lines = [json.dumps(line, ensure_ascii=False)[1:-1] for line in given.split("\n")]
    escaped = "\n".join(lines).replace("\x7f", "\\u007f")  # JSON allows DEL, TOML does not
    return f'"""\n{escaped}"""' if len(lines) > 1 else f'"{escaped}"'


def decimal(value: float, back: Callable[[float], float], wanted: float) -> str:
    """Shortest decimal near `value` that `back` takes to `wanted` exactly; else the nearest."""
    near = [float(value)]
    for _ in range(4):
        near = [np.nextafter(near[0], -np.inf), *near, np.nextafter(near[-1], np.inf)]
    rounded = [float(f"{value:.{digits}g}") for digits in range(1, 17)]
    tried = [*rounded, *near]
    return number(min(tried, key=lambda x: (abs(back(x) - wanted), len(repr(float(x))))))


def number(value: float) -> str:
    """Shortest decimal of a number, whole ones without a point."""
    return repr(float(value)).removesuffix(".0")
