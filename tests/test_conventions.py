"""Files against the CF conventions, by a checker of others."""

import re
import sys

import numpy as np
import pytest
import xarray as xr

from compass.conventions import epoch_text, in_conventions
from compass.saving import save_netcdf
from tests.reference.conventions import assert_in_conventions


@pytest.fixture
def program(monkeypatch):
    def run(*arguments):
        from compass.cli.main import main

        monkeypatch.setattr(sys, "argv", ["compass", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        assert ended.value.code == 0

    return run


def test_maps_and_windows(program, designs, tmp_path):
    seed = designs / "compass-15-5-1.toml"
    cells = ("--step-deg", 30, "--epochs", 3)
    program("map", seed, *cells, "--time-series", "-o", tmp_path / "map.nc")
    program("access", seed, "--duration-sols", 0.2, "-o", tmp_path / "access.nc")
    flattened = tmp_path / "flattened.toml"
    unsourced = re.sub(r'source = """[^"]*"""', "", seed.read_text())  # and of an ellipsoid
    flattened.write_text(unsourced.replace("kelly2018-sphere", "iau-ellipsoid"))
    program("map", flattened, *cells, "-o", tmp_path / "flattened.nc")
    assert_in_conventions(*(tmp_path / f"{name}.nc" for name in ("map", "access", "flattened")))
    with xr.open_dataset(tmp_path / "flattened.nc", engine="h5netcdf") as read:
        assert "ellipsoid" in read.attrs["figure"]
        assert read.mars.semi_minor_axis == 3376200.0
        assert "references" not in read.attrs
    with xr.open_dataset(tmp_path / "map.nc", engine="h5netcdf") as read:
        # whoever opens it has dates
        assert read.time.values[0] == np.datetime64("2000-01-01T12:00:00")
        assert read.set_xindex("dop_name").global_dop.sel(dop_name="gdop").size == 4


@pytest.mark.slow
def test_landings(program, designs, tmp_path):
    for name in ("entry-compass", "lou2019-recommended"):
        path = tmp_path / f"{name}.nc"
        program("land", designs / f"{name}.toml", "--runs", 2, "-o", path)
        assert_in_conventions(path)


def test_what_is_put_right():
    made = in_conventions(
        xr.Dataset(
            {"x_m": ("time", [1.0, 2.0]), "place": ((), "here", {"units": "1"})},
            {
                "time": ("time", [0.0, 60.0], {"units": "s"}),
                "latitude": ("time", [1.0, 2.0]),
                "who": ("who", ["a", "b"], {"long_name": "names"}),
            },
            {"epoch_tdb": "2030-01-01T12:00:00"},
        )
    )
    assert made.x_m.attrs == {"long_name": "x m"}
    assert made.time.attrs["units"] == "seconds since 2030-01-01T12:00:00"
    assert made.latitude.attrs["standard_name"] == "latitude"
    assert made.who_name.attrs == {"long_name": "names"} and "who" not in made.coords
    assert "units" not in made.place.attrs
    assert made.attrs["Conventions"] == "CF-1.11"
    # seconds after nobody knows when stay seconds
    bare = in_conventions(xr.Dataset(coords={"time": ("time", [0.0], {"units": "s"})}))
    assert bare.time.attrs["units"] == "s" and bare.time.attrs["axis"] == "T"


def test_what_goes_in_is_left_as_it_is(tmp_path):
    data = xr.Dataset({"a": ("lat", [1.0])}, {"lat": ("lat", [2.0])})
    before = data.copy(deep=True)
    save_netcdf(tmp_path / "a.nc", data)
    xr.testing.assert_identical(data, before)


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.0, "2000-01-01T12:00:00"), (86400.5, "2000-01-02T12:00:00.500000"),
     (-43200.0, "2000-01-01T00:00:00")],
)  # fmt: skip
def test_epochs_as_text(seconds, text):
    assert epoch_text(seconds) == text


def test_names_and_units_that_others_know():
    made = in_conventions(
        xr.Dataset(
            {"a.p95": ("n", [1.0], {"units": "deg/year"}), "b": ("n", [1.0], {"units": "degree"})}
        )
    )
    assert made.a_p95.units == "degree/year" and made.b.units == "degree"
