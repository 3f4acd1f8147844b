"""A store's line is read like any file: whatever it says, nothing is believed that no run writes."""

import json
from zlib import crc32

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import compass
from compass.errors import ArgumentError, CompassError
from compass.study.candidates import ROW, candidates
from compass.study.record import DamagedError, batch_record, from_line
from compass.study.results import read_results
from compass.study.stages import evaluate
from compass.study.store import FILE, Store


@pytest.fixture
def whole(tiny, tmp_path_factory):
    """A store of 12 candidates in two lines, its study and what it holds."""
    study = tiny()
    folder = tmp_path_factory.mktemp("whole")
    rows = candidates(study).rows(0, 12)
    with Store(folder, study) as store:
        for part in (rows[:5], rows[5:]):
            store.add("screen", part, evaluate("screen", study, part))
    return study, (folder / FILE).read_bytes().splitlines(keepends=True), rows


def forged(record):
    """A line with the checksum that it ought to have."""
    text = record if isinstance(record, bytes) else json.dumps(record).encode()
    return b"%08x %s\n" % (crc32(text), text)


def opened(study, lines, folder):
    """What a store of some lines holds: damage, and the results of the rest."""
    (folder / FILE).write_bytes(b"".join(lines))
    with Store(folder, study) as store:
        damage = store.damaged
    return damage, read_results(study, folder)


def test_the_lines_of_a_run_are_read_as_they_were_written(whole, tmp_path):
    study, lines, rows = whole
    damage, results = opened(study, lines, tmp_path)
    assert damage == [] and results.sizes["candidate"] == rows.size


def changes(record):
    """Forged records: each with one thing that no run writes, and words of what is said of it."""

    def put(value, *path):
        made = json.loads(json.dumps(record))
        inner = made
        for key in path[:-1]:
            inner = inner[key]
        if value is KeyError:
            del inner[path[-1]]
        else:
            inner[path[-1]] = value
        return made

    size = len(record["candidates"]["satellites"])
    for key in record:
        yield put(KeyError, key), "keys"
        yield put({"deep": [1]} if key != "candidates" else 7, key), ""
    yield put(1, "more"), "keys"
    yield put("judged", "stage"), "stage"
    yield put("entry", "stage"), "figures"
    yield put("0" * 32 + " " + compass.__version__, "of"), "another study"
    yield put(record["of"] + "1", "of"), "another version"
    for name, values in record["candidates"].items():
        yield put(KeyError, "candidates", name), "candidates"
        yield put(values[:1], "candidates", name), "values for"
        yield put(values * 2, "candidates", name), "values for"
        yield put([*values[1:], None], "candidates", name), "candidate"
        yield put([*values[1:], True], "candidates", name), ""
        yield put([*values[1:], "x"], "candidates", name), ""
        yield put([*values[1:], 10**400], "candidates", name), ""
        yield put([*values[1:], -1], "candidates", name), ""
        yield put([*values[1:], 32767], "candidates", name), ""
    yield put([41.0] * size, "candidates", "inclination_deg"), "does not have"
    yield put([20427.0] * size, "candidates", "radius_km"), "does not have"
    yield put(["walker-star"] * size, "candidates", "pattern"), "does not have"
    yield put([5.5] * size, "candidates", "satellites"), "numbers that a candidate has"
    empty = {name: [] for name in record["candidates"]}
    yield put(empty, "candidates"), "no candidate"
    for name, values in record["figures"].items():
        yield put(KeyError, "figures", name), "figures"
        yield put(values[:1], "figures", name), "1 values for"  # not to be broadcast
        yield put(values[0], "figures", name), "must be a list"
        yield put([*values[1:], "nan"], "figures", name), "must be numbers"
        yield put([*values[1:], [1]], "figures", name), "must be numbers"
        yield put([*values[1:], True], "figures", name), "must be numbers"
    yield put([1.0] * size, "figures", "gdop_p50"), "figures"
    for errors in ({"99": "x"}, {"-1": "x"}, {"a": "x"}, {"0": 1}, {" 0": "x"}, ["x"]):
        yield put(errors, "errors"), "errors"
    for seconds in (-1, None, "inf", "1"):
        yield put(seconds, "seconds"), "seconds"


def test_forged_lines_are_left_out_and_said(whole, tmp_path):
    study, lines, _ = whole
    _, honest = opened(study, [*lines[:2]], tmp_path)
    count = 0
    for record, words in changes(from_line(lines[2])):
        damage, results = opened(study, [*lines[:2], forged(record)], tmp_path)
        assert len(damage) == 1 and damage[0].startswith("line 3: "), record
        assert words in damage[0], (damage[0], words)
        assert results.identical(honest)
        count += 1
    assert count > 120


@pytest.mark.parametrize(
    "text",
    [
        b"", b"null", b"[]", b"3", b'"x"', b"{", b"\xff", b"[" * 100_000, b'{"a":' * 100_000,
        b"NaN", b'{"stage": NaN}', b'{"seconds": 1e999}', b"1" * 5000,
    ],
)  # fmt: skip
def test_lines_that_are_no_record_are_left_out(whole, tmp_path, text):
    study, lines, _ = whole
    damage, results = opened(study, [lines[0], forged(text), lines[1]], tmp_path)
    assert len(damage) == 1 and damage[0].startswith("line 2: ")
    assert results.sizes["candidate"] == 5


JUNK = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=3),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner),
    max_leaves=5,
)


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_junk_anywhere_is_never_a_traceback_nor_a_new_candidate(whole, tmp_path, data):
    study, lines, rows = whole
    number = data.draw(st.integers(0, 2))
    record = from_line(lines[number])
    place = record
    while True:
        key = data.draw(st.sampled_from(sorted(place)) if isinstance(place, dict) else
                        st.integers(0, len(place) - 1))  # fmt: skip
        if not isinstance(place[key], dict | list) or not place[key] or data.draw(st.booleans()):
            place[key] = data.draw(JUNK)
            break
        place = place[key]
    changed = [forged(record) if k == number else line for k, line in enumerate(lines)]
    try:
        _, results = opened(study, changed, tmp_path)
    except CompassError:
        assert number == 0  # another study's, or another version's
        return
    assert set(results.identity.values) <= set(candidate_keys(study))
    assert results.sizes["candidate"] <= rows.size + 1


def candidate_keys(study):
    from compass.study.candidates import identities

    return identities(candidates(study).rows(0, 52))


@pytest.mark.parametrize("first", [b"damaged\n", b"\n", forged({"format": 2}), forged({"a": 1})])
def test_a_damaged_first_line_costs_nothing(whole, tmp_path, first):
    study, lines, rows = whole
    damage, results = opened(study, [first, *lines[1:]], tmp_path)
    assert len(damage) == 1 and damage[0].startswith("line 1: ")
    assert results.sizes["candidate"] == rows.size
    with Store(tmp_path, study) as store:
        assert store.finished == rows.size
        store.add("screen", rows[:1], evaluate("screen", study, rows[:1]))
    with Store(tmp_path, study) as store:
        assert store.finished == rows.size and len(store.damaged) == 1


def test_without_a_first_line_nobody_elses_lines_are_taken(whole, tiny, tmp_path):
    _, lines, _ = whole
    other = tiny(fold=2)
    (tmp_path / FILE).write_bytes(b"".join([b"damaged\n", *lines[1:]]))
    before = (tmp_path / FILE).read_bytes()
    for look in (lambda: Store(tmp_path, other), lambda: read_results(other, tmp_path)):
        with pytest.raises(ArgumentError, match="no other is of this study"):
            look()
    assert (tmp_path / FILE).read_bytes() == before


def test_a_line_of_another_study_among_ours_is_left_out(whole, tiny, tmp_path):
    study, lines, rows = whole
    other = tiny(fold=2)
    stranger = forged(batch_record(other, "screen", rows[:2], evaluate("screen", other, rows[:2])))
    damage, results = opened(study, [*lines[:2], stranger], tmp_path)
    assert damage == ["line 3: of another study, or of another version"]
    assert results.sizes["candidate"] == 5


@pytest.mark.parametrize("line", [b"", b"x", b"00000000 {}\n", b"0 \n"])
def test_a_spoilt_line_has_no_object(line):
    with pytest.raises(DamagedError, match="torn or spoilt"):
        from_line(line)


def test_the_order_of_columns_is_that_of_a_row(whole):
    assert list(from_line(whole[1][1])["candidates"]) == list(ROW.names)
    assert np.dtype(ROW).itemsize == 31
