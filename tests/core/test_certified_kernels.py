"""Every bound of a box against exact values at random points of it, and volumes of cut boxes."""

import numpy as np
import pytest

from compass.core.certified.cuts import (
    BROKEN,
    CUT,
    EXPANSION,
    KEPT,
    MOVING,
    SCRATCH,
    cuts,
    projector,
)
from compass.core.certified.groups import Problem, make_room
from compass.core.certified.shares import (
    BOX,
    GIVEN,
    look,
    measure,
    of_measure,
    region_parts,
    still_open,
)
from compass.core.certified.sights import (
    BEAM,
    FALL,
    FIRST,
    HIGH,
    LAST,
    LOW,
    NUMBERS,
    RISE,
    SECOND,
    USER,
    WIDTH,
    mask_range,
    place,
    sights,
    states,
)
from compass.core.certified.volumes import volume
from compass.coverage.certified_domain import domain_of
from compass.coverage.certified_ranges import Ranges
from compass.frames import FIGURES
from compass.orbits import walker_delta
from compass.orbits.constellation import keplerian

MANY = 400
FEW = 12

#: Variance, m^2, in which weights are counted here.
SCALE = 9.0


def random_ranges(generator, n):
    """Correlated errors of places and clocks, noise, loop and ionosphere; some with a part only."""
    half = generator.normal(size=(n, 4, 4)) * [2.0, 8.0, 5.0, 3.0]
    covariance = np.swapaxes(half, 1, 2) @ half + np.diag([1.0, 1.0, 1.0, 9.0])
    zenith, a, b, delay = generator.uniform(0, 2, 4) * generator.integers(0, 2, 4)
    numbers = (generator.uniform(0, 1), zenith, a, 0.1 * b, delay, 0.917)
    return Ranges(covariance, numbers, 3.4e6)


def random_orbits(generator):
    if generator.random() < 0.5:
        return walker_delta(8, 4, 1, inclination_deg=60, radius_km=generator.uniform(7e3, 2e4))
    return keplerian(
        generator.uniform(9e6, 2e7, 8),
        generator.uniform(0, 0.3, 8),
        generator.uniform(0.2, 2, 8),
        *(generator.uniform(0, 6, 8) for _ in range(3)),
    )


class Case:
    """A random box over a random constellation, with its bounds."""

    def __init__(self, seed, level=False, weighed=False, sides=None):
        self.generator = g = np.random.default_rng(seed)
        figure = FIGURES["iau-ellipsoid" if seed % 2 else "iau-sphere"]
        self.domain = domain_of(random_orbits(g), figure, duration=1e5)
        self.e2 = self.domain.flattening
        size = 10 ** g.uniform(-3.5, -0.8)
        self.box = np.zeros(BOX)
        self.box[:3] = g.uniform(-1.5, 1.5), g.uniform(0, 6), g.uniform(0, 6)
        self.box[3:6] = size * g.uniform(0.1, 1, 3)
        # a box does not reach over a pole
        self.box[0] = np.clip(self.box[0], self.box[3] - np.pi / 2, np.pi / 2 - self.box[3])
        self.mask = g.uniform(0, 0.3)
        if sides is not None:  # one side alone, and long, over a sphere without a mask
            self.mask, self.box[3:6] = 0.0, [0.3 * (side in sides) for side in range(3)]
        self.user = np.zeros(USER)
        place(self.box, self.e2, 0.0, self.user)
        n = len(self.domain.orbits)
        self.numbers = np.zeros(NUMBERS)
        self.numbers[BEAM] = -1.0
        self.ranges = random_ranges(g, n) if weighed else None
        self.orbits = self.domain.orbits
        if weighed:
            columns = self.ranges.columns(self.orbits, SCALE)
            self.orbits = np.hstack([self.orbits, columns])
            self.numbers = np.append(self.numbers, self.ranges.shared_row(SCALE))
        self.rows, self.kinds = np.zeros((n + 1, WIDTH)), np.zeros(n + 1, dtype=np.int64)
        q, dq = self.motion(self.box[2])
        self.count = sights(
            self.box, self.user, self.orbits, q, dq, self.numbers, level,
            np.array([[0.0], [self.mask]]), self.rows, self.kinds,
        )  # fmt: skip

    def motion(self, t):
        n = len(self.domain.orbits)
        q, dq = np.zeros((n, 3)), np.zeros((n, 3))
        d = self.domain
        states(d.orbits, d.circles, d.breaks, d.paths, t, q, dq)
        return q, dq

    def at(self, u):
        """Up, unit lines of sight and height over the mask, exactly, at a point of the box."""
        b, longitude, t = self.box[:3] + self.box[3:6] * u
        up = np.array([np.cos(b) * np.cos(longitude), np.cos(b) * np.sin(longitude), np.sin(b)])
        normal = 1 / np.sqrt(1 - self.e2 * np.sin(b) ** 2)
        user = normal * up * [1, 1, 1 - self.e2]
        sight = self.motion(t)[0] - user
        far = np.linalg.norm(sight, axis=1)
        e = sight / far[:, np.newaxis]
        return up, e, sight @ up - np.sin(self.mask) * far

    def weights(self, u):
        """One over the sigma of every range, exactly, from the orbits' elements."""
        if self.ranges is None:
            return np.ones(len(self.orbits))
        up, e, _ = self.at(u)
        b, _, t = self.box[:3] + self.box[3:6] * u
        q, _ = self.motion(t)
        normal = 1 / np.sqrt(1 - self.e2 * np.sin(b) ** 2)
        d2 = ((q - normal * up * [1, 1, 1 - self.e2]) ** 2).sum(axis=1)
        node = self.orbits[:, 4] + self.orbits[:, 7] * t
        cross = np.stack([self.orbits[:, 3] * np.sin(node), -self.orbits[:, 3] * np.cos(node),
                          self.orbits[:, 2]], axis=1)  # fmt: skip
        radial = q / np.linalg.norm(q, axis=1, keepdims=True)
        along = np.cross(cross, radial)
        x = np.stack([(e * radial).sum(1), (e * along).sum(1), (e * cross).sum(1), np.ones(len(e))])
        noise, zenith, a, b, delay2, shell2 = self.ranges.numbers
        sine = e @ up
        square = np.einsum("in,nij,jn->n", x, self.ranges.covariance, x)
        square += a * d2 + b * d2**2 + delay2 / (1 - shell2 * (1 - sine**2))
        if not zenith:
            return np.sqrt(SCALE / (square + noise**2))
        # as far as the horizon the same, below it what goes on from there
        return np.sqrt(SCALE) * sine / np.sqrt(square * sine**2 + (noise * sine + zenith) ** 2)

    def names(self):
        """Which satellite each row is."""
        _, e, _ = self.at(np.zeros(3))
        away = self.rows[: self.count, np.newaxis, :3]
        away = away / np.linalg.norm(away, axis=2, keepdims=True)
        near = np.minimum(np.linalg.norm(away - e, axis=2), np.linalg.norm(away + e, axis=2))
        return near.argmin(axis=1)


def test_speeds_are_those_of_the_positions():
    for seed in range(FEW):
        case = Case(seed)
        t, step = case.generator.uniform(0, 6), 1e-5
        _, dq = case.motion(t)
        slope = (case.motion(t + step)[0] - case.motion(t - step)[0]) / (2 * step)
        assert np.allclose(dq, slope, atol=1e-8)
        bend = (
            case.motion(t + step)[0] - 2 * case.motion(t)[0] + case.motion(t - step)[0]
        ) / step**2
        assert np.all(np.linalg.norm(dq, axis=1) <= case.domain.orbits[:, 10])
        assert np.all(np.linalg.norm(bend, axis=1) <= case.domain.orbits[:, 11] + 1e-4)


@pytest.mark.parametrize("seeds", [FEW, pytest.param(MANY, marks=pytest.mark.slow)])
def test_lines_of_sight_stay_within_their_bounds(seeds):
    seen = 0
    for seed in range(seeds):
        case = Case(seed)
        if case.count < 0:
            continue
        names = case.names()
        others = np.setdiff1d(np.arange(len(case.domain.orbits)), names)
        for u in case.generator.uniform(-1, 1, (6, 3)):
            _, e, height = case.at(u)
            assert np.all(height[others] < 0)
            for row, kind, k in zip(case.rows, case.kinds, names, strict=False):
                off = e[k] - row[:3] - u @ row[3:12].reshape(3, 3)
                assert np.linalg.norm(off) <= 0.5 * row[SECOND] + 1e-14
                assert np.linalg.norm(e[k] - row[:3]) <= row[FIRST] + 1e-14
                for side in (HIGH, LOW):
                    line = row[side] + u @ row[side + 1 : side + 4]
                    assert -row[FALL] <= height[k] - line <= row[RISE]
                assert kind == 2 or height[k] >= 0
                seen += 1
    assert seen > 10 * seeds


@pytest.mark.parametrize("side", range(2))
def test_along_one_side_sight_leaves_its_tangent_as_its_slopes_there_say(side):
    """Then the quadratic form is what it is, and what comes after it alone is bounded."""
    seen = 0
    for seed in range(0, 2 * FEW, 2):
        case = Case(seed, sides=(side,))
        for u in (-1.0, -0.7, 0.7, 1.0):
            height = case.at(u * np.ones(3))[2]
            for row, k in zip(case.rows[: case.count], case.names(), strict=False):
                line = row[HIGH] + u * row[HIGH + 1 + side]
                assert -row[FALL] <= height[k] - line <= row[RISE]
                seen += 1
    assert seen > 10 * FEW


@pytest.mark.parametrize("seeds", [FEW, pytest.param(MANY, marks=pytest.mark.slow)])
def test_weighed_rows_stay_within_their_bounds(seeds):
    seen = 0
    for seed in range(seeds):
        case = Case(seed, weighed=True)
        if case.count < 0:
            continue
        names = case.names()
        for u in case.generator.uniform(-1, 1, (6, 3)):
            _, e, _ = case.at(u)
            weights = case.weights(u)
            for row, k in zip(case.rows, names, strict=False):
                away = weights[k] * np.append(e[k], 1.0)
                middle = np.append(row[:3], row[LAST])
                slopes = np.hstack([row[3:12].reshape(3, 3), row[LAST + 1 : LAST + 4, np.newaxis]])
                assert np.linalg.norm(away - middle - u @ slopes) <= 0.5 * row[SECOND] + 1e-13
                assert np.linalg.norm(away - middle) <= row[FIRST] + 1e-13
                seen += 1
    assert seen > 10 * seeds


def dilution(e, up, dop, weights):
    rows = np.column_stack([e, np.ones(len(e))]) * weights[:, np.newaxis]
    inverse = np.linalg.inv(rows.T @ rows)
    vertical = up @ inverse[:3, :3] @ up
    position = np.trace(inverse[:3, :3])
    return [position + inverse[3, 3], position, position - vertical, vertical, inverse[3, 3]][dop]


@pytest.mark.parametrize("seeds", [FEW, pytest.param(MANY, marks=pytest.mark.slow)])
@pytest.mark.parametrize("weighed", [False, True])
@pytest.mark.parametrize("dop", range(5))
def test_what_is_cut_off_keeps_and_breaks_the_limit(dop, weighed, seeds):
    decided = 0
    scratch, cut = np.zeros(SCRATCH), np.zeros(CUT + EXPANSION)
    for seed in range(seeds):
        case = Case(seed, dop in (2, 3), weighed)
        if case.count < 5:
            continue
        names = case.names()
        projector(dop, case.user, scratch)
        scratch[MOVING] = float(weighed)
        up, e, _ = case.at(np.zeros(3))
        square = dilution(
            e[names], up, dop, case.weights(np.zeros(3))[names]
        ) * case.generator.uniform(0.8, 1.2)
        cuts(case.rows, case.kinds, case.count, False, True, square, scratch, cut)
        for u in case.generator.uniform(-1, 1, (8, 3)):
            up, e, _ = case.at(u)
            here = dilution(e[names], up, dop, case.weights(u)[names])
            if u @ cut[KEPT + 1 : KEPT + 4] >= cut[KEPT]:
                assert here <= square
                decided += 1
            if u @ cut[BROKEN + 1 : BROKEN + 4] >= cut[BROKEN]:
                assert here > square
                decided += 1
    assert decided > seeds / 10


def test_volumes_of_cut_cubes_are_those_of_columns():
    generator = np.random.default_rng(1)
    edge = (np.arange(400) + 0.5) / 200 - 1
    x, y = np.meshgrid(edge, edge)
    for k in range(60):
        a, b, c = 10 ** generator.uniform(-5, 0, 3) * generator.choice([-1, 1], 3)
        if k % 5 == 0:
            b = 0.0
        if k % 7 == 0:
            c = 0.0
        t = generator.uniform(-1.1, 1.1) * (abs(a) + abs(b) + abs(c))
        first, *rest = sorted((a, b, c), key=abs, reverse=True)
        # along the largest coefficient a column is cut once
        share = np.clip(0.5 + 0.5 * (rest[0] * x + rest[1] * y - t) / abs(first), 0, 1).mean()
        found = volume(t, a, b, c)
        assert share - 3e-3 <= found <= share + 1e-5
    assert volume(-0.1, 0.0, 0.0, 0.0) == 1.0
    assert volume(np.inf, 1.0, 1.0, 1.0) == 0.0
    assert volume(0.1, 0.0, 0.0, 0.0) == 0.0


@pytest.mark.parametrize("e2", [0.0, 0.0117])
def test_a_share_of_volume_holds_no_less_than_its_measure(e2):
    generator = np.random.default_rng(2)
    for _ in range(40):
        b, h = generator.uniform(-1.2, 1.2), generator.uniform(0.01, 0.3)
        m, size, thin, dense = measure(np.array([b, 0, 0, h, 0.5, 0.25, 0, 0, 0, 0.0]), e2)
        edges = np.linspace(b - h, b + h, 20001)
        middle = 0.5 * (edges[1:] + edges[:-1])
        density = (1 - e2) * np.cos(middle) / (1 - e2 * np.sin(middle) ** 2) ** 2
        assert m == pytest.approx(density.mean() * size, rel=1e-7)
        assert thin <= density.min() and density.max() <= dense
        share = generator.random()
        part = np.sort(density)[: int(share * density.size)].sum() / density.size * size
        assert of_measure(share, m, size, thin, dense) <= part + 1e-4 * size
    assert of_measure(1.0, 3.0, 4.0, 0.1, 1.0) == 3.0


def test_profiles_are_bounded_over_an_interval_of_azimuth():
    azimuths, elevations = np.array([0.5, 2.0, 4.0]), np.array([0.1, 0.4, 0.0])
    generator = np.random.default_rng(3)
    for _ in range(60):
        middle, half = generator.uniform(0, 2 * np.pi), generator.uniform(0, 2)
        low, high = mask_range(azimuths, elevations, middle, half)
        around = np.interp(
            middle + half * np.linspace(-1, 1, 2001), azimuths, elevations, period=2 * np.pi
        )
        assert low <= around.min() <= low + 1e-3
        assert high - 1e-3 <= around.max() <= high
    assert mask_range(azimuths, elevations, 1.0, 4.0) == (0.0, 0.4)


def test_parts_of_a_box_beyond_an_edge():
    generator = np.random.default_rng(4)
    for seed in range(30):
        case = Case(seed)
        normal = np.cross(case.user[3:6], generator.normal(size=3))
        normal = (normal / np.linalg.norm(normal) + 0.05 * generator.normal(size=3)).reshape(1, 3)
        inside, outside = region_parts(case.user, normal)
        u = generator.uniform(-1, 1, (3000, 3))
        b, longitude = (case.box[:2] + case.box[3:5] * u[:, :2]).T
        place_ = np.stack(
            [np.cos(b) * np.cos(longitude), np.cos(b) * np.sin(longitude),
             (1 - case.e2) * np.sin(b)], axis=1,
        )  # fmt: skip
        share = (place_ @ normal[0] >= 0).mean()
        assert inside <= share + 0.04 and outside <= 1 - share + 0.04


def test_a_satellite_overhead_and_near_leaves_its_box_open():
    orbits = walker_delta(5, 5, 1, inclination_deg=60, radius_km=3500)
    domain = domain_of(orbits, FIGURES["iau-sphere"])
    box = np.zeros(BOX)
    box[3:6] = 0.2
    problem = Problem(
        domain.orbits, domain.circles, domain.breaks, domain.paths, np.empty((0, 3)),
        np.array([0.0, 0.0, 0.0, 1.0, -1.0]), np.zeros((2, 1)),
    )  # fmt: skip
    look(box, np.array([36.0]), make_room(len(domain.orbits)), problem)
    assert not box[GIVEN:].any() and still_open(box, 0) > 0.0
