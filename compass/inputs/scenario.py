"""Scenario files: read, check across fields, and turn into an entry and its beacons."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

import compass
from compass.arguments import checked
from compass.bodies import MARS_EQUATORIAL_RADIUS, MARS_GM, MARS_J2, MARS_ROTATION_RATE
from compass.conventions import epoch_text
from compass.design import Design
from compass.entry.atmosphere import Atmosphere, read_atmosphere_table
from compass.entry.beacons import Beacons, orbiting_beacons, surface_beacons
from compass.entry.covariance import axes_covariance
from compass.entry.filters import Filter, Method
from compass.entry.guidance import Dispersion, Guidance, guided_banks, with_bank
from compass.entry.layout import Part
from compass.entry.mars_air import PROFILE, SPREAD, WINDS
from compass.entry.model import EntryModel
from compass.entry.schedule import Measurements
from compass.entry.start import Trigger, check_start
from compass.entry.state import azimuth_from_heading, state_from_cartesian
from compass.entry.vehicle import Vehicle
from compass.entry.views import cartesian_of, spherical_jacobian
from compass.errors import ArgumentError, CompassError, DesignError
from compass.frames import HOUR, SECONDS_PER_DAY, direction, prime_meridian_angle
from compass.inputs.design import read_design
from compass.inputs.fusion_models import FusionTable
from compass.inputs.guidance_models import dispersion_of, guidance_of
from compass.inputs.instrument_models import features_of, instruments_of, link_of
from compass.inputs.reading import parse, read_text
from compass.inputs.scenario_faults import EXPONENTIAL, scenario_faults
from compass.inputs.scenario_models import (
    EntryTable,
    FilterTable,
    MeasurementsTable,
    OptimizeTable,
    OrbiterTable,
    ScenarioFile,
    TruthTable,
)
from compass.inputs.scenario_notes import scenario_notes
from compass.orbits import Constellation, keplerian, states_mci
from compass.orbits.states import from_states
from compass.orbits.touching import touching
from compass.saving import readable
from compass.units import KM

Winds = tuple[tuple[float, float, float], ...]

_METHODS: dict[str, Method] = {
    "ekf": "plain",
    "iterated-ekf": "plain",
    "relinearised-ekf": "relinearised",
    "unscented": "unscented",
    "square-root-ekf": "square-root",
    "information-ekf": "information",
}

#: Cosine of a latitude below which sigmas of longitude and heading say nothing.
POLAR = 1e-9


@dataclass(frozen=True)
class Orbiters:
    """Satellites that serve as beacons, and how the planet stands under them at time 0.

    Attributes
    ----------
    constellation
        The orbits.
    start
        Seconds after the constellation's epoch at which the entry begins.
    angle
        Angle from the inertial x axis to the prime meridian when the entry begins, radians.
    mask
        Elevation that a satellite must have over the lander's limb, radians; nan for line of
        sight alone.
    design
        The design that they are of, whose [signal] says how well their orbits and clocks are
        known; None for orbiters of the scenario's own.
    """

    constellation: Constellation
    start: float
    angle: float
    mask: float = float("nan")
    design: Design | None = None


@dataclass(frozen=True, repr=False)
class Scenario:
    """A scenario file, read.

    Attributes
    ----------
    name, source, paper
        As written.
    model
        The world as the filter knows it.
    truth
        The world as it is.
    state
        ``[r, lon, lat, V, gamma, psi]`` at time 0, SI, psi from north.
    times
        Seconds, shape (t,).
    triggers
        Events to notice.
    surface
        Latitude, longitude (rad) and height (m) of surface beacons, shape (n, 3).
    surface_names
        Their names.
    orbiters
        Orbiting beacons.
    mask
        Elevation mask of surface beacons, radians, or None for line of sight alone.
    measurements
        What is measured.
    settings
        The filter.
    runs, seed
        Of the Monte Carlo.
    optimize
        What ``compass optimize`` looks for, or None.
    fusion
        Accelerometers, distributed filters, radio and faults, or None; see
        `compass.inputs.fusion.fusion_plan`.
    text, digest, label
        The file's text, its SHA-256 and its name as given.
    notes
        What is to be told of it before it is flown.
    guidance
        Of the bank to a target, or None.
    dispersion
        Of entries about the planned one, or None.
    """

    name: str
    source: str
    paper: str | None
    model: EntryModel
    truth: EntryModel
    state: NDArray[np.float64]
    times: NDArray[np.float64]
    triggers: tuple[Trigger, ...]
    surface: NDArray[np.float64]
    surface_names: tuple[str, ...]
    orbiters: tuple[Orbiters, ...]
    mask: float | None
    measurements: Measurements
    settings: Filter
    runs: int
    seed: int
    optimize: OptimizeTable | None
    fusion: FusionTable | None
    text: str
    digest: str
    label: str
    notes: tuple[str, ...] = ()
    guidance: Guidance | None = None
    dispersion: Dispersion | None = None

    def __repr__(self) -> str:
        satellites = sum(orbiters.constellation.size for orbiters in self.orbiters)
        return (
            f"Scenario {self.name}: {self.times[-1]:g} s of flight, beacons: "
            f"{len(self.surface_names)} on the ground, {satellites} in orbit"
        )

    def planned(self) -> "Scenario":
        """The scenario whose vehicle flies the bank that guidance finds in the true world.

        Itself without guidance.
        """
        if self.guidance is None:
            return self
        start, end = cartesian_of(self.state[None, :6]), float(self.times[-1])
        target = direction(self.guidance.latitude, self.guidance.longitude)[None]
        (bank,), _, _ = guided_banks(
            self.truth, self.model, start, np.zeros((1, 2)), self.guidance, target,
            self.deployment, end,
        )  # fmt: skip
        return replace(self, model=with_bank(self.model, bank), truth=with_bank(self.truth, bank))

    @property
    def deployment(self) -> Trigger | None:
        """The trigger whose name speaks of a parachute, if there is one."""
        for trigger in self.triggers:
            if "parachute" in trigger.name.lower():
                return trigger
        return None

    def beacons(self, times: ArrayLike | None = None) -> Beacons:
        """All beacons at `times` (s; the scenario's own if left out), surface first.

        Raises
        ------
        ArgumentError
            An orbiter that comes under the surface in that time.
        """
        seconds = self.times if times is None else np.asarray(times, dtype=float)
        radius = self.model.planet_radius
        lat, lon, height = self.surface.T
        found = surface_beacons(
            lat, lon, seconds, planet_radius=radius, height=height, names=self.surface_names
        ).above(np.nan if self.mask is None else self.mask)
        for orbiters in self.orbiters:
            r, v = states_mci(orbiters.constellation, orbiters.start + seconds)
            found = found.with_others(
                orbiting_beacons(
                    r,
                    v,
                    seconds,
                    omega=self.model.omega,
                    angle=orbiters.angle,
                    planet_radius=radius,
                    names=orbiters.constellation.satellite_names,
                ).above(orbiters.mask)
            )
        return found


@checked
def read_scenario(path: str | Path, start_day: float | None = None) -> Scenario:
    """Read a scenario file.

    Parameters
    ----------
    path
        The file.
    start_day
        Day after the epoch of its beacons' design at which entry begins; else as the file says.

    Raises
    ------
    DesignError
        With every fault of the file: field, value, what is allowed and the remedy.

    Examples
    --------
    >>> import compass
    >>> compass.read_scenario("designs/landing.toml").name
    'Landing anywhere, to parachute deployment'
    """
    place = Path(path)
    return read_scenario_text(read_text(place), readable(path), place.parent, start_day)


def read_scenario_text(
    text: str,
    label: str = "scenario",
    folder: Path = Path(),
    start_day: float | None = None,
) -> Scenario:
    """Read a scenario from its TOML text; files it names are looked for from `folder`."""
    file = parse(text, label, ScenarioFile, scenario_faults)
    try:
        if start_day is not None:
            file = _on_day(file, start_day)
        return _scenario(file, text, label, folder)
    except DesignError as error:
        raise DesignError([f"{label}: {fault}" for fault in error.faults]) from error
    except CompassError as error:
        raise DesignError(f"{label}: {error}") from error


def _on_day(file: ScenarioFile, day: float) -> ScenarioFile:
    """Let the entry begin on a day after the epoch of the design whose satellites are beacons."""
    if not 0 <= day < np.inf:
        raise ArgumentError(f"start_day = {day:g}: must be 0 or more days")
    if file.beacons.design is None:
        raise ArgumentError(f"start_day = {day:g}: no beacons.design moves on; leave it out")
    beacons = file.beacons.model_copy(update={"start_s": day * SECONDS_PER_DAY})
    return file.model_copy(update={"beacons": beacons})


def _scenario(file: ScenarioFile, text: str, label: str, folder: Path) -> Scenario:
    model = _model(file, folder)
    state = _state(file.entry, model)
    check_start(model, state)
    entry, seen = file.entry, file.measurements
    count = int(np.floor(entry.duration_s / entry.step_s + 1e-9))
    if not 1 <= count <= 100_000:
        raise ArgumentError(
            f"entry.step_s = {entry.step_s:g}: {count} steps in duration_s = {entry.duration_s:g}; "
            "allowed 1 to 100000"
        )
    bias = file.truth
    return Scenario(
        name=file.name,
        source=file.source,
        paper=file.paper,
        model=model,
        truth=_truth(model, bias),
        state=state,
        times=entry.step_s * np.arange(count + 1, dtype=float),
        triggers=tuple(
            Trigger(t.name, "altitude", t.altitude_km * KM)
            if t.altitude_km is not None
            else Trigger(t.name, "speed", t.speed_m_s)
            if t.speed_m_s is not None
            else Trigger(t.name, "mach", t.mach or 0.0)
            for t in file.trigger
        ),
        surface=np.array(
            [
                [np.radians(b.latitude_deg), np.radians(b.longitude_deg), b.height_km * KM]
                for b in file.beacon
            ]
        ).reshape(-1, 3),
        surface_names=tuple(b.name for b in file.beacon),
        orbiters=_orbiters(file, model, folder),
        mask=None if file.beacons.mask_deg is None else float(np.radians(file.beacons.mask_deg)),
        measurements=Measurements(
            _range_sigma(seen),
            seen.range_rate_sigma_m_s,
            seen.interval_s,
            seen.start_s,
            np.inf if seen.stop_s is None else seen.stop_s,
            seen.in_turn,
            instruments_of(
                seen.two_way, seen.altimeter, seen.velocimeter, seen.features, seen.accelerometers
            ),
            features_of(file.feature),
            link_of(seen.link),
        ),
        settings=_filter(file.filter, state, model.planet_radius),
        runs=file.monte_carlo.runs,
        seed=file.monte_carlo.seed,
        optimize=file.optimize,
        fusion=file.fusion,
        text=text,
        digest=hashlib.sha256(text.encode()).hexdigest(),
        label=label,
        notes=scenario_notes(file),
        guidance=guidance_of(file.guidance),
        dispersion=dispersion_of(file.dispersion),
    )


def _model(file: ScenarioFile, folder: Path) -> EntryModel:
    planet, craft, air = file.planet, file.vehicle, file.atmosphere
    radius = MARS_EQUATORIAL_RADIUS.value if planet.radius_km is None else planet.radius_km * KM
    mean = all(getattr(air, name) is None for name in (*EXPONENTIAL, "table"))
    altitudes, densities = read_atmosphere_table(folder / air.table) if air.table else ((), ())
    if mean:
        altitudes, densities = zip(*((KM * km, density) for km, density in PROFILE), strict=True)
    tabled = bool(air.table) or mean
    if craft.ballistic_coefficient_kg_m2 is not None:
        drag = 1.0 / craft.ballistic_coefficient_kg_m2
    else:
        drag = craft.drag_area_per_mass_m2_kg or 0.0
    bank = craft.bank_deg if isinstance(craft.bank_deg, list) else [[0.0, craft.bank_deg]]
    return EntryModel(
        Vehicle(
            drag,
            craft.lift_to_drag,
            tuple(pair[0] for pair in bank),
            tuple(float(np.radians(pair[1])) for pair in bank),
            craft.nose_radius_m,
        ),
        Atmosphere(
            # beside a table these three only name a level; the table is flown as it is
            1.0 if tabled else air.reference_density_kg_m3 or 0.0,
            radius + 40.0 * KM if tabled else (air.reference_radius_km or 0.0) * KM,
            1.0 * KM if tabled else (air.scale_height_km or 0.0) * KM,
            tuple(radius + altitude for altitude in altitudes),
            densities,
            air.temperature_k,
            _winds(air.winds_by_km, radius),
        ),
        planet.rotation,
        MARS_GM.value if planet.gm_m3_s2 is None else planet.gm_m3_s2,
        radius,
        MARS_ROTATION_RATE.value
        if planet.rotation_rate_rad_s is None
        else planet.rotation_rate_rad_s,
        MARS_J2.value if planet.gravity == "j2" else 0.0,
    )


def _range_sigma(table: MeasurementsTable) -> float | None:
    """Own noise of ranges one way: none beside that of a link which is all there is of radio."""
    alone = table.link is not None and table.range_rate_sigma_m_s is None and not table.two_way
    return 0.0 if table.range_sigma_m is None and alone else table.range_sigma_m


def _winds(rows: Sequence[Sequence[float]] | Literal["mars"] | None, radius: float) -> Winds:
    """Rows of a table of winds over distance from the centre."""
    given = WINDS if rows == "mars" else rows or ()
    return tuple((radius + KM * float(km), float(e), float(n)) for km, e, n in given)


def _truth(model: EntryModel, table: TruthTable) -> EntryModel:
    """World as it is."""
    truth = model.truth(table.density_bias, table.scale_height_factor)
    if table.winds_by_km is None:
        return truth
    winds = _winds(table.winds_by_km, model.planet_radius)
    return replace(truth, atmosphere=replace(truth.atmosphere, winds=winds))


def _state(table: EntryTable, model: EntryModel) -> NDArray[np.float64]:
    if table.position_km is not None and table.velocity_m_s is not None:
        return state_from_cartesian(np.array(table.position_km) * KM, table.velocity_m_s)
    if table.radius_km is not None:
        radius = table.radius_km * KM
    else:
        radius = model.planet_radius + (table.altitude_km or 0.0) * KM
    assert table.heading_from is not None  # scenario_faults has seen to these
    lon, lat, gamma, heading = np.radians(
        [
            table.longitude_deg or 0.0,
            table.latitude_deg or 0.0,
            table.flight_path_deg or 0.0,
            table.heading_deg or 0.0,
        ]
    )
    azimuth = float(azimuth_from_heading(heading, table.heading_from))
    return np.array([radius, lon, lat, table.speed_m_s or 0.0, gamma, azimuth])


def _filter(table: FilterTable, state: NDArray[np.float64], planet_radius: float) -> Filter:
    if table.position_sigma_m is not None and table.velocity_sigma_m_s is not None:
        covariance = axes_covariance(table.position_sigma_m, table.velocity_sigma_m_s)
    else:
        degrees = np.radians(
            [
                table.longitude_sigma_deg or 0.0,
                table.latitude_sigma_deg or 0.0,
                table.flight_path_sigma_deg or 0.0,
                table.heading_sigma_deg or 0.0,
            ]
        )
        radius, speed = table.radius_sigma_m or 0.0, table.speed_sigma_m_s or 0.0
        if abs(np.cos(state[2])) < POLAR:
            raise ArgumentError(
                f"entry.latitude_deg = {np.degrees(state[2]):g}: at a pole longitude and heading "
                "are undefined, and so are sigmas of them; give filter.position_sigma_m and "
                "filter.velocity_sigma_m_s"
            )
        jacobian = spherical_jacobian(cartesian_of(state[:6]))
        root = jacobian * np.array([radius, *degrees[:2], speed, *degrees[2:]])
        covariance = root @ root.T
    return Filter(
        covariance,
        np.array(table.process_noise_si or [0.0] * 6),
        table.iterations if table.kind in ("iterated-ekf", "square-root-ekf") else 1,
        _parts(table, state, planet_radius),
        _METHODS[table.kind],
    )


def _parts(
    table: FilterTable, state: NDArray[np.float64], planet_radius: float
) -> tuple[Part, ...]:
    """Quantities that are not known, beside position and velocity."""
    blocks = (("lift", table.lift_to_drag), ("bias", table.range_bias))
    parts = [Part(name, (b.sigma,), b.considered) for name, b in blocks if b is not None]
    if (air := table.density) is not None:
        scales = (air.scale_km or np.inf, air.along_km or np.inf)
        wanders = np.isfinite(scales).any()
        own = tuple(KM * scale for scale in scales) if wanders else ()
        rows = SPREAD if air.sigma_by_km == "mars" else air.sigma_by_km or ()
        profile = tuple((planet_radius + KM * float(km), float(sigma)) for km, sigma in rows)
        part = Part("air", (air.sigma or 1.0,), air.considered, own, profile)
        first = float(part.sigma_at(state[:1])[0])
        parts.insert(0, replace(part, sigma=(first,)))
    if (clock := table.clock) is not None:
        parts.append(Part("clock", (clock.sigma_m, clock.drift_sigma_m_s), clock.considered))
    if (axes := table.attitude) is not None:
        parts.append(Part("attitude", (float(np.radians(axes.sigma_deg)),) * 3, axes.considered))
    if (gyros := table.gyros) is not None:
        drift, walk = np.radians([gyros.drift_sigma_deg_h / HOUR, gyros.walk_deg_sqrt_h / 60.0])
        parts.append(Part("gyro", (float(drift),) * 3, gyros.considered, walk=float(walk)))
    if (felt := table.accelerometers) is not None:
        parts.append(Part("imu", (felt.sigma_m_s2,) * 3, felt.considered))
    return tuple(parts)


def _orbiters(file: ScenarioFile, model: EntryModel, folder: Path) -> tuple[Orbiters, ...]:
    groups = []
    if file.orbiter:
        circles = [o for o in file.orbiter if o.position_km is None]
        vectors = [o for o in file.orbiter if o.position_km is not None]
        if circles:
            groups.append(Orbiters(_circles(circles, model), 0.0, 0.0))
        if vectors:
            constellation = from_states(
                np.array([o.position_km for o in vectors]) * KM,
                np.array([o.velocity_m_s for o in vectors]),
                satellite_names=[o.name for o in vectors],
                gm=model.gm,
            )
            groups.append(Orbiters(constellation, 0.0, 0.0))
    if file.beacons.design is not None:
        design = read_design(folder / file.beacons.design)
        constellation, start = design.constellation, file.beacons.start_s
        if not design.motion.is_closed_form:
            constellation, start = touching(constellation, design.motion, start), 0.0
        angle = float(prime_meridian_angle(constellation.epoch, start))
        groups.append(Orbiters(constellation, start, angle, design.mask.highest, design))
    return tuple(groups)


def _circles(tables: list[OrbiterTable], model: EntryModel) -> Constellation:
    rows = np.array(
        [[o.altitude_km, o.inclination_deg, o.raan_deg, o.latitude_argument_deg] for o in tables],
        dtype=float,
    ).T
    return keplerian(
        model.planet_radius + rows[0] * KM,
        0.0,
        np.radians(rows[1]),
        np.radians(rows[2]),
        0.0,
        np.radians(rows[3]),
        name="orbiters",
        satellite_names=[o.name for o in tables],
        gm=model.gm,
    )


def provenance(scenario: Scenario, command: str) -> dict[str, str]:
    """Return what a result was made from: global attributes of the CF convention, the scenario."""
    now = datetime.now(UTC).isoformat(timespec="seconds")
    return {
        "epoch_tdb": epoch_text(
            max((o.constellation.epoch + o.start for o in scenario.orbiters), default=0.0)
        ),
        "title": f"Entry navigation: {scenario.name}",
        "source": f"compass {compass.__version__}",
        "history": f"{now} {command}".strip(),
        "references": " ".join(scenario.source.split()),
        "scenario_file": scenario.label,
        "scenario_text": scenario.text,
        "scenario_sha256": scenario.digest,
    }
