"""A digest is of all of a value: whatever is changed in it, the digest is another."""

import subprocess
import sys
from copy import copy
from dataclasses import dataclass, fields
from enum import Enum
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compass.digest import PROVENANCE, digest_of
from compass.inputs import read_design
from compass.inputs.scenario import read_scenario
from compass.inputs.study import read_study


@dataclass(frozen=True)
class Thing:
    part: object
    label: str = "here"


class Kind(Enum):
    ONE = 1
    TWO = 2


LEAVES = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(allow_nan=False), st.text(), st.binary(),
    st.sampled_from(Kind), st.fractions(),
)  # fmt: skip
VALUES = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3), st.tuples(inner, inner), st.builds(Thing, inner),
        st.dictionaries(st.text(max_size=3), inner, max_size=3),
    ),
    max_leaves=8,
)  # fmt: skip


def alike(a, b):
    """Whether two values are the same and of the same kinds, and zeros of the same sign."""
    return type(a) is type(b) and repr(a) == repr(b)


@given(VALUES, VALUES)
def test_digests_are_equal_where_values_are(a, b):
    assert (digest_of(a) == digest_of(b)) == alike(a, b)


@pytest.mark.parametrize(
    "values",
    [
        [1, 1.0, True, "1", b"1", [1], (1,), {1}, {1: 1}, Fraction(1), np.float64(1), np.ones(1)],
        [["ab", "c"], ["a", "bc"], ["abc", ""], ["abc"], [["ab"], "c"]],
        [np.zeros(4), np.zeros((2, 2)), np.zeros(4, "f4"), np.zeros(8, "f4"), np.zeros(4, int)],
        [0.0, -0.0, 5e-324, float("nan"), float("inf")],
        [{"a": 1, "b": 2}, {"a": 2, "b": 1}, [("a", 1), ("b", 2)]],
        [Path("a"), "a"],
    ],
)
def test_what_looks_alike_is_not(values):
    assert len({digest_of(value) for value in values}) == len(values)


def test_order_and_memory_do_not_matter_where_content_is_the_same():
    assert digest_of({"a": 1, "b": 2}) == digest_of({"b": 2, "a": 1})
    assert digest_of({3, 1, 2}) == digest_of({2, 3, 1})
    square = np.arange(4.0).reshape(2, 2)
    assert digest_of(square) == digest_of(np.asfortranarray(square))
    read_only = square.copy()
    read_only.setflags(write=False)
    assert digest_of(read_only) == digest_of(square)


def test_what_has_no_content_is_no_key():
    for value in (lambda: 1, object(), np.array([object()]), Thing(print), Thing):
        with pytest.raises(TypeError, match="no content that could be told"):
            digest_of(value)


def test_where_a_thing_was_read_is_left_out():
    assert digest_of(Thing(1, "here")) == digest_of(Thing(1, "there"))


@pytest.mark.parametrize(
    ("read", "name"),
    [(read_design, "compass-15-5-1"), (read_scenario, "landing"), (read_study, "study-fourfold")],
)
def test_every_field_of_a_file_counts(designs, read, name):
    thing = read(designs / f"{name}.toml")
    base = digest_of(thing)
    assert base == digest_of(read(designs / ".." / "designs" / f"{name}.toml"))
    for field in fields(thing):
        value = "iau-ellipsoid" if field.name == "figure" else ("another",)
        other = copy(thing)
        object.__setattr__(other, field.name, value)  # past what the field may hold
        changed = digest_of(other)
        assert (changed == base) == (field.name in PROVENANCE), field.name


def test_another_process_comes_to_the_same(designs):
    path = str(designs / "landing.toml")
    script = (
        "from compass.digest import digest_of; from compass.inputs.scenario import read_scenario\n"
        f"print(digest_of(read_scenario({path!r})), end='')"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.stdout == digest_of(read_scenario(path))
