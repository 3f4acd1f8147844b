"""GDOP, not exceeded in 95 % of the time, by place."""

import compass

made = compass.map("designs/compass-15-5-1.toml", step_deg=2, epochs=31)
axes = made.plot("gdop", percentile=95)
