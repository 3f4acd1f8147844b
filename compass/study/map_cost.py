"""What a map will take of this machine, known before it begins."""

from dataclasses import dataclass

from compass.cores import cores
from compass.coverage.grid import Grid
from compass.orbits.motion import Motion

# Bytes, as measured: a satellite at an epoch (the same where orbits are integrated, all epochs at
# once), a cell, an epoch of a cell in the row at work.
POSITION_BYTES, INTEGRATED_BYTES, CELL_BYTES, ROW_BYTES = 40, 110, 180, 25
# And with errors besides, in the same order; their forms are made of all epochs at once.
ERROR_POSITION_BYTES, ERROR_CELL_BYTES, ERROR_ROW_BYTES = 700, 50, 20
# Seconds of one core, as measured (`tox -e bench` shows them): a cell at an epoch, and its errors.
CELL_S, ERROR_CELL_S = 5.5e-8, 5.5e-8

#: The same of every satellite of it: in view, at an epoch of gaps too; a fix's errors besides;
#: protection besides. And where no level horizon bounds who is in view.
SATELLITE_S, ERROR_SATELLITE_S, LEVEL_SATELLITE_S = 1.4e-9, 2.6e-9, 6e-7
SLANTED_S, SLANTED_ERROR_S, SLANTED_LEVEL_S = 3e-8, 3e-8, 9e-7


@dataclass(frozen=True)
class Cost:
    """What a map will take of this machine: seconds, to a factor of two, and bytes."""

    seconds: float
    bytes: float


def map_cost(
    satellites: int,
    epochs: int,
    grid: Grid,
    workers: int | None,
    motion: Motion,
    *,
    errors: bool = False,
    levels: bool = False,
    slanted: bool = False,
    gap_epochs: int = 0,
) -> Cost:
    """Work out what a map will take.

    Held are the positions of every satellite at every epoch (with what is made on the way to
    them, where that is not done in pieces), the figures of every cell, and the dilutions of a row
    that each thread sorts.

    Parameters
    ----------
    satellites, epochs, grid, workers, motion
        What is mapped, by how many threads.
    errors, levels
        Whether errors in metres, and protection levels, are mapped besides.
    slanted
        Whether users look down or stand in beams: who is in view is asked cell by cell then.
    gap_epochs
        Epochs at which gaps are followed.
    """
    threads = cores(workers)
    cells = grid.rows * grid.columns
    needed = (
        (POSITION_BYTES if motion.is_closed_form else INTEGRATED_BYTES) * satellites * epochs
        + CELL_BYTES * cells
        + ROW_BYTES * threads * grid.columns * epochs
    )
    in_view = SLANTED_S if slanted else SATELLITE_S
    cell, each = CELL_S, in_view
    if errors:
        needed += (
            ERROR_POSITION_BYTES * satellites * epochs
            + ERROR_CELL_BYTES * cells
            + ERROR_ROW_BYTES * threads * grid.columns * epochs
        )
        cell += ERROR_CELL_S
        each += SLANTED_ERROR_S if slanted else ERROR_SATELLITE_S
    if levels:
        each += SLANTED_LEVEL_S if slanted else LEVEL_SATELLITE_S
    seconds = (cell + each * satellites) * epochs + in_view * satellites * gap_epochs
    return Cost(seconds * cells / threads, needed)
