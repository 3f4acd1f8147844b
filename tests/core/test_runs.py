import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.core.count import count_rows
from compass.core.runs import ALL_AROUND, Row, cap_run, horizon_runs, mask_at, most_runs, sight_runs
from compass.frames import direction

COLUMNS = 24


def columns(m=COLUMNS):
    lon = -np.pi + 2 * np.pi / m * (np.arange(m) + 0.5)
    return np.cos(lon), np.sin(lon), lon


def one_run(runs, u, cos_cap, row, lon0):
    runs[0] = cap_run(*u, np.hypot(u[0], u[1]), np.arctan2(u[1], u[0]), cos_cap, *row, lon0)
    return 1


def spread(runs, found, m):
    inside = np.zeros(m, bool)
    for first, stop in runs[:found]:
        inside[np.arange(first, stop) % m] = True
    return inside


@settings(max_examples=300)
@given(
    st.floats(-np.pi / 2, np.pi / 2),
    st.floats(-np.pi, np.pi),
    st.floats(0.0, np.pi / 2),
    st.sampled_from([-np.pi / 2, -1.2, -0.4, 0.0, 0.3, 1.0, 1.5, np.pi / 2]),
)
def test_run_of_a_cap_equals_testing_every_column(lat, lon, radius, row):
    u, (cos_lon, sin_lon, _) = direction(lat, lon), columns()
    runs = np.empty((1, 2), np.int64)
    args = (np.sin(row), np.cos(row), cos_lon, sin_lon)
    found = one_run(runs, u, np.cos(radius), args, -np.pi + np.pi / COLUMNS)
    dot = (u[0] * cos_lon + u[1] * sin_lon) * np.cos(row) + u[2] * np.sin(row)
    differ = spread(runs, found, COLUMNS) != (dot >= np.cos(radius))
    flat = np.hypot(u[0], u[1]) * np.cos(row) < 1e-8
    assert not np.any(differ & ~(flat & (np.abs(dot - np.cos(radius)) < 1e-8)))


@pytest.mark.parametrize(("radius", "seen"), [(0.0, 1), (np.pi / COLUMNS, 1), (np.pi, COLUMNS)])
def test_smallest_and_largest_caps(radius, seen):
    cos_lon, sin_lon, lon = columns()
    runs = np.empty((1, 2), np.int64)
    u = direction(0.0, lon[5])
    cap = np.cos(radius) - (1e-15 if radius == 0 else 0)
    found = one_run(runs, u, cap, (0.0, 1.0, cos_lon, sin_lon), lon[0])
    assert spread(runs, found, COLUMNS).sum() == seen


@settings(max_examples=60)
@given(st.floats(-1.5, 1.5), st.floats(-np.pi, np.pi), st.floats(1.1, 8.0), st.floats(-1.5, 1.5))
def test_horizon_with_equal_elevations_is_a_cap(lat, lon, distance, row):
    cos_lon, sin_lon, lons = columns()
    e = 0.2
    r = distance * direction(lat, lon)
    cap = np.arccos(np.cos(e) / distance) - e
    runs, other = np.empty((COLUMNS, 2), np.int64), np.empty((1, 2), np.int64)
    args = (np.sin(row), np.cos(row), cos_lon, sin_lon)
    stand = np.array([np.cos(row), np.sin(row), np.cos(row), np.sin(row), 1.0])
    level = np.array([0.0, 2.0]), np.array([e, e])
    found = horizon_runs(*r, Row(*level, stand, cos_lon, sin_lon, lons[0], ALL_AROUND), runs)
    single = one_run(other, r / distance, np.cos(cap), args, lons[0])
    differ = spread(runs, found, COLUMNS) != spread(other, single, COLUMNS)
    # the two tests round differently: only a column on the rim may differ
    points = direction(row, lons)
    rim = np.abs(points @ (r / distance) - np.cos(cap)) < 1e-12
    assert not np.any(differ & ~rim)


@given(st.floats(-2 * np.pi + 1e-9, 2 * np.pi - 1e-9))
def test_mask_between_its_azimuths(azimuth):
    azimuths, elevations = np.array([0.3, 2.0, 5.0]), np.array([0.1, 0.5, 0.2])
    expected = np.interp(azimuth, azimuths, elevations, period=2 * np.pi)
    assert mask_at(azimuth, azimuths, elevations) == pytest.approx(expected, abs=1e-12)


def test_counts_equal_matrix_product(seed_design):
    rng = np.random.default_rng(1)
    u = rng.normal(size=(2, 9, 3))
    u /= np.linalg.norm(u, axis=-1, keepdims=True)
    cos_cap = np.cos(rng.uniform(0.2, 1.5, (2, 9)))
    lat = np.linspace(-1.5, 1.5, 11)
    cos_lon, sin_lon, lon = columns()
    out = np.empty((2, 11, COLUMNS), np.int16)
    count_rows(u, cos_cap, np.sin(lat), np.cos(lat), cos_lon, sin_lon, lon[0], out)
    points = direction(lat[:, None], lon)
    twin = (np.einsum("ijc,tsc->tijs", points, u) >= cos_cap[:, None, None]).sum(-1)
    np.testing.assert_array_equal(out, twin)


@settings(max_examples=60)
@given(
    lat=st.floats(-1.5, 1.5), lon=st.floats(-np.pi, np.pi), distance=st.floats(1.1, 8.0),
    row=st.floats(-1.5, 1.5), height=st.floats(0.05, 10.0), beam=st.floats(0.05, 3.0),
)  # fmt: skip
def test_users_in_orbit_see_down_to_their_mask_in_beams(lat, lon, distance, row, height, beam):
    cos_lon, sin_lon, lons = columns()
    r, up = distance * direction(lat, lon), direction(row, lons)
    u = 1.0 + height
    mask = -0.9 * np.arccos(1.0 / u)
    stand = np.array([np.cos(row), np.sin(row), u * np.cos(row), u * np.sin(row), u * u])
    users = Row(np.zeros(1), np.array([mask]), stand, cos_lon, sin_lon, lons[0], np.cos(beam))
    runs = np.empty((most_runs(1, users), 2), np.int64)
    found = sight_runs(*r, 0.0, users, runs)
    line = r - u * up
    far = np.linalg.norm(line, axis=1)
    above = np.arcsin((line * up).sum(axis=1) / far) - mask
    inside = beam - np.arccos(np.clip(line @ r / (far * distance), -1.0, 1.0))
    clear = np.minimum(np.abs(above), np.abs(inside)) > 1e-7  # rims round either way
    seen = spread(runs, found, COLUMNS)
    assert np.array_equal(seen[clear], ((above >= 0) & (inside >= 0))[clear])
