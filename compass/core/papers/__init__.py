"""Kernels of the filters that source papers print, in the papers' own states."""
