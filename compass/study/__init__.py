"""Many designs through the same functions."""
