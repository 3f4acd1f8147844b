"""``compass search`` as a user runs it."""

import json
from functools import partial

import numpy as np
import pytest
from click.testing import CliRunner

from compass.cli.main import program
from compass.errors import CompassError
from compass.inputs import read_design
from compass.orbits import walker_delta
from compass.study import search as module


def run(*arguments):
    return CliRunner().invoke(program, ["search", *(str(a) for a in arguments)])


@pytest.fixture
def one_pattern(monkeypatch):
    """Only 5/5/1 is tried: the kernels are slow when interpreted."""

    def patterns(_kind, largest, radius, smallest):
        assert smallest == largest
        if largest == 5:
            yield lambda i: walker_delta(
                5, 5, 1, inclination_deg=np.degrees(i), radius_km=radius / 1e3
            )

    monkeypatch.setattr(module, "patterns", patterns)
    monkeypatch.setattr(
        module,
        "optimal_inclination",
        lambda _c, _fold, limit, **_: None if limit < 1.2 else np.radians(43.66),
    )
    cheaper = partial(module.covering_radius, tolerance=1e-3)
    monkeypatch.setattr(module, "covering_radius", cheaper)


def test_smallest_is_written_as_a_design(one_pattern, tmp_path):
    path = tmp_path / "best.toml"
    result = run("--fold", 1, "--radius-km", 20428, "--max-satellites", 5, "-o", path, "--json")
    assert result.exit_code == 0
    found = json.loads(result.stdout)
    assert found["smallest"] == 5
    (candidate,) = found["candidates"]
    assert {
        "satellites",
        "planes",
        "phasing",
        "inclination_deg",
        "cap_radius_min_deg",
        "mask_margin_deg",
        "gdop_p95",
    } <= set(candidate)
    assert candidate["proven"] is True
    design = read_design(path)
    assert design.constellation.size == 5
    assert np.degrees(design.constellation.inclination[0]) == pytest.approx(
        candidate["inclination_deg"]
    )


def test_what_was_not_tried_is_said(one_pattern):
    asked = ("--fold", 1, "--radius-km", 20428, "--finalists", 0)
    result = run(*asked, "--max-satellites", 40)
    said = " ".join(result.stdout.split())
    assert "every pattern of up to 5 satellites" in said
    assert "up to 40, were not tried" in said
    result = run(*asked, "--max-satellites", 7, "--beyond", 2, "--json")
    assert json.loads(result.stdout)["tried"] == 7
    as_rosette = run(*asked, "--max-satellites", 5, "--pattern", "rosette")
    assert "(5, 5, 1)" in as_rosette.stdout


def test_none_found_is_1(one_pattern):
    result = run("--fold", 1, "--altitude-km", 300, "--max-satellites", 5)
    assert result.exit_code == 1
    assert "no walker-delta of up to 5 satellites" in result.output


@pytest.mark.slow
def test_the_table_of_an_areosynchronous_search():
    result = run("--fold", 1, "--orbit", "areosynchronous", "--max-satellites", 6)
    assert result.exit_code == 0
    assert "5/5/1" in result.stdout
    assert "proven" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "exactly one of"),
        (["--radius-km", 2e4, "--altitude-km", 2e4], "exactly one of"),
        (["--radius-km", 1000], "--radius-km = 1000: is not above the surface"),
        (["--radius-km", "nan"], "--radius-km = nan: must be a finite number or"),
        (["--radius-km", 2e7], "--radius-km = 2e+07: allowed up to 1e+06 km"),
        (["--repeat", 90, 1], "repeat = [90, 1]"),
        (["--radius-km", 2e4, "--mask-deg", 90], "--mask-deg = 90"),
        (["--radius-km", 2e4, "-o", "/nowhere/at/all.toml"], "does not exist"),
    ],
)
def test_bad_options(arguments, message):
    result = run("--fold", 1, "--max-satellites", 3, *arguments)
    assert isinstance(result.exception, CompassError)
    assert message in str(result.exception)
