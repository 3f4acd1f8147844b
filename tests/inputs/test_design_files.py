import hashlib
import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import compass
from compass.bodies import MARS_EQUATORIAL_RADIUS
from compass.errors import ArgumentError, DesignError
from compass.inputs import read_design_text
from compass.inputs.design import cross_faults
from compass.inputs.models import DesignFile
from compass.inputs.reading import MAX_BYTES, parse
from compass.inputs.scenario import read_scenario
from compass.inputs.study import read_study
from compass.orbits.period import repeat_radius

GOOD = """
name = "Test"
[constellation]
pattern = "walker-delta"
satellites = 15
planes = 5
phasing = 1
inclination_deg = 45
radius_km = 20427
"""
SATELLITE = """
name = "Test"
[constellation]
pattern = "elements"
[[constellation.satellite]]
name = "A"
inclination_deg = 10
semi_major_axis_km = 9000
"""


def faults(text):
    with pytest.raises(DesignError, match="design") as caught:
        read_design_text(text)
    return caught.value.faults


def changed(old, new, text=GOOD):
    assert old in text
    return text.replace(old, new)


def test_every_committed_design_reads_and_names_its_source(designs):
    paths = sorted(designs.glob("*.toml"))
    read = [
        compass.read_design(path)
        for path in paths
        if "constellation" in tomllib.loads(path.read_text())
    ]
    assert len(read) >= 6
    assert all(len(d.source) > 20 for d in read)
    kinds = {d.constellation.pattern.kind if d.constellation.pattern else "elements" for d in read}
    assert kinds == {"walker-delta", "walker-star", "elements"}  # a rosette is a delta
    assert any(d.constellation.eccentricity.max() > 0.2 for d in read)


def test_seed_design(seed_design):
    c = seed_design.constellation
    assert c.pattern.notation == "45°: 15/5/1"
    assert c.semi_major_axis[0] == 20427e3
    assert seed_design.figure.equatorial_radius == 3396.2e3
    assert seed_design.fold == 4
    assert [s.name for s in seed_design.stations] == ["North pole", "Equator 0 E", "Equator 180 E"]
    assert seed_design.digest == hashlib.sha256(seed_design.text.encode()).hexdigest()


def test_defaults():
    d = read_design_text(GOOD)
    assert (d.figure.name, d.mask.lowest, d.fold, d.stations) == ("iau-sphere", 0.0, 4, ())
    assert d.constellation.epoch == 0.0


@pytest.mark.parametrize(
    ("orbit", "radius_m"),
    [
        ("radius_km = 20427", 20427e3),
        ("altitude_km = 800", MARS_EQUATORIAL_RADIUS.value + 800e3),
        ('orbit = "areosynchronous"', 1e3 * compass.areosynchronous_radius_km()),
    ],
)
def test_three_ways_to_say_how_high(orbit, radius_m):
    d = read_design_text(changed("radius_km = 20427", orbit))
    assert d.constellation.semi_major_axis[0] == pytest.approx(radius_m)


def test_elements_by_axis_or_by_heights():
    one = read_design_text(SATELLITE + "eccentricity = 0.1").constellation
    low, high = one.periapsis_radius[0] - 3396190, one.apoapsis_radius[0] - 3396190
    by_height = changed(
        "semi_major_axis_km = 9000",
        f"periapsis_altitude_km = {low / 1e3}\napoapsis_altitude_km = {high / 1e3}",
        SATELLITE,
    )
    other = read_design_text(by_height).constellation
    assert other.semi_major_axis[0] == pytest.approx(9e6)
    assert other.eccentricity[0] == pytest.approx(0.1)


def test_a_satellite_may_say_after_what_its_track_closes():
    """Any shape of orbit, each satellite for itself; an axis says nothing of it."""
    text = changed("semi_major_axis_km = 9000", "repeat = [4, 2]\neccentricity = 0.3", SATELLITE)
    closed = read_design_text(text).constellation
    assert (closed.repeat, closed.eccentricity[0]) == ((2, 1), 0.3)
    assert closed.semi_major_axis[0] == repeat_radius(2, 1)
    same = compass.from_elements(repeat=(4, 2), eccentricity=0.3, inclination_deg=0)
    assert (same.repeat, same.semi_major_axis[0]) == ((2, 1), repeat_radius(2, 1))
    with pytest.raises(ArgumentError, match="exactly one of semi_major_axis_km and repeat"):
        compass.from_elements(inclination_deg=0)
    assert read_design_text(SATELLITE).constellation.repeat is None
    another = SATELLITE.split("[[constellation.satellite]]", 1)[1].replace('"A"', '"B"')
    both = text + "\n[[constellation.satellite]]" + another
    assert read_design_text(both).constellation.each_repeat == ((2, 1), None)


def test_stations_and_horizons():
    text = GOOD + (
        '[[station]]\nname = "A"\nlatitude_deg = 45\nlatitude_kind = "planetographic"\n'
        "longitude_deg = 10\nhorizon_deg = [[0, 5], [180, 20]]\n"
        "[coverage]\nhorizon_deg = [[0, 1.5]]\n"
    )
    d = read_design_text(text.replace('name = "Test"', 'name = "Test"\nfigure = "iau-ellipsoid"'))
    assert np.degrees(d.stations[0].latitude) == pytest.approx(44.66, abs=0.01)
    assert np.degrees(d.stations[0].mask.highest) == pytest.approx(20)
    assert d.mask.is_constant


def test_epoch_is_tdb():
    d = read_design_text("epoch = 2000-01-02T12:00:00\n" + GOOD)
    assert d.constellation.epoch == 86400.0


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("planes = 5", "planes = 4", "constellation.planes = 4: 15 satellites do not divide into 4 planes; use one of 1, 3, 5, 15"),
        ("planes = 5", "plains = 5", "constellation.plains = 5: unknown key; did you mean planes?"),
        ("planes = 5", "", "constellation.planes: missing; number of planes p"),
        ("satellites = 15", 'satellites = "15"', "constellation.satellites = '15': must be a whole number"),
        ("satellites = 15", "satellites = 15.5", "must be a whole number"),
        ("satellites = 15", "satellites = 0", "must be at least 1"),
        ("satellites = 15", "satellites = 99999999", "must be at most 10000"),
        ("phasing = 1", "phasing = 5", "phasing is meant modulo planes, so write 0"),
        ("phasing = 1", "phasing = -1", "constellation.phasing = -1: must be at least 0"),
        ("radius_km = 20427", "radius_km = 3000", "is not above the surface; must be more than 3396.19 km"),
        ("radius_km = 20427", "radius_km = nan", "must be a finite number"),
        ("radius_km = 20427", "radius_km = inf", "must be a finite number"),
        ("radius_km = 20427", "radius_km = true", "must be a number"),
        ("radius_km = 20427", "altitude_km = -5", "must be above 0"),
        ("radius_km = 20427", "radius_km = 20427\naltitude_km = 9", "found radius_km and altitude_km"),
        ("radius_km = 20427", "", "needs exactly one of radius_km, altitude_km, orbit and repeat; found none"),
        ("radius_km = 20427", 'orbit = "geo"', "constellation.orbit = 'geo': allowed: 'areosynchronous'"),
        ("inclination_deg = 45", "inclination_deg = 181", "must be at most 180"),
        ('"walker-delta"', '"flower"', "constellation.pattern = 'flower': allowed: 'walker-delta', 'walker-star', 'rosette', 'elements'"),
        ('pattern = "walker-delta"', "", "constellation.pattern: missing"),
        ('name = "Test"', "", "name: missing"),
        ('name = "Test"', 'name = ""', "name = ''"),
        ('name = "Test"', 'name = "T"\nfigure = "moon"', "figure = 'moon': allowed: 'iau-sphere'"),
        ('name = "Test"', 'name = "T"\nepoch = "today"', "must be a date and time"),
        ('name = "Test"', 'name = "T"\nepoch = 2030-01-01T00:00:00Z', "without a time zone"),
        ('name = "Test"', 'name = "T"\nconstellation = 3', "TOML"),
        ('name = "Test"', 'name = "T"\nsource = 3', "source = 3: must be text"),
        ('name = "Test"', 'name = "T"\npaper = "x"', "paper = 'x': allowed: 'kelly2018'"),
    ],
)  # fmt: skip
def test_one_wrong_thing_in_a_pattern(old, new, message):
    assert any(message in text for text in faults(changed(old, new)))


@pytest.mark.parametrize(
    ("extra", "message"),
    [
        ("[coverage]\nmask_deg = 95", "coverage.mask_deg = 95: must be below 90"),
        ("[coverage]\nmask_deg = -1", "must be at least 0"),
        ("[coverage]\nfold = 0", "coverage.fold = 0: must be at least 1"),
        ("[coverage]\nhorizon_deg = 3", "must be a list"),
        ("[coverage]\nhorizon_deg = [[0, 1, 2]]", "coverage.horizon_deg[1]"),
        ("[coverage]\nhorizon_deg = []", "at least one"),
        ("[coverage]\nhorizon_deg = [[0, 1], [0, 2]]", "must increase"),
        ("[coverage]\nhorizon_deg = [[0, 95]]", "below 90"),
        ("[coverage]\nmask_deg = 1\nhorizon_deg = [[0, 1]]", "has both mask_deg and horizon_deg"),
        ('[[station]]\nname = "A"\nlatitude_deg = 91\nlongitude_deg = 0', "station[1].latitude_deg = 91: must be at most 90"),
        ("station = 3", "station = 3: must be a list"),
        ("coverage = 3", "coverage = 3: must be a table"),
    ],
)  # fmt: skip
def test_one_wrong_thing_elsewhere(extra, message):
    text = extra + GOOD if extra[0] != "[" else GOOD + extra
    assert any(message in text for text in faults(text))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("semi_major_axis_km = 9000", "semi_major_axis_km = 9000\neccentricity = 1", "must be below 1"),
        ("semi_major_axis_km = 9000", "semi_major_axis_km = 9000\neccentricity = 0.8", "periapsis radius 1800 km is not above the surface"),
        ("semi_major_axis_km = 9000", "", "needs either semi_major_axis_km"),
        ("semi_major_axis_km = 9000", "eccentricity = 0.1", "semi_major_axis_km: missing"),
        ("semi_major_axis_km = 9000", "periapsis_altitude_km = 500", "apoapsis_altitude_km: missing"),
        ("semi_major_axis_km = 9000", "periapsis_altitude_km = 500\napoapsis_altitude_km = 400", "swap them"),
        ("semi_major_axis_km = 9000", 'semi_major_axis_km = "x"', "must be a number"),
        ("semi_major_axis_km = 9000", "semi_major_axis_km = 9000\nrepeat = [1, 1]", "needs either semi_major_axis_km"),
        ("semi_major_axis_km = 9000", "repeat = [20, 1]", "satellite[1].repeat = [20, 1]: so many revolutions need"),
        ("semi_major_axis_km = 9000", "repeat = [2, 1]\neccentricity = 0.8", "satellite[1].repeat = [2, 1]: periapsis radius"),
        ("semi_major_axis_km = 9000", "repeat = [2]", "satellite[1].repeat"),
        ("[[constellation.satellite]]", "satellite = 3\n[other]", "constellation.satellite = 3: must be a list"),
        ('name = "A"', 'name = ""', "satellite[1].name"),
    ],
)  # fmt: skip
def test_one_wrong_thing_in_a_satellite(old, new, message):
    assert any(message in text for text in faults(changed(old, new, SATELLITE)))


def test_satellites_need_names_of_their_own():
    again = SATELLITE.split("[[", 1)[1]
    assert any("used twice" in text for text in faults(SATELLITE + "[[" + again))


@pytest.mark.parametrize(
    ("multiplier", "message"),
    [
        ('"1/2"', "allowed are whole multiples"),
        ('"one"', "must be a finite number or a fraction"),
        ('"1/0"', "must be a finite number or a fraction"),
        ('"1e999999999"', "must be a finite number or a fraction"),
        ("nan", "finite"),
        ("-inf", "finite"),
        ("[1]", "multiplier"),
        ("true", "multiplier"),
    ],
)
def test_wrong_multiplier_of_a_rosette(multiplier, message):
    text = GOOD.replace("walker-delta", "rosette").replace(
        "phasing = 1", f"multiplier = {multiplier}"
    )
    told = [fault for fault in faults(text) if "multiplier" in fault]
    assert len(told) == 1 and message in told[0]


def test_rosette_reads():
    text = GOOD.replace("walker-delta", "rosette").replace(
        "phasing = 1", "multiplier = 2.3333333333"
    )
    with pytest.raises(DesignError, match="multiples"):
        read_design_text(text.replace("2.3333333333", "0.5"))
    good = text.replace("2.3333333333", '"7/3"')
    assert read_design_text(good).constellation.pattern.phasing == 7 % 5


def test_all_faults_come_together():
    text = (
        "figur = 1\n"
        + GOOD.replace("planes = 5", "planes = 4").replace("20427", "nan")
        + "[coverage]\nmask_deg = 95\nfold = 0\n"
    )
    found = "\n".join(faults(text))
    for part in ("figur", "planes = 4", "radius_km = nan", "mask_deg = 95", "fold = 0"):
        assert part in found


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "no such file"),
        ("folder", "is a directory"),
        (b"", "empty"),
        (b" \n\t", "empty"),
        (b"\x00\x01\xff\xfe", "line 1 is not text in UTF-8.*saved as UTF-8"),
        ("name = 'a'\nsource = 'é'".encode("latin-1"), "line 2 is not text in UTF-8"),
        (b"a = = 3", "not valid TOML"),
        (
            b"a = 3\n'b c'.d = 1\na = [\n 4,\n]\n",
            "not valid TOML: a is given twice, .* in line 3; l",
        ),
        (b"[t]\nx.y = 3\nx.y = 4", "not valid TOML: x.y is given twice, again in line 3; leave"),
        (b"x.y = 3\nx = {y = 4}\n", "not valid TOML: .*twice, again in line 2"),
        (b"[t]\n[t]\n", r"not valid TOML: Cannot declare \('t',\) twice"),
        (b"a = " + b"[" * 5000, "nested too deeply|not valid TOML"),
        (b"a = " + b"[" * 90 + b"]" * 90, "not valid TOML: nested too deeply, more than 30 times$"),
        (b"a = " + b"{b = " * 900 + b"1" + b"}" * 900, "nested too deeply$|more than 30 times$"),
        (b"a = " + b"9" * 5000, "not valid TOML: a value that cannot be: Exceeds .* digits$"),
        (b"#" * (MAX_BYTES + 1), "at most 1 MB"),
    ],
)
def test_files_that_are_no_design(tmp_path, content, message):
    path = tmp_path / "x.toml"
    if content == "folder":
        path.mkdir()
    elif content is not None:
        path.write_bytes(content)
    with pytest.raises(DesignError, match=message) as caught:
        compass.read_design(path)
    assert str(caught.value).startswith(str(path))


@pytest.mark.parametrize(
    "command",
    [
        ["show", "x.toml"],
        ["land", "x.toml"],
        ["trade", "x.toml"],
        ["report", "x.toml"],
        ["search", "--max-satellites", "3", "--orbit", "areosynchronous", "--require", "x.toml"],
    ],
)
@pytest.mark.parametrize("text", ["x = " + "[" * 990 + "]" * 990, "x = [" + "9" * 5000 + "]"])
def test_no_command_gives_up_on_what_is_nested_or_long(command, text, run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("x.toml").write_text(text)
    status, _, err = run(*command)
    assert status == 2 and err.startswith("x.toml: not valid TOML: ") and err.count("\n") == 1


def test_a_name_too_long_for_a_file(tmp_path):
    with pytest.raises(DesignError, match="cannot be read: File name too long"):
        compass.read_design(tmp_path / ("x" * 300))


def test_a_file_of_another_kind_is_said_once(designs):
    readers = {
        "compass-15-5-1.toml": (compass.read_design, "a design"),
        "landing.toml": (read_scenario, "a scenario of landing"),
        "study-small.toml": (read_study, "a study"),
    }
    for name, (own, kind) in readers.items():
        assert own(designs / name).name
        for reader, wanted in readers.values():
            if reader is not own:
                with pytest.raises(DesignError, match=f"is {kind}, not {wanted}") as caught:
                    reader(designs / name)
                assert len(caught.value.faults) == 1


def test_huge_files_are_refused_unread(tmp_path):
    path = tmp_path / "huge.toml"
    with path.open("wb") as file:
        file.truncate(100_000_000)
    with pytest.raises(DesignError, match=r"100\.0 MB"):
        compass.read_design(path)


def test_devices_are_refused():
    with pytest.raises(DesignError, match="not a regular file"):
        compass.read_design("/dev/zero")


scalars = (
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8)
    | st.sampled_from(["walker-delta", "rosette", "elements", "1/4", "areosynchronous"])
)  # fmt: skip
keys = st.sampled_from(
    ["name", "constellation", "pattern", "satellites", "planes", "phasing", "inclination_deg",
     "radius_km", "altitude_km", "orbit", "multiplier", "satellite", "semi_major_axis_km",
     "eccentricity", "periapsis_altitude_km", "apoapsis_altitude_km", "coverage", "mask_deg",
     "horizon_deg", "fold", "station", "latitude_deg", "longitude_deg", "figure", "epoch"]
)  # fmt: skip
tables = st.recursive(
    scalars,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(keys, inner, max_size=6),
    max_leaves=25,
)


@settings(max_examples=300)
@given(st.dictionaries(keys, tables, max_size=6))
@example(
    {"constellation": {"pattern": "rosette", "satellites": 6, "planes": 3, "multiplier": 1e308}}
)
@example({"constellation": {"pattern": "elements", "satellite": [{"eccentricity": 10**400}]}})
@example({"coverage": {"horizon_deg": [[10**400, 0]]}})
def test_any_table_is_read_or_refused_but_never_crashes(raw):
    faults = cross_faults(raw)
    assert all(isinstance(fault, str) and fault for fault in faults)


@settings(max_examples=200)
@given(st.text(max_size=200))
@example("\ufeff" + GOOD)
@example(GOOD.replace("\n", "\r\n"))
@example('name = "x"\n[constellation]\npattern = 1979-05-27T07:32:00Z\n')
def test_any_text_is_read_or_refused_but_never_crashes(text):
    try:
        design = read_design_text(text)
    except DesignError as error:
        assert error.faults
    else:
        assert design.constellation.size


@settings(max_examples=150)
@given(st.data())
def test_any_value_in_any_field_is_read_or_refused(data):
    raw = tomllib.loads(GOOD)
    raw["coverage"] = {}
    raw["station"] = [{"name": "A", "latitude_deg": 1.0, "longitude_deg": 2.0}]
    table = data.draw(
        st.sampled_from([raw, raw["constellation"], raw["coverage"], raw["station"][0]])
    )
    table[data.draw(keys)] = data.draw(tables)
    found = cross_faults(raw)
    try:
        DesignFile.model_validate(raw)
    except ValueError as error:
        from compass.inputs.faults import model_faults

        assert model_faults(error.errors(), DesignFile)
    assert isinstance(found, list)


def test_parse_keeps_the_label_before_every_fault():
    with pytest.raises(DesignError, match=r"^here: name: missing"):
        parse("a = 1", "here", DesignFile, lambda raw: [])
