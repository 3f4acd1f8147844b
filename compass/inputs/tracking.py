"""The table ``[tracking]`` of a design: read, checked, and turned into a `Tracking`."""

from typing import Annotated, Any, Literal

from pydantic import Field

from compass.inputs.table import Table
from compass.tracking import TRACKERS, Tracker, Tracking

DAY = 86400.0
Positive = Annotated[float, Field(gt=0, lt=1e9)]
Sigma = Annotated[float, Field(ge=0, lt=1e9)]


class TrackerTable(Table):
    """One kind of tracking."""

    range_m: Positive | None = Field(None, description="noise of one range a step, m, 1 sigma")
    doppler_mm_s: Positive | None = Field(
        None, description="noise of a range rate over a minute, mm/s, 1 sigma"
    )
    time_m: Positive | None = Field(
        None, description="noise of one comparison of clocks a step, m, 1 sigma"
    )
    bias_m: Sigma = Field(0.0, description="constant error of its ranges, m, considered")
    time_bias_m: Sigma = Field(0.0, description="constant error of its time, m, considered")
    position_m: Sigma = Field(0.0, description="error of its coordinates, m, considered")
    one_way: bool = Field(False, description="whether ranges hold the satellite's clock")
    schedule: Literal["all", "in-turn"] = Field(
        "all", description="all satellites in view at once, or one after the other"
    )


class TrackingTable(Table):
    """Who tracks the satellites."""

    days: float = Field(1.0, gt=0, le=1000, description="arc from the epoch, up to 1000 days")
    step_s: Positive = Field(600.0, description="between measurements, s")
    prior_m: Positive = Field(1000.0, description="knowledge of each coordinate before, m")
    prior_mm_s: Positive = Field(100.0, description="of each velocity component, mm/s")
    prior_clock_m: Positive = Field(1000.0, description="of each clock, m")
    process_noise_m2_s3: float = Field(
        3.6e-15, ge=0, lt=1, description="density of unmodelled acceleration, m^2/s^3"
    )
    radiation_sigma: Sigma = Field(
        0.1, description="knowledge before of each satellite's push by sunlight, relative, 1 sigma"
    )
    gravity_sigmas: Sigma = Field(
        10.0, description="errors of the gravity field, in its formal sigmas, considered"
    )
    considered: Literal["schmidt", "blind"] = Field(
        "schmidt", description="whether gains know the sigmas of what is considered, or ignore it"
    )
    earth: TrackerTable | None = Field(None, description="three complexes, eight hours each")
    stations: TrackerTable | None = Field(None, description="the design's stations")
    moons: TrackerTable | None = Field(None, description="stations on Phobos and Deimos")
    crosslinks: TrackerTable | None = Field(None, description="satellites with each other")


def tracking_of_table(table: TrackingTable) -> Tracking:
    """Tracking of a design's table, in SI."""
    return Tracking(
        earth=_tracker(table.earth),
        stations=_tracker(table.stations),
        moons=_tracker(table.moons),
        crosslinks=_tracker(table.crosslinks),
        duration=table.days * DAY,
        step=table.step_s,
        prior=table.prior_m,
        prior_speed=table.prior_mm_s / 1e3,
        prior_clock=table.prior_clock_m,
        process_noise=table.process_noise_m2_s3,
        radiation=table.radiation_sigma,
        gravity=table.gravity_sigmas,
        considered=table.considered,
    )


def _tracker(table: TrackerTable | None) -> Tracker | None:
    if table is None:
        return None
    return Tracker(
        range=table.range_m,
        doppler=None if table.doppler_mm_s is None else table.doppler_mm_s / 1e3,
        time=table.time_m,
        bias=table.bias_m,
        time_bias=table.time_bias_m,
        position=table.position_m,
        one_way=table.one_way,
        schedule=table.schedule,
    )


def tracking_faults(raw: dict[str, Any]) -> list[str]:
    """Faults between fields of ``[tracking]``, found on the raw tables, whatever is in them."""
    table = raw.get("tracking")
    if not isinstance(table, dict):
        return []
    faults = []
    kinds = [name for name in TRACKERS if isinstance(table.get(name), dict)]
    if not kinds:
        faults.append(f"tracking: nobody tracks; give one of {', '.join(TRACKERS)}")
    for name in kinds:
        tracker = table[name]
        if not {"range_m", "doppler_mm_s", "time_m"} & set(tracker):
            faults.append(
                f"tracking.{name}: measures nothing; give one of range_m, doppler_mm_s, time_m"
            )
        if name == "crosslinks" and tracker.get("position_m"):
            faults.append("tracking.crosslinks.position_m: satellites are estimated; leave it out")
        if name == "crosslinks" and tracker.get("one_way"):
            faults.append("tracking.crosslinks.one_way: links are two-way; give time_m for clocks")
    if "stations" in kinds and not raw.get("station"):
        faults.append("tracking.stations: the design has none; add a [[station]]")
    days, step = table.get("days", 1.0), table.get("step_s", 600.0)
    numbers = all(isinstance(x, int | float) and not isinstance(x, bool) for x in (days, step))
    if numbers and step > 0 and not 1.0 <= days * DAY / step <= 1e5:
        faults.append(
            f"tracking.step_s = {step}: {days * DAY / step:.6g} steps in {days:g} days; "
            "allowed 1 to 100000"
        )
    return faults
