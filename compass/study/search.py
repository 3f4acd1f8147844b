"""The smallest constellation: every pattern of every size, each at its best inclination."""

from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.allowed import check_all_allowed
from compass.core.inclination import best_inclination
from compass.cores import shared
from compass.coverage.cap import cap_radius, mask_for_cap
from compass.coverage.certificate import prove_fold
from compass.coverage.certified_geometry import CertifiedGeometry, certified_geometry
from compass.coverage.margin import covering_radius
from compass.coverage.symmetry import shortest_span
from compass.errors import whole_number
from compass.frames import Figure
from compass.orbits import Constellation, Pattern
from compass.orbits.constellation import from_pattern
from compass.orbits.kinds import kind_of
from compass.sites import Mask

#: How near bounds of shares of those that are listed come: as near as it takes to choose by them.
LISTED = 5e-4


@dataclass(frozen=True)
class Candidate:
    """A pattern at its best inclination.

    Attributes
    ----------
    constellation
        The pattern at that inclination, rounded to the search's resolution.
    radius
        Smallest cap radius that it needs, radians.
    mask_margin
        Highest mask with the fold wanted, radians.
    closest_approach
        Least angle between two satellites at any time, radians: 0 means that some collide.
    proven
        Whether the certificate of continuous coverage confirms it.
    geometry
        Availability and the GDOP not exceeded over 95 % of area and time; None if not asked for.
    """

    constellation: Constellation
    radius: float
    mask_margin: float
    closest_approach: float
    proven: bool = False
    geometry: CertifiedGeometry | None = None

    def as_dict(self) -> dict[str, Any]:
        """Plain values with degrees."""
        pattern = self.constellation.pattern
        assert pattern is not None
        known = self.geometry.numbers() if self.geometry else {}
        gdop = known.get("gdop", {})
        return {
            "pattern": pattern.kind,
            "satellites": pattern.satellites,
            "planes": pattern.planes,
            "phasing": pattern.phasing,
            "multiplier": None if pattern.multiplier is None else str(pattern.multiplier),
            "inclination_deg": round(float(np.degrees(pattern.inclination)), 6),
            "cap_radius_min_deg": float(np.degrees(self.radius)),
            "mask_margin_deg": float(np.degrees(self.mask_margin)),
            "closest_approach_deg": float(np.degrees(self.closest_approach)),
            "proven": self.proven,
            "gdop_p95": gdop.get("p95"),
            "gdop_p95_bracket": gdop.get("p95_bracket"),
            "availability": known.get("availability"),
            "availability_bracket": known.get("availability_bracket"),
        }


def patterns(
    kind: str, largest: int, radius: float, smallest: int = 1
) -> Iterator[Callable[[float], Constellation]]:
    """Makers of every pattern of a kind with `smallest` to `largest` satellites.

    Each takes an inclination in radians. Walker phasings run from 0 to planes - 1; rosettes are
    those deltas that a multiplier gives.
    """
    for t in range(smallest, largest + 1):
        for p, f in layouts(kind, t):
            yield _maker(kind, t, p, f, radius)


def layouts(kind: str, satellites: int) -> Iterator[tuple[int, int]]:
    """Planes and Walker's F of every pattern of a kind with so many satellites."""
    for planes in (p for p in range(1, satellites + 1) if satellites % p == 0):
        for phasing in range(planes):
            if kind_of(kind).writes(satellites, planes, phasing):
                yield planes, phasing


def _maker(kind: str, t: int, p: int, f: int, radius: float) -> Callable:
    layout = kind_of(kind).layout
    return lambda inclination: from_pattern(Pattern(layout, t, p, f, inclination), radius)


def search(
    fold: int,
    mask: float,
    *,
    radius: float,
    figure: Figure,
    largest: int,
    beyond: int = 0,
    kind: str = "walker-delta",
    finalists: int = 10,
    least_approach: float = 0.0,
    workers: int = 2,
    progress: Callable[..., Iterable[Any]] = lambda items, **_: items,
) -> list[Candidate]:
    """Smallest patterns with continuous `fold`-fold coverage, those of largest margin first.

    Size after size is tried, up to the first that any pattern covers with, and `beyond` more.
    Inclinations from 0 to 90 degrees are searched by branch and bound, so no local minimum is
    missed, and rounded to 0.01 degree; more than 90 degrees give the mirror images.

    Parameters
    ----------
    fold, mask
        Satellites to be in view at once, above this elevation (radians, not negative).
    radius
        Of the orbits, metres.
    figure
        Sphere that is to be covered.
    largest
        Largest number of satellites to try.
    beyond
        How many sizes to try beyond the smallest that covers.
    kind
        Name of one of `compass.orbits.kinds.KINDS`.
    finalists
        How many of the best get a certificate and certified geometry.
    least_approach
        Those in which two satellites come nearer than this, radians, do not count and go last.
    workers
        Threads; the result does not depend on them.
    progress
        Wraps the patterns in work, called with ``total``, as tqdm is.

    Raises
    ------
    ArgumentError
        Something out of range.
    """
    kind_of(kind)
    check_all_allowed(
        max_satellites=largest,
        fold=whole_number("fold", fold),
        mask_deg=np.degrees(mask),
        finalists=finalists,
        beyond=beyond,
    )
    sphere_radius = figure.equatorial_radius
    cap = float(cap_radius(radius, sphere_radius, mask))
    sizes = [list(patterns(kind, t, radius, smallest=t)) for t in range(fold + 1, largest + 1)]
    found: list[Candidate] = []
    close: list[Candidate] = []

    def size_after_size() -> Generator[Candidate | None, None, None]:
        for size, makers in enumerate(sizes, start=fold + 1):
            if found and size > found[0].constellation.size + beyond:
                return
            yield from shared(lambda make: _best(make, fold, cap, sphere_radius), makers, workers)

    with closing(size_after_size()) as tried:
        for one in progress(tried, total=sum(map(len, sizes))):
            if one is not None:
                (found if one.closest_approach >= least_approach else close).append(one)
    for some in (found, close):
        some.sort(key=lambda c: (c.constellation.size, -round(c.mask_margin, 9)))
    best = list(shared(lambda c: _examine(c, fold, mask, figure), found[:finalists], workers))
    return best + found[len(best) :] + close


def _best(
    make: Callable[[float], Constellation], fold: int, cap: float, sphere_radius: float
) -> Candidate | None:
    """Optimise the inclination of a pattern; None if it cannot cover with caps of radius `cap`."""
    start = make(0.0)
    inclination = optimal_inclination(start, fold, cap, resolution=np.radians(0.01))
    if inclination is None:
        return None
    c = make(float(np.radians(np.round(np.degrees(inclination), 2))))
    radius = covering_radius(c, fold).radius
    if radius > cap:
        return None
    margin = float(mask_for_cap(radius, c.semi_major_axis[0], sphere_radius))
    return Candidate(c, radius, margin, closest_approach(c))


def optimal_inclination(
    constellation: Constellation, fold: int, limit: float = np.pi, resolution: float = 5e-5
) -> float | None:
    """Inclination (radians, 0 to pi/2) at which a pattern needs the smallest caps for a fold.

    Only the pattern of the constellation matters, not its inclination. The caps are proven to
    be within 0.07 degree of the smallest at any inclination, and are the smallest nearby among
    multiples of `resolution` (radians; by default 0.003 degree). None if they must be larger
    than `limit` everywhere, or come within 0.07 degree of it and no more.
    """
    span = shortest_span(constellation)
    rate = constellation.mean_motion[0]
    inclination, radius = best_inclination(
        constellation.raan,
        constellation.mean_anomaly,
        fold,
        span.start * rate,
        span.stop * rate,
        limit,
        np.radians(0.035),
        resolution,
    )
    return float(inclination) if np.isfinite(radius) else None


def closest_approach(constellation: Constellation) -> float:
    """Least angle between two satellites of equal circular orbits at any time, radians.

    With ``u = P cos x + Q sin x`` the cosine of the angle between two of them is
    ``(P.P' + Q.Q')/2 + (P.P' - Q.Q')/2 cos 2x + (P.Q' + Q.P')/2 sin 2x``. A single satellite
    has pi.
    """
    if constellation.size < 2:
        return float(np.pi)
    middle, swing = pair_cosines(constellation)
    return float(np.arccos(np.clip((middle + swing).max(), -1.0, 1.0)))


def pair_cosines(constellation: Constellation) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean and amplitude of the cosine of the angle between each two satellites.

    Of equal circular orbits; shape (pairs,). They do not change as the whole turns or goes on.
    """
    c = constellation
    co, so = np.cos(c.raan), np.sin(c.raan)
    ci, si = np.cos(c.inclination), np.sin(c.inclination)
    node = np.stack([co, so, 0 * co], axis=-1)
    ahead = np.stack([-so * ci, co * ci, si], axis=-1)
    cu, su = np.cos(c.mean_anomaly)[:, np.newaxis], np.sin(c.mean_anomaly)[:, np.newaxis]
    p, q = node * cu + ahead * su, ahead * cu - node * su
    pp, qq, pq = p @ p.T, q @ q.T, p @ q.T
    pairs = np.triu_indices(c.size, k=1)
    return ((pp + qq) / 2)[pairs], np.hypot((pp - qq) / 2, (pq + pq.T) / 2)[pairs]


def _examine(candidate: Candidate, fold: int, mask: float, figure: Figure) -> Candidate:
    """Add certificate and certified geometry to a finalist."""
    c = candidate.constellation
    certificate = prove_fold(c, fold, sphere_radius=figure.equatorial_radius, mask=mask)
    geometry = certified_geometry(c, figure=figure, mask=Mask.constant(mask), width=LISTED)
    return replace(candidate, proven=certificate.outcome == "proven", geometry=geometry)
