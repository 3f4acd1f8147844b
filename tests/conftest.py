import os
import signal
import sys
from pathlib import Path

if "--interpreted" in sys.argv:
    # before anything: the files beside this one in folders that are asked for import kernels
    # before options are read; workers and programs that tests start inherit it
    os.environ["NUMBA_DISABLE_JIT"] = "1"

import numba
import pytest
from hypothesis import settings

import compass
from compass.cli import main as program

# The first example compiles kernels, so none has a deadline; a machine's run must be repeatable.
settings.register_profile("compass", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("compass")

# Programs started in the background inherit that ^C is ignored; some tests send it.
signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser):
    parser.addoption("--interpreted", action="store_true", help="run kernels as plain Python")


def pytest_configure(config):
    if config.getoption("interpreted") and not numba.config.DISABLE_JIT:
        raise pytest.UsageError("--interpreted: give it on the command line")


DESIGNS = Path(__file__).parents[1] / "designs"


@pytest.fixture(scope="session")
def designs():
    return DESIGNS


@pytest.fixture(scope="session")
def seed_design():
    return compass.read_design(DESIGNS / "compass-15-5-1.toml")


@pytest.fixture(scope="session", autouse=True)
def own_answers(tmp_path_factory):
    """Keep answers that took long in a folder of the tests, not in the user's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="session", autouse=True)
def little_to_certify():
    """Let maps show the bracket that they begin with where kernels are interpreted.

    And let clearances over a horizon be found to some degrees. The order of a study's candidates by
    proven bounds and more draws, compiled too, is left to tests of its own, which ask for it.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("compass.study.order.LEVELS", {})
        patch.setattr("compass.study.order.DRAWS", {})
        patch.setattr("compass.coverage.drawn.DRAWS", 100 if numba.config.DISABLE_JIT else 4096)
        if numba.config.DISABLE_JIT:
            patch.setattr("compass.coverage.certified_geometry.BUDGET_BOXES", 0)
            patch.setattr("compass.api.series.MOMENTS", 100)
            patch.setattr("compass.coverage.clearance.MARGIN_BOXES", 100)
            patch.setattr("compass.coverage.clearance.MOST_BOXES", 500)
            patch.setattr("compass.coverage.fold_verdict.MARGIN_BOXES", 100)
            patch.setattr("compass.coverage.fold_verdict.MISSED_BOXES", 100)
            patch.setattr("compass.coverage.fold_verdict.SHARE_BOXES", 300)
        yield


@pytest.fixture
def run(monkeypatch, capsys):
    """Run the program as a user does; return exit status, stdout and stderr."""

    def call(*arguments):
        monkeypatch.setattr("sys.argv", ["compass", *map(str, arguments)])
        with pytest.raises(SystemExit) as finished:
            program.main()
        captured = capsys.readouterr()
        return finished.value.code, captured.out, captured.err

    return call
