"""What a scenario file may say of measurements beside one-way radio, and how it is read."""

from math import inf, radians
from typing import Annotated, Any, Literal

from pydantic import Field

from compass.entry.instruments import Features, Instrument
from compass.entry.link import Link
from compass.entry.radio import STAGNATION, WAKE
from compass.inputs.table import Table
from compass.links import Radio
from compass.ranging import Receiver

Positive = Annotated[float, Field(gt=0, le=1e15)]
Share = Annotated[float, Field(ge=0, le=1)]
Below = Annotated[
    Annotated[float, Field(gt=0, le=1e4)] | None,
    Field(description="altitude from which on it works, km; always if left out"),
]


class TwoWayTable(Table):
    """Radio to the beacons and back: no clock of the lander enters."""

    range_sigma_m: Positive | None = Field(None, description="one sigma of ranges, m")
    range_rate_sigma_m_s: Positive | None = Field(None, description="one sigma of range rates, m/s")


class LinkTable(Table):
    """Radio from the beacons, whose C/N0 makes the noise of ranges, beside range_sigma_m if given.

    Without any other radio it is of ranges one way.
    """

    frequency_mhz: Annotated[float, Field(ge=1, le=1e6)] = Field(description="carrier, MHz")
    eirp_dbw: Annotated[float, Field(ge=-100, le=100)] = Field(
        description="radiated power of a beacon towards the lander, dBW"
    )
    g_over_t_db_k: Annotated[float, Field(ge=-100, le=100)] = Field(
        description="the lander's figure of merit along its antenna's axis, dB/K"
    )
    required_db_hz: Annotated[float, Field(ge=-50, le=150)] = Field(
        description="C/N0 below which nothing is measured, dB Hz"
    )
    chip_m: Positive = Field(description="chip length of the code, m")
    loop_hz: Positive = Field(1.0, description="bandwidth of the code loop, Hz")
    spacing: Annotated[float, Field(gt=0, lt=2)] = Field(
        1.0, description="early to late, chips, 0 to 2"
    )
    integration_s: Positive = Field(0.02, description="before the detector, s")
    beamwidth_deg: Annotated[float, Field(gt=0, lt=180)] | None = Field(
        None,
        description="full width at half power of the lander's antenna, degrees; alike in all "
        "directions if left out",
    )
    antenna: Literal["aft", "zenith"] = Field(
        "aft", description="where its axis points: against the velocity, or up"
    )
    electrons: Literal["none", "wake", "stagnation"] = Field(
        "none", description="plasma that signals cross, fitted to one trajectory"
    )
    plasma_m: Annotated[float, Field(ge=0, le=100)] = Field(1.0, description="how thick it is, m")


class AltimeterTable(Table):
    """The lander's altimeter, whose noise counts what terrain is not known."""

    sigma_m: Positive = Field(description="one sigma, m")
    share: Share = Field(0.0, description="one sigma more, as a share of the height")
    below_km: Below = None
    interval_s: Positive = Field(1.0, description="time between readings, s")


class VelocimeterTable(Table):
    """The lander's velocimeter: three axes of its velocity over the ground."""

    sigma_m_s: Positive = Field(description="one sigma of each axis, m/s")
    share: Share = Field(0.0, description="one sigma more, as a share of the speed")
    below_km: Below = None
    interval_s: Positive = Field(1.0, description="time between readings, s")


class FeaturesTable(Table):
    """The lander's camera, which knows features of the surface, one [[feature]] each."""

    sigma_deg: Annotated[float, Field(gt=0, le=10)] = Field(
        description="one sigma of a direction to each side, degrees"
    )
    below_km: Below = None
    interval_s: Positive = Field(1.0, description="time between pictures, s")


class AccelerometersTable(Table):
    """The lander's accelerometers, which feel drag and lift but no gravity."""

    sigma_m_s2: Annotated[float, Field(gt=0, le=10)] = Field(
        description="one sigma of a reading of each axis, m/s^2"
    )
    interval_s: Positive = Field(1.0, description="time between readings, s")


class FeatureTable(Table):
    """A feature of the surface that the lander knows by sight."""

    name: str = Field(min_length=1, description="what to call the feature")
    latitude_deg: Annotated[float, Field(ge=-90, le=90)] = Field(
        description="planetocentric latitude, degrees"
    )
    longitude_deg: Annotated[float, Field(ge=-180, le=360)] = Field(
        description="east longitude, degrees"
    )
    height_km: Annotated[float, Field(ge=-20, le=100)] = Field(
        0.0, description="height over the planet's sphere, km"
    )


def features_of(tables: list[FeatureTable]) -> Features:
    """Features of the surface, as given."""
    return Features(
        tuple(table.name for table in tables),
        tuple(radians(table.latitude_deg) for table in tables),
        tuple(radians(table.longitude_deg) for table in tables),
        tuple(1e3 * table.height_km for table in tables),
    )


def link_of(table: LinkTable | None) -> Link | None:
    """Radio link, as given."""
    if table is None:
        return None
    plasma = {"none": None, "wake": WAKE, "stagnation": STAGNATION}[table.electrons]
    return Link(
        Radio(
            ("satellite", "station"),
            1e6 * table.frequency_mhz,
            table.eirp_dbw,
            table.g_over_t_db_k,
            table.required_db_hz,
        ),
        Receiver(
            chip=table.chip_m,
            bandwidth=table.loop_hz,
            spacing=table.spacing,
            integration=table.integration_s,
        ),
        inf if table.beamwidth_deg is None else radians(table.beamwidth_deg),
        table.antenna,
        plasma,
        table.plasma_m,
    )


def instruments_of(
    two_way: TwoWayTable | None,
    altimeter: AltimeterTable | None,
    velocimeter: VelocimeterTable | None,
    features: FeaturesTable | None,
    accelerometers: AccelerometersTable | None,
) -> tuple[Instrument, ...]:
    """Instruments, as given."""
    instruments = []
    if two_way is not None and two_way.range_sigma_m is not None:
        instruments.append(Instrument("two_way_range", two_way.range_sigma_m))
    if two_way is not None and two_way.range_rate_sigma_m_s is not None:
        instruments.append(Instrument("two_way_rate", two_way.range_rate_sigma_m_s))
    for kind, table in (
        ("altimeter", altimeter),
        ("velocimeter", velocimeter),
        ("features", features),
    ):
        if table is not None:
            below = inf if table.below_km is None else 1e3 * table.below_km
            instruments.append(Instrument(kind, *_sigmas(table), below, table.interval_s))
    if (felt := accelerometers) is not None:
        instruments.append(Instrument("accelerometers", felt.sigma_m_s2, interval=felt.interval_s))
    return tuple(instruments)


def _sigmas(table: AltimeterTable | VelocimeterTable | FeaturesTable) -> tuple[float, float]:
    """Sigma of a reading, and what it grows by with height or speed."""
    if isinstance(table, FeaturesTable):
        return radians(table.sigma_deg), 0.0
    if isinstance(table, VelocimeterTable):
        return table.sigma_m_s, table.share
    return table.sigma_m, table.share


def instrument_faults(raw: dict[str, Any], interval_faults: Any) -> list[str]:
    """Faults between fields of the tables above; `interval_faults` knows the time step."""
    measured, faults = raw.get("measurements"), []
    if not isinstance(measured, dict):
        return []
    two_way = measured.get("two_way")
    if isinstance(two_way, dict) and not two_way:
        faults.append("measurements.two_way: needs range_sigma_m, range_rate_sigma_m_s or both")
    for name in ("altimeter", "velocimeter", "features", "accelerometers"):
        if isinstance(table := measured.get(name), dict):
            faults += interval_faults(table, f"measurements.{name}.interval_s")
    if "accelerometers" in measured and "fusion" in raw:
        faults.append(
            "measurements.accelerometers: not beside [fusion], whose filters have their own; leave "
            "it out and give fusion.acceleration_sigma_m_s2"
        )
    if "features" in measured and not raw.get("feature"):
        faults.append("feature: missing; measurements.features needs at least one [[feature]]")
    if raw.get("feature") and "features" not in measured:
        faults.append(
            "measurements.features: missing; needed beside [[feature]], to say how well they are "
            "seen"
        )
    return faults
