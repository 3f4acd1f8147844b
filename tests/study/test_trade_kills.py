"""Kills of real processes in mid-study: what resumes equals what was never disturbed."""

import json
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from compass.inputs.study import read_study
from compass.study.results import read_results
from compass.study.store import FILE, read_lines

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.slow

STUDY = """
name = "To be killed"

[study]
patterns = ["walker-delta"]
satellites = { least = 12, most = 16 }
inclination_deg = { least = 30, most = 60, step = 1 }
orbits = ["areosynchronous"]
mask_deg = 5

[map]
step_deg = 15
epochs = 3

[[constraint]]
figure = "fold_proven"
at_least = 1

[[objective]]
figure = "satellites"

[[objective]]
figure = "gdop_p95"
"""

CANDIDATES = (28 + 14 + 24 + 24 + 31) * 31  # sums of divisors of 12 ... 16, 31 inclinations


def environment():
    return os.environ | {"PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "ignore"}


def start(study, folder, *options, **settings):
    arguments = [sys.executable, "-m", "compass.cli.main", "trade", study, "-o", folder, "--json"]
    return subprocess.Popen(
        [*map(str, arguments), *map(str, options)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment(),
        **settings,
    )


def finish(process, code=0):
    out, err = process.communicate(timeout=60)
    assert process.returncode == code, err
    return json.loads(out) if code in (0, 1) else err


def stored(folder):
    """How many candidates the store holds, by stage; none twice."""
    counts = {}
    for record, _ in read_lines(folder / FILE):
        if record is not None and "stage" in record:
            size = len(record["candidates"]["satellites"])
            counts[record["stage"]] = counts.get(record["stage"], 0) + size
    return counts


def wait_for(folder, candidates, process, limit=40.0):
    """Until the store holds some; the study must not be over by then."""
    end = time.monotonic() + limit
    while time.monotonic() < end:
        if (folder / FILE).exists() and stored(folder).get("screen", 0) >= candidates:
            assert process.poll() is None
            return
        time.sleep(0.02)
    raise AssertionError("nothing was stored")


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "study.toml"
    path.write_text(STUDY)
    return path


@pytest.fixture(scope="module")
def undisturbed(study, tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    summary = finish(start(study, folder, "--workers", 1))
    assert summary["candidates"] == summary["computed"]["screen"] == CANDIDATES
    assert summary["feasible"] == summary["computed"]["map"] > 50
    return read_results(read_study(study), folder)


def check_whole(study, folder, undisturbed, summary, before):
    """The resumed run did what was missing, and all is as if nothing had happened."""
    assert summary["computed"]["screen"] == CANDIDATES - before.get("screen", 0)
    counts = stored(folder)
    assert counts["screen"] == CANDIDATES
    assert counts["map"] == int(undisturbed.feasible.sum())
    assert read_results(read_study(study), folder).identical(undisturbed)


def test_the_client_is_killed(study, tmp_path, undisturbed):
    process = start(study, tmp_path, "--workers", 2)
    wait_for(tmp_path, 500, process)
    children = children_of(process.pid)
    process.kill()
    process.communicate()
    before = stored(tmp_path)
    assert 500 <= before["screen"] < CANDIDATES
    end = time.monotonic() + 10  # workers end with their client
    while any(Path(f"/proc/{pid}").exists() for pid in children) and time.monotonic() < end:
        time.sleep(0.05)
    assert not any(Path(f"/proc/{pid}").exists() for pid in children)
    summary = finish(start(study, tmp_path, "--workers", 2))
    check_whole(study, tmp_path, undisturbed, summary, before)
    assert finish(start(study, tmp_path, "--workers", 1))["computed"] == {"screen": 0, "map": 0}


def test_the_client_is_interrupted(study, tmp_path, undisturbed):
    process = start(study, tmp_path, "--workers", 1)
    wait_for(tmp_path, 500, process)
    process.send_signal(signal.SIGINT)
    assert "interrupted" in finish(process, 130)
    before = stored(tmp_path)
    summary = finish(start(study, tmp_path, "--workers", 1))
    check_whole(study, tmp_path, undisturbed, summary, before)


def children_of(pid):
    text = Path(f"/proc/{pid}/task/{pid}/children").read_text()
    return [int(child) for child in text.split()]


def test_a_worker_is_killed(study, tmp_path, undisturbed):
    process = start(study, tmp_path, "--workers", 2)
    wait_for(tmp_path, 500, process)
    workers = [
        child
        for child in children_of(process.pid)
        if b"spawn_main" in Path(f"/proc/{child}/cmdline").read_bytes()
    ]
    assert len(workers) == 2
    os.kill(workers[0], signal.SIGKILL)
    summary = finish(process)
    assert summary["unfinished"] == 0
    check_whole(study, tmp_path, undisturbed, summary, {})


@pytest.fixture
def small_disk(tmp_path):
    """Give a file system of 200 kB, which a finished study does not fit into."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=200k", "tmpfs", folder]
    if subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("not permitted to mount a tmpfs")
    yield folder
    subprocess.run(["umount", folder], check=True)


def test_the_disk_is_full(study, small_disk, undisturbed):
    message = finish(start(study, small_disk, "--workers", 1), 2)
    assert "No space left on device" in message and "Traceback" not in message
    before = stored(small_disk)
    assert before["screen"] > 0
    assert f"all {before['screen']} finished candidates" in message
    subprocess.run(["mount", "-o", "remount,size=20m", small_disk], check=True)
    summary = finish(start(study, small_disk, "--workers", 1))
    check_whole(study, small_disk, undisturbed, summary, before)


def test_the_quota_is_used_up(study, tmp_path, undisturbed):
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, resource.RLIM_INFINITY))

    message = finish(start(study, tmp_path, "--workers", 1, preexec_fn=limit), 2)
    assert "File too large" in message and "safe" in message
    before = stored(tmp_path)
    summary = finish(start(study, tmp_path, "--workers", 1))
    check_whole(study, tmp_path, undisturbed, summary, before)


class TestCluster:
    """A Dask scheduler and two workers, processes of their own on loopback."""

    @pytest.fixture
    def dask(self, tmp_path):
        pytest.importorskip("distributed")
        running = []

        def launch(part, *options):
            command = [sys.executable, "-m", f"distributed.cli.dask_{part}", *options]
            process = subprocess.Popen(
                [*command, "--no-dashboard"],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                env=environment(),
            )
            running.append(process)
            return process

        def cluster():
            file = tmp_path / f"scheduler-{len(running)}.json"
            options = ["--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file)]
            scheduler = launch("scheduler", *options)
            end = time.monotonic() + 30
            while not file.exists() and time.monotonic() < end:
                time.sleep(0.05)
            address = json.loads(file.read_text())["address"]
            workers = [launch("worker", address, "--nthreads", "1", "--no-nanny") for _ in range(2)]
            return address, scheduler, workers

        yield cluster
        for process in running:
            process.kill()
            process.wait()

    def test_a_worker_is_killed(self, study, tmp_path, undisturbed, dask):
        address, _, workers = dask()
        process = start(study, tmp_path / "store", "--scheduler", address)
        wait_for(tmp_path / "store", 500, process)
        workers[0].kill()
        summary = finish(process)
        check_whole(study, tmp_path / "store", undisturbed, summary, {})

    def test_the_scheduler_is_killed(self, study, tmp_path, undisturbed, dask):
        folder = tmp_path / "store"
        address, scheduler, _ = dask()
        process = start(study, folder, "--scheduler", address)
        wait_for(folder, 500, process)
        scheduler.kill()
        message = finish(process, 2)
        assert "lost; every finished candidate is stored" in message
        before = stored(folder)
        assert 500 <= before["screen"] < CANDIDATES
        address, _, _ = dask()
        summary = finish(start(study, folder, "--scheduler", address))
        check_whole(study, folder, undisturbed, summary, before)
