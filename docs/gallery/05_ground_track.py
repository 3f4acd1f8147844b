"""Where a lander flies, and which beacons see it."""

import compass

axes = compass.land("designs/entry-ground-beacons.toml", runs=20).plot()
