"""The figures of merit that a study may name: at which stage each is found, which way is better."""

from dataclasses import dataclass

from compass.quantities import Quantity, quantity

#: In the order in which a candidate goes through them, cheapest first.
STAGES = ("cost", "screen", "map", "requirements", "orbits", "entry")


@dataclass(frozen=True)
class Merit:
    """A quantity that sorts candidates, and the stage that finds it."""

    quantity: Quantity
    stage: str

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


#: What each stage finds, by the names in `compass.quantities`.
_FOUND_BY = {
    "cost": (
        "satellites", "planes", "delta_v_transfer_m_s", "delta_v_planes_m_s", "delta_v_total_m_s",
        "delta_v_deploy_m_s", "wait_days", "node_drift_deg_year",
    ),
    "screen": (
        "fold_proven", "cap_radius_min_deg", "mask_margin_deg", "closest_approach_deg",
        "delta_v_keeping_m_s_year",
    ),
    "map": ("gdop_p50", "gdop_p95", "gdop_p95_zone", "pdop_p95", "availability", "count_mean"),
    "requirements": (
        "requirements_met", "requirement_margin_deg", "requirement_share", "requirement_share_most",
    ),
    "orbits": ("days_proven",),
    "entry": (
        "in_view.min", "in_view.median", "crlb_position_m.p50", "crlb_position_m.p95",
        "crlb_velocity_m_s.p50", "crlb_velocity_m_s.p95", "share_within_goal",
        "unobservable_share",
    ),
}  # fmt: skip

MERITS: dict[str, Merit] = {
    name: Merit(quantity(name), stage) for stage in STAGES for name in _FOUND_BY[stage]
}


def merits_of(stage: str) -> tuple[str, ...]:
    """Names of the figures that a stage finds."""
    return _FOUND_BY[stage]
