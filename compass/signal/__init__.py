"""What one range is worth: the errors of clocks, orbits, receiver and ionosphere."""
