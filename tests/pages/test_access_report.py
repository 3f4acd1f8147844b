"""The access section of a report."""

from dataclasses import replace

import pytest

import compass
from compass.bodies import SOLAR_DAY
from compass.errors import ArgumentError
from compass.inputs import read_design
from compass.links import Radio, Wanted
from compass.orbits import keplerian
from compass.pages.access import access_section
from compass.pictures.access import MAX_ROWS


@pytest.fixture(scope="module")
def design():
    return replace(
        read_design("designs/compass-15-5-1.toml"),
        access=Wanted(("phobos",), True, False),
        access_duration=1.5 * SOLAR_DAY.value,
    )


def test_every_node_has_its_timeline(design):
    radios = (Radio(("station", "satellite"), 4e8, 7.0, -15.0, 45.0),)
    section = access_section(compass.access(replace(design, radios=radios), eclipse=True))
    stems = [p.stem for p in section.pictures]
    assert stems == [
        "access-north-pole",
        "access-equator-0-e",
        "access-equator-180-e",
        "access-phobos",
        "access-earth",
        "access-link-station-satellite-400",
    ]
    assert all(p.drawn.startswith((b"\x89PNG", b"<svg")) for p in section.pictures)
    assert [t.title for t in section.tables] == [
        "Satellites in sight",
        "Reaching the Earth",
        "In Mars's shadow",
        "Radio links along their windows",
    ]
    for table in section.tables:
        assert all(len(row) == len(table.header) for row in table.rows)
    assert "North pole sees 15 of 15 satellites" in section.paragraphs[0]
    assert any("a message passes without waiting, always" in text for text in section.paragraphs)


def test_a_large_constellation_is_cut_and_said_so(design):
    many = keplerian(1e7, 0.0, 0.5, [0.1 * k for k in range(MAX_ROWS + 3)], 0.0, 0.0)
    crowd = replace(
        design, constellation=many, stations=design.stations[:1], access=Wanted(),
        access_duration=0.1 * SOLAR_DAY.value,
    )  # fmt: skip
    section = access_section(compass.access(crowd))
    assert f"The first {MAX_ROWS} of {MAX_ROWS + 3} satellites" in section.pictures[0].caption


def test_a_node_that_sees_nothing_has_no_empty_picture(design):
    equator = keplerian(2.0427e7, 0.0, 0.0, [0.0, 2.1, 4.2], 0.0, 0.0)
    blind = replace(design, constellation=equator, access=Wanted(), access_duration=SOLAR_DAY.value)
    section = access_section(compass.access(blind))
    assert "North pole never sees a satellite" in section.paragraphs[0]
    assert {p.stem for p in section.pictures} == {"access-equator-0-e", "access-equator-180-e"}


def test_a_timeline_on_given_or_new_axes(design):
    found = compass.access(replace(design, access=Wanted()))
    axes = found.plot()
    assert axes.get_title().startswith("Satellites in sight of ")
    assert found.plot(axes=axes) is axes
    with pytest.raises(ArgumentError, match="name = 'Moon': no such node; allowed North pole"):
        found.plot("Moon")
