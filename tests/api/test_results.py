"""What holds of every command's result."""

import json
import re
from dataclasses import FrozenInstanceError, fields, replace

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

import compass
from compass.cli.main import program
from compass.document import html, text
from compass.errors import ArgumentError
from tests.evidence import unknown, unknown_variables

# every command once, at full length: too slow where kernels are interpreted
pytestmark = pytest.mark.slow

SEED = "compass-15-5-1.toml"
SMALL = {"step_deg": 15, "epochs": 6}


@pytest.fixture(scope="module")
def seed(designs):
    return designs / "compass-15-5-1.toml"


def horizon(designs, folder):
    """Horizons of some stations on flat ground."""
    flat = xr.Dataset(
        {"height": (("lat", "lon"), np.zeros((181, 361)), {"units": "m"})},
        {"lat": np.r_[-90:91.0], "lon": np.r_[-180:181.0]},
    )
    flat.to_netcdf(folder / "flat.nc", engine="h5netcdf")
    return compass.horizon(designs / "five-landing-sites.toml", folder / "flat.nc", azimuths=8)


def optimize(designs):
    """Best directions: the quickest search there is."""
    scenario = compass.read_scenario(designs / "entry-ground-beacons.toml")
    task = scenario.optimize.model_copy(update={"what": "directions", "starts": 2})
    return compass.optimize(replace(scenario, optimize=task))


#: One of every command, but for those that write files or draw pages for whole minutes.
MAKERS = {
    "show": lambda designs, _: compass.show(designs / SEED),
    "map": lambda designs, _: compass.map(designs / SEED, **SMALL),
    "fold": lambda designs, _: compass.fold(designs / SEED),
    "check": lambda designs, _: compass.check(designs / SEED),
    "search": lambda *_: compass.search(fold=1, max_satellites=2, altitude_km=3e5),
    "access": lambda designs, _: compass.access(
        designs / SEED, stations=["Gale=-4.6,137.4"], duration_sols=0.2
    ),
    "series": lambda designs, _: compass.series(
        designs / SEED, stations=["Gale=-4.6,137.4"], days=0.2, epochs=20
    ),
    "land": lambda designs, _: compass.land(designs / "entry-ground-beacons.toml", runs=2),
    "drift": lambda designs, _: compass.drift(designs / SEED, days=1),
    "keep": lambda designs, _: compass.keep(designs / SEED, years=0.1),
    "deploy": lambda designs, _: compass.deploy(designs / SEED),
    "determine": lambda designs, _: compass.determine(designs / "tracked-15-5-1.toml", days=0.1),
    "locate": lambda designs, _: compass.locate(
        designs / "tracked-15-5-1.toml", site="rover=18.4,77.5", hours=0.2
    ),
    "horizon": horizon,
    "optimize": lambda designs, _: optimize(designs),
    "trade": lambda designs, folder: compass.trade(
        designs / "study-small.toml", store=folder / "store", workers=1
    ),
    "reproduce": lambda *_: compass.reproduce("montenbruck2018"),
    "export": lambda designs, _: compass.export(designs / SEED, format="toml"),
    "new": lambda *_: compass.new("design"),
    "schema": lambda *_: compass.schema("design"),
    "version": lambda *_: compass.version(),
}
GRIDDED = {"map", "access", "series", "land", "drift", "determine", "horizon", "trade"}
#: What is a text or a table has nothing to draw.
UNDRAWN = {"reproduce", "export", "new", "schema", "version"}


@pytest.fixture(scope="module")
def results(designs, tmp_path_factory):
    """What each command found, made when first asked for."""
    folder, made = tmp_path_factory.mktemp("results"), {}

    class Results:
        def __getitem__(self, name):
            if name not in made:
                made[name] = MAKERS[name](designs, folder)
            return made[name]

    return Results()


def test_every_command_is_looked_at():
    judged = {"judge", "report", "view", "warm"}  # their own tests have them
    commands = {name for name in program.list_commands(None) if name not in judged}
    assert commands == set(MAKERS)


@pytest.mark.parametrize("name", MAKERS)
def test_text_html_and_json_come_from_one_result(results, name):
    found = results[name]
    page = found.document()
    files = ("new", "schema")  # they print as they are
    assert name in files or str(found) == repr(found) == text(page)
    assert found._repr_html_() == html(page)
    json.dumps(found.to_dict(), allow_nan=False)
    with pytest.raises(FrozenInstanceError):
        setattr(found, fields(found)[0].name, None)


@pytest.mark.parametrize("name", MAKERS)
def test_no_share_and_no_percentile_stands_alone(results, name):
    if name != "schema":  # which says what files may hold, and has no values
        assert unknown(results[name].to_dict()) == []
    if name in GRIDDED:
        assert unknown_variables(results[name].dataset) == []


@pytest.mark.parametrize("name", sorted(set(MAKERS) - UNDRAWN))
def test_a_result_draws_itself_on_given_and_on_new_axes(results, name):
    axes = Figure().add_subplot()
    assert results[name].plot(axes=axes) is axes
    assert axes.has_data() or name == "search"  # which found nothing
    assert axes.get_title() and (axes.get_xlabel() or name == "map")
    if name not in ("map", "fold"):  # drawn elsewhere, and slow to draw
        assert results[name].plot() is not axes


@pytest.mark.parametrize("name", sorted(GRIDDED))
def test_a_dataset_says_what_it_holds_and_when(results, name):
    made = results[name].dataset
    decoded = xr.decode_cf(made)
    for key in ("time", "start", "end"):
        if key in made.variables:
            assert decoded[key].dtype.kind == "M"  # a date
            assert made[key].attrs["units"].startswith("seconds since ")
    for key, variable in made.data_vars.items():
        if variable.dtype.kind == "f":
            assert {"units", "long_name"} <= set(variable.attrs), key


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
    missed = str(compass.map(seed, fold=9, **SMALL))
    assert missed.startswith("COMPASS 15/5/1: MISSED: 4 to ")
    assert "(95 % of area and time); between proven bounds" in missed
    (fewest,) = (line for line in missed.splitlines() if line.startswith("fewest satellites"))
    assert "over area and time (between proven bounds, where nothing else is said)" in missed
    assert fewest.split()[4:] == ["4"]
    (longest,) = (line for line in missed.splitlines() if line.startswith("longest time below"))
    assert "  ∞  " in longest and "∞ ±" not in missed
    shares = [line for line in missed.splitlines() if line.startswith("share of area and time, at")]
    assert len(shares) == 6 and not [line for line in shares if "sampled" in line]
    (hdop,) = (line for line in missed.splitlines() if line.startswith("HDOP"))
    assert re.search(
        r"  bounds that hold in 95 of 100 cases, [\d,]+ random places and moments$", hdop
    )


def test_what_show_says_of_explicit_elements(designs):
    for path in sorted(designs.glob("*.toml")):
        if 'pattern = "elements"' in path.read_text():
            found = compass.show(path)
            assert found.geometry is None and "orbits of their own" in str(found)
            assert found.to_dict()["cap"] is None
            return
    raise AssertionError("no design with explicit elements")
