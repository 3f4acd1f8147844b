"""Who tracks a design's satellites, and how well their orbits and clocks are known for it."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.api.given import given_design
from compass.api.progress import bar
from compass.api.results import Result
from compass.arguments import checked
from compass.conventions import dated, epoch_text
from compass.design import Design
from compass.digest import digest_of
from compass.document import Page, Sentence, Table, Value, Verdict
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.frames import HOUR, SECONDS_PER_DAY
from compass.handover.signal_toml import text_with_signal
from compass.handover.toml import design_toml
from compass.inputs import read_design_text
from compass.orbits.motion import MotionModel
from compass.quantities import quantity
from compass.ranging import MAS, Signal
from compass.saving import replacing
from compass.signal.determination import (
    Determination,
    check_clocks_measured,
    determine_orbits,
    implied_signal,
)
from compass.signal.links import NEAREST
from compass.signal.unknown_forces import DEGREE, forces_of
from compass.tracking import PICTURES, Tracking, titled
from compass.words import counted, listed

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

COMPONENTS = ("radial", "along", "cross", "clock")

#: How well the sigmas are known.
EVIDENCE = (
    "covariance of linearised least squares, no sample: exact for the errors that are modelled, "
    "and silent on those that are not"
)


#: By what share less tracking must know more for it to be said.
NOTED = 0.01


@dataclass(frozen=True, repr=False)
class DetermineResult(Result):
    """How well every satellite's orbit and clock are known, and what each kind of tracking buys.

    Attributes
    ----------
    design
        Whose satellites.
    motion
        On which motion.
    determination
        Covariances along the arc and the prediction.
    by_tracking
        The same with one kind of tracking left out, and with one kind alone.
    signal
        What users' ranges are worth for it.
    radiation
        Reflectivity times area over mass on which sunlight pushes, m^2/kg.
    """

    design: Design = field(repr=False)
    motion: str
    determination: Determination = field(repr=False)
    by_tracking: dict[str, Determination] = field(repr=False)
    signal: Signal = field(repr=False)
    radiation: float = 0.0

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        whole, last = self.determination, self.determination.last
        return plain(
            {
                "design": self.design.name,
                "motion": self.motion,
                "days": whole.arc / 86400.0,
                "tracking": list(whole.tracking.kinds),
                "measurements": whole.counts,
                "tracked_share": {
                    kind: tracked.mean(axis=1).tolist() for kind, tracked in whole.tracked.items()
                },
                "considered": whole.tracking.considered,
                "evidence": EVIDENCE,
                **self._numbers(whole.rms[last]),
                "common_orientation_mas": (whole.orientation / MAS).tolist(),
                "common_time_m": whole.common_time,
                "predicted": {
                    "hours": (float(whole.times[-1]) - whole.arc) / HOUR,
                    **self._numbers(whole.rms[-1]),
                },
                "by_tracking": {
                    name: self._numbers(each.rms[each.last], each.tracking)
                    for name, each in self.by_tracking.items()
                },
                "per_satellite": [
                    {"name": name, **self._numbers(whole.sigma[last, s])}
                    for s, name in enumerate(self.design.constellation.satellite_names)
                ],
                "time_h": (whole.times / HOUR).tolist(),
                "rms_m": {
                    name: whole.rms[:, k].tolist()
                    for k, name in enumerate(COMPONENTS)
                    if k < 3 or self.clock_known
                },
                "signal": {
                    "covariance_m2": [list(row) for row in self.signal.covariance[0]],
                    "ephemeris_rate_m_h": [rate * HOUR for rate in self.signal.ephemeris_rate],
                    "update_h": self.signal.update / HOUR,
                },
            }
        )

    @property
    def clock_known(self) -> bool:
        """Whether anything measures the satellites' clocks."""
        return self.determination.tracking.measures_clocks

    def _numbers(self, sigma: Any, tracking: Tracking | None = None) -> dict[str, float | None]:
        """Sigmas by name; none of clocks that nothing measures."""
        sigmas: dict[str, float | None] = {
            f"{name}_sigma_m": float(sigma[k]) for k, name in enumerate(COMPONENTS)
        }
        told = (tracking or self.determination.tracking).measures_clocks
        return sigmas if told else sigmas | {"clock_sigma_m": None}

    def document(self) -> Page:
        """The sigmas in a sentence, what each tracking buys, satellite by satellite."""
        whole, known = (
            self.determination,
            self._numbers(self.determination.rms[self.determination.last]),
        )
        told = ", ".join(
            f"{name} {Value(quantity(f'{name}_sigma_m'), known[f'{name}_sigma_m'])} m"
            for name in COMPONENTS
            if known[f"{name}_sigma_m"] is not None
        )
        whom = listed(whole.tracking.titles)
        claim = f"after {_days(whole.arc)} of tracking by {whom}: {told}"
        header = ("", *(f"{quantity(f'{name}_sigma_m').title}, m" for name in COMPONENTS))
        names = self.design.constellation.satellite_names
        each = tuple(
            (name, *self._cells(whole.sigma[whole.last, s])) for s, name in enumerate(names)
        )
        bought = tuple(
            (name, *self._cells(run.rms[run.last], run.tracking))
            for name, run in {"all of it": whole, **self.by_tracking}.items()
        )
        hours = (float(whole.times[-1]) - whole.arc) / HOUR
        ahead = ((f"{hours:g} h later, not tracked", *self._cells(whole.rms[-1])),)
        return Page(
            self.design.name,
            (
                Verdict("", claim),
                Table(
                    "What each kind of tracking buys: rms over satellites at the arc's end",
                    header,
                    bought + (ahead if hours else ()),
                ),
                Table("Satellite by satellite, at the arc's end", header, each),
                self._schedule_table(),
                *(Sentence(note) for note in self.notes()),
            ),
        )

    def _schedule_table(self) -> Table:
        """Who measures for how much of the arc."""
        share = quantity("tracked_share")
        rows = []
        for kind, tracked in self.determination.tracked.items():
            each = tracked.mean(axis=1)
            values = (float(each.min()), float(each.mean()), float(each.max()))
            rows.append(
                (
                    titled(kind),
                    str(self.determination.counts[kind]),
                    *(Value(share, value) for value in values),
                )
            )
        epochs = {tracked.shape[1] for tracked in self.determination.tracked.values()}
        title = (
            f"Who measures when: a satellite's share of the arc's {max(epochs, default=0)} epochs"
        )
        header = ("", "measurements", *(f"{share.heading}, {w}" for w in ("least", "mean", "most")))
        return Table(title, header, tuple(rows))

    def _cells(self, sigma: Any, tracking: Tracking | None = None) -> tuple[Value, ...]:
        numbers = self._numbers(sigma, tracking)
        return tuple(Value(quantity(name), value) for name, value in numbers.items())

    def notes(self) -> tuple[str, ...]:
        """What the numbers stand on, and what they leave out."""
        whole, t = self.determination, self.determination.tracking
        kept = ", ".join(f"{count} by {titled(kind)}" for kind, count in whole.counts.items())
        turn = ", ".join(f"{x:.3g}" for x in whole.orientation / MAS)
        sense = {
            "schmidt": "considered, the gain knows their sigmas (Schmidt)",
            "blind": "considered, the gain ignores them (the classical consider batch)",
        }[t.considered]
        notes = [
            f"one sigma; arc of {_days(whole.arc)} in steps of {t.step:g} s, {kept} "
            f"measurements; before it {t.prior:g} m and {t.prior_speed * 1e3:g} mm/s in each "
            f"coordinate; process noise {t.process_noise:g} m^2/s^3; trackers' constant errors are "
            f"{sense}",
            f"{self.motion}; errors grow by the gradient of a point, J2 and C22",
            f"common to all satellites at the end: a turn of {turn} mas about x, y, z; the "
            "covariances hold it",
            _forces(t, self.radiation),
            *self._nearest(),
            *self._worse(),
            "left out: errors of Mars's orientation and of the planets' places, the media, "
            f"manoeuvres, the field beyond degree {DEGREE}"
            + ("" if t.earth is None or t.earth.position else ", places of stations on the Earth"),
        ]
        if not self.clock_known:
            notes.append("nothing measures the clocks: add time_m, or one_way stations")
        return tuple(notes)

    def _nearest(self) -> tuple[str, ...]:
        """Which satellites are not linked, where any are."""
        if self.determination.tracking.crosslinks is None:
            return ()
        return (f"satellites nearer to each other than {NEAREST / 1e3:g} km are not linked",)

    def _worse(self) -> tuple[str, ...]:
        """Why less tracking knows more, where it does: gains correct nothing that is considered."""
        whole = self.determination
        better = [
            f"{COMPONENTS[k]} {name}"
            for name, run in self.by_tracking.items()
            for k in range(4 if run.tracking.measures_clocks and self.clock_known else 3)
            if run.tracking.kinds != whole.tracking.kinds
            and run.rms[run.last, k] < (1.0 - NOTED) * whole.rms[whole.last, k]
        ]
        if not better:
            return ()
        return (
            f"better known with less tracking: {listed(better)}; errors of trackers and of the "
            "field are considered and never corrected, so that further measurements bring theirs "
            "into the rest: a determination that estimated them would lose nothing by more data",
        )

    def design_text(self) -> str:
        """Return the design's file with the table ``[signal]`` that this tracking implies."""
        meant = replace(self.design, signal=self.signal)
        text = text_with_signal(self.design.text, self.signal) if self.design.text else ""
        if text and digest_of(read_design_text(text, self.design.label)) == digest_of(meant):
            return text
        return design_toml(meant)

    def write(self, path: str | Path) -> None:
        """Write `design_text`.

        Raises
        ------
        ArgumentError
            Nothing measures the clocks, so that no signal follows.
        OutputError
            The file cannot be written.
        """
        check_clocks_measured(self.determination.tracking)
        text = self.design_text()
        with replacing(Path(path)) as temporary:
            temporary.write_text(text, encoding="utf-8")

    def plot(self, *, name: str = "tracking", axes: "Axes | None" = None) -> "Axes":
        """Draw sigmas over time, or who tracks whom when.

        Parameters
        ----------
        name
            ``tracking``: the position's sigma with all tracking and without each kind;
            ``components``: radial, along, cross and clock, the mean and span over satellites;
            ``schedule``: whom each kind of tracker measures when.
        axes
            Where to; new ones without.

        Raises
        ------
        ArgumentError
            Another name.
        """
        from compass.pictures.determine import draw_components, draw_schedule, draw_sigmas

        if name == "components":
            return draw_components(axes, self.design.name, self.determination, self.clock_known)
        if name == "schedule":
            c = self.design.constellation
            return draw_schedule(axes, self.design.name, self.determination, c.satellite_names)
        if name != "tracking":
            raise ArgumentError(f"name = {name!r}: allowed {', '.join(PICTURES)}")
        return draw_sigmas(axes, self.design.name, self.determination, self.by_tracking)

    @property
    def dataset(self) -> "xr.Dataset":
        """One sigma of every satellite's orbit and clock over time, as CF lays it out."""
        import xarray as xr

        dims, sigma = ("satellite", "time"), np.moveaxis(self.determination.sigma, 0, -1)
        known = COMPONENTS if self.clock_known else COMPONENTS[:3]
        kinds, epochs = self.determination.tracked, self.determination.times.size
        on = np.zeros((len(kinds), len(sigma), epochs), np.int8)
        for k, tracked in enumerate(kinds.values()):
            on[k, :, : tracked.shape[1]] = tracked
        made = xr.Dataset(
            {
                "tracked": (
                    ("tracker", *dims),
                    on,
                    {"units": "1", "long_name": "whether the tracker measures the satellite"},
                )
            }
            | {
                (name := f"{component}_sigma_m"): (
                    dims,
                    sigma[:, k],
                    quantity(name).attributes(),
                )
                for k, component in enumerate(known)
            },
            {
                "tracker": list(kinds),
                "satellite": list(self.design.constellation.satellite_names),
                "time": ("time", self.determination.times, {"units": "s", "long_name": "time"}),
            },
            {"title": self.design.name, "motion": self.motion}
            | {"epoch_tdb": epoch_text(self.design.constellation.epoch)},
        )
        return dated(made)

    def save_plot(self, path: str | Path, name: str = "tracking") -> None:
        """Write `plot` as a PNG file; a killed run leaves no partial one."""
        from compass.pictures.files import save_axes

        save_axes(self.plot(name=name), path)


def _fewer(tracking: Tracking) -> dict[str, Tracking]:
    """The same tracking without each of its kinds, and by each alone; nothing of one kind."""
    kinds, fewer = tracking.kinds, {}
    for name in kinds if len(kinds) > 1 else ():
        left = tracking.only(*(kind for kind in kinds if kind != name))
        alone = tracking.only(name)
        assert left is not None
        assert alone is not None
        fewer[f"without {titled(name)}"] = left
        if len(kinds) > 2:
            fewer[f"{titled(name)} alone"] = alone
    return fewer


def _if_known(tracking: Tracking) -> dict[str, Tracking]:
    """The same tracking with one source of error gone, for each that is there."""
    easier = {}
    if tracking.gravity:
        easier["were gravity known"] = replace(tracking, gravity=0.0)
    if tracking.radiation:
        easier["were sunlight's push known"] = replace(tracking, radiation=0.0)
    exact = {
        name: replace(getattr(tracking, name), bias=0.0, time_bias=0.0, position=0.0)
        for name in tracking.kinds
    }
    if any(each != getattr(tracking, name) for name, each in exact.items()):
        easier["were trackers without bias"] = replace(tracking, **exact)
    return easier


def _forces(tracking: Tracking, radiation: float) -> str:
    """How well the forces are known, in words."""
    push = f"sunlight's push on {radiation:g} m^2/kg"
    told = (
        f"{push} is estimated a satellite, known before to {100 * tracking.radiation:.3g} %"
        if tracking.radiation
        else f"{push} counts as known"
    )
    return told + (
        f"; GM and the field to degree {DEGREE} are considered, off by {tracking.gravity:g} of "
        "their formal sigmas (DE440, GMM-3)"
        if tracking.gravity
        else "; gravity counts as known"
    )


def _days(seconds: float) -> str:
    """A time in days, in words."""
    return counted(seconds / SECONDS_PER_DAY, "day")


@checked
def determine(
    design: Design | str | Path,
    *,
    days: float | None = None,
    update_h: float | None = None,
    motion: MotionModel | None = None,
    progress: bool = False,
) -> DetermineResult:
    """How well the satellites' orbits and clocks are known, by whom they are tracked.

    Parameters
    ----------
    design
        A design with a table ``[tracking]``, or the path of its file.
    days
        Arc from the epoch; else the design's.
    update_h
        Hours between uploads to users: how long orbits are predicted; else those of the design's
        signal, or 6 without one.
    motion
        ``two-body``, ``j2`` or ``numerical``; else the design's.
    progress
        Show a bar on stderr.

    Raises
    ------
    ArgumentError, DesignError
        Nobody tracks, or the design is not allowed.

    Examples
    --------
    >>> import compass
    >>> found = compass.determine("designs/tracked-15-5-1.toml", days=0.25)
    >>> bool(found.determination.rms[found.determination.last, 0] < 100)
    True
    """
    read = given_design(design)
    if update_h is None:
        update_h = 6.0 if read.signal is None else read.signal.update / HOUR
    tracking = read.tracking
    if tracking is not None and days is not None:
        tracking = replace(tracking, duration=days * 86400.0)
    moved = read.motion.or_of(motion)
    whole = determine_orbits(read, tracking, motion=moved, prediction=update_h * HOUR)
    compared, others = _fewer(whole.tracking) | _if_known(whole.tracking), {}
    with bar(progress, "determine", compared.items(), unit="set of trackers", leave=False) as sets:
        for name, by in sets:
            sets.set_postfix_str(name)
            others[name] = determine_orbits(read, by, motion=moved)
    signal = implied_signal(whole, read, update_h * HOUR)
    radiation = forces_of(moved).radiation
    return DetermineResult(read, moved.title, whole, others, signal, radiation)
