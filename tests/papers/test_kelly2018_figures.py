"""The paper's figures: their data by a second way, and that each is drawn."""

from xml.etree import ElementTree

import matplotlib.image
import numpy as np
import pytest
import xarray as xr

import compass
from compass.api.reproduce import ReproduceResult
from compass.coverage.gap import gap
from compass.papers import kelly2018_figures as figures
from compass.papers.verdict import compare
from compass.pictures.kelly2018 import draw_figure, seen
from tests.reference.conventions import assert_in_conventions

SPHERE = 3396.2e3


def test_the_figures_are_those_of_the_paper():
    assert [f.number for f in figures.FIGURES_OF_THE_PAPER] == [1, 4, 5, 6, 7, 8, 9]


def test_figure_1_links_what_stands_above_the_horizon():
    data = figures.navigation_structure()
    for site in (0, 1):
        place = data.ground_place.values[site]
        up = place / np.linalg.norm(place)
        above = (data.satellite_place.values - place) @ up > 0
        np.testing.assert_array_equal(data.in_view.values[site], above)
    assert data.in_view.values.sum(axis=1).min() >= 4


def test_figure_4_orbits_are_circles_through_their_satellites():
    data = figures.orbits()
    radii = np.linalg.norm(data.track.values, axis=2)
    np.testing.assert_allclose(radii, 20427e3, rtol=1e-12)
    for k in range(15):
        track = data.track.values[k // 3]
        off = np.linalg.norm(track - data.satellite_place.values[k], axis=1).min()
        assert off < np.pi * 20427e3 / 180


def test_figure_5_leaves_what_the_geometry_leaves():
    data = figures.planar_coverage(1.0)
    share = np.cos(np.radians(data.lat)) / np.cos(np.radians(data.lat)).sum()
    bare = ((data["count"] == 0).mean("lon") * share).sum("lat").values
    # two satellites leave what is more than 90 deg less the cap from the ring between them
    two = 1 - (1 - SPHERE / 20427e3)
    assert bare == pytest.approx([two, 2 * gap(20427e3, SPHERE, 3).fraction], abs=2e-3)


def test_every_satellite_is_in_view_of_the_stations_drawn(monkeypatch):
    monkeypatch.setattr(figures, "SPAN", 25 * 3600.0)
    data = figures.equatorial_profile()
    counts = data["count"].values.reshape(2, 15)
    assert (counts.sum(axis=0) > 0).all()
    polar = figures.polar_profile()
    assert (polar["count"].values >= 1).all()


def test_places_behind_mars_are_hidden():
    x, y, hidden = seen(np.array([[0.0, 0.0, 3 * SPHERE], [1.0, 0.0, 0.0], [-1.0, 1.0, -1.0]]))
    assert x[0] == pytest.approx(0.0)
    assert y[0] == pytest.approx(3 * np.cos(np.radians(25.0)))
    assert hidden.tolist() == [False, False, True]


@pytest.mark.slow
def test_the_command_s_folder(tmp_path, run, monkeypatch):
    from compass.papers import kelly2018

    monkeypatch.setattr(kelly2018, "rows", lambda: [compare("x", "Table 9", "1.0", 1.0)])
    code, _, err = run("reproduce", "kelly2018", "-o", tmp_path / "out")
    assert code == 0
    assert "wrote" in err
    made = sorted((tmp_path / "out").iterdir())
    stems = [f"figure-{n}" for n in (1, 4, 5, 6, 7, 8, 9)]
    assert sorted({path.stem for path in made}) == [*stems, "rows"]
    assert len(made) == 2 * len(stems) + 1
    for path in made:
        if path.suffix == ".png":
            assert matplotlib.image.imread(path).std() > 0.02
        if path.suffix == ".svg":
            assert len(ElementTree.parse(path).findall(".//{*}path")) > 10
    with xr.open_dataset(tmp_path / "out" / "figure-7.nc", engine="h5netcdf") as read:
        assert read.sizes["pair"] == 15
    assert "Table 9" in (tmp_path / "out" / "rows.csv").read_text()
    assert_in_conventions(*(tmp_path / "out" / f"{stem}.nc" for stem in stems))


def test_a_paper_without_figures_writes_its_rows(tmp_path):
    found = ReproduceResult("lou2017", "t", (compare("x", "Table 9", "1.0", 1.0),))
    assert found.pictures() == ()
    found.write(tmp_path / "rows")
    assert [path.name for path in (tmp_path / "rows").iterdir()] == ["rows.csv"]
    (tmp_path / "file").write_text("")
    with pytest.raises(compass.errors.OutputError, match="is a file; give a folder"):
        found.write(tmp_path / "file")


@pytest.mark.parametrize("number", [1, 4, 5])
def test_a_figure_is_drawn(number):
    figure = next(f for f in figures.FIGURES_OF_THE_PAPER if f.number == number)
    image = draw_figure(number, figure.title, figure.make())
    assert image.stem == f"figure-{number}"
    assert image.drawn.startswith((b"\x89PNG", b"<svg"))
