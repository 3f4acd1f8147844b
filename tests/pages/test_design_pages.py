import html
import re
from html.parser import HTMLParser

import pytest

import compass
from compass.document.blocks import Answers, Picture, Section, arranged
from compass.document.numbers import cell
from compass.errors import OutputError
from compass.inputs import read_design_text
from compass.pages import design as design_page
from compass.pages.design import design_report
from compass.pages.page import write_page
from compass.study.mapping import MapOptions

SMALL = MapOptions(step_deg=15, epochs=4)


class Links(HTMLParser):
    """Everything a browser would load."""

    def __init__(self):
        super().__init__()
        self.sources = []
        self.images = 0

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.images += tag == "img"
        self.sources += [values[k] for k in ("src", "href") if k in values]


@pytest.fixture(scope="module", autouse=True)
def two_days():
    """Look two days ahead, bracket coarsely, draw few pixels: each is tested well elsewhere."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("compass.coverage.certified_geometry.BUDGET_BOXES", 2000)
        patch.setattr("compass.pictures.rendering.PNG_DPI", 70)
        patch.setattr("compass.api.outlook.HORIZON", 2.0)
        patch.setattr("compass.api.outlook.GLANCE", 1.0)
        yield


@pytest.fixture(scope="module")
def page(seed_design):
    return design_report(seed_design, "compass report x", SMALL)


@pytest.fixture
def brief(monkeypatch):
    """Leave out the parts whose kernels are slow when interpreted; they have tests of their own."""
    home = "compass.pages.design"
    kept = ("orbits", "caps and gaps", "comparison")
    parts = [(name, part) for name, part in design_page.SECTIONS if name in kept]
    stations = ("stations", lambda found, beside: design_page._stations(found))
    monkeypatch.setattr(f"{home}.SECTIONS", (*parts, stations))
    monkeypatch.setattr(f"{home}.fold", lambda design, **_: None)
    monkeypatch.setattr(f"{home}.FoldResult", type(None))
    monkeypatch.setattr(f"{home}.access", lambda design, **_: None)
    monkeypatch.setattr(f"{home}.outlook", lambda design: None)
    monkeypatch.setattr(f"{home}._beside", lambda found: [])
    monkeypatch.setattr("compass.api.map.certified_figures", lambda *_: None)
    monkeypatch.setattr(
        f"{home}.answer_section", lambda found, shown, _: Section("Answer", tuple(shown))
    )
    monkeypatch.setattr("compass.papers.kelly2018._fold_rows", list)


def test_brief_page_tells_where_its_numbers_come_from(brief, seed_design):
    text, _ = design_report(seed_design, "compass report x", SMALL)
    assert design_report(seed_design, "compass report x", SMALL)[0] == text  # byte by byte
    for part in (
        "60,422,2",
        "erratum",
        seed_design.digest,
        "compass report x",
        "North pole",
    ):
        assert part in text


@pytest.mark.slow
def test_page_is_self_contained(page):
    text, sections = page
    links = Links()
    links.feed(text)
    assert links.images == sum(len(s.pictures) for s in sections) >= 12
    assert all(link.startswith(("data:", "#")) for link in links.sources)
    assert not re.search(r"<script src|@import|url\(", text)
    assert len(text.encode()) < 6e6


@pytest.mark.slow
def test_page_tells_everything(page, seed_design):
    text, sections = page
    titles = [section.title for section in sections]
    assert titles == [
        "The answer", "Coverage", "Geometry and accuracy", "Stations and links", "Orbits",
        "How long it lasts", "Deployment", "Losses", "Caps and gaps", "Published against computed",
    ]  # fmt: skip
    (answers,) = (block for block in sections[0].blocks if isinstance(block, Answers))
    said = {row.question: row for row in answers.rows}
    assert said["4 in view above 0°, everywhere"].holds
    assert said["Left alone on real orbits it lasts"].written == "2 days and more"
    assert said["The mask may rise to"].written == "6.23 deg"  # 6.2385, never more than is proven
    for known in ("GDOP, half of area and time below", "GDOP, 95 % below"):
        assert said[known].sure == "between proven bounds, for all time, two-body motion"
    assert said["After any one loss, in view at least"].written == "3"
    advice = sections[0].paragraphs[0]
    assert "Build it as it is" in advice and "15/5/4" in advice and "8.5" in advice
    for part in (
        "60,422,2",
        "of designs with a table [signal]",
        "erratum",
        seed_design.digest,
        "compass report x",
        "North pole",
    ):
        assert part in text
    assert len({p.stem for s in sections for p in s.pictures}) == sum(
        len(s.pictures) for s in sections
    )
    for section in sections:
        for picture in section.pictures:
            assert picture.drawn.startswith((b"\x89PNG", b"<svg"))
            assert picture.caption


def test_text_of_a_design_is_escaped(designs, brief):
    evil = '<script>alert("x")</script>'
    text = (designs / "areostationary-trio.toml").read_text()
    text = text.replace("Three areostationary relays", evil.replace('"', '\\"'))
    text = text.replace('name = "Phoenix"', "name = '<img src=x onerror=alert(1)>'")
    page, _ = design_report(read_design_text(text), "", SMALL)
    assert "<script>alert" not in page
    assert "<img src=x" not in page
    assert "&lt;script&gt;" in page and "\\u003cimg src=x" in page


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "relay-orbiters",
        "walker-star-iridium",
        "draim-four",
        "rosette-12-3-quarter",
        "areostationary-trio",
    ],
)
def test_every_kind_of_design_makes_a_page(designs, name, monkeypatch):
    # seconds each, with tests of their own
    monkeypatch.setattr("compass.pages.design.outlook", lambda design: None)
    monkeypatch.setattr("compass.pages.design._beside", lambda found: [])
    steps = []
    design = compass.read_design(designs / f"{name}.toml")
    page, sections = design_report(design, "", SMALL, progress=steps.append)
    assert design.name.replace("'", "&#39;") in page
    assert len(steps) == design_page.PARTS
    assert len(sections) >= 3


def test_report_command_writes_the_page_and_the_pictures(run, designs, tmp_path, brief):
    import json

    folder = tmp_path / "out"
    arguments = ["report", designs / "draim-four.toml", "-o", folder, "--step-deg", 30]
    code, out, _ = run(*arguments, "--epochs", 3, "--json")
    assert code == 0
    made = json.loads(out)
    assert sorted(p.name for p in folder.iterdir()) == sorted(
        ["index.html", *(name.rsplit("/", 1)[1] for name in made["pictures"])]
    )
    code, out, _ = run(*arguments, "--epochs", 3)
    assert out == f"report: {folder / 'index.html'}\n"


def test_report_of_designs_joined_is_a_page_of_one_network(run, designs, tmp_path, brief):
    """All satellites count, and both files are named in its commands."""
    other = tmp_path / "other.toml"
    other.write_text(
        'name = "other"\n[constellation]\npattern = "elements"\n[[constellation.satellite]]\n'
        'name = "low"\nsemi_major_axis_km = 3900\ninclination_deg = 80\n[coverage]\nfold = 1\n'
        '[[station]]\nname = "Mast"\nlatitude_deg = 0.2\nlongitude_deg = 0\n'
    )
    first, folder = designs / "draim-four.toml", tmp_path / "out"
    options = ["-o", folder, "--step-deg", 30, "--epochs", 3]
    code, _, err = run("report", first, other, *options)
    assert code == 0, err
    text = (folder / "index.html").read_text()
    title = f"{compass.read_design(first).name} + other"
    assert f"<h1>{title}" in html.unescape(text) and "5 satellites" in text
    assert "low" in text and "other.toml" in text


@pytest.mark.slow
def test_report_of_a_scenario(run, designs, tmp_path):
    text = (designs / "lou2019-recommended.toml").read_text()
    path = tmp_path / "landing.toml"
    path.write_text(re.sub(r"(?m)^runs = \d+", "runs = 4", text))
    code, out, _ = run("report", path, "-o", tmp_path / "page")
    assert code == 0
    page = (tmp_path / "page" / "index.html").read_text()
    links = Links()
    links.feed(page)
    assert links.images >= 8
    assert out == f"report: {tmp_path / 'page' / 'index.html'}\n"


def test_report_into_a_file_is_refused(run, designs, tmp_path, brief):
    path = tmp_path / "taken"
    path.write_text("x")
    code, _, err = run(
        "report", designs / "draim-four.toml", "-o", path, "--step-deg", 30, "--epochs", 2
    )
    assert code == 2
    assert "is a file; give a folder" in err
    assert path.read_text() == "x"


def test_failed_write_leaves_the_old_page(tmp_path, monkeypatch):
    old = write_page(tmp_path, "old", [])
    section = arranged("t", pictures=(Picture("p", "t", "c", b"png"),))

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.write_bytes", full)
    with pytest.raises(OutputError, match="No space left"):
        write_page(tmp_path, "new", [section])
    assert old.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["index.html"]


def test_cells():
    assert cell(float("inf")) == "∞"
    assert cell(60422240.1) == "60,422,240"
    assert cell(0.1234567891) == "0.1235"
    assert cell("x") == "x"
    assert cell(3) == "3"


@pytest.mark.browser
def test_page_in_a_real_browser(page, tmp_path, opened):
    text, sections = page
    opened(write_page(tmp_path, text, sections), sum(len(s.pictures) for s in sections))
