"""What is counted is marked at whole numbers, however few of them are on an axis."""

import numpy as np
import pytest
import xarray as xr

from compass.inputs.study import read_study_text
from compass.pages import trade_pictures
from compass.pictures.front import draw_front
from compass.pictures.style import new_figure, whole_numbers
from tests.pages.test_trade_page import TEXT


def marks(axis):
    """Ticks between the ends of an axis."""
    low, high = axis.get_view_interval()
    return [tick for tick in axis.get_majorticklocs() if low <= tick <= high]


@pytest.mark.parametrize("values", [[15], [14, 15], [6, 7, 9], [8, 24], [1, 200]])
def test_marks_of_counts_are_whole(values):
    axes = new_figure().add_subplot()
    axes.plot(values, values, "o")
    for axis in (axes.xaxis, axes.yaxis):
        whole_numbers(axis)
        found = marks(axis)
        assert found and all(float(tick).is_integer() for tick in found)


@pytest.mark.parametrize("most", [6, 7, 9])
def test_pictures_of_a_small_study_count_whole_satellites(monkeypatch, most):
    study = read_study_text(TEXT)
    satellites = np.repeat(np.arange(6, most + 1), 2)
    n = satellites.size
    numbers = {
        "satellites": satellites, "planes": np.tile([1, 2], n // 2), "phasing": np.zeros(n, int),
        "inclination_deg": np.linspace(30.0, 70.0, n), "radius_km": np.linspace(9e3, 2e4, n),
        "mask_deg": np.zeros(n), "gdop_p50": np.linspace(2.0, 4.0, n),
        "pattern": np.full(n, "walker-delta", object), "front": np.zeros(n, int),
    }  # fmt: skip
    results = xr.Dataset({name: ("candidate", values) for name, values in numbers.items()})
    drawn = []
    monkeypatch.setattr(trade_pictures, "picture", lambda figure, *_, **__: drawn.append(figure))
    trade_pictures.sensitivity_pictures(study, results)
    figure = new_figure()
    draw_front(figure.add_subplot(), results, "satellites", "gdop_p50")
    of_counts = [
        axis
        for one in (*drawn, figure)
        for axes in one.axes
        for axis in (axes.xaxis, axes.yaxis)
        if axis.get_label_text().replace("\n", " ")
        in ("satellites", "number of satellites", "planes", "phasing F")
    ]
    assert len(of_counts) > (2 if most == 6 else 4)
    for axis in of_counts:
        assert all(float(tick).is_integer() for tick in marks(axis))
