"""Availability and percentiles of GDOP of one constellation: one definition, everywhere."""

import numpy as np
import pytest

import compass
from compass.coverage.certified_geometry import certified_geometry
from compass.coverage.certified_share import CertifiedShare
from compass.frames import FIGURES
from compass.orbits import positions_mci
from compass.sites import Mask
from compass.study import search as search_module
from compass.study.judge_surface import judge_surface
from compass.study.search import Candidate


def samples(c, figure, mask, count, seed):
    """GDOP and PDOP at random places and moments, by inverting matrices, on any figure."""
    rng = np.random.default_rng(seed)
    a, b = figure.equatorial_radius, figure.polar_radius
    times = rng.uniform(0.0, 1e6, count)
    r = positions_mci(c, times).transpose(1, 0, 2)
    # equal areas of the sphere, kept or not by how much area of the ellipsoid they stand for
    up = rng.normal(size=(count, 3))
    up /= np.linalg.norm(up, axis=1, keepdims=True)  # outward normals
    share = (a**2 * (up[:, :2] ** 2).sum(axis=1) + b**2 * up[:, 2] ** 2) ** -2
    kept = rng.uniform(size=count) * share.max() <= share
    r, up = r[kept], up[kept]
    place = up * np.array([a, a, b]) ** 2
    place /= np.sqrt((up * place).sum(axis=1))[:, None]
    line = r - place[:, None]
    line /= np.linalg.norm(line, axis=-1, keepdims=True)
    seen = np.einsum("qni,qi->qn", line, up) >= np.sin(mask)
    rows = np.concatenate([line, np.ones((*seen.shape, 1))], axis=-1) * seen[..., None]
    enough = seen.sum(axis=1) >= 4
    dops = np.full((2, len(up)), np.inf)
    normal = np.einsum("qni,qnj->qij", rows[enough], rows[enough])
    variance = np.diagonal(np.linalg.pinv(normal, hermitian=True), axis1=1, axis2=2)
    dops[:, enough] = np.sqrt(variance.sum(axis=1)), np.sqrt(variance[:, :3].sum(axis=1))
    return dops


NOTHING = CertifiedShare(0.0, 1.0, 0, "")


@pytest.mark.slow
@pytest.mark.parametrize("figure", ["kelly2018-sphere", "iau-ellipsoid"])
def test_brackets_against_many_samples(figure):
    c = compass.walker_delta(15, 5, 1, inclination_deg=45, radius_km=20428)
    chosen, mask = FIGURES[figure], np.radians(3.0)
    found = certified_geometry(
        c, figure=chosen, mask=Mask.constant(mask), pdop_max=3.0, percents=(50, 95)
    )
    gdop, pdop = samples(c, chosen, mask, 40_000, 3)
    spread = 4 * np.sqrt(0.25 / gdop.size)
    share = (pdop <= 3.0).mean()
    assert found.availability.low - spread <= share <= found.availability.high + spread
    for percent, known in found.dops["gdop"].items():
        assert (gdop <= known.low).mean() <= percent / 100 + spread
        assert (gdop <= known.high).mean() >= percent / 100 - spread
        assert known.high - known.low <= 0.02 * known.high
    assert found.availability.width <= 4e-4


@pytest.mark.slow
def test_map_search_and_judge_say_the_same(seed_design):
    """The same constellation, mask and figure, asked for in three ways."""
    figure, c = FIGURES["iau-sphere"], seed_design.constellation
    found = search_module._examine(Candidate(c, 1.0, 0.1, 1.0), 4, 0.0, figure)
    by_search = found.as_dict()
    mapped = compass.map(
        compass.Design(name="same", constellation=c), step_deg=30, epochs=2
    ).numbers()
    judged = judge_surface(c, fold=4, figure=figure, mask=Mask())
    assert 2.0 < judged["gdop"]["p95"] < 6.0
    for name in ("availability", "availability_bracket"):
        assert mapped[name] == judged[name]
    low, high = by_search["availability_bracket"]  # of a list, not so near
    assert low < mapped["availability"] < high and high - low <= search_module.LISTED
    # more percentiles looked for at once split other boxes: the brackets are not the same ones
    brackets = np.array([of["p95_bracket"] for of in (mapped["gdop"], judged["gdop"])])
    brackets = np.vstack([brackets, by_search["gdop_p95_bracket"]])
    assert brackets[:, 0].max() < brackets[:, 1].min()
    assert np.all(brackets[:, 1] - brackets[:, 0] <= [0.02, 0.02, 0.05] * brackets[:, 1])


@pytest.mark.slow
def test_the_budget_is_of_boxes_times_satellites(monkeypatch):
    """Many satellites cost as much as few: without that a map of thousands would not end."""
    asked = []
    monkeypatch.setattr(
        "compass.coverage.certified_effort.certified_share",
        lambda c, *_, budget_boxes, **__: asked.append(budget_boxes * c.size) or NOTHING,
    )
    monkeypatch.setattr("compass.coverage.certified_geometry.BUDGET_BOXES", 600_000)
    for size in (15, 1000):
        c = compass.walker_delta(size, size, 0, inclination_deg=50, radius_km=20428)
        certified_geometry(c, figure=FIGURES["iau-sphere"], mask=Mask(), percents=())
    assert asked[0] <= asked[1] <= 40_000_000
