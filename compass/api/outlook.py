"""How long a design lasts on real orbits, which radius lasts longer, and what keeping costs.

Other commands say each of these; here they are asked for together, as a page wants them, within a
bound on the work, and kept on disk.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import ceil
from typing import Any

import numpy as np

from compass.api.drift import drift
from compass.api.keep import keep
from compass.api.promises import promise_dict
from compass.api.radii import RESONANT, RadiusLasts, at_radii, forces_of, real_motion
from compass.coverage.certificate import Outcome
from compass.coverage.fold_verdict_over_days import followed_as_caps
from compass.coverage.lasting import Lasting, prove_span
from compass.coverage.promises import Promise, promises_of
from compass.coverage.room import has_slots
from compass.design import Design
from compass.document import Answer
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.frames import SECONDS_PER_DAY
from compass.kept import kept
from compass.orbits.trajectory import Trajectory
from compass.orbits.trimming import beat_of
from compass.words import capital, days_words, place_words

#: A Mars year, days: how far a page looks ahead, and the look before that.
HORIZON, GLANCE = 687.0, 40.0

#: Days of all satellites that are followed at most, and satellites of a sweep or of keeping.
SATELLITE_DAYS, MOST_SATELLITES = 15 * HORIZON, 40

#: The same of satellites that are followed by boxes of place and time: seconds a day, not less.
BOXED_DAYS = 15 * 7.0

#: Other radii that are tried, km from the design's: the second pair where the first does not last.
STEPS = ((-400.0, 400.0), (-800.0, 800.0))


@dataclass(frozen=True)
class SlotHistory:
    """What `compass.drift` finds over the days.

    Attributes
    ----------
    days
        After the epoch, (t,).
    margin_deg, room_deg
        Of the caps, and in the slots, (t,); no room without slots.
    satellites
        Their names, (n,).
    in_track_deg, cross_track_deg
        Places in the slots, (t, n); None without slots.
    slot_sideways_deg
        How far a slot reaches across; None without slots.
    """

    days: list[float]
    margin_deg: list[float]
    room_deg: list[float] | None
    satellites: list[str]
    in_track_deg: list[list[float]] | None
    cross_track_deg: list[list[float]] | None
    slot_sideways_deg: float | None


@dataclass(frozen=True)
class KeptSatellite:
    """What keeping one satellite takes: burns, days between two, worst places, propellant."""

    name: str
    delta_v_m_s_year: float
    burns: int
    days_between_burns: float | None
    worst_in_track_deg: float
    worst_cross_track_deg: float
    propellant_kg: float


@dataclass(frozen=True)
class KeepingCost:
    """What keeping costs, as `compass.keep` finds it; `holds` where all stay in their slots."""

    years: float
    box_deg: float
    holds: bool
    delta_v_mean_m_s_year: float
    specific_impulse_s: float
    dry_mass_kg: float
    per_satellite: tuple[KeptSatellite, ...]

    @classmethod
    def of(cls, known: Mapping[str, Any]) -> "KeepingCost":
        """Take what is needed of what `compass.keep` gives as JSON."""
        rows = tuple(KeptSatellite(**_some(KeptSatellite, row)) for row in known["per_satellite"])
        return cls(**{**_some(cls, known), "per_satellite": rows})


def _some(kind: type, known: Mapping[str, Any]) -> dict[str, Any]:
    """Of known values those that a class has fields for."""
    return {field.name: known[field.name] for field in fields(kind)}


@dataclass(frozen=True)
class Outlook:
    """A design's future.

    Attributes
    ----------
    asked, motion
        What was asked of it, in words, and under what motion.
    requirements
        What becomes of each of its requirements, as `compass.drift` lists it.
    horizon_days
        How far was looked.
    outcome, days_proven, first_loss_days, loss
        The claim over the horizon; where it is lost, in words.
    drift
        What becomes of margin and slots; None where the fold does not hold at the epoch.
    radius_km
        Of the design, if its orbits have one semi-major axis.
    radii
        How long the pattern lasts at other radii.
    keeping
        What keeping costs.
    notes
        What was not looked at, and why.
    known
        Whether it was kept from an earlier run.
    sure
        How sure the claim is: ``proven``, or ``sampled`` where samples alone tell of a part.
    """

    asked: str
    motion: str
    requirements: tuple[dict[str, Any], ...]
    horizon_days: float
    outcome: str
    days_proven: float
    first_loss_days: float | None
    loss: str
    drift: SlotHistory | None
    radius_km: float | None
    radii: tuple[RadiusLasts, ...]
    keeping: KeepingCost | None
    notes: tuple[str, ...]
    known: bool
    sure: str = "proven"

    @property
    def lasts(self) -> bool:
        """Whether it is proven for the whole horizon."""
        return self.outcome == Outcome.PROVEN.value

    @property
    def lasting_radii(self) -> tuple[RadiusLasts, ...]:
        """Other radii at which it is proven for the whole horizon."""
        return tuple(r for r in self.radii if r.days_proven >= self.horizon_days)


def outlook(design: Design) -> Outlook:
    """Find out what becomes of a design, or recall it.

    Looked at: what it requires, or its fold everywhere, over `HORIZON` days from the epoch, less
    for many satellites; if that is not proven for all of it, other radii of
    `STEPS`, trimmed, and a year of station-keeping.

    Parameters
    ----------
    design
        The design.
    """
    bounds = (HORIZON, GLANCE, STEPS, SATELLITE_DAYS, BOXED_DAYS)
    flown = (design.constellation, design.motion, design.figure, design.upkeep)
    question = ("outlook", *bounds, *flown, design.fold, design.mask, design.requirements)
    found, known = kept(question, lambda: _look(design))
    radii = tuple(RadiusLasts(**row) for row in found.pop("radii"))
    notes, rows = tuple(found.pop("notes")), tuple(found.pop("requirements"))
    history, cost = found.pop("drift"), found.pop("keeping")
    return Outlook(
        **found,
        notes=notes,
        requirements=rows,
        radii=radii,
        drift=None if history is None else SlotHistory(**history),
        keeping=None if cost is None else KeepingCost.of(cost),
        known=known,
    )


def left_words(design: Design) -> str:
    """How the satellites fly where nobody corrects them, to go on with "it lasts"."""
    return "left alone on real orbits" if design.motion.table is None else "on its given paths"


def lasts_words(design: Design, days: float) -> str:
    """Days that are proven to the end of what was looked at, and whether its paths end there."""
    table = design.motion.table
    ends = table is not None and days * SECONDS_PER_DAY >= table.stop
    return days_words(days) + (", all they are given for" if ends else " and more")


@dataclass(frozen=True)
class Glance:
    """How long a design left alone keeps what is asked of it, as far as a glance goes.

    Attributes
    ----------
    design
        The design.
    days_proven, looked_days
        For how long it is proven, of how long was looked at.
    lost
        Where it is lost, in words; empty where it is not.
    first_loss_days
        Day by which it is lost; None where it is not.
    sure
        As of `Outlook`.
    """

    design: Design
    days_proven: float
    looked_days: float
    lost: str
    first_loss_days: float | None = None
    sure: str = "proven"

    @property
    def words(self) -> str:
        """The days that are proven, as `compass.words.days_words`; of none why."""
        if self.days_proven >= self.looked_days:
            return lasts_words(self.design, self.looked_days)
        if self.days_proven == 0.0:
            return f"no time: at the epoch {self.lost}" if self.lost else "no time that is proven"
        return days_words(self.days_proven)

    @property
    def sentence(self) -> str:
        """How long it lasts, in a sentence."""
        return f"{capital(left_words(self.design))} it lasts {self.words}."

    def answer(self, name: str = "") -> Answer:
        """The same as one of the first lines of a page, with the command that proves it.

        `name` is the design's, where several stand in a page.
        """
        who = f"“{name}”" if name else "it"
        days = min(self.looked_days, days_to_see(self.days_proven, self.first_loss_days))
        proven = f"{self.sure}: compass drift {self.design.typed} --days {days:g}"
        return Answer(f"{capital(left_words(self.design))} {who} lasts", self.words, None, proven)


def days_to_see(proven: float, lost: float | None) -> int:
    """Days to ask for, so that what is proven and the loss are seen: of a share in its stretch."""
    return max(ceil(proven) + 1, ceil(lost or 0.0))


def glance(design: Design) -> Glance:
    """Find out, or recall, how long a design lasts left alone, `GLANCE` days ahead at most."""
    horizon = min(GLANCE, _horizon(design))
    flown = (design.constellation, design.motion, design.figure)
    question = ("glance", horizon, *flown, design.fold, design.mask, design.requirements)

    def look() -> dict[str, Any]:
        claim = _claim(design, horizon)
        lasts = claim.outcome is Outcome.PROVEN
        return {
            "days_proven": horizon if lasts else claim.days_proven,
            "looked_days": horizon,
            "lost": claim.loss,
            "first_loss_days": claim.first_loss_days,
            "sure": claim.sure,
        }

    return Glance(design, **kept(question, look)[0])


def commands(design: Design, found: Outlook) -> dict[str, str]:
    """The command lines that prove what is said: ``lasts``, ``radii``, ``keeping``."""
    name = design.typed
    radii = ",".join(f"{r.radius_km:g}" for r in found.lasting_radii or found.radii)
    until = found.horizon_days
    if not found.lasts:
        until = days_to_see(found.days_proven, found.first_loss_days)
    return {
        "lasts": f"compass drift {name} --days {until:g}",
        "radii": f"compass drift {name} --days {found.horizon_days:g} --radius-km {radii}",
        "keeping": f"compass keep {name}",
    }


def _look(design: Design) -> dict[str, Any]:
    c = design.constellation
    one_axis = bool(c.size) and np.ptp(c.semi_major_axis) <= 1e-9 * c.semi_major_axis[0]
    motion, notes = real_motion(design), []
    horizon = _horizon(design)
    if horizon < HORIZON:
        notes.append(f"looked {horizon:.4g} days ahead, which is as far as was affordable or known")
    claim = _claim(design, horizon)
    lost = claim.outcome is not Outcome.PROVEN
    over_time, keeping = None, None
    radii: tuple[RadiusLasts, ...] = ()
    if claim.days_proven > 0.0:
        end = min(horizon, max(1.25 * claim.days_proven, 1.0)) if lost else horizon
        over_time = _over_time(design, end)
    if lost and over_time is not None:
        if motion.forces is None or c.size > MOST_SATELLITES:
            notes.append(
                "other radii and station-keeping are looked at for up to "
                f"{MOST_SATELLITES} satellites under forces"
            )
        else:
            if one_axis:
                radii = _other_radii(design, horizon)
            else:
                notes.append("other radii: the orbits have several, for which no one stands")
            if not has_slots(c):
                notes.append(
                    "keeping: orbits that are oval, or of several radii or inclinations, form no "
                    "slots, so that no box follows from a margin; what a box costs says compass "
                    f"keep {design.typed} --box-deg DEGREES"
                )
            else:
                try:
                    keeping = keep(design).to_dict()
                except ArgumentError as error:
                    notes.append(f"keeping: {error}")
    found = {
        "motion": motion.title,
        "horizon_days": horizon,
        **vars(claim),
        "drift": over_time,
        "radius_km": float(c.semi_major_axis[0]) / 1e3 if one_axis else None,
        "radii": [r.as_dict() for r in radii],
        "keeping": keeping,
        "notes": notes,
    }
    result: dict[str, Any] = plain(found)
    return result


def _horizon(design: Design) -> float:
    """How many days can be looked ahead: what is affordable, and known."""
    table = real_motion(design).table
    known = np.inf if table is None else table.stop / SECONDS_PER_DAY
    always = [each for each in design.requirements if each.counts and each.share == 1.0]
    as_caps = all(followed_as_caps(design, each) for each in always)
    most = SATELLITE_DAYS if as_caps else BOXED_DAYS
    return float(min(HORIZON, most / max(design.constellation.size, 1), known))


@dataclass(frozen=True)
class Settled:
    """What is asked of a design and how long that is kept: fields of `Outlook`."""

    asked: str
    outcome: Outcome
    days_proven: float
    first_loss_days: float | None
    loss: str
    requirements: tuple[dict[str, Any], ...] = ()
    sure: str = "proven"


def _claim(design: Design, horizon: float) -> Settled:
    """Settle what is asked of a design over a glance and, if it held, over the horizon."""
    motion = real_motion(design)
    for days in sorted({min(GLANCE, horizon), horizon}):
        stop = days * SECONDS_PER_DAY
        path = motion.trajectory(design.constellation, 0.0, stop)
        found = _required(design, path, stop) or _everywhere(design, path, stop)
        if found.outcome is not Outcome.PROVEN:
            break
    return found


def _everywhere(design: Design, path: Trajectory, stop: float) -> Settled:
    """Its fold everywhere."""
    mask = design.mask.highest
    lasting = prove_span(
        path,
        design.fold,
        sphere_radius=design.figure.equatorial_radius,
        stretch=design.figure.stretch,
        mask=mask,
        start=0.0,
        stop=stop,
    )
    return Settled(
        f"{design.fold} or more satellites above {np.degrees(mask):g} deg everywhere",
        lasting.outcome,
        lasting.days_proven,
        lasting.first_loss_days,
        _place(lasting),
    )


def _required(design: Design, path: Trajectory, stop: float) -> Settled | None:
    """Its requirements, the one that is lost first before the others; None if none is settled.

    An always of which samples alone tell, and see no miss, is open for ever and says nothing.
    """
    promises = promises_of(design, path, 0.0, stop)
    known = [
        each
        for each in promises
        if each.outcome is not Outcome.UNDECIDED or each.evidence != "sampled"
    ]
    if not known:
        return None
    first = min(known, key=lambda one: one.decides.proven_until)
    outcomes = {each.outcome for each in known}
    order = (Outcome.REFUTED, Outcome.UNDECIDED, Outcome.PROVEN)
    asked = (
        "all that is required"
        if len(known) == len(promises) > 1
        else (f"what is required: {'; '.join(each.requirement.claim for each in known)}")
    )
    return Settled(
        asked,
        next(outcome for outcome in order if outcome in outcomes),
        first.decides.days_proven,
        first.first_loss_days,
        _loss_of(first),
        tuple(promise_dict(each) for each in promises),
        "sampled" if any(each.evidence == "sampled" for each in known) else "proven",
    )


def _loss_of(promise: Promise) -> str:
    """What a requirement loses first, in words; empty if it does not."""
    if promise.first_loss_days is None:
        return ""
    name, lasting = promise.requirement.name, promise.lasting
    if lasting is not None and promise.decides is lasting:
        return f"{_place(lasting)} ({name})"
    return f"“{name}” misses {promise.requirement.wanted} at {promise.place}"


def _over_time(design: Design, days: float) -> dict[str, Any]:
    """Margin, room and places in the slots over the days."""
    result = drift(design, days=days)
    found = result.drift
    room, box = found.room, found.box
    return {
        "days": found.times / SECONDS_PER_DAY,
        "margin_deg": np.degrees(found.least[:, 0]),
        "room_deg": None if room is None else np.degrees(room.room),
        "satellites": list(design.constellation.satellite_names),
        "in_track_deg": None if room is None else np.degrees(room.along),
        "cross_track_deg": None if room is None else np.degrees(room.across),
        "slot_sideways_deg": None if box is None else float(np.degrees(box.sideways)),
    }


def _other_radii(design: Design, horizon: float) -> tuple[RadiusLasts, ...]:
    """How long the pattern lasts, trimmed, at its own radius if it can be trimmed, and others."""
    c = design.constellation
    own = float(c.semi_major_axis[0]) / 1e3
    # an oval orbit's lowest point is nearer than its axis says
    lowest = design.figure.equatorial_radius / 1e3 / (1.0 - float(c.eccentricity.max()))
    found: tuple[RadiusLasts, ...] = ()
    beat = beat_of(c, forces_of(real_motion(design), "radii").field).period
    tried = [(0.0,)] if beat < RESONANT * SECONDS_PER_DAY else []
    for steps in (*tried, *STEPS):
        radii = [own + step for step in steps if own + step > lowest]
        found += at_radii(design, radii, days=horizon)
        if any(r.days_proven >= horizon for r in found):
            break
    return tuple(sorted(found, key=lambda r: r.radius_km))


def _place(lasting: Lasting) -> str:
    """Where coverage is lost first, in words; empty if it is not."""
    w = lasting.witness
    if w is None:
        return ""
    place = place_words(float(np.degrees(w.latitude)), float(np.degrees(w.longitude)), ".2f")
    return f"{w.fold} in view at {place}"
