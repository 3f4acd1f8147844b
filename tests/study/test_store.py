"""The store: nothing that was reported as stored is lost, nothing torn is believed."""

import csv
import errno
import os
from pathlib import Path

import numpy as np
import pytest

import compass
from compass.errors import ArgumentError, OutputError
from compass.study import store as module
from compass.study.candidates import candidates, identities
from compass.study.record import as_line, header
from compass.study.results import read_results, write_results
from compass.study.stages import Found, evaluate
from compass.study.store import FILE, Store
from tests.reference.conventions import assert_in_conventions


@pytest.fixture
def batch(tiny):
    study = tiny()
    rows = candidates(study).rows(0, 10)
    return study, rows, evaluate("screen", study, rows)


def cut(found, part):
    """What was found of a part of a batch."""
    return Found({name: values[part] for name, values in found.figures.items()}, {}, 0.0)


def test_what_goes_in_comes_out(batch, tmp_path):
    study, rows, found = batch
    found.figures["mask_margin_deg"][:3] = np.inf, -np.inf, np.nan
    with Store(tmp_path, study) as store:
        store.add("screen", rows, found)
        assert store.finished == 10
    with Store(tmp_path, study) as store:
        assert store.done["screen"] == set(identities(rows)) and store.damaged == []
        (stored,) = store.batches["screen"]
        assert store.batches["map"] == []
    assert np.array_equal(stored.rows, rows)
    for name, values in stored.found.figures.items():
        assert np.array_equal(values, found.figures[name], equal_nan=True)


def test_every_torn_end_is_dropped(batch, tmp_path):
    study, rows, found = batch
    with Store(tmp_path, study) as store:
        store.add("screen", rows[:5], cut(found, slice(5)))
        safe = (tmp_path / FILE).stat().st_size
        store.add("screen", rows[5:], cut(found, slice(5, 10)))
    whole = (tmp_path / FILE).read_bytes()
    for end in range(safe, len(whole), 41):
        (tmp_path / FILE).write_bytes(whole[:end])
        with Store(tmp_path, study) as store:
            assert store.finished == 5
            store.add("screen", rows[5:], cut(found, slice(5, 10)))
        assert (tmp_path / FILE).read_bytes() == whole


def begun(folder, study):
    """A store of which only the first line was written before its run was killed."""
    (folder / FILE).write_bytes(as_line(header(study)))


def test_a_first_line_torn_begins_anew(tiny, tmp_path):
    whole = as_line(header(tiny()))
    for end in range(0, len(whole), 7):
        (tmp_path / FILE).write_bytes(whole[:end])
        with Store(tmp_path, tiny()):
            assert (tmp_path / FILE).read_bytes() == whole


def test_a_run_that_finishes_nothing_leaves_no_store(batch, tmp_path):
    study, rows, found = batch
    with pytest.raises(OutputError, match="no cluster"), Store(tmp_path / "trades" / "a", study):
        raise OutputError("no cluster")
    assert not list(tmp_path.iterdir())
    (tmp_path / "trades").mkdir()
    with Store(tmp_path / "trades" / "a", study):
        (tmp_path / "trades" / "a" / "notes").write_text("mine")
    assert [file.name for file in (tmp_path / "trades" / "a").iterdir()] == ["notes"]
    with Store(tmp_path / "b", study) as store:
        store.add("screen", rows, found)
    Store(tmp_path / "b", study).close()
    assert (tmp_path / "b" / FILE).exists()


def test_a_first_batch_stays_that_is_written_when_the_run_is_interrupted(
    batch, tmp_path, monkeypatch
):
    study, rows, found = batch

    def stop(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), Store(tmp_path / "a", study) as store:
        monkeypatch.setattr(module.os, "fsync", stop)
        store.add("screen", rows, found)
    monkeypatch.undo()
    with Store(tmp_path / "a", study) as store:
        assert store.done["screen"] == set(identities(rows))


def test_a_spoilt_line_in_the_middle_is_left_out(batch, tmp_path):
    study, rows, found = batch
    with Store(tmp_path, study) as store:
        store.add("screen", rows[:5], cut(found, slice(5)))
        end = (tmp_path / FILE).stat().st_size
        store.add("screen", rows[5:], cut(found, slice(5, 10)))
    data = bytearray((tmp_path / FILE).read_bytes())
    data[end - 20] ^= 1
    (tmp_path / FILE).write_bytes(data)
    with Store(tmp_path, study) as store:
        assert store.damaged == ["line 2: torn or spoilt"]
        assert store.done["screen"] == set(identities(rows[5:]))


def test_two_runs_at_once_are_refused(tiny, tmp_path):
    with Store(tmp_path, tiny()), pytest.raises(ArgumentError, match="another run is at work"):
        Store(tmp_path, tiny())
    Store(tmp_path, tiny()).close()


def test_another_study_and_another_version_are_refused(tiny, tmp_path, monkeypatch):
    begun(tmp_path, tiny())
    with pytest.raises(ArgumentError, match=r"the store of another study \('tiny'"):
        Store(tmp_path, tiny(fold=2))
    with pytest.raises(ArgumentError, match="the store of another study"):
        read_results(tiny(fold=2), tmp_path)
    monkeypatch.setattr(compass, "__version__", "99")
    with pytest.raises(ArgumentError, match="this is 99, format 6, whose numbers may differ"):
        Store(tmp_path, tiny())


@pytest.mark.parametrize("text", ["hello\nworld\n", "one line\n", '{"not": "ended"', "x" * 500])
def test_a_file_that_is_no_store_stays_as_it_is(tiny, tmp_path, text):
    (tmp_path / FILE).write_text(text)
    with pytest.raises(ArgumentError, match="not a store of candidates, or its first line is dam"):
        Store(tmp_path, tiny())
    assert (tmp_path / FILE).read_text() == text


def test_a_folder_that_cannot_be_one(tiny, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be used"):
        Store(tmp_path / "file", tiny())


@pytest.mark.parametrize(
    "make",
    [Path.mkdir, os.mkfifo, lambda p: p.symlink_to("/dev/full"), lambda p: p.symlink_to("/no/x")],
)
def test_something_else_at_the_place_of_the_store(tiny, tmp_path, make):
    make(tmp_path / FILE)
    with pytest.raises(OutputError, match=f"{FILE}: cannot be used: "):
        Store(tmp_path, tiny())


@pytest.mark.parametrize("gone", [Path.unlink, lambda p: p.rename(p.with_name("moved"))])
def test_a_store_that_is_taken_away_ends_the_run(batch, tmp_path, gone):
    study, rows, found = batch
    with Store(tmp_path, study) as store:
        gone(store.path)
        with pytest.raises(OutputError, match="deleted or moved while in use"):
            store.add("screen", rows, found)
    with pytest.raises(ArgumentError, match="no such store"):
        read_results(study, tmp_path)


def test_a_file_system_without_locks_is_not_another_run(tiny, tmp_path, monkeypatch):
    def refuse(*_):
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr("fcntl.flock", refuse)
    with pytest.raises(OutputError, match="cannot be locked: No locks available"):
        Store(tmp_path, tiny())


@pytest.mark.parametrize("part", [0, 30])
def test_a_full_disk_takes_nothing_back(batch, tmp_path, monkeypatch, part):
    study, rows, found = batch
    honest = os.write

    def full(handle, data):
        if part:
            honest(handle, data[:part])
        raise OSError(errno.ENOSPC, "No space left on device")

    with Store(tmp_path, study) as store:
        store.add("screen", rows[:5], cut(found, slice(5)))
        before = (tmp_path / FILE).read_bytes()
        monkeypatch.setattr(module.os, "write", full)
        with pytest.raises(OutputError, match="No space left on device; all 5 finished"):
            store.add("screen", rows[5:], cut(found, slice(5, 10)))
        assert (tmp_path / FILE).read_bytes() == before
        monkeypatch.undo()
        store.add("screen", rows[5:], cut(found, slice(5, 10)))
    assert len(read_results(study, tmp_path).candidate) == 10


def test_results_of_all_stages_and_their_errors(tiny, tmp_path):
    study = tiny()
    rows = candidates(study).rows(0, 52)
    with Store(tmp_path, study) as store:
        found = evaluate("screen", study, rows)
        store.add("screen", rows, found)
        proven = np.flatnonzero(found.figures["fold_proven"] == 1)
        mapped = evaluate("map", study, rows[proven])
        mapped.errors[0] = "ValueError: made up"
        store.add("map", rows[proven], mapped)
    results = read_results(study, tmp_path)
    assert results.sizes["candidate"] == 52
    assert set(results.identity.values) == set(identities(rows))
    assert (results.stage == "map").sum() == proven.size
    assert results.feasible.sum() == proven.size - 1
    assert (results.error != "").sum() == 1
    one = results.isel(
        candidate=int(np.flatnonzero(results.identity == identities(rows)[proven[1]])[0])
    )
    assert one.gdop_p50 == mapped.figures["gdop_p50"][1]
    # the front by its definition
    good = results.isel(candidate=np.flatnonzero(results.feasible))
    t, m = good.satellites.values, good.mask_margin_deg.values
    for k in range(t.size):
        beaten = np.any((t <= t[k]) & (m >= m[k]) & ((t < t[k]) | (m > m[k])))
        assert (good.front.values[k] == 0) == (not beaten)
    write_results(results, tmp_path / "trade.nc")
    import xarray as xr

    with xr.open_dataset(tmp_path / "trade.nc", engine="h5netcdf") as again:
        assert np.array_equal(again.front, results.front)
        assert again.mask_margin_deg.units == "degree"
    assert_in_conventions(tmp_path / "trade.nc")
    with (tmp_path / "trade.csv").open(newline="", encoding="utf-8") as stream:
        lines = list(csv.DictReader(stream))
    assert [line["identity"] for line in lines] == results.identity.values.tolist()
    assert float(lines[0]["radius_km"]) == float(results.radius_km[0])
    unknown = np.isnan(results.gdop_p95.values)
    assert [line["gdop_p95"] == "" for line in lines] == unknown.tolist() and unknown.any()
    # what has no attributes says in words how figures are known
    assert [line["gdop_p95_evidence"] for line in lines] == [
        "" if none else "sampled" for none in unknown
    ]
    assert "radius_km_evidence" not in lines[0]


def test_results_without_the_line_of_a_screening(tiny, tmp_path):
    study = tiny()
    rows = candidates(study).rows(0, 52)
    screened = evaluate("screen", study, rows)
    rows = rows[screened.figures["fold_proven"] == 1]
    mapped = evaluate("map", study, rows)
    mapped.errors.update({0: "ValueError: made up", rows.size - 1: "ValueError: another"})
    with Store(tmp_path, study) as store:
        store.add("screen", rows[1:], evaluate("screen", study, rows[1:]))
        store.add("map", rows, mapped)
    results = read_results(study, tmp_path)
    assert set(results.identity.values) == set(identities(rows[1:]))
    last = results.isel(candidate=results.identity.values.tolist().index(identities(rows)[-1]))
    assert last.error == "ValueError: another" and (results.error != "").sum() == 1
    assert (results.stage == "map").all() and last.gdop_p50 == mapped.figures["gdop_p50"][-1]


def test_no_store_to_read(tiny, tmp_path):
    with pytest.raises(ArgumentError, match=r"no such store; run `compass trade tiny.toml` first"):
        read_results(tiny(), tmp_path)


def test_a_store_without_a_finished_candidate(tiny, tmp_path):
    begun(tmp_path, tiny())
    with pytest.raises(ArgumentError, match="no candidate is finished yet"):
        read_results(tiny(), tmp_path)
