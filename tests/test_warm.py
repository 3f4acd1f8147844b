"""Everything compiled at once: what is said of it, and what stops it."""

import json
import re

import pytest

import compass
from compass.api import warm as warming
from compass.cli.main import Commands
from compass.core import kernel_cache
from compass.errors import OutputError


@pytest.fixture
def few(monkeypatch):
    """Run commands that are quick."""
    monkeypatch.setattr(
        warming, "COMMANDS", (("show", "design.toml"), ("schema", "study"), ("version",))
    )


def test_small_jobs_are_run_and_what_is_kept_is_counted(few, run):
    def kept():
        return len(kernel_cache.compiled(kernel_cache.places()[1]))

    # other tests compile meanwhile
    before = kept()
    status, out, _ = run("warm", "--json")
    found = json.loads(out)
    assert status == 0 and before <= found["kernels"] <= kept()
    assert found["runs"][0]["command"] == "compass show design.toml"
    before = kept()
    status, out, _ = run("warm", "--workers", 1)
    said = int(re.search(r"(\d+) compiled kernels", out)[1])
    assert status == 0 and before <= said <= kept() and "compass version" in out


def test_only_what_serves_these_sources_is_counted(tmp_path):
    source = kernel_cache.SOURCES / "dop.py"
    for folder in (kernel_cache.folder_of(source), "dop-0123456789abcdef"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "x.nbc").touch()
    assert kernel_cache.compiled(tmp_path) == [tmp_path / kernel_cache.folder_of(source) / "x.nbc"]


def test_a_command_that_fails_says_which(few, monkeypatch):
    monkeypatch.setattr(warming, "COMMANDS", (("fold", "nothing.toml"),))
    with pytest.raises(OutputError, match=r"warm: compass fold nothing\.toml failed: .*nothing"):
        compass.warm()


def test_where_nothing_lasts_it_says_so(monkeypatch):
    monkeypatch.setattr(warming, "is_lasting", lambda: False)
    with pytest.raises(OutputError, match="set NUMBA_CACHE_DIR"):
        compass.warm()


@pytest.mark.parametrize("command", warming.COMMANDS, ids=" ".join)
def test_every_job_is_one_that_the_program_takes(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    warming.write_files(tmp_path)
    name, *arguments = command
    assert Commands().get_command(None, name).make_context(name, arguments)
