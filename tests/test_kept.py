"""Answers kept on disk."""

import json

import pytest
from numba import config

from compass import kept as module
from compass.kept import kept


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "compass" / "answers"


def test_a_question_is_worked_out_once():
    asked = []
    answers = [kept(("q", 1.0), lambda: asked.append(1) or {"x": 0.1}) for _ in range(3)]
    assert [known for _, known in answers] == [False, True, True]
    assert all(answer == {"x": 0.1} for answer, _ in answers)
    assert len(asked) == 1


def test_another_question_or_version_has_its_own_answer(monkeypatch):
    kept(("q", 1.0), lambda: {"x": 1})
    assert kept(("q", 2.0), lambda: {"x": 2}) == ({"x": 2}, False)
    monkeypatch.setattr(module, "version", lambda: "another")
    assert kept(("q", 1.0), lambda: {"x": 3}) == ({"x": 3}, False)


@pytest.mark.parametrize(
    "change",
    [("numba.__version__", "another"), ("numba.config.DISABLE_JIT", int(not config.DISABLE_JIT))],
)
def test_what_computes_and_how_makes_another_version(monkeypatch, change):
    before = module.version()
    monkeypatch.setattr(*change)
    module.version.cache_clear()
    try:
        assert module.version() != before
    finally:
        module.version.cache_clear()


@pytest.mark.parametrize("content", ["", "[1]", "{"])
def test_a_damaged_answer_is_worked_out_again(home, content):
    kept("q", lambda: {"x": 1})
    (file,) = home.glob("*.json")
    file.write_text(content)
    assert kept("q", lambda: {"x": 2}) == ({"x": 2}, False)
    assert json.loads(file.read_text()) == {"x": 2}


def test_a_place_that_cannot_be_written_costs_time_alone(home, monkeypatch):
    home.parent.mkdir(parents=True)
    home.write_text("a file")
    assert kept("q", lambda: {"x": 1}) == ({"x": 1}, False)
    monkeypatch.setattr(module, "folder", lambda: None)
    assert kept("q", lambda: {"x": 1}) == ({"x": 1}, False)


def test_a_user_without_a_home_keeps_nothing(monkeypatch):
    def no_home():
        raise RuntimeError("no home")

    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setattr(module.Path, "home", no_home)
    assert module.folder() is None


def test_the_oldest_go_first(home, monkeypatch):
    monkeypatch.setattr(module, "MOST", 2)
    for k in range(4):
        kept(k, lambda: {})
    assert len(list(home.glob("*.json"))) == 2
