"""What all results have in common: they say whether the claim holds and print themselves."""

from abc import ABC, abstractmethod
from typing import Any

from compass.document import Page, html, text


class Result(ABC):
    """What a command found.

    Printed it is the command's text, in a notebook the same as HTML, and ``to_dict()`` is what
    ``--json`` prints.
    """

    @property
    def holds(self) -> bool:
        """Whether the claim asked about holds; the command's exit status is 1 if not."""
        return True

    @abstractmethod
    def document(self) -> Page:
        """The result as blocks, the answer first."""

    @abstractmethod
    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON, keyed by names with units; infinite and missing ones are None."""

    def __str__(self) -> str:
        return text(self.document())

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return html(self.document())
