"""What every answer to "so many satellites above so many degrees" has, whatever it rests on."""

from abc import abstractmethod
from dataclasses import dataclass, field

from compass.api.results import Result
from compass.coverage.certificate import Outcome
from compass.design import Design


@dataclass(frozen=True, repr=False)
class FoldClaim(Result):
    """A claim of continuous coverage: for all time of a pattern, or along paths for some days.

    Attributes
    ----------
    design
        What was asked about.
    fold, mask_deg
        So many satellites above so many degrees; of a mask by azimuth the highest.
    """

    design: Design = field(repr=False)
    fold: int
    mask_deg: float

    @property
    @abstractmethod
    def outcome(self) -> Outcome:
        """Proven, refuted or undecided."""

    @property
    def holds(self) -> bool:
        """Whether the claim is proven, for all the time asked about."""
        return self.outcome is Outcome.PROVEN

    @property
    def mask_margin_deg(self) -> float | None:
        """Highest mask with the fold wanted, degrees; None if there is none, or along paths."""
        return None
