"""Kills of real processes in mid-study: what resumes equals what was never disturbed."""

import os
import resource
import signal
import subprocess
import time
from pathlib import Path

import pytest
from trade_processes import CANDIDATES, HANGS, DaskProcesses, Trade

from compass.study.cluster import AHEAD
from compass.study.workers import HELD

pytestmark = pytest.mark.slow

#: Batches on their way with two worker processes: theirs, and those that wait.
TWO_PROCESSES = 2 * HELD


@pytest.fixture
def trade(killed_study, tmp_path):
    return Trade(killed_study, tmp_path / "store")


def test_the_client_is_killed(trade, undisturbed):
    trade.start("--workers", 2).wait_for(500)
    children = trade.children()
    trade.process.kill()
    trade.process.communicate()
    before = trade.stored()
    assert 500 <= before["screen"] < CANDIDATES
    end = time.monotonic() + 60  # workers end with their client
    while any(Path(f"/proc/{pid}").exists() for pid in children) and time.monotonic() < end:
        time.sleep(0.05)
    assert not any(Path(f"/proc/{pid}").exists() for pid in children)
    trade.check_resumed(undisturbed, before, TWO_PROCESSES, "--workers", 2)


def test_the_client_is_interrupted(trade, undisturbed):
    trade.start("--workers", 1).wait_for(500)
    trade.process.send_signal(signal.SIGINT)
    assert "interrupted" in trade.finish(130)
    trade.check_resumed(undisturbed, trade.stored(), HELD + 1, "--workers", 1)


def spawned(trade):
    """Worker processes."""
    commands = {child: Path(f"/proc/{child}/cmdline") for child in trade.children()}
    return [child for child, command in commands.items() if b"spawn_main" in command.read_bytes()]


@pytest.mark.parametrize("begun", [False, True])
def test_a_terminal_interrupts_the_workers_too(trade, begun):
    trade.start("--workers", 2, start_new_session=True)
    end = time.monotonic() + HANGS
    while not spawned(trade) and time.monotonic() < end:
        time.sleep(0.02)
    if begun:
        trade.wait_for(500)
    else:
        time.sleep(0.3)  # while they import what they need
    workers = spawned(trade)
    os.kill(workers[0], signal.SIGSTOP)  # not even one that stands still is waited for
    os.killpg(trade.process.pid, signal.SIGINT)
    message = trade.finish(130, limit=10).strip()
    assert message == "interrupted; nothing half-written was left behind"
    assert not any(Path(f"/proc/{pid}/cmdline").exists() for pid in workers)


def test_a_worker_is_killed(trade, undisturbed):
    trade.start("--workers", 2).wait_for(500)
    workers = spawned(trade)
    assert len(workers) == 2
    os.kill(workers[0], signal.SIGKILL)
    assert trade.finish()["unfinished"] == 0
    trade.check_survived(undisturbed, 1)


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


def test_the_disk_is_full(killed_study, small_disk, undisturbed):
    trade = Trade(killed_study, small_disk)
    message = trade.start("--workers", 1).finish(2)
    assert "No space left on device" in message
    before = trade.stored()
    assert before["screen"] > 0
    assert f"all {before['screen']} finished candidates" in message
    subprocess.run(["mount", "-o", "remount,size=20m", small_disk], check=True)
    trade.check_resumed(undisturbed, before, HELD + 1, "--workers", 1)


def test_the_quota_is_used_up(trade, undisturbed):
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, resource.RLIM_INFINITY))

    message = trade.start("--workers", 1, preexec_fn=limit).finish(2)
    assert "File too large" in message and "safe" in message
    trade.check_resumed(undisturbed, trade.stored(), HELD + 1, "--workers", 1)


class TestCluster:
    """A Dask scheduler and two workers, processes of their own on loopback."""

    #: Batches on their way.
    BATCHES = 2 * AHEAD

    @pytest.fixture
    def dask(self, trade, tmp_path):
        pytest.importorskip("distributed")
        running = DaskProcesses(tmp_path, trade.environment)
        yield running
        running.end()

    @pytest.fixture
    def cluster(self, dask):
        def start():
            scheduler, address = dask.scheduler("--host", "127.0.0.1")
            return address, scheduler, [dask.worker(address) for _ in range(2)]

        return start

    def test_a_worker_is_killed(self, trade, undisturbed, cluster):
        address, _, workers = cluster()
        trade.start("--scheduler", address).wait_for(500)
        workers[0].kill()
        assert trade.finish()["unfinished"] == 0
        trade.check_survived(undisturbed, self.BATCHES)

    def test_the_scheduler_is_killed(self, trade, undisturbed, cluster):
        address, scheduler, _ = cluster()
        trade.start("--scheduler", address).wait_for(500)
        scheduler.kill()
        assert "lost; every finished candidate is stored" in trade.finish(2)
        before = trade.stored()
        assert 500 <= before["screen"] < CANDIDATES
        address, _, _ = cluster()
        trade.check_resumed(undisturbed, before, self.BATCHES, "--scheduler", address)

    def test_the_client_is_killed(self, trade, undisturbed, cluster):
        address, _, _ = cluster()
        trade.start("--scheduler", address).wait_for(500)
        trade.process.kill()
        trade.process.communicate()
        before = trade.stored()
        assert 500 <= before["screen"] < CANDIDATES
        trade.rest()  # until the workers are through with what they had begun
        trade.check_resumed(undisturbed, before, self.BATCHES, "--scheduler", address)
