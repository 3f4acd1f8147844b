"""Kernels of the landing engine: flight, transition, measurements, filter, runs."""
