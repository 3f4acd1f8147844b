"""Maps row by row: what is found of some rows of a grid, and who does them."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from threading import Event
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from compass.cores import cores
from compass.coverage.grid import Grid

#: Pieces of work, the same whoever does them, so that sums come out the same.
BLOCKS = 32


class Part(NamedTuple):
    """What is found of some rows.

    Attributes
    ----------
    cells
        Figures of their cells by name, shape (..., row, column).
    sums
        What is added up over rows.
    """

    cells: dict[str, NDArray]
    sums: tuple[NDArray, ...] = ()


#: Finds the part of some rows.
RowWork = Callable[[Sequence[int]], Part]


class Rows(Protocol):
    """Who does the rows of a grid."""

    def __call__(self, kind: str, work: RowWork, grid: Grid) -> Iterator[tuple[NDArray, Part]]:
        """Yield each block of rows and what was found of it, in their order.

        Whoever cannot be given `work` as it is knows it by its `kind`.
        """


def blocks_of(grid: Grid) -> list[NDArray[np.int64]]:
    """Rows of a grid in blocks."""
    return np.array_split(np.arange(grid.rows), min(BLOCKS, grid.rows))


def by_threads(workers: int | None, progress: Callable[[int], None]) -> Rows:
    """Do rows on this machine; who goes away before the end waits for rows at work, no more.

    Parameters
    ----------
    workers
        Threads; by default one a core.
    progress
        Called with the number of rows just finished.
    """

    def do(kind: str, work: RowWork, grid: Grid) -> Iterator[tuple[NDArray, Part]]:
        blocks, left = blocks_of(grid), Event()
        with ThreadPoolExecutor(cores(workers)) as pool:
            try:
                parts = pool.map(lambda block: work(_Wanted(block, left)), blocks)
                for block, part in zip(blocks, parts, strict=True):
                    yield block, part
                    progress(block.size)
            finally:
                left.set()

    return do


class _Wanted(Sequence[int]):
    """Rows of a block, which end early if nobody waits for them any more."""

    def __init__(self, block: NDArray[np.int64], left: Event) -> None:
        self._block, self._left = block, left

    def __len__(self) -> int:
        return self._block.size

    def __getitem__(self, k):  # type: ignore[no-untyped-def]
        if self._left.is_set():
            raise IndexError
        return self._block[k]


def gathered(
    parts: Iterable[tuple[NDArray, Part]],
    grid: Grid,
    add: Callable[..., None] = lambda *sums: None,
) -> dict[str, NDArray]:
    """Figures of all cells by name; the sums of each block are given to `add`, in its order."""
    whole: dict[str, NDArray] = {}
    for rows, part in parts:
        for name, values in part.cells.items():
            if name not in whole:
                shape = (*values.shape[:-2], grid.rows, values.shape[-1])
                whole[name] = np.empty(shape, values.dtype)
            whole[name][..., rows, :] = values
        add(*part.sums)
    return whole
