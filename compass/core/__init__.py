"""Compiled kernels: floats and arrays in, floats and arrays out, SI units and radians."""
