"""The clock that budgets go by stands while kernels are compiled."""

from time import monotonic

import pytest
from numba import config

from compass.core import compiling as module
from compass.core.compiling import compiling, watchers, worked
from compass.core.jit import kernel


def test_the_clock_stands_while_any_thread_compiles(monkeypatch):
    now, told = [100.0], []
    monkeypatch.setattr(module, "monotonic", lambda: now[0])
    monkeypatch.setattr(module, "_STOPWATCH", module._Stopwatch())
    monkeypatch.setattr(module, "watchers", [told.append])

    def passed(seconds):
        before = worked()
        now[0] += seconds
        return worked() - before

    assert passed(1.0) == 1.0
    with compiling():
        assert passed(2.0) == 0.0
        with compiling():  # as a kernel that another calls, or another thread
            assert passed(4.0) == 0.0
        assert passed(8.0) == 0.0 and told == [True]
    assert told == [True, False] and passed(16.0) == 16.0
    assert worked() == pytest.approx(117.0)  # 14 of the 31 seconds were spent so
    with pytest.raises(ZeroDivisionError), compiling():
        now[0] += 1 / 0
    assert passed(1.0) == 1.0


@pytest.mark.skipif(config.DISABLE_JIT, reason="nothing is compiled")
def test_a_kernel_that_is_compiled_stops_it():
    @kernel
    def tripled(x):
        return 3.0 * x

    told = []
    watchers.append(told.append)
    try:
        wall, work = monotonic(), worked()
        assert tripled(2.0) == 6.0
        assert worked() - work < monotonic() - wall
    finally:
        watchers.remove(told.append)
    assert told == [True, False]
