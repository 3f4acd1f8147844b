"""Published numbers, each file with its source in its head, and the problems they solve."""
