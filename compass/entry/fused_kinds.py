"""The algorithms of fused filters, one record each, by their names in scenario files."""

from dataclasses import dataclass
from typing import Literal

#: Rules by which local estimates are weighed, see `compass.entry.intersection`.
Weighting = Literal["determinant", "trace", "fast", "equal"]

Algorithm = Literal[
    "ekf", "iterated", "information", "intermittent", "ci", "ci-feedback", "dcifaif", "federated"
]


@dataclass(frozen=True)
class Kind:
    """An algorithm: what `compass.core.entry.groups.Arrangement` says of it, and its usual rule.

    With `lost_is_zero` a beacon's lost signal is taken for one that reads 0.
    """

    apart: bool = False
    feedback: bool = False
    divided: bool = False
    fading: bool = False
    weighting: Weighting = "equal"
    iterations: int = 1
    lost_is_zero: bool = False


#: All algorithms. An information filter is algebraically the extended Kalman filter that skips
#: what did not arrive; ``information`` takes a lost range for one that reads 0.
KINDS_OF_FILTER: dict[Algorithm, Kind] = {
    "ekf": Kind(),
    "iterated": Kind(iterations=5),
    "information": Kind(lost_is_zero=True),
    "intermittent": Kind(),
    "ci": Kind(apart=True, weighting="determinant"),
    "ci-feedback": Kind(apart=True, feedback=True, weighting="determinant"),
    "dcifaif": Kind(apart=True, feedback=True, fading=True, weighting="fast"),
    "federated": Kind(apart=True, feedback=True, divided=True),
}
