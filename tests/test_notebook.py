"""What a notebook does: the README's jobs and a student's sweep, with the public names alone."""

import ast
from pathlib import Path

import numpy as np
import pandas
import pytest
from matplotlib.figure import Figure

import compass

DESIGNS = Path(__file__).parents[1] / "designs"


def test_a_design_made_in_a_notebook():
    design = compass.Design(
        compass.walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427),
        figure="kelly2018-sphere",
    )
    found = compass.fold(design, fold=4)
    assert str(found.outcome) == "proven" and f"{found.mask_margin_deg:.2f}" == "6.24"
    made = compass.map(design, step_deg=15, epochs=5)
    assert made.dataset.gdop.dims == ("percentile", "lat", "lon")
    assert made.plot("gdop", percentile=95).get_title().endswith("95th percentile over time")
    assert "<table>" in made._repr_html_()
    assert compass.show(design).geometry.cap.fraction == pytest.approx(0.41687, abs=1e-5)


def test_a_students_sweep_over_inclination():
    """Which inclination leaves the highest mask? Second way: the search finds the same."""
    pattern = compass.walker_delta(5, 5, 1, inclination_deg=45, orbit="areosynchronous")
    design, margins = compass.Design(pattern, fold=1), {}
    for inclination in (40.0, 43.66, 47.0):
        margins[inclination] = compass.fold(
            design.varied(inclination_deg=inclination)
        ).mask_margin_deg
    assert max(margins, key=margins.get) == 43.66
    assert margins[43.66] == pytest.approx(11.5, abs=0.05)


def test_a_students_sweep_over_inclination_and_altitude():
    """Mask and geometry over a grid of designs, in a table and in a picture.

    Second way: what must be seen of the sky does not depend on altitude. So a mask margin says how
    wide the caps must be, ``acos(R cos(e) / r) - e``, the same from every altitude.
    """
    pattern = compass.walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
    design = compass.Design(pattern, fold=4, figure="kelly2018-sphere")
    rows = []
    for inclination in (45.0, 65.0, 70.0):
        for altitude in (14000.0, 17030.8, 20000.0):
            one = design.varied(inclination_deg=inclination, altitude_km=altitude)
            margin = compass.fold(one).mask_margin_deg
            gdop = compass.map(one, step_deg=30, epochs=3, budget_s=0.01).dataset.gdop
            best = float(gdop.sel(percentile=50).min())
            rows.append((inclination, altitude, margin, best))
    table = pandas.DataFrame(rows, columns=["inclination", "altitude", "margin", "gdop"])
    grid = table.pivot(index="inclination", columns="altitude", values="margin")
    assert f"{grid.loc[45.0, 17030.8]:.2f}" == "6.24"
    mask, radius = np.radians(grid), 3396.2 + grid.columns.to_numpy()
    caps = np.arccos(3396.2 / radius * np.cos(mask)) - mask
    np.testing.assert_allclose(caps.sub(caps[17030.8], axis=0), 0.0, atol=1e-8)
    assert set(grid.idxmax(axis=0)) == {65.0}
    assert table.gdop.between(1.5, 4.0).all() and table.gdop.nunique() == len(table)
    axes = Figure().subplots()
    axes.contourf(grid.columns, grid.index, grid)
    axes.scatter(table.altitude, table.inclination, 20 * table.gdop)


@pytest.mark.slow
def test_the_readmes_jobs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = compass.search(fold=1, max_satellites=5, orbit="areosynchronous")
    found.write("best.toml")
    best = compass.read_design("best.toml")
    assert best.constellation.size == found.best.constellation.size == 5
    seen = compass.access(best, stations=["Gale=-4.6,137.4"], duration_sols=1)
    assert seen.plot().get_title() == "Satellites in sight of Gale"
    table = pandas.DataFrame(seen.windows)
    assert table.duration_s.sum() == pytest.approx(
        float((seen.dataset.end - seen.dataset.start).sum())
    )
    assert set(table.columns) >= {"first", "second", "start_s", "max_elevation_deg"}
    flown = compass.land(DESIGNS / "entry-ground-beacons.toml", runs=3)
    assert np.isfinite(flown.to_dict()["navigation"]["position_rms_m"]).all()
    made = compass.export(best, format="czml", output="best.czml")
    assert Path("best.czml").read_text() == made.files["design.czml"]
    page = compass.report(best, output="page", step_deg=30, epochs=3).page
    assert page == Path("page/index.html") and "5/5/1" in page.read_text()


STUDY = """
name = "Five for one in view"
[study]
patterns = ["walker-delta"]
satellites = [5]
inclination_deg = [43.66, 50]
orbits = ["areosynchronous"]
mask_deg = 0
fold = 1
[map]
step_deg = 30
epochs = 2
[[constraint]]
figure = "fold_proven"
at_least = 1
[[objective]]
figure = "satellites"
[[objective]]
figure = "mask_margin_deg"
"""


@pytest.mark.slow
def test_a_students_sweep_to_a_judged_choice(tmp_path, monkeypatch):
    """From a sweep by hand to one that is stored: what either finds the other finds too."""
    monkeypatch.chdir(tmp_path)
    Path("study.toml").write_text(STUDY)
    traded = compass.trade("study.toml", workers=1)
    met = traded.dataset.where(traded.dataset.feasible, drop=True)
    pattern = compass.walker_delta(5, 5, 1, inclination_deg=50, orbit="areosynchronous")
    design = compass.Design(pattern, "Five", fold=1)
    sweep = [design.varied(inclination_deg=inclination) for inclination in (43.66, 50)]
    for one in sweep:
        alike = (met.planes == 5) & (met.phasing == 1)
        (row,) = np.flatnonzero(alike & np.isclose(met.inclination_deg, _inclination_deg(one)))
        below = compass.fold(one).mask_margin_deg - met.mask_margin_deg.values[row]
        # a screen finds caps to 5e-4, on the safe side; as caps widen, masks fall by (1 - s cos c)
        # / (1 + s^2 - 2 s cos c) of that, where s = R / r, which is 1 / (1 - s) at most
        assert 0.0 <= below <= np.degrees(5e-4) / (1.0 - 3396.19 / 20427.7)
    best = float(met.mask_margin_deg.max())
    searched = compass.search(fold=1, max_satellites=5, orbit="areosynchronous")
    assert searched.to_dict()["candidates"][0]["mask_margin_deg"] >= best - 1e-3
    seen = compass.access(sweep[0], stations=["Gale=-4.6,137.4"], duration_sols=1)
    assert seen.to_dict()["nodes"][0]["any_share"] == 1.0
    judged = compass.judge(sweep, scenario=DESIGNS / "landing.toml", samples=8, finalists=0)
    named = {row["design"] for row in judged.to_dict()["designs"]}
    assert named == {"Five, inclination 43.66 deg", "Five, inclination 50 deg"}
    for result in (traded, searched, seen, judged):
        assert str(result) and "<table>" in result._repr_html_()
        assert len(repr(result)) < 20000
    assert judged.plot().get_ylabel() == "share of entries within, %"
    assert traded.plot().get_title() == "Five for one in view"


def _inclination_deg(design):
    return float(np.degrees(design.constellation.inclination[0]))


def test_it_needs_nothing_from_a_subpackages_inside():
    tree = ast.parse(Path(__file__).read_text())
    names = [
        alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.Import)
        for alias in node.names
    ]
    froms = [node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    assert not [name for name in names + froms if name.startswith("compass.")]
