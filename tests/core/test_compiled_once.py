"""No kernel is compiled twice for what is the same to it."""

import subprocess
import sys

import pytest
from numba import config, int64, njit

from compass.core.jit import compile_for_types_alone

JOBS = """
import sys
import compass

design = compass.Design(compass.walker_delta(4, 4, 1, inclination_deg=60, radius_km=20_000))
compass.fold(design, fold=1)
compass.map(design, step_deg=30)
compass.show(design)
for module in [m for name, m in sys.modules.items() if name.startswith("compass.core")]:
    for name, value in vars(module).items():
        if len(getattr(value, "signatures", ())) > 1:
            print(module.__name__, name, *value.signatures, sep="\\n  ")
"""


@pytest.mark.skipif(config.DISABLE_JIT, reason="nothing is compiled")
def test_constants_and_defaults_of_callers_are_no_kinds_of_their_own():
    @njit
    def power(base, times=2):
        return base**times

    @njit
    def powers(base):
        return power(base) + power(base, 3) + power(base, 4)

    compile_for_types_alone(power)
    assert powers(2) == 4 + 8 + 16
    assert power.signatures == [(int64, int64)]


@pytest.mark.slow
def test_the_commands_compile_each_kernel_once():
    done = subprocess.run([sys.executable, "-c", JOBS], capture_output=True, text=True, check=True)
    assert done.stdout == ""
