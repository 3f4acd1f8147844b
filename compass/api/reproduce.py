"""Every number of a source paper: published, computed, and who is right."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import compass
from compass.api.results import Result
from compass.arguments import checked
from compass.conventions import epoch_text
from compass.document import Page, Picture, Table
from compass.document import Verdict as Answer
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.papers import PAPERS
from compass.papers.verdict import Row, Verdict
from compass.pictures.files import check_folder, write_pictures
from compass.saving import replacing, save_netcdf, write_csv

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

#: Papers with figures drawn from data.
DRAWN = ("kelly2018",)


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
        """Rows that differ without a demonstrated error of the paper."""
        return tuple(row for row in self.rows if not row.holds)

    @property
    def holds(self) -> bool:
        """Whether no row differs."""
        return not self.differs

    @property
    def counts(self) -> dict[str, int]:
        """How many rows have each verdict."""
        return {str(kind): sum(row.verdict is kind for row in self.rows) for kind in Verdict}

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        rows = [row.as_dict() for row in self.rows]
        return plain({"paper": self.paper, "title": self.title, "rows": rows} | self.counts)

    def plot(self, *, axes: "Axes | None" = None) -> "Axes":
        """Draw how far each number found is from the printed one, in its tolerances.

        Numbers within one tolerance agree. Statements, and rows without a printed number, have no
        place.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.style import CYCLE, MARS, axes_or_new, look

        rows = [(row, off) for row in self.rows if (off := row.off) is not None]
        drawn = axes_or_new(axes, 8.0, 1.8 + 0.16 * len(rows))
        colours = {Verdict.DIFFERS: MARS, Verdict.ERRATUM: CYCLE[4]}
        with look():
            drawn.axvspan(-1.0, 1.0, color=CYCLE[2], alpha=0.15)
            for verdict in Verdict:
                places = [k for k, (row, _) in enumerate(rows) if row.verdict is verdict]
                if places:
                    drawn.plot(
                        [rows[k][1] for k in places], places, "o", markersize=4,
                        color=colours.get(verdict, CYCLE[0]), label=str(verdict),
                    )  # fmt: skip
            drawn.set_xscale("symlog", linthresh=1.0)
            drawn.set_yticks(range(len(rows)), [row.item for row, _ in rows], fontsize=7)
            drawn.set_ylim(max(len(rows), 4) - 0.5, -0.5)
            drawn.set(
                xlabel="found less printed, in tolerances",
                title=f"{self.paper}: {len(rows)} numbers",
            )
            if rows:
                drawn.legend(loc="lower right")
        return drawn

    def pictures(self) -> tuple[Picture, ...]:
        """Draw the figures of the paper that have data here; none for a paper without any."""
        return tuple(image for image, _ in self._figures())

    def write(self, folder: str | Path) -> None:
        """Write the rows as CSV and every figure as picture (SVG, maps PNG) and data (netCDF).

        Parameters
        ----------
        folder
            Made if its parent exists.

        Raises
        ------
        OutputError
            The folder or a file in it cannot be written.
        """
        place = Path(folder)
        check_folder(place)
        figures = self._figures()
        write_pictures([image for image, _ in figures], place)
        for image, data in figures:
            attrs = {
                "title": f"{image.title}. {self.title}",
                "history": f"compass reproduce {self.paper}, version {compass.__version__}",
                "epoch_tdb": epoch_text(0.0),  # the paper says none
            }
            save_netcdf(place / f"{image.stem}.nc", data.assign_attrs(attrs))
        with replacing(place / "rows.csv") as temporary:
            plain_rows = [row.as_dict() for row in self.rows]
            write_csv(temporary, list(plain_rows[0]), [list(row.values()) for row in plain_rows])

    def _figures(self) -> list[tuple[Picture, "xr.Dataset"]]:
        if self.paper not in DRAWN:
            return []
        from compass.papers.kelly2018_figures import FIGURES_OF_THE_PAPER
        from compass.pictures.kelly2018 import draw_figure

        made = [(figure, figure.make()) for figure in FIGURES_OF_THE_PAPER]
        return [(draw_figure(figure.number, figure.title, data), data) for figure, data in made]

    def document(self) -> Page:
        """How many agree, then every row."""
        counts = ", ".join(f"{count} {kind}" for kind, count in self.counts.items() if count)
        verdict = Answer(
            "explained" if self.holds else "differs",
            f"{len(self.rows)} rows: {counts}",
            self.holds,
        )
        table = comparison_table("Published and computed", self.rows)
        return Page(self.title, (verdict, table))


def comparison_table(title: str, rows: Sequence[Row]) -> Table:
    """Table of published against computed."""
    header = ("where", "item", "published", "computed", "unit", "agrees if", "verdict")
    cells = (
        (r.where, r.item, r.published or "–", r.computed, r.unit, r.criterion or "–", r.told)
        for r in rows
    )
    return Table(title, header, tuple(cells))


@checked
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
    >>> found = compass.reproduce("montenbruck2018")
    >>> found.holds
    True
    """
    if paper not in PAPERS:
        raise ArgumentError(f"paper = {paper!r}: not known; allowed {', '.join(PAPERS)}")
    module = import_module(f"compass.papers.{paper}")
    return ReproduceResult(paper, module.TITLE, tuple(module.rows()))
