"""The globe: what it is made from, and in a browser that its numbers are the map's and it moves."""

import base64
import json

import numpy as np
import pytest

import compass
from compass.coverage.errors import error_map
from compass.coverage.grid import make_grid
from compass.coverage.site import site_coverage
from compass.coverage.view import view
from compass.inputs import read_design_text
from compass.orbits import positions_mcmf
from compass.pages.globe.scene import scene
from compass.pictures.colours import count_colours, count_map
from compass.pictures.relief import elevation, finer_shade, shade
from compass.signal.ranges import range_errors
from compass.sites import Mask, Site

OVAL = """
name = "Three & <b>more</b>"
figure = "iau-ellipsoid"
[constellation]
pattern = "elements"
satellite = [
  { name = "A", semi_major_axis_km = 12000, eccentricity = 0.3, inclination_deg = 60 },
  { name = "B", semi_major_axis_km = 14000, inclination_deg = 10, raan_deg = 20 },
]
[coverage]
mask_deg = 3
fold = 1
[[station]]
name = "</script>"
latitude_deg = 10
longitude_deg = 20
"""

#: Every term of a range's error, clocks that know of their orbits, one satellite worse.
METRES = """
name = "in metres"
figure = "iau-ellipsoid"
[constellation]
pattern = "walker-delta"
satellites = 15
planes = 5
phasing = 1
inclination_deg = 45
radius_km = 20427
[motion]
model = "j2"
[coverage]
mask_deg = 5
[[station]]
name = "A"
latitude_deg = 3
longitude_deg = 5
[[link]]
between = ["satellite", "station"]
frequency_mhz = 2200
eirp_dbw = 10
g_over_t_db_per_k = -25
[signal]
clock = "rafs"
update_h = 6
covariance_m2 = MATRICES
common_m = { time = 1.5, orientation_mas = 3 }
receiver = { noise_m = 0.5, zenith_m = 0.5, chip_m = 150 }
ionosphere_tec = 10
"""
ONE = [[4, 1, 0, 2], [1, 64, 0, -3], [0, 0, 25, 0], [2, -3, 0, 9]]
WORSE = [[900, 0, 0, 0], [0, 400, 0, 0], [0, 0, 100, 0], [0, 0, 0, 400]]


def test_paths_of_the_scene_are_those_of_the_orbits(seed_design):
    shown = scene(seed_design)
    n, samples = seed_design.constellation.size, shown["samples"]
    path = np.frombuffer(base64.b64decode(shown["path"]), "<f4").reshape(samples, n, 3)
    times = shown["step_s"] * np.arange(samples)
    wanted = np.moveaxis(positions_mcmf(seed_design.constellation, times), 0, 1) / 1e3
    assert np.abs(path - wanted).max() < 0.002  # single precision of 20,000 km
    assert times[-1] == pytest.approx(shown["duration_s"])
    assert len(shown["gaps"]) == 10 and len(shown["gaps"][0]["outline"]) == 49


def test_a_design_without_planes_has_no_gaps_and_cannot_end_its_script():
    shown = read_design_text(OVAL)
    assert scene(shown)["gaps"] == []
    page = compass.view(shown).page
    assert '</script>"' not in page and "<b>more" not in page
    frame = compass.view(shown)._repr_html_()
    assert frame.startswith("<iframe") and "<script" not in frame


def test_a_count_has_one_colour_and_too_few_are_red():
    short, long = count_colours(4, 6), count_colours(4)
    assert short == long[:7] and len(long) == 13
    assert all(red > 1.5 * max(green, blue) for red, green, blue, _ in short[:4])
    assert count_map(4, 2, 6).N == 5


def test_relief_has_the_heights_of_known_places():
    height = elevation()
    cell = {"Olympus Mons": (18.65, 226.2), "Hellas": (-42.4, 70.5), "Elysium Mons": (25.0, 147.2)}
    at = {name: height[int((90 - lat) // 2), int(lon // 2)] for name, (lat, lon) in cell.items()}
    assert at["Olympus Mons"] > 15_000 and at["Elysium Mons"] > 7_000 and at["Hellas"] < -5_000
    assert 0 <= shade().min() < 0.5 < shade().max() <= 1
    fine = finer_shade(2)
    assert fine.shape == (180, 360)
    blocks = fine.reshape(90, 2, 180, 2).mean(axis=(1, 3))
    assert np.abs(blocks - shade()).max() < 0.2 and fine.max() <= shade().max()


def test_view_writes_a_page(run, designs, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, out, _ = run("view", designs / "compass-15-5-1.toml")
    assert (code, out) == (0, "views/compass-15-5-1.html\n")
    opened = []
    monkeypatch.setattr("webbrowser.open", lambda uri: opened.append(uri) or False)
    code, out, err = run(
        "view", designs / "draim-four.toml", "-o", tmp_path / "x.html", "--json", "--open"
    )
    assert code == 0 and json.loads(out)["bytes"] < 1e6
    assert opened == [(tmp_path / "x.html").as_uri()] and "no browser was found" in err
    assert "MB" in str(compass.view(designs / "draim-four.toml"))


PLACES = [(-75.0, 10.0), (-20.0, 200.0), (0.0, 90.0), (31.0, 301.0), (62.0, 45.0), (88.0, 5.0)]


@pytest.mark.browser
@pytest.mark.parametrize("text", [None, OVAL], ids=["sphere", "ellipsoid"])
def test_numbers_of_the_globe_are_those_of_the_map(browser, tmp_path, seed_design, text):
    design = seed_design if text is None else read_design_text(text)
    path = compass.view(design).write(tmp_path / "globe.html")
    browser.get(path.as_uri())
    times = [0.0, 10_000.0, 33_333.0]
    script = """
      const globe = document.querySelector(".globe").globe;
      return arguments[0].map(t => arguments[1].map(([lat, lon]) => {
        const found = globe.at(lat, lon, t);
        return [found.count, Number.isFinite(found.gdop) ? found.gdop : null];
      }));
    """
    shown = browser.execute_script(script, times, PLACES)
    for k, (latitude, longitude) in enumerate(PLACES):
        site = Site(
            "x", np.radians(latitude), np.radians(longitude),
            mask=Mask.constant(design.mask.highest), figure=design.figure,
        )  # fmt: skip
        wanted = site_coverage(design.constellation, site, times)
        for j in range(len(times)):
            count, gdop = shown[j][k]
            assert count == int(wanted["count"][j])
            exact = float(wanted["gdop"][j])
            assert gdop is None if np.isinf(exact) else gdop == pytest.approx(exact, rel=1e-4)


@pytest.mark.browser
@pytest.mark.parametrize("matrices", [ONE, [WORSE, *[ONE] * 14]], ids=["alike", "each"])
def test_metres_of_the_globe_are_those_of_the_map(browser, tmp_path, matrices):
    design = read_design_text(METRES.replace("MATRICES", str(matrices)))
    page = compass.view(design).write(tmp_path / "globe.html")
    assert page.stat().st_size < 6e6
    browser.get(page.as_uri())
    figure, times = design.figure, [0.0, 30_000.0]
    grid = make_grid("equal-angle", 20.0, figure.polar_radius / figure.equatorial_radius)
    places = [(lat, lon) for lat in np.degrees(grid.latitude) for lon in np.degrees(grid.longitude)]
    script = """
      const globe = document.querySelector(".globe").globe, names = arguments[2];
      return arguments[0].map(t => arguments[1].map(([lat, lon]) => {
        const found = globe.at(lat, lon, t);
        return names.map(name => Number.isFinite(found[name]) ? found[name] : null);
      }));
    """
    names = ["error_horizontal_m", "error_vertical_m", "error_position_m", "error_time_m"]
    shown = np.array(browser.execute_script(script, times, places, names), dtype=float)
    for values, t in zip(shown, times, strict=True):
        sky = view(design.constellation, [t], figure.equatorial_radius, design.mask, design.motion)
        mapped = error_map(sky, grid, range_errors(design, [t]))
        for k, name in enumerate(names):
            wanted = mapped[name].sel(percentile=50).values.ravel()
            assert np.isfinite(wanted).mean() > 0.9  # one epoch: every percentile is its value
            assert np.allclose(np.nan_to_num(values[:, k], nan=np.inf), wanted, rtol=1e-4)
    canvas = browser.find_element("css selector", ".globe canvas")
    before = browser.execute_script("return arguments[0].toDataURL()", canvas)
    browser.find_element("css selector", "option[value=error_vertical_m]").click()
    assert browser.execute_script("return arguments[0].toDataURL()", canvas) != before
    assert "100 m" in browser.find_element("css selector", ".legend").text
    canvas.send_keys("\ue015")  # arrow down: values of the middle, without a pointer
    told = browser.find_element("css selector", ".readout").text
    middle = browser.execute_script(
        "const g = document.querySelector('.globe').globe;"
        "return g.at(g.lat * 180 / Math.PI, g.lon * 180 / Math.PI, g.time)"
    )
    assert f"vertical error {middle['error_vertical_m']:.3g} m" in told
    assert browser.get_log("browser") == []


@pytest.mark.browser
def test_the_globe_moves_and_obeys_the_keyboard(browser, tmp_path, seed_design):
    path = compass.view(seed_design).write(tmp_path / "globe.html")
    browser.get(path.as_uri())

    def state():
        return browser.execute_script(
            "const g = document.querySelector('.globe').globe;"
            "return [g.time, g.lon, g.lat, g.zoom, g.canvas.toDataURL().slice(-2000)]"
        )

    canvas = browser.find_element("css selector", ".globe canvas")
    before = state()
    canvas.send_keys("\ue014")  # arrow right
    turned = state()
    assert turned[1] > before[1] and turned[4] != before[4]
    canvas.send_keys("+")
    assert state()[3] > before[3]
    canvas.send_keys(" ")
    browser.execute_async_script("setTimeout(arguments[0], 400)")
    assert state()[0] > before[0]
    canvas.send_keys(" ")
    still = state()
    browser.execute_async_script("setTimeout(arguments[0], 200)")
    assert state()[0] == still[0]
    browser.find_element("name", "far").click()
    assert state()[3] < 0.2
    browser.find_element("css selector", "option[value=gdop]").click()
    assert "no fix" in browser.find_element("css selector", ".legend").text
    sideways = {"width": 844, "height": 390, "deviceScaleFactor": 1, "mobile": True}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", sideways)
    assert 300 < canvas.size["height"] < 390  # a phone held sideways shows all of it
    nav = browser.find_element("tag name", "nav")
    assert nav.value_of_css_property("position") == "static"
    assert browser.get_log("browser") == []
    assert not browser.find_element("css selector", "img.still").is_displayed()


@pytest.mark.browser
def test_without_scripts_the_still_picture_stays(browser, tmp_path, seed_design):
    path = compass.view(seed_design).write(tmp_path / "globe.html")
    browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
    browser.get(path.as_uri())
    assert browser.find_element("css selector", "img.still").is_displayed()
    assert not browser.find_element("css selector", ".globe").is_displayed()
