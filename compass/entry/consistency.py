"""Whether a filter's claims hold: consistent or not, by how much, in a sentence."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compass.errors import ArgumentError


def nees_bounds(states: int, runs: int, level: float = 0.95) -> tuple[float, float]:
    """Two-sided bounds of the mean NEES of a consistent filter.

    ``runs * mean`` is chi-square with ``runs * states`` degrees of freedom.

    Parameters
    ----------
    states, runs
        Dimension of the error and number of independent runs.
    level
        Probability of lying within the bounds.

    References
    ----------
    Bar-Shalom, Li and Kirubarajan 2001, Estimation with Applications to Tracking and
    Navigation, section 5.4.2.
    """
    from scipy.stats import chi2

    if runs < 1 or not 0 < level < 1:
        raise ArgumentError(f"runs = {runs}, level = {level}: at least 1, and between 0 and 1")
    low, high = chi2.ppf([(1 - level) / 2, (1 + level) / 2], runs * states) / runs
    return float(low), float(high)


#: A run whose error at the end is more than so many times what the filter claims is lost.
LOST = 100.0

#: A consistent filter is called inconsistent once in so many flights.
FALSE_ALARM = 1e-3


@dataclass(frozen=True)
class Consistency:
    """Whether the errors of a filter are what it claims, at every epoch of a flight.

    Attributes
    ----------
    times
        Epochs, s, shape (t,).
    nees
        Mean normalised error squared over the runs, shape (t,).
    states
        Its value if the filter is consistent.
    low, high
        What every epoch's mean of a consistent filter lies between, but for one flight in
        1 / `FALSE_ALARM`.
    runs, lost, broken, strayed
        Runs; those that did not stay finite; those whose covariance did not stay positive
        definite; those that end more than `LOST` times farther off than they claim.
    """

    times: NDArray[np.float64]
    nees: NDArray[np.float64]
    states: int
    low: float
    high: float
    runs: int
    lost: int
    broken: int
    strayed: int = 0

    @property
    def worst(self) -> int:
        """Index of the epoch whose mean is farthest from what it should be, as a ratio."""
        off = np.abs(np.log(np.maximum(self.nees, 1e-300) / self.states))
        return int(np.nanargmax(off)) if np.isfinite(off).any() else 0

    @property
    def ratio(self) -> float:
        """Errors there over what the filter claims: ``sqrt(NEES / states)``."""
        return float(np.sqrt(self.nees[self.worst] / self.states))

    @property
    def holds(self) -> bool:
        """Whether the filter is consistent."""
        within = (self.nees >= self.low) & (self.nees <= self.high)
        return bool(within.all()) and not self.lost and not self.broken

    @property
    def sentence(self) -> str:
        """What to tell, with the likely cause."""
        if self.lost == self.runs:
            return f"The filter is inconsistent: all {self.runs} runs diverged."
        worst = self.nees[self.worst]
        where = (
            f"{'worst ' if self.holds else ''}NEES {worst:.3g} at {self.times[self.worst]:g} s, "
            f"where {self.low:.2f} to {self.high:.2f} is right for {self.runs} runs"
        )
        if self.holds:
            return f"The filter is consistent: its errors are what it claims ({where})."
        said = []
        if self.lost:
            said.append(f"{self.lost} of {self.runs} runs diverged")
        if self.broken:
            said.append(
                f"in {self.broken} of {self.runs} runs its covariance did not stay positive "
                "definite"
            )
        if self.strayed:
            said.append(
                f"{self.strayed} of {self.runs} runs lost their way and end more than {LOST:g} "
                "times farther off than they claim"
            )
        if worst > self.high:
            said.append(
                f"its errors are {self.ratio:.3g} times what it claims ({where}): it is too sure "
                "of itself, as with a nonlinearity or a world other than it knows"
            )
        elif worst < self.low:
            said.append(
                f"its errors are {self.ratio:.2g} times what it claims ({where}): it is too "
                "cautious, as with too much process noise"
            )
        return f"The filter is inconsistent and makes no claim of accuracy: {'; '.join(said)}."


def consistency(
    nees: NDArray[np.float64], times: NDArray[np.float64], states: int, diverged: NDArray[np.bool_]
) -> Consistency:
    """Judge the normalised errors of many runs.

    The mean over independent runs is compared, at every epoch, with the chi-square interval that
    all epochs together leave once in 1 / `FALSE_ALARM` flights at most (Bonferroni).

    Parameters
    ----------
    nees
        Normalised errors squared, (runs, t); nan where a covariance is not positive definite.
    times
        Seconds, (t,).
    states
        Dimension of the error.
    diverged
        Runs that did not stay finite, (runs,).
    """
    kept = nees[~diverged]
    whole = kept[np.isfinite(kept).all(axis=1)]
    low, high = nees_bounds(states, max(1, len(whole)), 1.0 - FALSE_ALARM / times.size)
    return Consistency(
        times=times,
        nees=whole.mean(axis=0) if len(whole) else np.full(times.size, np.nan),
        states=states,
        low=low,
        high=high,
        runs=len(nees),
        lost=int(diverged.sum()),
        broken=len(kept) - len(whole),
        strayed=int((whole[:, -1] > states * LOST**2).sum()),
    )
