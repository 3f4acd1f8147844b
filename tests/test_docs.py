"""The site's pages: what the code writes is complete, what is written by hand can be read."""

import importlib.util
import re
from pathlib import Path

import pytest

import compass
from compass.cli.main import program
from compass.inputs import read_design_text
from compass.inputs.commented import Key
from compass.inputs.shipped import MODELS
from compass.inputs.study import read_study_text
from compass.quantities import QUANTITIES

DOCS = Path(__file__).parents[1] / "docs"


def script(name):
    spec = importlib.util.spec_from_file_location(f"docs_{name}", DOCS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


generate, runner = script("generate"), script("run_blocks")


def toml(page):
    return [text for kind, text in runner.blocks(DOCS / page) if kind == "toml"]


def test_every_command_and_every_public_name_is_in_the_reference():
    commands, functions = generate.commands(), generate.functions()
    for name in program.list_commands(None):
        assert f"\n## compass {name}\n" in commands
    for name in set(compass.__all__) - {"__version__"}:
        assert f"\n## compass.{name}\n" in functions
    for name in ("Site.of", "Mask.of", "Requirement.of"):  # what makes them of degrees
        assert f"\n## compass.{name}\n" in functions


def test_every_key_and_every_quantity_is_in_the_reference():
    text = generate.files()

    def names(model):
        for name, field in model.model_fields.items():
            inner = Key(name, field).models
            yield from ([name] if not inner else [])
            for table in inner:
                yield from names(table)

    for model in MODELS.values():
        assert all(f"| `{name}` |" in text for name in names(model))
    listed = generate.quantities()
    assert all(f"| `{name}` |" in listed for name in QUANTITIES)


def test_cells_of_the_reference_hold_no_markup():
    for page in (generate.files(), generate.quantities()):
        for line in page.splitlines():
            if line.startswith("| `"):
                assert len(re.findall(r"(?<!\\)\|", line)) in (4, 5), line


def test_files_of_the_pages_read():
    assert read_design_text(toml("why/conventions.md")[0]).constellation.size == 15
    assert read_design_text(toml("tutorial.md")[0]).stations[1].name == "Oxia Planum"
    assert read_design_text(toml("howto/requirements.md")[0]).requirements[0].fold == 4
    promised = read_design_text(toml("howto/accuracy.md")[0])
    assert promised.signal and promised.tracking and promised.integrity
    study = read_study_text(toml("howto/study.md")[0], folder=DOCS.parent / "designs")
    assert study.entry is not None and study.compare is not None


def test_links_between_pages_lead_somewhere():
    made = {"errata.md", "gallery.md"}
    for page in DOCS.rglob("*.md"):
        if "reference" in page.parts or "_build" in page.parts or page.name in made:
            continue
        for place in re.findall(r"\]\(([^)#]+)\)", page.read_text()):
            there = page.parent / place
            drawn = there.parent.name == "gallery" and there.with_suffix(".py").exists()
            assert there.exists() or there.name in made or there.parent.name == "reference" or drawn


def test_blocks_run_in_order_and_faults_are_told(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(
        "```python\nx = 1\n```\n```toml\n# own.toml\nname = 3\n```\n```text\nnot run\n```\n"
        "```python\nfrom pathlib import Path\nassert x == 1 and Path('own.toml').exists()\n```\n"
        "```sh\n# typed:\ncompass version\n```\n"
    )
    assert runner.run(page) == []
    page.write_text("```sh\ncompass show none.toml\n```\n")
    (fault,) = runner.run(page)
    assert "exit status 2" in fault
    page.write_text("```python\n1 / 0\n```\n")
    assert "ZeroDivisionError" in runner.run(page)[0]


@pytest.mark.slow
def test_a_gallerys_picture_is_under_its_lines(tmp_path):
    folder = tmp_path / "docs" / "gallery"
    folder.mkdir(parents=True)
    (folder / "one.py").write_text(
        '"""A line $ of two."""\n\nfrom matplotlib.figure import Figure\n\n'
        "axes = Figure().subplots()\naxes.plot([1, 2])\n"
    )
    page = generate.gallery(folder)
    assert "axes.plot([1, 2])" in page and "![A line $ of two.](gallery/one.png)" in page
    assert (folder / "one.png").read_bytes().startswith(b"\x89PNG")
