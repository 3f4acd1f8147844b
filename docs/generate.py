"""Pages that the code writes: commands, functions, files, quantities, errata, the gallery."""

import inspect
import os
import re
import sys
from collections.abc import Iterator
from contextlib import chdir
from importlib import import_module
from pathlib import Path
from typing import Any

import click

import compass
from compass.cli.main import program
from compass.inputs.commented import Key
from compass.inputs.shipped import MODELS
from compass.quantities import QUANTITIES

#: Papers whose rows may hold errata; each needs seconds.
PAPERS = ("kelly2018", "ballard1980", "lou2017", "lou2019", "yu2018")


def write_all(docs: Path) -> None:
    """Write every page that is made from the code, and the pictures of the gallery."""
    reference = docs / "reference"
    reference.mkdir(exist_ok=True)
    pages = {
        "commands.md": commands(),
        "functions.md": functions(),
        "files.md": files(),
        "quantities.md": quantities(),
    }
    for name, text in pages.items():
        (reference / name).write_text(text, encoding="utf-8")
    (docs / "why" / "errata.md").write_text(errata(), encoding="utf-8")
    (docs / "gallery.md").write_text(gallery(docs / "gallery"), encoding="utf-8")


def commands() -> str:
    """Help of every command, as the program prints it."""
    context = click.Context(program, info_name="compass")
    parts = ["# Commands\n", _text(program.get_help(context))]
    for name in program.list_commands(context):
        command = program.get_command(context, name)
        assert command is not None
        inner = click.Context(command, info_name=f"compass {name}")
        parts += [f"## compass {name}\n", _text(command.get_help(inner))]
    return "\n".join(parts)


def functions() -> str:
    """Every public name with its signature and its docstring."""
    parts = [
        "# Functions\n",
        "One function a command, and what they take and return; all are names of `compass`.\n",
    ]
    for name in sorted(set(compass.__all__) - {"__version__"}):
        found = getattr(compass, name)
        parts += _entry(name, found)
        if inspect.isclass(found):
            for key, made in vars(found).items():
                if isinstance(made, classmethod) and not key.startswith("_"):
                    parts += _entry(f"{name}.{key}", getattr(found, key))
    return "\n".join(parts)


def _entry(name: str, found: Any) -> list[str]:
    """One public name: its first line, its signature, the rest of its docstring."""
    doc = inspect.cleandoc(found.__doc__ or "")
    try:
        signature = str(inspect.signature(found)).replace('"', "")
    except ValueError:
        signature = ""
    first, _, rest = doc.partition("\n")
    parts = [f"## compass.{name}\n", f"{_prose(first)}\n", _code(f"{name}{signature}")]
    return parts + ([_text(rest.strip("\n"))] if rest.strip() else [])


def files() -> str:
    """Every key of every kind of file, from the models that read them."""
    parts = [
        "# Files\n",
        "Made from the models that read the files; `compass new KIND` writes the same as a "
        "commented file, `compass schema KIND` as JSON Schema.\n",
    ]
    for kind, model in MODELS.items():
        parts.append(f"## {kind}\n")
        for path, table in _tables(model):
            parts.append(f"### {kind}: {path or 'top of the file'}\n" if path else "")
            parts.append("| key | default | meaning |\n| --- | --- | --- |")
            for name, field in table.model_fields.items():
                key = Key(name, field)
                if key.models:
                    continue
                default = "" if key.default in (None, [], {}) else f"`{key.default}`"
                parts.append(f"| `{name}` | {default} | {_prose(key.comment)} |")
            parts.append("")
    return "\n".join(parts)


def _tables(model: type, path: str = "") -> Iterator[tuple[str, type]]:
    yield path, model
    for name, field in model.model_fields.items():
        key = Key(name, field)
        inner = f"{path}.{name}" if path else name
        for table in key.models:
            tag = "" if len(key.models) == 1 else f" ({table.__doc__.rstrip('.')})"
            mark = f"[[{inner}]]" if key.many else f"[{inner}]"
            for deeper, found in _tables(table, inner):
                yield (f"{mark}{tag}" if deeper == inner else deeper), found


def quantities() -> str:
    """Every number that results print: its name in JSON, unit and meaning."""
    parts = [
        "# Quantities\n",
        "Numbers in JSON and in files have these names; in text and on pages the words.\n",
        "| name | words | unit | meaning |\n| --- | --- | --- | --- |",
    ]
    parts += [
        f"| `{q.name}` | {_prose(q.title)} | {q.shown_unit} | {_prose(q.meaning)} |"
        for q in QUANTITIES.values()
    ]
    return "\n".join([*parts, ""])


def errata() -> str:
    """Where the printed papers are shown to be wrong, from the rows that show it."""
    parts = [
        "# Published against exact\n",
        "Where a source's formula or number is wrong, the exact one is used, and the printed one "
        "is kept under a name that says so. Each row is computed when this page is built; "
        "`compass reproduce PAPER` prints all rows.\n",
    ]
    for paper in PAPERS:
        module = import_module(f"compass.papers.{paper}")
        rows = [row.as_dict() for row in module.rows()]
        wrong = [row for row in rows if row["verdict"] == "erratum"]
        parts += [f"## {_prose(module.TITLE)}\n"]
        parts += ["| what | printed | computed | unit | why |\n| --- | --- | --- | --- | --- |"]
        parts += [
            "| " + " | ".join(_prose(str(row[key])) for key in
                              ("item", "published", "computed", "unit", "reason")) + " |"
            for row in wrong
        ]  # fmt: skip
        parts.append("")
    return "\n".join(parts)


def gallery(folder: Path) -> str:
    """Pictures, each under the lines that made it, which are run here."""
    parts = ["# Gallery\n", "Every picture is made by the lines over it when this page is built.\n"]
    root = folder.parents[1]
    for script in sorted(folder.glob("*.py")):
        text = script.read_text(encoding="utf-8")
        picture = script.with_suffix(".png")
        if not picture.exists() or os.environ.get("COMPASS_GALLERY") != "keep":
            space: dict[str, object] = {}
            with chdir(root):
                exec(compile(text, str(script), "exec"), space)
            space["axes"].figure.savefig(picture, dpi=120)  # type: ignore[attr-defined]
        title = re.match(r'"""(.*?)"""\n', text, re.DOTALL)
        assert title is not None
        first = title[1].split("\n")[0]
        code = text[title.end() :].strip("\n")
        parts += [f"## {first.rstrip('.')}\n", f"```python\n{code}\n```\n"]
        parts += [f"![{first}](gallery/{picture.name})\n"]
    return "\n".join(parts)


def _prose(text: str) -> str:
    """Text for a cell or a paragraph of Markdown: no mark of it is taken for markup."""
    plain = text.replace("``", "`")
    plain = re.sub(r"([\\*_<>|\[\]$])", r"\\\1", plain) if "`" not in plain else plain
    return " ".join(plain.replace("|", "\\|" if "`" in plain else "|").split())


def _text(text: str) -> str:
    return f"```text\n{text}\n```\n"


def _code(text: str) -> str:
    return f"```python\n{text}\n```\n"


if __name__ == "__main__":
    write_all(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
