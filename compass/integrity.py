"""What a user is promised: how rarely an error may exceed what he is told, after which faults."""

from dataclasses import dataclass

from compass.errors import ArgumentError


@dataclass(frozen=True)
class Integrity:
    """The table ``[integrity]`` of a design: the risk that is allowed, and how it is shared out.

    Attributes
    ----------
    hazard
        Probability allowed that an error exceeds its protection level without an alarm, P_HMI.
    fault
        Probability that a satellite is faulty, each, P_sat.
    alarm
        Probability allowed of a false alarm, P_FA.
    horizontal
        Share of `hazard` and `alarm` that is horizontal, half of it each for east and north.
    bias
        Largest error of a range without a fault that is no noise, m.
    alert_horizontal, alert_vertical
        Protection levels that the user can still use, m.
    """

    hazard: float = 1e-7
    fault: float = 1e-5
    alarm: float = 1e-5
    horizontal: float = 0.5
    bias: float = 0.0
    alert_horizontal: float = 50.0
    alert_vertical: float = 50.0

    def __post_init__(self) -> None:
        """Refuse what no probability can be, and faults of two satellites that use all of it up."""
        for name in ("hazard", "fault", "alarm", "horizontal"):
            if not 0.0 < getattr(self, name) < 1.0:
                raise ArgumentError(f"{name} = {getattr(self, name):g}: allowed above 0, below 1")
        if not 0.0 <= self.bias < 1e6:
            raise ArgumentError(f"bias_m = {self.bias:g}: must be 0 or more")
        if not (self.alert_horizontal > 0 and self.alert_vertical > 0):
            raise ArgumentError("alert_horizontal_m, alert_vertical_m: must be above 0")
        if self.unmonitored(5) >= 0.5 * self.hazard:
            raise ArgumentError(
                f"p_sat = {self.fault:g}: two of five satellites fail at once with "
                f"{self.unmonitored(5):.2g}, more than half of p_hmi = {self.hazard:g}, and only "
                "single faults are watched for; lower p_sat, or allow more"
            )

    def unmonitored(self, satellites: int) -> float:
        """Probability that two or more of so many satellites are faulty: nothing watches for it.

        ``1 - (1 - p)^n - n p (1 - p)^(n - 1)``.
        """
        p, n = self.fault, satellites
        # by its series: the difference of numbers near one would have no digits
        term, total = 0.5 * n * (n - 1) * p * p * (1.0 - p) ** (n - 2), 0.0
        for k in range(2, n + 1):
            total += term
            term *= (n - k) / (k + 1) * p / (1.0 - p)
        return total
