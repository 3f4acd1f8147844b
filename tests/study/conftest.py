"""A lander short of time: the first 40 s of an entry, quick enough for interpreted kernels."""

import pytest

from compass.inputs.scenario import read_scenario_text


@pytest.fixture(scope="session")
def short(designs):
    """Make a scenario of 20 steps from designs/landing.toml, with changes of its text."""
    text = (designs / "landing.toml").read_text()
    text = text.replace("duration_s = 320", "duration_s = 40\nstep_s = 2")
    text = text.replace('[[trigger]]\nname = "parachute deployment"\nmach = 2\n', "")
    text = text.replace('[beacons]\ndesign = "compass-15-5-1.toml"\n', "")

    def make(*changes):
        changed = text
        for old, new in changes:
            assert old in changed
            changed = changed.replace(old, new)
        return read_scenario_text(changed)

    return make
