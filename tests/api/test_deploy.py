"""Deployment by drift of the nodes, against propagation and against plain sums."""

import json

import numpy as np
import pytest

import compass
from compass.bodies import MARS_GM
from compass.document import text
from compass.errors import ArgumentError
from compass.inputs import read_design, read_design_text
from compass.orbits.constellation import keplerian
from compass.orbits.deployment import deploy_by_drift
from compass.orbits.forces import ForceModel
from compass.orbits.gravity import built_in_field
from compass.orbits.impulses import hohmann, node_change
from compass.orbits.motion import Motion
from compass.orbits.period import secular_rates
from compass.pages.deployment import deployment_section

OBLATE = Motion(
    "numerical", ForceModel(built_in_field().truncated(2, 0), False, False, 0.0, "none")
)


def node_of(c, motion, t):
    """Node of the mean plane: of the sum of the poles over ten revolutions after a time."""
    span = 10 * 2 * np.pi / c.mean_motion[0]
    r, v = motion.trajectory(c, 0.0, t + span).states(t + np.linspace(0.0, span, 400))
    pole = np.cross(r[0], v[0]).sum(axis=0)
    return np.arctan2(pole[0], -pole[1])


@pytest.mark.slow
def test_nodes_part_as_integrated_orbits_do(designs):
    """A waiting orbit at 1500 km, integrated under J2: its node comes to the plane when told."""
    c = read_design(designs / "compass-15-5-1.toml").constellation
    radius = 3396.2e3 + 1500e3
    found = deploy_by_drift(c, radius, [radius], 15)
    wait = float(found.planes[0].waits[0])
    low = keplerian(radius, 0.0, np.radians(45), 0.0, 0.0, 0.0)
    # one plane east is four fifths of a turn west, where nodes go
    turned = np.mod(node_of(low, OBLATE, wait) - node_of(low, OBLATE, 0.0), 2 * np.pi)
    own = wait * float(secular_rates(c.semi_major_axis[0], 0.0, c.inclination[0])[0])
    assert np.degrees(np.mod(turned - own, 2 * np.pi)) == pytest.approx(72.0, abs=2.5)


def test_the_cheapest_is_the_least_of_all_that_are_quick_enough(designs):
    found = compass.deploy(designs / "compass-15-5-1.toml", longest_wait_days=200)
    out = found.to_dict()
    quick = [o for o in out["options"] if o["wait_days"] <= 200]
    assert out["chosen"]["delta_v_deploy_m_s"] == min(o["delta_v_deploy_m_s"] for o in quick)
    assert found.holds
    assert (out["launches"], out["planes_a_launch"], len(out["planes"])) == (1, 5, 4)
    radius = 3396.2e3 + out["chosen"]["waiting_altitude_km"] * 1e3
    first, last = 3396.2e3 + 400e3, 20427e3
    known = hohmann(first, radius) + hohmann(radius, last)
    assert out["chosen"]["delta_v_deploy_m_s"] == pytest.approx(float(known))
    far = out["planes"][1]
    turn = 2 * np.sqrt(MARS_GM.value / last) * np.sin(np.pi / 4) * np.sin(np.radians(72))
    assert far["direct_m_s"] == pytest.approx(float(hohmann(first, last)) + turn)
    assert node_change(last, np.pi / 4, np.radians(144)) == pytest.approx(turn)
    words = text(found.document())
    assert "5 planes from 1 launch: waiting at" in words
    assert found.plot().get_ylabel() == "delta-v of one satellite, m/s"
    json.dumps(out)


def test_every_wait_turns_the_node_by_its_angle(designs):
    c = read_design(designs / "compass-15-5-1.toml").constellation
    found = deploy_by_drift(c, 4e6, np.array([4e6, 9e6, 2.5e7]), 15)
    for plane in found.planes:
        gone = np.mod(found.parting * plane.waits, 2 * np.pi)
        assert gone == pytest.approx(plane.node, abs=1e-9)
    assert np.all(found.waits > 0)
    assert found.parting[0] < 0 < found.parting[2]


def test_launches_carry_whole_planes(designs):
    path = designs / "compass-15-5-1.toml"
    by_six = compass.deploy(path, satellites_a_launch=6).to_dict()
    assert (by_six["launches"], by_six["planes_a_launch"], len(by_six["planes"])) == (3, 2, 1)
    alone = compass.deploy(path, satellites_a_launch=3)
    assert alone.to_dict()["launches"] == 5
    assert alone.deployment.planes == ()
    assert alone.to_dict()["chosen"]["wait_days"] == 0.0
    late = compass.deploy(path, longest_wait_days=0.5)
    assert not late.holds
    assert "no waiting orbit brings every plane in 0.5 days" in text(late.document())
    late.plot()


def test_the_table_of_a_design_is_read(designs):
    given = (designs / "compass-15-5-1.toml").read_text() + (
        "[deployment]\nsatellites_a_launch = 6\nlongest_wait_days = 100\n"
        "waiting_altitude_km = [2000, 1000]\n"
    )
    found = compass.deploy(read_design_text(given))
    assert (found.deployment.launches, found.longest_wait_days) == (3, 100.0)
    assert found.altitudes_km[[0, -1]] == pytest.approx([1000.0, 2000.0])


def test_the_page_has_a_section_where_there_are_planes(designs):
    section = deployment_section(read_design(designs / "compass-15-5-1.toml"))
    assert section.title == "Deployment"
    assert [p.stem for p in section.pictures] == ["deployment"]
    assert section.paragraphs[-1].startswith("The same by a command: compass deploy ")
    assert deployment_section(read_design(designs / "draim-four.toml")) is None
    assert deployment_section(read_design(designs / "areostationary-trio.toml")) is None


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"launch_altitude_km": 50}, "launch_altitude_km = 50: allowed 100 to"),
        ({"longest_wait_days": 0}, "longest_wait_days = 0: allowed 0.001 to"),
        ({"satellites_a_launch": 0}, "satellites_a_launch = 0: allowed 1 to"),
    ],
)
def test_deploy_refuses(designs, options, message):
    with pytest.raises(ArgumentError, match=message):
        compass.deploy(designs / "compass-15-5-1.toml", **options)


def test_orbits_that_are_no_pattern_are_refused(designs, run):
    with pytest.raises(ArgumentError, match="deploy: needs circular orbits"):
        compass.deploy(designs / "draim-four.toml")
    code, out, _ = run("deploy", designs / "compass-15-5-1.toml", "--json")
    assert code == 0
    assert json.loads(out)["launches"] == 1
