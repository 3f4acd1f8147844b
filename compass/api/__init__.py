"""One file a command: its options, its result, its function.

A function takes a design, scenario or study (or the path of its file) and keyword options with
their units in their names, and returns a frozen result that prints itself as the command prints.
"""
