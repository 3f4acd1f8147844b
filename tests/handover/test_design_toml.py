"""Design files written and read again: the identical constellation."""

import dataclasses
from fractions import Fraction
from math import gcd

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import compass
from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.handover.toml import constellation_toml, design_toml
from compass.inputs import read_design, read_design_text
from compass.orbits import (
    Pattern,
    areosynchronous_radius,
    keplerian,
    rosette,
    walker_delta,
    walker_star,
)
from compass.orbits.constellation import from_pattern
from compass.orbits.motion import Motion
from compass.orbits.period import repeat_radius
from compass.sites import Mask

IAU = FIGURES["iau-sphere"]
KEPT = ("name", "source", "paper", "figure", "mask", "fold", "access", "access_duration",
        "conjunction", "radios", "requirements", "signal", "tracking", "integrity", "upkeep",
        "launching")  # fmt: skip
SAME = ("name", "epoch", "satellite_names", "pattern", "gm", "repeat")
ELEMENTS = ("semi_major_axis", "eccentricity", "inclination", "raan", "argument_of_periapsis",
            "mean_anomaly")  # fmt: skip

# any text of one line that a file in UTF-8 can hold
texts = st.text(st.characters(exclude_categories=["Cs", "Cc"]), min_size=1, max_size=40)
degrees = st.floats(-720, 720) | st.integers(-360, 360).map(float)
inclinations = st.floats(0, 180) | st.integers(0, 18000).map(lambda n: n / 100)
kilometres = st.floats(3397.0, 1e5) | st.integers(3397, 10**5).map(float)
epochs = st.floats(-1e9, 1e9).map(lambda s: round(s, 6)) | st.just(0.0)


def assert_identical(one, other):
    for field in SAME:
        assert getattr(one, field) == getattr(other, field)
    for field in ELEMENTS:
        np.testing.assert_array_equal(getattr(one, field), getattr(other, field))


def assert_once_written_always_the_same(constellation):
    """One reading may round the last digit; from then on nothing changes."""
    first = read_design_text(constellation_toml(constellation, IAU)).constellation
    for field in ELEMENTS:
        np.testing.assert_allclose(
            getattr(first, field), getattr(constellation, field), rtol=4.5e-16, atol=0
        )
    again = read_design_text(constellation_toml(first, IAU)).constellation
    assert_identical(first, again)
    return first


angles = st.floats(0, 359.9)


@st.composite
def patterns(draw):
    """Patterns as files make them, of degrees and kilometres."""
    kind = draw(st.sampled_from(["walker-delta", "walker-star", "rosette"]))
    planes, per_plane = draw(st.integers(1, 7)), draw(st.integers(1, 5))
    t = planes * per_plane
    options = {
        "inclination_deg": draw(inclinations),
        "raan_deg": draw(st.just(0.0) | angles),
        "phase_deg": draw(st.just(0.0) | angles),
        **draw(
            st.fixed_dictionaries({"radius_km": kilometres})
            | st.fixed_dictionaries({"altitude_km": kilometres})
            | st.just({"orbit": "areosynchronous"})
            | st.sampled_from([{"repeat": (2, 1)}, {"repeat": (6, 4)}])
        ),
        "name": draw(texts),
        "epoch": draw(epochs),
    }
    if kind == "rosette":
        steps = draw(st.integers(0, 2 * t).filter(lambda c: gcd(c, per_plane) == 1))
        return rosette(t, planes, Fraction(steps * planes, t), **options)
    make = walker_delta if kind == "walker-delta" else walker_star
    return make(t, planes, draw(st.integers(0, planes - 1)), **options)


@given(patterns())
def test_patterns_round_trip(constellation):
    text = constellation_toml(constellation, IAU)
    assert_identical(constellation, read_design_text(text).constellation)


def test_what_each_satellite_says_of_its_track_is_kept():
    closed = compass.from_elements(repeat=(3, 2), eccentricity=0.2, inclination_deg=[10, 20])
    other = compass.from_elements(
        semi_major_axis_km=9000, inclination_deg=5, satellite_names=["other"], name="other"
    )
    text = constellation_toml(closed + other, IAU)
    read = read_design_text(text).constellation
    assert read.each_repeat == ((3, 2), (3, 2), None)
    np.testing.assert_array_equal(read.semi_major_axis, (closed + other).semi_major_axis)
    assert text.count("repeat = [3, 2]") == 2 and text.count("semi_major_axis_km = 9000") == 1


@given(
    st.lists(
        st.tuples(kilometres, st.floats(0, 0.9), inclinations, degrees, degrees, degrees),
        min_size=1,
        max_size=4,
    ),
    st.lists(texts, min_size=4, max_size=4, unique=True),
    texts,
    epochs,
)
def test_explicit_elements_round_trip(satellites, names, name, epoch):
    a, e, *angles = np.array(satellites).T
    c = keplerian(
        a * 1e3 / (1 - e),
        e,
        *(np.radians(angle) for angle in angles),
        name=name,
        epoch=epoch,
        satellite_names=names[: len(a)],
    )
    read = assert_once_written_always_the_same(c)
    assert (read.name, read.satellite_names, read.epoch) == (name, c.satellite_names, epoch)
    for field in ("eccentricity", "inclination", "raan"):  # from degrees: nothing is rounded
        np.testing.assert_array_equal(getattr(read, field), getattr(c, field))


@given(st.floats(0, np.pi), st.floats(3.4e6, 1e8))
def test_any_radians_and_metres_settle_at_once(inclination, radius):
    assert_once_written_always_the_same(
        from_pattern(Pattern("walker-delta", 6, 3, 2, inclination), radius)
    )


def test_every_design_of_the_repository_round_trips(designs):
    read = [read_design(p) for p in sorted(designs.glob("*.toml"))
            if "[constellation]" in p.read_text()]  # fmt: skip
    assert len(read) >= 6
    for design in read:
        again = read_design_text(design_toml(design))
        assert_identical(design.constellation, again.constellation)
        for field in KEPT:
            assert getattr(design, field) == getattr(again, field)
        for one, other in zip(design.stations, again.stations, strict=True):
            assert dataclasses.replace(one, latitude=0.0) == dataclasses.replace(
                other, latitude=0.0
            )
            assert one.latitude == pytest.approx(other.latitude, rel=4.5e-16, abs=0)


def test_the_file_reads_well():
    c = walker_delta(12, 4, 1, inclination_deg=61.25, radius_km=20428, name="Twelve")
    horizon = Mask((0.0, float(np.radians(180))), tuple(np.radians([5.0, 12.5]).tolist()))
    text = constellation_toml(c, IAU, mask=horizon, fold=3, source='two\nlines "quoted" \\')
    assert text == (
        'name = "Twelve"\n'
        'source = """\ntwo\nlines \\"quoted\\" \\\\"""\n'
        'figure = "iau-sphere"\n\n'
        '[constellation]\npattern = "walker-delta"\nsatellites = 12\nplanes = 4\nphasing = 1\n'
        "inclination_deg = 61.25\nradius_km = 20428\n\n"
        "[coverage]\nhorizon_deg = [[0, 5], [180, 12.5]]\nfold = 3\n"
    )
    read = read_design_text(text)
    assert (read.mask, read.source) == (horizon, 'two\nlines "quoted" \\')


def test_orbits_are_said_as_a_reader_would():
    def orbit(radius, repeat=None):
        c = from_pattern(Pattern("walker-delta", 3, 1, 0, 0.0), radius, repeat=repeat)
        return constellation_toml(c, IAU).split("inclination_deg = 0\n")[1].split("\n")[0]

    assert orbit(areosynchronous_radius(), (1, 1)) == 'orbit = "areosynchronous"'
    assert orbit(repeat_radius(2, 1), (2, 1)) == "repeat = [2, 1]"
    # near is not closed: nobody said that the tracks close
    assert orbit(areosynchronous_radius()).startswith("radius_km = 20427.6")
    assert orbit(20427e3) == "radius_km = 20427"
    # between 4096 and 4194.3 km doubles of kilometres are twice as coarse as those of metres
    surface = IAU.equatorial_radius
    wanted = [a / 10 * 1e3 + surface for a in range(7100, 7900)]
    reached = [any(km * 1e3 == r for km in neighbours(r / 1e3)) for r in wanted]
    assert not all(reached)
    for radius, by_radius in zip(wanted, reached, strict=True):
        assert orbit(radius).startswith("radius_km" if by_radius else "altitude_km")


def neighbours(value):
    return value + np.spacing(value) * np.arange(-4, 5)


def test_another_planet_is_refused():
    c = walker_delta(3, 1, 0, inclination_deg=0.0, radius_km=20000, gm=3.986e14)
    with pytest.raises(ArgumentError, match="a design file is about Mars"):
        constellation_toml(c, IAU)


EVERYTHING = """
name = "all of it"
figure = "iau-ellipsoid"
[constellation]
pattern = "walker-delta"
satellites = 6
planes = 2
phasing = 1
inclination_deg = 50
radius_km = 20428
[coverage]
horizon_deg = [[0, 5], [180, 12.5]]
fold = 3
[motion]
model = "numerical"
gravity_degree = 6
sun = false
moons = true
radiation_m2_kg = 0.031
shadow = "cone"
[deployment]
launch_altitude_km = 350
waiting_altitude_km = [500.5, 9000]
longest_wait_days = 700
satellites_a_launch = 8
[keeping]
specific_impulse_s = 1500
years = 3.3
[[station]]
name = "Gale"
latitude_deg = -4.59
longitude_deg = 137.44
horizon_deg = [[0, 3], [90, 7]]
[access]
duration_sols = 3.7
moons = ["deimos"]
earth = true
crosslinks = true
atmosphere_height_km = 80
conjunction_deg = 3.1
[[link]]
between = ["satellite", "station"]
frequency_mhz = 401.585625
eirp_dbw = 10.5
g_over_t_db_per_k = -20
required_cn0_dbhz = 31
[[requirement]]
name = "Gale always"
sites = ["Gale"]
fold = 2
mask_deg = 12
losses = 1
[[requirement]]
name = "belt"
region = ["lat:-30:30"]
pdop_at_most = 6
share = 0.95
share_of = "area-time"
altitude_km = 12
beam_deg = 20
error_vertical_m_at_most = 30
error_as = "95-percent"
[signal]
clock = "rafs"
update_h = 6
ephemeris_m = [2, 8, 5]
receiver = { noise_m = 0.5 }
[tracking]
days = 2
stations = { range_m = 1, time_m = 2 }
[integrity]
p_sat = 2e-6
"""


def test_every_table_is_kept():
    """Each field of a design but its text and its files, with nothing as it is without a table."""
    design = read_design_text(EVERYTHING)
    again = read_design_text(design_toml(design))
    plain = compass.Design(design.constellation, name=design.name)
    for field in KEPT:
        if field not in ("name", "source", "paper"):
            assert getattr(design, field) != getattr(plain, field), f"{field} is not tried"
        assert getattr(design, field) == getattr(again, field), field
    assert design.stations == again.stations
    assert design.motion.title == again.motion.title
    assert design.motion.forces.radiation == again.motion.forces.radiation
    bare = compass.Requirement("")
    for field in dataclasses.fields(bare):
        tried = {getattr(wanted, field.name) for wanted in design.requirements}
        assert tried - {getattr(bare, field.name)}, f"{field.name} of a requirement is not tried"
    known = {f.name for f in dataclasses.fields(compass.Design)}
    elsewhere = {"constellation", "stations", "motion", "text", "label", "others", "beacons"}
    assert known == {*KEPT, *elsewhere}
    assert compass.export(design, format="toml").not_kept == ()
    lit = dataclasses.replace(design, beacons=design.stations[:1])
    (said,) = compass.export(lit, format="toml").not_kept
    assert design.stations[0].name in said and "--beacon" in said


def test_what_a_design_file_cannot_say_is_said():
    design = read_design_text(EVERYTHING)
    forces = design.motion.forces
    other = dataclasses.replace(
        forces, field=dataclasses.replace(forces.field, name="mine", gm=4e13)
    )
    (gale,) = design.stations
    moved = dataclasses.replace(gale, latitude=0.5)
    wanted = dataclasses.replace(design.requirements[0], sites=(moved,))
    changed = dataclasses.replace(design, motion=Motion("numerical", other), requirements=(wanted,))
    made = compass.export(changed, format="toml")
    assert len(made.not_kept) == 2
    assert "mine" in made.not_kept[0] and "'Gale'" in made.not_kept[1]
    assert "NOT KEPT" in str(made)


def test_trajectories_are_said_not_to_be_kept(designs, tmp_path):
    compass.export(
        designs / "areostationary-trio.toml", format="oem", output=tmp_path / "oem",
        duration_h=24, step_s=3600,
    )  # fmt: skip
    text = 'name = "read"\n[constellation]\npattern = "ephemeris"\nfiles = ["oem/*.oem"]\n'
    (tmp_path / "d.toml").write_text(text)
    made = compass.export(tmp_path / "d.toml", format="toml")
    assert "trajectories" in made.not_kept[0]
    assert read_design_text(made.files["design.toml"]).constellation.size == 3
