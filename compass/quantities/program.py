"""Numbers about the program's own work."""

from compass.quantities.record import Quantity

PROGRAM = (
    Quantity("warm.command", "1", "command", form="text", meaning="What was run."),
    Quantity(
        "warm.elapsed_s", "s", "time", 3, "less", meaning="By the clock, its compilation included."
    ),
)
