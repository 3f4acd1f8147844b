"""Units of files and results, in SI."""

KM, KM2 = 1e3, 1e6
