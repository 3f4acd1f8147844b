"""``[motion]`` and ephemerides in design files."""

from datetime import datetime, timedelta

import numpy as np
import pytest

from compass.errors import DesignError
from compass.frames import SECONDS_PER_DAY as DAY
from compass.frames import seconds_past_j2000
from compass.handover.design_tables import not_kept
from compass.handover.oem import oem
from compass.handover.toml import design_toml
from compass.inputs import read_design, read_design_text
from compass.inputs.oem import read_oem
from compass.orbits import states_mci
from tests.orbits.test_gravity import SHADR

DESIGN = """
name = "three"
epoch = 2030-01-01T12:00:00
[constellation]
pattern = "walker-delta"
satellites = 3
planes = 3
phasing = 1
inclination_deg = 45
radius_km = 20000
"""


def with_motion(text):
    return read_design_text(f"{DESIGN}\n[motion]\n{text}").motion


def test_motion_is_two_body_unless_said():
    assert read_design_text(DESIGN).motion.model == "two-body"
    assert with_motion('model = "j2"').model == "j2"


def test_every_key_of_the_table_reaches_the_forces():
    motion = with_motion(
        'model = "numerical"\ngravity_degree = 5\nsun = false\nmoons = false\n'
        'radiation_m2_kg = 0.01\nshadow = "cone"'
    )
    f = motion.forces
    assert (f.field.degree, f.sun, f.moons, f.radiation, f.shadow) == (
        5,
        False,
        False,
        0.01,
        "cone",
    )
    default = with_motion('model = "numerical"').forces
    assert (default.field.degree, default.sun, default.moons) == (8, True, True)
    assert (default.radiation, default.shadow) == (0.026, "cylinder")


def test_a_gravity_file_stands_beside_the_design(tmp_path):
    (tmp_path / "x.tab").write_text(SHADR)
    (tmp_path / "d.toml").write_text(
        DESIGN + '[motion]\nmodel = "numerical"\ngravity_file = "x.tab"\ngravity_frame = "iau-1991"'
    )
    with pytest.raises(DesignError, match=r"gravity_degree: 8 if left out: allowed 2 to 3.*x\.tab"):
        read_design(tmp_path / "d.toml")
    with (tmp_path / "d.toml").open("a") as file:
        file.write("\ngravity_degree = 3")
    design = read_design(tmp_path / "d.toml")
    field = design.motion.forces.field
    assert (field.name, field.degree) == ("x.tab", 3)
    assert np.degrees(field.meridian) == pytest.approx(-0.238)
    # a design written anew, elsewhere, names the same file
    assert read_design_text(design_toml(design)).motion == design.motion
    assert not_kept(design) == ()


def test_motions_compare_by_value():
    one, two = (with_motion('model = "numerical"') for _ in range(2))
    assert (one == two) and hash(one) == hash(two)
    assert one != with_motion('model = "numerical"\ngravity_degree = 7')
    paths = [one.trajectory(read_design_text(DESIGN).constellation, 0.0, 1e4) for _ in range(2)]
    assert paths[0] == paths[1] and hash(paths[0]) == hash(paths[1])
    assert paths[0] != one


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('model = "numeric"', "motion.model = 'numeric': allowed"),
        ('model = "numerical"\ngravity_degree = 21', "gravity_degree = 21: allowed 2 to 20"),
        ('model = "numerical"\ngravity_degree = 1', "gravity_degree = 1: must be at least 2"),
        ("sun = true", 'motion.sun = true: counts with model = "numerical" only'),
        ('model = "numerical"\ngravity_frame = "iau-2000"', "is of a gravity_file; add it"),
        ('model = "numerical"\ngravity_file = "no.gfc"', "motion.gravity_frame: missing"),
        (
            'model = "numerical"\ngravity_file = "no.gfc"\ngravity_frame = "iau-2000"',
            r"no\.gfc: cannot be read",
        ),
        ('model = "numerical"\nradiation_m2_kg = -1', "radiation_m2_kg = -1: must be at least 0"),
        ('model = "numerical"\ndrag = true', "motion.drag = true: unknown key"),
    ],
)
def test_a_wrong_table_gets_one_message(text, message):
    with pytest.raises(DesignError, match=message):
        with_motion(text)


# ---- ephemerides ----

EPOCH = seconds_past_j2000(datetime(2030, 1, 1, 12))


def write_oem(folder, step=600.0, days=0.5, names=3):
    design = read_design_text(DESIGN)
    times = np.arange(0.0, days * DAY + 1.0, step)
    for name, text in list(oem(design, times).items())[:names]:
        (folder / name).write_text(text)
    return design


def by_files(folder, more=""):
    path = folder / "d.toml"
    path.write_text(
        f'name = "files"\n{more}\n[constellation]\npattern = "ephemeris"\nfiles = ["*.oem"]'
    )
    return read_design(path)


def test_what_was_written_is_read_again(tmp_path):
    """Positions are written to a millimetre, velocities to a micrometre a second."""
    written = write_oem(tmp_path)
    read = by_files(tmp_path)
    assert read.motion.model == "ephemeris"
    assert read.constellation.epoch == pytest.approx(EPOCH, abs=1e-5)
    assert set(read.constellation.satellite_names) == {"P1S1", "P2S1", "P3S1"}
    times = np.linspace(0, 0.5 * DAY, 101)
    here, speed = read.motion.states(read.constellation, times)
    there, pace = states_mci(written.constellation, times)
    # the epoch's microseconds: dates are written to them, at 1.4 km/s
    assert np.linalg.norm(here - there, axis=-1).max() < 0.01
    assert np.abs(speed - pace).max() < 1e-4
    assert read.motion.table.errors.max() < 0.5
    assert "leaving out every other" in read.motion.table.estimated


def test_the_estimated_error_covers_the_true_one(tmp_path):
    written = write_oem(tmp_path, step=5400.0, days=1.0)
    path = by_files(tmp_path).motion.table
    times = np.linspace(0, 1.0 * DAY, 501)
    miss = np.linalg.norm(
        path.states(times)[0] - states_mci(written.constellation, times)[0], axis=-1
    )
    assert 0.02 < miss.max() < path.errors.max()


def test_an_epoch_may_be_chosen_inside(tmp_path):
    write_oem(tmp_path)
    read = by_files(tmp_path, "epoch = 2030-01-01T15:00:00")
    path = read.motion.table
    assert (path.start, path.stop) == (pytest.approx(-3 * 3600), pytest.approx(9 * 3600))
    with pytest.raises(DesignError, match="days after the first moment that all files cover"):
        by_files(tmp_path, "epoch = 2031-01-01T15:00:00")


def change(folder, old, new, which=0):
    path = sorted(folder.glob("*.oem"))[which]
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    return path


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("CENTER_NAME = MARS", "CENTER_NAME = EARTH", "CENTER_NAME = EARTH: allowed MARS"),
        ("REF_FRAME = ICRF", "REF_FRAME = ITRF2000", "REF_FRAME = ITRF2000: allowed ICRF, EME2000"),
        ("TIME_SYSTEM = TDB", "TIME_SYSTEM = GPS", "TIME_SYSTEM = GPS: allowed TDB"),
        ("INTERPOLATION = HERMITE", "INTERPOLATION = LINEAR", "INTERPOLATION = LINEAR: allowed"),
        ("DEGREE = 7", "DEGREE = 31", "DEGREE = 31: allowed 1 to 15"),
        ("OBJECT_NAME = P1S1", "OBJECT_NAME = P2S1", "'P2S1' is in 2 files"),
        ("OBJECT_NAME = P1S1", "OBJECT_NAME =", "OBJECT_NAME: missing"),
        ("CCSDS_OEM_VERS", "VERS", "is no CCSDS OEM in KVN"),
        ("META_START", "META_BEGIN", "has no META_START"),
        ("20000.000000 ", "nan ", "state 1, '2030-01-01T12:00:00.000000 .*: needs a date and six"),
        (
            "20000.000000 ",
            "20000000.0 ",
            r"state 1 is 2e\+07 km from .*; check the units, km and km/s",
        ),
    ],
)
def test_a_wrong_file_gets_one_message(tmp_path, old, new, message):
    write_oem(tmp_path)
    text = (tmp_path / "1-P1S1.oem").read_text()
    if old == "20000.000000 ":
        old = text.split("META_STOP\n\n")[1].split()[1] + " "
    (tmp_path / "1-P1S1.oem").write_text(text.replace(old, new))
    with pytest.raises(DesignError, match=message):
        by_files(tmp_path)


def test_a_gap_is_refused(tmp_path):
    write_oem(tmp_path)
    path = tmp_path / "1-P1S1.oem"
    lines = path.read_text().splitlines()
    path.write_text("\n".join(lines[:30] + lines[34:]))
    with pytest.raises(DesignError, match="a gap of 50 min after state"):
        by_files(tmp_path)


def test_times_must_increase(tmp_path):
    write_oem(tmp_path)
    path = tmp_path / "1-P1S1.oem"
    lines = path.read_text().splitlines()
    lines[30], lines[31] = lines[31], lines[30]
    path.write_text("\n".join(lines))
    with pytest.raises(DesignError, match="is not later than the one before"):
        by_files(tmp_path)


@pytest.mark.parametrize("date", ["2030-13-01T12:10:00", "2030-01-01T12:10:00+01:00", "noon"])
def test_a_date_must_be_one(tmp_path, date):
    write_oem(tmp_path)
    change(tmp_path, "2030-01-01T12:10:00.000000", date)
    with pytest.raises(DesignError, match="a date that cannot be read"):
        by_files(tmp_path)


def test_a_coarse_table_is_refused(tmp_path):
    write_oem(tmp_path, step=14400.0, days=4.0)
    with pytest.raises(
        DesignError, match="240 min apart are too coarse for interpolation of degree 7"
    ):
        by_files(tmp_path)


def test_too_few_states_are_refused(tmp_path):
    write_oem(tmp_path, step=7200.0, days=0.5)
    with pytest.raises(DesignError, match="7 states; interpolation of degree 7"):
        by_files(tmp_path)


def test_no_file_and_no_common_time_are_refused(tmp_path):
    with pytest.raises(DesignError, match=r"'\*\.oem' matches no file"):
        by_files(tmp_path)
    write_oem(tmp_path)
    path = tmp_path / "1-P1S1.oem"
    path.write_text(path.read_text().replace("2030-01-0", "2031-01-0"))
    with pytest.raises(DesignError, match="no time that all files cover"):
        by_files(tmp_path)


def test_two_segments_join_and_other_clocks_are_read(tmp_path):
    """The same states dated in UTC, days of the year, in two segments that share a row."""
    write_oem(tmp_path, names=1)
    path = tmp_path / "1-P1S1.oem"
    plain = read_oem(path)
    head, body = path.read_text().split("META_STOP\n")
    meta = "META_START" + head.split("META_START")[1] + "META_STOP\n"
    rows = body.split("\n")[1:-1]
    # TDB - UTC is 69.184 s but for 2 ms in 2030, as far as leap seconds are known
    shifted = []
    for row in rows:
        date, rest = row.split(" ", 1)
        when = datetime.fromisoformat(date) - timedelta(seconds=69.184)
        shifted.append(f"{when:%Y-%jT%H:%M:%S.%f} {rest}")
    two = [*meta.splitlines(), *shifted[:40], *meta.splitlines(), *shifted[39:]]
    text = head.split("META_START")[0] + "\n".join(two)
    path.write_text(text.replace("TIME_SYSTEM = TDB", "TIME_SYSTEM = UTC", 1))
    with pytest.raises(DesignError, match="TIME_SYSTEM = TDB, UTC: segments differ"):
        read_oem(path)
    path.write_text(text.replace("TIME_SYSTEM = TDB", "TIME_SYSTEM = utc"))
    other = read_oem(path)
    assert other.times.shape == plain.times.shape
    assert other.times == pytest.approx(plain.times, abs=0.003, rel=0)
    assert other.states == pytest.approx(plain.states)


def test_an_ephemeris_takes_no_motion_table(tmp_path):
    write_oem(tmp_path)
    path = tmp_path / "d.toml"
    path.write_text(
        'name = "x"\n[constellation]\npattern = "ephemeris"\nfiles = ["*.oem"]\n[motion]\nmodel = "j2"'
    )
    with pytest.raises(DesignError, match="leave the table out"):
        read_design(path)
