"""Maps of designs: the default epochs against a dense reference."""

import pytest

from compass.inputs.design import read_design_text
from compass.study.mapping import MapOptions, make_map

SYMMETRIC = """
name = "12/3/1"
[constellation]
pattern = "walker-delta"
satellites = 12
planes = 3
phasing = 1
inclination_deg = 50
orbit = "areosynchronous"
"""


def gdop(**options):
    made = make_map(read_design_text(SYMMETRIC), MapOptions(step_deg=10, **options))
    return made.dataset.cells_dop.sel(dop="gdop", global_percentile=95).item(), made.dataset


@pytest.mark.slow
def test_default_epochs_do_not_dwell_on_moments_of_symmetry():
    # 96 epochs meet the singular geometry of 12/3/1 so often that they find thousands
    found, dataset = gdop()
    assert dataset.time[0] == 0
    dense, _ = gdop(epochs=2003)
    assert found == pytest.approx(dense, rel=0.1)
