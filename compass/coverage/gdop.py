"""GDOP over area and time without a fixed grid: adaptive sampling with a stated error."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compass.core.gdop import gdop_over
from compass.coverage.symmetry import Span, shortest_span
from compass.errors import ArgumentError
from compass.orbits import Constellation, positions_mci


@dataclass(frozen=True)
class Estimate:
    """A number and its standard error, from independent repetitions."""

    value: float
    error: float


@dataclass
class _Cells:
    """Boxes of the cube (time, longitude, sine of latitude), each of its sides in [0, 1]."""

    corner: NDArray[np.float64]
    side: NDArray[np.float64]

    @property
    def volume(self) -> NDArray[np.float64]:
        """Share of area and time."""
        return self.side**3

    def halved(self) -> "_Cells":
        """Each cell cut into eight."""
        octants = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T
        side = self.side / 2
        corner = self.corner[:, np.newaxis] + octants * side[:, np.newaxis, np.newaxis]
        return _Cells(corner.reshape(-1, 3), np.repeat(side, 8))


def gdop_samples(
    constellation: Constellation,
    percent: float,
    *,
    sphere_radius: float,
    mask: float,
    span: Span,
    generator: np.random.Generator,
    levels: int = 3,
    start: int = 10,
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """GDOP, fold and weight (share of area and time) of samples, dense where it matters.

    A cube of time, longitude and sine of latitude (in which volume is area-time) is cut into
    ``start**3`` cells, with two random points in each. Cells whose points lie on both sides of
    the percentile, or differ in fold below 5, are cut into eight, `levels` times in all. These
    points only steer; the answer comes from two fresh points in every cell in the end, each for
    half of it, so the sums are unbiased.
    """
    ticks = np.arange(start) / start
    grid = np.array(np.meshgrid(ticks, ticks, ticks)).reshape(3, -1).T
    cells = _Cells(grid, np.full(start**3, 1.0 / start))
    done: list[_Cells] = []
    edge = None
    for _ in range(levels - 1):
        fold, gdop = _sample(constellation, sphere_radius, mask, span, generator, cells)
        if edge is None:
            edge = _quantile(gdop.ravel(), np.ones(gdop.size), percent)
        low = np.minimum(fold, 5)
        split = (gdop <= edge).any(axis=1) & (gdop >= edge).any(axis=1)
        split |= low.min(axis=1) != low.max(axis=1)
        done.append(_Cells(cells.corner[~split], cells.side[~split]))
        cells = _Cells(cells.corner[split], cells.side[split]).halved()
    done.append(cells)
    leaves = _Cells(
        np.concatenate([part.corner for part in done]), np.concatenate([part.side for part in done])
    )
    fold, gdop = _sample(constellation, sphere_radius, mask, span, generator, leaves)
    return gdop.ravel(), fold.ravel(), np.repeat(leaves.volume / 2, 2)


def _sample(
    constellation: Constellation,
    sphere_radius: float,
    mask: float,
    span: Span,
    generator: np.random.Generator,
    cells: _Cells,
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Fold and GDOP at two random points of every cell, shape (cells, 2)."""
    at = cells.corner[:, np.newaxis] + cells.side[:, np.newaxis, np.newaxis] * generator.random(
        (cells.side.size, 2, 3)
    )
    times = span.start + (span.stop - span.start) * at[..., 0].ravel()
    longitude = 2 * np.pi * at[..., 1].ravel()
    z = 2 * at[..., 2].ravel() - 1
    ring = np.sqrt(1 - z * z)
    places = np.stack([ring * np.cos(longitude), ring * np.sin(longitude), z], axis=-1)
    r = np.ascontiguousarray(positions_mci(constellation, times).transpose(1, 0, 2))
    fold, gdop = gdop_over(r, places[:, np.newaxis], sphere_radius, np.sin(mask))
    return fold.reshape(-1, 2), gdop.reshape(-1, 2)


def _quantile(values: NDArray, weights: NDArray, percent: float) -> float:
    """Value that a share `percent` of the weight does not exceed."""
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    place = np.searchsorted(total, percent / 100 * total[-1])
    return float(values[order[min(int(place), values.size - 1)]])


def gdop_percentile(
    constellation: Constellation,
    percent: float,
    *,
    sphere_radius: float,
    mask: float = 0.0,
    span: Span | None = None,
    repetitions: int = 4,
    seed: int = 1,
    levels: int = 3,
    start: int = 10,
) -> Estimate:
    """GDOP not exceeded over `percent` of the sphere's area and the span's time.

    The mean over independent repetitions of `gdop_samples`, with its standard error. Infinite,
    with infinite error, where fewer than four satellites or a singular geometry take up more
    than the rest.

    Raises
    ------
    ArgumentError
        The percentage is not between 0 and 100.
    """
    if not 0 < percent < 100:
        raise ArgumentError(f"percent = {percent:g}: allowed above 0 and below 100")
    span = span or shortest_span(constellation)
    values = []
    for sequence in np.random.SeedSequence(seed).spawn(repetitions):
        gdop, _, weight = gdop_samples(
            constellation,
            percent,
            sphere_radius=sphere_radius,
            mask=mask,
            span=span,
            generator=np.random.default_rng(sequence),
            levels=levels,
            start=start,
        )
        values.append(_quantile(gdop, weight, percent))
    return _mean(values)


def gdop_share(
    constellation: Constellation,
    threshold: float,
    *,
    sphere_radius: float,
    mask: float = 0.0,
    span: Span | None = None,
    repetitions: int = 4,
    seed: int = 1,
    levels: int = 3,
    start: int = 10,
) -> Estimate:
    """Share of area and time with GDOP at or below a threshold.

    Where exactly four satellites are in view there are curves on which GDOP is infinite; how
    much of area and time that is, `compass.coverage.share` tells exactly.
    """
    span = span or shortest_span(constellation)
    available = []
    for sequence in np.random.SeedSequence(seed).spawn(repetitions):
        gdop, _, weight = gdop_samples(
            constellation,
            95.0,
            sphere_radius=sphere_radius,
            mask=mask,
            span=span,
            generator=np.random.default_rng(sequence),
            levels=levels,
            start=start,
        )
        available.append(float(weight[gdop <= threshold].sum()))
    return _mean(available)


def _mean(values: list[float]) -> Estimate:
    if not np.all(np.isfinite(values)):
        return Estimate(float("inf"), float("inf"))
    return Estimate(float(np.mean(values)), float(np.std(values, ddof=1) / np.sqrt(len(values))))
