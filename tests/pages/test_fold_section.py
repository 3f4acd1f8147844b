"""The report's section on exact fold."""

import pytest

import compass
from compass.inputs import read_design_text
from compass.pages.fold import fold_section
from compass.pages.neighbours import _phasings, neighbours

PATTERN = """
name = "small"
[constellation]
pattern = "{pattern}"
satellites = 6
planes = 6
{third}
inclination_deg = 52
radius_km = 20428
[coverage]
fold = {fold}
"""

ELEMENTS = """
name = "two circles"
[constellation]
pattern = "elements"
[[constellation.satellite]]
name = "A"
semi_major_axis_km = 12000
inclination_deg = 60
[[constellation.satellite]]
name = "B"
semi_major_axis_km = 12000
inclination_deg = 60
raan_deg = 20
mean_anomaly_deg = 180
[coverage]
fold = {fold}
"""


def section(text, **values):
    found = compass.fold(read_design_text(text.format(**values)))
    c, sphere = found.design.constellation, found.design.figure.equatorial_radius
    beside = neighbours(c, found.fold, sphere, inclinations=2) if c.pattern else ()
    return fold_section(found, beside, moments=6)


def test_a_proven_design():
    found = section(PATTERN, pattern="walker-delta", third="phasing = 4", fold=1)
    assert "proven" in found.paragraphs[0]
    assert "for all time" in found.paragraphs[0]
    assert [p.stem for p in found.pictures] == [
        "fold-worst-moment",
        "fold-over-time",
        "fold-margin-inclination",
    ]
    assert all(p.drawn.startswith((b"\x89PNG", b"<svg")) for p in found.pictures)
    assert found.tables[0].title.startswith("Fold and margins (proven, ")


@pytest.mark.slow
def test_a_refuted_design_shows_its_witness():
    found = section(PATTERN, pattern="walker-star", third="phasing = 1", fold=4)
    assert "Counter-example" in found.paragraphs[0]
    assert "too few" in found.pictures[0].caption


def test_explicit_orbits_have_no_curve_over_inclination():
    found = section(ELEMENTS, fold=1)
    assert len(found.pictures) == 2


@pytest.mark.slow
def test_ellipses_have_no_shares_and_no_smallest_cap(designs):
    found = fold_section(compass.fold(designs / "draim-four.toml"), moments=6)
    assert "proven" in found.paragraphs[0]
    assert len(found.tables) == 1
    assert len(found.pictures) == 2


def test_neighbours_start_with_the_design():
    from compass.orbits import rosette

    c = rosette(12, 12, 5, inclination_deg=57.3, radius_km=20000)
    near = _phasings(c.pattern)
    assert [p.phasing for p in near] == [5, 4, 6, 3, 7, 2, 8, 1]
    assert {p.kind for p in near} == {"walker-delta"}
