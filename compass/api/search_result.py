"""The patterns that a search found, as text, numbers, picture and file."""

from dataclasses import dataclass, replace
from math import degrees, radians
from pathlib import Path
from typing import TYPE_CHECKING, Any

from compass.api.results import Result
from compass.coverage.certified_percentile import bounded
from compass.design import PDOP_MAX
from compass.document import Page, Proven, Sentence, Table, Value, Verdict
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.handover.toml import constellation_toml
from compass.orbits.kinds import ROSETTE
from compass.orbits.pattern import rosette_notation
from compass.quantities import quantity
from compass.saving import replacing
from compass.sites import Mask
from compass.study import search as engine

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Candidates that the text lists.
LISTED = 25


@dataclass(frozen=True, repr=False)
class SearchResult(Result):
    """Patterns that cover, smallest first, then by the highest mask.

    Attributes
    ----------
    fold, mask_deg, radius_km, figure, pattern, max_satellites, beyond
        What was looked for.
    candidates
        What was found.
    least_approach_deg, kept_out
        Those whose satellites come nearer to each other than this were kept out, smallest first.
    """

    fold: int
    mask_deg: float
    radius_km: float
    figure: str
    pattern: str
    max_satellites: int
    beyond: int
    candidates: tuple[engine.Candidate, ...]
    least_approach_deg: float = 0.0
    kept_out: tuple[engine.Candidate, ...] = ()

    @property
    def holds(self) -> bool:
        """Whether there is any."""
        return bool(self.candidates)

    @property
    def tried(self) -> int:
        """Largest size that was tried."""
        if not self.candidates:
            return self.max_satellites
        return min(self.candidates[0].constellation.size + self.beyond, self.max_satellites)

    @property
    def best(self) -> engine.Candidate:
        """The smallest with the highest mask.

        Raises
        ------
        ArgumentError
            Nothing was found.
        """
        if not self.candidates:
            raise ArgumentError(f"search: {self._claim()}")
        return self.candidates[0]

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return plain(
            {
                "fold": self.fold,
                "mask_deg": self.mask_deg,
                "radius_km": self.radius_km,
                "figure": self.figure,
                "pattern": self.pattern,
                "max_satellites": self.max_satellites,
                "beyond": self.beyond,
                "tried": self.tried,
                "smallest": self.best.constellation.size if self.holds else None,
                "candidates": [
                    candidate.as_dict() | {"pattern": self.pattern} for candidate in self.candidates
                ],
                "least_approach_deg": self.least_approach_deg,
                "kept_out": [candidate.as_dict() for candidate in self.kept_out],
                "sentence": self.sentence,
                "evidence": "fold and margins proven; geometry between proven bounds, as _bracket",
            }
        )

    @property
    def sentence(self) -> str:
        """What to build, what is next best, and what was kept out and why."""
        kept = ""
        if self.kept_out:
            first = self.kept_out[0]
            angle = degrees(first.closest_approach)
            kept = (
                f"; kept out: {len(self.kept_out)} whose satellites come within "
                f"{self.least_approach_deg:g} deg of each other, the smallest "
                f"{self._notation(first)} ({angle:.2f} deg)"
            )
        if not self.holds:
            return f"{self._claim()}{kept}."
        following = self._notation(self.candidates[1]) if len(self.candidates) > 1 else "none found"
        near = Value(
            quantity("closest_approach_deg"), degrees(self.best.closest_approach), Proven()
        )
        return (
            f"Build {self._notation(self.best)}: {self.best.constellation.size} satellites, "
            f"{self._has()}; closest approach {near} deg; "
            f"next best {following}{kept}."
        )

    def _claim(self) -> str:
        if not self.holds:
            none = f"no {self.pattern} of up to {self.max_satellites} satellites"
            return f"{none} has {self._wanted()}"
        size = self.best.constellation.size
        return f"{size} satellites, {self._notation(self.best)}, have {self._has()}"

    def _has(self) -> str:
        """What the best has: what was wanted, and how high the mask may be."""
        margin = Value(quantity("mask_margin_deg"), degrees(self.best.mask_margin), Proven())
        return f"{self._wanted()}; highest mask {margin} deg"

    def _wanted(self) -> str:
        return (
            f"continuous {self.fold}-fold coverage above {self.mask_deg:g} deg at "
            f"{self.radius_km:.6g} km"
        )

    def document(self) -> Page:
        """The smallest, then all that were found."""
        title = f"Smallest {self.pattern}"
        if not self.holds:
            said = Verdict("none", self._claim(), False)
            return Page(title, (said, *([Sentence(self.sentence)] if self.kept_out else [])))
        count = len(self.candidates)
        how = (
            f"every pattern of up to {self.tried} satellites at its best inclination to "
            f"0.01 deg, by branch and bound; {count} have the fold. Highest masks are proven, "
            "rounding on the safe side; finalists have a certificate of their own, and GDOP and "
            f"the share of area and time with PDOP at most {PDOP_MAX:g} between proven bounds"
        )
        if self.tried < self.max_satellites:
            how += (
                f". Larger ones, up to {self.max_satellites}, were not tried: beyond says how many "
                "sizes past the smallest to try (--beyond)"
            )
        verdict = Verdict("found", self._claim(), True)
        return Page(title, (verdict, self._table(), Sentence(how), Sentence(self.sentence)))

    def plot(self, *, axes: "Axes | None" = None) -> "Axes":
        """Draw the highest mask of every candidate, smallest first.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.bars import draw_bars

        shown = self.candidates[:LISTED]
        return draw_bars(
            axes,
            [self._notation(candidate) for candidate in shown],
            [degrees(candidate.mask_margin) for candidate in shown],
            quantity("mask_margin_deg"),
            f"{self.fold}-fold coverage at {self.radius_km:.6g} km",
        )

    def _notation(self, candidate: engine.Candidate) -> str:
        """What to call a pattern, in the notation of the kind that was looked for."""
        pattern: Any = candidate.constellation.pattern
        if self.pattern != ROSETTE.name:
            return str(pattern.notation)
        return rosette_notation(pattern.satellites, pattern.planes, pattern.multiplier)

    def _table(self) -> Table:
        names = (
            "satellites", "inclination_deg", "cap_radius_min_deg", "mask_margin_deg",
            "closest_approach_deg", "gdop_p95", "availability",
        )  # fmt: skip
        rows = []
        for candidate in self.candidates:
            known = candidate.as_dict()
            certificate = "proven" if candidate.proven else ""
            numbers = (_cell(name, known) for name in names)
            rows.append((self._notation(candidate), *numbers, certificate))
        header = ("pattern", *(quantity(name).heading for name in names), "certificate")
        return Table("Patterns that cover", header, tuple(rows), LISTED)

    def write(self, path: str | Path, *, command: str = "compass.search") -> None:
        """Write the best as a design file.

        Raises
        ------
        ArgumentError, OutputError
            Nothing was found, or the file cannot be written.
        """
        text = constellation_toml(
            self.best.constellation,
            FIGURES[self.figure],
            mask=Mask.constant(radians(self.mask_deg)),
            fold=self.fold,
            source=f"Smallest of its kind with continuous {self.fold}-fold coverage, found by: "
            f"{command}. Highest mask {degrees(self.best.mask_margin):.4f} deg.",
        )
        with replacing(Path(path)) as temporary:
            temporary.write_text(text, encoding="utf-8")


def _cell(name: str, known: dict[str, Any]) -> Value | str:
    """One number of a candidate, with what is known of it; nothing where it was not asked for."""
    if known[name] is None:
        return ""
    value = bounded(name, known, name)
    return value if value.evidence else replace(value, evidence=Proven())
