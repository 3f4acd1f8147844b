"""Compiled kernels are kept where they can be, and never outlive their sources."""

import ast
import os
import shutil
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace

import pytest
from numba import config

from compass.cli.shared import QUIET, announce_compilation
from compass.core import kernel_cache
from compass.core.kernel_cache import KernelCache, Turn

INNER = "from compass.core.jit import kernel\n\n@kernel\ndef inner():\n    return {}\n"
OUTER = (
    "from compass.core.jit import kernel\nfrom compass.core.inner import inner\n\n"
    "@kernel\ndef outer():\n    return inner()\n"
)
OTHER = "from compass.core.jit import kernel\n\n@kernel\ndef other():\n    return 0\n"
#: What a user may have set that would decide the place.
OWN = ("XDG_CACHE_HOME", "TMPDIR", "NUMBA_CACHE_DIR")
CALL = (
    "from compass.core.outer import outer; from compass.core import kernel_cache as k\n"
    "from compass.core.other import other; found = outer(), other()\n"
    "hits = [sum(f.stats.cache_hits.values()) for f in (outer, other)]\n"
    "print(found[0], k.places()[1], k.is_lasting(), *hits)"
)


@pytest.fixture
def package(tmp_path):
    """A package of a kernel, one it is compiled into, and another; and a caller of them."""
    core = tmp_path / "site" / "compass" / "core"
    core.mkdir(parents=True)
    for name in ("jit.py", "kernel_cache.py", "compiling.py", "__init__.py"):
        shutil.copy(kernel_cache.SOURCES / name, core)
    (core.parent / "__init__.py").touch()
    (core / "outer.py").write_text(OUTER)
    (core / "other.py").write_text(OTHER)

    def start(value, **environment):
        (core / "inner.py").write_text(INNER.format(value))
        where = {k: v for k, v in os.environ.items() if k not in OWN}
        where |= {"PYTHONPATH": str(tmp_path / "site"), "HOME": str(tmp_path / "home")}
        # Python itself takes a file for unchanged that is as long and written in the same second
        where["PYTHONDONTWRITEBYTECODE"] = "1"
        return subprocess.Popen(
            [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(tmp_path / 'site')!r})\n"
             + CALL], env=where | environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            text=True,
        )  # fmt: skip

    def end(started):
        out, err = started.communicate()
        assert started.returncode == 0, err
        result, place, lasting, *hits = out.split()
        return int(result), Path(place), lasting == "True", *map(int, hits)

    def call(value, **environment):
        return end(start(value, **environment))

    call.start, call.end = start, end
    call.core = core
    return call


@pytest.mark.slow
@pytest.mark.parametrize("taken", ["package", "own", "home", "passing"])
def test_an_edit_of_what_is_compiled_in_is_seen_wherever_kernels_are(package, tmp_path, taken):
    environment = {}
    if taken == "own":
        environment["NUMBA_CACHE_DIR"] = str(tmp_path / "own")
        environment["NUMBA_CACHE_LOCATOR_CLASSES"] = "InTreeCacheLocator"
    if taken in ("home", "passing"):
        (package.core / "__pycache__").write_text("no folder")  # not even for root
    if taken == "passing":
        (tmp_path / "home").write_text("no folder")
        (tmp_path / "now").mkdir()
        environment["TMPDIR"] = str(tmp_path / "now")
    root = {
        "package": package.core / "__pycache__", "own": tmp_path / "own",
        "home": tmp_path / "home" / ".cache" / "compass",
        "passing": tmp_path / "now" / f"compass-{os.getuid()}",
    }[taken]  # fmt: skip
    first = package(1, **environment)
    assert first == (1, root / "kernels", taken != "passing", 0, 0)
    assert package(1, **environment) == (*first[:3], 1, 1)  # and kept
    assert package(2, **environment) == (2, *first[1:3], 0, 1)  # what was not edited is kept


@pytest.mark.slow
def test_of_processes_that_ask_at_once_one_compiles_and_the_others_take_what_it_kept(package):
    started = [package.start(1) for _ in range(3)]
    done = [package.end(process) for process in started]
    assert [sum(hits) for hits in zip(*(found[3:] for found in done), strict=True)] == [2, 2]


def test_a_turn_ends_where_compiling_fails_and_a_place_without_locks_has_none(tmp_path):
    first, second, nowhere = Turn(), Turn(), Turn()
    (tmp_path / "file").touch()
    nowhere.take(tmp_path / "file" / "x.lock")
    nowhere.end()
    first.take(tmp_path / "x.lock")
    waiting = threading.Thread(target=second.take, args=(tmp_path / "x.lock",))
    waiting.start()
    waiting.join(0.2)
    assert waiting.is_alive()
    first.end()
    waiting.join(10)
    assert not waiting.is_alive()
    second.end()


@pytest.mark.slow
def test_kernels_that_came_with_a_package_that_cannot_be_written_are_used(package, tmp_path):
    place = package(1)[1]
    moved = tmp_path / "home" / ".cache" / "compass" / "kernels"
    # root writes anywhere: a folder that takes no more files is one whose path is a dead end
    (package.core / "__init__.py").write_text(
        "from compass.core import kernel_cache as k\n"
        "k.can_be_written = lambda p, real=k.can_be_written: 'site' not in str(p) and real(p)\n"
    )
    kept = {file: file.stat().st_mtime_ns for file in place.rglob("*.nbi")}
    (package.core / "outer.py").touch()  # an installation dates its files anew
    assert package(1) == (1, moved, True, 1, 1)
    assert kept == {file: file.stat().st_mtime_ns for file in place.rglob("*.nbi")}


def test_the_users_choice_of_a_place_is_first(tmp_path, monkeypatch):
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", "/x")
    places = [*kernel_cache.lasting_places(), kernel_cache.passing_place()]
    assert [p.name for p in places] == ["kernels"] * 4
    assert [p.parent for p in places[:3]] == [
        tmp_path, kernel_cache.SOURCES / "__pycache__", Path("/x/compass"),
    ]  # fmt: skip


def test_the_imports_found_are_those_that_python_reads():
    def read(source):
        package = kernel_cache.SOURCES.parent.parent
        found = set()
        for node in ast.walk(ast.parse(source.read_bytes())):
            assert not isinstance(node, ast.Import) or "compass" not in ast.unparse(node)
            if isinstance(node, ast.ImportFrom):
                assert node.level == 0
                home = package.joinpath(*node.module.split("."))
                for path in (home, *(home / alias.name for alias in node.names)):
                    found |= {path.with_suffix(".py"), path / "__init__.py"}
        return {file for file in found if file.is_relative_to(kernel_cache.SOURCES)}

    for source in kernel_cache.SOURCES.rglob("*.py"):
        assert kernel_cache.imports(source) == {file for file in read(source) if file.is_file()}
    dop = kernel_cache.SOURCES / "dop.py"
    assert {"dop.py", "runs.py", "jit.py", "kernel_cache.py"} <= {
        file.name for file in kernel_cache.parts(dop)
    }


@pytest.mark.parametrize("spoil", [lambda p: p.chmod(0o777), lambda p: p.rmdir() or p.touch()])
def test_a_passing_place_that_others_could_fill_is_not_believed(tmp_path, monkeypatch, spoil):
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(tmp_path))
    assert kernel_cache.passing_place().parent.stat().st_mode & 0o777 == 0o700
    spoil(tmp_path / f"compass-{os.getuid()}")
    assert kernel_cache.passing_place() is None


def test_a_user_without_a_home_has_the_package(monkeypatch):
    def homeless():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", homeless)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    assert kernel_cache.lasting_places()[-1].parent == kernel_cache.SOURCES / "__pycache__"


def test_with_no_place_at_all_kernels_are_compiled_each_time(monkeypatch):
    kernel_cache.places.cache_clear()
    try:
        monkeypatch.setattr(kernel_cache, "can_be_written", lambda _: False)
        assert kernel_cache.places()[1] is None and not kernel_cache.is_lasting()
        kept = KernelCache(kernel_cache.digest.__wrapped__)
        assert kept.cache_path is None
        kept.save_overload(None, None)
    finally:
        kernel_cache.places.cache_clear()


def test_a_place_that_is_full_or_damaged_costs_a_compilation_only(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(kernel_cache, "places", lambda: ((tmp_path,), tmp_path))
    kept = KernelCache(kernel_cache.digest.__wrapped__)
    source = kernel_cache.SOURCES / "kernel_cache.py"
    assert kept.cache_path == str(tmp_path / f"kernel_cache-{kernel_cache.digest(source)}")
    kept._all[0].save_overload = full
    kept.save_overload(None, None)
    kept._all[0].load_overload = full
    assert kept.load_overload(None, None) is None
    kept.let_others_compile()
    assert not kernel_cache.can_be_written(Path("/dev/null/x"))


@pytest.mark.parametrize(("lasting", "said"), [(True, "later runs start"), (False, "NUMBA_CACHE")])
def test_who_must_compile_each_time_is_told_what_helps(monkeypatch, capsys, lasting, said):
    from numba.core import event

    closing = []
    context = SimpleNamespace(call_on_close=closing.append, meta={})
    monkeypatch.setattr("click.get_current_context", lambda **_: context)
    monkeypatch.setattr(kernel_cache, "is_lasting", lambda: lasting)
    announce_compilation()
    with event.trigger_event("numba:compile"):
        pass
    closing[0]()
    assert said in (found := capsys.readouterr().err) and found.count("\n") == 1


def test_who_wants_quiet_hears_nothing_of_a_thread_that_compiles(monkeypatch, capsys):
    from numba.core import event

    closing = []
    context = SimpleNamespace(call_on_close=closing.append, meta={QUIET: True})
    here = threading.current_thread()
    monkeypatch.setattr(
        "click.get_current_context",
        lambda **_: context if threading.current_thread() is here else None,
    )
    announce_compilation()
    asked = threading.Thread(target=lambda: event.trigger_event("numba:compile").__enter__())
    asked.start()
    asked.join()
    closing[0]()
    assert capsys.readouterr().err == ""
