"""Pages as their readers meet them: narrow, dark, on paper, read aloud, without a network."""

import base64
import re

import numpy as np
import pytest

from compass.coverage.grid import equal_angle_grid
from compass.document import Answer, Answers, Details, Section, Table, Value
from compass.document.blocks import Interactive, Picture, arranged
from compass.inputs import read_design_text
from compass.pages.globe.piece import globe
from compass.pages.globe.still import still_picture
from compass.pages.page import render, write_page
from compass.pictures.bars import draw_bars
from compass.pictures.maps import map_figure
from compass.pictures.rows import draw_rows
from compass.pictures.style import look, new_figure, picture
from compass.quantities import quantity

pytestmark = pytest.mark.browser

#: The smallest PNG: one white pixel.
DOT = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAQAAAC1HAwCAAAAC0lEQVR42mP8/x8AAwMCAO+ip1sAAAAASUVORK5CYII="
)
AXES = "document.querySelector('#curve .reading').reading.panels[0]"
WIDE = Table(
    "A wide table of long words",
    ("station", *(quantity(f"station.{n}").heading for n in ("gdop_p95", "pdop_p95", "mean")), "u"),
    tuple((f"Station of a long name {k}", 2.5, 3.25, 6.5, "words " * 6) for k in range(5)),
)
WORDS = "at 109 epochs on cells of one degree, error not known"
LONG = Table("Long", ("", "n"), tuple((f"row {k}", k / 7) for k in range(60)))


@pytest.fixture(scope="module")
def page(seed_design, tmp_path_factory):
    """A page with a block of every kind, the globe first, and names that are markup."""
    text = seed_design.text.replace("North pole", "<i>North</i> $pole$")
    design = read_design_text(text)
    answers = Answers(
        "Met, and how sure",
        (
            Answer("Four in view everywhere", "proven", True, "for all time"),
            Answer("GDOP, 95 % below", Value(quantity("gdop"), 3.4), False, f"sampled, {WORDS}"),
            Answer("<i>Left</i>", "31 days"),
        ),
    )
    pictures = (Picture("dot", "A dot", "A caption.", DOT), curve(), chart(), spans(), bars())
    sections = [
        Section("The answer", (answers, globe(design, still_picture(design, 15.0)))),
        arranged("Coverage", ("Words. " * 40,), pictures, (WIDE, LONG)),
        Section("Losses", (Details("Folded", (WIDE,)), Interactive("x", "t", "c", "<p>x</p>", ""))),
    ]
    made = render(design.name, design.source, sections, [("SHA-256", "a" * 64)], design.text)
    return write_page(tmp_path_factory.mktemp("page"), made, [])


def curve():
    """A curve on logarithmic axes and a point beside it."""
    figure = new_figure(5.6, 3.5)
    axes = figure.add_subplot()
    axes.plot([1.0, 10.0, 100.0], [2.0, 3.0, 4.0], label="rising")
    axes.set(xscale="log", xlim=(1, 100), ylim=(0, 5), xlabel="days", ylabel="deg")
    return picture(figure, "curve", "A curve", "Values.", alt="A curve.")


def chart():
    """A map whose value is the longitude of the cell."""
    grid = equal_angle_grid(np.radians(10.0))
    east = np.degrees(grid.longitude_edges[:-1] + grid.longitude_edges[1:]) / 2
    values = np.repeat(east[np.newaxis], 18, axis=0)
    figure = map_figure(values, grid, "East", "east", figure_name="iau-sphere", scale="linear")
    return picture(figure, "chart", "East", "Values.", alt="A map.")


def spans():
    """Two rows of spans."""
    figure = new_figure(5.6, 2.5)
    rows = [[[1.0, 2.0], [3.0, 4.5]], [[0.0, 5.0]]]
    with look():
        axes = figure.add_subplot()
        draw_rows(axes, ["P1S1", "P1S2"], rows, ["k", "r"], (0.0, 5.0))
        axes.set_xlabel("sols")
    return picture(figure, "spans", "Spans", "Values.", alt="Spans.")


def bars():
    """Two bars, the second longer."""
    axes = draw_bars(None, ["one", "two"], [3.25, 6.5], quantity("gdop"), "t")
    return picture(axes.figure, "bars", "Bars", "Values.", wide=True, alt="Bars.")


def sized(browser, width, dark=False):
    """A window of so many CSS pixels, light or dark."""
    browser.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False},
    )
    scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize("width", [1440, 390])
def test_everybody_can_read_it(browser, page, faults, width, dark):
    sized(browser, width, dark)
    browser.get(page.as_uri())
    browser.execute_script("document.querySelectorAll('details').forEach(d => d.open = true)")
    assert faults(browser) == []
    ground = browser.execute_script("return getComputedStyle(document.body).backgroundColor")
    assert (sum(map(int, re.findall(r"\d+", ground))) < 200) is dark


@pytest.mark.parametrize("width", [1440, 1000, 390, 360])
def test_nothing_sticks_out_and_no_letter_of_a_picture_is_too_small(browser, page, width):
    sized(browser, width)
    browser.get(page.as_uri())
    browser.execute_script("document.querySelectorAll('details').forEach(d => d.open = true)")
    assert browser.execute_script("return document.documentElement.scrollWidth") <= width
    narrow = browser.execute_script(
        "return [...document.querySelectorAll('dd, td, p:not(.stations)')].filter("
        "  e => e.offsetWidth && e.textContent.length > 20 && e.offsetWidth < 60"
        ").map(e => e.textContent.slice(0, 40))"
    )
    assert narrow == []  # no column of single letters
    if width < 500:  # what is moved sideways is not squeezed into heads of one word a line
        heads = browser.execute_script(
            "return [...document.querySelector('#s2 table').querySelectorAll('th')].map(e => e.offsetWidth)"
        )
        assert min(heads) >= 5 * 16
    shown = browser.execute_script(
        "return [...document.querySelectorAll('img:not(.still)')].map(e => [e.src, e.clientWidth])"
    )
    vectors = [(unpacked(src), wide) for src, wide in shown if "svg+xml" in src]
    assert len(vectors) == 3
    for svg, wide in vectors:
        (width_points,) = re.findall(r'<svg[^>]*viewBox="0 0 ([\d.]+)', svg)
        least = min(float(size) for size in re.findall(r"font-size: ([\d.]+)px", svg))
        assert least * wide / float(width_points) >= 10.0
    fades = browser.execute_script(
        "return [...document.querySelectorAll('.shown:not(figure.interactive *)')].map("
        "  e => [e.scrollWidth > e.clientWidth + 2, e.matches('.after'),"
        "        getComputedStyle(e).maskImage !== 'none'])"
    )
    assert all(wider is marked is faded for wider, marked, faded in fades)
    assert any(wider for wider, *_ in fades) is (width < 500)


def unpacked(source):
    """Text of an SVG that a page carries."""
    return base64.b64decode(source.partition("base64,")[2]).decode()


def test_nothing_is_fetched_and_names_are_text(browser, page):
    sized(browser, 1440)
    browser.get(page.as_uri())
    fetched = browser.execute_script(
        "return performance.getEntriesByType('resource').map(e => e.name)"
        ".filter(n => !n.startsWith('data:'))"
    )
    assert fetched == [] and browser.get_log("browser") == []
    assert (
        browser.execute_script("return document.querySelectorAll('i:not(.legend i)').length") == 0
    )
    assert "<i>North</i> $pole$ sees" in browser.find_element("css selector", ".stations").text


def test_on_paper_all_is_open_but_the_provenance_and_no_row_is_cut(browser, page):
    sized(browser, 1440)
    browser.get(page.as_uri())
    browser.execute_script("dispatchEvent(new Event('beforeprint'))")
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    opened = browser.execute_script(
        "return [...document.querySelectorAll('details')].map(d => [d.open, !!d.closest('#provenance')])"
    )
    assert opened and all(is_open is not last for is_open, last in opened)
    assert browser.find_element("css selector", "img.still").is_displayed()
    assert not browser.find_element("css selector", ".globe").is_displayed()
    caption = browser.find_element("css selector", "figure:has(.globe) figcaption").text
    assert "slider" not in caption and "Stars" in caption  # of what is on paper
    sizes = browser.execute_script(
        "return [...document.querySelectorAll('.answers td, .answers th')]"
        ".map(e => parseFloat(getComputedStyle(e).fontSize))"
    )
    assert max(sizes) <= 10.01  # 7.5 points: the columns of one table
    (sure,) = browser.find_elements("css selector", ".answers details")
    assert sure.text.split("\n") == ["sampled", WORDS]
    led = browser.execute_script(
        "return [...document.querySelectorAll('section > p')].filter(p => getComputedStyle(p)"
        ".breakAfter === 'avoid').map(p => p.nextElementSibling.className)"
    )
    assert led == ["pictures"]  # what leads to pictures or a table stays with them
    cut = browser.execute_script(
        "return [...document.querySelectorAll('tr, figure, section > p')]"
        ".filter(e => getComputedStyle(e).breakInside !== 'avoid').length"
    )
    assert cut == 0
    paper = base64.b64decode(browser.execute_cdp_cmd("Page.printToPDF", {})["data"])
    assert paper.startswith(b"%PDF") and len(re.findall(rb"/Type\s*/Page\b", paper)) <= 8


def pointed(browser, stem, x, y):
    """What a picture says where the pointer is, in fractions of it from the upper left."""
    return browser.execute_async_script(
        """
        const [stem, x, y, done] = arguments, root = document.querySelector(`#${stem} .reading`);
        root.reading.ready.then(() => {
          const box = root.querySelector("img").getBoundingClientRect();
          root.dispatchEvent(new PointerEvent("pointermove",
            {clientX: box.left + x * box.width, clientY: box.top + y * box.height}));
          const tip = root.querySelector(".tip");
          done(getComputedStyle(tip).display === "none" ? "" : tip.innerText);
        });
        """,
        stem, x, y,
    )  # fmt: skip


def touched(browser, root):
    """Touch the middle of a picture with a finger and lift it."""
    from selenium.webdriver.common.actions.action_builder import ActionBuilder
    from selenium.webdriver.common.actions.pointer_input import PointerInput

    browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", root)
    finger = ActionBuilder(browser, mouse=PointerInput("touch", "finger"))
    finger.pointer_action.move_to(root).pointer_down().pointer_up()
    finger.perform()


def test_pictures_say_the_value_under_the_pointer_and_by_the_keys(browser, page):
    sized(browser, 1440)
    browser.get(page.as_uri())
    (panel,) = browser.execute_script(
        "return document.querySelector('#chart .reading').reading.panels"
    )
    left, top, right, bottom = panel["box"]
    # on the equator of a Mollweide map longitude is even; towards the poles parallels shrink
    told = pointed(
        browser, "chart", left + (right - left) * (0.5 + 95 / 360), (top + bottom) / 2.02
    )
    assert told.splitlines() == ["5.0° N, 95.0° E", "east: 95"]
    theta = np.deg2rad(25.0)
    latitude = np.degrees(np.arcsin((2 * theta + np.sin(2 * theta)) / np.pi))
    x = left + (right - left) * (0.5 - 120 / 360 * np.cos(theta))
    told = pointed(browser, "chart", x, (top + bottom) / 2 - (bottom - top) / 2 * np.sin(theta))
    assert abs(latitude - 35.0) < 5.0 and told.startswith("35.0° N, 1")
    assert abs(float(told.split(": ")[1]) + 120.0) <= 5.01
    assert pointed(browser, "chart", 0.01, 0.01) == ""  # beside the map
    (axes,) = browser.execute_script(
        "return document.querySelector('#curve .reading').reading.panels"
    )
    left, top, right, bottom = axes["box"]
    across, high = (left + right) / 2, top + 0.1 * (bottom - top)
    told = pointed(browser, "curve", across, high)
    assert told.splitlines() == ["days: 10", "deg", "rising: 3"]
    for name, place in (("latitude", "10.0° N"), ("longitude", "10.0° E")):
        browser.execute_script(f"{AXES}.x[3] = '{name}'")
        assert pointed(browser, "curve", across, high).splitlines()[0] == f"{name}: {place}"
    browser.execute_script(f"{AXES}.x[3] = 'days'")
    (rows,) = browser.execute_script(
        "return document.querySelector('#spans .reading').reading.panels"
    )
    left, top, right, bottom = rows["box"]
    least, most = rows["y"][:2]  # the first row, 0, on top
    y = bottom - (0.0 - least) / (most - least) * (bottom - top)
    for x, said in ((3.5, "from 3 to 4.5"), (2.5, "not at 2.5")):
        told = pointed(browser, "spans", left + x / 5 * (right - left), y)
        assert told.splitlines() == ["P1S1", said, "sols"]
    (panel,) = browser.execute_script(
        "return document.querySelector('#bars .reading').reading.panels"
    )
    left, top, right, bottom = panel["box"]
    least, most = panel["y"][:2]
    told = pointed(
        browser, "bars", right - 0.001, bottom - (1 - least) / (most - least) * (bottom - top)
    )
    assert told.splitlines() == ["two", "GDOP: 6.5"]
    root = browser.find_element("css selector", "#curve .reading")
    touched(browser, root)
    assert root.find_element("css selector", ".tip").text.splitlines()[0].startswith("days: ")
    root.send_keys("\ue00c")  # escape
    assert root.find_element("css selector", ".tip").text == ""
    root.send_keys("\ue014")
    assert root.find_element("css selector", ".tip").text.splitlines()[-1] == "rising: 3"
    browser.execute_script("""
      const {lines} = document.querySelector("#curve .reading").reading.panels[0], [first] = lines;
      for (let k = 1; k < 14; k++)
        lines.unshift({...first, name: `${k}`, y: first.y.map(v => v + 100 * k)});
    """)  # of 14 curves the 12 that are near the pointer, and that there are more
    told = pointed(browser, "curve", across, high).splitlines()
    assert len(told) == 15 and told[2:4] == ["rising: 3", "1: 103"] and told[-1] == "and 2 more"


def test_what_the_keys_read_stays_in_sight_where_a_picture_is_wider_than_its_place(browser, page):
    sized(browser, 360)
    browser.get(page.as_uri())
    root = browser.find_element("css selector", "#chart .reading")
    browser.execute_async_script("arguments[0].reading.ready.then(arguments[1])", root)
    for key, times in (("\ue014", 45), ("\ue012", 90)):  # to the right end, to the left one
        root.send_keys(key * times)
        place, dot = browser.execute_script(
            "const sides = e => { const b = e.getBoundingClientRect(); return [b.left, b.right]; };"
            "return [arguments[0], arguments[0].querySelector('span')].map(sides)",
            root,
        )
        assert root.find_element("css selector", "span").is_displayed()
        assert place[0] <= dot[0] + 1 and dot[1] <= place[1] + 1  # scrolled by whole pixels
