"""What a text in a file may hold: any letter, and nothing that a terminal or a format obeys."""

import unicodedata

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compass.errors import DesignError
from compass.inputs import read_design_text
from compass.inputs.scenario import read_scenario_text
from compass.inputs.study import read_study_text

CONTROL = [chr(k) for k in range(0x100) if unicodedata.category(chr(k)) == "Cc"]

DESIGN = """name = "{}"
[constellation]
pattern = "walker-delta"
satellites = 4
planes = 2
phasing = 0
inclination_deg = 55
altitude_km = 17000
[[station]]
name = "{}"
latitude_deg = 0
longitude_deg = 0
"""


def escaped(letter):
    return f"\\U{ord(letter):08x}"


def test_there_are_65_control_characters():
    assert len(CONTROL) == 65


@pytest.mark.parametrize("letter", CONTROL)
def test_a_control_character_is_refused_wherever_a_text_is(letter):
    text = f"a{escaped(letter)}b"
    for given_text, field in (
        (DESIGN.format(text, "x"), "name"), (DESIGN.format("x", text), "station[1].name"),
    ):  # fmt: skip
        with pytest.raises(DesignError) as error:
            read_design_text(given_text, "d.toml")
        (fault,) = error.value.faults
        assert fault.startswith(f"d.toml: {field} = ")
        assert f"has the control character U+{ord(letter):04X}; leave it out" in fault
        assert fault.isprintable()


def test_in_scenarios_and_studies_too(designs):
    for read, name in (
        (read_scenario_text, "landing.toml"), (read_study_text, "study-small.toml"),
    ):  # fmt: skip
        text = (designs / name).read_text()
        schema, first, rest = text.split("\n", 2)
        assert schema.startswith("#:schema ") and first.startswith("name = ")
        with pytest.raises(DesignError, match=r"control character U\+001B"):
            read(f'name = "a\\u001b[31m"\n{rest}', name, designs)


@settings(max_examples=50)
@given(st.text(st.characters(exclude_categories=["Cc", "Cs"]), min_size=1, max_size=50))
def test_every_other_letter_is_kept(name):
    text = "".join(map(escaped, name))
    design = read_design_text(DESIGN.format(text, text))
    assert design.name == name and design.stations[0].name == name


def test_a_source_may_have_lines():
    assert read_design_text('source = "a\\n\\tb"\n' + DESIGN.format("x", "x")).source == "a\n\tb"
