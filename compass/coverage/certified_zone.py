"""What a dilution of precision does not exceed in the zone of latitude where that is most."""

from collections.abc import Sequence
from math import inf
from typing import Unpack

from compass.coverage.certified_percentile import (
    GREATEST,
    CertifiedPercentile,
    certified_percentile,
)
from compass.coverage.certified_places import Place
from compass.coverage.certified_question import Asked
from compass.coverage.certified_share import certified_share
from compass.orbits import Constellation

#: How near shares come that put zones in order, and parts of the boxes for that and for the look
#: whether a zone can be the worst.
COARSE, ORDERED, COMPARED = 2e-2, 0.2, 0.1

#: Limit at most by whose shares zones are put in order.
TOLD = 100.0


def certified_worst_zone(
    constellation: Constellation,
    percent: float,
    zones: Sequence[Place],
    *,
    guess: float,
    precision: float,
    budget_boxes: float,
    limits: Sequence[float] = (),
    **asked: Unpack[Asked],
) -> CertifiedPercentile:
    """Bracket the largest of one percentile of several zones.

    Zones are looked at in the order of their shares below a guess; once one is known, those whose
    share below its lower bound is large enough cannot be worse.

    Parameters
    ----------
    constellation, percent, precision, limits, asked
        As of `compass.coverage.certified_percentile.certified_percentiles`.
    zones
        Where.
    guess
        An estimate, such as a sample's.
    budget_boxes
        For each zone.
    """
    asked.setdefault("dop", "gdop")
    level, at = percent / 100.0, min(max(guess, 1.0 + COARSE), TOLD)

    def share_below(limit: float, place: Place, part: float, *levels: float) -> float:
        here: Asked = {**asked, "place": place}
        boxes = part * budget_boxes
        return certified_share(
            constellation, limit, width=COARSE, against=levels, budget_boxes=boxes, **here
        ).low

    order = [(share_below(at, zone, ORDERED / len(zones)), k) for k, zone in enumerate(zones)]
    low, high, scope, stopped = 0.0, 0.0, "", ""
    for _, k in sorted(order):
        if low >= GREATEST:
            return CertifiedPercentile(low, inf, percent, scope)
        if low >= 1.0 and share_below(low, zones[k], COMPARED, level) >= level:
            continue
        here: Asked = {**asked, "place": zones[k]}
        found = certified_percentile(
            constellation,
            percent,
            guess=guess,
            precision=precision,
            budget_boxes=budget_boxes,
            limits=limits,
            **here,
        )
        low, high, scope = max(low, found.low), max(high, found.high), found.scope
        stopped = stopped or found.stopped
    return CertifiedPercentile(low, high, percent, scope, stopped)
