"""Faults between fields of a scenario, found on the raw tables, whatever is in them."""

import math
from collections.abc import Iterator
from functools import partial
from itertools import pairwise
from typing import Any

from compass.inputs.faults import fault, tables_in
from compass.inputs.guidance_models import guidance_faults
from compass.inputs.instrument_models import instrument_faults

_SPHERICAL = (
    "longitude_deg",
    "latitude_deg",
    "speed_m_s",
    "flight_path_deg",
    "heading_deg",
    "heading_from",
)
_CARTESIAN = ("position_km", "velocity_m_s")
_CIRCLE = ("altitude_km", "inclination_deg", "raan_deg", "latitude_argument_deg")
_AXES = ("position_sigma_m", "velocity_sigma_m_s")
#: An exponential atmosphere; a table stands in their place.
EXPONENTIAL = ("reference_density_kg_m3", "reference_radius_km", "scale_height_km")
#: Altitudes of winds, from below the lowest ground to above any entry, and speeds, which stay
#: below 200 m/s on Mars up to 120 km.
WIND_COLUMNS = (((-10.0, 1000.0), "km"), ((-500.0, 500.0), "m/s"))
_STATES = (
    "radius_sigma_m",
    "longitude_sigma_deg",
    "latitude_sigma_deg",
    "speed_sigma_m_s",
    "flight_path_sigma_deg",
    "heading_sigma_deg",
)


def scenario_faults(raw: dict[str, Any]) -> list[str]:
    """Faults that concern several fields at once."""
    faults: list[str] = []
    vehicle, entry = raw.get("vehicle"), raw.get("entry")
    if isinstance(vehicle, dict):
        keys = ("drag_area_per_mass_m2_kg", "ballistic_coefficient_kg_m2")
        faults += _exactly_one(vehicle, keys, "vehicle") + _bank_faults(vehicle.get("bank_deg"))
    if isinstance(raw.get("atmosphere"), dict):
        faults += _air_faults(raw["atmosphere"])
    faults += _wind_faults(raw)
    if isinstance(entry, dict):
        faults += _entry_faults(entry)
    for k, trigger in enumerate(tables_in(raw, "trigger"), start=1):
        faults += _exactly_one(trigger, ("altitude_km", "speed_m_s", "mach"), f"trigger[{k}]")
    for k, orbiter in enumerate(tables_in(raw, "orbiter"), start=1):
        faults += _either(orbiter, _CIRCLE, _CARTESIAN, f"orbiter[{k}]")
    faults += _name_faults(raw)
    measured = raw.get("measurements")
    if isinstance(raw.get("filter"), dict):
        faults += _either(raw["filter"], _AXES, _STATES, "filter")
        faults += _filter_faults(raw["filter"])
        faults += _block_faults(raw["filter"], measured if isinstance(measured, dict) else {})
    if isinstance(measured, dict):
        keys = ("range_sigma_m", "range_rate_sigma_m_s")
        if not any(key in measured for key in (*keys, "two_way", "link")):
            faults.append(f"measurements: needs {keys[0]}, {keys[1]} or both, or two_way or link")
        faults += _schedule_faults(measured, entry)
        faults += instrument_faults(raw, partial(_interval_faults, entry=entry))
    faults += guidance_faults(raw)
    optimize = raw.get("optimize")
    if (
        isinstance(optimize, dict)
        and optimize.get("what") == "orbiters"
        and "altitude_km" not in optimize
    ):
        faults.append("optimize.altitude_km: missing; needed to place orbiters")
    return faults


def _filter_faults(table: dict[str, Any]) -> list[str]:
    """Options of one kind of filter beside another, and a flight that cannot be looked back on."""
    kind, faults = table.get("kind", "ekf"), []
    if kind not in ("iterated-ekf", "square-root-ekf") and "iterations" in table:
        problem = 'only for kind = "iterated-ekf" or "square-root-ekf"; change it or leave it out'
        faults.append(fault("filter.iterations", table["iterations"], problem))
    density, noise = table.get("density"), table.get("process_noise_si")
    wanders = isinstance(density, dict) and ("scale_km" in density or "along_km" in density)
    shaken = isinstance(noise, list) and any(noise)
    if kind == "relinearised-ekf" and (wanders or shaken):
        problem = (
            "with process noise or a density that wanders there is no one flight to look back "
            'along; take "unscented"'
        )
        faults.append(fault("filter.kind", kind, problem))
    if isinstance(density, dict):
        faults += _exactly_one(density, ("sigma", "sigma_by_km"), "filter.density")
        if "sigma_by_km" in density and not wanders:
            faults.append("filter.density.scale_km: missing; needed beside sigma_by_km")
        faults += _spread_faults(density.get("sigma_by_km"))
    return faults


def _block_faults(table: dict[str, Any], measured: dict[str, Any]) -> list[str]:
    """Errors of instruments that are not there, and blocks that one kind of filter cannot have."""
    faults = []
    if "accelerometers" in table and "accelerometers" not in measured:
        faults.append(
            "measurements.accelerometers: missing; needed beside biases, filter.accelerometers"
        )
    if "gyros" in table and "attitude" not in table:
        faults.append("filter.attitude: missing; needed beside filter.gyros, which hold these axes")
    gyros = table.get("gyros")
    walk = gyros.get("walk_deg_sqrt_h") if isinstance(gyros, dict) else None
    if table.get("kind") == "relinearised-ekf" and walk:
        problem = 'axes that wander cannot be looked back on; leave it out or take "unscented"'
        faults.append(fault("filter.gyros.walk_deg_sqrt_h", walk, problem))
    if table.get("kind") == "information-ekf":
        faults += [
            f"filter.{name}.considered = true: information knows only what is estimated; set it "
            'to false, or take "ekf"'
            for name, block in table.items()
            if isinstance(block, dict) and block.get("considered") is True
        ]
    return faults


def _air_faults(air: dict[str, Any]) -> list[str]:
    """An atmosphere without a table that has some of its three numbers, and lacks another."""
    if "table" in air or not any(name in air for name in EXPONENTIAL):
        return []
    return [
        f"atmosphere.{name}: missing; give it, or a table, or none of the three for a mean profile"
        for name in EXPONENTIAL
        if name not in air
    ]


def _wind_faults(raw: dict[str, Any]) -> list[str]:
    """Winds whose rows are not in order, or beside a rotation that knows none."""
    faults, planet = [], raw.get("planet")
    rotation = planet.get("rotation") if isinstance(planet, dict) else None
    for name in ("atmosphere", "truth"):
        table = raw.get(name)
        if not isinstance(table, dict) or "winds_by_km" not in table:
            continue
        field, rows = f"{name}.winds_by_km", table["winds_by_km"]
        if not _rises(rows):
            problem = "winds: altitudes must increase strictly; put the rows in order"
            faults.append(fault(field, rows, problem))
        faults += _wind_rows(field, rows)
        if rotation == "published-coriolis":
            problem = f"is of air that turns with the planet; leave {field} out"
            faults.append(fault("planet.rotation", rotation, problem))
    return faults


def _wind_rows(field: str, rows: object) -> Iterator[str]:
    """Altitudes and speeds that are none of winds."""
    for k, row in enumerate(rows if isinstance(rows, list) else (), start=1):
        for j, x in enumerate(row if isinstance(row, list) else (), start=1):
            (low, high), unit = WIND_COLUMNS[min(j, 2) - 1]
            if isinstance(x, int | float) and (x < low or x > high):
                yield fault(f"{field}[{k}][{j}]", x, f"allowed {low:g} to {high:g} {unit}")


def _spread_faults(rows: object) -> list[str]:
    """Sigmas by height that are not in order, or not above 0."""
    field, faults = "filter.density.sigma_by_km", []
    if not _rises(rows):
        problem = "altitudes must increase strictly; put the rows in order"
        faults.append(fault(field, rows, problem))
    for k, row in enumerate(rows if isinstance(rows, list) else (), start=1):
        sigma = row[1] if isinstance(row, list) and len(row) == 2 else None
        if isinstance(sigma, int | float) and sigma <= 0:
            faults.append(fault(f"{field}[{k}][2]", sigma, "must be above 0, one sigma"))
    return faults


def _rises(rows: object) -> bool:
    """Whether the first numbers of rows increase; the model tells what is no row."""
    if not isinstance(rows, list):
        return True
    firsts = [row[0] for row in rows if isinstance(row, list) and row]
    numbers = [x for x in firsts if isinstance(x, int | float) and not isinstance(x, bool)]
    return not any(later <= earlier for earlier, later in pairwise(numbers))


def _exactly_one(table: dict[str, Any], keys: tuple[str, ...], field: str) -> list[str]:
    given = [key for key in keys if key in table]
    if len(given) == 1:
        return []
    said = " and ".join(given) or "none"
    return [f"{field}: needs exactly one of {', '.join(keys)}; found {said}"]


def _either(
    table: dict[str, Any], first: tuple[str, ...], second: tuple[str, ...], field: str
) -> list[str]:
    """All of `first` or all of `second`, not some of both."""
    some = [key for key in first if key in table]
    others = [key for key in second if key in table]
    if bool(some) == bool(others):
        problem = "found some of both" if some else "found neither"
        return [f"{field}: needs either {', '.join(first)} or {', '.join(second)}; {problem}"]
    keys = first if some else second
    return [f"{field}.{key}: missing; needed beside the others" for key in keys if key not in table]


def _entry_faults(entry: dict[str, Any]) -> list[str]:
    cartesian = any(key in entry for key in _CARTESIAN)
    faults = _either(entry, _SPHERICAL, _CARTESIAN, "entry")
    if not cartesian:
        faults += _exactly_one(entry, ("altitude_km", "radius_km"), "entry")
    else:
        faults += [
            fault(f"entry.{key}", entry[key], "not beside position_km; leave it out")
            for key in ("altitude_km", "radius_km")
            if key in entry
        ]
    return faults


def _schedule_faults(measured: dict[str, Any], entry: object) -> list[str]:
    """Faults of a schedule in which no measurement has a place."""
    times = measured.get("start_s", 0), measured.get("stop_s", math.inf)
    duration = entry.get("duration_s", math.inf) if isinstance(entry, dict) else math.inf
    if not all(isinstance(t, int | float) for t in (*times, duration)):
        return []  # the model says what is wrong with them
    start, stop = times
    faults = []
    if stop < start:
        problem = f"is before start_s = {start}; nothing would be measured, put it after"
        faults.append(fault("measurements.stop_s", stop, problem))
    if start > duration:
        problem = f"is after entry.duration_s = {duration}; nothing would be measured, begin sooner"
        faults.append(fault("measurements.start_s", start, problem))
    return faults + _interval_faults(measured, "measurements.interval_s", entry)


def _interval_faults(measured: dict[str, Any], field: str, entry: object) -> list[str]:
    """A given interval that is no whole number of the steps at which anything can be measured."""
    step: Any = entry.get("step_s", 1.0) if isinstance(entry, dict) else 1.0
    interval: Any = measured.get("interval_s", step)
    if not all(isinstance(t, int | float) and 0 < t < math.inf for t in (step, interval)):
        return []  # the model says what is wrong with them
    steps = max(1, round(interval / step))
    if abs(interval - steps * step) <= 1e-6:
        return []
    problem = f"must be a whole number of entry.step_s = {step:g}; the nearest is {steps * step:g}"
    return [fault(field, interval, problem)]


def _bank_faults(bank: object) -> list[str]:
    if not isinstance(bank, list):
        return []
    if not bank:
        return ["vehicle.bank_deg = []: must have at least one [time, angle] pair"]
    if not _rises(bank):
        return [fault("vehicle.bank_deg", bank, "times must increase strictly; put them in order")]
    return []


def _name_faults(raw: dict[str, Any]) -> list[str]:
    faults, names = [], set()
    for kind in ("beacon", "orbiter", "feature"):
        what = "feature" if kind == "feature" else "beacon"
        for k, table in enumerate(tables_in(raw, kind), start=1):
            name = table.get("name")
            if not isinstance(name, str):
                continue
            if name in names:
                used = f"used twice; give each {what} its own name"
                faults.append(fault(f"{kind}[{k}].name", name, used))
            names.add(name)
    return faults
