"""``[signal]`` in design files: read, written again, and every fault said."""

from dataclasses import replace

import numpy as np
import pytest

import compass
from compass.errors import ArgumentError, DesignError
from compass.handover.toml import design_toml
from compass.inputs import read_design_text
from compass.quantities import QUANTITIES

DESIGN = """
name = "three"
[constellation]
pattern = "walker-delta"
satellites = 3
planes = 3
phasing = 1
inclination_deg = 45
radius_km = 20427
{more}
[signal]
{text}
"""
GIVEN = "ephemeris_m = [2, 8, 5]\nreceiver = { noise_m = 0.5 }\n"
EYE = np.eye(4).tolist()


def signal(text, more=""):
    return read_design_text(DESIGN.format(text=text, more=more)).signal


def test_there_is_none_unless_said():
    assert read_design_text(DESIGN.split("[signal]")[0].format(more="")).signal is None


EVERY_KEY = """
frequency_mhz = 400
clock = { name = "rafs", drift_per_day = 1e-13 }
clock_m = 0.3
update_h = 6
age = "worst"
ephemeris_m = [2, 8, 5]
ephemeris_rate_m_h = [0.1, 0.5, 0.2]
common_m = { time = 1, orientation_mas = 10 }
receiver = { noise_m = 0.5, zenith_m = 0.6, chip_m = 300, loop_hz = 2, spacing = 0.5, integration_s = 0.01 }
ionosphere_tec = 1.5
dual = true
"""
LINK = """[[link]]
between = ["satellite", "station"]
frequency_mhz = 400
eirp_dbw = 10
g_over_t_db_per_k = -20
"""


def test_every_key_reaches_the_signal():
    made = signal(EVERY_KEY, LINK)
    assert (made.frequency, made.update, made.age, made.dual) == (4e8, 21600, "worst", True)
    assert (made.clock.white, made.clock.drift_per_day) == (1.9e-12, 1e-13)
    assert made.ephemeris_rate == pytest.approx((0.1 / 3600, 0.5 / 3600, 0.2 / 3600))
    assert made.common_orientation == pytest.approx(np.radians(10 / 3600e3))
    assert (made.receiver.chip, made.receiver.bandwidth, made.receiver.spacing) == (300, 2, 0.5)
    assert (made.common_time, made.clock_sigma, made.ionosphere) == (1, 0.3, 1.5)


@pytest.mark.parametrize(
    "text",
    [
        GIVEN + "clock_m = 3",
        GIVEN + 'clock = "dsac"\nupdate_h = 24',
        GIVEN + "clock = { white = 1e-12, walk = 1e-17 }\nupdate_h = 0",
        f"covariance_m2 = {EYE}\nreceiver = {{ zenith_m = 1 }}",
        f"covariance_m2 = {[EYE] * 3}\nreceiver = {{ zenith_m = 1 }}",
    ],
)
def test_what_is_written_reads_the_same(text):
    made = read_design_text(DESIGN.format(text=text, more=""))
    assert read_design_text(design_toml(made)).signal == made.signal


def test_every_key_is_written_again():
    made = signal(EVERY_KEY, LINK)
    from compass.handover.signal_toml import signal_lines

    again = "\n".join(signal_lines(made)[1:])
    assert signal(again, LINK) == made


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"signal.receiver: missing; a user's receiver"),
        (GIVEN, "signal.clock: missing; name one, or give clock_m"),
        (GIVEN + "clock = {}\nupdate_h = 1", "has neither a name nor numbers: white, flicker"),
        (GIVEN + 'clock = "raf"\nupdate_h = 1', "signal.clock = 'raf': not known; did you mean"),
        (GIVEN + 'clock = { name = "raf" }\nupdate_h = 1', "did you mean rafs"),
        (GIVEN + "clock = { white = 0.0 }\nupdate_h = 1", "all its numbers are 0"),
        (GIVEN + "clock = { white = -1e-12 }\nupdate_h = 1", "white = -1e-12: must be at least 0"),
        (GIVEN + 'clock = "rafs"', "signal.clock = 'rafs': counts with data that age"),
        (GIVEN + "clock_m = -3", "signal.clock_m = -3: must be at least 0"),
        (GIVEN.replace("8", "-8") + "clock_m = 3", r"ephemeris_m\[2\] = -8: must be at least 0"),
        (GIVEN.replace("8, ", "") + "clock_m = 3", "ephemeris_m = .*: must have at least 3 values"),
        (GIVEN.split("\n")[1] + "\nclock_m = 3", "signal.ephemeris_m: missing; give radial"),
        (GIVEN.replace("[2, 8, 5]", '"determined"') + "clock_m = 3", "signal.ephemeris_m = "),
        (GIVEN.replace("{ noise_m = 0.5 }", "{}") + "clock_m = 3", "signal.receiver: is empty"),
        (GIVEN.replace("noise_m = 0.5", "loop_hz = 1") + "clock_m = 3", "is of a code loop"),
        (GIVEN.replace("noise_m = 0.5", "chip_m = 300") + "clock_m = 3", r"add a \[\[link\]\]"),
        (GIVEN + f"clock_m = 3\ncovariance_m2 = {EYE}", "covariance_m2 says the same; keep one"),
        (GIVEN + "clock_m = 3\nclok = 1", "signal.clok = 1: unknown key; did you mean .clock"),
        (
            f"receiver = {{ noise_m = 1 }}\ncovariance_m2 = {[EYE] * 2}",
            "2 matrices for 3 satellites",
        ),
        (
            f"receiver = {{ noise_m = 1 }}\ncovariance_m2 = {(-np.eye(4)).tolist()}",
            "is no covariance",
        ),
        ("receiver = { noise_m = 1 }\ncovariance_m2 = [[1]]", "covariance_m2"),
    ],
)
def test_a_wrong_table_gets_a_message(text, message):
    with pytest.raises(DesignError, match=message):
        signal(text)


def test_show_tells_the_budget(tmp_path):
    path = tmp_path / "d.toml"
    path.write_text(DESIGN.format(text=GIVEN + 'clock = "csac"\nupdate_h = 6', more=""))
    found = compass.show(path)
    told = found.to_dict()["signal"]
    assert set(told) - {"by_age"} <= set(QUANTITIES)
    budget = np.array([told[f"{t}_error_m"] for t in ("clock", "orbit", "receiver", "ionosphere")])
    assert np.sqrt((budget**2).sum(axis=0)) == pytest.approx(told["range_error_m"])
    assert told["by_age"]["age_h"] == [0, 3, 6]
    assert "Budget of a range" in str(found) and "Range error by age" in str(found)


TRACKED = "[tracking]\nearth = { range_m = 1, time_m = 1 }\n"
DETERMINED = 'ephemeris_m = "determined"\nreceiver = { noise_m = 0.5 }\n'


@pytest.mark.parametrize(("between", "told"), [(0.0, False), (-0.9, True)])
def test_show_tells_what_clocks_and_orbits_have_in_common(tmp_path, between, told):
    """Fixes project all of the covariance on each line; the rows of `show` are terms apart."""
    matrix = np.eye(4)
    matrix[0, 3] = matrix[3, 0] = between
    text = f"receiver = {{ noise_m = 1 }}\ncovariance_m2 = {matrix.tolist()}"
    (path := tmp_path / "d.toml").write_text(DESIGN.format(text=text, more=""))
    said = " ".join(str(compass.show(path)).split())
    assert ("what clocks and orbits have in common counts in fixes, not here" in said) is told


def test_orbit_errors_may_be_those_that_tracking_implies():
    """Signals do not guess; commands work it out, as `compass determine` does."""
    read = read_design_text(DESIGN.format(text=DETERMINED, more=TRACKED))
    assert read.signal.determined
    assert read_design_text(design_toml(read)).signal == read.signal
    with pytest.raises(ArgumentError, match="compass determine DESIGN -o NEW"):
        read.signal.of_satellites(read.constellation.size)
    short = replace(read, tracking=replace(read.tracking, duration=7200.0), text="")
    worked = compass.determine(short).signal
    assert not worked.determined
    shown = compass.show(short)
    assert shown.design.signal == replace(worked, determined=True)
    assert "as tracking by Earth leaves them" in " ".join(str(shown).split())


@pytest.mark.parametrize(
    ("text", "more", "said"),
    [
        (DETERMINED, "", "'determined': nobody tracks; add a table [tracking]"),
        (DETERMINED + "clock_m = 1\n", TRACKED, "signal.clock_m = 1: follows from what is"),
        (
            DETERMINED.replace("determined", "guessed") + "clock_m = 1\n",
            TRACKED,
            "'guessed': allowed: 'determined'",
        ),
    ],
)
def test_what_cannot_be_determined_is_refused(text, more, said):
    with pytest.raises(DesignError) as refused:
        read_design_text(DESIGN.format(text=text, more=more))
    assert said in str(refused.value)
    assert str(refused.value).count("\n") == 0
