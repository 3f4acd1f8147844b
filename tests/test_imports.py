"""What is imported when: a fresh process lists it, so that a new heavy import is noticed."""

import ast
import json
import pkgutil
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import compass

ROOT = "designs/compass-15-5-1.toml"
#: Reads every shipped file: designs on real orbits, scenarios with a tabulated air, studies.
READ_ALL = """
import compass, pathlib
for path in sorted(pathlib.Path("designs").glob("*.toml")):
    text = path.read_text()
    is_study, is_scenario = "[study]" in text, "[vehicle]" in text
    compass.read_design(path) if not (is_study or is_scenario) else (
        compass.read_study(path) if is_study else compass.read_scenario(path)
    )
"""
#: Those of other people that take long to load.
HEAVY = {
    "numba", "erfa", "scipy.optimize", "scipy.integrate", "xarray", "pandas", "matplotlib",
    "scipy.linalg", "shapely", "pyproj", "h5netcdf", "dask", "dask.array", "pymoo", "jinja2",
    "pydantic", "numpy",
}  # fmt: skip


def loaded(designs, code):
    """Which of the heavy ones are loaded once the code has run."""
    script = f"{code}\nimport sys, json\nprint()\nprint(json.dumps(sorted(sys.modules)))"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True,
        cwd=designs.parent,
    )  # fmt: skip
    return HEAVY & set(json.loads(done.stdout.splitlines()[-1]))


@pytest.mark.parametrize(
    ("code", "allowed"),
    [
        ("import compass", set()),
        ("import compass; dir(compass)", set()),
        (f"import compass; compass.read_design({ROOT!r})", {"numpy", "pydantic"}),
        (f"import compass; compass.show({ROOT!r}).to_dict()", {"numpy", "pydantic"}),
        (READ_ALL, {"numpy", "pydantic"}),
        (
            "import compass; compass.walker_delta(15, 5, 1, inclination_deg=45, radius_km=20427)",
            {"numpy"},
        ),
    ],
    ids=["import", "names", "read", "show", "read all", "pattern"],
)
def test_only_what_is_needed_is_loaded(designs, code, allowed):
    assert loaded(designs, code) <= allowed


def bound(statements):
    """Public names that statements at the top of a file bind."""
    for statement in statements:
        if isinstance(statement, ast.ImportFrom | ast.Import):
            names = (each.asname or each.name for each in statement.names)
        elif isinstance(statement, ast.FunctionDef | ast.ClassDef):
            names = (statement.name,)
        elif isinstance(statement, ast.Assign | ast.AnnAssign):
            targets = getattr(statement, "targets", None) or [statement.target]
            names = (each.id for each in targets if isinstance(each, ast.Name))
        else:
            continue
        yield from (name for name in names if not name.startswith("_"))


@pytest.mark.parametrize(
    "package",
    sorted(Path(compass.__file__).parent.rglob("__init__.py"))[1:],
    ids=lambda file: file.parent.name,
)
def test_a_package_that_gives_names_lists_them(package):
    """Most give none: their modules are asked themselves."""
    given = set(bound(ast.parse(package.read_text()).body))
    parts = package.relative_to(Path(compass.__file__).parent.parent).parent.parts
    module = import_module(".".join(parts))
    listed = list(getattr(module, "__all__", ()))
    assert len(set(listed)) == len(listed)
    assert bool(listed) == bool(given), "names without __all__"
    for name in listed:
        assert getattr(module, name) is not None


def stands(reference):
    """Whether what a dotted name says is there, a field of a class among it."""
    module, names = reference.split("."), []
    while True:
        try:
            held = import_module(".".join(module))
            break
        except ModuleNotFoundError:
            names.insert(0, module.pop())
    for name in names:
        if name in getattr(held, "__annotations__", {}):
            return True
        if not hasattr(held, name):
            return False
        held = getattr(held, name)
    return True


def test_what_words_refer_to_is_where_they_say(designs):
    """Names in backticks, whole, in docstrings and in documents but that of what has changed."""
    root = designs.parent
    documents = [root / "README.md", root / "CONTRIBUTING.md"]
    files = [*documents, *root.glob("docs/**/*.md"), *root.glob("compass/**/*.py")]
    named = {
        (name, file.relative_to(root))
        for file in files
        for name in re.findall(r"`(compass(?:\.\w+)+)`", file.read_text())
    }
    assert len(named) > 100
    assert [one for one in sorted(named) if not stands(one[0])] == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("code", "allowed"),
    [
        (f"compass.fold({ROOT!r}).to_dict()", {"numba"}),
        (
            f"compass.map({ROOT!r}, step_deg=30, epochs=2).to_dict()",
            # xarray asks whether Dask is installed, and needs no more of it
            {"numba", "xarray", "pandas", "h5netcdf", "jinja2", "dask"},
        ),
    ],
    ids=["fold", "map"],
)
def test_a_command_loads_no_drawing(designs, code, allowed):
    assert loaded(designs, f"import compass; {code}") <= {"numpy", "pydantic", *allowed}


@pytest.mark.slow
def test_neither_text_nor_json_of_a_landing_waits_for_pictures(designs):
    """Landing, best beacons and ranking: with a notebook's backend that is not installed here."""
    code = """
import os; os.environ["MPLBACKEND"] = "module://not_installed.backend"
import compass
from dataclasses import replace
done = [compass.land("designs/entry-compass.toml", runs=2)]
scenario = compass.read_scenario("designs/entry-ground-beacons.toml")
task = scenario.optimize.model_copy(update={"what": "directions", "starts": 2})
done.append(compass.optimize(replace(scenario, optimize=task)))
lander = "designs/landing.toml"
done.append(compass.judge("designs/walker-15-15-6.toml", scenario=lander, samples=2, finalists=0))
for result in done:
    str(result), result.to_dict()
"""
    assert not loaded(designs, code) & {"matplotlib", "shapely", "pyproj", "pymoo"}


def test_no_public_name_is_that_of_a_subpackage():
    """Such a name would become the module once anyone imports it."""
    modules = {module.name for module in pkgutil.iter_modules(compass.__path__)}
    assert not modules & set(compass.__all__)


def test_every_public_name_is_there_and_listed():
    for name in compass.__all__:
        assert getattr(compass, name) is not None
    assert set(dir(compass)) == set(compass.__all__)
    with pytest.raises(AttributeError, match="no attribute 'fly'"):
        compass.fly  # noqa: B018


def test_a_misspelt_public_name_is_answered_with_the_one_meant():
    with pytest.raises(AttributeError, match=r"'fodl'; did you mean compass\.fold\?$"):
        getattr(compass, "fodl")  # noqa: B009, mypy knows that it is not there
    with pytest.raises(AttributeError, match=r"no attribute 'xyzzy'$"):
        getattr(compass, "xyzzy")  # noqa: B009


def test_packages_list_what_they_offer():
    for file in sorted(Path(compass.__path__[0]).rglob("__init__.py")):
        tree = ast.parse(file.read_text())
        names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)} | {
            alias.asname or alias.name
            for node in tree.body if isinstance(node, ast.ImportFrom)
            for alias in node.names
        }  # fmt: skip
        assert not names or "__all__" in names, file


def test_type_checkers_see_every_public_name(tmp_path):
    from importlib.resources import files

    assert files("compass").joinpath("py.typed").is_file()
    source = files("compass").joinpath("__init__.py").read_text()
    block = source[source.index("if TYPE_CHECKING:") : source.index("__version__")]
    for name in set(compass.__all__) - {"__version__"}:
        assert name in block, name
