"""``[[requirement]]`` tables: what they become, and what is refused."""

import numpy as np
import pytest

from compass.errors import DesignError
from compass.inputs import read_design_text
from compass.inputs.requirements import RequirementTable

DESIGN = """
name = "three"
[constellation]
pattern = "walker-delta"
satellites = 3
planes = 1
phasing = 0
inclination_deg = 0
{orbit}
[coverage]
mask_deg = 5
[[station]]
name = "Gale"
latitude_deg = -4.6
longitude_deg = 137.4
horizon_deg = [[0, 0], [180, 20]]
{more}
"""


def design(more, orbit="radius_km = 20000"):
    return read_design_text(DESIGN.format(more=more, orbit=orbit))


def faults(more):
    with pytest.raises(DesignError, match="design") as caught:
        design(more)
    return "\n".join(caught.value.faults)


def test_all_keys_arrive_in_si_and_words():
    (one,) = design(
        '[[requirement]]\nname = "shell"\nregion = ["lat:-45:45", "polygon:0,0;0,9;9,0"]\n'
        "fold = 5\nmask_deg = -3\npdop_at_most = 6\ntdop_at_most = 2.5\nshare = 0.95\n"
        'share_of = "area-time"\naltitude_km = 400\nlosses = 1\nbeam_deg = 20\n'
    ).requirements
    assert (one.fold, one.share, one.share_of, one.losses) == (5, 0.95, "area-time", 1)
    assert one.mask == pytest.approx(np.radians(-3))
    assert (one.altitude, one.limits) == (4e5, (("pdop", 6.0), ("tdop", 2.5)))
    assert one.claim == (
        "5 satellites and PDOP at most 6 and TDOP at most 2.5 without any 1, for 95 % of area and "
        "time, 45° S to 45° N, polygon:0,0;0,9;9,0, 400 km above the ground, in beams of 20 deg"
    )


def test_sites_are_stations_and_without_a_place_it_is_the_globe():
    first, second = design(
        '[[requirement]]\nsites = ["Gale"]\nfold = 1\n[[requirement]]\nfold = 2\n'
    ).requirements
    assert first.name == "requirement 1"
    assert first.sites[0].mask.highest == pytest.approx(np.radians(20))
    assert second.claim == "2 satellites, always, all of Mars"


def test_tracks_close_only_if_that_is_said():
    assert design("", 'orbit = "areosynchronous"').constellation.repeat == (1, 1)
    assert design("", "repeat = [4, 2]").constellation.repeat == (2, 1)
    closed = design("", 'orbit = "areosynchronous"').constellation
    radius = float(closed.semi_major_axis[0]) / 1e3
    assert design("", f"radius_km = {radius!r}").constellation.repeat is None
    with pytest.raises(DesignError, match=r"repeat = .30, 1.: so many revolutions need a radius"):
        design("", "repeat = [30, 1]")


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ('sites = ["Jezero"]\nfold = 1', "sites = 'Jezero': no such [[station]]; there are Gale"),
        ('sites = ["gael"]\nfold = 1', "'gael': no such [[station]]; did you mean Gale? there are"),
        ('sites = ["Gale", "Gale"]\nfold = 1', "sites = 'Gale': named twice; leave one out"),
        ('region = ["globe", "globe"]\nfold = 1', "region = 'globe': given twice; leave one out"),
        (
            'region = "polygon:0,0;10,10;0,10;10,0"\nfold = 1',
            "requirement[1].region = polygon: the sides after corners 1 and 3 cross or touch",
        ),
        ('region = "lat:40:10"\nfold = 1', "requirement[1].region = lat:40:10: latitudes must"),
        ("fold = 1\nmask_deg = 95", "requirement[1].mask_deg = 95: must be below 90"),
        ("fold = 1\nmask_deg = -5", "allowed 0 up to below 90 for users on the ground"),
        ("fold = 1\nshare = 1.5", "requirement[1].share = 1.5: must be at most 1"),
        ("fold = 1\nshare = 0", "requirement[1].share = 0: must be above 0"),
        ("pdop_at_most = 0.5", "requirement[1].pdop_at_most = 0.5: must be at least 1"),
        ("mask_deg = 5", "requirement[1]: asks for nothing; add fold or one of pdop_at_most"),
        ('sites = ["Gale"]\nfold = 1\naltitude_km = 3', "sites have their own height_km"),
        (
            "protection_horizontal_m_at_most = 50\nshare = 0.9",
            "requirement[1].protection_horizontal_m_at_most = 50: follows from the errors of ranges",
        ),
        ("fold = 1\nfolds = 2", "requirement[1].folds = 2: unknown key; did you mean fold?"),
        (
            'name = "a"\nfold = 1\n[[requirement]]\nname = "a"\nfold = 2',
            "requirement[2].name = 'a': used twice; rename one",
        ),
    ],
)
def test_faults_name_the_field_and_the_remedy(table, message):
    assert message in faults(f"[[requirement]]\n{table}\n")


#: What no key takes, or only some: of other kinds, endless, next to nothing, huge.
WRONG = (
    "-3", "0", "2.5", "1e400", "nan", "-inf", "true", '""', '"x"', "[]", '["x"]', "[1]", "{ a = 1 }",
    "2020-01-01", "99999999999999999999", "1e-320",
)  # fmt: skip


@pytest.mark.parametrize("key", RequirementTable.model_fields)
def test_any_key_is_read_or_refused_by_its_name(key):
    """Whatever it holds; given twice it is refused by name too, and nothing else is said of it."""
    other = "" if key == "fold" else "fold = 2\n"
    for value in WRONG:
        try:
            read = design(f"[[requirement]]\n{other}{key} = {value}\n")
        except DesignError as error:
            (said,) = error.faults
            assert f": requirement[1].{key}" in said and said.count(":") >= 2
            shown = value.replace('"', "'").replace("1e400", "inf").strip("[]")
            assert shown in said or key == "region"
            assert "must be at least 1.0" not in said and "00.0" not in said
        else:
            assert read.requirements[0].claim
    with pytest.raises(DesignError, match=f"not valid TOML: {key} is given twice"):
        design(f"[[requirement]]\n{other}{key} = 1\n{key} = 1\n")


@pytest.mark.parametrize(
    ("horizon", "message"),
    [
        ("[[0, 12], [90, 112.0]]", "elevations [12.0, 112.0] deg; allowed 0 up to below 90"),
        ("[[0, -1]]", "elevations [-1.0] deg; allowed 0 up to below 90"),
        ("[[0, 12], [0.1, 3], [0.1, 4]]", "azimuths [0.0, 0.1, 0.1] deg; they must increase"),
    ],
)
def test_a_horizon_that_is_none_is_told_as_it_was_written(horizon, message):
    text = DESIGN.format(more="", orbit="radius_km = 20000")
    with pytest.raises(DesignError) as caught:
        read_design_text(text.replace("[[0, 0], [180, 20]]", horizon))
    (said,) = caught.value.faults
    assert said.startswith("design: station[1].horizon_deg: ") and message in said


def test_sites_and_regions_beside_them_all_count():
    (one,) = design(
        '[[requirement]]\nsites = ["Gale"]\nregion = ["lat:0:9", "lat:50:60"]\nfold = 1\n'
    ).requirements
    assert one.where == "Gale, the equator to 9° N, 50° N to 60° N"


def test_an_unknown_site_is_one_fault_wherever_it_is_named():
    known, unknown = '["Gale", "Nowhere"]\nfold = 1', '["Nowhere", "Nowhere", "Else"]\nfold = 2'
    said = faults("".join(f"[[requirement]]\nsites = {s}\n" for s in (known, known, unknown)))
    first, second = said.split("\n")
    assert first.endswith("there are Gale; so in requirement[2] and requirement[3]")
    assert second.endswith("requirement[3].sites = 'Else': no such [[station]]; there are Gale")


def test_levels_follow_from_what_is_promised():
    wanted = "[[requirement]]\nprotection_vertical_m_at_most = 50\nlosses = 1\n"
    signal = "[signal]\nclock_m = 3\nephemeris_m = [2, 8, 5]\nreceiver = { noise_m = 0.5 }\n"
    told = faults(wanted + signal)
    assert "follows from what users are promised; add an [integrity]" in told
    six = DESIGN.replace("satellites = 3", "satellites = 6")
    text = six.format(more=wanted + signal + "[integrity]\n", orbit="radius_km = 20000")
    (read,) = read_design_text(text).requirements
    assert read.limits == (("protection_vertical_m", 50.0),)


def test_a_site_without_any_station_is_told_to_add_one():
    text = DESIGN.format(orbit="radius_km = 20000", more="").partition("[[station]]")[0]
    with pytest.raises(DesignError, match=r"there are none; add a .*station.* of that name"):
        read_design_text(text + '[[requirement]]\nsites = ["Gale"]\nfold = 1\n')
