"""OEM as other programs read it: states to the printed digits, frame, time, interpolation."""

import numpy as np
import pytest
from scipy.interpolate import KroghInterpolator

from compass import frames
from compass.handover.instants import sample_times, tdb
from compass.handover.oem import DEGREE, oem
from compass.inputs import read_design, read_design_text
from compass.orbits import keplerian, positions_mcmf, states_mci

# half a unit of the last digit: 1 mm and 1 um/s
POSITION, VELOCITY = 0.5001e-3, 0.5001e-6
DESIGNS = ["compass-15-5-1.toml", "draim-four.toml"]


def read(folder, name, text):
    path = folder / name
    path.write_text(text, encoding="ascii")
    return path


def reference(design, times):
    """States in ICRF by the axes' directions: node and pole of Mars in the sky."""
    epoch = design.constellation.epoch
    ra, dec = frames.spin_pole(epoch)
    pole = frames.direction(dec, ra)
    node = np.array([-np.sin(ra), np.cos(ra), 0.0])
    axes = np.stack([node, np.cross(pole, node), pole])
    return [np.einsum("stk,kx->stx", x, axes) for x in states_mci(design.constellation, times)]


@pytest.mark.parametrize("name", DESIGNS)
def test_brahe_reads_the_ephemeris(designs, tmp_path, name):
    brahe = pytest.importorskip("brahe")
    from brahe.ccsds import OEM

    text = "epoch = 2031-05-06T07:08:09\n" + (designs / name).read_text()
    design = read_design_text(text)
    c = design.constellation
    times = sample_times(c, 3.0)
    r, v = reference(design, times)
    messages = oem(design, times)
    assert len(messages) == c.size
    for k, (file, message) in enumerate(messages.items()):
        theirs = OEM.from_file(str(read(tmp_path, file, message)))
        (segment,) = theirs.segments
        assert segment.object_name == c.satellite_names[k]
        assert (segment.center_name, segment.ref_frame) == ("MARS", "ICRF")
        assert (segment.interpolation, segment.interpolation_degree) == ("HERMITE", DEGREE)
        states = list(segment.states)
        assert len(states) == times.size
        for n, state in enumerate(states):
            np.testing.assert_allclose(state.position, r[k, n], rtol=0, atol=POSITION)
            np.testing.assert_allclose(state.velocity, v[k, n], rtol=0, atol=VELOCITY)
        epoch = brahe.Epoch.from_datetime(2031, 5, 6, 7, 8, 9.0, 0.0, brahe.TDB)
        # they subtract atomic times, to which TDB runs at a rate within 3.3e-10 of one
        passed = np.array([state.epoch - epoch for state in states])
        np.testing.assert_allclose(passed, times, rtol=3.4e-10, atol=1e-8)
        # their own rotation of Mars takes our ICRF to our Mars-fixed position at the epoch
        turned = brahe.rotation_icrf_to_body_fixed_iau(499, epoch) @ states[0].position
        fixed = positions_mcmf(c, [0.0])[k, 0]
        # 2e-11 as in the test of the frames, and the printed millimetre in three components
        bound = 2e-11 * np.linalg.norm(fixed) + 2 * POSITION
        np.testing.assert_allclose(turned, fixed, rtol=0, atol=bound)


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_strict_reader_reads_the_ephemeris(designs, tmp_path):
    strict = pytest.importorskip("oem", exc_type=ImportError)
    design = read_design(designs / "draim-four.toml")
    times = sample_times(design.constellation, 5.0)
    r, _ = reference(design, times)
    for k, (file, message) in enumerate(oem(design, times).items()):
        theirs = strict.OrbitEphemerisMessage.open(read(tmp_path, file, message))
        (segment,) = theirs.segments
        assert (theirs.version, segment.metadata["TIME_SYSTEM"]) == ("2.0", "TDB")
        states = list(segment.states)
        assert states[0].epoch.scale == "tdb"
        ours = np.array([state.position for state in states]) * 1e3
        np.testing.assert_allclose(ours, r[k], rtol=0, atol=POSITION)
        # it interpolates as the message says: within rounding and a millimetre of the truth
        middle = (times[3] + times[4]) / 2
        got = segment(states[0].epoch + (states[1].epoch - states[0].epoch) * middle / times[1])
        truth, _ = reference(design, [middle])
        np.testing.assert_allclose(got.position * 1e3, truth[k, 0], rtol=0, atol=2e-3)


@pytest.mark.parametrize(
    "name", ["compass-15-5-1.toml", "draim-four.toml", "relay-orbiters.toml", None]
)
def test_the_default_step_interpolates_to_a_millimetre(designs, name):
    eccentric = keplerian(3.6e7, 0.9, 0.9, 0.0, 1.0, 0.0)  # starts at periapsis
    c = eccentric if name is None else read_design(designs / name).constellation
    times = sample_times(c)[:60]
    r, v = states_mci(c, times)
    nodes = np.arange(4)
    for k in range(c.size):
        for first in range(0, 56, 5):
            some = times[first + nodes]
            scale = some[1] - some[0]
            x = np.repeat((some - some[1]) / scale, 2)
            y = np.empty((8, 3))
            y[::2], y[1::2] = r[k, first + nodes], v[k, first + nodes] * scale
            middle = 0.5
            truth = states_mci(c, [some[1] + middle * scale])[0][k, 0]
            assert np.abs(KroghInterpolator(x, y)(middle) - truth).max() < 1e-3


def test_the_text_keeps_to_the_standard():
    names = ["Été", "tab here", "  ", "x" * 300, "a/b", "火星"]
    satellites = "".join(
        f"[[constellation.satellite]]\nname = {name!r}\nsemi_major_axis_km = 9000\n"
        "inclination_deg = 50\n".replace("'", '"')
        for name in names
    )
    design = read_design_text(
        f'name = "45°: \\"one\\""\nsource = """{"word " * 60}\nnext"""\n'
        f'[constellation]\npattern = "elements"\n{satellites}'
    )
    created = np.datetime64("2030-01-02T03:04:05")
    messages = oem(design, np.array([0.0, 60.0]), "j2", created)
    assert list(messages) == [
        "1-Ete.oem", "2-tab_here.oem", "3-.oem", f"4-{'x' * 60}.oem", "5-a_b.oem",
        "6-_u706b_u661f.oem",
    ]  # fmt: skip
    objects = []
    for text in messages.values():
        lines = text.splitlines()
        assert text.isascii() and text.endswith("\n") and "\t" not in text
        assert max(map(len, lines)) <= 254
        keys = [line.split(" = ")[0] for line in lines if " = " in line and "COMMENT" not in line]
        assert keys == [
            "CCSDS_OEM_VERS", "CREATION_DATE", "ORIGINATOR", "OBJECT_NAME", "OBJECT_ID",
            "CENTER_NAME", "REF_FRAME", "TIME_SYSTEM", "START_TIME", "STOP_TIME",
            "INTERPOLATION", "INTERPOLATION_DEGREE",
        ]  # fmt: skip
        said = dict(line.split(" = ", 1) for line in lines if " = " in line)
        assert said["CREATION_DATE"] == "2030-01-02T03:04:05"
        assert said["INTERPOLATION_DEGREE"] == "3"  # two states and two velocities
        objects.append(said["OBJECT_NAME"])
        assert 'COMMENT 45\\xb0: "one": 6 satellites' in lines
        assert any(line.startswith("COMMENT Motion: mean motion under J2") for line in lines)
    assert objects == ["Ete", "tab here", "UNNAMED", "x" * 200, "a/b", "\\u706b\\u661f"]


def test_now_is_the_date_of_creation(seed_design):
    before = np.datetime64("now")
    text = next(iter(oem(seed_design, np.array([0.0, 1.0])).values()))
    stamp = text.split("CREATION_DATE = ")[1].split("\n")[0]
    assert before <= np.datetime64(stamp) <= np.datetime64("now")
    assert tdb(0.0, np.zeros(1))[0] == np.datetime64("2000-01-01T12:00:00")
