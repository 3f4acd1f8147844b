"""Words with numbers in sentences."""

from math import floor, remainder
from numbers import Integral


def counted(number: float, noun: str) -> str:
    """A number and its noun, of many where it is not one: ``1 satellite, 2 satellites``.

    Fractions have six digits: ``0.5 days``.
    """
    hisses = noun.endswith(("ch", "s", "x")) and not noun.endswith("och")
    many = "" if number == 1 else "es" if hisses else "s"
    return f"{number if isinstance(number, Integral) else format(number, 'g')} {noun}{many}"


def days_words(days: float) -> str:
    """Days that something lasts, never more than it does.

    Whole ones, of few two decimals, and minutes where those would say 0.
    """
    if days < 0.01:
        minutes = floor(1440 * days)
        return counted(minutes, "minute") if minutes else "less than a minute"
    return counted(floor(days) if days >= 10 else floor(100 * days) / 100, "day")


def latitude_words(degrees: float, form: str = ".2f") -> str:
    """A latitude as people read it, north or south; files and options have it signed."""
    said = format(abs(degrees), form)
    if float(said) == 0.0:
        return "the equator"
    return f"{said}° {'N' if degrees > 0 else 'S'}"


def longitude_words(degrees: float, form: str = ".2f") -> str:
    """A longitude as people read it, east or west by no more than half a turn."""
    turned = remainder(degrees, 360.0)
    said = format(abs(turned), form)
    return f"{said}° {'E' if turned >= 0.0 or float(said) in (0.0, 180.0) else 'W'}"


def place_words(latitude_deg: float, longitude_deg: float, form: str = ".2f") -> str:
    """A place as people read it: ``41.83° S, 10.67° E``."""
    return f"{latitude_words(latitude_deg, form)}, {longitude_words(longitude_deg, form)}"


def capital(words: str) -> str:
    """Words as a sentence begins; what follows the first letter stays, names and signs in it."""
    return words[:1].upper() + words[1:]


def listed(words: list[str]) -> str:
    """Words with commas between, and an "and" before the last."""
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def ordinal(number: int) -> str:
    """The number of one in a row: ``1st, 2nd, 3rd, 4th, 11th``."""
    last = "th" if number // 10 % 10 == 1 else {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
    return f"{number}{last}"
