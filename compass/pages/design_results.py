"""What a design's page is made from: the results of the commands, each asked once."""

from dataclasses import dataclass

from compass.api.access_result import AccessResult
from compass.api.check import CheckResult
from compass.api.fold_result import FoldResult
from compass.api.map_result import MapResult
from compass.api.outlook import Outlook
from compass.api.series_result import SeriesResult
from compass.api.show import ShowResult
from compass.coverage.areas import AreaFigures
from compass.design import Design


@dataclass(frozen=True)
class DesignResults:
    """Results on one design.

    Attributes
    ----------
    design
        The design.
    shown, mapped, fold
        Of `compass.show`, `compass.map` and `compass.fold` (with one satellite lost, two-body).
    access
        Of `compass.access`, or None where nothing is to be linked.
    checked
        Of `compass.check`; None where the design has no requirements of its own.
    outlook
        How long it lasts on real orbits; None where nobody asked.
    followed
        Of `compass.series` at the stations; None without any, or without a signal.
    stations
        Fold and geometry at the stations, proven or between proven bounds.
    aloft
        Maps of users above the ground or in beams, of whom requirements speak.
    """

    design: Design
    shown: ShowResult
    mapped: MapResult
    fold: FoldResult
    access: AccessResult | None
    outlook: Outlook | None = None
    checked: CheckResult | None = None
    followed: SeriesResult | None = None
    stations: tuple[AreaFigures, ...] = ()
    aloft: tuple[MapResult, ...] = ()
