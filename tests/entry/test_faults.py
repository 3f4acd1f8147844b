"""Faults: laid over epochs and beacons, and refused where they are none."""

import numpy as np
import pytest

from compass.entry.faults import Fault, fault_tables
from compass.errors import ArgumentError

TIMES = np.arange(11.0)
NAMES = ("a", "b")


def test_faults_are_laid_over_epochs_and_beacons():
    tables = fault_tables(
        [
            Fault("outage", "a", 3, 5),
            Fault("bias", "b", 2, 4, 100.0),
            Fault("spike", "b", 3.2, size=7.0),
            Fault("subsystem-dead", "a", 9),
            Fault("all-ranges-lost", start=10),
        ],
        TIMES,
        NAMES,
    )
    assert np.flatnonzero(tables.lost[:, 0]).tolist() == [3, 4, 5, 10]
    assert np.flatnonzero(tables.lost[:, 1]).tolist() == [10]
    assert tables.offset[:, 1].tolist() == [0, 0, 100, 107, 100, 0, 0, 0, 0, 0, 0]
    assert np.flatnonzero(~tables.alive[:, 0]).tolist() == [9, 10]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Fault("fire"), "kind = 'fire'"),
        (lambda: Fault("outage", "a", 5, 3), "before the start"),
        (lambda: Fault("bias", "a", 5, 6), "needs a size"),
        (lambda: Fault("bias", "a", size=np.nan), "finite"),
        (lambda: fault_tables([Fault("outage", "c")], TIMES, NAMES), "beacon = 'c': allowed a, b"),
        (lambda: fault_tables([Fault("outage", "a", 99)], TIMES, NAMES), "choose times inside"),
        (lambda: fault_tables([Fault("spike", "a", 99, size=1)], TIMES, NAMES), "times inside"),
    ],
)
def test_bad_faults_are_refused(make, message):
    with pytest.raises(ArgumentError, match=message):
        make()
