"""What goes wrong with beacons and subsystems, when, and by how much."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from compass.errors import ArgumentError

FaultKind = Literal["outage", "bias", "spike", "all-ranges-lost", "subsystem-dead"]


@dataclass(frozen=True)
class Fault:
    """One fault.

    Attributes
    ----------
    kind
        ``outage``: the beacon's range does not arrive; ``bias``: it arrives wrong by `size`,
        silently; ``spike``: wrong by `size` at the epoch `start` alone; ``all-ranges-lost``: no
        range arrives; ``subsystem-dead``: the beacon's local filter gives no estimate (a
        centralised filter has no such subsystem and goes on).
    beacon
        Name of the beacon; empty for ``all-ranges-lost``.
    start, end
        Seconds; the fault holds for ``start <= t <= end``.
    size
        Metres, for ``bias`` and ``spike``.
    """

    kind: FaultKind
    beacon: str = ""
    start: float = 0.0
    end: float = float("inf")
    size: float = 0.0

    def __post_init__(self) -> None:
        if self.kind not in get_args(FaultKind):
            allowed = ", ".join(get_args(FaultKind))
            raise ArgumentError(f"fault: kind = {self.kind!r}: allowed {allowed}")
        if not (isfinite(self.start) and self.start <= self.end):
            raise ArgumentError(
                f"fault: from {self.start} s to {self.end} s: the end must not be before the start"
            )
        if not isfinite(self.size):
            raise ArgumentError(f"fault: size = {self.size} m: must be a finite number")
        if self.kind in ("bias", "spike") and self.size == 0.0:
            raise ArgumentError(f"fault: a {self.kind} needs a size in metres other than 0")


@dataclass(frozen=True)
class FaultTables:
    """Faults over epochs and beacons, shape (epoch, beacon).

    Attributes
    ----------
    lost
        The range does not arrive.
    offset
        Error added to it, metres.
    alive
        The beacon's subsystem works.
    """

    lost: NDArray[np.bool_]
    offset: NDArray[np.float64]
    alive: NDArray[np.bool_]


def fault_tables(
    faults: Sequence[Fault], times: NDArray[np.float64], beacon_names: Sequence[str]
) -> FaultTables:
    """Lay a schedule of faults over epochs (s) and beacons.

    Raises
    ------
    ArgumentError
        A fault of a beacon that does not exist, or that falls outside the epochs.
    """
    shape = (times.size, len(beacon_names))
    tables = FaultTables(np.zeros(shape, bool), np.zeros(shape), np.ones(shape, bool))
    for fault in faults:
        during = (times >= fault.start) & (times <= fault.end)
        if fault.kind == "spike":
            during = np.zeros(times.size, bool)
            nearest = int(np.argmin(np.abs(times - fault.start)))
            during[nearest] = times[0] <= fault.start <= times[-1]
        if not during.any():
            raise ArgumentError(
                f"fault: {fault.kind} from {fault.start:g} s to {fault.end:g} s: the entry lasts "
                f"from {times[0]:g} s to {times[-1]:g} s; choose times inside"
            )
        if fault.kind == "all-ranges-lost":
            tables.lost[during] = True
            continue
        if fault.beacon not in beacon_names:
            raise ArgumentError(
                f"fault: beacon = {fault.beacon!r}: allowed {', '.join(beacon_names)}"
            )
        column = list(beacon_names).index(fault.beacon)
        if fault.kind == "outage":
            tables.lost[during, column] = True
        elif fault.kind == "subsystem-dead":
            tables.alive[during, column] = False
        else:
            tables.offset[during, column] += fault.size
    return tables
