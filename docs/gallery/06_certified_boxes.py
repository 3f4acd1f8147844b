"""Boxes by which a share is certified, at one moment: good, bad, cut by a line, and still open."""

import compass
from compass.coverage.certified_boxes import boxes_at
from compass.pictures.boxes import draw_boxes

pattern = compass.walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)
axes = draw_boxes(boxes_at(pattern, 2.5), "PDOP at most 2.5 on 15/5/1")
