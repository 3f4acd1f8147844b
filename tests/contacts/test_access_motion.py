"""Access on real orbits and from any day: tables of states against ellipses, and against the sky."""

import json

import numpy as np
import pytest

import compass
from compass.contacts.nodes import find_node, path_nodes, satellite_nodes
from compass.contacts.radio import node_states
from compass.contacts.survey import survey
from compass.errors import ArgumentError
from compass.frames import FIGURES, SECONDS_PER_DAY
from compass.inputs import read_design_text
from compass.links import Wanted
from compass.orbits import keplerian
from compass.orbits.motion import Motion
from compass.sites import Site

SITE = Site("Gale", np.radians(-4.6), np.radians(137.4), figure=FIGURES["iau-sphere"])

DESIGN = """
name = "two"
epoch = 2030-01-01T12:00:00
[constellation]
pattern = "walker-delta"
satellites = 2
planes = 2
phasing = 1
inclination_deg = 30
radius_km = {radius}
[motion]
model = "numerical"
gravity_degree = 3
sun = false
moons = false
radiation_m2_kg = 0
[[station]]
name = "Gale"
latitude_deg = -4.6
longitude_deg = 137.4
mask_deg = 5
"""


def two(radius=8000):
    return read_design_text(DESIGN.format(radius=radius))


def ellipses():
    return keplerian([8e6, 9e6], [0.0, 0.1], [0.6, 1.2], [0.3, 2.0], 0.4, [0.0, 2.0], epoch=9e8)


def test_a_table_of_an_ellipse_is_the_ellipse():
    c, span = ellipses(), 6 * 3600.0
    path = Motion().trajectory(c, 0.0, span)
    times = np.random.default_rng(1).uniform(0, span, 200)
    for table, ellipse in zip(path_nodes(path, 0.0, span), satellite_nodes(c), strict=True):
        miss = node_states(table, times)[:, :3] - node_states(ellipse, times)[:, :3]
        assert np.linalg.norm(miss, axis=1).max() < 0.011
        distance = np.linalg.norm(node_states(ellipse, times)[:, :3], axis=1)
        assert table.lowest <= distance.min()
        assert distance.max() <= table.highest


@pytest.mark.parametrize("start", [0.0, 7200.0])
def test_windows_on_paths_are_those_on_ellipses(start):
    c, span = ellipses(), 8 * 3600.0
    wanted = Wanted(crosslinks=True)
    ways = (
        survey(c, [SITE], start + span, wanted),
        survey(
            c, [SITE], span, wanted, path=Motion().trajectory(c, start, start + span), start=start
        ),
    )
    assert ways[1].epoch == c.epoch + start
    for whole, part in zip(*(way.windows for way in ways), strict=True):
        inside = np.clip(whole.spans - start, 0.0, span)
        inside = inside[inside[:, 1] > inside[:, 0]]
        assert part.spans == pytest.approx(inside, abs=0.005)


def test_rise_and_set_of_an_integrated_orbit_are_at_the_mask():
    design = two()
    found = compass.access(design, duration_sols=0.3, start_day=1.0)
    assert found.record["motion"].startswith("numerical motion: GMM-3")
    assert found.to_dict()["epoch_tdb_s_past_j2000"] == design.constellation.epoch + SECONDS_PER_DAY
    edges = [
        (w.second if w.first == "Gale" else w.first, t)
        for w in found.survey.windows
        for t in w.spans.ravel()
        if 1.0 < t < found.survey.duration - 1.0
    ]
    assert edges
    path = design.motion.trajectory(design.constellation, 0.0, 1.5 * SECONDS_PER_DAY)
    site = design.stations[0]
    for name, t in edges:
        k = path.satellite_names.index(name)
        ray = path.positions_mcmf([SECONDS_PER_DAY + t])[k, 0] - site.r_mcmf
        up = ray @ site.enu_mcmf[2] / np.linalg.norm(ray)
        assert np.degrees(np.arcsin(up)) == pytest.approx(5.0, abs=1e-5)
    assert found.survey.nodes and find_node(found.survey.nodes, "P1S1").states.shape[1] == 6
    assert "In numerical motion: GMM-3" in " ".join(found.notes())
    assert "Rise and set are found to 1 ms of the motion modelled" in " ".join(found.notes())


def test_a_day_that_is_none_is_refused(tmp_path, run):
    with pytest.raises(ArgumentError, match="start_day = -1"):
        compass.access(two(), start_day=-1.0)
    path = tmp_path / "d.toml"
    path.write_text(DESIGN.format(radius=8000))
    code, out, _ = run("access", path, "--duration-sols", 0.1, "--motion", "two-body", "--json")
    assert code == 0
    assert json.loads(out)["motion"] == "two-body motion"
