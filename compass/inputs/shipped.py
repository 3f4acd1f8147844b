"""The designs, scenarios and studies that come with the package, and the starters of each kind."""

from pathlib import Path

from pydantic import BaseModel

from compass.errors import ArgumentError, meant
from compass.inputs.models import DesignFile
from compass.inputs.reading import KINDS, named_files, tables
from compass.inputs.scenario_models import ScenarioFile
from compass.inputs.study_models import StudyFile

#: What each kind of file must say, and the table it is known by.
MODELS: dict[str, type[BaseModel]] = {
    "design": DesignFile,
    "scenario": ScenarioFile,
    "study": StudyFile,
}
_TABLES = {"design": "constellation", "scenario": "vehicle", "study": "study"}


def model_of(kind: str) -> type[BaseModel]:
    """Return the model of a kind of file.

    Raises
    ------
    ArgumentError
        There is no such kind.
    """
    if kind not in MODELS:
        raise ArgumentError(f"kind = {kind!r}: allowed: {', '.join(MODELS)}")
    return MODELS[kind]


def folder() -> Path:
    """Where the shipped files are: in the installed package, or beside it in a clone."""
    package = Path(__file__).parents[1]
    installed = package / "designs"
    return installed if installed.is_dir() else package.parent / "designs"


def starter(kind: str) -> Path:
    """Return the file to start from where none is named."""
    return Path(__file__).parent / "starters" / f"{kind}.toml"


def source(kind: str, name: str | Path | None) -> Path:
    """File to make a new one of a kind from: a shipped one by its name, or any by its path.

    Raises
    ------
    ArgumentError
        There is none of that name, or it is of another kind.
    """
    if name is None:
        return starter(kind)
    path = Path(name)
    if path.suffix != ".toml":
        path = folder() / f"{name}.toml"
        if not path.is_file():
            known = names(kind)
            guess = meant(str(name), known)
            raise ArgumentError(
                f"from = {str(name)!r}: no {kind} comes with compass under this name; {guess}"
                f"give the path of a .toml file, or one of {', '.join(known)}"
            )
    if _TABLES[kind] not in (raw := tables(path)):
        is_a = next((KINDS[t] for t in KINDS if t in raw), "of no kind")
        raise ArgumentError(f"from = {str(name)!r}: is {is_a}, not {KINDS[_TABLES[kind]]}")
    return path


def names(kind: str) -> list[str]:
    """Names of the shipped files of a kind."""
    files = sorted(folder().glob("*.toml"))
    return [path.stem for path in files if _TABLES[kind] in tables(path)]


def of_paper(paper: str) -> list[str]:
    """Names of the shipped designs and scenarios that a source paper proposes."""
    files = sorted(folder().glob("*.toml"))
    return [path.stem for path in files if tables(path).get("paper") == paper]


def companions(path: Path) -> list[Path]:
    """Return the files beside `path` that it names, and those that these name in turn."""
    return [other for other in named_files(path) if other.parent == path.parent]
