import dataclasses
import json
from dataclasses import FrozenInstanceError

import pytest

import compass
from compass.coverage.certificate import Outcome
from compass.coverage.continuous import STEPS, continuous_coverage
from compass.document import html, text
from compass.errors import ArgumentError
from compass.orbits import orbital_period
from compass.orbits.constellation import from_pattern
from compass.sites import Mask


@pytest.fixture(scope="module")
def found(designs):
    return compass.fold(designs / "compass-15-5-1.toml", losses=1)


def test_it_prints_as_the_command_prints(found, run, designs):
    code, out, _ = run("fold", designs / "compass-15-5-1.toml", "--losses", 1)
    assert (code, out) == (0, str(found) + "\n")
    assert str(found) == repr(found) == text(found.document())
    assert found._repr_html_() == html(found.document())
    assert str(found).splitlines()[0].startswith("COMPASS 15/5/1: PROVEN: 4 or more satellites")


def test_its_dictionary_is_the_json(found, run, designs):
    _, out, _ = run("fold", designs / "compass-15-5-1.toml", "--losses", 1, "--json")
    assert json.loads(out) == found.to_dict()
    json.dumps(found.to_dict(), allow_nan=False)


def test_it_is_frozen_and_knows_whether_it_holds(found):
    assert found.holds and found.outcome is Outcome.PROVEN
    with pytest.raises(FrozenInstanceError):
        found.fold = 3


def test_the_worst_place_is_where_the_next_satellite_is_farthest(found, designs):
    """By a second way: the angle to the 4th nearest satellite there is the cap radius."""
    import numpy as np

    from compass.frames import direction
    from compass.orbits import positions_mcmf

    worst = found.to_dict()["worst"]
    design = compass.read_design(designs / "compass-15-5-1.toml")
    r = positions_mcmf(design.constellation, [worst["time_s"]])[:, 0]
    place = direction(np.radians(worst["latitude_deg"]), np.radians(worst["longitude_deg"]))
    angles = np.degrees(np.arccos(r @ place / np.linalg.norm(r, axis=1)))
    # the bracket of the radius is 1e-6 rad wide
    assert np.sort(angles)[3] == pytest.approx(found.cap_radius_min_deg, abs=2 * np.degrees(1e-6))


def test_a_design_or_its_path(designs):
    path = designs / "compass-15-5-1.toml"
    assert str(compass.fold(compass.read_design(path))) == str(compass.fold(str(path)))
    with pytest.raises(ArgumentError, match="design = int: must be a Design or the path"):
        compass.fold(15)


def test_a_plot_on_given_or_new_axes(found):
    axes = found.plot()
    assert len(axes.patches) == 6  # folds 4 to 9
    assert found.plot(axes=axes) is axes
    assert axes.get_ylabel() == "share of area and time, %"


def test_every_outcome_has_a_sentence():
    assert all(outcome.sentence.endswith(".") for outcome in Outcome)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "fold"), [("walker-star-iridium", 1), ("compass-15-5-1", 4), ("walker-15-15-6", 4)]
)
def test_margins_hold_as_they_are_printed(designs, name, fold):
    """Rounded to the safe side: the claim is proven at what is printed, not just at the number."""
    design = compass.read_design(designs / f"{name}.toml")
    shown = {}
    for block in compass.fold(design, fold=fold).document().blocks:
        for row in getattr(block, "rows", ()):
            shown[str(row[0])] = str(row[1])
    mask = float(next(v for k, v in shown.items() if k.startswith("highest mask")))
    altitude = float(next(v for k, v in shown.items() if k.startswith("lowest altitude")))
    assert compass.fold(design, fold=fold, mask_deg=mask).outcome == "proven"
    radius = altitude * 1e3 + design.figure.equatorial_radius
    lower = dataclasses.replace(
        design, constellation=from_pattern(design.constellation.pattern, radius)
    )
    assert compass.fold(lower, fold=fold).outcome == "proven"


def test_what_a_long_claim_costs_is_told_before_each_step():
    """Every step, in order, and the revolutions of the fastest satellite that it looks at."""
    c = compass.from_elements(
        semi_major_axis_km=[9000, 20000.5], inclination_deg=[10, 50], satellite_names=["a", "b"]
    )
    told, hours = [], 3.0
    continuous_coverage(
        c,
        1,
        sphere_radius=3396.19e3,
        mask=Mask(),
        duration=hours * 3600,
        begin=lambda step, revolutions: told.append((step, revolutions)),
    )
    assert [step for step, _ in told] == list(STEPS)
    turns = hours * 3600 / orbital_period(9000e3)
    assert [number for _, number in told] == pytest.approx([turns] * len(STEPS))
