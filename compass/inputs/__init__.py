"""Design files: what a user writes down, checked in full and turned into things."""

from compass.inputs.design import read_design, read_design_text

__all__ = ["read_design", "read_design_text"]
