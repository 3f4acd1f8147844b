"""Run every block of code of the pages written by hand: Python as it is, `compass` as typed.

The blocks of a page share one namespace and one folder, in their order, as a reader would have
them; the designs of the repository lie beside. A block of TOML with a name in its first line
(`# mine.toml`) is written to that file.
"""

import contextlib
import io
import re
import shlex
import shutil
import sys
import tempfile
import traceback
from pathlib import Path

ROOT = Path(__file__).parents[1]
#: Pages whose blocks are the code's own, and run when they are made.
MADE = {"gallery.md", "reference", "errata.md"}


def blocks(page: Path) -> list[tuple[str, str]]:
    """Language and text of every block of a page; `text` and `console` are output."""
    return re.findall(r"^```(\w+)\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)


def run(page: Path) -> list[str]:
    """Run the blocks of a page; return what went wrong."""
    space: dict[str, object] = {"__name__": "__main__"}
    with tempfile.TemporaryDirectory() as name, contextlib.chdir(name):
        shutil.copytree(ROOT / "designs", "designs")
        for language, text in blocks(page):
            try:
                with contextlib.redirect_stdout(io.StringIO()):
                    _run_block(language, text, space)
            except Exception:
                return [f"{page}:\n{text}\n{traceback.format_exc(limit=3)}"]
    return []


def _run_block(language: str, text: str, space: dict[str, object]) -> None:
    if language == "python":
        exec(compile(text, "block", "exec"), space)
    elif language == "toml":
        named = re.match(r"# (\S+\.toml)\n", text)
        if named:
            Path(named[1]).write_text(text)
    elif language == "sh":
        for line in text.replace("\\\n", " ").splitlines():
            if line.startswith("compass "):
                _command(shlex.split(line, comments=True))


def _command(words: list[str]) -> None:
    """Run the program in this process; exit statuses 0 and 1 are answers."""
    from compass.cli import main

    sys.argv = words
    try:
        main.main()
    except SystemExit as finished:
        if finished.code not in (0, 1, None):
            raise RuntimeError(f"{shlex.join(words)}: exit status {finished.code}") from None


def main() -> int:
    """Run all pages."""
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    ours = [p for p in pages if not MADE & {p.name, p.parent.name} and "_build" not in p.parts]
    wrong = [fault for page in ours for fault in run(page)]
    print("\n".join(wrong) or f"{len(ours)} pages run")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
