import pytest

from compass.coverage.geometry import pattern_geometry
from compass.papers import kelly2018, kelly2018_geometry
from compass.papers.verdict import Row, compare, judge_claim, printed_tolerance


@pytest.mark.parametrize(
    ("printed", "half_unit"),
    [("3.3962e3", 0.05), ("15", 0.5), ("80.43", 0.005), ("1.60e6", 5000.0)],
)
def test_tolerance_is_half_a_unit_of_the_last_printed_digit(printed, half_unit):
    assert printed_tolerance(printed) == pytest.approx(half_unit, rel=1e-4)


def test_verdicts():
    assert compare("x", "T", "1.5", 1.54).verdict == "reproduced"
    assert compare("x", "T", "1.5", 1.56).verdict == "differs: no reason on record"
    row = compare("x", "T", "1.5", 2.0, erratum="misprint")
    assert (row.verdict, row.reason, row.difference) == ("erratum: misprint", "misprint", 0.5)
    assert row.holds
    assert not compare("x", "T", "1.5", 2.0).holds
    assert judge_claim("x", "T", "always", "never", "", False, "no").verdict == "erratum: no"
    assert Row("x", "T", "always", 3, "", "reproduced").difference is None
    assert Row("x", "T", None, 3, "", "not printed").difference is None


@pytest.fixture(scope="module")
def rows():
    return {row.item: row for row in kelly2018.rows()}


@pytest.mark.slow
def test_every_row_of_the_paper_is_explained(rows):
    assert len(rows) >= 45
    assert all(row.holds for row in rows.values())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("item", "computed", "rel", "verdict"),
    [
        # independently computed values of the specification, to the digits given there
        ("Cap area A_max", 6.042224e7, 1e-7, "erratum"),
        ("Cap area by the printed eq. 4", 7.14697e7, 1e-6, "reproduced"),
        ("Cap share of the planet", 41.6870, 1e-6, "erratum"),
        ("Gap triangle area", 1.680403e6, 1e-6, "erratum"),
        ("Gap triangle area, flat", 1.672201e6, 1e-6, "reproduced"),
        ("Gap triangle depth l", 567.288, 1e-6, "erratum"),
        ("Gap triangle base Q", 1965.142, 1e-6, "erratum"),
        ("Limiting circumference C_lim", 9825.71, 1e-6, "reproduced"),
        ("C_gap by the printed eq. 9", 13195.2, 1e-5, "reproduced"),
        ("C_gap, length of that parallel", 12370.2, 1e-5, "erratum"),
        ("Constellation's served share", 625.30, 1e-5, "erratum"),
        ("Total share of gaps", 11.59, 1e-3, "erratum"),
        ("Tangent distance s", 20142.695, 1e-7, "reproduced"),
        ("Coverage depth d", 2831.547, 1e-6, "reproduced"),
        ("Maximum coverage radius h", 3348.931, 1e-6, "erratum"),
        ("Fewest satellites in view anywhere", 4, 0, "reproduced"),
        ("Most satellites in view anywhere", 9, 0, "not printed"),
        ("Fewest satellites in view inside a gap", 4, 0, "reproduced"),
        ("Most satellites in view inside a gap", 6, 0, "erratum"),
    ],
)
def test_numbers_of_the_specification(rows, item, computed, rel, verdict):
    assert rows[item].computed == pytest.approx(computed, rel=rel)
    assert rows[item].verdict.startswith(verdict)


def test_another_constellation_differs_from_the_paper(seed_design):
    from compass import walker_delta

    other = pattern_geometry(
        walker_delta(12, 4, 1, inclination_deg=40.1, radius_km=18000), 3396.2e3
    )
    assert any(not row.holds for row in kelly2018_geometry.geometry_rows(other))
    single = pattern_geometry(
        walker_delta(4, 4, 1, inclination_deg=40.1, radius_km=18000), 3396.2e3
    )
    assert kelly2018_geometry.geometry_rows(single) == []
