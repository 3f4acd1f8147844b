"""Numbers of the kinds of measurement, for kernels and for those who call them; no kernel."""

#: Kinds of measurement, a number each: range and its rate by radio one way; both ways, where no
#: clock of the lander enters; distance from the centre; direction to a source (three components)
#: and velocity relative to it (three).
RANGE, RATE, ECHO, ECHO_RATE, HEIGHT, BEARING, VELOCITY = 0, 1, 2, 3, 4, 5, 8
