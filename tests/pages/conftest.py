"""A real browser, to open pages in as a reader would."""

import shutil
import subprocess

import pytest

FLAGS = (
    "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--window-size=1300,1000",
)  # fmt: skip


#: Words of the program in what is read on a page, but for input and code in full.
RAW = """
const found = [], walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
const raw = /`|\\b(nan|inf|undefined|True|False)\\b|NaN|\\[object|[0-9]e(\\+|-0)|^None$/;
while (walk.nextNode()) {
  const {parentElement: of, textContent: text} = walk.currentNode;
  if (!of.closest("script, style, pre, code") && raw.test(text.trim())) found.push(text.trim());
}
return found;
"""


@pytest.fixture
def browser(tmp_path):
    """Headless Chromium."""
    if not (shutil.which("chromium") and shutil.which("chromedriver")):
        pytest.skip("Chromium and its driver are not installed")
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    for flag in (*FLAGS, f"--user-data-dir={tmp_path / 'profile'}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(
        options, Service("/usr/bin/chromedriver", log_output=subprocess.DEVNULL)
    )
    yield driver
    driver.quit()


@pytest.fixture
def opened(browser, faults):
    """Open a page: its pictures load, nothing is fetched or logged, nothing sticks out or is cut.

    On a phone in the dark axe finds nothing, and nothing sticks out there either. No word is one of
    the program's: no markup of sources, no key, no number that is none or has a padded power.
    """

    def check(path, pictures):
        browser.get(path.as_uri())
        images = browser.find_elements("tag name", "img")
        sizes = [browser.execute_script("return arguments[0].naturalWidth", i) for i in images]
        assert len(sizes) == pictures and all(size > 300 for size in sizes)
        assert browser.get_log("browser") == []
        requests = browser.execute_script(
            "return performance.getEntriesByType('resource').map(e => e.name)"
            ".filter(n => !n.startsWith('data:'))"
        )
        assert requests == []
        width = browser.execute_script("return document.documentElement.scrollWidth")
        assert width <= browser.execute_script("return window.innerWidth")
        # on a desktop every picture is seen whole
        cut = "[...document.querySelectorAll('.shown')]"
        cut += ".filter(e => e.scrollWidth > e.clientWidth + 1).length"
        assert browser.execute_script(f"return {cut}") == 0
        assert browser.execute_script(RAW) == []
        phone = {"width": 360, "height": 740, "deviceScaleFactor": 1, "mobile": False}
        dark = [{"name": "prefers-color-scheme", "value": "dark"}]
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", phone)
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": dark})
        assert browser.execute_script("return document.documentElement.scrollWidth") <= 360
        assert faults(browser) == []
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
        return browser

    return check


@pytest.fixture
def faults():
    """What axe finds on the page that a browser shows, in a line each."""
    from axe_selenium_python import Axe

    def found(browser):
        axe = Axe(browser)
        axe.inject()
        return [
            f"{v['id']}: {node['html'][:70]}"
            for v in axe.run()["violations"]
            for node in v["nodes"]
        ]  # fmt: skip

    return found
