"""Coverage pictures of designs that see next to nothing."""

import warnings

import pytest

from compass.inputs import read_design_text
from compass.pages.coverage import fold_pictures
from compass.study.mapping import MapOptions, make_map

NOTHING = """
name = "One satellite, seen from straight below alone"
[constellation]
pattern = "walker-delta"
satellites = 1
planes = 1
phasing = 0
inclination_deg = 0
orbit = "areosynchronous"
[coverage]
mask_deg = 89.9
"""


@pytest.mark.slow
def test_a_map_that_sees_nothing_is_drawn_without_a_word():
    made = make_map(read_design_text(NOTHING), MapOptions(step_deg=15, epochs=2))
    assert made.dataset.count_max.max() == 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert all(picture.drawn for picture in fold_pictures(made.dataset))
