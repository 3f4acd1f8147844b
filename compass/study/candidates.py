"""Candidates of a study: listed or sampled, each with an identity that outlives the run.

A candidate is a row of plain numbers (`ROW`, 31 bytes): small to keep by the million and to send
to a worker by the thousand. Its identity is a hash of these bytes and of nothing else, so that
it is the same in every run, on every machine and in every study.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from hashlib import blake2b

import numpy as np
from numpy.typing import NDArray

from compass.errors import DesignError
from compass.inputs.study import Free, Study
from compass.orbits import Constellation, Pattern
from compass.orbits.constellation import from_pattern
from compass.orbits.kinds import (
    KIND_NAMES,
    ROSETTE,
    WALKER_DELTA,
    WALKER_STAR,
    least_multiplier,
)

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
    star = PATTERNS[row["pattern"]] == WALKER_STAR.name
    kind = WALKER_STAR if star else WALKER_DELTA
    return from_pattern(Pattern(kind.name, t, p, f, inclination), radius)


def described(row: np.void) -> str:
    """Say what a candidate is, on one line."""
    return (
        f"{PATTERNS[row['pattern']]} {row['satellites']}/{row['planes']}/{row['phasing']} at "
        f"{row['inclination_deg']:g} deg, radius {row['radius_km']:.10g} km, "
        f"mask {row['mask_deg']:g} deg"
    )


def pattern_columns(rows: NDArray) -> tuple[NDArray, ...]:
    """Candidates as kernels take patterns: star or not, t, p, f, inclination (rad), (n,) each."""
    counts = (rows[name].astype(np.int64) for name in ("satellites", "planes", "phasing"))
    star = rows["pattern"] == PATTERNS.index(WALKER_STAR.name)
    return star, *counts, np.radians(rows["inclination_deg"])


@dataclass(frozen=True)
class Block:
    """Candidates of one kind, size and number of planes, with the phasings they may have."""

    pattern: int
    satellites: int
    planes: int
    phasings: tuple[int, ...]


def blocks(study: Study) -> list[Block]:
    """Every kind, size and number of planes that the study allows, in its order.

    Raises
    ------
    DesignError
        There is none.
    """
    space, found = study.space, []
    for kind in space.patterns:
        for t in space.satellites:
            for p in (p for p in range(1, t + 1) if t % p == 0):
                if space.planes is not None and p not in space.planes:
                    continue
                phasings = [
                    f
                    for f in range(p)
                    if (space.phasing is None or f in space.phasing)
                    and (kind != ROSETTE.name or least_multiplier(t, p, f) is not None)
                ]
                if phasings:
                    found.append(Block(PATTERNS.index(kind), t, p, tuple(phasings)))
    if not found:
        raise DesignError(
            f"{study.label}: study: no candidate: none of the satellites "
            f"{_few(space.satellites)} goes with the planes and phasings given; planes must "
            "divide satellites, phasing must be below planes"
        )
    return found


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
        sizes = np.array([len(block.phasings) for block in self.blocks])
        if (count := int(sizes.sum()) * self.each) > MOST_CANDIDATES:
            raise DesignError(
                f"{study.label}: study: {count} candidates on the grid, more than "
                f"{MOST_CANDIDATES:g}; take larger steps, or draw from it: sampling.method "
                "(latin-hypercube, sobol, nsga2)"
            )
        self.ends = np.cumsum(sizes) * self.each
        self.starts = self.ends - sizes * self.each
        self._numbers = np.array([(b.pattern, b.satellites, b.planes) for b in self.blocks])
        self._phasings = np.concatenate([np.array(b.phasings) for b in self.blocks])

    def __len__(self) -> int:
        return int(self.ends[-1])

    def rows(self, start: int, stop: int) -> NDArray:
        """Candidates number `start` up to `stop`, shape (stop - start,), of dtype `ROW`."""
        number = np.arange(start, min(stop, len(self)))
        block = np.searchsorted(self.ends, number, side="right")
        phasing, rest = np.divmod(number, self.each)
        inclination, rest = np.divmod(rest, self.radii.size * self.masks.size)
        radius, mask = np.divmod(rest, self.masks.size)
        found = np.empty(number.size, ROW)
        found["pattern"], found["satellites"], found["planes"] = self._numbers[block].T
        found["phasing"] = self._phasings[phasing]
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
    pattern = np.array([b.pattern for b in choices])
    satellites = np.array([b.satellites for b in choices])
    # blocks come kind by kind, and in each size by size: runs of equal neighbours
    size_starts = _run_starts(pattern, satellites)
    kind_starts = _run_starts(pattern[size_starts])
    kind = _choose(np.array([kind_starts.size]), share[:, 0])
    size = kind_starts[kind] + _choose(_lengths(kind_starts, size_starts.size)[kind], share[:, 1])
    block = size_starts[size] + _choose(_lengths(size_starts, pattern.size)[size], share[:, 2])
    counts = np.array([len(b.phasings) for b in choices])
    phasing = (np.cumsum(counts) - counts)[block] + _choose(counts[block], share[:, 3])
    found = np.empty(len(share), ROW)
    found["pattern"], found["satellites"] = pattern[block], satellites[block]
    found["planes"] = np.array([b.planes for b in choices])[block]
    found["phasing"] = np.concatenate([np.array(b.phasings) for b in choices])[phasing]
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
        return np.round(values.least + share * (values.most - values.least), 6)
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
    DesignError
        As `blocks` and `Grid`.
    """
    if study.sampling.method == "grid":
        Grid(study)
    else:
        blocks(study)


def batches(found: Grid | Listed, size: int) -> Iterator[NDArray]:
    """Yield the candidates in order, `size` at a time."""
    for start in range(0, len(found), size):
        yield found.rows(start, start + size)
