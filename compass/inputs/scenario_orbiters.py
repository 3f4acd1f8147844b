"""The orbiters of a scenario file: circles, vectors, and the satellites of a design."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from compass.design import Design
from compass.entry.model import EntryModel
from compass.frames import prime_meridian_angle
from compass.inputs.design import read_design
from compass.inputs.scenario_models import (
    OrbiterTable,
    ScenarioFile,
)
from compass.orbits import Constellation, keplerian
from compass.orbits.states import from_states
from compass.orbits.touching import touching
from compass.units import KM


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


def orbiters_of(file: ScenarioFile, model: EntryModel, folder: Path) -> tuple[Orbiters, ...]:
    """Groups of beacons in orbit, each with its own epoch."""
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
