"""Coverage maps of Mars beside kshana, one thread each.

Ratios are of processor times in one run, so that a noisy machine cannot favour either side. Both
count satellites and judge the geometry of every cell and epoch; kshana gives availability and the
mean and percentiles of GDOP, PDOP, HDOP and VDOP rounded as JSON, compass these and TDOP by cell,
shares of every fold and waiting times. lox finds passes alone, and only with a file of planetary
ephemerides: it has no map to stand beside.
"""

import json
import subprocess
import sys
import time

import numpy as np
import pytest

from compass import walker_delta
from compass.coverage.grid import equal_angle_grid
from compass.coverage.maps import coverage_map
from compass.coverage.view import view
from compass.sites import Mask

kshana = pytest.importorskip("kshana")

RADIUS, ORBIT_KM, INCLINATION, MASK, PDOP = 3396.2e3, 20428, 55, 5, 6
DAY = 88642.66

#: Satellites, planes, epochs, cell in degrees, and how many times faster is asked for.
CASES = [(15, 5, 96, 1.0, 4.0), (60, 5, 96, 1.0, 2.0), (1000, 20, 96, 1.0, 4.0),
         (15, 5, 1000, 1.0, 3.0), (15, 5, 96, 0.25, 4.0)]  # fmt: skip


def processor(function):
    begin = time.process_time()
    return function(), time.process_time() - begin


def scenario(satellites, planes, epochs, step):
    """The case as kshana reads it; it takes whole steps of its span, so half a step is added."""
    between = DAY / epochs
    return f"""
kind = "constellation-design"
body = "mars"
duration_s = {between * (epochs + 0.5)}
step_s = {between}
mask_deg = {MASK}
pdop_threshold = {PDOP}
grid_step_deg = {step}
clock = "common"
track_points = 2
max_tracks = 0
[[constellation]]
name = "pattern"
[[constellation.shell]]
pattern = "delta"
total = {satellites}
planes = {planes}
phasing = 1
inclination_deg = {INCLINATION}
semi_major_axis_km = {ORBIT_KM}
"""


def ours(satellites, planes, epochs, step):
    pattern = walker_delta(satellites, planes, 1, inclination_deg=INCLINATION, radius_km=ORBIT_KM)
    seen = view(pattern, np.arange(epochs) * DAY / epochs, RADIUS, Mask.constant(np.radians(MASK)))
    return coverage_map(seen, equal_angle_grid(np.radians(step)), pdop_threshold=PDOP, workers=1)


@pytest.mark.parametrize(("satellites", "planes", "epochs", "step", "least"), CASES)
def test_a_map(satellites, planes, epochs, step, least):
    case = satellites, planes, epochs, step
    ours(satellites, planes, 2, 30.0)  # kernels are loaded
    made, taken = processor(lambda: ours(*case))
    found, rival = processor(lambda: json.loads(kshana.run(scenario(*case))))
    pairs = 360 * 180 / step**2 * epochs * satellites / taken
    print(
        f"\n{satellites} satellites, {epochs} epochs, {step:g} deg: compass {taken:.2f} s, "
        f"kshana {kshana.version()} {rival:.2f} s,"
        f" x{rival / taken:.1f}; {pairs / 1e9:.2f} G satellite-cell-epochs a second"
    )
    # the same question: cells and epochs are the same, but for rounding at the horizon
    theirs = found["global"]
    assert found["work"]["epochs"] == epochs
    assert 100 * float(made.cells_availability) == pytest.approx(
        theirs["availability_pct"], abs=0.1
    )
    assert rival / taken >= least


def test_a_whole_process():
    """From nothing to the numbers of a map, both in Python, figures certified here and not there."""
    rival = (
        "import kshana, json; print(json.loads(kshana.run("
        + repr(scenario(15, 5, 96, 1.0)) + "))['global'])"
    )  # fmt: skip
    own = "import sys; sys.argv = ['compass', 'map', 'designs/compass-15-5-1.toml', '--json']\n"
    own += "from compass.cli.main import main\nmain()"
    seconds = {}
    for name, script in (("compass", own), ("kshana", rival)) * 2:
        begin = time.perf_counter()
        subprocess.run([sys.executable, "-c", script], check=True, capture_output=True)
        seconds[name] = time.perf_counter() - begin
    print(f"\nwhole process: compass {seconds['compass']:.2f} s, kshana {seconds['kshana']:.2f} s")
    print(f"numba alone {import_of('numba'):.2f} s")


def import_of(module):
    begin = time.perf_counter()
    subprocess.run([sys.executable, "-c", f"import {module}"], check=True)
    return time.perf_counter() - begin
