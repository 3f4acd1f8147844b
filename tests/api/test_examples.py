"""The examples in the docstrings of public names run."""

import doctest
import inspect

import pytest

import compass

NAMES = [name for name in compass.__all__ if not name.startswith("_")]
COMMANDS = [
    name for name in NAMES if getattr(compass, name).__module__.startswith("compass.api.")
    and inspect.isfunction(getattr(compass, name))
]  # fmt: skip


@pytest.mark.parametrize(
    "name",
    # commands are asked for whole answers
    [pytest.param(name, marks=pytest.mark.slow) if name in COMMANDS else name for name in NAMES],
)
def test_examples_run(name, designs, monkeypatch):
    monkeypatch.chdir(designs.parent)
    thing = getattr(compass, name)
    examples = doctest.DocTestFinder(recurse=False).find(thing, name, globs={"compass": compass})
    for example in examples:
        assert doctest.DocTestRunner().run(example).failed == 0


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_an_example(name):
    assert ">>> " in inspect.getdoc(getattr(compass, name))
