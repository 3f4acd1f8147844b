"""The globe one can turn: what it shows as plain values, and the piece of page that draws it."""
