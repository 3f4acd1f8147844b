"""Maps on a Dask cluster: rows of a grid are done by its workers, to the same bytes."""

from collections.abc import Callable, Iterator

from numpy.typing import NDArray

from compass.coverage.grid import Grid
from compass.coverage.rows import Part, Rows, RowWork, blocks_of
from compass.errors import CompassError
from compass.study.cluster import Cluster


def by_cluster(cluster: Cluster, progress: Callable[[int], None]) -> Rows:
    """Let the workers of a cluster do rows, who know the map.

    They finish in any order; blocks are given on in theirs, so that sums are the same.

    Raises
    ------
    CompassError
        Workers died of some rows.
    """

    def do(kind: str, work: RowWork, grid: Grid) -> Iterator[tuple[NDArray, Part]]:
        waiting: dict[int, tuple[NDArray, Part]] = {}
        due = 0
        for rows, found in cluster.run(kind, blocks_of(grid)):
            if found is None:
                raise CompassError(
                    f"workers died of row {rows[0]} of the map: they may lack memory; ask for "
                    "larger cells or fewer epochs"
                )
            waiting[int(rows[0])] = rows, found
            while due in waiting:
                yield waiting[due]
                size = waiting.pop(due)[0].size
                progress(size if kind != "gaps" else 0)
                due += size

    return do
