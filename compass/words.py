"""Words with numbers in sentences."""


def counted(number: int, noun: str) -> str:
    """A number and its noun, which has an s unless there is one: ``1 satellite, 2 satellites``."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
