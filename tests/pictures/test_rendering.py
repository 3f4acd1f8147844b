"""A figure as bytes: vectors that say the same as the drawing, pixels where these are fewer."""

import re
from io import BytesIO
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from compass.coverage.grid import equal_angle_grid
from compass.pictures.maps import map_figure
from compass.pictures.rendering import smaller
from compass.pictures.style import look, new_figure, picture

#: What a name may hold that reads like a part of an SVG.
MARKUP = '<b d="1.23456 2.5"> & "x" 9.87654321 transform="rotate(-0 1 1)"'


def drawn(figure):
    """A picture of a figure, and its SVG as a tree."""
    made = picture(figure, "x", MARKUP, "c")
    return made, ElementTree.fromstring(made.drawn)


def curve(letters=9.0):
    figure = new_figure(5.0, 3.0)
    with look():
        axes = figure.add_subplot()
        axes.plot([0.0, 1.0, 2.0, 4.0], [3.0, 1.0, 5.0, 2.0], lw=1.5, color="#123456")
        axes.set(xlim=(0, 4), ylim=(0, 6), xlabel=MARKUP)
        axes.text(1.0, 1.0, "small", fontsize=letters)
    return figure


def test_words_stay_words_and_names_stay_as_written():
    made, tree = drawn(curve())
    assert made.form == "svg" and made.file_name == "x.svg"
    words = [text.text for text in tree.iter("{http://www.w3.org/2000/svg}text")]
    assert MARKUP in words and "small" in words
    assert tree.find("{*}title").text == MARKUP
    assert made.source.startswith("data:image/svg+xml;base64,")


def test_lines_go_where_the_data_are_to_a_hundredth_of_a_point():
    figure = curve()
    _, tree = drawn(figure)
    (rule,) = re.findall(r"\.(s\d+)\{[^}]*stroke: #123456", tree.find("{*}style").text)
    (path,) = (p for p in tree.iter("{http://www.w3.org/2000/svg}path") if p.get("class") == rule)
    points = np.array(re.findall(r"[ML] *(-?[\d.]+) +(-?[\d.]+)", path.get("d")), float)
    (axes,) = figure.axes
    x0, y0, x1, y1 = axes.get_position().extents * [360.0, 216.0, 360.0, 216.0]
    x, y = np.array([0.0, 1.0, 2.0, 4.0]), np.array([3.0, 1.0, 5.0, 2.0])
    wanted = np.column_stack([x0 + x / 4 * (x1 - x0), 216.0 - (y0 + y / 6 * (y1 - y0))])
    np.testing.assert_allclose(points, wanted, atol=0.0051)


@pytest.mark.parametrize("size", [4.0, 7.5, 20.0])
def test_the_smallest_letters_are_those_of_the_drawing(size):
    figure = curve(size)
    with look():
        figure.add_axes((0.4, 0.4, 0.2, 0.2)).set_axis_off()
        figure.axes[1].tick_params(labelsize=1.0)  # not drawn: counts for nothing
        figure.axes[0].text(0.5, 0.5, "unseen", fontsize=1.0, visible=False)
    made, tree = drawn(figure)
    sizes = [float(s) for s in re.findall(r"font-size: ([\d.]+)px", tree.find("{*}style").text)]
    assert made.letters == pytest.approx(min(sizes) / 360.0) == pytest.approx(min(size, 9.5) / 360)
    assert made.letters * made.least_width >= 10.0 > made.letters * (made.least_width - 1)


def test_fields_solids_and_crowds_are_pixels():
    grid = equal_angle_grid(np.radians(30.0))
    field = map_figure(np.ones((6, 12)), grid, "t", "x", figure_name="iau-sphere", scale="linear")
    solid, crowd = new_figure(3, 3), new_figure(3, 3)
    solid.add_subplot(projection="3d")
    some = np.random.default_rng(1).random((2, 3000))
    crowd.add_subplot().plot(*some, ".")
    for figure in (field, solid, crowd):
        made = picture(figure, "x", "Tit\u2192le", "c")
        assert made.drawn.startswith(b"\x89PNG") and made.form == "png"
        assert 0.0 < made.letters < 0.05
        assert "Tit\u2192le".encode() in made.drawn


def test_a_colour_bar_keeps_the_colours_that_no_place_has():
    """In 256 colours those of few pixels had been taken for others: yellow for pink, on a bar."""
    grid = equal_angle_grid(np.radians(10.0))
    dark = np.repeat(np.linspace(6.0, 30.0, 18), 36).reshape(18, 36)
    figure = map_figure(dark, grid, "t", "GDOP", figure_name="iau-sphere", named=True)
    made = picture(figure, "x", "t", "c")
    few = np.asarray(Image.open(BytesIO(made.drawn)).convert("RGB"), dtype=int)
    full = np.asarray(figure.canvas.buffer_rgba(), dtype=int)[..., :3]
    assert np.abs(few - full).max() <= 16  # a step of a bar of 16 colours; by median cut it is 53


def test_styles_are_said_once_and_nothing_else_is_lost():
    before = (
        '<?xml version="1.0"?><!DOCTYPE svg><svg width="9pt"><metadata>m</metadata><g id="a">'
        '<path d="M 1.23456 2 \nL 3.999 4" style="fill: none"/>\n <text style="fill: none" '
        'transform="rotate(-0 1 1)" x="1.005">1.23456</text></g></svg>'
    )
    assert smaller(before, "A & B") == (
        '<svg width="9pt"><title>A &amp; B</title><style>.s0{fill: none}</style><g>'
        '<path d="M 1.23 2L 4 4" class="s0"/>\n<text class="s0" x="1">1.23456</text></g></svg>'
    )
