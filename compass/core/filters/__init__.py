"""Filters for entry navigation, one algorithm a file, all with the interface of `common`."""
