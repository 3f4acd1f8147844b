"""Texts in pictures are drawn as they are written."""

import re
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.text import Text

import compass
from compass.coverage.grid import equal_angle_grid
from compass.pictures.maps import map_figure
from compass.pictures.style import (
    axes_or_new,
    boxes,
    look,
    new_figure,
    picture,
    without_markup,
)

SIGNS = st.text(st.characters(categories=["L", "N", "P", "S", "Zs"]) | st.just("$"), max_size=20)


def drawn(text):
    """A picture with a text in every place that a text may have."""
    figure = new_figure(4, 3)
    with look():
        axes = figure.add_subplot()
        axes.plot([1, 2], [1, 2], label=f"x{text}")
        axes.set_title(text)
        axes.set_xticks([1, 2], [text, text])
        axes.annotate(text, (1, 1))
    axes.set_ylabel(text)  # also outside of the look
    axes.legend()
    figure.suptitle(text)
    return figure


@settings(max_examples=25)
@given(SIGNS)
def test_any_text_is_drawn_as_written_and_without_a_warning(text):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        figure = drawn(text)
        assert picture(figure, "x", text, text).drawn.startswith(b"<svg")
    assert not any(part.get_parse_math() for part in figure.findobj(Text))


@pytest.mark.parametrize(
    "text", ["a $x^2$", "$\\frac{1", "cost $$", "$\\nonsense$", "北\U0001f680\a"]
)
def test_what_looks_like_a_formula_is_none(text):
    plain = text.replace("$", "S")
    wide = [picture_width(t) for t in (text, plain)]
    assert wide[0] == pytest.approx(wide[1], rel=0.2)  # a formula would be much narrower, or fail


def picture_width(text):
    figure = new_figure(4, 3)
    label = figure.text(0.5, 0.5, text)
    figure.draw_without_rendering()
    return label.get_window_extent().width


def test_letters_that_no_font_has_are_told_once_and_other_warnings_are_kept():
    boxes()
    drawn("a\U000f0000b\U000f0001").draw_without_rendering()
    assert boxes() == "\U000f0000\U000f0001"
    drawn("plain").draw_without_rendering()
    assert boxes() == ""
    figure = drawn("plain")
    with pytest.warns(UserWarning, match="another"), figure._plain():
        warnings.warn("another", UserWarning, stacklevel=1)


def test_ticks_of_a_logarithmic_axis_are_text_too():
    axes = axes_or_new(None)
    axes.loglog([1e-4, 1e3], [2, 30])
    axes.figure.draw_without_rendering()
    labels = [label.get_text() for label in axes.get_xticklabels() if label.get_text()]
    assert "10⁻³" in labels and "10²" in labels
    minor = [label.get_text() for label in axes.get_yticklabels(which="minor") if label.get_text()]
    assert all(re.fullmatch(r"[2-9]×10[⁰¹]", text) for text in minor)


@pytest.mark.parametrize(
    ("formula", "text"),
    [
        (r"$\mathdefault{10^{-12}}$", "10⁻¹²"),
        (r"$\mathdefault{2\times10^{5}}$", "2×10⁵"),
        ("", ""),
        ("plain", "plain"),
    ],
)
def test_formulas_of_ticks(formula, text):
    assert without_markup(formula) == text


def test_every_figure_is_made_and_drawn_in_one_place():
    package = Path(compass.__file__).parent
    for path in package.rglob("*.py"):
        if path.name not in ("style.py", "rendering.py"):
            assert not re.search(r"pyplot|\nfrom matplotlib.figure|backend_", path.read_text()), (
                path
            )


def test_the_same_figure_gives_the_same_picture():
    assert np.array_equal(*(picture(drawn("$a$"), "x", "t", "c").drawn for _ in range(2)))


def test_letters_over_the_colours_of_a_map_have_a_light_rim():
    grid = equal_angle_grid(np.radians(30.0))
    figure = map_figure(np.zeros((6, 12)), grid, "Dark", "x", figure_name="iau-sphere", named=True)
    written = [text for text in figure.axes[0].texts if text.get_text()]
    assert len(written) > 10 and all(text.get_path_effects() for text in written)


def test_no_name_is_printed_over_another():
    figure = new_figure(4.0, 3.0)
    axes = figure.add_subplot()
    axes.set(xlim=(0, 1), ylim=(0, 1))
    figure.names += [axes.text(x, 0.5, "Utopia") for x in (0.1, 0.12, 0.7)]
    assert b"Utopia" in picture(figure, "x", "x", "x").drawn
    assert [name.get_visible() for name in figure.names] == [True, False, True]


def test_no_title_is_wider_than_its_picture():
    """Names are as long as users like; beside a legend there is less room than above it."""
    figure = new_figure(6, 3)
    axes = figure.add_subplot()
    axes.plot([1, 2], [1, 2], label="a kind of tracking that is told beside the axes")
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    axes.set_title("A constellation with a long name: how well its orbits are known over time")
    figure.canvas.draw()
    box = axes.title.get_window_extent()
    assert figure.bbox.x0 <= box.x0 < box.x1 <= figure.bbox.x1 and box.y1 <= figure.bbox.y1
