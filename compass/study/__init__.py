"""Designs through the pipe: one mapped, or many searched, traded and judged."""
