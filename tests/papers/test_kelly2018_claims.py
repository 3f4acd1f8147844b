"""What the paper's words claim: each row can fail, and the geometry has a second way."""

import numpy as np
import pytest

from compass.coverage.certificate import fold_range
from compass.papers import kelly2018_claims as paper
from compass.papers.kelly2018 import constellation


def test_rows(every_row_can_fail):
    rows = paper.rows()
    every_row_can_fail(rows)
    verdicts = {row.item.split(" ")[0]: str(row.verdict) for row in rows}
    assert verdicts["Satellites"] == "reproduced"  # hidden from Earth, the later row of the two
    assert [str(row.verdict) for row in paper.plane_rows()] == ["erratum", "reproduced", "erratum"]
    assert all(row.holds for row in rows)


def test_a_shorter_reach_changes_the_verdicts(monkeypatch):
    """Caps of half a sphere leave a plane without gaps; smaller ones than 60 deg lose the relay."""
    right = paper.cap
    monkeypatch.setattr(paper, "cap", lambda orbit, sphere=paper.SPHERE: right(orbit, sphere) - 0.4)
    fewest = paper.low_orbit_rows()[0]
    assert fewest.verdict == "differs"
    monkeypatch.setattr(paper, "JPL_INCLINATIONS_DEG", (90.0,) * 6)
    mean, latitudes, _ = paper.comparison_rows()
    assert mean.verdict == "reproduced"
    assert latitudes.verdict == "erratum"  # polar orbits favour the poles
    monkeypatch.setattr(paper, "NANN_SATELLITES", 9)
    assert paper.comparison_rows()[2].verdict == "differs"
    monkeypatch.setattr(paper, "misses", lambda a, b, radius: np.zeros((15, 15), dtype=bool))
    assert paper.relay_rows()[0].verdict == "differs"


@pytest.mark.slow
def test_the_ground_sees_what_the_exact_fold_says():
    fewest = paper.low_orbit_rows()[0].found[0]
    (exact, _), _ = fold_range(constellation(), sphere_radius=paper.SPHERE)
    assert fewest == exact == 4


@pytest.mark.parametrize("latitude_deg", [0.0, 35.0, 62.0, 89.0])
def test_mean_in_view_by_sampling(latitude_deg):
    """A satellite at random phases and nodes, a place at longitude zero."""
    orbit, inclination = paper.SPHERE + 800e3, np.radians(111.0)
    random = np.random.default_rng(1)
    u, node = random.uniform(0, 2 * np.pi, (2, 200_000))
    x = np.cos(u) * np.cos(node) - np.sin(u) * np.cos(inclination) * np.sin(node)
    z = np.sin(u) * np.sin(inclination)
    f = np.radians(latitude_deg)
    seen = (x * np.cos(f) + z * np.sin(f) >= np.cos(paper.cap(orbit))).mean()
    mean = paper.mean_in_view(f, orbit, np.array([inclination]))
    assert mean == pytest.approx(seen, abs=5 * np.sqrt(0.25 / 200_000))


def test_mean_over_latitudes_is_the_cap_s_share():
    orbit = paper.SPHERE + 800e3
    sines = (np.arange(200) + 0.5) / 100 - 1
    inclinations = np.radians(paper.JPL_INCLINATIONS_DEG)
    means = [paper.mean_in_view(float(np.arcsin(s)), orbit, inclinations) for s in sines]
    assert np.mean(means) == pytest.approx(6 * (1 - paper.SPHERE / orbit) / 2, rel=2e-3)


def test_hops_of_networks_known():
    ring = np.eye(6, dtype=bool)
    for k in range(6):
        ring[k, (k + 1) % 6] = ring[(k + 1) % 6, k] = True
    assert paper.hops(ring) == 3
    assert paper.hops(np.ones((4, 4), dtype=bool)) == 1
    assert paper.hops(np.eye(3, dtype=bool)) == float("inf")
