"""How numbers stand in TOML."""

from collections.abc import Callable

import numpy as np


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
