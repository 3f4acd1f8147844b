"""When the samples are and how dates are said, against another program's time scales."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compass.errors import ArgumentError
from compass.frames import seconds_past_j2000
from compass.handover.instants import MOST_STATES, default_step, iso, sample_times, tdb, utc
from compass.orbits import keplerian, repeat_period, walker_delta

COMPASS = walker_delta(15, 5, 1, inclination_deg=45.8, radius_km=20427)


@pytest.mark.parametrize(
    "date",
    ["1973-05-06", "1981-07-01", "1989-12-31", "1999-01-01", "2012-06-30", "2016-12-31",
     "2017-01-01", "2035-07-01"],
)  # fmt: skip
def test_utc_equals_another_program(date):
    brahe = pytest.importorskip("brahe")
    year, month, day = (int(part) for part in date.split("-"))
    theirs = brahe.Epoch.from_datetime(year, month, day, 7, 8, 9.0, 0.0, brahe.TDB)
    y, mo, d, h, mi, s, ns = theirs.to_datetime_as_time_system(brahe.UTC)
    expected = np.datetime64(f"{y:04d}-{mo:02d}-{d:02d}T{h:02d}:{mi:02d}:00") + np.timedelta64(
        round(s * 1e6 + ns / 1e3), "us"
    )
    when = np.datetime64(f"{date}T07:08:09").astype("datetime64[us]").astype(object)
    ours = utc(seconds_past_j2000(when), np.zeros(1))[0]
    # TDB swings by 1.7 ms about terrestrial time
    assert abs(ours - expected) <= np.timedelta64(1700, "us")


def test_utc_at_the_last_leap_second_and_before_the_first():
    start = np.datetime64("2016-12-31T23:59:59", "us")
    seconds = (start - np.datetime64("2000-01-01T12:00:00", "us")) / np.timedelta64(1, "s")
    # UTC 23:59:58, :59, :60 (reads as 00:00:00), 00:00:00
    texts = iso(utc(seconds + 36 + 32.184, np.array([-1.0, 0.0, 1.0, 2.0])))
    assert [text[11:19] for text in texts] == ["23:59:58", "23:59:59", "00:00:00", "00:00:00"]
    old = utc(-1e9, np.zeros(1)) - tdb(-1e9, np.zeros(1))
    assert old[0] == -np.timedelta64(42_184_000, "us")


def test_the_epoch_and_microseconds_are_said():
    assert iso(tdb(86400.0, np.array([0.0, 0.25]))) == [
        "2000-01-02T12:00:00.000000",
        "2000-01-02T12:00:00.250000",
    ]


def test_by_default_one_repeat_period_in_whole_steps():
    times = sample_times(COMPASS)
    assert times[0] == 0
    assert times[-1] == pytest.approx(repeat_period(COMPASS).duration, abs=1e-6)
    # 150 steps in a period of 88 522 s are of 590.1 s
    np.testing.assert_array_equal(np.diff(times)[:-1], 590.0)


def test_the_step_follows_the_fastest_satellite_at_periapsis():
    both = keplerian([9e6, 9e6], [0.0, 0.5], 0.5, 0.0, 0.0, 0.0)
    circle = keplerian(9e6, 0.0, 0.5, 0.0, 0.0, 0.0)
    assert default_step(circle) / default_step(both) == pytest.approx(1.5**0.5 / 0.5**1.5, rel=0.02)


@given(st.floats(1e-3, 100.0), st.floats(0.01, 1.0))
def test_samples_increase_from_0_to_the_end(hours, share):
    step = max(hours * 3600 * share, 1.0)
    if step > hours * 3600:
        return
    times = sample_times(COMPASS, hours, step)
    assert times[0] == 0
    assert times[-1] == pytest.approx(hours * 3600, abs=1e-6)
    assert (np.diff(times) > 0).all()
    assert np.diff(times).max() <= step + 2e-3


@pytest.mark.parametrize(
    ("duration", "step", "message"),
    [
        (0.0, None, "duration_h = 0: must be above 0"),
        (float("nan"), None, "duration_h = nan"),
        (1e6, None, "at most 87600"),
        (1.0, 0.0, "step_s = 0: must be at least 0.001"),
        (1.0, 4000.0, "at most the duration, 3600 s"),
        (1.0, float("nan"), "step_s = nan"),
        (24.0, 0.5, f"more than {MOST_STATES}; take steps from 1 s on"),
    ],
)
def test_bad_spans(duration, step, message):
    with pytest.raises(ArgumentError, match=message.replace("(", r"\(")):
        sample_times(COMPASS, duration, step)


def test_the_step_advised_is_accepted():
    assert sample_times(COMPASS, 24.0, 1.0).size * COMPASS.size < MOST_STATES


def test_dates_end_with_the_year_9999():
    late = replace(COMPASS, epoch=float(252_455_572_800 - 3600))  # 9999-12-31 23:00
    with pytest.raises(ArgumentError, match="ends after the year 9999"):
        sample_times(late, 2.0)
    assert sample_times(late, 0.5).size
