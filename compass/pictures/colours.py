"""Colours of numbers: a count has one colour on every picture, too few in view are red."""

from matplotlib import colormaps
from matplotlib.colors import ListedColormap

#: Counts up to this have colours of their own.
DISTINCT = 12


def count_colours(wanted: int, most: int = DISTINCT) -> list[tuple[float, ...]]:
    """Colours of 0, 1, ... `most` satellites in view: reds below `wanted`, then as they are many.

    The same count has the same colour whatever `most` is.
    """
    few, enough = colormaps["Reds_r"], colormaps["viridis"]
    reds = [few(0.1 + 0.45 * k / max(wanted, 1)) for k in range(wanted)]
    above = [enough(min(k / max(DISTINCT - wanted, 4), 1.0)) for k in range(most + 1)]
    return [tuple(colour) for colour in [*reds, *above][: most + 1]]


def count_map(wanted: int, low: int, high: int) -> ListedColormap:
    """Colour map of the counts from `low` to `high`, one colour each."""
    return ListedColormap(count_colours(wanted, max(high, low))[low:])
