"""The finalists of a study, from results made by hand."""

from dataclasses import replace

import numpy as np
import xarray as xr

from compass.inputs.study import Objective
from compass.quantities.merits import MERITS
from compass.study.candidates import ROW
from compass.study.choice import finalists_of


def results_of(satellites, margins, fronts):
    """Results of candidates of which little more than two objectives is known."""
    columns = {name: np.zeros(len(satellites)) for name in (*ROW.names, *MERITS)}
    columns |= {"satellites": np.array(satellites), "mask_margin_deg": np.array(margins)}
    columns["planes"] = np.ones(len(satellites))
    columns |= {"pattern": np.full(len(satellites), "walker-delta"), "front": np.array(fronts)}
    columns["identity"] = np.array([f"{k}" for k in range(len(satellites))])
    return xr.Dataset({name: ("candidate", values) for name, values in columns.items()})


def test_of_equals_the_next_largest_shortfall_decides(tiny):
    """All of one size fall short alike in size; the front's are 5 to 25 satellites, 0 to 10 deg."""
    study = tiny(entry=True)  # compared with 15 satellites
    results = results_of([5, 15, 15, 15, 25], [0.0, 6.0, 8.0, 7.0, 10.0], [0, 2, 0, 1, 0])
    chosen = {role: f for f in finalists_of(study, results) for role in f.role.split("; ")}
    for role in ("balanced", "best of 15 satellites"):
        assert chosen[role].figures["mask_margin_deg"] == 8.0


def test_an_objective_that_is_infinite_for_all_does_not_decide(tiny):
    study = tiny()
    study = replace(study, objectives=(*study.objectives, Objective("gdop_p95", 1)))
    results = results_of([5, 7, 9], [0.0, 8.0, 10.0], [0, 0, 0])
    results["gdop_p95"][:] = np.inf
    assert finalists_of(study, results)[0].figures["satellites"] == 7
