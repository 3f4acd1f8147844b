"""Where dispersed entries come down: the sentence and the numbers."""

import math
from typing import Any

import numpy as np

from compass.document.numbers import significant
from compass.entry.dispersed import Dispersed, beyond_words
from compass.quantities.draws import share_bounds
from compass.units import KM


def dispersed_sentence(dispersed: Dispersed) -> str:
    """Where dispersed entries come down."""
    event = dispersed.event
    count, came = dispersed.times.size, int(dispersed.reached.sum())
    lost = f"; {count - came} do not come to it" if came < count else ""
    of = "the target" if dispersed.guided else "where the planned one does"
    how = "guided " if dispersed.guided else ""
    if came < 3:
        return f"Of {count} dispersed {how}entries {came} come to {event}."
    ellipse = dispersed.ellipse
    half, most = (distance_words(dispersed.within(share)) for share in (50.0, 95.0))
    (least, less), (more, greatest) = (
        map(distance_words, dispersed.within_bounds(share)) for share in (50.0, 95.0)
    )
    return (
        f"Of {count} dispersed {how}entries half come to {event} within {half} of {of}, 95 % "
        f"within {most} (95 % ellipse {distance_words(ellipse.semi_major)} by "
        f"{distance_words(ellipse.semi_minor)}, half axes). Other draws would put half within "
        f"{least} to {less}, 95 % within {more} to {greatest}, in 95 of 100 cases{lost}."
        f"{_knowledge_words(dispersed)}{beyond_words(dispersed.beyond)}"
    )


def _knowledge_words(dispersed: Dispersed) -> str:
    """What guidance knew, if that was not all."""
    if dispersed.nees is None:
        return ""
    known = (
        " They are guided by what the filter knows, which is "
        f"{significant(dispersed.knowledge, 3)} m off at last (rms)"
    )
    if dispersed.claims_hold:
        return f"{known}."
    nees = significant(float(dispersed.nees[dispersed.reached].mean()), 3)
    return f"{known} and inconsistent: NEES {nees} where 6 is right."


def distance_words(metres: float) -> str:
    """A distance over the ground, in metres below a kilometre."""
    if not math.isfinite(metres):
        return "no distance"
    return f"{significant(metres, 3)} m" if metres < KM else f"{significant(metres / KM, 3)} km"


def dispersed_facts(dispersed: Dispersed) -> dict[str, Any]:
    """Where dispersed entries come down, as plain values."""
    reached = dispersed.reached
    ellipse = dispersed.ellipse if int(reached.sum()) >= 3 else None
    return {
        "at": dispersed.event,
        "guided": dispersed.guided,
        "entries": dispersed.times.size,
        "reached": int(reached.sum()),
        "within_m": {
            "p50": dispersed.within(50.0),
            "p50_interval": dispersed.within_bounds(50.0),
            "p95": dispersed.within(95.0),
            "p95_interval": dispersed.within_bounds(95.0),
        },
        "beyond_m": dispersed.beyond,
        "reached_share": reached.mean(),
        "reached_share_interval": share_bounds(float(reached.mean()), reached.size),
        "knowledge_rms_m": None if dispersed.nees is None else dispersed.knowledge,
        "nees": None if dispersed.nees is None else dispersed.nees[reached].mean(),
        "offsets_east_north_m": dispersed.offsets,
        "ellipse": None
        if ellipse is None
        else {
            "east_m": ellipse.east,
            "north_m": ellipse.north,
            "semi_major_m": ellipse.semi_major,
            "semi_minor_m": ellipse.semi_minor,
            "azimuth_deg": np.degrees(ellipse.azimuth),
            "level": ellipse.level,
        },
    }
