"""Telling what was found: pictures, tables and one self-contained HTML page."""
