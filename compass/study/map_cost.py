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
# Seconds of one core, as measured (`tox -e bench` shows them): a cell at an epoch, and every
# satellite of it; a satellite of it where errors are asked for; gaps are a satellite of it too.
CELL_S, SATELLITE_S, ERROR_SATELLITE_S = 4e-8, 9e-10, 8e-9


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
    errors: bool = False,
) -> Cost:
    """Work out what a map will take.

    Held are the positions of every satellite at every epoch (with what is made on the way to
    them, where that is not done in pieces), the figures of every cell, and the dilutions of a row
    that each thread sorts.
    """
    threads = cores(workers)
    cells = grid.rows * grid.columns
    needed = (
        (POSITION_BYTES if motion.is_closed_form else INTEGRATED_BYTES) * satellites * epochs
        + CELL_BYTES * cells
        + ROW_BYTES * threads * grid.columns * epochs
    )
    seconds = CELL_S + SATELLITE_S * satellites
    if errors:
        needed += (
            ERROR_POSITION_BYTES * satellites * epochs
            + ERROR_CELL_BYTES * cells
            + ERROR_ROW_BYTES * threads * grid.columns * epochs
        )
        seconds += ERROR_SATELLITE_S * satellites
    return Cost(seconds * cells * epochs / threads, needed)
