"""How satellites of one launch come to their planes: waiting against delta-v."""

from dataclasses import dataclass, field
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.api.given import joined_designs
from compass.api.results import Result
from compass.arguments import checked
from compass.coverage.room import has_slots
from compass.design import Design
from compass.document import Page, Sentence, Table, Value, Verdict
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY
from compass.orbits.deployment import WEIGHED, Deployment, deploy_by_drift
from compass.quantities import quantity
from compass.words import counted

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Waiting orbits that the table shows.
SHOWN = 10


@dataclass(frozen=True, repr=False)
class DeployResult(Result):
    """Waiting times and delta-v of the planes of one launch.

    Attributes
    ----------
    design
        What is deployed.
    deployment
        What was found, SI.
    longest_wait_days
        Allowed.
    """

    design: Design = field(repr=False)
    deployment: Deployment
    longest_wait_days: float

    @property
    def chosen(self) -> int | None:
        """Place of the cheapest waiting orbit that is quick enough."""
        return self.deployment.cheapest(self.longest_wait_days * SECONDS_PER_DAY)

    @property
    def holds(self) -> bool:
        """Whether waiting reaches every plane in time."""
        return self.chosen is not None

    @property
    def altitudes_km(self) -> Any:
        """Altitudes of the waiting orbits."""
        return (self.deployment.radii - self.design.figure.equatorial_radius) / 1e3

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        deployment, k = self.deployment, self.chosen
        return plain(
            {
                "design": self.design.name,
                "launches": deployment.launches,
                "planes_a_launch": deployment.planes_a_launch,
                "longest_wait_days": self.longest_wait_days,
                "delta_v_first_plane_m_s": deployment.transfer,
                "chosen": None if k is None else self._option(k),
                "planes": [
                    {
                        "node_deg": degrees(plane.node),
                        "direct_m_s": plane.direct,
                        "wait_days": None if k is None else plane.waits[k] / SECONDS_PER_DAY,
                        "waiting_m_s": None if k is None else deployment.delta_v[k],
                    }
                    for plane in deployment.planes
                ],
                "options": [self._option(j) for j in range(deployment.radii.size)],
            }
        )

    def _option(self, k: int) -> dict[str, float]:
        deployment = self.deployment
        return {
            "waiting_altitude_km": self.altitudes_km[k],
            "wait_days": deployment.waits[k] / SECONDS_PER_DAY,
            "delta_v_deploy_m_s": deployment.delta_v[k],
            "parting_deg_day": degrees(deployment.parting[k]) * SECONDS_PER_DAY,
        }

    def document(self) -> Page:
        """The cheapest way in time, plane by plane, then waiting against delta-v."""
        deployment, k = self.deployment, self.chosen
        names = ("waiting_altitude_km", "wait_days", "delta_v_deploy_m_s")
        wait, cost = quantity("wait_days"), quantity("delta_v_deploy_m_s")
        if k is None:
            longest = counted(self.longest_wait_days, "day")
            claim = f"no waiting orbit brings every plane in {longest}"
        else:
            known = self._option(k)
            shown = {name: Value(quantity(name), known[name]) for name in names}
            each = "each of " if deployment.launches > 1 else ""
            claim = (
                f"{counted(deployment.planes_a_launch, 'plane')} from {each}"
                f"{counted(deployment.launches, 'launch')}: waiting "
                f"at {shown['waiting_altitude_km']} km for up to {shown['wait_days']} days, "
                f"{shown['delta_v_deploy_m_s']} m/s a satellite"
            )
        rows = tuple(
            (
                f"{degrees(plane.node):.4g}",
                Value(wait, None if k is None else float(plane.waits[k]) / SECONDS_PER_DAY),
                Value(cost, None if k is None else float(deployment.delta_v[k])),
                Value(cost, plane.direct),
            )
            for plane in deployment.planes
        )
        header = ("node from the first, deg", wait.heading, f"{cost.heading}, waiting", "at once")
        pick = np.unique(np.linspace(0, deployment.radii.size - 1, SHOWN).astype(int))
        options = tuple(
            tuple(Value(quantity(name), self._option(j)[name]) for name in names) for j in pick
        )
        how = (
            "By first-order J2 rates of nodes, Hohmann transfers, satellites phased in their "
            "planes by the moment of the last one; the first plane costs "
            f"{deployment.transfer:.4g} m/s a satellite. Another launch or wait stands in a "
            "table [deployment]."
        )
        return Page(
            self.design.name,
            (
                Verdict("" if self.holds else "too slow", claim, self.holds),
                *([Table("Planes of one launch", header, rows)] if rows else []),
                Table(
                    "Waiting against delta-v", tuple(quantity(n).heading for n in names), options
                ),
                Sentence(how),
            ),
        )

    def plot(self, *, axes: "Axes | None" = None) -> "Axes":
        """Draw delta-v against the wait for the last plane, and what turning at once costs.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.style import CYCLE, MARS, axes_or_new

        drawn, deployment = axes_or_new(axes), self.deployment
        days = deployment.waits / SECONDS_PER_DAY
        drawn.plot(days, deployment.delta_v, color=MARS, label="waiting")
        if deployment.planes:
            worst = max(plane.direct for plane in deployment.planes)
            drawn.axhline(worst, color=CYCLE[0], label="turning the farthest plane at once")
        if (k := self.chosen) is not None:
            drawn.plot(days[k], deployment.delta_v[k], "o", color=MARS, label="cheapest in time")
        drawn.axvline(self.longest_wait_days, color="0.5", linewidth=0.8, linestyle=":")
        drawn.set_xlim(0.0, 2.0 * self.longest_wait_days)
        drawn.set(
            xlabel="days until the last plane is reached",
            ylabel="delta-v of one satellite, m/s",
            title=f"{self.design.name}: delta-v against waiting",
        )
        drawn.legend()
        return drawn


@checked
def deploy(
    design: Design | str | Path,
    *others: Design | str | Path,
    launch_altitude_km: float | None = None,
    longest_wait_days: float | None = None,
    satellites_a_launch: int | None = None,
) -> DeployResult:
    """Weigh waiting for planes, whose nodes the flattening of Mars turns apart, against delta-v.

    Parameters
    ----------
    design, *others
        A design of circular orbits of one radius and inclination, or the path of its file; several
        are one network, their satellites together.
    launch_altitude_km
        Of the circular orbit launched into; else the design's.
    longest_wait_days
        Until the last plane is reached; else the design's.
    satellites_a_launch
        At most; else the design's, or all.

    Raises
    ------
    ArgumentError, DesignError
        An option or the design is not allowed.

    Examples
    --------
    >>> import compass
    >>> found = compass.deploy("designs/compass-15-5-1.toml")
    >>> found.deployment.launches
    1
    """
    read = joined_designs((design, *others))
    c, known = read.constellation, read.launching
    if not has_slots(c):
        raise ArgumentError("deploy: needs circular orbits of one radius and inclination")
    sphere = read.figure.equatorial_radius
    launched = known.launched if launch_altitude_km is None else launch_altitude_km * 1e3
    days = known.longest_wait / SECONDS_PER_DAY if longest_wait_days is None else longest_wait_days
    each = satellites_a_launch or known.satellites_a_launch or c.size
    low, high = known.waiting
    deployment = deploy_by_drift(
        c, sphere + launched, sphere + np.linspace(low, high, WEIGHED), each
    )
    return DeployResult(read, deployment, days)
