"""Numbers of the kinds of measurement and of filter, for kernels and their callers; no kernel."""

#: Kinds of measurement, a number each: range and its rate by radio one way; both ways, where no
#: clock of the lander enters; distance from the centre; direction to a source (three components)
#: and velocity relative to it (three); what the accelerometers read (three).
RANGE, RATE, ECHO, ECHO_RATE, HEIGHT, BEARING, VELOCITY, ACCELERATION = 0, 1, 2, 3, 4, 5, 8, 11

#: Ways of filtering: extended; through spread points; looking back; extended, its covariance
#: carried as a root, see `compass.core.entry.root`; extended, what an epoch tells gathered as
#: information.
PLAIN, UNSCENTED, RELINEARISED, ROOTED, INFORMATION = range(5)
