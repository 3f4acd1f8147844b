"""CZML: accepted by another program's schema, and interpolated as viewers do it."""

import json

import numpy as np
import pytest
from scipy.interpolate import BarycentricInterpolator

from compass.handover.czml import DEGREE, czml
from compass.handover.instants import sample_times
from compass.inputs import read_design, read_design_text
from compass.orbits import orbital_period, positions_mcmf


def read(design, hours=None):
    times = sample_times(design.constellation, hours)
    return times, json.loads(czml(design, times))


def by_kind(packets, kind):
    return [p for p in packets if p["id"].startswith(f"{kind}/")]


@pytest.mark.parametrize("name", ["compass-15-5-1.toml", "draim-four.toml"])
def test_another_program_accepts_every_packet(designs, name):
    czml3 = pytest.importorskip("czml3")
    _, packets = read(read_design(designs / name), 3.0)
    for packet in packets:  # their models refuse any property that the schema does not know
        assert czml3.Packet.model_validate(packet).id == packet["id"]


def test_the_document_says_when(designs):
    design = read_design_text(
        "epoch = 2030-01-02T03:04:05\n" + (designs / "compass-15-5-1.toml").read_text()
    )
    times, packets = read(design, 3.0)
    document = packets[0]
    assert (document["id"], document["version"]) == ("document", "1.0")
    # TDB less 32.184 s and 37 leap seconds
    start, stop = "2030-01-02T03:02:55.816000Z", "2030-01-02T06:02:55.816000Z"
    assert document["clock"] == {
        "interval": f"{start}/{stop}",
        "currentTime": start,
        "multiplier": 180.0,
        "range": "LOOP_STOP",
        "step": "SYSTEM_CLOCK_MULTIPLIER",
    }
    for packet in by_kind(packets, "satellite"):
        assert packet["availability"] == f"{start}/{stop}"
        assert packet["position"]["epoch"] == start
        assert packet["position"]["cartesian"][::4] == times.tolist()
    identities = [packet["id"] for packet in packets]
    assert len(set(identities)) == len(identities)


@pytest.mark.parametrize(
    ("figure", "radii"),
    [
        ("iau-ellipsoid", [3396190.0, 3396190.0, 3376200.0]),
        ("kelly2018-sphere", [3396200.0] * 3),
    ],
)
def test_the_ellipsoid_is_mars(figure, radii):
    design = read_design_text(
        f'name = "x"\nfigure = "{figure}"\n[constellation]\npattern = "rosette"\nsatellites = 3\n'
        "planes = 3\nmultiplier = 1\ninclination_deg = 50\nradius_km = 20428\n"
        '[[station]]\nname = "P"\nlatitude_deg = 90\nlongitude_deg = 0\n'
    )
    _, packets = read(design, 1.0)
    mars = packets[1]
    assert mars["id"] == "Mars"
    assert mars["ellipsoid"]["radii"]["cartesian"] == radii
    assert mars["properties"]["polar_radius_m"] == {"number": radii[2]}
    assert mars["position"]["cartesian"] == [0, 0, 0]
    assert "Cesium.Ellipsoid.default" in mars["description"]
    (station,) = by_kind(packets, "station")
    assert station["position"] == {"referenceFrame": "FIXED", "cartesian": [0, 0, radii[2]]}


@pytest.mark.parametrize("name", ["compass-15-5-1.toml", "draim-four.toml", "relay-orbiters.toml"])
def test_a_viewer_interpolates_to_millimetres(designs, name):
    """Lagrange's polynomial through the nearest samples, as the document says."""
    design = read_design(designs / name)
    c = design.constellation
    times, packets = read(design)
    satellites = by_kind(packets, "satellite")
    assert len(satellites) == c.size
    for k, packet in enumerate(satellites):
        position = packet["position"]
        assert (position["referenceFrame"], position["interpolationDegree"]) == ("FIXED", DEGREE)
        samples = np.array(position["cartesian"]).reshape(-1, 4)
        np.testing.assert_array_equal(samples[:, 0], times)
        for first in range(0, min(times.size - 9, 150), 11):
            some = samples[first : first + DEGREE + 1]
            middle = (some[3, 0] + some[4, 0]) / 2
            found = BarycentricInterpolator(some[:, 0] - middle, some[:, 1:])(0.0)
            truth = positions_mcmf(c, [middle])[k, 0]
            # samples are rounded to 1 mm, which the weights raise by less than two
            assert np.abs(found - truth).max() < 2e-3
        assert packet["path"]["leadTime"] + packet["path"]["trailTime"] == pytest.approx(
            orbital_period(c.semi_major_axis[k])
        )
        assert packet["label"]["text"] == c.satellite_names[k]


def test_planes_have_colours_and_few_samples_a_low_degree(seed_design):
    packets = json.loads(czml(seed_design, np.array([0.0, 60.0])))
    satellites = by_kind(packets, "satellite")
    assert {p["position"]["interpolationDegree"] for p in satellites} == {1}
    colours = [tuple(p["point"]["color"]["rgba"]) for p in satellites]
    assert len(set(colours)) == 5
    assert all(len(set(colours[n : n + 3])) == 1 for n in range(0, 15, 3))
