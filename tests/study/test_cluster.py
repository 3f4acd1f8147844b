"""A Dask cluster as workers: the same numbers, and everything that may stand at its address."""

import contextlib
import logging
import os
import pickle
import socket
import subprocess
import sys
import threading
import time
from dataclasses import replace
from http.server import BaseHTTPRequestHandler, HTTPServer

import numpy as np
import pytest
from trade_processes import DaskProcesses, Trade

import compass
from compass.errors import ArgumentError, CompassError
from compass.inputs.study import Objective
from compass.study import cluster, errand, trade
from compass.study.bounds import LEVELS, bounds, ends
from compass.study.candidates import candidates, identities
from compass.study.cluster import Cluster, Tls
from compass.study.results import read_results
from compass.study.stages import StudyJob
from compass.study.store import Store
from compass.study.trade import run_trade
from tests.one_process import OneProcess

distributed = pytest.importorskip("distributed")


class Quiet:
    """Bars that count nothing."""

    def __call__(self, *_):
        return contextlib.nullcontext(self)

    def update(self, n):
        pass


def run(study, folder, team):
    with Store(folder, study) as store:
        return run_trade(study, store, team, Quiet())


@pytest.fixture
def local():
    """Make a cluster of threads of this process."""
    with contextlib.ExitStack() as stack:

        def make(workers):
            return stack.enter_context(
                distributed.LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    processes=False,
                    protocol="tcp",
                    host="127.0.0.1",
                    dashboard_address="127.0.0.1:0",  # another may be at work beside
                )
            )

        yield make


def test_a_cluster_finds_the_same(tiny, tmp_path, monkeypatch, local):
    monkeypatch.setitem(trade.BATCH, "screen", 5)
    study = tiny()
    run(study, tmp_path / "one", OneProcess(study))
    team = Cluster(StudyJob(study), local(2).scheduler_address)
    try:
        assert team.count == 2
        run(study, tmp_path / "two", team)
    finally:
        team.close()
    one, two = (read_results(study, tmp_path / name) for name in ("one", "two"))
    assert one.identical(two)


def test_proven_bounds_by_a_cluster_have_the_same_bytes(tiny, local):
    """Of one worker and of two, as of none: certified shares that a limit leaves narrow and wide."""
    study = replace(tiny(), objectives=(Objective("availability", -1),))
    every = candidates(study)
    rows = every.rows(0, len(every))[::17]
    known = bounds(LEVELS["bounds-1"], study, rows)
    low, high = (known[end] for end in ends("availability"))
    assert (low < high).any() and rows.size > 2
    for workers in (1, 2):
        team = Cluster(StudyJob(study), local(workers).scheduler_address)
        try:
            batches = [rows[k : k + 1] for k in range(rows.size)]
            found = {batch[0].tobytes(): f.figures for batch, f in team.run("bounds-1", batches)}
        finally:
            team.close()
        for name, values in known.items():
            parts = [found[row.tobytes()][name] for row in rows]
            assert np.concatenate(parts).tobytes() == values.tobytes()


def test_a_map_by_a_cluster_has_the_same_bytes(designs, local):
    address, few = local(2).scheduler_address, {"step_deg": 45, "epochs": 2}
    here, there = (
        compass.map(designs / "draim-four.toml", **few, **where).dataset.drop_attrs(deep=False)
        for where in ({}, {"scheduler": address})
    )
    assert here.identical(there)
    with pytest.raises(ArgumentError, match="workers and scheduler: not both"):
        compass.map(designs / "draim-four.toml", workers=2, scheduler=address)


@pytest.mark.slow
def test_only_the_candidate_that_kills_its_workers_is_left_out(tiny, tmp_path, monkeypatch):
    monkeypatch.setitem(trade.BATCH, "screen", 26)
    monkeypatch.setattr(cluster, "PATIENCE", 60.0)  # a nanny and its worker begin one by one
    monkeypatch.setattr(cluster, "SILENCE", 120.0)  # and on a busy machine they take their time
    rows = candidates(tiny()).rows(0, 52)
    (key,) = identities(rows[5:6])
    environment = Trade(None, tmp_path / "store").environment | {
        "LETHAL": key,
        "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0",
    }
    dask = DaskProcesses(tmp_path, environment)
    try:
        _, address = dask.scheduler("--host", "127.0.0.1")
        dask.worker(address, nanny=True)
        team = Cluster(StudyJob(tiny()), address)
        summary = run(tiny(), tmp_path, team)
        team.close()
    finally:
        dask.end()
    assert summary.unfinished == 1 and summary.reached["screen"] == 51
    # the batch that waited behind it was not to blame
    assert set(read_results(tiny(), tmp_path).identity.values) == set(identities(rows)) - {key}


NO_ADDRESSES = (
    "  nonsense  tcp://[::1  tcp://host  tcp://host:port  tcp://host:0  http://127.0.0.1:80"
)


@pytest.mark.parametrize(
    "address",
    [*NO_ADDRESSES.split("  "), "tcp://me@127.0.0.1:9", "tcp://127.0.0.1:9/path"],
)
def test_addresses_that_are_none(tiny, address):
    with pytest.raises(ArgumentError, match="not an address; write it as tcp://host:port"):
        Cluster(StudyJob(tiny()), address)


@pytest.mark.parametrize("address", ["TCP://127.0.0.1:9", " tcp://127.0.0.1:9", "tcp://[::1]:9/"])
def test_addresses_written_otherwise(tiny, monkeypatch, address):
    monkeypatch.setattr(cluster, "PATIENCE", 0.5)
    with pytest.raises(ArgumentError, match=r"does not answer|no connection"):
        Cluster(StudyJob(tiny()), address)


def test_nobody_is_there(tiny, monkeypatch):
    monkeypatch.setattr(cluster, "PATIENCE", 0.5)
    with pytest.raises(ArgumentError, match=r"tcp://127.0.0.1:9: (does not answer|no connection)"):
        Cluster(StudyJob(tiny()), "tcp://127.0.0.1:9")


def test_somebody_is_there_and_silent(tiny, monkeypatch):
    monkeypatch.setattr(cluster, "PATIENCE", 0.5)
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(ArgumentError, match="check the address, that `dask scheduler` runs"):
            Cluster(StudyJob(tiny()), address)


def test_a_web_server_is_no_scheduler(tiny, monkeypatch):
    monkeypatch.setattr(cluster, "PATIENCE", 2.0)
    monkeypatch.setattr(BaseHTTPRequestHandler, "log_message", lambda *_: None)
    server = HTTPServer(("127.0.0.1", 0), BaseHTTPRequestHandler)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        with pytest.raises(ArgumentError, match="that `dask scheduler` runs there"):
            Cluster(StudyJob(tiny()), f"tcp://127.0.0.1:{server.server_port}")
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def test_a_worker_is_no_scheduler(tiny, local):
    (worker,) = local(1).workers.values()
    with pytest.raises(ArgumentError, match="a Dask Worker, not a scheduler"):
        Cluster(StudyJob(tiny()), worker.address)


def test_a_scheduler_without_workers(tiny, monkeypatch, local):
    monkeypatch.setattr(cluster, "PATIENCE", 1.0)
    with pytest.raises(ArgumentError, match=r"has no worker; start `dask worker tcp://127.0.0.1:"):
        Cluster(StudyJob(tiny()), local(0).scheduler_address)


@pytest.mark.parametrize(
    ("found", "why"),
    [("no package numba", "no package numba; they"), ("99", "compass 99, this is .*; they")],
)
def test_a_worker_that_cannot_do_the_work_is_named_and_left(tiny, monkeypatch, local, found, why):
    monkeypatch.setattr(cluster, "able", lambda: found)
    monkeypatch.setattr(cluster, "ByValue", lambda function: function)
    made = local(1)
    (worker,) = made.workers.values()
    with pytest.raises(
        ArgumentError, match=f"1 of 1 .*{worker.address}: {why} are left as they are"
    ):
        Cluster(StudyJob(tiny()), made.scheduler_address)
    assert worker.status.name == "running"


def test_a_worker_that_comes_later_and_cannot_is_named(tiny, tmp_path, local):
    team = Cluster(StudyJob(tiny()), local(1).scheduler_address)
    team._work = lambda version, *rest: errand.work("99", *rest)
    try:
        with pytest.raises(CompassError, match=r"tcp://[\d.:]+: compass [\d.]+, this is 99"):
            run(tiny(), tmp_path, team)
    finally:
        team.close()


LACKING = """
import sys
class Lacking:
    def find_spec(self, name, *_):
        if name.partition(".")[0] == {!r}:
            raise ModuleNotFoundError(f"No module named {{name}}", name={!r})
sys.meta_path.insert(0, Lacking())
"""


@pytest.mark.slow
@pytest.mark.parametrize("package", ["compass", "numba"])
def test_a_real_worker_without_a_package_lives_on(tiny, tmp_path, monkeypatch, package):
    monkeypatch.setattr(cluster, "PATIENCE", 60.0)
    (tmp_path / "lacking.py").write_text(LACKING.format(package, package))
    dask = DaskProcesses(tmp_path, dict(os.environ))
    try:
        # the scheduler lacks all of it: it need not know what the work is
        _, address = dask.scheduler("--host", "127.0.0.1", "--preload", tmp_path / "lacking.py")
        options = "--nthreads", 1, "--no-nanny", "--preload", tmp_path / "lacking.py"
        worker = dask.launch("worker", address, *options)
        for _ in range(2):
            with pytest.raises(ArgumentError, match=rf"1 of 1 .*no package {package}"):
                Cluster(StudyJob(tiny()), address)
        assert worker.poll() is None
    finally:
        dask.end()


def test_what_is_sent_needs_nothing_of_this_package():
    for function in (errand.able, errand.work):
        code = pickle.dumps(errand.ByValue(function))
        script = (
            "import pickle, sys\nsys.modules['compass'] = None\n"
            "function = pickle.loads(sys.stdin.buffer.read())\n"
            "print(function.__name__, function() if function.__code__.co_argcount == 0 else '')"
        )
        done = subprocess.run([sys.executable, "-c", script], input=code, capture_output=True)
        assert done.stdout.decode().split()[0] == function.__name__, done.stderr
    assert errand.able() == compass.__version__


INSTEAD = """
import pickle, sys
from importlib.machinery import PathFinder
class Instead:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] == "compass":
            if (found := PathFinder.find_spec(name, path or [{!r}])) is None:
                raise ModuleNotFoundError(name, name=name)
            return found
sys.meta_path.insert(0, Instead())
print(pickle.loads(sys.stdin.buffer.read())())
"""


@pytest.mark.parametrize(
    ("file", "text", "said"),
    [
        ("none.txt", "", "no package compass"),
        ("compass/left.txt", "", "no package compass.study, and {}/compass is another compass"),
        ("compass/__init__.py", "", "no package compass.study, and {}/compass/__init__.py is anot"),
        ("compass.py", "", "no package compass.study, and {}/compass.py is another compass"),
        ("compass.py", "1 / 0", "cannot import compass: division by zero"),
        ("compass.py", "import absent", "no package absent"),
    ],
)
def test_what_a_machine_has_in_place_of_this_package_is_named(tmp_path, file, text, said):
    tmp_path.joinpath(file).parent.mkdir(exist_ok=True)
    tmp_path.joinpath(file).write_text(text)
    code = pickle.dumps(errand.ByValue(errand.able))
    script = INSTEAD.format(str(tmp_path))
    done = subprocess.run([sys.executable, "-c", script], input=code, capture_output=True)
    found = done.stdout.decode()
    assert found.startswith(said.format(tmp_path)) and found.count("\n") == 1, done.stderr


def test_the_loggers_of_a_host_are_left_alone(tiny, local):
    levels = [logging.getLogger(name).level for name in ("distributed", "tornado.application")]
    Cluster(StudyJob(tiny()), local(1).scheduler_address).close()
    assert levels == [
        logging.getLogger(name).level for name in ("distributed", "tornado.application")
    ]


def test_a_cluster_that_loses_all_its_workers(tiny, tmp_path, monkeypatch, local):
    monkeypatch.setattr(cluster, "WATCH", 0.1)
    monkeypatch.setattr(cluster, "SILENCE", 1.0)
    made = local(1)
    team = Cluster(StudyJob(tiny()), made.scheduler_address)
    try:
        made.scale(0)
        end = time.monotonic() + 60
        while made.scheduler.workers and time.monotonic() < end:
            time.sleep(0.05)
        with pytest.raises(CompassError, match="has had no worker for 1 s; every finished"):
            run(tiny(), tmp_path, team)
    finally:
        team.close()


@pytest.mark.parametrize(
    ("address", "message"),
    [
        ("tls://127.0.0.1:9", "missing.pem: no such file; give a certificate or key"),
        ("tcp://127.0.0.1:9", "with certificates, write it as tls://host:port"),
    ],
)
def test_certificates_that_are_not_there(tiny, tmp_path, address, message):
    missing = tmp_path / "missing.pem"
    with pytest.raises(ArgumentError, match=message):
        Cluster(StudyJob(tiny()), address, Tls(missing, missing, missing))


def test_text_is_no_certificate(tiny, tmp_path):
    text = tmp_path / "text.pem"
    text.write_text("hello")
    with pytest.raises(ArgumentError, match=r"--tls-ca = .*text.pem: not a certificate"):
        Cluster(StudyJob(tiny()), "tls://127.0.0.1:9", Tls(text, text, text))


def test_tls_without_certificates(tiny):
    with pytest.raises(ArgumentError, match="needs certificates; give --tls-ca"):
        Cluster(StudyJob(tiny()), "tls://127.0.0.1:9")
