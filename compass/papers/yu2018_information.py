"""Yu et al. 2018, sections 3 and 4: what ranges and range rates tell, by random geometries.

Equations are tried on directions drawn from a seed, against derivatives by complex steps and
eigenvalues by LAPACK: a counter-example is a demonstration, agreement everywhere is not a proof.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from compass.entry.fisher import (
    best_determinant,
    best_directions,
    best_rate_determinant,
    position_variance_bound,
    range_information,
    rate_information,
    two_beacon_eigenvalues,
)
from compass.papers.verdict import Erratum, Row, claim, compare, computed

Array = NDArray[np.float64]

#: Largest determinants, in sigma^-6, of so many beacons.
TABLE_1 = {3: "1.000", 4: "2.3704", 5: "4.6296", 6: "8.0000", 7: "12.7037", 8: "18.9630"}
TRIALS, SEED = 500, 2018
ROUNDING = 1e-9


def information_rows() -> list[Row]:
    """Table 1, Figure 1 and equations 28 to 47."""
    return [*_table_1(), *_eigenvector_rows(), *_bound_rows(), *_rate_rows(), *_chain_rows()]


def directions(count: int, trial: int) -> Array:
    """Unit vectors drawn evenly over the sphere, shape (count, 3)."""
    n = np.random.default_rng((SEED, count, trial)).normal(size=(count, 3))
    return n / np.linalg.norm(n, axis=1, keepdims=True)


def worst(check: Callable[[int], float]) -> float:
    """Largest value of a check over all trials; nan if any is."""
    return float(np.max([check(trial) for trial in range(TRIALS)]))


def _table_1() -> list[Row]:
    four = range_information(best_directions(4), 2.0)
    printed = (4 / (3 * 2.0**-2)) ** 3
    return [
        *(
            compare(
                f"Maximum determinant of {n} beacons, in sigma^-6",
                "Table 1",
                text,
                float(np.linalg.det(range_information(best_directions(n), 1.0))),
            )
            for n, text in TABLE_1.items()
        ),
        claim(
            "Maximum determinant of 4 beacons of sigma 2 m: eq. 40 as printed; by eigenvalues; "
            "of four directions on a cone",
            "eq. 40",
            "(N / (3 sigma^-2))^3, found by a genetic algorithm",
            (printed, best_determinant(np.full(4, 2.0)), np.linalg.det(four)),
            "m^-6",
            "all three equal",
            lambda eq_40, best, cone: _equal(eq_40, best) and _equal(best, cone),
            shown="{:.4g}; {:.4g}; {:.4g}",
            erratum=Erratum(
                "the exponent is misprinted: (N sigma^-2 / 3)^3, in closed form for every N >= 3",
                shown=lambda eq_40, best, cone: _equal(best, cone) and eq_40 > 2 * best,
            ),
        ),
    ]


def _equal(a: float, b: float) -> bool:
    return abs(a - b) <= ROUNDING * abs(b)


def _eigenvector_rows() -> list[Row]:
    def one(trial: int) -> float:
        n = directions(1, trial)
        w = n[0] / n[0, 2]
        return float(np.abs(range_information(n, 2.0) @ w - w / 4).max() / np.abs(w).max())

    def two(trial: int) -> float:
        n = directions(2, trial)
        cross = np.cross(n[0], n[1])
        w = cross / cross[2]
        return float(np.abs(range_information(n, 2.0) @ w).max() / np.abs(w).max())

    n = np.array([[1.0, 0.0, 0.0], [0.5, np.sqrt(0.75), 0.0]])
    values = np.linalg.eigvalsh(range_information(n, 1.0))[::-1]
    closed = two_beacon_eigenvalues(1.0, 1.0, np.radians(60.0))
    return [
        claim(
            "w3 = n/n_z of one beacon is the eigenvector to sigma^-2: largest residual",
            "eq. 31",
            "the observable combination",
            worst(one),
            "1",
            "rounding; n itself is meant, the quotient has no value for a level one",
            lambda residual: residual < ROUNDING,
        ),
        claim(
            "w3 = n1 x n2 / (n1x n2y - n1y n2x) of two beacons is not observable: largest residual",
            "eq. 34",
            "the eigenvector to eigenvalue 0",
            worst(two),
            "1",
            "rounding; n1 x n2 itself is meant, the quotient has no value for an upright plane",
            lambda residual: residual < ROUNDING,
        ),
        claim(
            "Larger over smaller eigenvalue of two equal beacons 60 deg apart: by LAPACK, closed "
            "form",
            "section 4.3",
            "lambda1 = lambda2",
            (values[0] / values[1], closed[0] / closed[1]),
            "1",
            "1",
            lambda ratio, _: abs(ratio - 1) < ROUNDING,
            shown="{:.6f}, {:.6f}",
            erratum=Erratum(
                "equal only if the directions are orthogonal and the noise alike",
                shown=lambda ratio, form: _equal(ratio, form) and ratio > 1 + ROUNDING,
            ),
        ),
    ]


def _bound_rows() -> list[Row]:
    def excess(trial: int) -> float:
        f = range_information(directions(6, trial), 1.0)
        return float(3 / np.trace(f) / np.trace(np.linalg.inv(f)))

    least = float(np.trace(np.linalg.inv(range_information(best_directions(6), 1.0))))
    bounds = [position_variance_bound(np.ones(n)) for n in range(3, 9)]
    return [
        claim(
            "3/tr F over tr F^-1, 6 beacons: largest of random directions",
            "eqs. 28, 41",
            "tr F^-1 > 3/tr F",
            worst(excess),
            "1",
            "below 1 (true, but 1/3 is reached: see the next row)",
            lambda share: share < 1,
        ),
        claim(
            "Least trace of the error covariance of 6 beacons of sigma 1: on a cone; 9 sigma^2/N",
            "eq. 41 and Figure 1",
            "3 sigma^2 / N = 0.5 is its lower bound",
            (least, position_variance_bound(np.ones(6))),
            "m^2",
            "0.5 is reached",
            lambda reached, _: abs(reached - 0.5) < ROUNDING,
            shown="{:.6f}; {:.6f}",
            erratum=Erratum(
                "tr F^-1 >= 9/tr F: 9 sigma^2 / N is the lower bound, and it is reached",
                shown=lambda reached, bound: _equal(reached, bound) and reached > 0.5 + ROUNDING,
            ),
        ),
        claim(
            "Rank of the information of 1 and 2 beacons, whose errors have no bound",
            "eqs. 32 and 35",
            "3 sigma^2 and 3 sigma^2 / 2 bound the estimation errors",
            [np.linalg.matrix_rank(range_information(directions(k, 0), 1.0)) for k in (1, 2)],
            "of 3",
            "3 each",
            lambda one, two: one == two == 3,
            shown="{:.0f}, {:.0f}",
            erratum=Erratum(
                "the information is singular, the error in what is not observed unlimited: no "
                "figure of accuracy follows",
                shown=lambda one, two: one == 1 and two == 2,
            ),
        ),
        claim(
            "Lower bound of 3 to 8 beacons of sigma 1",
            "Figure 1",
            "more beacons are more accurate, by less and less",
            bounds,
            "m^2",
            "falls, ever slower",
            lambda *b: bool((np.diff(b) < 0).all() and (np.diff(b, 2) > 0).all()),
            shown="{:.3f}, {:.3f}, {:.3f}, {:.3f}, {:.3f}, {:.3f}",
        ),
    ]


def _geometry(count: int, trial: int) -> tuple[Array, Array, Array, Array]:
    """Directions, distances (m), lander's velocity (m/s), beacons' velocities (m/s)."""
    random = np.random.default_rng((SEED + 1, count, trial))
    return (
        directions(count, trial),
        random.uniform(2e5, 2e6, count),
        random.normal(size=3) * 3e3,
        random.normal(size=(count, 3)) * 2e3,
    )


def _rate_gradients(trial: int, moving: bool) -> tuple[Array, Array, Array]:
    """d(range rate)/dv and /dr of one beacon by complex steps, and L v of eq. 44 as printed."""
    n, distance, v, beacon = _geometry(1, trial)
    line, w = distance[0] * n[0], beacon[0] if moving else np.zeros(3)

    def rate(r: NDArray, u: NDArray) -> complex:
        return (r @ (u - w)) / np.sqrt(r @ r)

    step = 1e-30j * np.eye(3)
    by_v = np.array([rate(line, v + h).imag for h in step]) / 1e-30
    by_r = np.array([rate(line + h, v + 0j).imag for h in step]) / 1e-30
    x, y, z = n[0]
    eq_44 = (
        np.array(
            [
                [y * y + z * z, -x * y, -x * z],
                [-y * x, z * z + x * x, -y * z],
                [-z * x, -z * y, x * x + y * y],
            ]
        )
        / distance[0]
    )
    return by_v - n[0], by_r, eq_44 @ v


def _rate_rows() -> list[Row]:
    def velocity(trial: int) -> float:
        return float(np.abs(_rate_gradients(trial, True)[0]).max())

    def printed(trial: int, moving: bool) -> float:
        _, right, information = _rate_gradients(trial, moving)
        return float(np.linalg.norm(information - right) / np.linalg.norm(right))

    def mended(trial: int) -> float:
        n, distance, v, beacon = _geometry(1, trial)
        _, right, _ = _rate_gradients(trial, True)
        f = rate_information(n, distance, v - beacon, 1.0)
        return float(np.abs(f - np.outer(right, right)).max() / np.abs(f).max())

    def binet(trial: int) -> float:
        n, distance, v, _ = _geometry(6, trial)
        f = rate_information(n, distance, v, 1.0)
        rows = (v - (n @ v)[:, None] * n) / distance[:, None]
        triples = [
            np.linalg.det(rows[[i, j, k]]) ** 2
            for i in range(6) for j in range(i) for k in range(j)
        ]  # fmt: skip
        return float(abs(sum(triples) / np.linalg.det(f) - 1))

    cones = [
        np.linalg.det(rate_information(best_directions(k), np.ones(k), [0.0, 0.0, 1.0], 1.0))
        for k in (3, 6)
    ]
    ratio = best_rate_determinant(6, 1.0, 1.0, 1.0) / best_rate_determinant(3, 1.0, 1.0, 1.0)
    return [
        claim(
            "Derivative of the range rate by velocity less n: largest of random geometries",
            "eq. 42",
            "sum sigma^-2 n n^T",
            worst(velocity),
            "1",
            "rounding",
            lambda off: off < ROUNDING,
        ),
        claim(
            "L v against the derivative of the range rate by position, beacons at rest",
            "eqs. 43 to 45",
            "sum sigma^-2 L v v^T L^T",
            worst(lambda trial: printed(trial, False)),
            "relative",
            "rounding",
            lambda off: off < ROUNDING,
        ),
        claim(
            "the same, beacons in motion: as printed; with v relative to the beacon",
            "eqs. 43 to 45",
            "sum sigma^-2 L v v^T L^T",
            (worst(lambda trial: printed(trial, True)), worst(mended)),
            "relative",
            "rounding",
            lambda as_printed, _: as_printed < ROUNDING,
            shown="{:.3g}; {:.1e}",
            erratum=Erratum(
                "v must be the velocity relative to the beacon, or orbiters are wrong",
                shown=lambda as_printed, right: right < ROUNDING and as_printed > 0.1,
            ),
        ),
        claim(
            "Sum of squared triple products over the determinant less 1, 6 beacons",
            "eq. 46",
            "equal",
            worst(binet),
            "1",
            "within 1e-6",
            lambda off: off < 1e-6,
        ),
        claim(
            "Largest determinant of 6 beacons over that of 3, range rates: on cones; by formula",
            "eq. 46",
            "similar with Table 1, so 8",
            (cones[1] / cones[0], ratio),
            "1",
            "8",
            lambda by_cone, by_form: abs(by_cone - 8) < 1e-6 and abs(by_form - 8) < 1e-6,
            shown="{:.6f}; {:.6f}",
        ),
    ]


def chain(trial: int) -> Array:
    """The four members of eq. 47, read so that the units fit, for four beacons of sigma 1.

    ``3/tr F``; ``3 / sum [..]^2 / R^2`` with the bracket of its second line; ``2 / (3 sum (vx + vy
    + vz)^2 / R^2)``; ``2 / (3 sum v^2 / R^2)``.
    """
    n, distance, v, _ = _geometry(4, trial)
    f = rate_information(n, distance, v, 1.0)
    x, y, z = (n**2).T
    bracket = v[0] * (1 + (y + z) / 2) + v[1] * (1 + (x + z) / 2) + v[2] * (1 + (x + y) / 2)
    inverse = 1 / distance**2
    return np.array(
        [
            3 / np.trace(f),
            3 / (inverse * bracket**2).sum(),
            2 / (3 * (inverse * v.sum() ** 2).sum()),
            2 / (3 * (inverse * (v @ v)).sum()),
        ]
    )


def _chain_rows() -> list[Row]:
    members = np.array([chain(trial) for trial in range(TRIALS)])
    steps = (members[:, :-1] > members[:, 1:]).mean(axis=0)
    whole = float((members[:, 0] > members[:, 3]).mean())
    wrong = Erratum("random geometries contradict it", shown=lambda share: 0 <= share < 1)
    return [
        *(
            claim(
                f"Share of random geometries in which step {k + 1} of the chain holds",
                "eq. 47",
                "always",
                steps[k],
                "1",
                "1",
                lambda share: share == 1,
                erratum=wrong,
            )
            for k in range(3)
        ),
        claim(
            "the same, first member against the last",
            "eq. 47",
            "always",
            whole,
            "1",
            "1: true all the same, as tr F <= sum v^2/R^2",
            lambda share: share == 1,
        ),
        computed(
            "Noise of a range rate at which it locates as well as a range of 100 m noise, 500 km "
            "away at 5 km/s",
            "section 4.6",
            100.0 * 5e3 / 500e3,
            "m/s",
            note="sigma_R v/R; which is better depends on the noise, which the chapter leaves open",
        ),
    ]
