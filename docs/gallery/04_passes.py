"""When a rover on the equator sees each satellite."""

import compass

found = compass.access(
    "designs/walker-15-26000km.toml", stations=["Rover=0,137.4,10"], duration_sols=3
)
axes = found.plot("Rover")
