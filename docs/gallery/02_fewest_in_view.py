"""Fewest satellites in view of a Ballard rosette: red is fewer than wanted."""

import compass

made = compass.map("designs/rosette-12-3-quarter.toml", step_deg=2, epochs=31)
axes = made.plot("count_min")
