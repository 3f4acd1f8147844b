"""Who tracks a constellation's satellites, and how well: the table ``[tracking]`` of a design."""

from dataclasses import dataclass, replace
from typing import Any, Literal

from compass.errors import ArgumentError

Schedule = Literal["all", "in-turn"]

Considered = Literal["schmidt", "blind"]

#: The kinds of trackers, in order.
TRACKERS = ("earth", "stations", "moons", "crosslinks")

#: What of a determination is drawn: sigma by tracking, by component, who is measured when.
PICTURES = ("tracking", "components", "schedule")


@dataclass(frozen=True)
class Tracker:
    """One kind of tracking; every sigma is of one sigma, None where nothing of it is measured.

    Attributes
    ----------
    range
        Noise of one range a step, m, one way.
    doppler
        Noise of a range rate over a minute, m/s; longer counts average it.
    time
        Noise of one comparison of clocks a step, m.
    bias
        Constant error of all ranges of one tracker, m; considered, not estimated.
    time_bias
        Constant error of a tracker's time, m; considered.
    position
        Constant error of each coordinate of a tracker, m; considered.
    one_way
        Whether ranges hold the satellite's clock.
    schedule
        ``all`` satellites in view at every step, or one after the other ``in-turn``.
    """

    range: float | None = None
    doppler: float | None = None
    time: float | None = None
    bias: float = 0.0
    time_bias: float = 0.0
    position: float = 0.0
    one_way: bool = False
    schedule: Schedule = "all"

    def __post_init__(self) -> None:
        """Refuse what measures nothing, and negative sigmas."""
        measured = [x for x in (self.range, self.doppler, self.time) if x is not None]
        if not measured:
            raise ArgumentError("measures nothing; give one of range_m, doppler_mm_s, time_m")
        if not all(0.0 < x < 1e9 for x in measured):
            raise ArgumentError("range_m, doppler_mm_s, time_m: must be above 0")
        if not all(0.0 <= x < 1e9 for x in (self.bias, self.time_bias, self.position)):
            raise ArgumentError("bias_m, time_bias_m, position_m: must be 0 or more")
        if self.schedule not in ("all", "in-turn"):
            raise ArgumentError(f"schedule = {self.schedule!r}: allowed all, in-turn")


def titled(kind: str) -> str:
    """A kind of tracker as people write it."""
    return "Earth" if kind == "earth" else kind


@dataclass(frozen=True)
class Tracking:
    """The tracking of a constellation, over an arc from the epoch.

    Attributes
    ----------
    earth
        Three complexes, eight hours each, two-way.
    stations
        The design's stations.
    moons
        Stations on Phobos and Deimos.
    crosslinks
        Between all satellites that see each other.
    duration
        Of the arc, s.
    step
        Between measurements, s.
    prior, prior_speed, prior_clock
        What is known of each coordinate and clock before, one sigma: m, m/s, m.
    considered
        How constant errors of trackers are considered: ``schmidt``, the gain knows their sigmas;
        ``blind``, ignored by the gain, but present.
    process_noise
        Density of the acceleration that no model has, m^2/s^3, each axis.
    radiation
        What is known before of each satellite's scale of sunlight's push, one sigma, relative; it
        is estimated. 0: known.
    gravity
        Errors of the field of gravity in formal sigmas of the built-in one, considered. 0: known.
    """

    earth: Tracker | None = None
    stations: Tracker | None = None
    moons: Tracker | None = None
    crosslinks: Tracker | None = None
    duration: float = 86400.0
    step: float = 600.0
    prior: float = 1000.0
    prior_speed: float = 0.1
    prior_clock: float = 1000.0
    process_noise: float = 3.6e-15
    radiation: float = 0.1
    gravity: float = 10.0
    considered: Considered = "schmidt"

    def __post_init__(self) -> None:
        """Refuse arcs without a step and priors without a width."""
        if not any(getattr(self, name) for name in TRACKERS):
            raise ArgumentError(f"nobody tracks; give one of {', '.join(TRACKERS)}")
        if not 0.0 < self.step <= self.duration <= 1000.0 * 86400.0:
            raise ArgumentError(
                f"step_s = {self.step:g}: must be above 0, at most the arc, {self.duration:g} s; "
                "the arc at most 1000 days"
            )
        if self.duration / self.step > 1e5:
            raise ArgumentError(
                f"step_s = {self.step:g}: {self.duration / self.step:.0f} steps; allowed 100000"
            )
        for name in ("prior", "prior_speed", "prior_clock"):
            if not 0.0 < getattr(self, name) < 1e9:
                raise ArgumentError(f"{name} = {getattr(self, name):g}: must be above 0")
        if self.considered not in ("schmidt", "blind"):
            raise ArgumentError(f"considered = {self.considered!r}: allowed schmidt, blind")
        if not 0.0 <= self.process_noise < 1.0:
            raise ArgumentError(f"process_noise = {self.process_noise:g}: must be 0 or more")
        for name in ("radiation", "gravity"):
            if not 0.0 <= getattr(self, name) < 1e9:
                raise ArgumentError(f"{name} = {getattr(self, name):g}: must be 0 or more")

    def only(self, *names: str) -> "Tracking | None":
        """Return the tracking by some kinds alone; None if none of them is there."""
        left: dict[str, Any] = {
            name: getattr(self, name) if name in names else None for name in TRACKERS
        }
        return replace(self, **left) if any(left.values()) else None

    @property
    def kinds(self) -> tuple[str, ...]:
        """Names of the kinds that are there."""
        return tuple(name for name in TRACKERS if getattr(self, name) is not None)

    @property
    def titles(self) -> list[str]:
        """The same as people write them."""
        return [titled(name) for name in self.kinds]

    @property
    def measures_clocks(self) -> bool:
        """Whether anything compares the satellites' clocks with a clock on the ground."""
        trackers = (getattr(self, name) for name in self.kinds if name != "crosslinks")
        return any(each.time is not None or each.one_way for each in trackers)
