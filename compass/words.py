"""Words with numbers in sentences."""


def counted(number: int, noun: str) -> str:
    """A number and its noun, of many where it is not one: ``1 satellite, 2 satellites``."""
    many = "es" if noun.endswith(("ch", "s")) and not noun.endswith("och") else "s"
    return f"{number} {noun}" if number == 1 else f"{number} {noun}{many}"


def listed(words: list[str]) -> str:
    """Words with commas between, and an "and" before the last."""
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)
