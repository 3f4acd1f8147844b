"""The examples in the docstrings of public names run, and every public name has one."""

import doctest
import inspect

import pytest

import compass

NAMES = [name for name in compass.__all__ if not name.startswith("_")]
#: Commands are asked for whole answers.
COMMANDS = [
    name for name in NAMES
    if getattr(compass, name).__module__.startswith(("compass.api.", "compass.pages."))
]  # fmt: skip


def examples(name):
    """Those of a name's docstring and, of a class, of its methods'."""
    thing = getattr(compass, name)
    finder = doctest.DocTestFinder(recurse=inspect.isclass(thing))
    return [test for test in finder.find(thing, name, globs={"compass": compass}) if test.examples]


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name in COMMANDS else name
             for name in NAMES]
)  # fmt: skip
def test_examples_run(name, designs, monkeypatch):
    monkeypatch.chdir(designs.parent)
    found = examples(name)
    assert found
    for example in found:
        # an example of refusals alone shows nobody what comes
        assert any(not part.exc_msg for part in example.examples if part.want)
        assert doctest.DocTestRunner().run(example).failed == 0
