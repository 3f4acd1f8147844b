"""The smallest constellations with continuous k-fold coverage, every pattern of every size."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, radians
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from compass.api.progress import bar
from compass.api.requirement_search import RequirementSearchResult, needs_of
from compass.api.results import Result
from compass.coverage.certified_effort import Effort
from compass.design import PDOP_MAX, Requirement
from compass.document import Bracket, Page, Proven, Sentence, Table, Value, Verdict
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.frames import FIGURES, Figure
from compass.handover.toml import constellation_toml
from compass.orbits.kinds import ROSETTE
from compass.orbits.pattern import rosette_notation
from compass.orbits.patterns import orbit_radius
from compass.quantities import quantity
from compass.saving import replacing
from compass.sites import Mask
from compass.study import search as engine
from compass.study.requirement_question import Question
from compass.study.requirement_search import search_for

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Orbits are of less than this, metres.
MOST_RADIUS = 1e10

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
        near = degrees(self.best.closest_approach)
        return (
            f"Build {self._notation(self.best)}: {self._claim()}; closest approach {near:.1f} deg; "
            f"geometry was not asked for; next best {following}{kept}."
        )

    def _claim(self) -> str:
        wanted = (
            f"continuous {self.fold}-fold coverage above {self.mask_deg:g} deg at "
            f"{self.radius_km:.6g} km"
        )
        if not self.holds:
            return f"no {self.pattern} of up to {self.max_satellites} satellites has {wanted}"
        best = self.best.constellation
        margin = Value(quantity("mask_margin_deg"), degrees(self.best.mask_margin), Proven())
        return (
            f"{best.size} satellites, {self._notation(self.best)}, have {wanted}; highest mask "
            f"{margin} deg"
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
                f". Larger ones, up to {self.max_satellites}, were not tried: ask how many sizes "
                "beyond the smallest to try (beyond)"
            )
        found = Verdict("found", self._claim(), True)
        return Page(title, (found, self._table(), Sentence(how), Sentence(self.sentence)))

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


def search(
    *,
    max_satellites: int,
    require: str | Path | Sequence[Requirement] | None = None,
    fold: int | None = None,
    mask_deg: float = 0.0,
    region: str | Sequence[str] = (),
    pdop_at_most: float | None = None,
    gdop_at_most: float | None = None,
    share: float = 1.0,
    share_of: Literal["time", "area-time"] = "time",
    radius_km: float | None = None,
    altitude_km: float | None = None,
    orbit: str | None = None,
    repeat: Sequence[int] | None = None,
    least_approach_deg: float = 1.0,
    beyond: int = 0,
    pattern: str = "walker-delta",
    figure: str = "iau-sphere",
    finalists: int = 10,
    budget_s: float | None = None,
    workers: int | None = None,
    progress: bool = False,
) -> SearchResult | RequirementSearchResult:
    """Find the smallest patterns that meet requirements, or cover the whole sphere k-fold.

    With requirements, a region or a limit on geometry: every pattern of every size at every whole
    degree of inclination, and where tracks are closed every turn over the ground, until the
    smallest that meets all of it. Of a fold alone: every pattern, size after size up to the
    smallest that has it, at its best inclination to 0.01 degree; largest mask margin first.

    Parameters
    ----------
    max_satellites
        Largest size to try; the search ends sooner, with the smallest size that does it.
    require
        File with ``[[requirement]]`` (a design may be one), or requirements.
    fold, mask_deg
        Satellites to be in view at once, above a mask, degrees; instead of a file.
    region
        Where, one or several, as in a ``[[requirement]]``; else everywhere.
    pdop_at_most, gdop_at_most, share, share_of
        Geometry wanted there, and for which share.
    radius_km, altitude_km, orbit, repeat
        One of them: radius, altitude over the equator, ``areosynchronous``, or revolutions and
        rotations of Mars after which the ground track closes.
    least_approach_deg
        Least angle that must lie between two satellites at any time, seen from Mars's centre.
    beyond
        How many sizes to try beyond the smallest, of a fold alone.
    pattern
        ``walker-delta``, ``walker-star`` or ``rosette``.
    figure
        Sphere that is to be covered: ``iau-sphere`` or ``kelly2018-sphere``; a file says its own.
    finalists
        How many of the best get a certificate, and GDOP and availability between proven bounds.
    budget_s
        Seconds that each share of geometry wanted may take; by default so many boxes, which is the
        same on any machine.
    workers
        Threads; by default one a core. The result does not depend on it.
    progress
        Show bars on stderr.

    Raises
    ------
    ArgumentError, DesignError
        An option or the file is not allowed.

    Examples
    --------
    >>> import compass
    >>> found = compass.search(fold=1, max_satellites=5, radius_km=20428)
    >>> found.best.constellation.size
    5
    """
    if figure not in FIGURES or not FIGURES[figure].is_sphere:
        spheres = ", ".join(name for name, each in FIGURES.items() if each.is_sphere)
        raise ArgumentError(f"figure = {figure!r}: allowed {spheres}")
    if not 0 <= least_approach_deg < 180:
        raise ArgumentError(
            f"least_approach_deg = {least_approach_deg:g}: allowed 0 up to below 180 degrees"
        )
    if not 0 <= mask_deg < 90:
        raise ArgumentError(f"mask_deg = {mask_deg:g}: allowed 0 up to below 90")
    Effort(budget_s=budget_s)  # refuses what is no budget before anything is looked for
    least, threads = radians(least_approach_deg), workers or os.cpu_count() or 1
    regions = (region,) if isinstance(region, str) else tuple(region)
    named = (("pdop", pdop_at_most), ("gdop", gdop_at_most))
    limits = [(name, limit) for name, limit in named if limit is not None]
    if require is None and not regions and not limits:
        return _covering(
            fold,
            mask_deg,
            _radius(radius_km, altitude_km, orbit, repeat, FIGURES[figure])[0],
            figure,
            pattern,
            max_satellites,
            beyond,
            finalists,
            least_approach_deg,
            threads,
            progress,
        )
    needs = needs_of(
        require,
        regions,
        fold=fold,
        mask_deg=mask_deg,
        limits=limits,
        share=share,
        share_of=share_of,
        figure=figure,
    )
    radius, closed = _radius(radius_km, altitude_km, orbit, repeat, needs.figure)
    question = Question(
        needs.requirements,
        needs.figure,
        needs.mask,
        radius,
        closed,
        least,
        (pattern,),
        max_satellites,
        budget_s,
    )
    outcome = search_for(
        question,
        finalists=min(finalists, 5),
        workers=threads,
        progress=lambda sizes: bar(progress, "sizes", sizes),
    )
    return RequirementSearchResult(question, outcome)


def _covering(
    fold: int | None,
    mask_deg: float,
    radius: float,
    figure: str,
    pattern: str,
    max_satellites: int,
    beyond: int,
    finalists: int,
    least_approach_deg: float,
    workers: int,
    progress: bool,
) -> SearchResult:
    """Smallest patterns that cover the whole sphere."""
    if fold is None:
        raise ArgumentError("fold: missing; give it, a region and a limit, or a file (require)")
    least = radians(least_approach_deg)
    found = engine.search(
        fold,
        radians(mask_deg),
        radius=radius,
        figure=FIGURES[figure],
        largest=max_satellites,
        beyond=beyond,
        kind=pattern,
        finalists=finalists,
        least_approach=least,
        workers=workers,
        progress=lambda work, total: bar(progress, "patterns", work, total=total),
    )
    return SearchResult(
        fold,
        mask_deg,
        radius / 1e3,
        figure,
        pattern,
        max_satellites,
        beyond,
        tuple(c for c in found if c.closest_approach >= least),
        least_approach_deg,
        tuple(c for c in found if c.closest_approach < least),
    )


def _radius(
    radius_km: float | None,
    altitude_km: float | None,
    orbit: str | None,
    repeat: Sequence[int] | None,
    figure: Figure,
) -> tuple[float, tuple[int, int] | None]:
    """Orbit radius, metres, of the one that is given, and how tracks close if that is said."""
    radius, closed = orbit_radius(radius_km, altitude_km, orbit, repeat, figure)
    if not radius < MOST_RADIUS:
        raise ArgumentError(f"radius_km = {radius / 1e3:g}: allowed below {MOST_RADIUS / 1e3:g} km")
    return radius, closed


def _cell(name: str, known: dict[str, Any]) -> Value | str:
    """One number of a candidate, with what is known of it; nothing where it was not asked for."""
    if known[name] is None:
        return ""
    bounds = known.get(f"{name}_bracket")
    return Value(quantity(name), known[name], Bracket(*bounds) if bounds else Proven())
