"""Where a user is who stands still, with however few satellites: how well, and after how long."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from compass.api.given import given_in_metres, given_site
from compass.api.results import Result
from compass.arguments import checked
from compass.clocks import clock_named
from compass.design import Design
from compass.document import Page, Sentence, Table, Value, Verdict
from compass.document.plain import plain
from compass.errors import ArgumentError, meant
from compass.frames import HOUR, SECONDS_PER_DAY
from compass.quantities import quantity
from compass.signal.standing import SIDEWAYS, UPWARDS, sights_from, standing_covariance
from compass.sites import Site
from compass.words import counted

if TYPE_CHECKING:
    from matplotlib.axes import Axes


#: How well the errors are known.
EVIDENCE = (
    "covariance of linearised least squares at the epochs looked at, no sample of errors; in view: "
    "at these epochs"
)

#: Most epochs of one look.
MOST_EPOCHS = 20_000


@dataclass(frozen=True)
class Standing:
    """One way to stand: with or without a known height and a clock that is held.

    Attributes
    ----------
    clock_held, height_known
        Which.
    sigma
        East, north and up after every epoch, m, shape (t, 3).
    until
        Hours until the place is known to the goal and stays so; None if it never is.
    """

    clock_held: bool
    height_known: bool
    sigma: NDArray[np.float64]
    until: float | None

    @property
    def title(self) -> str:
        """In words."""
        clock = "clock held" if self.clock_held else "clock free"
        return f"{clock}, height {'known' if self.height_known else 'unknown'}"

    @property
    def position(self) -> NDArray[np.float64]:
        """Root of the three variances together, m, shape (t,)."""
        return np.asarray(np.linalg.norm(self.sigma, axis=1))


@dataclass(frozen=True, repr=False)
class LocateResult(Result):
    """How well a user who stands still knows his place, over time, in four ways to stand.

    Attributes
    ----------
    design
        Whose satellites, those that are used.
    site
        Where.
    hours
        After the begin, shape (t,).
    seen
        Satellites in view, shape (t,).
    ways
        With and without a held clock and a known height.
    goal_m, height_m, doppler_m_s, clock
        What was asked: goal, sigma of a known height and of Doppler, name of the held clock.
    """

    design: Design = field(repr=False)
    site: Site
    hours: NDArray[np.float64]
    seen: NDArray[np.int64]
    ways: tuple[Standing, ...]
    goal_m: float
    height_m: float
    doppler_m_s: float
    clock: str

    @property
    def best(self) -> Standing:
        """With a held clock and a known height."""
        return self.ways[0]

    @property
    def holds(self) -> bool:
        """Whether the place is known to the goal with a held clock and a known height."""
        return self.best.until is not None

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON; lists over the hours."""
        return plain(
            {
                "design": self.design.name,
                "satellites": list(self.design.constellation.satellite_names),
                "site": self.site.name,
                "goal_m": self.goal_m,
                "height_m": self.height_m,
                "doppler_m_s": self.doppler_m_s,
                "clock": self.clock,
                "hours": self.hours,
                "evidence": EVIDENCE,
                "in_view": self.seen,
                "ways": [
                    {
                        "clock_held": way.clock_held,
                        "height_known": way.height_known,
                        "until_goal_h": way.until,
                        "east_m": way.sigma[:, 0],
                        "north_m": way.sigma[:, 1],
                        "up_m": way.sigma[:, 2],
                        "standing_error_m": way.position,
                    }
                    for way in self.ways
                ],
            }
        )

    def document(self) -> Page:
        """After how long the goal is met, and the error after some times, for each way to stand."""
        error, until = quantity("standing_error_m"), quantity("until_goal_h")
        n, held = self.design.constellation.size, self.best.until
        known = (
            f"not known to {self.goal_m:g} m within {self.hours[-1]:.4g} h"
            if held is None
            else f"known to {self.goal_m:g} m after {Value(until, held)} h"
        )
        few, many = self.seen.min(), self.seen.max()
        in_view = f"{few}" if few == many else f"{few} to {many}"
        claim = (
            f"{self.site.name}, standing still, {counted(n, 'satellite')}, {in_view} in view at "
            f"once: place {known}, clock held and height known"
        )
        if not many:
            claim += "; nothing is ever measured: no satellite rises above the horizon meanwhile"
        shown = [k for k in (10 / 60, 1.0, 3.0) if k < self.hours[-1]] + [float(self.hours[-1])]
        at = [int(np.searchsorted(self.hours, hour - 1e-9)) for hour in shown]
        header = (
            "",
            f"to {self.goal_m:g} m after, h",
            *(f"after {hour:.3g} h, m" for hour in shown),
        )
        rows = tuple(
            (
                way.title,
                Value(until, way.until),
                *(Value(error, float(way.position[k])) for k in at),
            )
            for way in self.ways
        )
        how = (
            "one sigma of the place in space, from ranges and Doppler "
            f"({self.doppler_m_s * 1e3:g} mm/s) one after another; errors of orbits and clocks, of "
            "the table [signal], stay as they are meanwhile, the ionosphere is left out; before, "
            f"the place is known to {SIDEWAYS / 1e3:g} km and its height to {UPWARDS / 1e3:g} km "
            f"or, where known, to {self.height_m:g} m; a held clock ({self.clock}) has an unknown "
            "offset and rate and wanders as it does, a free one is another at every epoch, to "
            "3 ms and 1e-6"
        )
        return Page(
            self.design.name,
            (
                Verdict("known" if self.holds else "not known", claim, self.holds),
                Table("Error of the place", header, rows),
                Sentence(how),
            ),
        )

    def plot(self, *, axes: "Axes | None" = None) -> "Axes":
        """Draw the error of the place over time for each way to stand.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.style import axes_or_new

        drawn = axes_or_new(axes)
        for way in self.ways:
            drawn.semilogy(self.hours, way.position, label=way.title)
        drawn.axhline(self.goal_m, color="0.5", linewidth=0.8, linestyle=":")
        drawn.set(
            xlabel="hours of standing still",
            ylabel=quantity("standing_error_m").heading,
            title=f"{self.design.name}, {self.site.name}",
        )
        drawn.legend()
        return drawn


@checked
def locate(
    design: Design | str | Path,
    *,
    site: Site | str,
    satellites: Sequence[str] = (),
    hours: float = 6.0,
    step_s: float = 60.0,
    start_day: float = 0.0,
    goal_m: float = 10.0,
    height_m: float = 10.0,
    doppler_m_s: float = 0.001,
    clock: str = "uso",
) -> LocateResult:
    """How well a user who stands still knows his place, with however few satellites, over time.

    Parameters
    ----------
    design
        A design with a table ``[signal]``, or the path of its file.
    site
        A station of the design by its name, ``NAME=LAT,LON[,MASK]`` in degrees, or a `Site`.
    satellites
        Names of those that are there already; all if left out.
    hours, step_s, start_day
        How long, at which step, from which day after the epoch on.
    goal_m
        One sigma of the place that is wanted.
    height_m
        One sigma of the height where it is known.
    doppler_m_s
        One sigma of a range rate.
    clock
        Name of the user's clock where it is held.

    Raises
    ------
    ArgumentError, DesignError
        An option or the design is not allowed.

    Examples
    --------
    >>> import compass
    >>> found = compass.locate(
    ...     "designs/tracked-15-5-1.toml", site="rover=18.4,77.5", satellites=["P1S1"], hours=2
    ... )
    >>> [way.title for way in found.ways][0]
    'clock held, height known'
    """
    read = given_in_metres(design)
    if read.signal is None:
        raise ArgumentError(
            f"{read.label}: has no table [signal], which says how well orbits and clocks are known;"
            " add one (compass determine writes it)"
        )
    count = hours * HOUR / step_s
    if not 1 <= count <= MOST_EPOCHS:
        raise ArgumentError(
            f"hours = {hours:g}, step_s = {step_s:g}: must make 1 to {MOST_EPOCHS} steps"
        )
    held = clock_named(clock)
    place, used = _place(site, read), _with(satellites, read)
    since = step_s * np.arange(int(count) + 1, dtype=np.float64)
    sights = sights_from(used, place, start_day * SECONDS_PER_DAY + since, doppler_m_s)
    ways = []
    for oscillator in (held, None):
        for height in (height_m, None):
            covariance = standing_covariance(used, sights, oscillator, height)
            sigma = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
            until = _until(np.linalg.norm(sigma, axis=1), since / HOUR, goal_m)
            ways.append(Standing(oscillator is not None, height is not None, sigma, until))
    return LocateResult(
        design=used,
        site=place,
        hours=since / HOUR,
        seen=sights.seen,
        ways=tuple(ways),
        goal_m=goal_m,
        height_m=height_m,
        doppler_m_s=doppler_m_s,
        clock=clock,
    )


def _until(error: NDArray[np.float64], hours: NDArray[np.float64], goal: float) -> float | None:
    """Hours after which the error stays within the goal; None if it is not at the end."""
    outside = np.flatnonzero(error > goal)
    first = 0 if outside.size == 0 else int(outside[-1]) + 1
    return float(hours[first]) if first < hours.size else None


def _place(site: Site | str, design: Design) -> Site:
    """A site, the station of a name, or the place of ``NAME=LAT,LON[,MASK]`` in degrees."""
    if isinstance(site, Site) or "=" in site:
        return given_site(site, design, "site")
    known = {station.name: station for station in design.stations}
    if site not in known:
        names = ", ".join(known) or "none"
        raise ArgumentError(
            f"site = {site!r}: is no station of the design, which has {names}; "
            f"{meant(site, known)}name one, or write NAME=LAT,LON in degrees"
        )
    return known[site]


def _with(names: Sequence[str], design: Design) -> Design:
    """The design with those satellites alone, and their covariances."""
    c = design.constellation
    unknown = [name for name in names if name not in c.satellite_names]
    if unknown:
        raise ArgumentError(
            f"satellites = {unknown[0]!r}: is none of the design; "
            f"{meant(unknown[0], c.satellite_names)}it has "
            f"{', '.join(c.satellite_names)}"
        )
    if not names:
        return design
    return design.with_satellites([c.satellite_names.index(name) for name in names])
