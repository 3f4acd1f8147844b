"""What is said of a flight and of one filter on it: sentences, tables, numbers."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.api.given import in_metres
from compass.document.blocks import Picture, Section, Table, arranged
from compass.document.evidence import Sampled
from compass.document.numbers import significant
from compass.entry.accuracy import Accuracy, Spread
from compass.entry.assess import Assessment, assess
from compass.entry.carried import CarriedFilter
from compass.entry.dispersed import Dispersed, beyond_words, fly_dispersed
from compass.entry.quantiles import share_bounds
from compass.entry.state import longitude_degrees
from compass.entry.trajectory import Trajectory, fly, loads
from compass.errors import ArgumentError
from compass.inputs.scenario import Scenario
from compass.signal.budget import basis, mean_age_covariance

KM = 1e3

#: How well what is drawn is known.
EVIDENCE = (
    "beside percentiles and shares of entries or runs drawn as _interval: bounds that hold that of "
    "all in 95 of 100 cases"
)

#: Filter runs that would take longer (s), or have more epochs in all, are refused.
MOST_SECONDS, MOST_STEPS = 3600.0, 100_000_000


#: Degrees that lines to satellites may turn from mid-flight on before it is said: an error along
#: them has changed by 1 - cos of it, 6 %, and what was across them counts with its sine.
MOST_TURN = 20.0


def assess_scenario(scenario: Scenario, runs: int | None = None) -> Assessment:
    """Fly a scenario's truth and assess its navigation; `runs` instead of the scenario's.

    Raises
    ------
    ArgumentError
        A flight that ends before its second time, or a beacon at the lander's place.
    """
    many = scenario.runs if runs is None else runs
    check_cost(scenario, many)
    planned = scenario.planned()
    flight = fly(planned.truth, scenario.state, scenario.times, triggers=scenario.triggers)
    if flight.times.size < 2:
        raise ArgumentError(f"{scenario.label}: {flight.ending}; nothing to navigate")
    return assess(
        planned.model,
        flight,
        scenario.beacons(flight.times),
        scenario.measurements,
        scenario.settings,
        deployment=scenario.deployment,
        satellites=satellite_errors(scenario),
        runs=many,
        seed=scenario.seed,
    )


def satellite_errors(scenario: Scenario) -> NDArray[np.float64] | None:
    """Covariance of each beacon's radial, along, cross and clock error, m^2, (n, 4, 4).

    As the [signal] of the beacons' design says, by its age of data; zeros of beacons of the
    scenario's own, and None where no design has that table.

    Raises
    ------
    ArgumentError
        Nothing measures the clocks of satellites whose errors tracking is to imply.
    """
    designs = [orbiters.design for orbiters in scenario.orbiters]
    if not any(design is not None and design.signal is not None for design in designs):
        return None
    found = [np.zeros((len(scenario.surface_names), 4, 4))]
    for orbiters, design in zip(scenario.orbiters, designs, strict=True):
        errors = np.zeros((orbiters.constellation.size, 4, 4))
        if design is not None and design.signal is not None:
            signal = in_metres(design).signal
            assert signal is not None
            errors = mean_age_covariance(signal, orbiters.constellation.size)
        found.append(errors)
    return np.concatenate(found)


def disperse_scenario(scenario: Scenario, found: Assessment) -> Dispersed | None:
    """Fly the entries of a scenario's [dispersion]; None if it has none.

    Guided ones know of themselves what the filter tells them that `found` was assessed with.

    Raises
    ------
    ArgumentError
        The planned entry does not come to deployment.
    """
    if scenario.dispersion is None:
        return None
    settings = found.settings or scenario.settings
    carried = CarriedFilter(
        found.flight, found.beacons, found.taken, scenario.measurements, settings
    )
    return fly_dispersed(
        scenario.truth,
        scenario.model,
        scenario.state,
        scenario.dispersion,
        float(scenario.times[-1]),
        trigger=scenario.deployment,
        guidance=scenario.guidance,
        carried=None if scenario.guidance is None else carried,
        seed=scenario.seed,
    )


def dispersed_sentence(found: Dispersed) -> str:
    """Where dispersed entries come down."""
    count, came = found.times.size, int(found.reached.sum())
    lost = f"; {count - came} do not come to it" if came < count else ""
    of = "the target" if found.guided else "where the planned one does"
    how = "guided " if found.guided else ""
    if came < 3:
        return f"Of {count} dispersed {how}entries {came} come to {found.event}."
    ellipse = found.ellipse
    half, most = (distance_words(found.within(share)) for share in (50.0, 95.0))
    (least, less), (more, greatest) = (
        map(distance_words, found.within_bounds(share)) for share in (50.0, 95.0)
    )
    return (
        f"Of {count} dispersed {how}entries half come to {found.event} within {half} of {of}, 95 % "
        f"within {most} (95 % ellipse {distance_words(ellipse.semi_major)} by "
        f"{distance_words(ellipse.semi_minor)}, half axes). Other draws would put half within "
        f"{least} to {less}, 95 % within {more} to {greatest}, in 95 of 100 cases{lost}."
        f"{_knowledge_words(found)}{beyond_words(found.beyond)}"
    )


def _knowledge_words(found: Dispersed) -> str:
    """What guidance knew, if that was not all."""
    if found.nees is None:
        return ""
    known = (
        f" They are guided by what the filter knows, which is {significant(found.knowledge, 3)} m "
        "off at last (rms)"
    )
    if found.claims_hold:
        return f"{known}."
    nees = significant(float(found.nees[found.reached].mean()), 3)
    return f"{known} and inconsistent: NEES {nees} where 6 is right."


def distance_words(metres: float) -> str:
    """A distance over the ground, in metres below a kilometre."""
    if not math.isfinite(metres):
        return "no distance"
    return f"{significant(metres, 3)} m" if metres < KM else f"{significant(metres / KM, 3)} km"


def dispersed_facts(found: Dispersed) -> dict[str, Any]:
    """Where dispersed entries come down, as plain values."""
    enough = int(found.reached.sum()) >= 3
    ellipse = found.ellipse if enough else None
    return {
        "at": found.event,
        "guided": found.guided,
        "entries": found.times.size,
        "reached": int(found.reached.sum()),
        "within_m": {
            "p50": found.within(50.0),
            "p50_interval": found.within_bounds(50.0),
            "p95": found.within(95.0),
            "p95_interval": found.within_bounds(95.0),
        },
        "beyond_m": found.beyond,
        "reached_share": found.reached.mean(),
        "reached_share_interval": share_bounds(float(found.reached.mean()), found.times.size),
        "knowledge_rms_m": None if found.nees is None else found.knowledge,
        "nees": None if found.nees is None else found.nees[found.reached].mean(),
        "offsets_east_north_m": found.offsets,
        "ellipse": None
        if ellipse is None
        else {
            "east_m": ellipse.east,
            "north_m": ellipse.north,
            "semi_major_m": ellipse.semi_major,
            "semi_minor_m": ellipse.semi_minor,
            "azimuth_deg": np.degrees(ellipse.azimuth),
            "level": ellipse.level,
        },
    }


def check_cost(scenario: Scenario, runs: int) -> float:
    """Seconds that the filter runs will take, about; refused beyond `MOST_SECONDS`.

    Raises
    ------
    ArgumentError
        So many runs of so many epochs that they would take hours.
    """
    beacons = len(scenario.surface_names) + sum(o.constellation.size for o in scenario.orbiters)
    steps = runs * scenario.times.size
    seconds = steps * (2e-6 + 0.4e-6 * beacons)
    if seconds > MOST_SECONDS or steps > MOST_STEPS:
        raise ArgumentError(
            f"{scenario.label}: {runs} runs of {scenario.times.size} epochs past {beacons} beacons "
            f"would take about {seconds / 60:.0f} minutes and {steps * 80 / 1e9:.0f} GB of memory; "
            "give a longer entry.step_s or fewer runs"
        )
    return seconds


def entry_section(
    scenario: Scenario,
    found: Assessment,
    *,
    pictures: bool = True,
    claim: str | None = None,
    dispersed: Dispersed | None = None,
) -> Section:
    """Text, pictures and tables of one scenario, the answer first: `claim`, or that of `found`."""
    drawn: tuple[Picture, ...] = ()
    if pictures:
        from compass.pictures.entry import entry_pictures

        drawn = entry_pictures(found, dispersed)
    paragraphs = [" ".join(scenario.source.split())] if scenario.source.strip() else []
    first = claim_sentence(found) if claim is None else claim
    words = [*([first] if first else []), *paragraphs, *findings(scenario, found)]
    return arranged(f"Entry: {scenario.name}", tuple(words), drawn, entry_tables(found))


def findings(scenario: Scenario, found: Assessment) -> list[str]:
    """What is to be known of a flight and its filter, in sentences."""
    flight = found.flight
    last = flight.times[-1]
    count = found.seen.sum(axis=1)
    words = [
        found.consistency.sentence,
        *_whole_words(found),
        accuracy_sentence(found.accuracy, claimed=found.claim_m is not None),
        *ground_words(found),
        *satellite_words(scenario, found),
        f"The lander flies {last:g} s, from {flight.altitude[0] / KM:.1f} km and "
        f"{flight.speed[0]:.0f} m/s to {flight.altitude[-1] / KM:.1f} km and "
        f"{flight.speed[-1]:.0f} m/s. Between {count.min()} and {count.max()} of "
        f"{found.beacons.size} beacons are in view.",
    ]
    if flight.ending:
        words.append(f"The flight ended early: {flight.ending}.")
    if flight.missed:
        words.append(f"Not reached: {'; '.join(flight.missed)}.")
    if scenario.notes:
        words.append(f"Note: {'; '.join(scenario.notes)}.")
    words.append(observability_sentence(found))
    if not found.taken.any():
        left = "the errors are those of the first estimate"
        if any(count for _, count in found.readings):
            left = "what is known is from the other instruments"
        words.append(f"No beacon is ever measured: {left}.")
    return words


def observability_sentence(found: Assessment) -> str:
    """What beacons tell of position and velocity, which is no claim where the filter makes none."""
    radio = " by radio alone" if found.readings else ""
    when = f"at {found.flight.times[found.blind_epoch]:g} s"
    if found.blind.words:
        return (
            f"Not everything can be seen{radio} {when}: the observability matrix has rank "
            f"{found.blind.rank} of 6. Hidden: {'; '.join(found.blind.words)}."
        )
    weakest = f"worst {when}, where the weakest direction is {found.blind.weakest}."
    if found.claim_m is None:
        return (
            f"The observability matrix{radio} has full rank throughout, which is no accuracy: the "
            f"filter makes no claim from it; {weakest}"
        )
    return f"Position and velocity are observable throughout{radio}; {weakest}"


def satellite_words(scenario: Scenario, found: Assessment) -> list[str]:
    """What is said of how well the satellites' own places and clocks are known."""
    words = []
    for orbiters in scenario.orbiters:
        if (design := orbiters.design) is None:
            continue
        if design.signal is None:
            words.append(
                f"Orbits and clocks of {design.name} count as known exactly; give the design a "
                "table [signal] to count what is not known of them."
            )
        else:
            words.append(
                f"Considered of {design.name}: {basis(design)}; as errors of the range to each "
                f"satellite that stay as they are in mid-flight{_turning(found)}."
            )
    if not found.known_exactly and scenario.fusion is not None:
        words.append("Filters of [fusion] take orbits and clocks of satellites as known exactly.")
    return words


def _turning(found: Assessment) -> str:
    """By how much lines to measured satellites turn, where that is too much for constant errors."""
    lines = found.flight.path[:, None, :3] - found.beacons.r
    lines /= np.linalg.norm(lines, axis=2, keepdims=True)
    cosine = (lines * lines[len(lines) // 2]).sum(axis=2)
    used = found.taken & found.beacons.moving
    turned = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))[used].max(initial=0.0)
    if turned < MOST_TURN:
        return ""
    return f", which holds badly here: lines to satellites turn by up to {turned:.0f} deg from then"


def _whole_words(found: Assessment) -> list[str]:
    """What is to be said of further states that the filter estimates."""
    whole = found.whole
    if whole.states == found.consistency.states or whole.holds == found.consistency.holds:
        return []
    nees = f"NEES {whole.nees[whole.worst]:.3g} at {found.flight.times[whole.worst]:g} s"
    return [
        f"All {whole.states} states that it estimates together are "
        f"{'consistent' if whole.holds else 'inconsistent'} ({nees}, {whole.low:.2f} to "
        f"{whole.high:.2f} is right): that concerns density, L/D, clock and biases, not the place."
    ]


def claim_sentence(
    found: Assessment, dispersed: Dispersed | None = None, *, guided: bool = False
) -> str:
    """What a landing comes to: knowledge, if it may be claimed, delivery, and entries flown.

    Of a `guided` one delivery is that of its bank flown as planned, whatever happens: entries that
    are guided come before it.
    """
    at, claim = found.accuracy, found.claim_m
    where = f"At {at.name} ({at.time:.1f} s)"
    if claim is None:
        known = f"{where} no accuracy is claimed, for the filter is inconsistent."
    else:
        known = (
            f"{where} the lander knows its place to {significant(claim, 3)} m (1 sigma, all axes)."
        )
    ellipse = at.delivery.ellipse
    how = delivered(guided=guided)
    half = (significant(axis / KM, 3) for axis in (ellipse.semi_major, ellipse.semi_minor))
    linear = (
        anywhere(how)
        if at.anywhere
        else f"{how} it comes down within {' by '.join(half)} km (95 % ellipse, half axes, "
        f"major axis {np.degrees(ellipse.azimuth):.0f} deg from north), half of the time within "
        f"{significant(at.delivery.cep / KM, 3)} km."
    )
    flown = dispersed_sentence(dispersed) if dispersed else ""
    parts = (known, flown, linear) if guided else (known, linear, flown)
    return " ".join(part for part in parts if part)


def delivered(*, guided: bool) -> str:
    """How a lander comes to where linear covariance has it."""
    return "By the planned bank alone" if guided else "Unguided"


def anywhere(how: str) -> str:
    """What is said instead of an ellipse that is larger than Mars."""
    return (
        f"{how} it comes down nobody knows where: what is not known of its first state spreads "
        "over more than a radian of the ground, of which linear covariance says nothing."
    )


def ground_words(found: Assessment) -> list[str]:
    """What is to be said of the ground, where a flight goes on to it past deployment."""
    if found.ground is None:
        return []
    said = accuracy_sentence(found.ground, claimed=found.claim_m is not None)
    said = said.removeprefix("Linear covariance there, ")
    return [f"On the ground ({found.ground.time:.1f} s), as if no parachute were opened, {said}"]


def accuracy_sentence(at: Accuracy, *, claimed: bool) -> str:
    """Knowledge and delivery along, across and down; knowledge a filter's that is consistent."""
    known, comes = (
        ", ".join(significant(sigma, 3) for sigma in spread.along_cross_down)
        for spread in (at.knowledge, at.delivery)
    )
    when = "at the moment of the event" if at.projected else "at that time"
    would = "known" if claimed else "by a consistent filter it would be known"
    said = f"Linear covariance there, along, across and down: {would} to {known} m"
    if at.anywhere:
        return f"{said} (1 sigma)."
    return f"{said}, delivered to {comes} m (1 sigma, {when})."


def event_table(flight: Trajectory) -> Table:
    """Return what happened on the way down, in order."""
    rows = [
        (
            event.name,
            event.time,
            (event.state[0] - flight.model.planet_radius) / KM,
            float(event.state[3]),
            float(np.degrees(event.state[2])),
            float(longitude_degrees(event.state[1])),
        )
        for event in flight.events
    ]
    return Table(
        "Events",
        ("event", "time, s", "altitude, km", "speed, m/s", "latitude, deg", "longitude, deg"),
        tuple(rows),
    )


def entry_tables(found: Assessment) -> tuple[Table, ...]:
    """Events, loads, view, and navigation at some times."""
    flight, borne = found.flight, loads(found.flight)
    peaks = [
        (title, *borne.largest(name)[:1], unit, borne.largest(name)[1])
        for name, title, unit in (
            ("g_load", "aerodynamic acceleration in standard gravities", "g"),
            ("dynamic_pressure", "dynamic pressure", "Pa"),
            ("heat_flux", "stagnation-point convective heat flux", "W/m^2"),
            ("heat_load", "heat flux integrated", "J/m^2"),
        )
    ]
    view = [
        (
            name,
            float(found.seen[:, k].mean()),
            int(found.taken[:, k].sum()),
            _noise(found.range_noise, k),
        )
        for k, name in enumerate(found.beacons.names)
    ]
    mc, bound = found.monte_carlo, found.bound
    rows = [
        (
            float(flight.times[k]),
            int(found.seen[k].sum()),
            int(found.observability.rank[k]),
            float(found.observability.spherical_degree[k]),
            float(found.observability.degree[k]),
            float(found.observability.index[k]),
            float(bound.position_sigma[k]),
            float(mc.position_rms[k]),
            float(bound.velocity_sigma[k]),
            float(mc.velocity_rms[k]),
            float(mc.mean_nees[k]),
        )
        for k in np.unique(np.linspace(0, flight.times.size - 1, 9).round().astype(int))
    ]
    events = (event_table(flight),) if flight.events else ()
    return (
        *events,
        budget_table(found),
        Table("Largest loads", ("quantity", "largest", "unit", "at, s"), tuple(peaks)),
        Table(
            "Beacons",
            ("beacon", "share of time in view", "epochs measured", "range noise, m"),
            tuple(view),
        ),
        *(
            [Table("Beside one-way radio", ("what", "numbers read"), found.readings)]
            if found.readings
            else []
        ),
        Table(
            # of normal errors on three axes a mean square has a relative error of at most
            # sqrt(2 / n), its root half of that
            f"Navigation ({len(mc.errors)} runs, which know rms errors to "
            f"{100 / math.sqrt(2 * len(mc.errors)):.2g} % or better, 1 sigma; "
            "delta of angles in SI, not free of latitude, and of axes in 3400 km, 100 s)",
            (
                "time, s",
                "in view",
                "rank",
                "delta of angles",
                "delta of axes",
                "index I",
                "bound, m",
                "rms error, m",
                "bound, m/s",
                "rms error, m/s",
                "NEES (6)",
            ),
            tuple(rows),
        ),
    )


def budget_table(found: Assessment) -> Table:
    """What the error of the known place comes from; squares add up."""
    whole = found.accuracy.knowledge.along_cross_down
    variance = float(whole @ whole)
    rows = [
        (
            share.name,
            *(significant(sigma, 3) for sigma in (*share.along_cross_down, share.sigma)),
            f"{100.0 * share.sigma**2 / variance:.1f}",
        )
        for share in found.budget
    ]
    total = (significant(float(sigma), 3) for sigma in (*whole, math.sqrt(variance)))
    return Table(
        f"Where the error of the known place comes from, 1 sigma ({found.accuracy.name}; squares "
        "add up)",
        ("source", "along, m", "across, m", "down, m", "all axes, m", "share of variance, %"),
        (*rows, ("all", *total, "100.0")),
    )


def _noise(sigmas: NDArray[np.float64] | None, beacon: int) -> str:
    """Noise of the ranges of one beacon, least to most."""
    if sigmas is None or not np.isfinite(sigmas[:, beacon]).any():
        return "none"
    low, high = (significant(float(f(sigmas[:, beacon])), 3) for f in (np.nanmin, np.nanmax))
    return low if low == high else f"{low} to {high}"


def entry_facts(scenario: Scenario, found: Assessment) -> dict[str, Any]:
    """Return the numbers as one JSON object, names with their units."""
    flight, mc, bound = found.flight, found.monte_carlo, found.bound
    return {
        "scenario": scenario.name,
        "rotation": flight.model.rotation,
        "ending": flight.ending,
        "events": [
            {
                "name": event.name,
                "time_s": event.time,
                "altitude_km": (event.state[0] - flight.model.planet_radius) / KM,
                "speed_m_s": event.state[3],
                "latitude_deg": np.degrees(event.state[2]),
                "longitude_deg": longitude_degrees(event.state[1]),
            }
            for event in flight.events
        ],
        "end": {
            "time_s": flight.times[-1],
            "altitude_km": flight.altitude[-1] / KM,
            "speed_m_s": flight.states[-1, 3],
            "latitude_deg": np.degrees(flight.states[-1, 2]),
            "longitude_deg": longitude_degrees(flight.states[-1, 1]),
            "flight_path_deg": np.degrees(flight.states[-1, 4]),
        },
        "beacons": list(found.beacons.names),
        "readings": dict(found.readings),
        "in_view_share": found.seen.mean(axis=0),
        "evidence": {
            "in_view_share": str(Sampled(how=f"at the {flight.times.size} epochs of the flight")),
            "navigation": (
                f"bounds of a covariance; rms and nees of {len(mc.errors)} runs, rms with its "
                "standard error beside it as _sampling"
            ),
            "others": EVIDENCE,
        },
        "in_view": {
            "min": found.seen.sum(axis=1).min(),
            "max": found.seen.sum(axis=1).max(),
        },
        "observability": {
            "rank_min": found.observability.rank.min(),
            "degree_si_min": found.observability.spherical_degree.min(),
            "degree_scaled_min": found.observability.degree.min(),
            "index_mean": found.observability.index.mean(),
            "worst_time_s": flight.times[found.blind_epoch],
            "hidden": list(found.blind.words),
            "weakest": found.blind.weakest,
            "sentence": observability_sentence(found),
        },
        "landing": {
            "at": found.accuracy.name,
            "time_s": found.accuracy.time,
            "projected": found.accuracy.projected,
            "claim_m": found.claim_m,
            "knowledge": _spread_facts(found.accuracy.knowledge),
            "budget": [
                {
                    "source": share.name,
                    **dict(
                        zip(("along_m", "cross_m", "down_m"), share.along_cross_down, strict=True)
                    ),
                    "position_m": share.sigma,
                }
                for share in found.budget
            ],
            "delivery": None if found.accuracy.anywhere else _spread_facts(found.accuracy.delivery),
            "ground": None
            if found.ground is None
            else {
                "time_s": found.ground.time,
                "knowledge": _spread_facts(found.ground.knowledge),
                "delivery": None if found.ground.anywhere else _spread_facts(found.ground.delivery),
            },
        },
        "consistency": {
            "consistent": found.consistency.holds,
            "sentence": found.consistency.sentence,
            "ratio": found.consistency.ratio,
            "nees_worst": found.consistency.nees[found.consistency.worst],
            "worst_time_s": flight.times[found.consistency.worst],
            "nees_interval": [found.consistency.low, found.consistency.high],
            "states_estimated": found.whole.states,
            "whole_state_consistent": found.whole.holds,
        },
        "missed_triggers": list(flight.missed),
        "notes": list(scenario.notes),
        "navigation": {
            "time_s": flight.times,
            "position_bound_m": bound.position_sigma,
            "velocity_bound_m_s": bound.velocity_sigma,
            "position_rms_m": mc.position_rms,
            "position_rms_sampling_m": mc.position_rms_error,
            "velocity_rms_m_s": mc.velocity_rms,
            "velocity_rms_sampling_m_s": mc.velocity_rms_error,
            "nees": mc.mean_nees,
            "runs": len(mc.errors),
            "diverged": int(mc.diverged.sum()),
            "broken": int(mc.broken.sum()),
        },
    }


def _spread_facts(spread: Spread) -> dict[str, Any]:
    """One spread as plain values."""
    ellipse = spread.ellipse
    return {
        "along_m": spread.along_cross_down[0],
        "cross_m": spread.along_cross_down[1],
        "down_m": spread.along_cross_down[2],
        "semi_major_m": ellipse.semi_major,
        "semi_minor_m": ellipse.semi_minor,
        "ellipse_level": ellipse.level,
        "azimuth_deg": np.degrees(ellipse.azimuth),
        "cep_m": spread.cep,
    }
