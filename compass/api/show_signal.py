"""What a design's ranges are worth: by age, by elevation, and term by term."""

from typing import Any

import numpy as np

from compass.design import Design
from compass.document import Sentence, Table, Value
from compass.document.blocks import Block, columns
from compass.frames import HOUR
from compass.quantities import quantity
from compass.signal.budget import TERMS, basis, range_budget
from compass.signal.weights import average_weights

#: Correlations of clocks and orbits that change a range's error by less than this are not told.
TIED = 0.01

ELEVATIONS = (0.0, 5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0)


def _ages(design: Design) -> tuple[float, ...]:
    """Ages of the data to tell, s: none, half and all of the time between uploads."""
    assert design.signal is not None
    update = design.signal.update
    return (0.0, 0.5 * update, update) if update else (0.0,)


def _elevations(design: Design) -> np.ndarray:
    """Elevations to tell, degrees: the mask, and round ones above it."""
    mask = float(np.degrees(design.mask.lowest))
    return np.array([mask, *(e for e in ELEVATIONS if e > mask)])


def signal_facts(design: Design) -> dict[str, Any]:
    """Range errors and their terms by elevation, errors by age, and the average user's weights."""
    assert design.signal is not None
    degrees = _elevations(design)
    elevation = np.radians(degrees)
    budget = range_budget(design, elevation)
    radius = float(design.constellation.periapsis_radius[0])
    weights = average_weights(radius, design.figure.equatorial_radius, design.mask.lowest)
    terms = {f"{term}_error_m": getattr(budget, term).tolist() for term in TERMS}
    return {
        "elevation_deg": degrees.tolist(),
        "range_error_m": budget.total.tolist(),
        **terms,
        "by_age": {
            "age_h": [age / HOUR for age in _ages(design)],
            "range_error_m": [
                range_budget(design, elevation, age=age).total.tolist() for age in _ages(design)
            ],
        },
        "radial_weight": weights.radial,
        "across_weight_inverse": 1.0 / weights.across2,
    }


def signal_blocks(design: Design) -> list[Block]:
    """Tables of `signal_facts`, and what they leave out; none without a signal."""
    if design.signal is None:
        return []
    known = signal_facts(design)
    names = ("elevation_deg", "range_error_m", *(f"{term}_error_m" for term in TERMS))
    rows = [
        [Value(quantity(name), known[name][k]) for name in names]
        for k in range(len(known["elevation_deg"]))
    ]
    which = {"mean": "mean over the ages of the data", "worst": "the oldest data"}
    blocks: list[Block] = [
        columns(f"Budget of a range, m, one sigma: {which[design.signal.age]}", rows)
    ]
    ages = known["by_age"]["age_h"]
    if len(ages) > 1:
        header = ("elevation, deg", *(f"{age:.4g} h" for age in ages))
        by_age = tuple(
            (
                Value(quantity("elevation_deg"), e),
                *(
                    Value(quantity("range_error_m"), row[k])
                    for row in known["by_age"]["range_error_m"]
                ),
            )
            for k, e in enumerate(known["elevation_deg"])
        )
        blocks.append(Table("Range error by age of the data, m, one sigma", header, by_age))
    blocks.append(Sentence(_left_out(design)))
    return blocks


def _left_out(design: Design) -> str:
    """Say what the budget holds and what it does not."""
    assert design.signal is not None
    clock = design.signal.clock
    told = "clocks are set to a constant" if clock is None else f"clock {clock.title}"
    told += f" ({clock.source})" if clock is not None and clock.source else ""
    shared = design.signal.common_time or design.signal.common_orientation
    told += f"; {basis(design)}" if design.signal.determined else ""
    of_each = design.signal.of_satellites(design.constellation.size)
    sigmas = np.sqrt(np.diagonal(of_each, axis1=1, axis2=2))
    common = np.any(np.abs(of_each[:, :3, 3]) > TIED * sigmas[:, :3] * sigmas[:, 3:])
    return (
        f"{told}; along and cross errors as the mean over azimuths at the satellite's lowest; left "
        "out: troposphere (centimetres), multipath, antenna offsets"
        + ("; errors that all satellites share are added to fixes, not to ranges" if shared else "")
        + ("; what clocks and orbits have in common counts in fixes, not here" if common else "")
    )
