"""A cluster on other networks: the link is cut in mid-study, for a while and for good."""

import os
import shutil
import subprocess
import time

import pytest
from trade_processes import CANDIDATES, DaskProcesses, Trade

from compass.study.cluster import AHEAD

pytestmark = pytest.mark.slow

#: Batches on their way to two workers.
BATCHES = 2 * AHEAD


def ip(*arguments):
    subprocess.run(["ip", *arguments], check=True, capture_output=True)


class Networks:
    """Three hosts as network namespaces: a client and a far worker, each linked to a hub."""

    def __init__(self):
        stem = f"compass-{os.getpid()}"
        self.hub, self.client, self.far = (f"{stem}-{name}" for name in ("hub", "client", "far"))
        self.links = {self.client: "link1", self.far: "link2"}

    def make(self):
        for name in (self.hub, self.client, self.far):
            ip("netns", "add", name)
            ip("-n", name, "link", "set", "lo", "up")
        for net, (name, link) in enumerate(self.links.items(), start=1):
            # 192.0.2.0/24 is kept for documentation (RFC 5737): it is nobody's
            ip("-n", self.hub, "link", "add", link, "type", "veth", "peer", "eth0", "netns", name)
            ip("-n", self.hub, "address", "add", f"192.0.2.{16 * net + 1}/28", "dev", link)
            ip("-n", name, "address", "add", f"192.0.2.{16 * net + 2}/28", "dev", "eth0")
            ip("-n", self.hub, "link", "set", link, "up")
            ip("-n", name, "link", "set", "eth0", "up")

    def address(self, name):
        """Of the hub, as a host sees it."""
        return f"192.0.2.{16 * (1 + list(self.links).index(name)) + 1}"

    def set(self, name, state):
        ip("-n", self.hub, "link", "set", self.links[name], state)

    def end(self):
        for name in (self.hub, self.client, self.far):
            subprocess.run(["ip", "netns", "delete", name], capture_output=True)


def on(name):
    return ["ip", "netns", "exec", name]


@pytest.fixture
def networks():
    pytest.importorskip("distributed")
    if not shutil.which("ip"):
        pytest.skip("no network namespaces: the program ip is not installed")
    made = Networks()
    try:
        made.make()
    except subprocess.CalledProcessError as error:
        made.end()
        pytest.skip(f"no network namespaces: {error.stderr.decode().strip()}")
    yield made
    made.end()


@pytest.fixture
def trade(killed_study, tmp_path, networks):
    """Give up on a silent scheduler after 8 s, on a silent worker after 12, not half a minute."""
    return Trade(
        killed_study,
        tmp_path / "store",
        on(networks.client),
        SILENCE="8",
        DASK_DISTRIBUTED__COMM__TIMEOUTS__TCP="12s",
    )


@pytest.fixture
def cluster(trade, networks, tmp_path):
    """Give the scheduler's address for the client: it and a worker at the hub, another far off."""
    dask = DaskProcesses(tmp_path, trade.environment)
    _, address = dask.scheduler(around=on(networks.hub))
    port = address.rpartition(":")[2]
    dask.worker(f"tcp://{networks.address(networks.far)}:{port}", on(networks.hub))
    dask.worker(f"tcp://{networks.address(networks.far)}:{port}", on(networks.far))
    yield f"tcp://{networks.address(networks.client)}:{port}"
    dask.end()


def test_a_short_cut_costs_only_its_time(trade, networks, cluster, undisturbed):
    trade.start("--scheduler", cluster).wait_for(500)
    networks.set(networks.client, "down")
    time.sleep(3)
    assert trade.process.poll() is None
    networks.set(networks.client, "up")
    assert trade.finish()["unfinished"] == 0
    trade.check_survived(undisturbed, 0)


def test_a_long_cut_ends_the_run_and_the_same_command_goes_on(
    trade, networks, cluster, undisturbed
):
    trade.start("--scheduler", cluster).wait_for(500)
    networks.set(networks.client, "down")
    message = trade.finish(2)
    assert "lost; every finished candidate is stored" in message
    before = trade.stored()
    assert 500 <= before["screen"] < CANDIDATES
    networks.set(networks.client, "up")
    trade.check_resumed(undisturbed, before, BATCHES, "--scheduler", cluster)


def test_the_work_of_a_worker_that_is_cut_off_goes_to_another(
    trade, networks, cluster, undisturbed
):
    trade.start("--scheduler", cluster).wait_for(500)
    networks.set(networks.far, "down")
    assert trade.finish()["unfinished"] == 0
    trade.check_survived(undisturbed, BATCHES)
