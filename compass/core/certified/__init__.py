"""Bounds of dilution of precision over boxes of latitude, longitude and time."""
