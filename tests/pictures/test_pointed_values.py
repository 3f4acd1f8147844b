"""What a picture says in numbers is what it was drawn from, where it was drawn."""

import base64
import json
import zlib

import numpy as np
import pytest

from compass.coverage.grid import equal_angle_grid
from compass.pictures.bars import draw_bars
from compass.pictures.maps import map_figure
from compass.pictures.mars_map import MarsMap
from compass.pictures.reading import POINTS
from compass.pictures.rows import draw_rows, within
from compass.pictures.style import look, new_figure, picture
from compass.quantities import QUANTITIES, quantity

STEP = 10.0


def panels(figure):
    return json.loads(picture(figure, "x", "x", "x").reading)


def unpacked(panel):
    words = np.frombuffer(zlib.decompress(base64.b64decode(panel["values"])), "<f2")
    return words.astype(float).reshape(len(panel["lat"]), len(panel["lon"])) * panel["scale"]


def test_a_map_says_the_value_of_each_cell_that_it_keeps():
    grid = equal_angle_grid(np.radians(STEP))
    values = 3e6 * (1.0 + np.arange(18 * 36).reshape(18, 36))
    values[2, 3] = np.inf
    (panel,) = panels(map_figure(values, grid, "A map", "GDOP", figure_name="iau-sphere"))
    assert panel["label"] == "GDOP" and panel["title"] == "A map"
    lat, lon = np.degrees(grid.latitude_edges), np.degrees(grid.longitude_edges)
    np.testing.assert_allclose(panel["lat"], (lat[1:] + lat[:-1]) / 2)
    np.testing.assert_allclose(panel["lon"], (lon[1:] + lon[:-1]) / 2)
    np.testing.assert_allclose(unpacked(panel), values, rtol=1e-3)  # half a part in 2^11, inf kept
    left, top, right, bottom = panel["box"]
    assert 0 < left < right < 1 and 0 < top < bottom < 1
    width, height = (right - left) * 5.5, (bottom - top) * 3.7
    assert width / height == pytest.approx(2.0, rel=1e-3)  # Mollweide's rim


@pytest.mark.parametrize("name", [name for name, one in QUANTITIES.items() if one.ticks])
def test_a_map_runs_over_the_range_of_its_quantity(name):
    """Errors and levels in metres had dilutions' colours: black wherever they were over 30 m."""
    grid = equal_angle_grid(np.radians(30.0))
    figure = map_figure(np.ones((6, 12)), grid, "", name, figure_name="iau-sphere", of=name)
    axes, bar = figure.axes
    low, high = quantity(name).limits
    assert any((m.norm.vmin, m.norm.vmax) == (low, high) for m in axes.collections)
    assert tuple(bar.get_xticks()) == quantity(name).ticks


def test_a_share_is_drawn_and_said_in_per_cent():
    grid = equal_angle_grid(np.radians(30.0))
    shares = np.linspace(0.25, 0.75, 72).reshape(6, 12)
    figure = map_figure(shares, grid, "", "share, %", figure_name="iau-sphere", scale="share")
    (panel,) = panels(figure)
    np.testing.assert_allclose(unpacked(panel), 100 * shares, rtol=1e-3)
    assert figure.axes[1].get_xlim() == (0.0, 100.0)


def test_a_fine_map_is_thinned_and_keeps_its_own_cells():
    grid = equal_angle_grid(np.radians(1.0))
    lat = np.degrees(grid.latitude_edges[:-1] + grid.latitude_edges[1:]) / 2
    values = np.repeat(np.abs(lat)[:, np.newaxis] + 1.0, 360, axis=1)
    (panel,) = panels(map_figure(values, grid, "", "x", figure_name="iau-sphere"))
    assert len(panel["lat"]) == 90 and len(panel["lon"]) == 180
    np.testing.assert_allclose(unpacked(panel)[:, 7], np.abs(panel["lat"]) + 1.0, rtol=1e-3)


def test_curves_say_their_points_and_marks_say_nothing():
    figure = new_figure()
    axes = figure.add_subplot()
    x = np.linspace(0.0, 10.0, 1001)
    axes.plot(x, np.where(x < 5, x**2, np.nan), label="</script>")
    axes.axhline(3.0)
    axes.set(xlim=(0, 10), ylim=(1, 100), yscale="log", xlabel="time, h", ylabel="km")
    (panel,) = panels(figure)
    assert "<" not in picture(figure, "x", "x", "x").reading
    assert panel["x"] == [0, 10, False, "time, h"] and panel["y"] == [1, 100, True, "km"]
    (line,) = panel["lines"]
    assert line["name"] == "</script>" and len(line["x"]) == POINTS
    np.testing.assert_allclose(np.square(line["x"]), line["y"], rtol=1e-4)


def test_a_picture_without_values_says_nothing():
    figure = new_figure()
    axes = figure.add_subplot()
    axes.axvline(1.0)
    figure.add_subplot().set_axis_off()
    assert picture(figure, "x", "x", "x").reading == ""
    with_words = new_figure()
    with_words.add_subplot().plot([1, 2], [3, 4])
    with_words.axes[0].set_xscale("symlog")
    assert picture(with_words, "x", "x", "x").reading == ""


def test_bars_say_their_names_and_lengths():
    axes = draw_bars(None, ["one", "two"], [3.25, None], quantity("gdop"), "t")
    (panel,) = panels(axes.figure)
    assert panel["flat"] and panel["of"] == quantity("gdop").heading
    assert [(bar["name"], bar["value"]) for bar in panel["bars"]] == [("one", 3.25), ("two", 0.0)]
    assert panel["bars"][0]["corners"] == pytest.approx([0.0, -0.4, 3.25, 0.4])
    upright = new_figure()
    axes = upright.add_subplot()
    axes.bar([1.5, 2.5], [3.0, -4.0], width=0.5)
    axes.set(xlabel="radius, km", ylabel="days")
    (panel,) = panels(upright)
    assert [(bar["name"], bar["value"]) for bar in panel["bars"]] == [
        ("radius, km: 1.5", 3.0), ("radius, km: 2.5", -4.0)
    ]  # fmt: skip
    assert panel["bars"][1]["corners"] == [2.25, -4.0, 2.75, 0.0] and panel["of"] == "days"


def test_rows_say_the_spans_that_are_shown():
    figure = new_figure()
    spans = np.array([[-1.0, 0.5], [2.0, 3.0], [4.5, 7.0], [8.0, 9.0]])
    with look():
        draw_rows(figure.add_subplot(), ["a", "b"], [spans, []], ["k", "r"], (0.0, 5.0))
    (panel,) = panels(figure)
    assert [row["name"] for row in panel["rows"]] == ["a", "b"]
    assert panel["rows"][0]["from"] == [0.0, 2.0, 4.5] and panel["rows"][0]["to"] == [0.5, 3.0, 5.0]
    assert panel["rows"][1]["from"] == []
    line = next(line for line in figure.axes[0].lines if len(line.get_xdata()) == 9)
    drawn = np.asarray(line.get_xdata()).reshape(-1, 3)[:, :2]
    np.testing.assert_array_equal(drawn, within(spans, (0.0, 5.0)))  # what is drawn is what is told


def test_maps_on_one_scale_of_colours_say_what_it_is_of():
    figure = new_figure()
    grid = equal_angle_grid(np.radians(30.0))
    for k, axes in enumerate(figure.subplots(1, 2)):
        chart = MarsMap(axes)
        edges = np.degrees(grid.longitude_edges), np.degrees(grid.latitude_edges)
        mesh = chart.field(*edges, np.full((6, 12), k + 1.0), label="own" if k else "")
    figure.colorbar(mesh, ax=figure.axes, orientation="horizontal").set_label("shared")
    assert [panel["label"] for panel in panels(figure)] == ["shared", "own"]
