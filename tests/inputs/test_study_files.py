"""Study files: what is read, and every fault at once with its remedy."""

import numpy as np
import pytest

from compass.allowed import MOST_SAMPLES
from compass.entry.doubts import Doubts
from compass.errors import DesignError
from compass.inputs.study import Free, read_study, read_study_text
from compass.orbits import areosynchronous_radius, orbital_period
from compass.quantities.merits import MERITS, STAGES, merits_of

GOOD = """
name = "t"
[study]
patterns = ["walker-delta", "walker-delta"]
satellites = 5
inclination_deg = { least = 40, most = 50, step = 5 }
orbits = ["areosynchronous", "half", "third"]
[[constraint]]
figure = "fold_proven"
at_least = 1
[[constraint]]
figure = "gdop_p95"
below = 6
[[objective]]
figure = "satellites"
[[objective]]
figure = "mask_margin_deg"
"""


def test_a_good_one():
    study = read_study_text(GOOD)
    assert study.space.patterns == ("walker-delta",)
    assert study.space.satellites == (5,)
    assert study.space.inclination_deg == (40.0, 45.0, 50.0)
    assert study.space.mask_deg == (0.0,)
    assert [o.sign for o in study.objectives] == [1, -1]
    assert [o.goal for o in study.objectives] == ["smallest", "largest"]
    proven, gdop = study.constraints
    assert proven.holds(1.0) and not proven.holds(0.0) and not proven.holds(None)
    assert gdop.holds(5.9) and not gdop.holds(6.0) and not gdop.holds(float("nan"))
    assert gdop.holds(np.array([5.9, 6.0, np.nan])).tolist() == [True, False, False]
    assert str(proven) == "fold_proven >= 1" and str(gdop) == "gdop_p95 < 6"
    assert study.constraints_of("map") == [gdop]


def test_what_is_no_value_of_its_field_is_refused_for_that_alone():
    text = GOOD.replace("gdop_p95", "\\u0000").replace("below = 6", "below = nan")
    with pytest.raises(DesignError) as refused:
        read_study_text(text)
    about = [fault.split(" = ")[0] for fault in str(refused.value).splitlines()]
    assert about == ["study: constraint[2].figure", "study: constraint[2].below"]


def test_named_orbits_have_whole_revolutions_in_a_sidereal_day():
    day = orbital_period(areosynchronous_radius())
    for k, radius in enumerate(read_study_text(GOOD).space.radius_km, start=1):
        assert orbital_period(radius * 1e3) * k == pytest.approx(day, rel=1e-12)


def test_free_ranges_with_sampling():
    text = GOOD.replace(", step = 5", "").replace(
        "[[constraint]]", '[sampling]\nmethod = "sobol"\nsamples = 8\n[[constraint]]', 1
    )
    assert read_study_text(text).space.inclination_deg == Free(40.0, 50.0)


def test_the_digest_covers_the_files_it_names(tmp_path, designs):
    design = (designs / "compass-15-5-1.toml").read_text()
    (tmp_path / "d.toml").write_text(design)
    path = tmp_path / "s.toml"
    path.write_text(GOOD + '[compare]\ndesign = "d.toml"\n')
    first = read_study(path)
    assert first.compare.constellation.size == 15
    assert read_study(path).digest == first.digest
    (tmp_path / "d.toml").write_text(design + "\n# a remark, which changes nothing\n")
    assert read_study(path).digest == first.digest
    (tmp_path / "d.toml").write_text(design.replace("mask_deg = 0", "mask_deg = 1"))
    assert read_study(path).digest != first.digest
    (tmp_path / "d.toml").unlink()
    with pytest.raises(DesignError, match=r"s.toml: .*d.toml: no such file"):
        read_study(path)


def test_the_digest_covers_the_table_of_the_air(tmp_path, designs):
    lander = (designs / "landing.toml").read_text().replace("[beacons]\ndesign", "[beacons]\n#")
    lander = lander.replace("scale_height_km = 7.5", 'scale_height_km = 7.5\ntable = "air.txt"')
    (tmp_path / "lander.toml").write_text(lander)
    path = tmp_path / "s.toml"
    path.write_text(GOOD + '[entry]\nscenario = "lander.toml"\n')
    found = set()
    for density in (2e-2, 2e-2, 1e-2):
        (tmp_path / "air.txt").write_text(f"0, {density}\n50, 1e-4\n130, 1e-9\n")
        found.add(read_study(path).digest)
    assert len(found) == 2


def test_entry_takes_a_scenario(designs):
    text = GOOD.replace(
        '[[objective]]\nfigure = "satellites"', '[[objective]]\nfigure = "crlb_position_m.p95"'
    )
    with pytest.raises(DesignError, match=r"without judging entries; add a table \[entry\]"):
        read_study_text(text)
    text += '[entry]\nscenario = "entry-compass.toml"\nsamples = 3\nfinalists = 2\n'
    entry = read_study_text(text, folder=designs).entry
    assert (entry.samples, entry.finalists) == (3, 2) and entry.scenario.name
    assert entry.doubts == Doubts()  # as the judge takes them
    own = text + "clock_m = 0\nclock_drift_m_s = 0\norbit_m = [1, 2, 3]\n"
    known = read_study_text(own, folder=designs)
    assert known.entry.doubts == Doubts(0.0, 0.0, (1.0, 2.0, 3.0))
    assert known.digest != read_study_text(text, folder=designs).digest
    with pytest.raises(DesignError, match=r"study: entry: clock_m = 0, clock_drift_m_s = 0\.3"):
        read_study_text(text + "clock_m = 0\n", folder=designs)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "satellites = 5",
            "satellites = []",
            r"satellites = \[\]: must have at least 1 value; a list",
        ),
        ("satellites = 5", "satellites = true", r"satellites = true: must be a number, a list"),
        ("satellites = 5", "satellites = [0]", r"study.satellites = 0: allowed 1 to 10000"),
        ("satellites = 5", "satellites = {least = 9}", r"study.satellites.most: missing"),
        ("satellites = 5", "satellites = {least = 9, most = 3}", "least is above most"),
        ("satellites = 5", 'satellites = "5"', "study.satellites"),
        ("satellites = 5", "satellites = {values = [5], step = 2}", "values or step, not both"),
        ("step = 5 }", "step = 1e-6 }", "take a larger step"),
        ("step = 5 }", "step = 0 }", "must be above 0"),
        (", step = 5", "", "a range without step is free"),
        ("most = 50", "most = 200", "allowed 0 to 180"),
        ("most = 50", 'most = "x"', "must be a number"),
        (
            'orbits = ["areosynchronous", "half", "third"]',
            "radius_km = 3000",
            "above the surface .3396",
        ),
        ('orbits = ["areosynchronous", "half", "third"]', "", "found neither"),
        ("[[constraint]]", "[sampling]\nmethod = 3\n[[constraint]]", "sampling.method = 3"),
        ("[[constraint]]", "[sampling]\nsamples = 9\n[[constraint]]", 'not for method = "grid"'),
        (
            "[[constraint]]",
            '[sampling]\nmethod = "sobol"\nsamples = 9\n[[constraint]]',
            "use 8 or 16",
        ),
        (
            "[[constraint]]",
            '[sampling]\nmethod = "nsga2"\n[[constraint]]',
            "sampling.population: missing",
        ),
        ("at_least = 1", "", r"constraint\[1\]: needs exactly one of .* found none"),
        ("at_least = 1", "at_least = 1\nabove = 0", "found at_least and above"),
        ('"satellites"', '"satelites"', "no candidate has this figure; did you mean satellites"),
        ('"satellites"', "7", r"objective\[1\].figure = 7: must be text"),
        ('"mask_margin_deg"', '"satellites"', "is an objective already"),
    ],
)
def test_faults(old, new, message):
    assert old in GOOD
    with pytest.raises(DesignError, match=message):
        read_study_text(GOOD.replace(old, new, 1))


@pytest.mark.parametrize(
    ("given", "field", "message"),
    [
        ("satellites = nan", "satellites[1]", "must be a whole number"),
        ("satellites = -1", "satellites", "allowed 1 to 10000"),
        (f"satellites = {10**400}", "satellites", "allowed 1 to 10000"),
        ("satellites = [5, 1.5]", "satellites[2]", "must be a whole number"),
        ("satellites = {least = 1.5, most = 5}", "satellites.least", "must be a whole number"),
        ("satellites = {least = 1, most = 20000}", "satellites.most", "allowed 1 to 10000"),
        ('satellites = "x"', "satellites", "must be a number, a list of them or a range"),
        ("satellites = 5\nphasing = [0, -1]", "phasing", "allowed 0 to 10000"),
        ("satellites = 5\nmask_deg = nan", "mask_deg[1]", "must be a finite number"),
        ("satellites = 5\nmask_deg = [inf]", "mask_deg[1]", "must be a finite number"),
        (
            "satellites = 5\nmask_deg = {least = 0, most = nan, step = 1}",
            "mask_deg.most",
            "must be a finite number",
        ),
    ],
)
def test_one_mistake_is_said_once_and_where_it_was_made(given, field, message):
    with pytest.raises(DesignError) as caught:
        read_study_text(GOOD.replace("satellites = 5", given))
    (fault,) = caught.value.faults
    assert fault.startswith(f"study: study.{field} = ") and message in fault


def test_entries_are_no_more_than_can_be_drawn(designs):
    text = GOOD + '[entry]\nscenario = "landing.toml"\n'
    for key in ("samples", "finalist_samples"):
        read_study_text(f"{text}{key} = {MOST_SAMPLES}\n", folder=designs)
        with pytest.raises(DesignError, match=f"entry.{key} = 8193: must be at most 8192"):
            read_study_text(f"{text}{key} = 8193\n", folder=designs)


def test_faults_of_both_files_that_it_names(designs):
    text = GOOD + '[entry]\nscenario = "compass-15-5-1.toml"\n[compare]\ndesign = "no.toml"\n'
    with pytest.raises(DesignError) as caught:
        read_study_text(text, folder=designs)
    scenario, design = caught.value.faults
    assert scenario.startswith("study: entry.scenario: ") and "is a design" in scenario
    assert design.startswith("study: compare.design: ") and "no such file" in design


def test_all_faults_at_once():
    text = GOOD.replace("satellites = 5", "satellites = 0").replace('"gdop_p95"', '"gdop"')
    with pytest.raises(DesignError) as caught:
        read_study_text(text, "s.toml")
    assert len(caught.value.faults) == 2
    assert all(fault.startswith("s.toml: ") for fault in caught.value.faults)


def test_faults_of_what_is_no_table():
    with pytest.raises(DesignError, match="study"):
        read_study_text('name = "t"\nstudy = 3\nsampling = 4\nobjective = 5\n')


def test_every_merit_belongs_to_a_stage():
    assert {m.stage for m in MERITS.values()} == set(STAGES)
    assert sum(len(merits_of(stage)) for stage in STAGES) == len(MERITS)


def test_a_figure_of_merit_is_one_record(monkeypatch, designs):
    """One more record, worked out of what its stage knows, and studies take it as any other."""
    from compass.quantities import merits
    from compass.study.candidates import batches, candidates
    from compass.study.cost import cost_figures

    record = merits.Merit(
        merits.Quantity("delta_v_a_plane_m_s", "m s-1", "delta-v of a plane", 4, "less"),
        "cost",
        of=lambda k: k["satellites"] / k["planes"] * k["delta_v_transfer_m_s"],
    )
    monkeypatch.setitem(merits.MERITS, "delta_v_a_plane_m_s", record)
    text = (designs / "study-small.toml").read_text()
    study = read_study_text(text.replace('"gdop_p95"', '"delta_v_a_plane_m_s"'), folder=designs)
    assert study.objectives[-1].figure == "delta_v_a_plane_m_s" and study.objectives[-1].sign == 1
    rows = next(batches(candidates(study), 1000))
    found = cost_figures(rows, study.cost, study.figure.equatorial_radius)
    one_plane = found["delta_v_transfer_m_s"] * rows["satellites"] / rows["planes"]
    assert found["delta_v_a_plane_m_s"] == pytest.approx(one_plane)
