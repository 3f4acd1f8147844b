"""Trades as real processes, to be killed, cut off and looked into."""

import json
import os
import subprocess
import sys
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path

from compass.inputs.study import read_study
from compass.study.record import DamagedError, from_line
from compass.study.results import read_results
from compass.study.store import FILE
from compass.study.trade import BATCH

ROOT = Path(__file__).parents[2]
COUNTED = Path(__file__).with_name("counted.py")

STUDY = """
name = "To be killed"

[study]
patterns = ["walker-delta"]
satellites = { least = 12, most = 16 }
inclination_deg = { least = 30, most = 60, step = 2 }
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

#: Seconds after which something hangs: kernels may have to be compiled first, beside other work.
HANGS = 600.0

CANDIDATES = (28 + 14 + 24 + 24 + 31) * 16  # sums of divisors of 12 ... 16, 16 inclinations


class Trade:
    """A study in a folder of its own: started, watched, killed, resumed, compared.

    `around` is put before each command, to run it elsewhere (in another network, say).
    """

    def __init__(self, study, folder, around=(), **environment):
        self.study, self.folder, self.around = study, folder, list(around)
        self.log = folder.with_name(f"{folder.name}.log")
        self.environment = os.environ | {
            "PYTHONPATH": str(ROOT),
            "PYTHONWARNINGS": "ignore",
            "EVALUATIONS": str(self.log),
            **environment,
        }
        self.process = None

    def start(self, *options, **settings):
        """Start it, or go on with it."""
        command = [
            *self.around,
            sys.executable,
            COUNTED,
            "trade",
            self.study,
            "--store",
            self.folder,
        ]
        self.process = subprocess.Popen(
            [*map(str, command), "--json", *map(str, options)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=self.environment,
            **settings,
        )
        return self

    def finish(self, code=0, limit=HANGS):
        """Wait for its end; return what it says: JSON, or a message if it failed."""
        out, err = self.process.communicate(timeout=limit)
        assert self.process.returncode == code, err
        assert "Traceback" not in err
        return json.loads(out) if code in (0, 1) else err

    def wait_for(self, candidates, limit=HANGS):
        """Wait until so many are screened; the study must not be over by then."""
        end = time.monotonic() + limit
        while time.monotonic() < end:
            ended = self.process.poll() is not None
            assert not ended, self.process.communicate()
            if (self.folder / FILE).exists() and self.stored()["screen"] >= candidates:
                return
            time.sleep(0.02)
        raise AssertionError("nothing was stored")

    def stored(self):
        """How many candidates the store holds, by stage."""
        counts = Counter()
        for line in (self.folder / FILE).read_bytes().splitlines(keepends=True):
            with suppress(DamagedError):
                record = from_line(line)
                if "stage" in record:
                    counts[record["stage"]] += len(record["candidates"]["satellites"])
        return counts

    def evaluations(self):
        """How often each candidate was begun at each stage, since this was last asked."""
        counts = Counter()
        for line in self.log.read_text().splitlines() if self.log.exists() else ():
            stage, *keys = line.split()
            counts.update((stage, key) for key in keys)
        self.log.unlink(missing_ok=True)
        return counts

    def rest(self, seconds=1.0):
        """Wait until nobody has begun anything for so long: what was on its way has ended."""
        size, since = -1, time.monotonic()
        while time.monotonic() < since + seconds:
            if self.log.stat().st_size != size:
                size, since = self.log.stat().st_size, time.monotonic()
            time.sleep(0.05)

    def children(self):
        text = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text()
        return [int(child) for child in text.split()]

    def results(self):
        return read_results(read_study(self.study), self.folder)

    def check_undisturbed(self, undisturbed):
        """Everything is stored once, as if nothing had happened."""
        assert self.stored() == {"screen": CANDIDATES, "map": int(undisturbed.feasible.sum())}
        assert self.results().identical(undisturbed)

    def check_survived(self, undisturbed, batches):
        """The run came to its end, and did again only what was on its way: so many batches."""
        self.check_undisturbed(undisturbed)
        again = Counter()
        for (stage, _), times in self.evaluations().items():
            assert times <= 2
            again[stage] += times - 1
        assert all(again[stage] <= batches * BATCH[stage] for stage in again)

    def check_resumed(self, undisturbed, before, batches, *options):
        """Go on: what was stored is not computed again, and what was lost was on its way."""
        begun = self.evaluations()
        assert set(begun.values()) == {1}
        lost = Counter(stage for stage, _ in begun) - before
        assert all(lost[stage] <= batches * BATCH[stage] for stage in lost)
        summary = self.start(*options).finish()
        assert summary["computed"]["screen"] == CANDIDATES - before["screen"]
        again = self.evaluations()
        assert set(again.values()) == {1}
        assert Counter(stage for stage, _ in again) == self.stored() - before
        self.check_undisturbed(undisturbed)


class DaskProcesses:
    """A Dask scheduler and its workers, each a process; all end with this."""

    def __init__(self, folder, environment, options=()):
        self.folder, self.environment, self.options = folder, environment, list(options)
        self.running = []

    def launch(self, part, *options, around=()):
        command = [*around, sys.executable, "-m", f"distributed.cli.dask_{part}", *options]
        process = subprocess.Popen(
            [*map(str, [*command, *self.options]), "--no-dashboard"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env=self.environment,
        )
        self.running.append(process)
        return process

    def scheduler(self, *options, around=()):
        """Start a scheduler; return it and its address."""
        file = self.folder / f"scheduler-{len(self.running)}.json"
        process = self.launch(
            "scheduler", "--port", 0, "--scheduler-file", file, *options, around=around
        )
        end = time.monotonic() + HANGS
        while time.monotonic() < end:
            with suppress(OSError, json.JSONDecodeError):  # not there, or half written
                return process, json.loads(file.read_text())["address"]
            time.sleep(0.05)
        raise AssertionError(f"no scheduler in {HANGS} s")

    def worker(self, address, around=(), nanny=False):
        kind = "--nanny" if nanny else "--no-nanny"
        return self.launch(
            "worker", address, "--nthreads", 1, kind, "--preload", COUNTED, around=around
        )

    def end(self):
        for process in self.running:
            process.kill()
            process.wait()
