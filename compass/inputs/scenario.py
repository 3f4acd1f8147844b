"""Scenario files: read, check across fields, and turn into an entry and its beacons."""

import hashlib
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

import compass
from compass.arguments import checked
from compass.conventions import epoch_text
from compass.entry.beacons import Beacons, orbiting_beacons, surface_beacons
from compass.entry.filters import Filter
from compass.entry.guidance import Dispersion, Guidance, guided_banks, with_bank
from compass.entry.model import EntryModel
from compass.entry.schedule import Measurements
from compass.entry.start import Trigger, check_start
from compass.entry.views import cartesian_of
from compass.errors import ArgumentError, CompassError, DesignError
from compass.frames import SECONDS_PER_DAY, direction
from compass.inputs.fusion_models import FusionTable
from compass.inputs.guidance_models import dispersion_of, guidance_of
from compass.inputs.instrument_models import features_of, instruments_of, link_of
from compass.inputs.reading import parse, read_text
from compass.inputs.scenario_faults import scenario_faults
from compass.inputs.scenario_filter import filter_of
from compass.inputs.scenario_models import OptimizeTable, ScenarioFile
from compass.inputs.scenario_notes import scenario_notes
from compass.inputs.scenario_orbiters import Orbiters, orbiters_of
from compass.inputs.scenario_world import model_of, range_sigma_of, state_of, truth_of
from compass.orbits import states_mci
from compass.saving import readable
from compass.units import KM


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
        beacons = surface_beacons(
            lat, lon, seconds, planet_radius=radius, height=height, names=self.surface_names
        ).above(np.nan if self.mask is None else self.mask)
        for orbiters in self.orbiters:
            r, v = states_mci(orbiters.constellation, orbiters.start + seconds)
            beacons = beacons.with_others(
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
        return beacons


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
    model = model_of(file, folder)
    state = state_of(file.entry, model)
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
        truth=truth_of(model, bias),
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
        orbiters=orbiters_of(file, model, folder),
        mask=None if file.beacons.mask_deg is None else float(np.radians(file.beacons.mask_deg)),
        measurements=Measurements(
            range_sigma_of(seen),
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
        settings=filter_of(file.filter, state, model.planet_radius),
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
