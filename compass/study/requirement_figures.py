"""What requirements of a study make of candidates: met or not, the margins and the brackets."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from compass.coverage.certified_effort import Effort
from compass.coverage.requirement_verdict import verdict_of
from compass.coverage.verdict import Verdict
from compass.design import Design, Requirement
from compass.inputs.study import Study
from compass.orbits import Constellation
from compass.quantities.merits import merits_of, worked_out
from compass.sites import Mask
from compass.study.candidates import make_constellation

#: How near bounds of shares of geometry come at first; most candidates are told apart by that.
COARSE = 2e-3


def requirement_figures(study: Study, rows: NDArray) -> dict[str, NDArray[np.float64]]:
    """Verdicts on every requirement of a study, candidate by candidate, shape (n,) each.

    Tracks of orbits that the study names are closed, their nodes as candidates stand at the epoch.
    """
    found = []
    for row in rows:
        repeat = study.space.repeat(float(row["radius_km"]))
        c = replace(make_constellation(row), repeat=repeat)
        found.append(settled(study, c, float(np.radians(row["mask_deg"]))))
    names = found[0] if found else merits_of("requirements")
    return worked_out("requirements", {name: [one[name] for one in found] for name in names})


def settled(study: Study, c: Constellation, mask: float) -> dict[str, float]:
    """Figures of a constellation: once a requirement is missed, those after it are not asked."""
    design = Design(c, figure=study.figure, mask=Mask.constant(mask), signal=study.signal)
    verdicts: list[Verdict] = []
    for wanted in study.requirements:
        verdicts.append(_decided(design, wanted))
        if verdicts[-1].met is False:
            break
    outcomes = [verdict.met for verdict in verdicts]
    margins = [verdict.margin for verdict in verdicts if verdict.margin is not None]
    shares = [verdict.share for verdict in verdicts if verdict.share is not None]
    met = 0.0 if False in outcomes else np.nan if None in outcomes else 1.0
    return {
        "requirements_met": met,
        "requirement_margin_deg": float(np.degrees(min(margins, default=np.nan))),
        "requirement_share": min((low for low, _ in shares), default=np.nan),
        "requirement_share_most": min((high for _, high in shares), default=np.nan),
    }


def _decided(design: Design, wanted: Requirement) -> Verdict:
    """Verdict with coarse bounds where these tell, with fine ones where they do not."""
    coarse = verdict_of(design, wanted, effort=Effort(width=COARSE))
    return coarse if coarse.met is not None else verdict_of(design, wanted)
