"""Gravity: its gradient, its laws, and files that others write."""

from math import factorial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import lpmv

from compass.core.gravity import field_acceleration
from compass.errors import ArgumentError, DesignError
from compass.orbits.gravity import GravityField, built_in_field, read_field


def potential(field, x):
    """Sum over unnormalised Legendre functions of SciPy (with its Condon-Shortley phase undone)."""
    r = np.linalg.norm(x)
    longitude, total = np.arctan2(x[1], x[0]), 0.0
    for n in range(2, field.degree + 1):
        for m in range(n + 1):
            norm = np.sqrt((2 - (m == 0)) * (2 * n + 1) * factorial(n - m) / factorial(n + m))
            legendre = (-1) ** m * norm * lpmv(m, n, x[2] / r)
            wave = field.c[n, m] * np.cos(m * longitude) + field.s[n, m] * np.sin(m * longitude)
            total += (field.radius / r) ** n * legendre * wave
    return field.gm / r * total


def acceleration(field, x):
    scale = field.gm / field.radius**2
    return np.array(field_acceleration(*x, field.terms(), field.degree + 1, field.radius, scale))


@given(
    # nearer to the poles the potential's own 1 - sin^2 loses the digits that differences need
    st.floats(-1.57, 1.57),
    st.floats(-np.pi, np.pi),
    st.floats(3.5e6, 3e7),
    st.integers(2, 20),
)
def test_acceleration_is_the_gradient_of_the_potential(latitude, longitude, r, degree):
    field = built_in_field().truncated(degree)
    c = np.cos(latitude)
    x = r * np.array([c * np.cos(longitude), c * np.sin(longitude), np.sin(latitude)])
    h = r * 1e-5
    slope = [
        (potential(field, x + h * e) - potential(field, x - h * e)) / (2 * h) for e in np.eye(3)
    ]
    # central differences: h^2 / 6 times the third derivative (some 400 U / r^3 at degree 20), and
    # rounding of the potential over h
    size = 2e-3 * field.gm / r * (field.radius / r) ** 2
    allowed = size / r * (1e-10 * degree**3 + 2e-16 * degree / 1e-5 * 30)
    assert acceleration(field, x) == pytest.approx(slope, abs=allowed)


def test_degree_two_is_the_textbooks_oblateness():
    field = built_in_field().truncated(2, 0)
    x = np.array([4e6, -3e6, 5e6])
    j2 = -np.sqrt(5) * field.c[2, 0]
    r2, z = x @ x, x[2]
    factor = -1.5 * field.gm * 1.9566e-3 * field.radius**2 / r2**2.5
    known = factor * ((1 - 5 * z * z / r2) * x + 2 * z * np.array([0, 0, 1]))
    # the textbook's J2 is rounded to 1.9566e-3
    assert acceleration(field, x) == pytest.approx(known * j2 / 1.9566e-3, rel=1e-12)


def test_a_place_on_the_axis_is_no_singularity():
    field = built_in_field()
    # a millimetre aside the gradient, 4e-8 per second squared, moves it by less than this
    assert acceleration(field, np.array([0.0, 0.0, 4e6])) == pytest.approx(
        acceleration(field, np.array([1e-3, 0.0, 4e6])), abs=1e-10
    )


def test_built_in_field_is_that_of_its_head():
    field = built_in_field()
    assert (field.degree, field.radius, field.gm) == (20, 3396.0e3, 42828.37285418775e9)
    assert field.c[2, 2] == -8.4635903869415e-05
    with pytest.raises(ArgumentError, match="gravity_degree = 21: allowed 0 to 20"):
        field.truncated(21)


SHADR = """  3396.0, 42828.372854, 0.1, 3, 3, 1, 0.0, 0.0
 2, 0, -8.75021132354D-04, 0.0, 1e-11, 0.0
 2, 1, 5.9D-10, -4.9D-11, 1e-12, 1e-12
 2, 2, -8.46D-05, 4.89D-05, 1e-12, 1e-12
 3, 0, -1.19e-05, 0.0, 1e-12, 0.0
 3, 1, 0.0, 0.0, 0.0, 0.0
 3, 2, 0.0, 0.0, 0.0, 0.0
 3, 3, 3.5e-05, 2.6e-05, 1e-12, 1e-12
"""
ICGEM = """product_type gravity_field
modelname made_up
earth_gravity_constant 0.42828372854e+14
radius 3396000.0
max_degree 2
norm fully_normalized
tide_system tide_free
end_of_head ====
gfc 0 0 1.0 0.0
gfc 2 0 -8.75021132354e-04 0.0
gfc 2 1 0.0 0.0
gfc 2 2 -8.46e-05 4.89e-05
"""


@pytest.mark.parametrize(("name", "text"), [("x.tab", SHADR), ("x.gfc", ICGEM)])
def test_files_of_others_are_read(tmp_path, name, text):
    (tmp_path / name).write_text(text)
    field = read_field(tmp_path / name, "iau-2000")
    assert (field.gm, field.radius) == (pytest.approx(42828.372854e9), 3396e3)
    assert (field.c[2, 0], field.s[2, 2]) == (-8.75021132354e-04, 4.89e-05)


def test_an_old_frame_turns_the_field_west(tmp_path):
    (tmp_path / "x.tab").write_text(SHADR)
    old, new = (read_field(tmp_path / "x.tab", frame) for frame in ("iau-1991", "iau-2000"))
    assert np.degrees(old.meridian - new.meridian) == pytest.approx(-0.238)


@pytest.mark.parametrize(
    ("name", "text", "frame", "message"),
    [
        ("x.tab", SHADR, None, "gravity_frame: missing; allowed iau-2000 or iau-1991"),
        ("x.tab", SHADR, "grs80", "gravity_frame: 'grs80'; allowed"),
        ("x.tab", SHADR.replace("3, 3, 1,", "3, 3, 0,"), "iau-2000", "normalisation state 0"),
        (
            "x.tab",
            SHADR.replace("-8.75021132354D-04", "-1.9566e-3"),
            "iau-2000",
            "C20 = -0.0019566",
        ),
        ("x.tab", SHADR.splitlines()[0], "iau-2000", "no coefficients of degree 2"),
        ("x.tab", SHADR.replace("42828.", "398600."), "iau-2000", "is not that of Mars"),
        ("x.tab", SHADR.replace("3396.0,", "6378.0,"), "iau-2000", "radius = 6.378e"),
        ("x.tab", "hello\n", "iau-2000", "is neither a SHADR table"),
        ("x.tab", SHADR.split("\n", 1)[1], "iau-2000", "is neither a SHADR table"),
        ("x.tab", SHADR.replace("5.9D-10", "oops"), "iau-2000", "line 3: '2 1 oops"),
        ("x.tab", SHADR.replace("5.9D-10", "nan"), "iau-2000", "line 3: '2 1 nan"),
        (
            "x.tab",
            SHADR.replace("1, 5.9D-10, -4.9D-11, 1e-12, 1e-12", "1"),
            "iau-2000",
            "line 3: '2 1",
        ),
        ("x.tab", SHADR.replace("2, 1,", "2, 0,"), "iau-2000", "line 3: degree 2, order 0: given"),
        ("x.tab", SHADR[: SHADR.index(" 3, 2")], "iau-2000", "degree 3, order 2: missing"),
        ("x.gfc", ICGEM.replace("gfc 2 2 -", "gfc 2 2 x"), "iau-2000", "line 12: '2 2 x8.46"),
        (
            "x.gfc",
            ICGEM.replace("fully_normalized", "unnormalized"),
            "iau-2000",
            "norm = unnormalized",
        ),
        ("x.gfc", ICGEM.replace("tide_system tide_free\n", ""), "iau-2000", "tide_system: missing"),
        ("x.gfc", ICGEM.replace("tide_free", "mean_tide"), "iau-2000", "tide_system = mean_tide"),
        ("missing.gfc", None, "iau-2000", "cannot be read"),
    ],
)
def test_bad_files_get_one_message(tmp_path, name, text, frame, message):
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(DesignError, match=message):
        read_field(tmp_path / name, frame)


def test_an_order_may_be_left_out():
    field = built_in_field().truncated(4, 0)
    assert isinstance(field, GravityField)
    assert not field.c[:, 1:].any()
