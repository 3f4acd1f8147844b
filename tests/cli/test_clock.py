"""Who waits at a terminal where nothing moves is told since when."""

import io
import sys
from time import sleep

import pytest

from compass.api.progress import bar
from compass.cli import clock as module
from compass.cli.clock import clock, line_of_its_own


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture(autouse=True)
def soon(monkeypatch):
    monkeypatch.setattr(module, "AFTER_S", 0.05)
    monkeypatch.setattr(module, "EVERY_S", 0.02)


def terminal_of(monkeypatch):
    """In a test itself: what a fixture puts there is captured anew before it is called."""
    monkeypatch.setattr(sys, "stderr", Terminal())
    return sys.stderr


def test_work_of_some_seconds_is_told_and_nothing_is_left(monkeypatch):
    terminal = terminal_of(monkeypatch)
    with clock("drift", wanted=True):
        sleep(0.3)
        with line_of_its_own():
            terminal.write("a message\n")
    written = terminal.getvalue()
    assert written.count("drift: at work for 0 s") > 1
    assert "\x1b[Ka message\n" in written  # at the beginning of a cleared line
    assert written.endswith("\x1b[K")


def test_a_bar_tells_more(monkeypatch):
    terminal = terminal_of(monkeypatch)
    with clock("map", wanted=True), bar(True, "rows", total=5) as rows:
        sleep(0.2)
        rows.update(5)
    assert "rows:" in terminal.getvalue() and "at work" not in terminal.getvalue()


def test_a_bar_whose_part_takes_long_does_not_stand_still(monkeypatch):
    terminal = terminal_of(monkeypatch)
    with clock("judge", wanted=True):
        with bar(True, "designs", total=2) as designs:
            sleep(0.3)
            assert terminal.getvalue().count("designs:   0%") > 3
            designs.update(2)
        ended = len(terminal.getvalue())
        sleep(0.1)
        assert "designs" not in terminal.getvalue()[ended:]


def test_a_bar_that_has_not_begun_to_show_stays_away(monkeypatch):
    terminal = terminal_of(monkeypatch)
    with clock("fold", wanted=True), bar(True, "revolutions", total=2, delay=60.0):
        sleep(0.2)
    assert "revolutions" not in terminal.getvalue() and "at work" in terminal.getvalue()


def test_what_is_quick_quiet_or_no_terminal_is_not_told(monkeypatch):
    terminal = terminal_of(monkeypatch)
    with clock("fold", wanted=True):
        pass
    with clock("fold", wanted=False):
        sleep(0.2)
    assert terminal.getvalue() == ""
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with clock("fold", wanted=True):
        sleep(0.2)
    assert sys.stderr.getvalue() == ""
