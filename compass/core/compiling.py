"""Who is told that a kernel is about to be compiled; asked for before Numba is loaded."""

from collections.abc import Callable

#: Called, from whichever thread compiles, before each compilation.
listeners: list[Callable[[], None]] = []
