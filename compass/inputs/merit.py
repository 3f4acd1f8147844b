"""The figures of merit that a study may name: at which stage each is known, its unit, its claim."""

from dataclasses import dataclass

#: In the order in which a candidate goes through them, cheapest first.
STAGES = ("cost", "screen", "map", "orbits", "entry")


@dataclass(frozen=True)
class Merit:
    """A figure of merit: the stage that finds it, its unit, what it is, which way is better."""

    stage: str
    unit: str
    title: str
    goal: str

    @property
    def heading(self) -> str:
        """Title with unit, for a column or an axis."""
        return self.title + ("" if self.unit == "1" else f", {self.unit}")


MERITS: dict[str, Merit] = {
    "satellites": Merit("cost", "1", "number of satellites", "minimise"),
    "planes": Merit("cost", "1", "number of planes", "minimise"),
    "delta_v_transfer_m_s": Merit(
        "cost", "m/s", "delta-v of the transfer from the parking orbit, a satellite", "minimise"
    ),
    "delta_v_planes_m_s": Merit(
        "cost", "m/s", "delta-v from the launch plane to the farthest plane", "minimise"
    ),
    "delta_v_total_m_s": Merit(
        "cost", "m/s", "transfer and plane change, summed over the satellites", "minimise"
    ),
    "node_drift_deg_year": Merit(
        "cost", "deg/year", "drift of the nodes under J2, common to all planes", "minimise"
    ),
    "fold_proven": Merit(
        "screen", "1", "continuous fold at the mask: 1 proven, 0 refuted", "maximise"
    ),
    "cap_radius_min_deg": Merit("screen", "deg", "smallest cap radius for the fold", "minimise"),
    "mask_margin_deg": Merit("screen", "deg", "highest mask with the fold", "maximise"),
    "closest_approach_deg": Merit(
        "screen", "deg", "least angle between two satellites at any time", "maximise"
    ),
    "delta_v_keeping_m_s_year": Merit(
        "screen",
        "m/s/year",
        "delta-v of the satellite that needs most to stay in its slot, by the mean push of the "
        "field",
        "minimise",
    ),
    "gdop_p50": Merit("map", "1", "GDOP, median over area and time", "minimise"),
    "gdop_p95": Merit("map", "1", "GDOP, 95th percentile over area and time", "minimise"),
    "gdop_p95_zone": Merit(
        "map", "1", "GDOP, 95th percentile in the zone of latitude where it is worst", "minimise"
    ),
    "pdop_p95": Merit("map", "1", "PDOP, 95th percentile over area and time", "minimise"),
    "availability": Merit("map", "1", "share of area and time with a good PDOP", "maximise"),
    "count_mean": Merit("map", "1", "satellites in view, mean over area and time", "maximise"),
    "days_proven": Merit(
        "orbits", "d", "days that the fold is proven on real orbits, trimmed once", "maximise"
    ),
    "in_view.min": Merit("entry", "1", "fewest satellites in view in an entry", "maximise"),
    "in_view.median": Merit("entry", "1", "satellites in view in an entry, median", "maximise"),
    "crlb_position_m.p50": Merit("entry", "m", "position bound at the end, median", "minimise"),
    "crlb_position_m.p95": Merit(
        "entry", "m", "position bound at the end, 95th percentile of entries", "minimise"
    ),
    "crlb_velocity_m_s.p50": Merit("entry", "m/s", "velocity bound at the end, median", "minimise"),
    "crlb_velocity_m_s.p95": Merit(
        "entry", "m/s", "velocity bound at the end, 95th percentile of entries", "minimise"
    ),
    "share_within_goal": Merit(
        "entry", "1", "share of entries whose position bound is within the goal", "maximise"
    ),
    "unobservable_share": Merit(
        "entry", "1", "share of entries whose state cannot be observed", "minimise"
    ),
}


def merits_of(stage: str) -> list[str]:
    """Names of the figures that a stage finds, in order."""
    return [name for name, merit in MERITS.items() if merit.stage == stage]
