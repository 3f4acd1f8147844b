"""Maps of users in orbit: against one user at a time, draws, proven bounds and requirements."""

from dataclasses import replace

import numpy as np
import pytest

import compass
from compass.coverage.certified_share import certified_folds
from compass.coverage.errors import ERRORS
from compass.coverage.in_view import satellites_in_view
from compass.coverage.maps import DOPS
from compass.coverage.moving import (
    Mover,
    Sights,
    dilutions_along,
    fix_errors,
    metre_ranges,
    seen_along,
    sights_along,
)
from compass.coverage.protection import LEVELS, levels_along
from compass.coverage.requirement_verdict import verdict_of
from compass.design import Design
from compass.errors import ArgumentError
from compass.frames import FIGURES, direction
from compass.integrity import Integrity
from compass.orbits import walker_delta
from compass.ranging import Receiver, Signal
from compass.requirement import Requirement
from compass.sites import Mask
from compass.study.mapping import MapOptions, MapRows, make_map
from tests.reference.conventions import assert_in_conventions

PATTERN = walker_delta(24, 6, 1, inclination_deg=55, radius_km=12000)
SIGNAL = Signal(
    frequency=4e8,
    clock_sigma=1.0,
    ephemeris=(2, 8, 5),
    receiver=Receiver(0.5, 0.5),
    ionosphere=10.0,
    common_time=3.0,
    common_orientation=1e-6,
)
SEED = Design(PATTERN, mask=Mask.of(5), signal=SIGNAL, integrity=Integrity())

#: Of users: above the ground inside the shell, over a level horizon and looking down, on an
#: ellipsoid, in beams, and above the shell, who see across Mars.
STANDING = {
    "high": {"altitude_km": 400.0},
    "down": {"altitude_km": 2000.0, "mask_deg": -30.0},
    "beams": {"altitude_km": 400.0, "mask_deg": -10.0, "beam_deg": 17.0},
    "ground-beams": {"beam_deg": 14.0},
    "above": {"altitude_km": 15000.0, "mask_deg": -78.0},
}


def one_at_a_time(design, options):
    """Who is seen, dilutions, errors and levels of the user of every cell, at every epoch."""
    rows = MapRows(design, options)
    figure, times, beam = design.figure, rows.times, rows.users.beam
    found = []
    for latitude in rows.grid.latitude:
        for longitude in rows.grid.longitude:
            out = direction(latitude, longitude)
            axis = np.array([figure.equatorial_radius] * 2 + [figure.polar_radius])
            ground = out / np.linalg.norm(out / axis)
            up = ground / axis**2
            up /= np.linalg.norm(up)
            east = np.array([-np.sin(longitude), np.cos(longitude), 0.0])
            axes = np.tile(np.stack([east, np.cross(up, east), up]), (times.size, 1, 1))
            place = np.tile(ground + rows.users.height * up, (times.size, 1))
            user = Mover("", place, axes, rows.mask)
            seen = seen_along(design, user, times, rows.motion, beam)
            dops = dilutions_along(design, user, Sights(*seen, metre_ranges(*seen[1].shape)))
            sights = sights_along(design, user, times, rows.motion, beam=beam)
            errors = fix_errors(design, user, sights)
            levels, _ = levels_along(design, user, sights)
            found.append((seen[1].sum(axis=1), dops, errors, levels))
    return rows, found


@pytest.mark.parametrize("figure", ["iau-sphere", "iau-ellipsoid"])
@pytest.mark.parametrize("name", STANDING)
def test_every_cell_has_what_its_user_has(name, figure):
    options = MapOptions(step_deg=45, epochs=7, **STANDING[name])
    design = replace(SEED, figure=figure)
    rows, found = one_at_a_time(design, options)
    data = make_map(design, options).dataset
    counts = np.array([each[0] for each in found]).reshape(*data.count_min.shape, -1)
    np.testing.assert_array_equal(data.count_min, counts.min(axis=-1))
    np.testing.assert_array_equal(data.count_max, counts.max(axis=-1))
    np.testing.assert_allclose(data.count_mean, counts.mean(axis=-1), rtol=1e-6)
    assert counts.max() >= 4  # there is something to compare
    rank = int(np.ceil(0.95 * rows.times.size)) - 1

    def compared(maps, values):
        p95 = np.sort(np.array(values), axis=-1)[:, rank].reshape(counts.shape[:2])
        # near singular geometries rounding is as large as the value squared
        good = p95 < 1e3
        np.testing.assert_allclose(maps.sel(percentile=95).values[good], p95[good], rtol=1e-4)

    for dop in DOPS:
        compared(data[dop], [each[1][dop] for each in found])
    for k, error in enumerate(ERRORS):
        compared(data[error], [each[2][:, k] for each in found])
    for level in LEVELS:
        compared(data[level], [each[3][level] for each in found])


def test_proven_bounds_draws_and_a_requirement_say_the_same():
    """Of users above a horizon for ever, and in beams that a horizon stands for."""
    asked = {"altitude_km": 400.0, "mask_deg": -10.0, "beam_deg": 17.0}
    design = replace(SEED, signal=None, integrity=None)
    found = compass.map(design, step_deg=45, epochs=5, pdop_max=3.0, width=0.05, **asked)
    low, high = found.certified.brackets["availability"]
    bounds = found.numbers()
    drawn = np.mean(found.drawn.values["pdop"] <= 3.0)
    sigma = 0.5 / np.sqrt(found.drawn.count.size)
    assert low - 4 * sigma <= drawn <= high + 4 * sigma
    wanted = Requirement.of(
        "shell", pdop_at_most=3.0, share=0.5 * (low + high), share_of="area-time", **asked
    )
    share = verdict_of(design, wanted).share
    assert share[0] <= high and low <= share[1]
    assert bounds["availability_bracket"] == [low, high]
    shares = bounds["fold_share"]
    for count in range(1, found.dataset.attrs["wanted_fold"] + 1):
        seen = np.mean(found.drawn.count >= count)
        share_low, share_high = shares[f"{count}_bracket"]
        assert share_low - 4 * sigma <= seen <= share_high + 4 * sigma
    mean_low, mean_high = bounds["count"]["mean_bracket"]
    assert mean_low - 0.05 <= found.drawn.count.mean() <= mean_high + 0.05
    assert bounds["count"]["min_bracket"][0] <= found.drawn.count.min()
    assert found.drawn.count.max() <= bounds["count"]["max_bracket"][1]
    # without beams more are in view
    whole = verdict_of(design, replace(wanted, beam=None)).share
    assert whole[0] > high


def test_it_is_said_whose_map_it_is(tmp_path):
    found = compass.map(
        SEED, step_deg=45, epochs=3, width=0.1, altitude_km=400, mask_deg=-10, beam_deg=17
    )
    words = ", 400 km above the ground, in beams of 17 deg"
    assert found.users == words
    assert f"a user anywhere{words}: " in str(found) and f"of users{words[1:]};" in str(found)
    assert words in found.to_dict()["evidence"]["others"]
    provenance = found.to_dict()["provenance"]
    assert (provenance["user_altitude_km"], provenance["beam_deg"]) == (400.0, 17.0)
    assert found.plot("gdop").get_title().startswith(f"{SEED.name}{words}: ")
    found.write(tmp_path / "shell.nc", time_series=True)
    assert_in_conventions(tmp_path / "shell.nc")
    ground = compass.map(SEED, step_deg=45, epochs=3, width=0.1)
    assert ground.users == "" and "beam_deg" not in ground.dataset.attrs
    assert "a rover anywhere: " in str(ground)


def test_the_time_series_are_of_the_same_users(tmp_path):
    import xarray as xr

    found = compass.map(SEED, step_deg=45, epochs=3, width=0.1, altitude_km=2000, mask_deg=-30)
    found.write(tmp_path / "shell.nc", time_series=True)
    with xr.open_dataset(tmp_path / "shell.nc", engine="h5netcdf") as read:
        np.testing.assert_array_equal(read.count_series.min("time"), read.count_min)
        np.testing.assert_array_equal(read.count_series.max("time"), read.count_max)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"mask_deg": -5}, "mask_deg = -5: allowed 0 up to below 90 degrees; below 0 is of users"),
        ({"altitude_km": 400, "mask_deg": -40}, "below the limb of Mars as seen from 400 km"),
        ({"altitude_km": -1}, r"altitude_km = -1: allowed 0 to"),
        ({"beam_deg": 0}, r"beam_deg = 0: allowed above 0"),
        ({"altitude_km": 400, "sites": ["a=0,0"]}, "is of regions; sites have their own height_km"),
    ],
)  # fmt: skip
def test_what_no_user_can_be_is_told(options, said):
    with pytest.raises(ArgumentError, match=said):
        compass.map(SEED, step_deg=45, epochs=3, width=0.1, **options)


@pytest.mark.slow
def test_beams_over_an_ellipsoid_have_bounds_and_take_satellites_away():
    c, flat = PATTERN, FIGURES["iau-ellipsoid"]
    folds = range(1, c.size + 1)
    asked = {"figure": flat, "mask": Mask.of(5)}
    wide, narrow = (
        satellites_in_view(
            c,
            dict(zip(folds, certified_folds(c, folds, width=0.02, **asked, **beam), strict=True)),
            (0, c.size),
            **asked,
            **beam,
        )
        for beam in ({}, {"beam": np.radians(14)})
    )
    assert 0.0 < narrow.mean[0] < narrow.mean[1] < wide.mean[0]
    assert narrow.least[1] <= wide.least[0] and narrow.most[1] < wide.most[0]
