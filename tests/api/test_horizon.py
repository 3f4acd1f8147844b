"""Horizons of stations from a grid of heights, written into a design file and read again."""

import numpy as np
import pytest
import xarray as xr

import compass
from compass.errors import ArgumentError
from compass.inputs import read_design

DESIGN = """
name = "one"
[constellation]
pattern = "walker-delta"
satellites = 3
planes = 1
phasing = 0
inclination_deg = 0
radius_km = 20000
{station}
"""
STATION = """
[[station]]
name = "S"
latitude_deg = 0
longitude_deg = 10
[[requirement]]
sites = ["S"]
fold = 1
"""


@pytest.fixture
def wall(tmp_path):
    """Flat ground of 100 m but for a ridge of 3 km along the meridian 0.5 degrees to the east."""
    lat, lon = np.linspace(-2, 2, 17), np.linspace(8, 12, 33)
    height = np.full((17, 33), 100.0)
    height[:, np.isclose(lon, 10.5)] = 3000.0
    data = {"z": (("lat", "lon"), height, {"units": "m"})}
    xr.Dataset(data, {"lat": lat, "lon": lon}).to_netcdf(tmp_path / "z.nc", engine="h5netcdf")
    return tmp_path / "z.nc"


def test_the_ridge_stands_in_the_file_and_counts_in_the_requirement(wall, tmp_path, run):
    path, out = tmp_path / "one.toml", tmp_path / "out.toml"
    path.write_text(DESIGN.format(station=STATION))
    code, printed, _ = run("horizon", path, "--terrain", wall, "--azimuths", 16, "-o", out)
    assert code == 0
    found = compass.horizon(path, wall, azimuths=16)
    assert printed == str(found) + "\n"
    (known,) = found.to_dict()["stations"]
    assert known["height_km"] == pytest.approx(0.1)
    # due east: 3 km at 0.5 degrees of arc, seen from 0.1 km over a sphere
    r, away = 3396190.0, np.radians(0.5)
    up, along = (r + 3000) * np.cos(away) - (r + 100), (r + 3000) * np.sin(away)
    east = dict(map(tuple, known["horizon_deg"]))[90.0]
    assert east == pytest.approx(np.degrees(np.arctan2(up, along)), abs=1e-6)
    again = read_design(out)
    assert again.stations[0].mask.highest == pytest.approx(np.radians(east), abs=1e-9)
    assert again.requirements[0].sites[0].mask == again.stations[0].mask


def test_what_has_no_horizon_is_told(wall, tmp_path):
    path = tmp_path / "none.toml"
    path.write_text(DESIGN.format(station=""))
    with pytest.raises(ArgumentError, match="stations: there are none; add a"):
        compass.horizon(path, wall)
    path.write_text(DESIGN.format(station=STATION))
    with pytest.raises(ArgumentError, match="above_m = -1: allowed 0 to 100000 metres"):
        compass.horizon(path, wall, above_m=-1)
