"""Mars Global Surveyor's overlaps: what a covariance claims, and where that falls short."""

import pytest

from compass.papers.lemoine1999 import MONTHS, overlaps, rows
from compass.papers.verdict import Verdict


@pytest.mark.slow
def test_overlaps_have_the_order_published_where_drag_and_fields_do_not_rule():
    found = {row.item: row for row in rows()}
    differs = {item for item, row in found.items() if row.verdict == Verdict.DIFFERS}
    # a tenth of the cross-track and along-track of February is all that tracking alone leaves
    assert differs == {
        f"February 1999, {name}: overlap of arcs of 1.25 days, rms"
        for name in ("cross-track", "along-track")
    }
    assert all("neither drag" in row.note for item, row in found.items() if "overlap" in item)
    radial, cross, along = overlaps(MONTHS[1])[0]
    for value, printed in zip((radial, cross, along), MONTHS[1].printed, strict=True):
        assert 1.0 < float(printed) / value < 5.0
