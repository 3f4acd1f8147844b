"""The smallest constellations with continuous k-fold coverage, every pattern of every size."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, radians
from pathlib import Path
from typing import Any, Literal

from compass.api.progress import bar
from compass.api.requirement_search import RequirementSearchResult, needs_of
from compass.api.results import Result
from compass.design import Requirement
from compass.document import Page, Proven, Sentence, Table, Value, Verdict
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.frames import FIGURES, Figure
from compass.handover.toml import constellation_toml
from compass.orbits.patterns import orbit_radius
from compass.quantities import quantity
from compass.saving import replacing
from compass.sites import Mask
from compass.study import search as engine
from compass.study.requirement_search import Question, search_for

#: Candidates that the text lists.
LISTED = 25


@dataclass(frozen=True, repr=False)
class SearchResult(Result):
    """Patterns that cover, smallest first, then by the highest mask.

    Attributes
    ----------
    fold, mask_deg, radius_km, figure, pattern, max_satellites
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
    candidates: tuple[engine.Candidate, ...]
    least_approach_deg: float = 0.0
    kept_out: tuple[engine.Candidate, ...] = ()

    @property
    def holds(self) -> bool:
        """Whether there is any."""
        return bool(self.candidates)

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
                "smallest": self.best.constellation.size if self.holds else None,
                "candidates": [candidate.as_dict() for candidate in self.candidates],
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
                f"{self.least_approach_deg:g} deg of each other, the smallest {_notation(first)} "
                f"({angle:.2f} deg)"
            )
        if not self.holds:
            return f"{self._claim()}{kept}."
        following = _notation(self.candidates[1]) if len(self.candidates) > 1 else "none found"
        near = degrees(self.best.closest_approach)
        return (
            f"Build {_notation(self.best)}: {self._claim()}; closest approach {near:.1f} deg; "
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
            f"{best.size} satellites, {_notation(self.best)}, have {wanted}; highest mask "
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
            f"every pattern of up to {self.max_satellites} satellites at its best inclination to "
            f"0.01 deg, by branch and bound; {count} have the fold. Highest masks are proven, "
            "rounding on the safe side; finalists have a certificate of their own"
        )
        found = Verdict("found", self._claim(), True)
        return Page(title, (found, self._table(), Sentence(how), Sentence(self.sentence)))

    def _table(self) -> Table:
        names = (
            "satellites", "inclination_deg", "cap_radius_min_deg", "mask_margin_deg",
            "closest_approach_deg", "gdop_p95",
        )  # fmt: skip
        rows = []
        for candidate in self.candidates:
            known = candidate.as_dict()
            certificate = "proven" if candidate.proven else ""
            numbers = (
                "" if known[name] is None else Value(quantity(name), known[name]) for name in names
            )
            rows.append((_notation(candidate), *numbers, certificate))
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
    pattern: str = "walker-delta",
    figure: str = "iau-sphere",
    finalists: int = 10,
    workers: int | None = None,
    progress: bool = False,
) -> SearchResult | RequirementSearchResult:
    """Find the smallest patterns that meet requirements, or cover the whole sphere k-fold.

    With requirements, a region or a limit on geometry: every pattern of every size at every whole
    degree of inclination, and where tracks are closed every turn over the ground, until the
    smallest that meets all of it. Of a fold alone: every pattern up to the largest size, at its
    best inclination to 0.01 degree; smallest first, then largest mask margin.

    Parameters
    ----------
    max_satellites
        Largest size to try.
    require
        File with ``[[requirement]]`` (a design may be one), or requirements.
    fold, mask_deg
        Satellites to be in view at once, above a mask, degrees; instead of a file.
    region
        Where, one or several, as in a ``[[requirement]]``; else everywhere.
    pdop_at_most, gdop_at_most, share, share_of
        Geometry wanted there, for which share.
    radius_km, altitude_km, orbit, repeat
        One of them: radius, altitude over the equator, ``areosynchronous``, or revolutions and
        rotations of Mars after which tracks close.
    least_approach_deg
        Least angle that must lie between two satellites at any time, seen from Mars's centre.
    pattern
        ``walker-delta``, ``walker-star`` or ``rosette``.
    figure
        Sphere that is to be covered: ``iau-sphere`` or ``kelly2018-sphere``; a file says its own.
    finalists
        How many of the best get a certificate and their GDOP.
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
    sphere = FIGURES[figure].equatorial_radius
    regions = (region,) if isinstance(region, str) else tuple(region)
    named = (("pdop", pdop_at_most), ("gdop", gdop_at_most))
    limits = [(name, limit) for name, limit in named if limit is not None]
    threads = workers or os.cpu_count() or 1
    if require is not None or regions or limits:
        if not 0 <= mask_deg < 90:
            raise ArgumentError(f"mask_deg = {mask_deg:g}: allowed 0 up to below 90")
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
        surface = needs.figure.equatorial_radius
        radius, closed = _radius(radius_km, altitude_km, orbit, repeat, surface)
        question = Question(
            needs.requirements,
            needs.figure,
            needs.mask,
            radius,
            closed,
            radians(least_approach_deg),
            (pattern,),
            max_satellites,
        )
        outcome = search_for(
            question,
            finalists=min(finalists, 5),
            workers=threads,
            progress=lambda sizes: bar(progress, "sizes", sizes),
        )
        return RequirementSearchResult(question, outcome)
    if fold is None:
        raise ArgumentError("fold: missing; give it, a region and a limit, or a file (require)")
    radius, _ = _radius(radius_km, altitude_km, orbit, repeat, sphere)
    least = radians(least_approach_deg)
    found = engine.search(
        fold,
        radians(mask_deg),
        radius=radius,
        sphere_radius=sphere,
        largest=max_satellites,
        kind=pattern,
        finalists=finalists,
        least_approach=least,
        workers=threads,
        progress=lambda work, total: bar(progress, "patterns", work, total=total),
    )
    return SearchResult(
        fold,
        mask_deg,
        radius / 1e3,
        figure,
        pattern,
        max_satellites,
        tuple(c for c in found if c.closest_approach >= least),
        least_approach_deg,
        tuple(c for c in found if c.closest_approach < least),
    )


def _radius(
    radius_km: float | None,
    altitude_km: float | None,
    orbit: str | None,
    repeat: Sequence[int] | None,
    sphere: float,
) -> tuple[float, tuple[int, int] | None]:
    """Orbit radius, metres, of the one that is given, and how tracks close if that is said."""
    for name, value in (("radius_km", radius_km), ("altitude_km", altitude_km)):
        if value is not None and not value < 1e7:
            raise ArgumentError(f"{name} = {value:g}: allowed below 1e7 km")
    figure = Figure("sphere", sphere, sphere, 0, "sphere")
    return orbit_radius(radius_km, altitude_km, orbit, repeat, figure)


def _notation(candidate: engine.Candidate) -> str:
    pattern: Any = candidate.constellation.pattern
    return str(pattern.notation)
