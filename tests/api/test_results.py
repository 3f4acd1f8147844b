"""What holds of every command's result."""

import json
from dataclasses import FrozenInstanceError, fields

import numpy as np
import pytest
import xarray as xr

import compass
from compass.document import html, text
from compass.document.blocks import Verdict
from compass.errors import ArgumentError

# every command once, at full length: too slow where kernels are interpreted
pytestmark = pytest.mark.slow

SMALL = {"step_deg": 15, "epochs": 6}


@pytest.fixture(scope="module")
def seed(designs):
    return designs / "compass-15-5-1.toml"


@pytest.fixture(scope="module")
def results(seed):
    return {
        "show": compass.show(seed),
        "map": compass.map(seed, **SMALL),
        "search": compass.search(fold=1, max_satellites=2, altitude_km=3e5),
        "reproduce": compass.reproduce("montenbruck2018"),
    }


NAMES = ["show", "map", "search", "reproduce"]


@pytest.mark.parametrize("name", NAMES)
def test_text_html_and_json_come_from_one_result(results, name):
    found = results[name]
    page = found.document()
    assert isinstance(page.blocks[0], Verdict)  # the answer first
    assert str(found) == repr(found) == text(page)
    assert found._repr_html_() == html(page)
    json.dumps(found.to_dict(), allow_nan=False)
    with pytest.raises(FrozenInstanceError):
        setattr(found, fields(found)[0].name, None)


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("show", ["{seed}"]),
        ("map", ["{seed}", "--step-deg", 15, "--epochs", 6]),
        ("search", ["--fold", 1, "--max-satellites", 2, "--altitude-km", 3e5]),
        ("reproduce", ["montenbruck2018"]),
    ],
)
def test_the_command_prints_it(run, results, seed, name, arguments):
    filled = [str(a).format(seed=seed) for a in arguments]
    code, out, _ = run(name, *filled)
    assert (code, out) == (0 if results[name].holds else 1, str(results[name]) + "\n")
    shown, known = json.loads(run(name, *filled, "--json")[1]), results[name].to_dict()
    for made in (shown, known):  # when and by which command is not the same
        for key in ("history", "command_line", "design_file"):
            made.get("provenance", {}).pop(key, None)
    assert shown == known


def test_a_search_without_success_says_so():
    none = compass.search(fold=1, max_satellites=2, altitude_km=300)
    assert not none.holds and none.to_dict()["smallest"] is None
    assert "no walker-delta of up to 2 satellites" in str(none)
    with pytest.raises(ArgumentError, match="no walker-delta of up to 2"):
        none.write("nowhere.toml")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"orbit": "low"}, "orbit = 'low': allowed areosynchronous"),
        ({"altitude_km": 300, "figure": "iau-ellipsoid"}, "figure = 'iau-ellipsoid': allowed"),
        ({"altitude_km": 300, "pattern": "flower"}, "pattern = 'flower': allowed walker-delta"),
    ],
)
def test_bad_options_of_a_search(options, message):
    with pytest.raises(ArgumentError, match=message):
        compass.search(fold=1, max_satellites=2, **options)


def test_an_unknown_paper():
    with pytest.raises(ArgumentError, match="paper = 'nobody': not known; allowed kelly2018"):
        compass.reproduce("nobody")


def test_a_map_is_a_dataset_a_file_and_pictures(results, seed, tmp_path):
    found = results["map"]
    found.write(tmp_path / "m.nc", time_series=True)
    with xr.open_dataset(tmp_path / "m.nc", engine="h5netcdf") as read:
        np.testing.assert_array_equal(read.count_min, found.dataset.count_min)
    axes = found.plot("pdop", percentile=50)
    assert axes.get_title() == "COMPASS 15/5/1: PDOP, 50th percentile over time"
    for name in ("count_min", "count_mean", "availability", "longest_gap"):
        assert found.plot(name).get_title().startswith("COMPASS 15/5/1: ")
    with pytest.raises(ArgumentError, match="name = 'dop': not a map; allowed count_min"):
        found.plot("dop")
    with pytest.raises(ArgumentError, match="percentile = 90: allowed 50 or 95"):
        found.plot("gdop", percentile=90)


def test_a_map_that_misses_the_fold_says_so(seed):
    assert str(compass.map(seed, fold=9, **SMALL)).startswith("COMPASS 15/5/1: MISSED: 4 to ")


def test_what_show_says_of_explicit_elements(designs):
    for path in sorted(designs.glob("*.toml")):
        if 'pattern = "elements"' in path.read_text():
            found = compass.show(path)
            assert found.geometry is None and "orbits of their own" in str(found)
            assert found.to_dict()["cap"] is None
            return
    raise AssertionError("no design with explicit elements")
