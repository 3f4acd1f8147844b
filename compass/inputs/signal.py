"""The table ``[signal]`` of a design: read, checked, and turned into a `Signal`."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, GetJsonSchemaHandler, Tag, field_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from compass.clocks import PARAMETERS, Clock, clock_named
from compass.errors import ArgumentError
from compass.frames import HOUR
from compass.inputs.faults import fault, satellites_given
from compass.inputs.table import Table
from compass.ranging import MAS, Receiver, Signal

Sigma = Annotated[float, Field(ge=0, le=1e9)]
Three = Annotated[list[Sigma], Field(min_length=3, max_length=3)]
#: Three sigmas, or the word; what was written says which was meant, so that a fault is told once.
Orbits = Annotated[
    Annotated[Three, Tag("numbers")] | Annotated[Literal["determined"], Tag("word")],
    Discriminator(lambda given: "word" if isinstance(given, str) else "numbers"),
]
Row = Annotated[list[float], Field(min_length=4, max_length=4)]
FourByFour = Annotated[list[Row], Field(min_length=4, max_length=4)]


class ClockTable(Table):
    """A clock: of a name with some numbers changed, or of its numbers alone."""

    name: str | None = Field(None, min_length=1, description="a clock to start from")
    white: float | None = Field(None, ge=0, lt=1, description="white noise: deviation at 1 s")
    flicker: float | None = Field(None, ge=0, lt=1, description="floor of the deviation")
    walk: float | None = Field(None, ge=0, lt=1, description="random walk: deviation at 1 s")
    drift_per_day: float | None = Field(
        None, ge=0, lt=1, description="relative change of frequency a day that is left in"
    )
    frequency_sigma: float | None = Field(
        None, ge=0, lt=1, description="relative error of the frequency at upload, 1 sigma"
    )

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Schema of the table, and of the name that may be written instead of it."""
        table = handler.resolve_ref_schema(handler(core))
        name = {"type": "string", "minLength": 1}
        return {"anyOf": [table, name], "description": table["description"]}


class CommonTable(Table):
    """Errors that all satellites share."""

    time: Sigma = Field(0.0, description="of the constellation's time, m, 1 sigma")
    orientation_mas: Sigma = Field(
        0.0, description="of Mars's orientation about each axis, milliarcseconds, 1 sigma"
    )


class ReceiverTable(Table):
    """Noise of a user's receiver."""

    noise_m: Sigma = Field(0.0, description="part that does not change, m, 1 sigma")
    zenith_m: Sigma = Field(0.0, description="part that grows as 1/sin(elevation), m, 1 sigma")
    chip_m: Sigma = Field(0.0, description="chip length, m, for a code loop on the link's C/N0")
    loop_hz: float = Field(1.0, gt=0, le=1e6, description="loop bandwidth, Hz")
    spacing: float = Field(1.0, gt=0, lt=2, description="early to late, chips, 0 to 2")
    integration_s: float = Field(0.02, gt=0, le=1e3, description="before the detector, s")


class SignalTable(Table):
    """What a user's ranges are worth."""

    frequency_mhz: float = Field(2200.0, gt=0, le=1e6, description="carrier, MHz")
    clock: ClockTable | None = Field(None, description="name of a clock, or a table of its numbers")
    clock_m: Sigma | None = Field(
        None, description="clock error at upload, m, 1 sigma; does not grow"
    )
    update_h: float = Field(
        0.0, ge=0, le=1e5, description="hours between uploads of orbits and clocks"
    )
    age: Literal["mean", "worst"] = Field(
        "mean", description="mean over the data's ages, or the oldest"
    )
    ephemeris_m: Orbits | None = Field(
        None,
        description="radial, along, cross at upload, m, 1 sigma; or determined: as [tracking] "
        "implies, for compass determine to write",
    )
    ephemeris_rate_m_h: Three | None = Field(
        None, description="growth of radial, along, cross, m an hour"
    )
    covariance_m2: list[FourByFour] | None = Field(
        None,
        min_length=1,
        max_length=10_000,
        description="radial, along, cross, clock at upload, m^2: 4 by 4, or one each",
    )
    common_m: CommonTable = Field(
        default_factory=lambda: CommonTable.model_validate({}),
        description="errors that all satellites share",
    )
    receiver: ReceiverTable = Field(description="a user's receiver")
    ionosphere_tec: Sigma = Field(0.0, description="vertical content below the Sun, TECU")
    dual: bool = Field(False, description="whether two frequencies remove the ionosphere")

    @field_validator("clock", mode="before")
    @classmethod
    def _named(cls, given: Any) -> Any:
        return {"name": given} if isinstance(given, str) else given

    @field_validator("covariance_m2", mode="before")
    @classmethod
    def _one_for_all(cls, given: Any) -> Any:
        return [given] if _depth(given) == 2 else given


def _depth(given: Any) -> int:
    """How many lists stand in each other, by their first entries."""
    return 1 + _depth(given[0]) if isinstance(given, list) and given else 0


def signal_of_table(table: SignalTable) -> Signal:
    """Signal of a design's table, in SI."""
    determined = table.ephemeris_m == "determined"
    given = None if isinstance(table.ephemeris_m, str) else table.ephemeris_m
    radial, along, cross = given or (0.0, 0.0, 0.0)
    rates = [rate / HOUR for rate in table.ephemeris_rate_m_h or (0.0, 0.0, 0.0)]
    receiver = table.receiver
    return Signal(
        frequency=table.frequency_mhz * 1e6,
        clock=_clock(table.clock),
        clock_sigma=table.clock_m or 0.0,
        update=table.update_h * HOUR,
        age=table.age,
        ephemeris=(radial, along, cross),
        ephemeris_rate=(rates[0], rates[1], rates[2]),
        covariance=tuple(
            tuple(tuple(row) for row in matrix) for matrix in table.covariance_m2 or []
        ),
        determined=determined,
        common_time=table.common_m.time,
        common_orientation=table.common_m.orientation_mas * MAS,
        receiver=Receiver(
            noise=receiver.noise_m,
            zenith=receiver.zenith_m,
            chip=receiver.chip_m,
            bandwidth=receiver.loop_hz,
            spacing=receiver.spacing,
            integration=receiver.integration_s,
        ),
        ionosphere=table.ionosphere_tec,
        dual=table.dual,
    )


def _clock(given: ClockTable | None) -> Clock | None:
    if given is None:
        return None
    numbers = given.model_dump(exclude_none=True)
    name = numbers.pop("name", None)
    return Clock(**numbers) if name is None else clock_named(name, **numbers)


def signal_faults(raw: dict[str, Any]) -> list[str]:
    """Faults between fields of ``[signal]``, found on the raw tables, whatever is in them."""
    table = raw.get("signal")
    if not isinstance(table, dict):
        return []
    faults = _clock_faults(table)
    if not {"ephemeris_m", "covariance_m2"} & set(table):
        faults.append(
            "signal.ephemeris_m: missing; give radial, along and cross sigmas, or covariance_m2"
        )
    for key in ("ephemeris_m", "clock_m"):
        if "covariance_m2" in table and key in table:
            faults.append(
                fault(f"signal.{key}", table[key], "covariance_m2 says the same; keep one of them")
            )
    if table.get("ephemeris_m") == "determined":
        remedy = "nobody tracks; add a table [tracking]"
        if "study" in raw:
            remedy = "follows from tracking, which a study has none of; give numbers"
        if "tracking" not in raw:
            faults.append(fault("signal.ephemeris_m", "determined", remedy))
        faults += [
            fault(f"signal.{key}", table[key], "follows from what is determined; leave it out")
            for key in ("clock_m", "ephemeris_rate_m_h")
            if key in table
        ]
    if table.get("receiver") == {}:
        faults.append("signal.receiver: is empty; give noise_m, zenith_m or chip_m")
    if "update_h" not in table:
        faults += [
            fault(f"signal.{key}", table[key], "counts with data that age only; add update_h")
            for key in ("age", "clock", "ephemeris_rate_m_h")
            if key in table
        ]
    receiver = table.get("receiver")
    if isinstance(receiver, dict) and "chip_m" not in receiver:
        faults += [
            fault(f"signal.receiver.{key}", receiver[key], "is of a code loop; add chip_m")
            for key in ("loop_hz", "spacing", "integration_s")
            if key in receiver
        ]
    faults += _loop_faults(raw, receiver)
    return faults + _covariance_faults(raw, table)


def _loop_faults(raw: dict[str, Any], receiver: object) -> list[str]:
    if not isinstance(receiver, dict) or not receiver.get("chip_m"):
        return []
    links = raw.get("link")
    ends = (
        [link.get("between") for link in links if isinstance(link, dict)]
        if (isinstance(links, list))
        else []
    )
    if any(isinstance(end, list) and {*map(str, end)} == {"station", "satellite"} for end in ends):
        return []
    return [
        fault(
            "signal.receiver.chip_m",
            receiver["chip_m"],
            'noise from C/N0 needs its link; add a [[link]] between ["satellite", "station"], '
            "or give noise_m",
        )
    ]


def _clock_faults(table: dict[str, Any]) -> list[str]:
    given = table.get("clock")
    if given is None:
        told = {"clock_m", "covariance_m2"} & set(table)
        if told or table.get("ephemeris_m") == "determined":
            return []
        return ["signal.clock: missing; name one, or give clock_m"]
    if isinstance(given, dict) and not {*PARAMETERS, "name"} & set(given):
        return [
            fault("signal.clock", given, f"has neither a name nor numbers: {', '.join(PARAMETERS)}")
        ]
    try:
        if isinstance(given, str):
            clock_named(given)
        elif isinstance(given, dict) and isinstance(given.get("name"), str):
            clock_named(given["name"])
        elif isinstance(given, dict) and not any(given.get(key) for key in PARAMETERS):
            return [fault("signal.clock", given, "all its numbers are 0; give one above")]
    except ArgumentError as error:
        return [f"signal.{error}"]
    return []


def _covariance_faults(raw: dict[str, Any], table: dict[str, Any]) -> list[str]:
    """Faults of covariances, as far as they have the right form, which the model checks."""
    given = table.get("covariance_m2")
    if not isinstance(given, list) or not given:
        return []
    try:
        one = [given] if _depth(given) == 2 else given
        matrices = tuple(tuple(tuple(map(float, row)) for row in matrix) for matrix in one)
        Signal(covariance=matrices)
    except ArgumentError as error:
        return [f"signal.{error}"]
    except (TypeError, IndexError, KeyError, ValueError):
        return []
    count = satellites_given(raw)
    if count is not None and len(matrices) not in (1, count):
        return [
            f"signal.covariance_m2: {len(matrices)} matrices for {count} satellites; give one for "
            "all, or one each"
        ]
    return []
