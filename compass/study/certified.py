"""What a map's figures over all area and time are for sure: brackets beside the samples."""

from dataclasses import dataclass, replace
from typing import Any

from compass.coverage.certified_share import (
    CertifiedPercentile,
    CertifiedShare,
    certified_percentile,
    certified_share,
)
from compass.design import Design
from compass.study.mapping import MapOptions, option_mask

#: How near bounds of a share are to come, and those of a percentile, relative to it.
WIDTH, PRECISION = 2e-4, 2e-2

#: Boxes after which a bracket is taken as it is: some seconds, and the same on any machine.
BUDGET_BOXES = 600_000


@dataclass(frozen=True)
class CertifiedFigures:
    """Share of area and time with a good PDOP, and what GDOP does not exceed in 95 % of them."""

    availability: CertifiedShare
    gdop_p95: CertifiedPercentile

    def attrs(self) -> dict[str, Any]:
        """Return the brackets as attributes of a dataset."""
        a, p = self.availability, self.gdop_p95
        return {
            "certified_availability_bracket": [a.low, a.high],
            "certified_gdop_p95_bracket": [p.low, p.high],
            "certified_scope": self.scope,
        }

    @property
    def scope(self) -> str:
        """For which motion and how long, and how it was found."""
        late = self.availability.stopped or self.gdop_p95.stopped
        return f"{self.availability.scope}; branch and bound, {self.availability.boxes} boxes" + (
            f"; stopped early: {late}" if late else ""
        )


def certified_figures(design: Design, options: MapOptions) -> CertifiedFigures | None:
    """Bracket a map's figures over the whole sphere; None for motions that have no bounds yet.

    For all time where the motion repeats up to a turn of the sphere, else over the map's period
    from the epoch on.

    Parameters
    ----------
    design, options
        As of `compass.study.mapping.make_map`.
    """
    motion = design.motion.or_of(options.motion)
    if motion.model not in ("two-body", "j2") or not design.constellation.size:
        return None
    if options.start_day or options.pdop_max < 1.0:
        return None
    hours = options.duration_h
    asked: dict[str, Any] = {
        "figure": replace(design.figure, polar_radius=design.figure.equatorial_radius),
        "mask": design.mask if options.mask_deg is None else option_mask(options.mask_deg),
        "duration": None if hours is None else hours * 3600.0,
        "motion": motion,
        "budget_boxes": BUDGET_BOXES,
    }
    availability = certified_share(
        design.constellation, options.pdop_max, dop="pdop", width=WIDTH, **asked
    )
    p95 = certified_percentile(design.constellation, 95.0, dop="gdop", precision=PRECISION, **asked)
    return CertifiedFigures(availability, p95)
