"""What a newcomer starts from: commented files, schemas, and hints that are near."""

import json
import re
import tomllib
from datetime import datetime

import pytest

import compass
from compass.errors import ArgumentError, DesignError, OutputError, near
from compass.inputs.commented import Key
from compass.inputs.reading import tables
from compass.inputs.shipped import MODELS, companions, names, starter
from compass.inputs.study import read_study

READERS = {
    "design": compass.read_design,
    "scenario": compass.read_scenario,
    "study": read_study,
}
SHIPPED = [(kind, name) for kind in MODELS for name in names(kind)]


@pytest.mark.parametrize(("kind", "name"), [*((kind, None) for kind in MODELS), *SHIPPED])
def test_a_new_file_says_what_its_source_says_and_runs(kind, name, tmp_path):
    made = compass.new(kind, like=name)
    path = tmp_path / "own.toml"
    assert made.write(path)[0] == path
    origin = starter(kind) if name is None else tmp_path.joinpath("own.toml")
    assert tables(path) == tables(origin)
    if name is not None:
        from compass.inputs.shipped import folder

        assert tables(path) == tables(folder() / f"{name}.toml")
    READERS[kind](path)


@pytest.mark.parametrize("kind", MODELS)
def test_every_key_stands_in_a_new_file(kind):
    text = compass.new(kind).text

    def missing(model):
        for name, field in model.model_fields.items():
            key = Key(name, field)
            written = rf"\[{name}\]|\.{name}\]" if key.models else rf"^(# )?{name} = "
            if not re.search(written, text, re.MULTILINE):
                yield name
            for inner in key.models:
                yield from missing(inner)

    assert list(missing(MODELS[kind])) == []


def test_ranges_defaults_and_choices_are_said():
    text = compass.new("design").text
    assert re.search(r'# latitude_kind = "planetocentric" .*one of "planetocentric", "plan', text)
    assert re.search(r"# required_cn0_dbhz = 30.0 .*from -50 to 200", text)
    assert re.search(r"fold = 4 .*from 1 to 1000", text)
    assert "# epoch = <2030-01-01T00:00:00>" in text


def test_a_name_that_is_not_there_is_answered_with_near_ones():
    with pytest.raises(ArgumentError, match="did you mean compass-15-5-1"):
        compass.new("design", like="compas-15-5-1")
    with pytest.raises(ArgumentError, match=r"is a scenario of landing, not a design"):
        compass.new("design", like=starter("scenario"))
    with pytest.raises(ArgumentError, match="kind = 'planet': allowed: design"):
        compass.new("planet")
    with pytest.raises(DesignError, match="no such file"):
        compass.new("design", like="none.toml")


def test_files_that_a_new_one_names_are_beside_it(tmp_path):
    made = compass.new("study", like="study-fourfold")
    assert [path.name for path in made.companions] == ["compass-15-5-1.toml", "landing.toml"]
    (tmp_path / "landing.toml").write_text("mine")
    with pytest.raises(OutputError, match=r"landing\.toml: is there already, and says something"):
        made.write(tmp_path / "x.toml")
    assert [path.name for path in tmp_path.iterdir()] == ["landing.toml"]
    (tmp_path / "x.toml").write_text("mine")
    with pytest.raises(OutputError, match="give a new name"):
        made.write(tmp_path / "x.toml")
    assert companions(tmp_path / "landing.toml") == []  # no TOML names nothing
    (tmp_path / "a.oem").write_text("states")
    (tmp_path / "flown.toml").write_text('files = ["*.oem"]\nsource = "none * at all"')
    assert companions(tmp_path / "flown.toml") == [tmp_path / "a.oem"]


def test_what_is_mostly_no_table_is_offered_by_its_name(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text('name = "x"\n[study]\nsatelites = [4]\n[objectve]\n')
    with pytest.raises(DesignError) as error:
        compass.read_study(path)
    assert "study.satelites = [4]: unknown key; did you mean satellites?" in str(error.value)
    assert "did you mean [[objective]]?" in str(error.value)


def test_schemas_beside_the_shipped_files_are_those_of_the_models():
    from compass.inputs.shipped import folder

    for kind in MODELS:
        written = json.loads((folder() / "schema" / f"{kind}.json").read_text())
        assert written == compass.schema(kind).to_dict(), f"compass schema {kind} > designs/schema"
    for kind, name in SHIPPED:
        first = (folder() / f"{name}.toml").read_text().split("\n")[0]
        assert first == f"#:schema schema/{kind}.json"


def test_shipped_files_obey_their_schemas():
    jsonschema = pytest.importorskip("jsonschema")
    from compass.inputs.shipped import folder

    for kind, name in SHIPPED:
        raw = tomllib.loads((folder() / f"{name}.toml").read_text())
        plain = json.loads(json.dumps(raw, default=datetime.isoformat))
        checker = jsonschema.Draft202012Validator(compass.schema(kind).to_dict())
        assert [error.message for error in checker.iter_errors(plain)] == []
        assert not checker.is_valid({**plain, "nmae": "x"})
        assert kind != "design" or not checker.is_valid({**plain, "epoch": "2030-01-01T00:00:00Z"})
        # editors assert formats too, and "date-time" wants the zone that an epoch in TDB has not
        assert '"format"' not in json.dumps(checker.schema)


def test_only_near_names_are_offered():
    assert near("satelites", ["satellites", "planes"]) == ["satellites"]
    assert near("stations", ["satellite", "planes", "rotation"]) == []


def test_a_table_of_several_is_offered_for_one_of_nearly_its_name(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text('name = "x"\n[beacons]\nlatitude_deg = 3\n[statoin]\n')
    with pytest.raises(DesignError) as error:
        compass.read_scenario(path)
    said = str(error.value)
    assert "beacons.latitude_deg = 3: unknown key; [[beacon]] has it; did you mean that?" in said
    for table in ("vehicle", "entry", "measurements", "filter"):
        assert f"{table}: missing" in said
    path.write_text('name = "x"\n[[sttion]]\n')
    with pytest.raises(DesignError, match=r"did you mean \[\[station\]\]\?"):
        compass.read_design(path)


def test_commands_print_and_write(run, tmp_path):
    code, out, err = run("new", "design")
    assert (code, err) == (0, "") and tomllib.loads(out) == tables(starter("design"))
    code, out, err = run("new", "scenario", "--from", "landing")
    assert code == 0 and "it names compass-15-5-1.toml" in err
    assert run("new", "scenario", "--from", "landing", "-q")[2] == ""
    code, out, err = run("new", "study", "-o", tmp_path / "s.toml", "--json")
    assert code == 0 and json.loads(out)["kind"] == "study" and "wrote" in err
    assert run("new", "study", "-o", tmp_path / "s.toml")[0] == 2
    code, out, err = run("schema", "design")
    assert code == 0 and json.loads(out) == compass.schema("design").to_dict()
    code, out, err = run("version")
    assert code == 0 and out.startswith(f"compass: {compass.__version__}")
    assert "numpy" in json.loads(run("version", "--json")[1])["packages"]


def test_they_show_themselves():
    assert "needed" in compass.schema("study")._repr_html_()
    assert "[constellation]" in compass.new("design")._repr_html_()


def test_what_is_not_installed_has_no_version(monkeypatch):
    monkeypatch.setattr("compass.api.version.PACKAGES", ("numpy", "no-such-package"))
    assert list(compass.version().packages) == ["numpy"]


def test_what_is_refused_is_shown_as_a_file_has_it(tmp_path):
    path = tmp_path / "own.toml"
    path.write_text(
        'name = "x"\n[constelation]\npattern = "walker-delta"\nopen = [true, { at = 1 }]\n'
    )
    with pytest.raises(DesignError) as refused:
        compass.read_design(path)
    said = str(refused.value)
    assert "constelation = { pattern = 'walker-delta', open = [true, { at = 1 }" in said
    assert "did you mean [constellation]?" in said and "True" not in said
