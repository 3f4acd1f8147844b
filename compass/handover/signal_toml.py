"""The table ``[signal]`` of a design, written so that reading it gives the same one back."""

from collections.abc import Sequence
from dataclasses import fields

from compass.clocks import CLOCKS, PARAMETERS, Clock
from compass.frames import HOUR
from compass.handover.decimals import decimal, number
from compass.inputs.toml_values import toml_text
from compass.ranging import MAS, Matrix, Receiver, Signal

_PLAIN = Signal()


def signal_lines(signal: Signal) -> list[str]:
    """Lines of a table ``[signal]``."""
    lines = ["[signal]"]
    if signal.frequency != _PLAIN.frequency:
        mhz = decimal(signal.frequency / 1e6, lambda x: x * 1e6, signal.frequency)
        lines.append(f"frequency_mhz = {mhz}")
    if signal.clock is not None:
        lines.append(f"clock = {_clock(signal.clock)}")
    told = signal.covariance or signal.determined
    if not told and (signal.clock_sigma or signal.clock is None):
        lines.append(f"clock_m = {number(signal.clock_sigma)}")
    ages = signal.clock is not None or any(signal.ephemeris_rate) or signal.age != "mean"
    if signal.update or ages:
        lines.append(f"update_h = {_per_hour(signal.update)}")
    if signal.age != "mean":
        lines.append(f"age = {toml_text(signal.age)}")
    if signal.covariance:
        lines.append(f"covariance_m2 = {_covariance(signal.covariance)}")
    elif signal.determined:
        lines.append('ephemeris_m = "determined"')
    else:
        lines.append(f"ephemeris_m = {_list([number(x) for x in signal.ephemeris])}")
    if any(signal.ephemeris_rate):
        rates = [decimal(x * HOUR, lambda y: y / HOUR, x) for x in signal.ephemeris_rate]
        lines.append(f"ephemeris_rate_m_h = {_list(rates)}")
    if signal.common_time or signal.common_orientation:
        mas = decimal(signal.common_orientation / MAS, lambda x: x * MAS, signal.common_orientation)
        lines.append(
            f"common_m = {{ time = {number(signal.common_time)}, orientation_mas = {mas} }}"
        )
    lines.append(f"receiver = {_receiver(signal.receiver)}")
    if signal.ionosphere:
        lines.append(f"ionosphere_tec = {number(signal.ionosphere)}")
    if signal.dual:
        lines.append("dual = true")
    return lines


def text_with_signal(text: str, signal: Signal) -> str:
    """Text of a design file with its table ``[signal]`` replaced; everything else as it stands."""
    kept: list[str] = []
    inside = False
    for line in text.splitlines():
        if line.lstrip().startswith("["):
            inside = line.lstrip().startswith(("[signal]", "[signal."))
        if not inside:
            kept.append(line)
    return "\n".join(["\n".join(kept).rstrip(), "", *signal_lines(signal), ""])


def _clock(clock: Clock) -> str:
    if clock in CLOCKS:
        return toml_text(clock.name)
    for known in CLOCKS:
        if known.name == clock.name:
            changed = [p for p in PARAMETERS if getattr(clock, p) != getattr(known, p)]
            return _table({"name": toml_text(clock.name)} | _numbers(clock, changed))
    return _table(_numbers(clock, [p for p in PARAMETERS if getattr(clock, p)]))


def _numbers(clock: Clock, names: Sequence[str]) -> dict[str, str]:
    return {name: number(getattr(clock, name)) for name in names}


def _receiver(receiver: Receiver) -> str:
    keys = {"noise": "noise_m", "zenith": "zenith_m", "chip": "chip_m", "bandwidth": "loop_hz"}
    keys |= {"spacing": "spacing", "integration": "integration_s"}
    plain = Receiver()
    told = {
        keys[f.name]: number(getattr(receiver, f.name))
        for f in fields(receiver)
        if f.name == "noise" or getattr(receiver, f.name) != getattr(plain, f.name)
    }
    return _table(told)


def _table(pairs: dict[str, str]) -> str:
    return "{ " + ", ".join(f"{key} = {value}" for key, value in pairs.items()) + " }"


def _list(values: Sequence[str]) -> str:
    return f"[{', '.join(values)}]"


def _covariance(matrices: Sequence[Matrix]) -> str:
    written = [_list([_list([number(x) for x in row]) for row in m]) for m in matrices]
    return written[0] if len(written) == 1 else _list(written)


def _per_hour(seconds: float) -> str:
    return decimal(seconds / HOUR, lambda hours: hours * HOUR, seconds)
