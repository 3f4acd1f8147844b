"""The pages in ``reports/`` as their readers open them: by width, read aloud, on paper."""

import base64
import re
from pathlib import Path

import pytest

from tests.pages.test_reading import sized

pytestmark = pytest.mark.browser

PAGES = sorted(Path("reports").glob("*/index.html"))


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.parent.name)
def test_a_report_is_read_on_every_screen(browser, faults, page):
    for width in (1440, 360):
        sized(browser, width)
        browser.get(page.absolute().as_uri())
        assert browser.execute_script("return document.documentElement.scrollWidth") <= width
        small = browser.execute_script(
            "return [...document.querySelectorAll('img:not(.still)')].filter(e => e.clientWidth"
            " && e.clientWidth < parseFloat(e.style.getPropertyValue('--least'))).map(e => e.alt)"
        )
        assert small == []
    assert faults(browser) == [] and browser.get_log("browser") == []


def test_a_design_takes_sixteen_sheets_of_paper(browser):
    (page,) = (path for path in PAGES if path.parent.name == "compass-15-5-1")
    sized(browser, 1440)
    browser.get(page.absolute().as_uri())
    paper = browser.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True})["data"]
    sheets = re.findall(rb"/Type\s*/Page\b", base64.b64decode(paper))
    assert 5 < len(sheets) <= 16


def test_no_table_is_cut_on_paper(browser):
    """At the width of a sheet within its margins no table sticks out, and none ends in a row."""
    for page in PAGES:
        sized(browser, 711)  # 188 mm
        browser.get(page.absolute().as_uri())
        browser.execute_script("dispatchEvent(new Event('beforeprint'))")
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
        tables, cut = browser.execute_script(
            "const all = [...document.querySelectorAll('table')], sheet = innerWidth;"
            "return [all.length, all.filter(e => {"
            "  const {right} = e.getBoundingClientRect(), row = getComputedStyle(e.rows[0]);"
            "  return right > Math.min(sheet, e.closest('.scroll').getBoundingClientRect().right) + 2"
            "    || row.breakInside !== 'avoid';"
            "}).map(e => e.caption.textContent)]"
        )
        assert tables and cut == []
