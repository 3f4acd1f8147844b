"""Every number of a source paper: published, computed, and who is right."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from compass.api.results import Result
from compass.document import Page, Table, Verdict
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.papers import PAPERS
from compass.papers.verdict import Row


@dataclass(frozen=True, repr=False)
class ReproduceResult(Result):
    """A paper's numbers beside the computed ones.

    Attributes
    ----------
    paper, title
        Key and title of the paper.
    rows
        One a number or claim.
    """

    paper: str
    title: str
    rows: tuple[Row, ...]

    @property
    def differs(self) -> tuple[Row, ...]:
        """Rows that differ without an erratum on record."""
        return tuple(row for row in self.rows if not row.holds)

    @property
    def holds(self) -> bool:
        """Whether every row is reproduced or its difference explained."""
        return not self.differs

    def _counts(self) -> dict[str, int]:
        return {
            "reproduced": sum(row.verdict == "reproduced" for row in self.rows),
            "errata": sum(row.verdict.startswith("erratum") for row in self.rows),
            "differs": len(self.differs),
        }

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        rows = [row.as_dict() for row in self.rows]
        return plain({"paper": self.paper, "title": self.title, "rows": rows} | self._counts())

    def document(self) -> Page:
        """How many agree, then every row."""
        counts = self._counts()
        verdict = Verdict(
            "explained" if self.holds else "unexplained",
            f"{len(self.rows)} rows: {counts['reproduced']} reproduced, {counts['errata']} errata, "
            f"{counts['differs']} unexplained",
            self.holds,
        )
        table = comparison_table("Published and computed", self.rows)
        return Page(self.title, (verdict, table))


def comparison_table(title: str, rows: Sequence[Row]) -> Table:
    """Table of published against computed."""
    header = ("where", "item", "published", "computed", "unit", "verdict")
    cells = ((r.where, r.item, r.published or "–", r.computed, r.unit, r.verdict) for r in rows)
    return Table(title, header, tuple(cells))


def reproduce(paper: str) -> ReproduceResult:
    """Every number of a source paper: published, computed, and who is right.

    Parameters
    ----------
    paper
        Its key, one of `compass.papers.PAPERS`.

    Raises
    ------
    ArgumentError
        There is no such paper.

    Examples
    --------
    >>> import compass
    >>> found = compass.reproduce("ballard1980")
    >>> found.holds
    True
    """
    if paper not in PAPERS:
        raise ArgumentError(f"paper = {paper!r}: not known; allowed {', '.join(PAPERS)}")
    module = import_module(f"compass.papers.{paper}")
    return ReproduceResult(paper, module.TITLE, tuple(module.rows()))
