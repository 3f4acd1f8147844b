"""Boxes at a moment: they tile the surface, and what they say of a place is so."""

import numpy as np
import pytest

from compass.coverage.certified_boxes import BoxKind, boxes_at
from compass.coverage.certified_places import Circle
from compass.coverage.region import latitude_band
from compass.errors import ArgumentError
from compass.orbits import positions_mci, walker_delta
from compass.pictures.boxes import draw_boxes

PATTERN = walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
BAND = latitude_band(0.1, 0.5)


def pdop(place, radius=3396190.0):
    """By the trace of the inverse normal matrix, at the epoch."""
    sights = positions_mci(PATTERN, [0.0])[:, 0] - radius * place
    sights = sights[sights @ place >= 0]
    rows = np.column_stack(
        [sights / np.linalg.norm(sights, axis=1, keepdims=True), np.ones(len(sights))]
    )
    return np.sqrt(np.trace(np.linalg.inv(rows.T @ rows)[:3, :3]))


@pytest.mark.parametrize("smallest", [0.4, pytest.param(0.05, marks=pytest.mark.slow)])
def test_boxes_tile_the_band_and_are_right(smallest):
    made = boxes_at(PATTERN, 2.6, smallest=smallest, place=BAND)
    b, _, hb, hl = made.boxes.T
    area = (2 * hl * (np.sin(b + hb) - np.sin(b - hb))).sum()
    assert area == pytest.approx(2 * np.pi * (np.sin(0.5) - np.sin(0.1)))
    assert 0.0 <= made.low <= made.high <= 1.0
    generator = np.random.default_rng(1)
    for box, kind in zip(made.boxes, made.kinds, strict=True):
        if kind in (BoxKind.KEPT, BoxKind.BROKEN):
            lat, lon = box[:2] + box[2:] * generator.uniform(-1, 1, 2)
            place = np.array([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
            assert (pdop(place) <= 2.6) == (kind == BoxKind.KEPT)
    axes = draw_boxes(made, "boxes")
    assert "% of the area is good" in axes.get_xlabel()


def test_what_cannot_be_drawn_is_refused():
    with pytest.raises(ArgumentError, match="limit"):
        boxes_at(PATTERN, 0.5)
    with pytest.raises(ArgumentError, match="smallest"):
        boxes_at(PATTERN, 6.0, smallest=0.0)
    assert len(boxes_at(PATTERN, 2.6, smallest=0.4, place=Circle(0.3)).boxes) >= 1
