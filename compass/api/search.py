"""The smallest constellations with continuous k-fold coverage, every pattern of every size."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, radians
from pathlib import Path
from typing import Any

from compass.api.progress import bar
from compass.api.results import Result
from compass.design import PDOP_MAX
from compass.document import Bracket, Page, Proven, Sentence, Table, Value, Verdict
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.handover.toml import constellation_toml
from compass.orbits.kinds import ROSETTE
from compass.orbits.pattern import rosette_notation
from compass.orbits.patterns import orbit_radius
from compass.quantities import quantity
from compass.saving import replacing
from compass.sites import Mask
from compass.study import search as engine

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
    """

    fold: int
    mask_deg: float
    radius_km: float
    figure: str
    pattern: str
    max_satellites: int
    beyond: int
    candidates: tuple[engine.Candidate, ...]

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
            }
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
            return Page(title, (Verdict("none", self._claim(), False),))
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
        return Page(title, (Verdict("found", self._claim(), True), self._table(), Sentence(how)))

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
    fold: int,
    max_satellites: int,
    mask_deg: float = 0.0,
    radius_km: float | None = None,
    altitude_km: float | None = None,
    orbit: str | None = None,
    repeat: Sequence[int] | None = None,
    beyond: int = 0,
    pattern: str = "walker-delta",
    figure: str = "iau-sphere",
    finalists: int = 10,
    workers: int | None = None,
    progress: bool = False,
) -> SearchResult:
    """Find the smallest patterns with continuous k-fold coverage of the whole sphere.

    Every pattern, size after size up to the smallest that has it, each at its best inclination to
    0.01 degree; smallest first, then largest mask margin.

    Parameters
    ----------
    fold
        Satellites to be in view at once.
    max_satellites
        Largest size to try; the search ends sooner, with the smallest size that has the fold.
    beyond
        How many sizes to try beyond that one.
    mask_deg
        Elevation mask, degrees.
    radius_km, altitude_km, orbit, repeat
        One of them: radius, altitude over the equator, ``areosynchronous``, or revolutions and
        rotations of Mars after which the ground track closes.
    pattern
        ``walker-delta``, ``walker-star`` or ``rosette``.
    figure
        Sphere that is to be covered: ``iau-sphere`` or ``kelly2018-sphere``.
    finalists
        How many of the best get a certificate, and GDOP and availability between proven bounds.
    workers
        Threads; by default one a core. The result does not depend on it.
    progress
        Show bars on stderr.

    Raises
    ------
    ArgumentError
        An option is not allowed.

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
    radius, _ = orbit_radius(radius_km, altitude_km, orbit, repeat, FIGURES[figure])
    if not radius < MOST_RADIUS:
        raise ArgumentError(f"radius_km = {radius / 1e3:g}: allowed below {MOST_RADIUS / 1e3:g} km")
    found = engine.search(
        fold,
        radians(mask_deg),
        radius=radius,
        figure=FIGURES[figure],
        largest=max_satellites,
        beyond=beyond,
        kind=pattern,
        finalists=finalists,
        workers=workers or os.cpu_count() or 1,
        progress=lambda work, total: bar(progress, "patterns", work, total=total),
    )
    return SearchResult(
        fold, mask_deg, radius / 1e3, figure, pattern, max_satellites, beyond, tuple(found)
    )


def _cell(name: str, known: dict[str, Any]) -> Value | str:
    """One number of a candidate, with what is known of it; nothing where it was not asked for."""
    if known[name] is None:
        return ""
    bounds = known.get(f"{name}_bracket")
    return Value(quantity(name), known[name], Bracket(*bounds) if bounds else Proven())
