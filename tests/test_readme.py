import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


@pytest.mark.slow
def test_python_of_the_readme_runs(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code = "\n".join(blocks("python"))
    exec(compile(code, "README.md", "exec"), {})
    printed = capsys.readouterr().out
    assert "proven up to a mask of 8.6 deg" in printed
    assert "4 satellites in view at least" in printed and "% of area and time, proven" in printed
    assert (tmp_path / "globe.html").stat().st_size < 6e6


def test_commands_of_the_readme_exist():
    named = set(re.findall(r"`compass (\w+)", README))
    script = "from compass.cli.main import main; import sys; sys.argv = ['c', '--help']; main()"
    listed = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True).stdout
    assert named
    for name in named:
        assert re.search(rf"^  {name} ", listed, re.MULTILINE), name


def test_what_the_readme_points_to_is_there():
    for place in re.findall(r"\]\(([^)]+)\)", README):
        assert (ROOT / place).exists(), place


def test_ci_runs_the_readmes_test_command():
    command = next(block.strip() for block in blocks("sh") if "tox" in block)
    assert command in (ROOT / ".ci" / "run").read_text()
