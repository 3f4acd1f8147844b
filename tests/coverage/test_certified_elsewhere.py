"""Certified figures against those that another program prints.

kshana 0.39.0 (PyPI), kind ``constellation-design``, body ``mars``, on cells of 1 degree at 199 epochs
of a sidereal day, PDOP at most 6; its percentiles are of fixes alone, so that of designs with a fix
everywhere and always both say the same, and are multiples of 0.005.
"""

import numpy as np
import pytest

from compass.coverage.certified_percentile import certified_percentiles
from compass.coverage.certified_share import certified_share
from compass.orbits import walker_delta

#: Walker's t/p/f, inclination and radius, mask; per cent of area and time, GDOP at 50, 90 and 95.
PRINTED = [
    ((13, 13, 2), 50.0, 20427.0, 0.0, 88.3581, (2.35, 7.565, 15.775)),
    ((21, 7, 3), 65.0, 12000.0, 5.0, 98.9051, (2.24, 3.84, 4.41)),
]
STEP = 0.005


@pytest.mark.slow
@pytest.mark.parametrize(("pattern", "inclination", "radius", "mask", "share", "gdop"), PRINTED)
def test_another_programs_fine_map_lies_between_the_bounds(
    pattern, inclination, radius, mask, share, gdop
):
    c = walker_delta(*pattern, inclination_deg=inclination, radius_km=radius)
    asked = {"mask": np.radians(mask), "budget_boxes": 1e6}
    found = certified_share(c, 6.0, width=1e-4, **asked)
    assert 100.0 * found.low < share < 100.0 * found.high and found.width <= 1e-4
    of = certified_percentiles(c, (50, 90, 95), precision=5e-3, dop="gdop", **asked).of
    for percent, printed in zip((50, 90, 95), gdop, strict=True):
        assert of[percent].low - STEP < printed < of[percent].high + STEP
        assert of[percent].high < 1.006 * of[percent].low
