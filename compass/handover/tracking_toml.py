"""The table ``[tracking]`` of a design, written so that reading it gives the same one back."""

from compass.handover.decimals import decimal, number
from compass.inputs.toml_values import toml_text
from compass.inputs.tracking import DAY
from compass.tracking import Tracker, Tracking

_PLAIN = Tracking(earth=Tracker(range=1.0))


def tracking_lines(tracking: Tracking) -> list[str]:
    """Lines of a table ``[tracking]``."""
    t = tracking
    lines = [
        "[tracking]",
        f"days = {decimal(t.duration / DAY, lambda x: x * DAY, t.duration)}",
        f"step_s = {number(t.step)}",
        f"prior_m = {number(t.prior)}",
        f"prior_mm_s = {_thousandths(t.prior_speed)}",
        f"prior_clock_m = {number(t.prior_clock)}",
        f"process_noise_m2_s3 = {number(t.process_noise)}",
    ]
    for key, name in (("radiation_sigma", "radiation"), ("gravity_sigmas", "gravity")):
        if getattr(t, name) != getattr(_PLAIN, name):
            lines.append(f"{key} = {number(getattr(t, name))}")
    if t.considered != _PLAIN.considered:
        lines.append(f"considered = {toml_text(t.considered)}")
    for name in t.kinds:
        lines.append(f"{name} = {_tracker(getattr(t, name))}")
    return lines


def _tracker(tracker: Tracker) -> str:
    told: list[str] = []
    if tracker.range is not None:
        told.append(f"range_m = {number(tracker.range)}")
    if tracker.doppler is not None:
        told.append(f"doppler_mm_s = {_thousandths(tracker.doppler)}")
    if tracker.time is not None:
        told.append(f"time_m = {number(tracker.time)}")
    for name in ("bias", "time_bias", "position"):
        if getattr(tracker, name):
            told.append(f"{name}_m = {number(getattr(tracker, name))}")
    if tracker.one_way:
        told.append("one_way = true")
    if tracker.schedule != "all":
        told.append(f"schedule = {toml_text(tracker.schedule)}")
    return "{ " + ", ".join(told) + " }"


def _thousandths(value: float) -> str:
    return decimal(value * 1e3, lambda x: x / 1e3, value)
