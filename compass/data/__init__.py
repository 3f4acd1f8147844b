"""Tables that the package carries, each with its source in its head."""
