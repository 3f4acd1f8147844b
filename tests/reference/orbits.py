"""The problem whose solution is reference-orbits.csv: two satellites by two other programs.

A Taylor integrator at 1e-16 and DOP853 at 1e-12 with Legendre functions and its own ephemerides,
which agree to 0.014 m after 100 days. Units here are SI and radians.

- Frame: z the pole of Mars of the epoch, RA 317.68143 - 0.1061 T, Dec 52.88650 - 0.0609 T degrees; x
  the node of Mars's equator on the ICRF equator. W = 176.630 + 350.89198226 d degrees.
- Gravity: MRO95A to degree 8, with the GM of Mars alone.
- Sun on a fixed ellipse: J2000 ecliptic, Keplerian elements of the epoch; only the mean anomaly moves.
- Phobos, Deimos: Sinclair 1989 as in `compass.moons`, but for one thing: the oracle counts longitudes
  from the node of each Laplace plane on the B1950 equator where Sinclair (and the published
  ephemerides in tests/test_moons.py) count them along the equator to that node first. Its moons are
  thus some 47 degrees ahead. The problem is the same for both programs; the moons are not the real ones.
- Radiation: C_r A/m = 0.026 m^2/kg, 1361/c N/m^2 at 1 au, no shadow.
"""

import csv
from pathlib import Path

import numpy as np

from compass.bodies import ASTRONOMICAL_UNIT
from compass.moons import moon_row
from compass.orbits.forces import ForceModel, Sky
from compass.orbits.gravity import field_from_csv

HERE = Path(__file__).parent
JULIAN_DATE = 2462503.0
DAYS = JULIAN_DATE - 2451545.0
EPOCH = DAYS * 86400.0
T = DAYS / 36525.0


def about_z(a):
    return np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])


def about_x(a):
    return np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])


FROM_ICRF = (
    about_z(np.radians(317.68143 - 0.1061 * T + 90.0))
    @ about_x(np.radians(90 - 52.88650 + 0.0609 * T))
).T
MERIDIAN = np.radians(176.630 + 350.89198226 * DAYS)
SPIN = np.radians(350.89198226) / 86400.0


def meridian(t):
    return MERIDIAN + SPIN * t


def sun(t):
    axis = (1.52371034 + 0.00001847 * T) * ASTRONOMICAL_UNIT.value
    e = 0.09339410 + 0.00007882 * T
    tilt, node, periapsis, longitude = np.radians(
        [
            1.84969142 - 0.00813131 * T,
            49.55953891 - 0.29257343 * T,
            -23.94362959 + 0.44441088 * T,
            -4.55343205 + 19140.30268499 * T,
        ]
    )
    rate = np.radians(19140.30268499 - 0.44441088) / (36525 * 86400.0)
    anomaly = longitude - periapsis + rate * np.asarray(t, float)
    big_e = anomaly
    for _ in range(20):
        big_e = big_e - (big_e - e * np.sin(big_e) - anomaly) / (1 - e * np.cos(big_e))
    flat = [axis * (np.cos(big_e) - e), axis * np.sqrt(1 - e * e) * np.sin(big_e), 0.0 * big_e]
    turn = about_z(node) @ about_x(tilt) @ about_z(periapsis - node)
    obliquity = np.radians(84381.448 / 3600)
    return -np.stack(flat, axis=-1) @ (FROM_ICRF @ about_x(obliquity) @ turn).T


def moons():
    rows = np.array(
        [moon_row(name, EPOCH, 0.0, from_icrf=FROM_ICRF) for name in ("phobos", "deimos")]
    )
    years = (JULIAN_DATE - 2441266.5) / 365.25
    rows[:, 6] += np.radians([47.386 - 0.00140 * years, 46.367 - 0.00138 * years])
    return rows


def field(degree=8):
    text = (HERE / "mars-gravity-mro95a.csv").read_text(encoding="utf-8")
    return field_from_csv(text, "MRO95A", 42828.374837e9, 3396.0e3).truncated(degree)


def sky():
    return Sky(meridian, sun, moons(), (7.17e5, 9.68e4), 1.32712440041e20)


def forces():
    return ForceModel(field(), True, True, 0.026, "none")


def states():
    """Cases with their days, positions and velocities."""
    found = {}
    with (HERE / "reference-orbits.csv").open(encoding="utf-8") as lines:
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            numbers = [float(row[key]) for key in ("day", "x_km", "y_km", "z_km")]
            speeds = [float(row[key]) for key in ("vx_km_s", "vy_km_s", "vz_km_s")]
            found.setdefault(row["case"], []).append(numbers + speeds)
    return {
        case: (table[:, 0] * 86400.0, table[:, 1:4] * 1e3, table[:, 4:] * 1e3)
        for case, table in ((case, np.array(rows)) for case, rows in found.items())
    }
