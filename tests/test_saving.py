import csv
import os
import signal
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

from compass.errors import OutputError
from compass.saving import (
    check_writable,
    making_folder,
    replacing,
    save_netcdf,
    write_csv,
    write_files,
)


def test_success_replaces_and_failure_leaves_the_old_file(tmp_path):
    path = tmp_path / "result.nc"
    with replacing(path) as temporary:
        temporary.write_text("old")
    with pytest.raises(ZeroDivisionError, match="division"), replacing(path) as temporary:
        temporary.write_text("half")
        raise ZeroDivisionError("division")
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_result_has_ordinary_permissions(tmp_path):
    path = tmp_path / "result"
    with replacing(path) as temporary:
        temporary.write_text("x")
    mask = os.umask(0)
    os.umask(mask)
    assert path.stat().st_mode & 0o777 == 0o666 & ~mask


def test_a_link_stays_and_its_file_is_replaced(tmp_path):
    (tmp_path / "far").mkdir()
    for target in ("far/old", "far/new"):
        link = tmp_path / target.replace("/", "-")
        link.symlink_to(tmp_path / target)
        (tmp_path / "far" / "old").write_text("old")
        with replacing(link) as temporary:
            temporary.write_text("x")
        assert link.is_symlink() and (tmp_path / target).read_text() == "x"


def test_a_link_to_no_folder_is_refused_before_the_work(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "none" / "x")
    with pytest.raises(OutputError, match="none does not exist"):
        check_writable(tmp_path / "link")


@pytest.mark.parametrize("make", [replacing, making_folder])
def test_names_as_long_as_any_file_may_have(tmp_path, make):
    path = tmp_path / ("é" * 124 + "abc.nc")
    assert len(os.fsencode(path.name)) == 254
    with make(path) as temporary:
        (temporary if make is replacing else temporary / "x").write_text("x")
    assert path.exists() and len(list(tmp_path.iterdir())) == 1


def test_writing_never_touches_the_mask_of_the_process(tmp_path, monkeypatch):
    monkeypatch.setattr("os.umask", None)  # another thread would make its files with it
    with replacing(tmp_path / "x"), making_folder(tmp_path / "y"):
        pass


def test_killed_process_leaves_the_old_file(tmp_path):
    path = tmp_path / "result.nc"
    path.write_text("old")
    script = (
        "import sys, time; from pathlib import Path; from compass.saving import replacing\n"
        f"with replacing(Path({str(path)!r})) as t:\n"
        "    t.write_text('half'); print('ready', flush=True); time.sleep(60)\n"
    )
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE) as process:
        assert process.stdout.readline() == b"ready\n"
        process.send_signal(signal.SIGKILL)
        process.wait(10)
    assert path.read_text() == "old"


@pytest.mark.parametrize("case", ["folder", "missing", "input"])
def test_impossible_outputs_are_refused(tmp_path, case):
    source = tmp_path / "design.toml"
    source.write_text("x")
    path, message = {
        "folder": (tmp_path, "is a directory"),
        "missing": (tmp_path / "no" / "x.nc", "does not exist"),
        "input": (source, "is an input itself"),
    }[case]
    with pytest.raises(OutputError, match=message):
        check_writable(path, [source])


def test_files_of_a_folder_and_of_folders_in_it(tmp_path):
    write_files(tmp_path, {"a.txt": "old", "part/1.txt": "1", "part/2.txt": "2"})
    (tmp_path / "mine.txt").write_text("kept")
    write_files(tmp_path, {"a.txt": "new", "part/1.txt": "one"})
    found = {str(p.relative_to(tmp_path)): p.read_text() for p in tmp_path.rglob("*.txt")}
    assert found == {"a.txt": "new", "mine.txt": "kept", "part/1.txt": "one"}
    with pytest.raises(OutputError, match=r"mine\.txt: cannot be made: "):
        write_files(tmp_path, {"mine.txt/1.txt": "1"})


def test_a_folder_that_takes_no_file_is_said(tmp_path, monkeypatch):
    def full(**_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("tempfile.mkdtemp", full)
    with (
        pytest.raises(OutputError, match=r"x\.nc: cannot be written: No space left"),
        replacing(tmp_path / "x.nc"),
    ):
        pass


def test_unwritable_folder_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("os.access", lambda *_: False)  # root may write anywhere
    with pytest.raises(OutputError, match="not writable"):
        check_writable(tmp_path / "x.nc")


def test_full_disk_is_said_plainly(tmp_path):
    with pytest.raises(OutputError, match="cannot be written: No space"), replacing(tmp_path / "x"):
        raise OSError(28, "No space left on device")


def test_a_folder_comes_whole_or_not_at_all(tmp_path):
    folder = tmp_path / "messages"
    with pytest.raises(ZeroDivisionError, match="division"), making_folder(folder) as temporary:
        (temporary / "one").write_text("half")
        raise ZeroDivisionError("division")
    assert list(tmp_path.iterdir()) == []
    folder.mkdir()  # an empty one may be there
    with making_folder(folder) as temporary:
        (temporary / "one").write_text("x")
        assert list(folder.iterdir()) == []
    assert [path.name for path in folder.iterdir()] == ["one"]
    mask = os.umask(0)
    os.umask(mask)
    assert folder.stat().st_mode & 0o777 == 0o777 & ~mask
    with pytest.raises(OutputError, match="has files in it"), making_folder(folder):
        raise AssertionError
    assert list(tmp_path.iterdir()) == [folder]


def test_a_folder_that_cannot_be_written_is_said(tmp_path):
    with (
        pytest.raises(OutputError, match="cannot be written: File name too long"),
        making_folder(tmp_path / "messages") as temporary,
    ):
        (temporary / ("x" * 300)).write_text("x")
    assert list(tmp_path.iterdir()) == []


def test_a_device_is_not_replaced(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with pytest.raises(OutputError, match="is a device or the like"):
        check_writable(pipe)
    assert pipe.is_fifo()


def test_netcdf_on_a_full_disk_is_refused(tmp_path):
    """In a process of its own: it once crashed."""
    script = (
        "import resource, sys, numpy, xarray; from pathlib import Path\n"
        "from compass.errors import OutputError; from compass.saving import save_netcdf\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, resource.RLIM_INFINITY))\n"
        "try: save_netcdf(Path(sys.argv[1]), xarray.Dataset({'x': ('n', numpy.ones(50_000))}))\n"
        "except OutputError as error: print(error)\n"
    )
    path = tmp_path / "result.nc"
    path.write_text("old")
    done = subprocess.run([sys.executable, "-c", script, path], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"{path}: cannot be written: File too large\n"
    assert path.read_text() == "old" and list(tmp_path.iterdir()) == [path]


def test_netcdf_with_groups(tmp_path):
    one, two = (xr.Dataset({"x": ("n", [k, 2.0])}, attrs={"title": "t"}) for k in (1.0, np.nan))
    save_netcdf(tmp_path / "result.nc", one, [("part/two", two)])
    for group, whole in ((None, one), ("part/two", two)):
        with xr.open_dataset(tmp_path / "result.nc", group=group, engine="h5netcdf") as again:
            assert again.equals(whole) and again.attrs["title"] == "t"


@pytest.mark.parametrize("text", ["=1+1", "+1", "-2", "@SUM(A1)", " =1", "\t=1", "\n-x"])
def test_no_cell_of_a_table_is_a_formula(tmp_path, text):
    write_csv(tmp_path / "t.csv", ["name", "value"], [[text, -1.5], ["Ünïversität, 北", 2]])
    with (tmp_path / "t.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    assert rows == [["name", "value"], [f"'{text}", "-1.5"], ["Ünïversität, 北", "2"]]
