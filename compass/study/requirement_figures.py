"""What requirements of a study make of candidates: met or not, the margins and the brackets.

Of all together figures of merit, and of each by itself columns ``requirement_K_...``, K as in
``requirement[K]`` of messages about files.
"""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.coverage.certified_effort import Effort
from compass.coverage.requirement_verdict import verdict_of
from compass.coverage.verdict import Verdict
from compass.design import Design
from compass.inputs.study import Study
from compass.orbits import Constellation
from compass.quantities import quantity
from compass.requirement import Requirement
from compass.sites import Mask
from compass.study.columns import Shown, each_placed

#: How near bounds of shares of geometry come at first; most candidates are told apart by that.
COARSE = 2e-3

#: How near bounds of a share come that the study sorts by or limits.
NEAR = 1e-3

#: Parts of a verdict that are kept of each requirement, and the quantities that they are of.
PARTS = {
    "met": "requirement_met",
    "margin_deg": "requirement_margin_deg",
    "share": "requirement_share",
    "share_most": "requirement_share_most",
}


def requirement_columns(study: Study) -> dict[str, dict[str, Any]]:
    """Columns of each requirement of a study by itself, and the attributes of each."""
    columns = {}
    for number, wanted in enumerate(study.requirements, start=1):
        for part, name in PARTS.items():
            attributes = quantity(name).attributes()
            title = f"{wanted.name}: {attributes['long_name']}"
            columns[f"requirement_{number}_{part}"] = attributes | {"long_name": title}
    return columns


def shown_requirements(study: Study) -> list[Shown]:
    """What is shown of each requirement: its margin, and the bounds of its share."""
    asked: list[Shown] = []
    for number, wanted in enumerate(study.requirements, start=1):
        for name in ("requirement_margin_deg", "requirement_share"):
            column = f"requirement_{number}_{name.removeprefix('requirement_')}"
            columns = (column, f"{column}_most") if name == "requirement_share" else (column,)
            known = quantity(name)
            asked.append((f"{wanted.name}: {known.heading}", known, columns))
    return asked


def requirement_figures(study: Study, rows: NDArray) -> dict[str, NDArray[np.float64]]:
    """Verdicts on every requirement of a study, candidate by candidate, shape (n,) each."""
    columns = requirement_columns(study)
    return each_placed(study, "requirements", columns, rows, partial(settled, study))


def settled(study: Study, c: Constellation, mask: float) -> dict[str, float]:
    """Figures of a constellation: once a requirement is missed, those after it are not asked."""
    design = Design(c, figure=study.figure, mask=Mask.constant(mask), signal=study.signal)
    verdicts: list[Verdict] = []
    for number, wanted in enumerate(study.requirements, start=1):
        verdict = _decided(design, wanted)
        sorted_by = {"requirement_share", f"requirement_{number}_share"}
        if study.named & {*sorted_by, *(f"{name}_most" for name in sorted_by)}:
            verdict = narrowed(design, verdict)
        verdicts.append(verdict)
        if verdicts[-1].met is False:
            break
    outcomes = [verdict.met for verdict in verdicts]
    margins = [verdict.margin for verdict in verdicts if verdict.margin is not None]
    shares = [verdict.share for verdict in verdicts if verdict.share is not None]
    met = 0.0 if False in outcomes else np.nan if None in outcomes else 1.0
    each = dict.fromkeys(requirement_columns(study), np.nan)
    for number, verdict in enumerate(verdicts, start=1):
        each |= {f"requirement_{number}_{part}": value for part, value in _parts(verdict).items()}
    return each | {
        "requirements_met": met,
        "requirement_margin_deg": float(np.degrees(min(margins, default=np.nan))),
        "requirement_share": min((low for low, _ in shares), default=np.nan),
        "requirement_share_most": min((high for _, high in shares), default=np.nan),
    }


def _parts(verdict: Verdict) -> dict[str, float]:
    """What is kept of a verdict, by `PARTS`; nan where it has no value."""
    low, high = verdict.share or (np.nan, np.nan)
    return {
        "met": np.nan if verdict.met is None else float(verdict.met),
        "margin_deg": np.nan if verdict.margin is None else float(np.degrees(verdict.margin)),
        "share": low,
        "share_most": high,
    }


def narrowed(design: Design, verdict: Verdict) -> Verdict:
    """The same verdict with the bounds of its share within `NEAR`, by halving what is between.

    Each half is a verdict on as much as its middle; it ends where one, of so many boxes as a
    verdict takes, brings them no nearer.
    """
    if verdict.share is None or verdict.requirement.share == 1.0:
        return verdict
    low, high = verdict.share
    while high - low > NEAR:
        middle = replace(verdict.requirement, share=0.5 * (low + high))
        found = verdict_of(design, middle, effort=Effort(width=0.5 * NEAR)).share
        if found is None or (found[0] <= low and found[1] >= high):
            break
        low, high = max(low, found[0]), min(high, found[1])
    return replace(verdict, share=(low, high))


def _decided(design: Design, wanted: Requirement) -> Verdict:
    """Verdict with coarse bounds where these tell, with fine ones where they do not."""
    coarse = verdict_of(design, wanted, effort=Effort(width=COARSE))
    return coarse if coarse.met is not None else verdict_of(design, wanted)
