"""Numbers of the kinds of measurement and of filter, for kernels and their callers; no kernel."""

#: Kinds of measurement, a number each: range and its rate by radio one way; both ways, where no
#: clock of the lander enters; distance from the centre; direction to a source (three components)
#: and velocity relative to it (three).
RANGE, RATE, ECHO, ECHO_RATE, HEIGHT, BEARING, VELOCITY = 0, 1, 2, 3, 4, 5, 8

#: Ways of filtering: extended; through spread points; looking back; extended, its covariance
#: carried as a root, see `compass.core.entry.root`.
PLAIN, UNSCENTED, RELINEARISED, ROOTED = range(4)
