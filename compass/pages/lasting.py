"""The section "How long it lasts" of a design's page, and what of it belongs in the first lines."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from compass.api.outlook import KeepingCost, Outlook, commands, lasts_words, left_words
from compass.api.promises import promise_table
from compass.api.radii import RadiusLasts
from compass.design import Design
from compass.document import Answer, Picture, Sampled, Sentence, Table, Value, Verdict
from compass.document.blocks import Block, Section
from compass.frames import SECONDS_PER_DAY
from compass.orbits import areosynchronous_radius
from compass.pictures.style import (
    CYCLE,
    FAINT,
    HALF,
    INK,
    MARS,
    look,
    new_figure,
    picture,
)
from compass.quantities import quantity
from compass.words import capital, days_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TITLE = "How long it lasts"
DAYS_PER_YEAR = 365.25

#: Growth of the largest step between moments that may be a leap to another fit, degrees.
LEAP = 2.0


def lasting_verdicts(design: Design, outlook: Outlook) -> tuple[Verdict, ...]:
    """How long it lasts left alone, what keeping costs, which radius does not need it.

    Each with the command that proves it.
    """
    said = [_lasts(design, outlook)]
    if outlook.keeping is not None:
        said.append(_keeping(design, outlook, outlook.keeping))
    if outlook.radii:
        said.append(_radius(design, outlook))
    return tuple(said)


def lasting_answers(design: Design, outlook: Outlook) -> list[Answer]:
    """The same as rows of the first lines: question, answer, how sure."""
    shown = commands(design, outlook)
    left = f"{capital(left_words(design))} it lasts"
    proven = f"{outlook.sure}: {shown['lasts']}"
    if outlook.lasts:
        rows = [Answer(left, lasts_words(design, outlook.horizon_days), None, proven)]
    elif outlook.days_proven == 0.0:
        rows = [Answer(left, f"no time: at the epoch {outlook.loss}", None, proven)]
    else:
        rows = [Answer(left, days_words(outlook.days_proven), None, proven)]
    if outlook.keeping is not None:
        mean = Value(quantity("delta_v_keeping_m_s_year"), outlook.keeping.delta_v_mean_m_s_year)
        years = f"simulated over {_years(outlook.keeping)}"
        cost = f"{mean} m/s a year a satellite"
        question = "To keep every satellite in its slot costs"
        rows.append(Answer(question, cost, None, f"{years}: {shown['keeping']}"))
    for r in outlook.lasting_radii[:1]:
        years = f"{outlook.horizon_days / DAYS_PER_YEAR:.1f} years"
        where = f"{r.radius_km:g} km, {_shift(outlook, r)}, for {years}"
        rows.append(Answer("It keeps itself at", where, None, f"proven: {shown['radii']}"))
    return rows


def lasting_sentence(design: Design, outlook: Outlook) -> str:
    """How long it has what is asked of it, in a sentence."""
    row = lasting_answers(design, outlook)[0]
    return f"{row.question} {row.written}."


def lasting_advice(design: Design, outlook: Outlook) -> str:
    """What to do about orbits that do not last, in a sentence; empty for those that do."""
    if outlook.lasts or outlook.days_proven == 0.0:
        return ""
    lost = f"it loses that after {days_words(outlook.days_proven)}"
    ways = []
    if good := outlook.lasting_radii:
        ways.append(f"fly it {_shift(outlook, good[0])}, where it keeps itself once trimmed")
    if outlook.keeping is not None:
        ways.append(
            "keep every satellite in its slot for "
            f"{outlook.keeping.delta_v_mean_m_s_year:.3g} m/s a year each"
        )
    remedy = ", or ".join(ways) or "renew its orbits before"
    return f"{capital(left_words(design))} {lost}: {remedy}."


def lasting_section(design: Design, outlook: Outlook | None) -> Section | None:
    """Margin and room over time, places in the slots, other radii, the keeping budget."""
    if outlook is None:
        return None
    blocks: list[Block] = [*lasting_verdicts(design, outlook), Sentence(_how(outlook))]
    if outlook.requirements:
        blocks.append(promise_table(outlook.requirements))
    if outlook.drift is not None:
        blocks.append(_margin_picture(outlook))
        if outlook.drift.in_track_deg is not None:
            blocks.append(_slot_picture(outlook))
    if outlook.radii:
        blocks += [_radius_picture(outlook), _radius_table(outlook)]
    if outlook.keeping is not None:
        blocks.append(_keeping_table(outlook.keeping))
    return Section(TITLE, tuple(blocks))


def _lasts(design: Design, outlook: Outlook) -> Verdict:
    command, left = commands(design, outlook)["lasts"], left_words(design)
    if outlook.lasts:
        years = outlook.horizon_days / DAYS_PER_YEAR
        long = f" ({years:.1f} years)" if years >= 1.0 else ""
        return Verdict(
            f"Lasts {lasts_words(design, outlook.horizon_days)}",
            f"{outlook.asked}, {outlook.sure} {left} for the "
            f"{days_words(outlook.horizon_days)} looked at{long} ({command})",
            True,
        )
    if outlook.first_loss_days is not None and outlook.days_proven * SECONDS_PER_DAY < 1.0:
        return Verdict(
            "Does not hold at the epoch", f"{outlook.asked}: {outlook.loss} ({command})", False
        )
    proven = Value(quantity("days_proven"), outlook.days_proven)
    if outlook.first_loss_days is None:
        word, end = f"Lasts at least {days_words(outlook.days_proven)}", "undecided after that"
    else:
        word = f"Lasts {days_words(outlook.days_proven)}"
        when = Value(quantity("first_loss_days"), outlook.first_loss_days)
        end = f"lost on day {when}: {outlook.loss}"
    return Verdict(
        word, f"{outlook.asked}, {outlook.sure} {left} for {proven} days, {end} ({command})", False
    )


def _keeping(design: Design, outlook: Outlook, kept: KeepingCost) -> Verdict:
    cost = quantity("delta_v_keeping_m_s_year")
    each = [row.delta_v_m_s_year for row in kept.per_satellite]
    low, high, mean = (Value(cost, v) for v in (min(each), max(each), float(np.mean(each))))
    stays = "every satellite stays in its slot" if kept.holds else "some leave their slots"
    return Verdict(
        f"Keeping it costs {mean} m/s a year a satellite",
        f"{low} to {high} by slot; {stays}, simulated over {_years(kept)} "
        f"({commands(design, outlook)['keeping']})",
        bool(kept.holds),
    )


def _radius(design: Design, outlook: Outlook) -> Verdict:
    command = commands(design, outlook)["radii"]
    good = outlook.lasting_radii
    if not good:
        best = max(outlook.radii, key=lambda r: r.days_proven)
        return Verdict(
            "No radius tried does without keeping",
            f"the best, {best.radius_km:g} km, is proven for {best.days_proven:.4g} days "
            f"({command})",
            False,
        )
    years = outlook.horizon_days / DAYS_PER_YEAR
    where = [f"{_shift(outlook, r)} ({r.radius_km:g} km)" for r in good]
    return Verdict(
        f"{_shift(outlook, good[0]).capitalize()} it keeps itself for {years:.1f} years",
        f"{' or '.join(where)}, trimmed once, the same pattern is proven for the "
        f"{outlook.horizon_days:g} days looked at with no burn, its margin never below "
        f"{min(r.margin_deg for r in good):.3g} deg at the moments looked at ({command})",
        True,
    )


def _shift(outlook: Outlook, radius: RadiusLasts) -> str:
    assert outlook.radius_km is not None
    shift = radius.radius_km - outlook.radius_km
    if abs(shift) < 1e-6:
        return "at its own radius"
    return f"{abs(shift):g} km {'higher' if shift > 0 else 'lower'}"


def _how(outlook: Outlook) -> str:
    return "; ".join((outlook.motion, *outlook.notes)) + "."


def _years(kept: KeepingCost) -> str:
    count = f"{kept.years:.3g}"
    return f"{count} year" if count == "1" else f"{count} years"


def _margin_picture(outlook: Outlook) -> Picture:
    assert outlook.drift is not None
    history = outlook.drift
    days, margin, room = history.days, history.margin_deg, history.room_deg
    what = "Margin" if room is None else "Margin and room"
    with look():
        figure = new_figure(*HALF)
        axes = figure.add_subplot()
        axes.plot(days, margin, color=MARS, lw=1.8, label="margin of the caps, proven")
        lowest = min(0.0, *margin)
        if room is not None:
            axes.plot(days, room, color=CYCLE[0], lw=1.4, label="room in slots")
        axes.axhline(0.0, color=INK, lw=0.8)
        if outlook.first_loss_days is not None:
            axes.axvline(outlook.first_loss_days, color=INK, lw=0.8, ls=":")
            axes.annotate(
                f"lost on day {outlook.first_loss_days:.1f}",
                (outlook.first_loss_days, max(margin)),
                (-4, 0),
                textcoords="offset points",
                ha="right",
                va="top",
            )
        axes.set(xlabel="days after the epoch", ylabel="degrees", xlim=(0, days[-1]))
        axes.set_ylim(bottom=max(lowest - 1.0, -10.0))
        axes.set_title(f"{what} over time")
        axes.legend(frameon=False, loc="lower left")
    return picture(
        figure,
        "lasting-margin",
        f"{what} over time",
        "By how much all caps could shrink with what is wanted kept"
        + (
            "."
            if room is None
            else ", and by how much every satellite could still stray from its slot: enough, not "
            "needed."
        ),
    )


def _slot_picture(outlook: Outlook) -> Picture:
    drift = outlook.drift
    assert drift is not None
    along, across = np.array(drift.in_track_deg), np.array(drift.cross_track_deg)
    last = until_leap(along, across)
    along, across = along[: last + 1], across[: last + 1]
    with look():
        figure = new_figure(*HALF)
        axes = figure.add_subplot()
        for s, name in enumerate(drift.satellites):
            colour = CYCLE[s % len(CYCLE)]
            axes.plot(along[:, s], across[:, s], color=colour, lw=1.0, alpha=0.9, label=name)
            axes.plot(along[-1, s], across[-1, s], "o", ms=4, color=colour)
            if len(drift.satellites) <= 30:
                figure.names.append(
                    axes.annotate(name, (along[-1, s], across[-1, s]), (3, 3), fontsize=8,
                                  textcoords="offset points", color=colour)
                )  # fmt: skip
        _slot_rim(axes, drift.slot_sideways_deg)
        axes.set(xlabel="ahead of the slot, deg", ylabel="beside the slot, deg")
        axes.set_title("Where satellites go in their slots")
    return picture(
        figure,
        "lasting-slots",
        "Drift in the slots",
        f"From the epoch to day {drift.days[last]:.4g} (dots), the pattern turned and advanced "
        "as a whole where it fits best; the grey oval is how far one satellite may leave its slot."
        + ("" if last == len(drift.days) - 1 else " Later on it fits best elsewhere."),
    )


def until_leap(along: NDArray[np.float64], across: NDArray[np.float64]) -> int:
    """Last moment before the best fit of a pattern leaps, of places in degrees, shape (t, n).

    Far out of their slots satellites fit two turns of the pattern alike. Drifts grow as the time
    squared at most, so that steps grow by twice the first at most; a leap is more than thrice as
    much as they ever grew by.
    """
    steps = np.hypot(np.diff(along, axis=0), np.diff(across, axis=0)).max(axis=1, initial=0.0)
    growth = np.diff(steps, prepend=0.0)
    before = np.maximum.accumulate(growth)[:-1]
    leaps = np.flatnonzero((growth[1:] > LEAP) & (growth[1:] > 3.0 * before))
    return int(leaps[0]) + 1 if leaps.size else len(along) - 1


def _slot_rim(axes: "Axes", sideways: float | None) -> None:
    turn = np.linspace(0, 2 * np.pi, 181)
    if sideways is not None and sideways > 0.0:
        axes.fill(sideways * np.cos(turn), sideways * np.sin(turn), color=FAINT, alpha=0.25, lw=0)


def _radius_picture(outlook: Outlook) -> Picture:
    with look():
        figure = new_figure(*HALF)
        axes = figure.add_subplot()
        for r in outlook.radii:
            good = r.days_proven >= outlook.horizon_days
            said = f"{r.days_proven:.4g} d" + (" or more" if good else "")
            _bar(axes, r.radius_km, r.days_proven, CYCLE[2] if good else FAINT, said)
        assert outlook.radius_km is not None
        said = f"as designed {outlook.days_proven:.4g} d"
        _bar(axes, outlook.radius_km, outlook.days_proven, MARS, said)
        axes.axhline(outlook.horizon_days, color=INK, lw=0.8, ls=":")
        radii = [outlook.radius_km, *(r.radius_km for r in outlook.radii)]
        axes.set_xlim(min(radii) - 150, max(radii) + 150)
        pace = areosynchronous_radius() / 1e3
        if min(radii) <= pace <= max(radii):
            axes.axvline(pace, color=INK, lw=0.8, ls="--", zorder=0)
            axes.annotate(
                "keeps pace with Mars",
                (pace, 0.5 * outlook.horizon_days),
                (5, 0),
                textcoords="offset points",
            )
        axes.set_ylim(0, 1.15 * outlook.horizon_days)
        axes.set(xlabel="radius, km", ylabel="days proven, left alone")
        axes.set_title("Lifetime against radius")
    return picture(
        figure,
        "lasting-radius",
        "Lifetime against radius",
        "Days for which the fold is proven with no burn: the design as it is, and the same pattern "
        "at other radii after one trim; the dotted line is how far was looked.",
    )


def _bar(axes: "Axes", radius_km: float, days: float, colour: str, said: str) -> None:
    axes.bar(radius_km, days, width=9.0, color=colour)
    axes.annotate(said, (radius_km, days), (0, 3), textcoords="offset points", ha="center")


def _radius_table(outlook: Outlook) -> Table:
    proven, margin = quantity("days_proven"), quantity("cap_margin_deg")
    sampled = Sampled(how="at moments of the span")
    rows = tuple(
        (
            f"{r.radius_km:g}",
            Value(proven, r.days_proven),
            "not in the span" if r.first_loss_days is None else f"{r.first_loss_days:.4f}",
            Value(margin, r.margin_deg, sampled),
            f"{r.beat_days:.4g}",
        )
        for r in outlook.radii
    )
    header = ("radius, km", proven.heading, "lost on day", margin.heading, "beat with Mars, days")
    return Table("The same pattern at other radii, trimmed once, left alone", header, rows)


def _keeping_table(kept: KeepingCost) -> Table:
    cost, mass = quantity("delta_v_keeping_m_s_year"), quantity("propellant_kg")
    rows = tuple(
        (
            row.name,
            Value(cost, row.delta_v_m_s_year),
            row.burns,
            "" if row.days_between_burns is None else f"{row.days_between_burns:.3g}",
            f"{row.worst_in_track_deg:.3g}",
            f"{row.worst_cross_track_deg:.3g}",
            Value(mass, row.propellant_kg),
        )
        for row in kept.per_satellite
    )
    header = (
        "satellite", cost.heading, "burns", "days between", "worst along, deg",
        "worst across, deg", mass.heading,
    )  # fmt: skip
    return Table(
        f"Keeping budget over {_years(kept)}, box of {kept.box_deg:.3g} deg along "
        f"the track, {kept.dry_mass_kg:g} kg dry, {kept.specific_impulse_s:g} s",
        header,
        rows,
    )
