"""Trade: candidates a second, share of time outside kernels, growth from 10^2 to 10^6, a cluster.

Run: pytest tests/bench/bench_trade.py -o python_files="bench_*.py" -p no:xdist -s
"""

import contextlib
import json
import os
import pickle
import subprocess
import sys
import time
from pathlib import Path

import pytest

from compass.inputs.study import read_study, read_study_text
from compass.study import pattern_judging, pattern_map, stages, trade
from compass.study.candidates import candidates
from compass.study.cluster import AHEAD, Cluster
from compass.study.stages import StudyJob, evaluate
from compass.study.store import FILE, Store
from compass.study.trade import run_trade
from compass.study.workers import Processes
from tests.one_process import OneProcess
from tests.study.trade_processes import DaskProcesses

ROOT = Path(__file__).parents[2]

TEXT = """
name = "growth"
[study]
patterns = {patterns}
satellites = {{ least = 8, most = 16 }}
inclination_deg = {{ least = 40, most = {most}, step = {step} }}
orbits = ["areosynchronous"]
mask_deg = 5
[[constraint]]
figure = "fold_proven"
at_least = 1
[[objective]]
figure = "satellites"
[[objective]]
figure = "mask_margin_deg"
"""

BOTH, ONE = '["walker-delta", "walker-star"]', '["walker-delta"]'


class Quiet:
    def __call__(self, *_):
        return contextlib.nullcontext(self)

    def update(self, n):
        pass


#: Patterns of both kinds of 8 to 16 satellites.
PATTERNS = 349


def growth_text(inclinations, patterns=BOTH):
    """A study of so many inclinations from 40 to 60 degrees of all patterns."""
    step = 20 / max(inclinations - 1, 1)
    most = 40 + step * (inclinations - 0.5)
    return TEXT.format(patterns=patterns, most=most, step=step)


def growth(*asked):
    return read_study_text(growth_text(*asked))


def timed(study, folder, team):
    began = time.perf_counter()
    with Store(folder, study) as store:
        summary = run_trade(study, store, team, Quiet())
    return summary, time.perf_counter() - began


class Clock:
    """Sums the processor time spent in compiled kernels of the stages.

    No LAPACK is called. All else counts as outside: orbits, constraints, costs, percentiles,
    JSON, the store.
    """

    def __init__(self, monkeypatch):
        self.seconds = 0.0
        for module, name in (
            (stages, "screen_patterns"),
            (pattern_map, "map_patterns"),
            (pattern_judging, "judge_patterns"),
        ):
            monkeypatch.setattr(module, name, self._timing(getattr(module, name)))

    def _timing(self, kernel):
        def call(*arguments):
            began = time.process_time()
            try:
                return kernel(*arguments)
            finally:
                self.seconds += time.process_time() - began

        return call


def split(monkeypatch, work, times=5):
    """Least processor time in kernels and outside them, of some runs of the same work."""
    inside, outside = [], []
    for run in range(times):
        with monkeypatch.context() as patch:
            clock = Clock(patch)
            began = time.process_time()
            work(run)
            outside.append(time.process_time() - began - clock.seconds)
        inside.append(clock.seconds)
    return min(inside), min(outside)


def warm(study):
    rows = candidates(study).rows(0, 2)
    for stage in ("screen", "map", *(("entry",) if study.entry else ())):
        evaluate(stage, study, rows)


def test_share_of_time_outside_kernels(tmp_path, monkeypatch):
    study = growth(30)
    warm(study)
    summaries = []

    def whole(run):
        summaries.append(timed(study, tmp_path / str(run), OneProcess(study))[0])

    inside, outside = split(monkeypatch, whole)
    share = outside / (inside + outside)
    print(
        f"\n{summaries[0].candidates} candidates, {summaries[0].reached['map']} mapped, stored: "
        f"{summaries[0].candidates / (inside + outside):.0f} a second on one core; "
        f"{share:.1%} outside kernels"
    )
    assert share < 0.2


def thinned(every):
    """Every so many candidates of the fourfold study, and those of them that pass the screen."""
    study = read_study(ROOT / "designs/study-fourfold.toml")
    warm(study)
    found = candidates(study)
    rows = found.rows(0, len(found))[::every]
    return (
        study,
        rows,
        rows[stages.passing(study, "screen", evaluate("screen", study, rows).figures)],
    )


def in_batches(stage, rows):
    size = trade.BATCH[stage]
    return [rows[k : k + size] for k in range(0, rows.size, size)]


def test_stage_by_stage(monkeypatch):
    study, rows, kept = thinned(every=60)
    for stage, some in (("screen", rows), ("map", kept), ("entry", kept)):
        parts = in_batches(stage, some)
        inside, outside = split(
            monkeypatch, lambda _, s=stage, p=parts: [evaluate(s, study, part) for part in p]
        )
        share = outside / (inside + outside)
        print(
            f"\n{stage}: {1e3 * (inside + outside) / some.size:.3f} ms a candidate, "
            f"{some.size / (inside + outside):.0f} a second on one core; {share:.1%} outside kernels"
        )
        assert share < 0.2


def test_throughput_on_one_core_and_on_two():
    """Screened: as the grid comes. Fully judged: survivors, through all three stages."""
    study, rows, kept = thinned(every=60)
    work = {
        "screened": [("screen", rows)],
        "fully judged": [("screen", kept), ("map", kept), ("entry", kept)],
    }
    teams = {"one core": OneProcess(study), "two cores": Processes(study, 2)}
    for stage in ("screen", "map", "entry"):  # start up
        list(teams["two cores"].run(stage, [rows[k : k + 1] for k in range(8)]))
    try:
        for what, steps in work.items():
            rates = {}
            for name, team in teams.items():
                wall = min(through(team, steps) for _ in range(5))
                rates[name] = steps[0][1].size / wall
            texts = [f"{rate:.0f} a second on {name}" for name, rate in rates.items()]
            print(f"\n{what}: {', '.join(texts)}")
    finally:
        teams["two cores"].close()


def through(team, steps):
    """Wall time of stages one after another, in batches small enough for both workers."""
    began = time.perf_counter()
    for stage, rows in steps:
        size = min(trade.BATCH[stage], -(-rows.size // 8))
        for _, found in team.run(stage, [rows[k : k + size] for k in range(0, rows.size, size)]):
            assert not found.errors
    return time.perf_counter() - began


@pytest.mark.parametrize(
    ("inclinations", "patterns"), [(1, ONE), (3, BOTH), (30, BOTH), (300, BOTH)]
)
def test_growth(tmp_path, inclinations, patterns):
    study = growth(inclinations, patterns)
    warm(study)
    summary, seconds = timed(study, tmp_path, OneProcess(study))
    work = sum(summary.seconds.values())
    size = (tmp_path / FILE).stat().st_size
    began = time.perf_counter()
    timed(study, tmp_path, OneProcess(study))
    again = time.perf_counter() - began
    n = summary.candidates
    print(
        f"\n{n} candidates: {seconds:.2f} s, {1e3 * seconds / n:.3f} ms each; handling "
        f"{1e6 * (seconds - work) / n:.0f} us each; store {size / n:.0f} bytes each; "
        f"reading it again {1e6 * again / n:.0f} us each"
    )


@pytest.mark.parametrize("inclinations", [30, 3000])
def test_a_whole_study_killed_once(tmp_path, inclinations):
    """The command as a user runs it, on two workers: killed half-way, given again, all in the end."""
    psutil = pytest.importorskip("psutil")
    file = tmp_path / "study.toml"
    file.write_text(growth_text(inclinations))
    candidates_to_screen = PATTERNS * inclinations
    command = [sys.executable, "-m", "compass", "trade", str(file), "--workers", "2", "--json"]
    command += ["--output", str(tmp_path / "store")]
    wall, most = [], 0
    for limit in (candidates_to_screen / 20_000, None):
        began = time.perf_counter()
        with (tmp_path / "answer").open("wb") as answer:
            running = psutil.Popen(command, stdout=answer, stderr=subprocess.DEVNULL)
        while running.poll() is None and (limit is None or time.perf_counter() - began < limit):
            with contextlib.suppress(psutil.Error):
                family = [running, *running.children(recursive=True)]
                most = max(most, sum(part.memory_info().rss for part in family))
            time.sleep(0.2)
        if running.poll() is None:
            running.kill()
        running.wait()
        wall.append(time.perf_counter() - began)
    found = json.loads((tmp_path / "answer").read_text())
    print(
        f"\n{found['candidates']} candidates, two workers: killed after {wall[0]:.0f} s, done "
        f"{wall[1]:.0f} s after the second start; at most {most / 1e9:.2f} GB in all processes"
    )
    assert found["candidates"] == candidates_to_screen
    assert most < 2e9


@pytest.mark.parametrize("workers", [2, 8])
def test_one_process_some_processes_some_cluster_workers(tmp_path, workers):
    """What more workers than cores cost, and that they all find the same to the last digit."""
    pytest.importorskip("distributed")
    study = growth(60)
    warm(study)
    wall = {}
    _, wall["1 process"] = timed(study, tmp_path / "1", OneProcess(study))
    team = Processes(study, workers)
    list(team.run("screen", [candidates(study).rows(k, k + 1) for k in range(4 * workers)]))
    _, wall[f"{workers} processes"] = timed(study, tmp_path / "2", team)
    team.close()
    dask = DaskProcesses(tmp_path, os.environ | {"PYTHONPATH": str(ROOT)})
    try:
        scheduler, address = dask.scheduler("--host", "127.0.0.1")
        for _ in range(workers):
            dask.launch("worker", address, "--nthreads", 1, "--no-nanny")
        team = Cluster(StudyJob(study), address)
        list(team.run("screen", [candidates(study).rows(k, k + 1) for k in range(4 * workers)]))
        before = processor_seconds(scheduler.pid)
        summary, wall[f"{workers} cluster workers"] = timed(study, tmp_path / "3", team)
        load = processor_seconds(scheduler.pid) - before
        team.close()
    finally:
        dask.end()
    stored = [figures_stored(tmp_path / run / FILE) for run in "123"]
    assert stored[0] == stored[1] == stored[2]
    batch = candidates(study).rows(0, trade.BATCH["screen"])
    task = len(pickle.dumps((study, batch)))
    answer = len(pickle.dumps(evaluate("screen", study, batch)))
    tasks = sum(-(-n // trade.BATCH[stage]) for stage, n in summary.reached.items())
    print(
        f"\n{summary.candidates} candidates, {os.cpu_count()} cores, the same figures stored",
        end="",
    )
    for name, seconds in wall.items():
        print(f"\n{name}: {seconds:.2f} s, speed-up {wall['1 process'] / seconds:.2f}", end="")
    print(
        f"\nscheduler: {tasks} tasks, {1e3 * load / tasks:.1f} ms of processor each; task "
        f"{task} bytes, answer {answer} bytes, for {batch.size} candidates; at most "
        f"{AHEAD} tasks a worker on their way"
    )


def figures_stored(file):
    """What a store knows of each candidate at each stage: how they were batched does not count."""
    known = {}
    for line in file.read_bytes().splitlines()[1:]:
        batch = json.loads(line.partition(b" ")[2])
        assert not batch["errors"]
        columns = [*batch["candidates"].values(), *batch["figures"].values()]
        places = len(batch["candidates"])
        for row in zip(*columns, strict=True):
            known[batch["stage"], *row[:places]] = row[places:]
    return known


def processor_seconds(pid):
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
