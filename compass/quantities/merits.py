"""Figures of merit, one record each: what it is, which stage finds it, how it is worked out.

A stage hands over what it knows of a batch of candidates, arrays by name along them; a figure is
one of these, or worked out of several. Study files, stores, constraints, fronts and pages take
names, units, directions and values from here.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compass.quantities.coverage import CONTINUOUS, MAPS
from compass.quantities.design import DESIGN
from compass.quantities.draws import median_number
from compass.quantities.geometry import GEOMETRY
from compass.quantities.lasting import LASTING
from compass.quantities.percentile import percentile
from compass.quantities.record import Quantity

#: What candidates go through, cheapest first.
STAGES = ("cost", "screen", "map", "requirements", "areas", "orbits", "entry")

#: What a stage knows of a batch of n candidates: arrays of shape (n, ...), and numbers.
Known = Mapping[str, Any]


@dataclass(frozen=True)
class Merit:
    """A quantity that sorts candidates.

    Attributes
    ----------
    quantity
        What it is; which way is better.
    stage
        Which of `STAGES` finds it.
    of
        How it is worked out of what the stage knows; without, the stage knows it by its name.
    needs
        Table without which no candidate of a study has it.
    """

    quantity: Quantity
    stage: str
    of: Callable[[Known], ArrayLike] | None = None
    needs: str = ""

    @property
    def title(self) -> str:
        """What it is, in words."""
        return self.quantity.title

    @property
    def unit(self) -> str:
        """Unit of its values as a reader sees it; nothing for a pure number, or a share of one."""
        return "" if self.quantity.form == "share" else self.quantity.shown_unit

    @property
    def goal(self) -> str:
        """Which way is better, in the words of study files."""
        return {"less": "minimise", "more": "maximise"}[self.quantity.better]

    @property
    def heading(self) -> str:
        """Title with unit, for a column or an axis."""
        return self.title + (f", {self.unit}" if self.unit else "")

    def values(self, known: Known) -> NDArray[np.float64]:
        """Its values, shape (n,)."""
        values = known[self.quantity.name] if self.of is None else self.of(known)
        return np.asarray(values, dtype=float)


def _error(name: str, title: str) -> Merit:
    """The 95th percentile of an error of fixes."""
    meaning = "One sigma, not exceeded at 95 of 100 places and moments; by the study's [signal]."
    made = Quantity(
        f"{name}.p95", "m", f"{title}, 95th percentile over area and time", 3, "less",
        meaning=meaning,
    )  # fmt: skip
    return Merit(made, "map", needs="signal")


_SHARED = {q.name: q for q in (*DESIGN, *GEOMETRY, *CONTINUOUS, *MAPS, *LASTING)}


#: What figures of all sites and regions of a study add to the title of those of one.
WORST = ", worst site or region"


def _of_areas(name: str) -> Merit:
    """A figure of the worst of all sites and regions of a study."""
    return Merit(replace(_SHARED[name], title=_SHARED[name].title + WORST), "areas")


_ALL = (
    Merit(_SHARED["satellites"], "cost"),
    Merit(_SHARED["planes"], "cost"),
    Merit(
        Quantity(
            "delta_v_transfer_m_s",
            "m s-1",
            "delta-v of the transfer from the parking orbit",
            4,
            "less",
            meaning="Of one satellite: two burns between circles in its plane.",
        ),
        "cost",
    ),
    Merit(
        Quantity(
            "delta_v_planes_m_s",
            "m s-1",
            "delta-v from the launch plane to the farthest plane",
            4,
            "less",
            meaning="Turning the node at the constellation's height, the shorter way.",
        ),
        "cost",
    ),
    Merit(
        Quantity(
            "delta_v_total_m_s",
            "m s-1",
            "transfer and plane change, summed over the satellites",
            4,
            "less",
            meaning="What all satellites together need to come to their places.",
        ),
        "cost",
        lambda k: (
            k["satellites"] * k["delta_v_transfer_m_s"]
            + k["satellites"] / k["planes"] * k["turns_m_s"]
        ),
    ),
    Merit(_SHARED["delta_v_deploy_m_s"], "cost"),
    Merit(_SHARED["wait_days"], "cost"),
    Merit(
        Quantity(
            "node_drift_deg_year",
            "deg year-1",
            "drift of the nodes under J2, common to all planes",
            4,
            "less",
            meaning="Turns the whole pattern about the pole in an Earth year.",
        ),
        "cost",
    ),
    Merit(_SHARED["fold_proven"], "screen"),
    Merit(_SHARED["cap_radius_min_deg"], "screen"),
    Merit(_SHARED["mask_margin_deg"], "screen"),
    Merit(_SHARED["closest_approach_deg"], "screen"),
    Merit(_SHARED["delta_v_keeping_m_s_year"], "screen"),
    Merit(
        Quantity(
            "gdop_p50",
            "1",
            "GDOP, median over area and time",
            3,
            "less",
            meaning="Not exceeded at half of all places and moments.",
        ),
        "map",
    ),
    Merit(_SHARED["gdop_p95"], "map"),
    Merit(
        Quantity(
            "gdop_p95_zone",
            "1",
            "GDOP, 95th percentile in the zone of latitude where it is worst",
            3,
            "less",
            meaning="North and south of the equator together.",
        ),
        "map",
    ),
    Merit(
        Quantity(
            "pdop_p95",
            "1",
            "PDOP, 95th percentile over area and time",
            3,
            "less",
            meaning="Not exceeded at 95 of 100 places and moments.",
        ),
        "map",
    ),
    Merit(_SHARED["availability"], "map"),
    Merit(
        Quantity(
            "count_mean",
            "1",
            "satellites in view, mean over area and time",
            4,
            "more",
            meaning="With alike caps: the share of the sphere in a cap times their number.",
        ),
        "map",
    ),
    _error("error_horizontal_m", "horizontal error"),
    _error("error_vertical_m", "vertical error"),
    _error("error_position_m", "position error"),
    _error("error_time_m", "time error"),
    _of_areas("area_fold_met"),
    _of_areas("area_margin_deg"),
    _of_areas("area_availability"),
    _of_areas("area_gdop_p50"),
    _of_areas("area_gdop_p95"),
    Merit(_SHARED["requirements_met"], "requirements"),
    Merit(_SHARED["requirement_margin_deg"], "requirements"),
    Merit(_SHARED["requirement_share"], "requirements"),
    Merit(_SHARED["requirement_share_most"], "requirements"),
    Merit(_SHARED["days_proven"], "orbits"),
    Merit(
        Quantity(
            "in_view.min",
            "1",
            "fewest satellites in view in an entry",
            better="more",
            form="count",
            meaning="At any moment of any entry judged.",
        ),
        "entry",
        lambda k: (k["counts"] > 0).argmax(axis=1),
    ),
    Merit(
        Quantity(
            "in_view.median",
            "1",
            "satellites in view in an entry, median",
            3,
            "more",
            meaning="Over the moments of all entries judged.",
        ),
        "entry",
        lambda k: median_number(k["counts"]),
    ),
    Merit(
        Quantity(
            "crlb_position_m.p50",
            "m",
            "position bound at the end, median",
            4,
            "less",
            meaning="Cramer-Rao bound of the position in space, one sigma, over entries judged.",
        ),
        "entry",
        lambda k: percentile(k["position_m"], 50, axis=1),
    ),
    Merit(
        Quantity(
            "crlb_position_m.p95",
            "m",
            "position bound at the end, 95th percentile of entries",
            4,
            "less",
            meaning="Cramer-Rao bound of the position in space, one sigma.",
        ),
        "entry",
        lambda k: percentile(k["position_m"], 95, axis=1),
    ),
    Merit(
        Quantity(
            "crlb_velocity_m_s.p50",
            "m s-1",
            "velocity bound at the end, median",
            4,
            "less",
            meaning="Cramer-Rao bound of the velocity, one sigma, over the entries judged.",
        ),
        "entry",
        lambda k: percentile(k["velocity_m_s"], 50, axis=1),
    ),
    Merit(
        Quantity(
            "crlb_velocity_m_s.p95",
            "m s-1",
            "velocity bound at the end, 95th percentile of entries",
            4,
            "less",
            meaning="Cramer-Rao bound of the velocity, one sigma.",
        ),
        "entry",
        lambda k: percentile(k["velocity_m_s"], 95, axis=1),
    ),
    Merit(
        Quantity(
            "share_within_goal",
            "1",
            "share of entries whose position bound is within the goal",
            4,
            "more",
            "share",
            meaning="The goal is the study's own.",
        ),
        "entry",
        lambda k: (k["position_m"] <= k["goal_m"]).mean(axis=1),
    ),
    Merit(
        Quantity(
            "unobservable_share",
            "1",
            "share of entries whose state cannot be observed",
            4,
            "less",
            "share",
            meaning="Measurements alone leave a direction of the state open.",
        ),
        "entry",
        lambda k: k["blind"].mean(axis=1),
    ),
)

#: Names of figures of one requirement by itself: its number in the file, and which figure.
OF_ONE = re.compile(r"requirement_([1-9]\d*)_(margin_deg|share|share_most)")


class _Merits(dict[str, Merit]):
    """Figures by name; those of one requirement, as many as there may be, when asked for."""

    def __missing__(self, name: str) -> Merit:
        match = OF_ONE.fullmatch(name)
        if match is None:
            raise KeyError(name)
        shared = _SHARED[f"requirement_{match[2]}"]
        title = f"requirement {match[1]}: {shared.title}"
        return Merit(replace(shared, name=name, title=title), "requirements")


#: By name, in the order of the stages.
MERITS: Mapping[str, Merit] = _Merits({merit.quantity.name: merit for merit in _ALL})


def merits_of(stage: str) -> tuple[str, ...]:
    """Names of the figures that a stage finds."""
    return tuple(name for name, merit in MERITS.items() if merit.stage == stage)


def worked_out(stage: str, known: Known) -> dict[str, NDArray[np.float64]]:
    """Every figure of a stage, shape (n,) each, of what the stage knows."""
    return {name: MERITS[name].values(known) for name in merits_of(stage)}
