"""Errors of users over time: as the map has them, and fix by fix."""

import numpy as np
import pytest
import xarray as xr

import compass
from compass.coverage.errors import ERRORS, error_map
from compass.coverage.grid import make_grid
from compass.coverage.moving import (
    Sights,
    errors_along,
    fix_errors,
    in_orbit,
    on_route,
    ranges_at,
    seen_along,
    standing,
)
from compass.coverage.view import view
from compass.design import Design
from compass.errors import ArgumentError, OutputError
from compass.frames import figure_of, mcmf_from_mci, prime_meridian_angle
from compass.orbits import keplerian, states_mci, walker_delta
from compass.ranging import Receiver, Signal
from compass.signal.ranges import radial_along_cross, range_errors
from compass.sites import Mask, Site

TIMES = np.array([0.0, 5000.0, 20000.0])


@pytest.fixture(scope="module")
def design():
    signal = Signal(
        ephemeris=(2, 8, 5), clock_sigma=3, receiver=Receiver(0.5, 0.5), ionosphere=30.0,
        frequency=4e8, common_time=2.0, common_orientation=1e-6,
    )  # fmt: skip
    c = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
    mask = Mask.constant(np.radians(5.0))
    return Design(constellation=c, name="d", figure="kelly2018-sphere", mask=mask, signal=signal)


@pytest.mark.parametrize("weights", ["variance", "equal"])
def test_who_stands_in_a_cell_has_the_errors_of_the_map(design, weights):
    """The map keeps its errors in single precision."""
    grid = make_grid("equal-angle", 60)
    for time in TIMES:
        seen = view(design.constellation, [time], design.figure.equatorial_radius, design.mask)
        made = error_map(seen, grid, range_errors(design, [time], weights=weights), workers=1)
        ranges = ranges_at(design, np.array([time]), design.motion, weights)
        for i, latitude in enumerate(grid.latitude):
            for j, longitude in enumerate(grid.longitude):
                site = Site("s", latitude, longitude, 0.0, design.mask, design.figure)
                user = standing(site, 1)
                sights = Sights(*seen_along(design, user, np.array([time]), design.motion), ranges)
                found = fix_errors(design, user, sights)
                assert sights.around[0] >= 4
                if weights == "variance":
                    np.testing.assert_array_equal(
                        found, errors_along(design, user, np.array([time]))[1]
                    )
                for k, name in enumerate(ERRORS):
                    there = float(made[name].sel(percentile=50).values[i, j])
                    assert found[0, k] == pytest.approx(there, rel=2e-5)


def test_a_rover_goes_evenly_over_the_ground_and_knows_what_a_site_there_does(design):
    figure = figure_of("iau-ellipsoid")
    places = np.radians([[0.0, 350.0], [40.0, 10.0], [80.0, 10.0]])
    rover = on_route("r", places, figure, design.mask, np.linspace(0, 1, 101))
    unit = rover.r / np.linalg.norm(rover.r, axis=1, keepdims=True)
    steps = np.arccos((unit[1:] * unit[:-1]).sum(axis=1))
    assert np.delete(steps, np.argmin(steps)) == pytest.approx(steps.max(), rel=1e-6)
    total = np.arccos(np.sin(0) + np.cos(places[1, 0]) * np.cos(np.radians(20))) + np.radians(40)
    assert steps.max() == pytest.approx(total / 100, rel=1e-9)
    for at, (lat, lon) in ((0, places[0]), (100, places[2])):
        site = Site("s", lat, lon - 2 * np.pi * (lon > np.pi), figure=figure)
        np.testing.assert_allclose(rover.r[at], site.r_mcmf, rtol=0, atol=1e-3)
        np.testing.assert_allclose(rover.axes[at], site.enu_mcmf, atol=1e-9)


def test_an_orbiter_hears_what_mars_and_the_beams_leave(design):
    """Every fix written out: lines that meet the sphere by their nearest point on the segment."""
    orbit = keplerian(9000e3, 0.1, 1.2, 0.3, 0.2, 0.1, satellite_names=["o"])
    c, radius, beam = design.constellation, design.figure.equatorial_radius, np.radians(35.0)
    mover = in_orbit(orbit, c.epoch, TIMES, design.figure)
    count, found, around = errors_along(design, mover, TIMES, beam=beam)
    plain, _, same = errors_along(design, mover, TIMES)
    r, v = states_mci(c, TIMES)
    own = states_mci(orbit, TIMES)[0][0]
    angle = prime_meridian_angle(c.epoch, TIMES)
    np.testing.assert_allclose(mover.r, mcmf_from_mci(own, angle), rtol=1e-12)
    p = np.diag([2.0, 8.0, 5.0, 3.0]) ** 2
    some_hidden = False
    for t in range(TIMES.size):
        rows, weights, total = [], [], 0
        up = own[t] / np.linalg.norm(own[t])
        for s in range(c.size):
            line = r[s, t] - own[t]
            share = np.clip(-own[t] @ line / (line @ line), 0, 1)
            free = np.linalg.norm(own[t] + share * line) > radius
            some_hidden |= not free
            total += free
            u = line / np.linalg.norm(line)
            inside = np.arccos(u @ r[s, t] / np.linalg.norm(r[s, t])) <= beam
            if free and inside:
                rac = np.append(radial_along_cross(r[s, t], v[s, t]) @ u, 1.0)
                rows.append([*-u, 1.0])
                weights.append(1 / (rac @ p @ rac + 1.0))
        assert (count[t], plain[t]) == (len(rows), total)
        assert (around[t], same[t]) == (total, total)
        if len(rows) < 4:
            assert np.isinf(found[t]).all()
            continue
        g = np.array(rows)
        cov = np.linalg.inv(g.T @ (np.array(weights)[:, None] * g))
        tilt = 2 * (radius * 1e-6) ** 2
        vertical = up @ cov[:3, :3] @ up
        whole = np.trace(cov[:3, :3])
        expected = [whole - vertical + tilt, vertical, whole + tilt, cov[3, 3] + 4.0]
        np.testing.assert_allclose(found[t], np.sqrt(expected), rtol=1e-9)
    assert some_hidden and np.isfinite(found).any()


def test_lines_that_tell_no_fix_are_told_apart(design):
    """Four satellites in one direction cannot be inverted, whatever rounding makes of it."""
    c = keplerian(20427e3, 0.0, 0.0, 0.0, 0.0, np.full(4, 0.01), epoch=design.constellation.epoch)
    d = Design(constellation=c, name="d", signal=Signal(clock_sigma=3, receiver=Receiver(0.5)))
    under = mcmf_from_mci(states_mci(c, [0.0])[0][0], prime_meridian_angle(c.epoch, [0.0]))[0]
    site = Site("s", 0.0, float(np.arctan2(under[1], under[0])), figure=d.figure)
    count, found, _ = errors_along(d, standing(site, 1), np.zeros(1))
    assert count[0] == 4 and np.isinf(found).all()


def test_series_tells_errors_of_all_who_are_named(design, tmp_path):
    site = compass.Site.of("S", latitude_deg=12, longitude_deg=40, figure=design.figure)
    asked = {"stations": [site], "days": 0.2, "epochs": 7}
    found = compass.series(
        design, **asked, routes=["rover=0,0;10,10;20,5"], orbiters=["low=3800,0,90,0,0,0"]
    )
    rows = found.to_dict()["users"]
    assert [row["user"] for row in rows] == ["S", "rover", "low"]
    assert all(row["fix_share"] == 1.0 for row in rows)
    assert all(row["error_horizontal_m"]["p50"] <= row["error_horizontal_m"]["worst"]
               for row in rows)  # fmt: skip
    assert "Errors of fixes over time" in str(found)
    assert "because of beams" not in " ".join(str(found).split())
    narrow = compass.series(design, **asked, beam_deg=7.0)
    (row,) = narrow.to_dict()["users"]
    around = narrow.errors["in_view_all_around"].values[0]
    heard = narrow.errors["in_view"].values[0]
    assert row["beyond_beam_share"] == np.mean((heard < 4) & (around >= 4)) > 0.5
    assert (around == found.errors["in_view"].values[0]).all()
    told = " ".join(str(narrow).split())
    assert "fewer because of beams alone, %" in told and "within 7 deg of its way down" in told
    found.write(tmp_path / "s.nc")
    found.save_plot(tmp_path / "s.png", "error_horizontal_m")
    with xr.open_dataset(tmp_path / "s.nc", engine="h5netcdf") as data:
        assert data["error_position_m"].dims == ("user", "time") and data.sizes["user"] == 3
    dense = compass.series(design, stations=[site], days=0.2, epochs=1001)
    for name in ("error_horizontal_m", "error_time_m"):
        values = dense.errors[name].values[0]
        for percent in (50, 95):
            low, high = rows[0][name][f"p{percent}_interval"]
            assert (values < low).mean() <= percent / 100 <= (values <= high).mean()
    assert "users" not in compass.series(Design(design.constellation, "bare"), **asked).to_dict()


def test_who_moves_needs_no_station(design, tmp_path):
    """The same errors as beside a station; there is nothing of stations to draw or to write."""
    site = compass.Site.of("S", latitude_deg=12, longitude_deg=40, figure=design.figure)
    asked = {"orbiters": ["low=3800,0,90,0,0,0"], "days": 0.2, "epochs": 5}
    alone, beside = (compass.series(design, stations=given, **asked) for given in ((), (site,)))
    assert alone.holds and alone.to_dict()["stations"] == []
    np.testing.assert_array_equal(
        alone.errors["error_position_m"].sel(user="low"),
        beside.errors["error_position_m"].sel(user="low"),
    )
    assert f"a fix at all {alone.drawn.sizes['time']:,} moments over 0.2 days" in str(alone)
    unheard = compass.series(design, **asked, beam_deg=2.0)
    assert "no fix at times for low" in str(unheard)
    alone.write(tmp_path / "s.nc")
    with pytest.raises(OutputError, match=r"must end in \.nc"):
        alone.write(tmp_path / "s.csv")
    with pytest.raises(ArgumentError, match="count: is of stations; add one"):
        alone.plot()


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"routes": ["rover=1,2"]}, "route 'rover=1,2': not NAME=LAT,LON;LAT,LON"),
        ({"routes": ["rover=1,2;99,2"]}, "route 'rover=99,2': latitude_deg = 99"),
        ({"routes": ["rover=1,2;1,2"]}, "route rover: leads nowhere"),
        ({"routes": ["rover=0,0;0,180"]}, "opposite each other; name one between"),
        ({"routes": ["S=0,0;0,90"]}, "user 'S': given twice; rename one"),
        ({"orbiters": ["low=3800,0,90"]}, "orbiter 'low=3800,0,90': not NAME=KM,E,INC"),
        ({"orbiters": ["low=3800,0.5,90,0,0,0"]}, "orbiter low: comes down to radius 1900 km"),
        ({"orbiters": ["low=3800,-1,90,0,0,0"]}, "orbiter 'low=3800,-1,90,0,0,0': "),
        ({"beam_deg": 0.0}, "beam_deg = 0: allowed above 0 to 90"),
    ],
)
def test_what_nobody_can_follow_is_told(design, asked, message):
    site = compass.Site.of("S", latitude_deg=12, longitude_deg=40, figure=design.figure)
    with pytest.raises(ArgumentError, match=message.replace("(", r"\(")):
        compass.series(design, stations=[site], days=0.1, epochs=2, **asked)


def test_movers_need_a_signal(design):
    site = compass.Site.of("S", latitude_deg=12, longitude_deg=40)
    with pytest.raises(ArgumentError, match="beam_deg: needs the errors of ranges; give one"):
        compass.series(Design(design.constellation, "bare"), stations=[site], beam_deg=7, epochs=2)
    with pytest.raises(ArgumentError, match=r"routes: needs .* table \[signal\]"):
        compass.series(
            Design(design.constellation, "bare"), stations=[site], routes=["r=0,0;1,1"], epochs=2
        )
