"""Drawing with matplotlib: the look of all pictures, maps of Mars, figures of results."""
