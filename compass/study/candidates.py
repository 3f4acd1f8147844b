"""Candidates of a study: listed or sampled, each with an identity that outlives the run.

A candidate is a row of plain numbers (`ROW`, 31 bytes): small to keep by the million and to send
to a worker by the thousand. Its identity is a hash of these bytes and of nothing else, so that
it is the same in every run, on every machine and in every study.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from hashlib import blake2b
from math import gcd, isqrt

import numpy as np
from numpy.typing import NDArray

from compass.core.patterns import Patterns
from compass.errors import DesignError
from compass.inputs.study import Free, Study
from compass.memory import check_fits
from compass.orbits import Constellation, Pattern
from compass.orbits.constellation import from_pattern
from compass.orbits.kinds import KIND_NAMES, ROSETTE, WALKER_STAR, kind_of

PATTERNS = KIND_NAMES

#: A candidate: index into `PATTERNS`, Walker's t/p/f, degrees, kilometres, degrees.
ROW = np.dtype(
    [
        ("pattern", "u1"),
        ("satellites", "<i2"),
        ("planes", "<i2"),
        ("phasing", "<i2"),
        ("inclination_deg", "<f8"),
        ("radius_km", "<f8"),
        ("mask_deg", "<f8"),
    ]
)


#: Candidates of a grid that a run can come to the end of.
MOST_CANDIDATES = 10**9

#: Bytes of memory that a candidate takes at the end, in the sets and tables of a run.
KEPT = 1700

#: Digits behind the point of what is drawn from a range, and by how much that may be beyond it.
DIGITS = 6
ROUNDING = 0.5 * 10.0**-DIGITS


def identities(rows: NDArray) -> list[str]:
    """Return 16 hexadecimal digits for each candidate."""
    data, size = np.ascontiguousarray(rows, ROW).tobytes(), ROW.itemsize
    return [
        blake2b(data[k : k + size], digest_size=8).hexdigest() for k in range(0, len(data), size)
    ]


def make_constellation(row: np.void) -> Constellation:
    """Return the constellation of a candidate."""
    t, p, f = int(row["satellites"]), int(row["planes"]), int(row["phasing"])
    inclination, radius = float(np.radians(row["inclination_deg"])), float(row["radius_km"]) * 1e3
    kind = _written(PATTERNS[row["pattern"]])
    return from_pattern(Pattern(kind, t, p, f, inclination), radius)


def described(row: np.void) -> str:
    """Say what a candidate is, on one line."""
    return (
        f"{PATTERNS[row['pattern']]} {row['satellites']}/{row['planes']}/{row['phasing']} at "
        f"{row['inclination_deg']:g} deg, radius {row['radius_km']:.10g} km, "
        f"mask {row['mask_deg']:g} deg"
    )


def patterns_of(rows: NDArray) -> Patterns:
    """Candidates as kernels take patterns."""
    return Patterns(
        rows["pattern"] == PATTERNS.index(WALKER_STAR.name),
        rows["satellites"].astype(np.int64),
        rows["planes"].astype(np.int64),
        rows["phasing"].astype(np.int64),
        np.radians(rows["inclination_deg"]),
    )


@dataclass(frozen=True)
class Phasings:
    """Phasings below `planes` that leave, divided by `turn`, one of `remainders`; not kept.

    A list of its own is one whole turn.
    """

    planes: int
    turn: int
    remainders: tuple[int, ...]

    def __len__(self) -> int:
        return self.planes // self.turn * len(self.remainders)

    def __contains__(self, phasing: int) -> bool:
        return 0 <= phasing < self.planes and phasing % self.turn in self.remainders


@dataclass(frozen=True)
class Block:
    """Candidates of one kind, size and number of planes, with the phasings they may have."""

    pattern: int
    satellites: int
    planes: int
    phasings: Phasings


def blocks(study: Study) -> list[Block]:
    """Every kind, size and number of planes that the study allows, in its order, none twice.

    Candidates are their geometry, not its spelling: of kinds that the study names and that lay out
    the same satellites one stands for all, a delta or else a rosette before a star; a rosette is
    written down as the delta that it is.

    Raises
    ------
    DesignError
        There is none.
    """
    space, found = study.space, []
    for kind in space.patterns:
        for t in space.satellites:
            for p in _divisors(t):
                if space.planes is not None and p not in space.planes:
                    continue
                if _is_said_already(kind, p, space.patterns):
                    continue
                phasings = _phasings(kind, t, p, space.phasing)
                if len(phasings):
                    found.append(Block(PATTERNS.index(_written(kind)), t, p, phasings))
    if not found:
        raise DesignError(
            f"{study.label}: study: no candidate: none of the satellites "
            f"{_few(space.satellites)} goes with the planes and phasings given; planes must "
            "divide satellites, phasing must be below planes"
        )
    return found


def _is_said_already(kind: str, planes: int, kinds: Iterable[str]) -> bool:
    """Whether another of a study's kinds has all that a kind would lay out in so many planes.

    Every rosette is a delta pattern; a star of one plane is a delta pattern, and a rosette, of one.
    """
    others = set(kinds) - {kind}
    if _written(kind) != kind:
        return _written(kind) in others
    return kind == WALKER_STAR.name and planes == 1 and bool(others)


def _written(kind: str) -> str:
    """Name of the kind under which candidates of a kind are written down: a rosette is a delta."""
    return kind_of(kind).layout


def _divisors(number: int) -> list[int]:
    """Divisors of a number, in order."""
    small = [d for d in range(1, isqrt(number) + 1) if number % d == 0]
    return small + [number // d for d in reversed(small) if d * d != number]


def _phasings(kind: str, t: int, p: int, given: tuple[int, ...] | None) -> Phasings:
    """Phasings of a kind, of those given.

    A rosette's multiplier has a numerator c = f (mod p) prime to t/p. Of the primes of t/p, those
    that do not divide p can be kept out of c by adding p; the others are in c where they are in
    f: there is such a c if f is prime to what t/p and p share.
    """
    shared = gcd(t // p, p) if kind == ROSETTE.name else 1
    if given is None:
        return Phasings(p, shared, tuple(f for f in range(shared) if gcd(f, shared) == 1))
    return Phasings(p, p, tuple(sorted({f for f in given if f < p and gcd(f, shared) == 1})))


class Layouts:
    """The blocks of a study as columns, to look many candidates up at once."""

    def __init__(self, choices: list[Block]) -> None:
        self.pattern, self.satellites, self.planes = np.array(
            [(b.pattern, b.satellites, b.planes) for b in choices]
        ).T
        self.sizes = np.array([len(b.phasings) for b in choices])
        self._turns = np.array([b.phasings.turn for b in choices])
        self._counts = np.array([len(b.phasings.remainders) for b in choices])
        self._starts = np.cumsum(self._counts) - self._counts
        self._remainders = np.concatenate([np.array(b.phasings.remainders) for b in choices])

    def phasing(self, block: NDArray[np.int64], place: NDArray[np.int64]) -> NDArray[np.int64]:
        """Phasings by their places in blocks."""
        turn, rest = np.divmod(place, self._counts[block])
        found: NDArray[np.int64] = (
            turn * self._turns[block] + self._remainders[self._starts[block] + rest]
        )
        return found


class Members:
    """Tells which candidates are of a study, however they are chosen from it."""

    def __init__(self, study: Study) -> None:
        self._space = study.space
        self._phasings = {(b.pattern, b.satellites, b.planes): b.phasings for b in blocks(study)}

    def have(self, rows: NDArray) -> NDArray[np.bool_]:
        """Whether each is one, shape (n,)."""
        whole = rows[["pattern", "satellites", "planes", "phasing"]]
        kinds, of = np.unique(whole, return_inverse=True)
        known = [f in self._phasings.get((k, t, p), ()) for k, t, p, f in kinds.tolist()]
        good = np.array(known, dtype=bool)[of]
        for name in ("inclination_deg", "radius_km", "mask_deg"):
            allowed = getattr(self._space, name)
            if isinstance(allowed, Free):  # its ends rounded as `_draw` rounds
                good &= (allowed.least - ROUNDING <= rows[name]) & (
                    rows[name] <= allowed.most + ROUNDING
                )
            else:
                good &= np.isin(rows[name], allowed)
        return np.asarray(good)


def _few(values: tuple[int, ...]) -> str:
    return ", ".join(map(str, values[:5])) + (" ..." if len(values) > 5 else "")


class Grid:
    """The full grid of a study: candidates by number, none of them kept in memory.

    Masks vary fastest, then radii, inclinations, phasings, blocks.
    """

    def __init__(self, study: Study) -> None:
        """Number them.

        Raises
        ------
        DesignError
            There is none, or there are more than `MOST_CANDIDATES`.
        """
        space = study.space
        self.blocks = blocks(study)
        values = (space.inclination_deg, space.radius_km, space.mask_deg)
        self.inclinations, self.radii, self.masks = (
            np.array(v, dtype=float) for v in values if not isinstance(v, Free)
        )
        self.each = self.inclinations.size * self.radii.size * self.masks.size
        self._layouts = Layouts(self.blocks)
        sizes = self._layouts.sizes
        if (count := int(sizes.sum()) * self.each) > MOST_CANDIDATES:
            raise DesignError(
                f"{study.label}: study: {count} candidates on the grid, more than "
                f"{MOST_CANDIDATES:g}; take larger steps, or draw from it: sampling.method "
                "(latin-hypercube, sobol, nsga2)"
            )
        self.ends = np.cumsum(sizes) * self.each
        self.starts = self.ends - sizes * self.each

    def __len__(self) -> int:
        return int(self.ends[-1])

    def rows(self, start: int, stop: int) -> NDArray:
        """Candidates number `start` up to `stop`, shape (stop - start,), of dtype `ROW`."""
        number = np.arange(start, min(stop, len(self)))
        block = np.searchsorted(self.ends, number, side="right")
        place, rest = np.divmod(number - self.starts[block], self.each)
        inclination, rest = np.divmod(rest, self.radii.size * self.masks.size)
        radius, mask = np.divmod(rest, self.masks.size)
        found = np.empty(number.size, ROW)
        known = self._layouts
        found["pattern"], found["satellites"] = known.pattern[block], known.satellites[block]
        found["planes"], found["phasing"] = known.planes[block], known.phasing(block, place)
        found["inclination_deg"] = self.inclinations[inclination]
        found["radius_km"] = self.radii[radius]
        found["mask_deg"] = self.masks[mask]
        return found


class Listed:
    """Candidates in a list; none twice."""

    def __init__(self, rows: NDArray) -> None:
        _, first = np.unique(rows, return_index=True)
        self._rows = rows[np.sort(first)]

    def __len__(self) -> int:
        return int(self._rows.size)

    def rows(self, start: int, stop: int) -> NDArray:
        """As `Grid.rows`."""
        return self._rows[start:stop]


def pick(study: Study, choices: list[Block], share: NDArray[np.float64]) -> NDArray:
    """Candidates at points of the unit cube.

    Parameters
    ----------
    study
        What they may be.
    choices
        Its `blocks`.
    share
        In [0, 1): of kinds, sizes, planes, phasings, inclinations, radii and masks; shape (n, 7).
    """
    known = Layouts(choices)
    pattern, satellites = known.pattern, known.satellites
    # blocks come kind by kind, and in each size by size: runs of equal neighbours
    size_starts = _run_starts(pattern, satellites)
    kind_starts = _run_starts(pattern[size_starts])
    kind = _choose(np.array([kind_starts.size]), share[:, 0])
    size = kind_starts[kind] + _choose(_lengths(kind_starts, size_starts.size)[kind], share[:, 1])
    block = size_starts[size] + _choose(_lengths(size_starts, pattern.size)[size], share[:, 2])
    found = np.empty(len(share), ROW)
    found["pattern"], found["satellites"] = pattern[block], satellites[block]
    found["planes"] = known.planes[block]
    found["phasing"] = known.phasing(block, _choose(known.sizes[block], share[:, 3]))
    found["inclination_deg"] = _draw(study.space.inclination_deg, share[:, 4])
    found["radius_km"] = _draw(study.space.radius_km, share[:, 5])
    found["mask_deg"] = _draw(study.space.mask_deg, share[:, 6])
    return found


def _run_starts(*columns: NDArray[np.int64]) -> NDArray[np.int64]:
    """Where runs of equal neighbours begin."""
    new = np.any([column[1:] != column[:-1] for column in columns], axis=0)
    return np.concatenate([[0], np.flatnonzero(new) + 1])


def _lengths(starts: NDArray[np.int64], total: int) -> NDArray[np.int64]:
    return np.diff(starts, append=total)


def _choose(counts: NDArray[np.int64], share: NDArray[np.float64]) -> NDArray[np.int64]:
    """One of so many, each as likely."""
    return np.minimum((share * counts).astype(np.int64), counts - 1)


def _draw(values: tuple[float, ...] | Free, share: NDArray[np.float64]) -> NDArray[np.float64]:
    if isinstance(values, Free):
        return np.round(values.least + share * (values.most - values.least), DIGITS)
    return np.array(values)[_choose(np.array([len(values)]), share)]


def candidates(study: Study) -> Grid | Listed:
    """All candidates of a study that lists or samples them.

    Latin hypercube and Sobol points (scrambled) are SciPy's, with the study's seed.
    """
    method, samples = study.sampling.method, study.sampling.samples
    if method == "grid":
        return Grid(study)
    from scipy.stats import qmc

    choices = blocks(study)
    sampler = qmc.LatinHypercube if method == "latin-hypercube" else qmc.Sobol
    return Listed(pick(study, choices, sampler(7, seed=study.seed).random(samples)))


def check_space(study: Study) -> None:
    """Refuse a study that has no candidate, or too many, before anything is made for it.

    Raises
    ------
    ArgumentError
        What is found out about all of them does not fit into memory.
    DesignError
        As `blocks` and `Grid`.
    """
    if study.sampling.method != "grid":
        blocks(study)
        return
    check_fits(
        KEPT * (count := len(Grid(study))),
        f"{study.label}: study: what is found out about {count} candidates",
        "take larger steps, or draw from the grid: sampling.method (latin-hypercube, sobol, nsga2)",
    )


def batches(found: Grid | Listed, size: int) -> Iterator[NDArray]:
    """Yield the candidates in order, `size` at a time."""
    for start in range(0, len(found), size):
        yield found.rows(start, start + size)
